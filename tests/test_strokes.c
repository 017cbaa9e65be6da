/* SPDX-License-Identifier: MIT */
/* Strokes and what else a hand paints, as commands: one record, one marker, one undo; what they
 * say, what they refuse, and what a journal has of them. Which voxels they are, test_paint proves.
 */
#include "command/command.h"
#include "session/session.h"
#include "tests/scarce_memory.h"
#include "tests/scene_main.h"

static struct interpreter interp;

static void resume(const char *journal)
{
    resume_journal(&interp, journal);
    CHECK(!interp.resumes_in_full); /* what the records say of seeds was enough */
}

/* The journal says this of the last command. */
static void is_recorded_as(const char *line)
{
    CHECK_TEXT(buf_text(&reply.canonical), line);
}

static size_t seeds(void)
{
    return forest_seeds(interp.session->forest);
}

/* ---- one stroke, one record ---- */

JOURNAL_STORY(a_stroke_is_one_record_one_marker_and_one_undo, "stroke.iftty")
{
    must(&interp,
         "auto on; seed 9,9,9 3; seed 1,1,1 1 to=2,1,1 to=3,1,1 to=3,2,1 to=3,3,1 to=3,3,5");
    is_recorded_as("seed 1,1,1 1 to=3,1,1 to=3,3,1 to=3,3,5");
    CHECK_HAS(buf_text(&reply.words), "marker=2 ");
    CHECK_INT(journal_count(interp.journal), 4);
    CHECK_INT(seeds(), 10);
    must_leave_seeds(&interp, "undo", 1);
    MUST_MENTION(&interp, "redo; remove 3,3,3", "marker 2 removed: 9 seeds of label 1");
    CHECK_INT(seeds(), 1);
}

JOURNAL_STORY(parts_of_a_stroke_are_undone_done_again_and_removed_as_one, "parts.iftty")
{
    must(&interp, "auto on; seed 9,9,9 3; seed 1,1,1 1 to=3,1,1; seed 3,1,1 1 to=3,3,1 joined=yes; "
                  "seed 3,3,1 1 to=3,3,5 joined=yes");
    is_recorded_as("seed 3,3,1 1 to=3,3,5 joined=yes");
    CHECK_INT(seeds(), 10);
    resume("parts.iftty");
    must_leave_seeds(&interp, "undo", 1);
    CHECK_HAS(buf_text(&reply.words), "at=3 ");
    must_leave_seeds(&interp, "redo", 10);
    CHECK_HAS(buf_text(&reply.words), "at=6 ");
    must_leave_seeds(&interp, "undo 2", 0); /* the other seed too */
    must_leave_seeds(&interp, "redo 2; goto 5", 6);
    must_leave_seeds(&interp, "undo", 1); /* from among the parts: all of it */
    must(&interp, "goto main");
    struct held held;
    const struct session *session = interp.session;
    const uint32_t cell = grid_cell(&session->scene->grid, 3, 2, 1);
    CHECK(session_find_held(&held, session, cell, false, &fault) == OK);
    CHECK(held.marker == 2 && held.trees == 9 && session_is_held(session, &held, cell));
    MUST_RECORD(&interp, "remove 3,2,1", "removed=2 ");
    CHECK_HAS(buf_text(&reply.text), "marker 2 removed: 11 seeds of label 1"); /* two ends twice */
    CHECK_INT(seeds(), 1);
    resume("parts.iftty");
    CHECK_INT(seeds(), 1);
    must_leave_seeds(&interp, "undo", 10);
}

/* Killed while the second part or the third is written: what stands afterwards is the parts that
 * were whole on the disk, which are one stroke. */
STORY(a_stroke_that_is_cut_short_keeps_its_whole_parts_as_one)
{
    OWNED(buf_release) struct buf whole = {0};
    size_t stood[11] = {0};
    begin_with_journal(&interp, "whole.iftty");
    must(&interp, "auto on; seed 9,9,9 3; seed 1,1,1 1 to=3,1,1");
    CHECK(file_read(&whole, place("whole.iftty"), 1 << 20, NULL) == OK);
    const size_t first = whole.length;
    buf_clear(&whole);
    must(&interp, "seed 3,1,1 1 to=3,3,1 joined=yes; seed 3,3,1 1 to=3,3,5 joined=yes");
    interpreter_release(&interp);
    CHECK(file_read(&whole, place("whole.iftty"), 1 << 20, NULL) == OK);
    for (size_t cut = first; cut <= whole.length && check_failures == 0; cut += 3) {
        CHECK(file_write(place("cut.iftty"), whole.data, cut, FILE_REPLACE, NULL) == OK);
        begin_interpreter(&interp);
        resume("cut.iftty");
        const size_t count = seeds();
        CHECK(count == 4 || count == 6 || count == 10);
        stood[count]++;
        must_leave_seeds(&interp, "undo", 1);
        must_leave_seeds(&interp, "redo", count);
        must_leave_seeds(&interp, "remove 2,1,1", 1);
        interpreter_release(&interp);
    }
    CHECK(stood[4] > 0 && stood[6] > 0);
}

