/* SPDX-License-Identifier: MIT */
/* Commands that remove seeds, and run. */
#include "show/label_report.h"
#include "command/act.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "command/answers.h"
#include "command/planting.h"
#include "journal/record.h"
#include "session/markers.h"
#include "session/paint.h"

enum { TAKEN_MOST = 256 }; /* seeds that one record says were removed */

/* ---- eliminators ---- */

/* Only a forest that is up to date knows which tree holds a voxel. */
static enum err find_voxels(const struct act *act, struct voxels *v)
{
    enum err err = session_skims(act->session) ? session_catch_up(act->session, act->fault) : OK;
    return err ? err : act_find_voxels(act, NULL, v);
}

/* ---- single trees ---- */

/* Which seeds were removed, for the journal: "took=X,Y,Z;X,Y,Z". Nothing where they are more than a
 * line should hold. */
static void add_taken(const struct session *session, struct reply *reply)
{
    const struct edit *edit = edits_first(&session_state(session)->lists.pending);
    const size_t before = edits_count(&session_former(session)->lists.pending),
                 now = session_pendings(session);
    const char *between = "took=";
    if (now - before > TAKEN_MOST)
        return;
    for (size_t i = before; i < now; i++) {
        const struct place p = grid_place(&session_scene(session)->grid, edit[i].cell);
        buf_printf(&reply->words, "%s%u,%u,%u", between, p.x, p.y, p.z);
        between = ";";
    }
}

/* The seeds that a record says were removed; ERR_CHECK where it does not say it so. */
static enum err read_taken(const struct grid *grid, const struct record_word *word, uint32_t *seed,
                           size_t *count, struct fault *fault)
{
    const char *at = word->value, *end = word->value + word->value_length;
    bool goes_on = true;
    for (*count = 0; goes_on && *count < TAKEN_MOST; goes_on = scan_text(&at, ";")) {
        int64_t place[3];
        if (!scan_integer(&at, 0, grid->size[0] - 1, &place[0]) || !scan_text(&at, ",") ||
            !scan_integer(&at, 0, grid->size[1] - 1, &place[1]) || !scan_text(&at, ",") ||
            !scan_integer(&at, 0, grid->size[2] - 1, &place[2]))
            break;
        seed[(*count)++] =
            grid_cell(grid, (uint32_t)place[0], (uint32_t)place[1], (uint32_t)place[2]);
    }
    return at == end ? OK : fault_set(fault, ERR_CHECK, "took: expected X,Y,Z;X,Y,Z");
}

static enum err remove_trees(const struct act *act)
{
    struct session *session = act->session;
    uint32_t taken[TAKEN_MOST];
    struct record_word word;
    struct voxels v = {0};
    size_t count;
    enum err err;
    if (act_find_recorded(act, "took", &word)) {
        err = read_taken(&session_scene(session)->grid, &word, taken, &count, act->fault);
        err = err ? err : session_erase_seeds(session, taken, count, act->fault);
    } else {
        err = find_voxels(act, &v);
        err = err ? err : session_erase_trees(session, v.cell, v.count, act->fault);
    }
    voxels_release(&v);
    if (!err)
        add_taken(session, act->reply);
    return err;
}

/* ---- markers ---- */

/* The numbers that a record says were removed: an array that the caller frees. */
static enum err read_removed(const struct markers *markers, const struct record_word *word,
                             uint32_t **number, size_t *count, struct fault *fault)
{
    const char *at = word->value, *end = word->value + word->value_length;
    bool fits = true;
    *count = 0;
    *number = mem_array(markers->count + 1, sizeof **number);
    if (!*number)
        return fault_memory(fault, "markers");
    do {
        int64_t first, last;
        fits = scan_range(&at, 1, (int64_t)markers->count, &first, &last) &&
               *count + (size_t)(last - first) < markers->count;
        for (int64_t n = first; fits && n <= last; n++)
            (*number)[(*count)++] = (uint32_t)n;
    } while (fits && scan_text(&at, ","));
    return fits && at == end ? OK : fault_set(fault, ERR_CHECK, "removed: expected N,N-N");
}

/* Of a whole stroke, or of an outline without its ring. */
static size_t seeds_of(const struct markers *markers, uint32_t number)
{
    const int16_t label = markers->marker[number - 1].label;
    size_t seeds = 0;
    for (; number; number = markers_next(markers, number))
        seeds +=
            markers->marker[number - 1].label == label ? markers->marker[number - 1].voxels : 0;
    return seeds;
}

static void write_removed(const struct act *act, const uint32_t *number, size_t count, size_t seeds)
{
    const struct markers *markers = session_markers(act->session);
    struct buf *out = &act->reply->text;
    if (count > 1) {
        buf_printf(out, "%zu markers removed\n", count);
        return;
    }
    buf_printf(out, "marker %u removed: %zu seed%s of label ", number[0], seeds, plural(seeds));
    label_report_write_name(out, act->session, (unsigned)markers->marker[number[0] - 1].label);
    buf_add_char(out, '\n');
}

static enum err remove_markers(const struct act *act)
{
    struct session *session = act->session;
    struct record_word word;
    struct voxels v = {0};
    uint32_t *number = NULL;
    size_t count;
    enum err err;
    if (act_find_recorded(act, "removed", &word)) {
        err = read_removed(session_markers(session), &word, &number, &count, act->fault);
    } else {
        err = find_voxels(act, &v);
        if (!err)
            err = session_find_markers(session, v.cell, v.count, &number, &count, act->fault);
    }
    const size_t seeds = !err && count == 1 ? seeds_of(session_markers(session), number[0]) : 0;
    if (!err)
        err = session_take_away(session, number, count, act->fault);
    if (!err) {
        /* Which markers were removed: "removed=3,7-9", in order. */
        struct buf *words = &act->reply->words;
        buf_add_blank(words);
        buf_add_text(words, "removed=");
        for (size_t i = 0, last; i < count; i = last + 1) {
            for (last = i; last + 1 < count && number[last + 1] == number[last] + 1;)
                last++;
            buf_printf(words, i ? ",%u" : "%u", number[i]);
            if (last > i)
                buf_printf(words, "-%u", number[last]);
        }
        write_removed(act, number, count, seeds);
    }
    free(number);
    voxels_release(&v);
    return err;
}

/* In a ball, voxels that no tree holds are ignored, unless that is all of them. */
enum err act_remove(const struct act *act)
{
    enum { MARKER };
    struct session *session = act->session;
    const enum err err =
        act_number_or(act, "of", MARKER) == MARKER ? remove_markers(act) : remove_trees(act);
    if (err)
        return err;
    const uint32_t *p = act_place(act, "PLACE");
    const uint32_t cell = grid_cell(&session_scene(session)->grid, p[0], p[1], p[2]);
    return session_note_eliminator(session, cell, act->fault);
}

/* ---- runs ---- */

enum err act_run(const struct act *act)
{
    return session_run(act->session, act->fault);
}