JOURNAL_STORY(only_what_was_just_planted_is_gone_on_with, "alone.iftty")
{
    static const char words[] = "joined: the previous command did not plant seeds of label 1";
    is_refused(&interp, "seed 1,1,1 1 joined=yes", words);
    must(&interp, "seed 1,1,1 2");
    is_refused(&interp, "seed 1,1,1 1 joined=yes", words);
    must(&interp, "seed 1,1,1 1; run");
    is_refused(&interp, "seed 1,1,1 1 joined=yes", words);
    must(&interp, "seed 1,1,1 1; view left"); /* is no change of the segmentation */
    must(&interp, "seed 1,2,1 1 joined=yes; undo");
    is_refused(&interp, "seed 1,1,1 1 joined=yes", words);
}

JOURNAL_STORY(a_line_of_the_journal_holds_thousands_of_corners, "long.iftty")
{
    OWNED(buf_release) struct buf line = {0};
    struct snapshot end;
    uint64_t random = 5;
    must(&interp, "auto on");
    buf_add_text(&line, "seed 5,5,5 1");
    while (line.length < 65000) {
        const uint32_t x = check_below(&random, size[0]), y = check_below(&random, size[1]);
        buf_printf(&line, " to=%u,%u,%u", x, y, check_below(&random, size[2]));
    }
    must(&interp, buf_text(&line));
    MUST_MENTION(&interp, "history", " bytes more)");
    CHECK(reply.text.length < 2000);
    take_snapshot(&end, &interp);
    resume("long.iftty");
    is_segmented_as(&end, &interp);
    while (line.length < 65536)
        buf_add_text(&line, " to=1,1,1");
    is_refused(&interp, buf_text(&line), "the command is longer than 65535 bytes");
}

/* ---- where, and how large ---- */

STORY(millimetres_are_refused_where_nobody_knows_them)
{
    OWNED(buf_release) struct buf file = {0};
    begin_with_journal(&interp, "unknown.iftty");
    must(&interp, "seed 5,5,5 1 radius=2.50mm");
    is_recorded_as("seed 5,5,5 1 radius=2.5mm");
    must(&interp, "run; remove 1,1,1 radius=0.000001mm");
    is_refused(&interp, "seed 5,5,5 1 radius=400mm",
               "radius: it reaches 400 voxels along x; at most 128");
    is_refused(&interp, "seed 5,5,5 1 radius=1000.1mm",
               "radius: expected a number 0..512, or millimetres");
    is_refused(&interp, "seed 5,5,5 1 radius=2cm", "up to 1000 with at most six decimals, not 2cm");
    interpreter_release(&interp);
    CHECK(file_read(&file, place("scene.nii"), 1 << 20, NULL) == OK && file.length > 352);
    memset(file.data + 76 + 4 * 3, 0, 4); /* pixdim[3], */
    memset(file.data + 252, 0, 4);        /* and the codes of both forms, which say it too */
    CHECK(file_write(place("sizeless.nii"), file.data, file.length, FILE_REPLACE, NULL) == OK);
    begin_interpreter(&interp);
    open_scene(&interp, "sizeless.nii");
    must(&interp, "seed 5,5,5 1 radius=2"); /* whose brush is let go of once */
    is_refused(&interp, "seed 5,5,5 1 radius=2mm", "voxel size is unknown");
    is_refused(&interp, "remove 5,5,5 radius=2mm", "voxel size is unknown");
    must(&interp, "seed 5,5,5 1 radius=2");
    interpreter_release(&interp);
}

JOURNAL_STORY(only_intensities_of_the_range_are_planted, "range.iftty")
{
    must(&interp, "box 0,0,0 11,10,9 1 range=40..80.5");
    is_recorded_as("box 0,0,0 11,10,9 1 range=40..80.5");
    CHECK_HAS(buf_text(&reply.text), "left out, intensities beyond the range: ");
    must(&interp, "run");
    bool fits = true;
    for (uint32_t c = 0; c < interp.session->scene->grid.cells; c++) {
        const struct cell *cell = interp.session->scene->cell + c;
        const bool inside = cell->intensity >= 40 && cell->intensity <= 80;
        fits &= cell->flags & CELL_RIM || !(cell->flags & CELL_SEED) == !inside;
    }
    CHECK(fits);
    must(&interp, "undo 2");
    write_text("few.csv", "1,1,1,1\n9,9,8,1\n");
    MUST_MENTION(&interp, "seed-file few.csv range=0..20", "1 seed\n");
    is_refused(&interp, "seed 1,1,1 1 range=200..300",
               "range: no voxel of it has such an intensity");
    is_refused(&interp, "seed 1,1,1 1 range=20",
               "range: expected LOW..HIGH, as in 40..1200.5, or 2:LOW..HIGH of channel 2, of at "
               "most 19 digits each, not 20");
    is_refused(&interp, "seed 1,1,1 1 range=20..10", "expected LOW..HIGH");
    must(&interp, "range 0 90");
    is_refused(&interp, "seed 9,9,8 1 range=90..300", "is outside the region of interest");
}

JOURNAL_STORY(a_polygon_is_of_one_slice, "fill.iftty")
{
    must(&interp, "fill 1,1,5 1 to=9,1,5 to=9,2,5 to=9,9,5 range=-5..9999");
    is_recorded_as("fill 1,1,5 1 range=-5..9999 to=9,1,5 to=9,9,5");
    must_leave_seeds(&interp, "run", 45);
    is_refused(&interp, "fill 1,1,5 1 to=9,1,5 to=9,9,6",
               "the corners of a polygon must be in one slice");
    is_refused(&interp, "fill 1,1,5 1 to=2,1,5 to=9,1,5", "a polygon has three corners or more");
    is_refused(&interp, "fill 1,1,5 1", "missing: to; usage: fill X,Y,Z LABEL");
}

/* A label has so many seeds in a slice z, and so many in all slices. */
static void has_seeds(int label, uint32_t z, int there, int all)
{
    const struct scene *scene = interp.session->scene;
    int found[2] = {0};
    for (uint32_t c = 0; c < scene->grid.cells; c++)
        if (scene->cell[c].flags & CELL_SEED && scene->cell[c].label == label) {
            found[0] += grid_place(&scene->grid, c).z == z;
            found[1]++;
        }
    CHECK_INT(found[0], there);
    CHECK_INT(found[1], all);
}

JOURNAL_STORY(an_outline_says_what_lies_on_both_sides_of_a_border, "outline.iftty")
{
    static const char line[] = "outline 4,4,5 1 to=6,4,5 to=6,6,5 to=4,6,5";
    must(&interp, "auto on; seed 1,1,1 1");
    must(&interp, line);
    is_recorded_as(line);
    CHECK_HAS(buf_text(&reply.words), "marker=2-3 ");
    CHECK_INT(journal_count(interp.journal), 4);
    has_seeds(1, 5, 9, 10);
    has_seeds(0, 5, 52, 52); /* 81 less five at each corner, which are farther than 3, and these */
    must_leave_seeds(&interp, "undo", 1);
    MUST_MENTION(&interp, "redo; remove 5,5,5", "marker 2 removed: 9 seeds of label 1");
    CHECK_INT(seeds(), 1);
    must_leave_seeds(&interp, "undo; remove 2,4,5", 1); /* by its ring */
    must(&interp, "undo");
    is_refused(&interp, "seed 8,8,8 0 joined=yes", "the previous command did not plant");
    resume("outline.iftty");
    has_seeds(0, 5, 52, 52);
    must(&interp, "undo 5");
    must(&interp, "outline 0,4,5 1 to=0,6,5 to=0,6,7 range=0..40"); /* at the edge of the scene */
    has_seeds(1, 6, 2, 6);
    /* no ring around the background, */
    MUST_RECORD(&interp, "outline 4,4,5 0 to=6,4,5 to=6,6,5 to=4,6,5", "marker=6 ");
    must(&interp, "undo");
    must(&interp,
         "outline 4,4,5 1 to=6,4,5 to=6,6,5 to=4,6,5 ring=0"); /* nor where none is wanted */
    CHECK_HAS(buf_text(&reply.words), "marker=7 ");
    is_refused(&interp, "outline 4,4,5 0 to=6,4,5 to=6,6,5 ring=1", "only for objects");
    is_refused(&interp, "outline 4,4,5 1 to=6,4,5", "a polygon has three corners or more");
    is_refused(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,5 range=300..400", "no voxel of it has");
    is_refused(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,5 ring=17", "ring: expected");
}

JOURNAL_STORY(the_ring_of_an_outline_cuts_no_other_object, "others.iftty")
{
    must(&interp, "box 7,4,5 8,6,5 2");
    must(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,5 to=4,6,5"); /* while that waits */
    CHECK_HAS(buf_text(&reply.text), "in another object: 6 voxels");
    CHECK_HAS(buf_text(&reply.words), "spared=21-22,27-28,33-34 marker=2-3");
    must(&interp, "run");
    has_seeds(0, 5, 46, 46);
    must(&interp, "box 1,3,5 3,7,5 3"); /* what is planted later holds, */
    must(&interp, "run");
    has_seeds(0, 5, 33, 33);
    must(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,5 to=4,6,5 ring=1"); /* and in a ring too */
    CHECK_HAS(buf_text(&reply.text), "in another object: 6 voxels");
    must(&interp, "undo 3");
    has_seeds(0, 5, 46, 46);
    must(&interp, "seed 6,5,6 2"); /* voxels of its trees, where no seed is */
    must(&interp, "run; outline 4,4,7 1 to=6,4,7 to=6,6,7 to=4,6,7");
    const size_t before = forest_seeds(interp.session->forest);
    must(&interp, "run");
    CHECK(forest_seeds(interp.session->forest) > before + 9);
    CHECK(forest_seeds(interp.session->forest) < before + 9 + 52);
    const uint64_t digest = forest_digest(interp.session->forest);
    resume("others.iftty");
    CHECK(forest_digest(interp.session->forest) == digest);
}

JOURNAL_STORY(an_outline_takes_the_place_of_a_marker, "instead.iftty")
{
    must(&interp, "auto on; seed 1,1,1 1; outline 4,4,5 1 to=6,4,5 to=6,6,5 to=4,6,5 ring=1; "
                  "outline 4,4,5 1 to=7,4,5 to=7,7,5 to=4,7,5 ring=1 instead=2");
    is_recorded_as("outline 4,4,5 1 to=7,4,5 to=7,7,5 to=4,7,5 ring=1 instead=2");
    CHECK_HAS(buf_text(&reply.words), "removed=2 marker=4-5 ");
    has_seeds(1, 5, 16, 17);
    has_seeds(0, 5, 16, 16);
    must(&interp, "undo");
    has_seeds(1, 5, 9, 10);
    has_seeds(0, 5, 12, 12);
    must(&interp, "redo");
    must(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,5 to=4,6,5 ring=1 instead=5"); /* by its ring */
    CHECK_HAS(buf_text(&reply.words), "removed=4 marker=6-7 ");
    has_seeds(1, 5, 9, 10);
    is_refused(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,5 instead=4", "there is no marker 4");
    is_refused(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,5 instead=99", "there is no marker 99");
    is_refused(&interp, "outline 4,4,5 1 to=6,4,5 to=6,6,6 instead=6", "must be in one slice");
    has_seeds(1, 5, 9, 10);
    resume("instead.iftty");
    has_seeds(1, 5, 9, 10);
    has_seeds(0, 5, 12, 12);
}

/* ---- names and quotes ---- */

JOURNAL_STORY(a_label_may_be_called_by_several_words, "names.iftty")
{
    must(&interp, "label 1 'left hemi' #FF00Aa");
    is_recorded_as("label 1 \"left hemi\" #ff00aa");
    must(&interp, "label 2 \"right hemi\"; seed 1,1,1 'left hemi'");
    is_recorded_as("seed 1,1,1 1");
    must(&interp, "seed 9,9,9 \"right hemi\"; label 4 c#4");
    write_text("named.csv", "5,5,5,right hemi # there\n6,6,6,c#4\n");
    must(&interp, "seed-file named.csv; run");
    is_refused(&interp, "label 3 'a b '", "expected a name of at most 31 bytes");
    is_refused(&interp, "label 3 'a=b c'", "expected a name");
    is_refused(&interp, "branch 'a b'", "expected a word of at most 63 bytes");
    is_refused(&interp, "label 3 'a", "a word in quotes does not end");
    is_refused(&interp, "label 3 'a'b", "a word in quotes does not end");
    must(&interp, "label 3 it's");
    OWNED(buf_release) struct buf offers = {0};
    size_t start;
    command_complete(&offers, &start, "seed 1,1,1 le", 13, &interp);
    CHECK_TEXT(buf_text(&offers), "\"left hemi\"\tlabel 1\n");
    buf_clear(&offers);
    command_complete(&offers, &start, "seed 1,1,1 ", 11, &interp);
    CHECK_HAS(buf_text(&offers),
              "\"left hemi\"\tlabel 1\n\"right hemi\"\tlabel 2\n\"it's\"\tlabel 3\n");
    resume("names.iftty");
    CHECK_TEXT(interp.session->now.kept.label_name[1], "left hemi");
}

/* ---- sketches ---- */

/* What a pen draws is seen, and leaves no trace. */
STORY(a_sketch_is_as_if_it_had_never_been)
{
    struct snapshot before, seen;
    for (int runs = 0; runs < 2; runs++) {
        begin_with_journal(&interp, "sketch.iftty");
        must(&interp, "seed 9,9,9 3; seed 9,8,9 2; run; remove 9,8,9");
        must(&interp, "undo"); /* so that there is something to do again */
        must(&interp, runs ? "auto on" : "auto off");
        must(&interp, "render");
        take_snapshot(&before, &interp);
        CHECK(interpreter_drop_sketch(&interp, NULL) == OK); /* there is none */
        CHECK(interpreter_sketch(&interp, "cross 1,1,1", NULL) == OK);
        CHECK(interpreter_sketch(&interp, "seed 1,1,1 1 radius=2 to=9,9,9", NULL) == OK);
        CHECK(interpreter_sketch(&interp, "seed 9,9,9 1 radius=2 to=2,9,1", NULL) == OK);
        CHECK(interpreter_sketch(&interp, "seed 99,9,9 1", NULL) == ERR_INPUT);
        CHECK(interpreter_sketch(&interp, "remove 1,1,1", NULL) == ERR_USAGE);
        take_snapshot(&seen, &interp);
        CHECK(seen.forest != before.forest || !runs);
        CHECK(seen.records == before.records && seen.acknowledged == before.acknowledged);
        CHECK(interpreter_drop_sketch(&interp, NULL) == OK);
        is_as_before(&before, &interp, "a sketch");
        CHECK(interpreter_sketch(&interp, "seed 1,1,1 1", NULL) == OK);
        must(&interp, "redo"); /* of what was undone before */
        CHECK_HAS(buf_text(&reply.text), "remove 9,8,9");
        CHECK(interp.session->markers.count == 2);
        resume("sketch.iftty");
        interpreter_release(&interp);
    }
}

JOURNAL_STORY(a_sketch_without_memory_is_taken_back_in_the_end, "memory.iftty")
{
    struct snapshot before;
    must(&interp, "auto on; seed 9,9,9 3");
    take_snapshot(&before, &interp);
    unsigned refused = 0;
    for (size_t most = 0; most < 60; most++) {
        fail_allocation(most);
        refused += interpreter_sketch(&interp, "seed 1,1,1 1 radius=2 to=9,9,9", NULL) != OK;
        fail_allocation(most / 2);
        if (interpreter_drop_sketch(&interp, NULL)) {
            refused++;
            CHECK(interp.sketch.is_begun);
        }
        mem_allows = NULL;
        CHECK(interpreter_drop_sketch(&interp, NULL) == OK);
        is_as_before(&before, &interp, "a sketch without memory");
    }
    CHECK(refused > 10);
}

/* ---- what runs, and when ---- */

JOURNAL_STORY(what_waits_runs_with_the_next_edit_and_not_by_going_there, "waits.iftty")
{
    must(&interp, "seed 1,1,1 1; seed 9,9,9 2; run; undo"); /* record 5: two edits wait */
    MUST_ANSWER(&interp, "auto on", "2 edits pending until `run` or the next edit\n");
    CHECK_INT(session_pendings(interp.session), 2);
    must_leave_seeds(&interp, "seed 5,5,5 3", 3); /* runs all three */
    CHECK_INT(session_pendings(interp.session), 0);
    MUST_MENTION(&interp, "goto 2",
                 "after 2 seed 1,1,1 1, 1 edit pending until `run` or the next edit");
    CHECK_INT(seeds(), 0);
    CHECK_INT(session_pendings(interp.session), 1);
    must(&interp, "view left"); /* no edit */
    CHECK_INT(session_pendings(interp.session), 1);
    must_leave_seeds(&interp, "weight sobel", 1);
    must(&interp, "undo");
    CHECK_INT(session_pendings(interp.session), 1);
    CHECK_INT(seeds(), 0);
    must_leave_seeds(&interp, "redo", 1);
    must(&interp, "undo");
    resume("waits.iftty");
    CHECK_INT(session_pendings(interp.session), 1);
    must_leave_seeds(&interp, "run", 1);
}
