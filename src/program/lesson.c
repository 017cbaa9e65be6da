/* SPDX-License-Identifier: MIT */
#include "program/programs.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "command/interpreter.h"
#include "engine/forest.h"
#include "session/map.h"
#include "session/session.h"
#include "session/state.h"
#include "session/tally.h"

enum { KEYS_MOST = 4, KEYS_WIDE = 4 };

/* ---- state of the segmentation ---- */

enum { BACKGROUND, OBJECT };

static void add_dice(struct buf *out, unsigned dice)
{
    buf_printf(out, "%u.%03u", dice / DICE_ONE, dice % DICE_ONE / 10);
}

/* True if there are seeds of a label, most of them on its side of the truth. */
static bool are_planted(const struct lesson *lesson, int label, struct buf *missing)
{
    const size_t in = lesson->seeds[label][1], out = lesson->seeds[label][0];
    const size_t wrong = label == OBJECT ? out : in;
    if (in + out == 0)
        buf_printf(missing, "there is no seed of %s yet",
                   label == OBJECT ? "label 1" : "the background");
    else if (2 * wrong > in + out)
        buf_printf(missing, "%zu of its %zu seed%s %s %s the brain", wrong, in + out,
                   plural(in + out), in + out == 1 ? "is" : "are",
                   label == OBJECT ? "outside" : "in");
    return missing->length == 0;
}

/* Voxels of ch2 are 1 mm3. */
static bool labels_agree(const struct lesson *lesson, unsigned least, struct buf *missing)
{
    const struct overlap_counts count = overlap_counts_of(&lesson->overlap, OBJECT);
    const unsigned dice = overlap_dice(&lesson->overlap, OBJECT);
    if (!lesson->is_settled) {
        buf_add_text(missing, "labels are settling");
    } else if (dice < least) {
        const uint64_t more = count.a - count.both, less = count.b - count.both;
        buf_add_text(missing, "Dice ");
        add_dice(missing, dice);
        buf_add_text(missing, " of ");
        add_dice(missing, least);
        buf_printf(missing, ", %.0f ml too %s, most in z=%u",
                   (double)(more > less ? more : less) / 1000, more > less ? "much" : "little",
                   lesson->worst);
    }
    return missing->length == 0;
}

/* ---- the steps ---- */

struct step {
    const char *about;
    struct {
        const char *keys, *what;
    } key[KEYS_MOST];
    const char *command; /* the same at the prompt */
    /* The step is complete if */
    int planted;   /* seeds of this label are on the right side; -1: no condition */
    unsigned dice; /* Dice's coefficient is at least this, in ten thousandths; 0: no condition */
    bool is_named; /* label 1 needs a name */
};

static const struct step step[] = {
    {"in the object",
     {{"3L", "move 30 voxels right, from a ventricle into white matter"},
      {"i", "plant a ball of label 1; this label now fills the whole scene"}},
     "seed 60,108,90 1 radius=6",
     .planted = OBJECT},
    {"its neighbour",
     {{"4L", "move 40 voxels further, into the skull"},
      {"s0", "plant a ball of background in the skull, next to the brain"}},
     "seed 20,108,90 0 radius=6",
     .planted = BACKGROUND,
     .dice = 7500},
    {"the other side",
     {{"14H", "move 140 voxels to the other side"},
      {"i", "plant background there too: label 1 is now brain and neck muscles"}},
     "seed 160,108,90 0 radius=6",
     .planted = -1,
     .dice = 9200},
    {"the leak",
     {{"80J", "move 80 slices down, next to the neck"},
      {"I", "begin a stroke"},
      {"14L", "move 140 voxels, across the leak"},
      {"i", "plant a stroke of background: 1.69 litres of brain remain"}},
     "seed 160,108,10 0 radius=6 to=20,108,10",
     .planted = -1,
     .dice = 9500},
    {"a name", {{NULL, NULL}}, "label 1 brain", .planted = -1, .is_named = true},
};

enum { STEPS = sizeof step / sizeof step[0] };

/* True if a step is complete; otherwise adds the reason. */
static bool has_come(const struct step *s, const struct lesson *lesson, struct buf *missing)
{
    if ((s->planted >= 0 && !are_planted(lesson, s->planted, missing)) ||
        (s->dice && !labels_agree(lesson, s->dice, missing)))
        return false;
    if (s->is_named && !lesson->has_name)
        buf_add_text(missing, "label 1 has no name yet");
    return missing->length == 0;
}

/* The first incomplete step, but not one before the furthest so far; STEPS if all are complete. The
 * reason is that of the first incomplete step. */
static unsigned present_step(const struct lesson *lesson, struct buf *missing)
{
    unsigned n = 0;
    while (n < STEPS && has_come(&step[n], lesson, missing))
        n++;
    return n < lesson->furthest ? lesson->furthest : n;
}

/* ---- text ---- */

static void add_title(struct buf *out, const struct lesson *lesson, unsigned n,
                      const struct buf *missing)
{
    if (n < STEPS) {
        buf_printf(out, "step %u of %d, %s: %s\n", n + 1, STEPS, step[n].about, buf_text(missing));
        return;
    }
    buf_add_text(out,
                 "all steps are done: a brain, whose Dice coefficient with " LESSON_TRUTH " is ");
    add_dice(out, overlap_dice(&lesson->overlap, OBJECT));
    buf_add_char(out, '\n');
}

static void add_end(struct buf *out, const char *journal, bool in_pilot)
{
    buf_add_text(out, in_pilot ? "q, then `quit`, ends the lesson; `iftty "
                               : "`quit` ends the lesson. `iftty ");
    buf_add_safe_text(out, journal);
    buf_add_text(out,
                 in_pilot ? "` continues it, `iftty verify " : "` continues it,\n`iftty verify ");
    buf_add_safe_text(out, journal);
    buf_add_text(out, in_pilot ? "` proves it" : "` proves it, and examples/ has more.\n");
}

/* Add a key in a colour, "" for none. */
static void add_key(struct buf *out, const char *key, const char *colour)
{
    buf_printf(out, "%s%s%s", colour, key, *colour ? "\033[m" : "");
}

void lesson_add_beginning(struct buf *out)
{
    buf_printf(out,
               "A first organ: the brain of this head, in %d steps. Each step has instructions,\n"
               "and is complete when its result is reached, by any commands. `undo` undoes a\n"
               "command that did not help. The keys are those of the pilot (Ctrl-O); u undoes.\n",
               STEPS);
}

void lesson_add_page(struct buf *out, const struct lesson *lesson, const char *journal,
                     const char *colour)
{
    OWNED(buf_release) struct buf missing = {0};
    const unsigned n = present_step(lesson, &missing);
    add_title(out, lesson, n, &missing);
    if (n == STEPS)
        add_end(out, journal, false);
    for (unsigned k = 0; n < STEPS && k < KEYS_MOST && step[n].key[k].keys; k++) {
        const char *keys = step[n].key[k].keys;
        buf_add_text(out, "    ");
        add_key(out, keys, colour);
        buf_printf(out, "%*s %s\n", KEYS_WIDE - (int)strlen(keys), "", step[n].key[k].what);
    }
    if (n < STEPS)
        buf_printf(out, "%s  %s\n", step[n].key[0].keys ? "or here:" : "here:   ", step[n].command);
}

void lesson_add_captions(struct buf *out, const struct lesson *lesson, const char *journal,
                         const char *colour)
{
    OWNED(buf_release) struct buf missing = {0};
    const unsigned n = present_step(lesson, &missing);
    add_title(out, lesson, n, &missing);
    if (n == STEPS) {
        add_end(out, journal, true);
    } else if (!step[n].key[0].keys) {
        buf_printf(out, "%s:%s%s and Enter", colour, step[n].command, *colour ? "\033[m" : "");
    }
    for (unsigned k = 0; n < STEPS && k < KEYS_MOST && step[n].key[k].keys; k++) {
        buf_add_text(out, k ? "; " : "");
        add_key(out, step[n].key[k].keys, colour);
        buf_printf(out, " %s", step[n].key[k].what);
    }
}

void lesson_add_keys(struct buf *out)
{
    for (unsigned n = 0; n < STEPS; n++)
        for (unsigned k = 0; k < KEYS_MOST && step[n].key[k].keys; k++)
            buf_printf(out, "    %-9s %s\n", step[n].key[k].keys, step[n].key[k].what);
}

/* ---- looking at the session ---- */

enum err lesson_begin(struct lesson *lesson, const struct interpreter *interp, struct fault *fault)
{
    const struct map_place place = session_map_place(interp->session, false);
    const struct map_labels choice = {NULL, OBJECT};
    struct watch *watch = interp->session->watch;
    OWNED(volume_release) struct volume map = {0};
    OWNED(buf_release) struct buf path = {0};
    TRY(interpreter_find_file(interp, LESSON_TRUTH, &path, fault));
    TRY(map_read(&map, buf_text(&path), &place, watch, fault));
    TRY(map_to_regions(&map, 0, REGION_MOST, watch, fault));
    TRY(map_to_labels(&lesson->truth, &map, &choice, watch, fault));
    memcpy(lesson->size, place.grid->size, sizeof lesson->size);
    return OK;
}

/* Count slice by slice, to know the differences of each. After `interpolate` has made another grid,
 * nothing is counted. */
static void count_labels(struct lesson *lesson, const struct labels *labels)
{
    const struct scene *scene = labels->scene;
    const uint8_t *truth = lesson->truth;
    uint64_t most = 0;
    lesson->overlap = (struct overlap){0};
    memset(lesson->seeds, 0, sizeof lesson->seeds);
    if (memcmp(lesson->size, scene->grid.size, sizeof lesson->size) != 0)
        return;
    for (uint32_t z = 0; z < scene->grid.size[2]; z++) {
        const uint64_t before = lesson->overlap.differing;
        for (uint32_t y = 0; y < scene->grid.size[1]; y++) {
            const struct span row = grid_row(&scene->grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, truth++) {
                const uint8_t own = labels_at(labels, c) == OBJECT;
                const struct cell *cell = scene->cell + c;
                overlap_add(&lesson->overlap, &own, truth, 1);
                if (cell->flags & CELL_SEED && cell->label <= OBJECT)
                    lesson->seeds[cell->label][*truth]++;
            }
        }
        if (lesson->overlap.differing - before > most) {
            most = lesson->overlap.differing - before;
            lesson->worst = z;
        }
    }
}

void lesson_look(struct lesson *lesson, struct session *session, bool waits)
{
    const struct kept *kept = &session->now.kept;
    const bool settles = kept->finish.count && session->now.outlook.shows_finished;
    struct labels labels = labels_of_forest(session->scene);
    OWNED(buf_release) struct buf missing = {0};
    struct fault fault;
    lesson->has_name = *kept->label_name[OBJECT];
    if (settles && waits && session_labels(session, true, &labels, &fault))
        labels.finished = NULL; /* it was cancelled */
    if (settles && !labels.finished)
        labels.finished = session_finished(session);
    const uint64_t of =
        hash_mix_at(forest_digest(session->forest), session->scene_digest + !!labels.finished);
    lesson->is_settled = !settles || labels.finished;
    if (lesson->of != of)
        count_labels(lesson, &labels);
    lesson->of = of;
    const unsigned n = present_step(lesson, &missing);
    lesson->furthest = n < STEPS ? n : STEPS - 1;
}

/* ---- the program ---- */

/* ERR_IO if the scene or the truth is missing; called before the terminal changes. */
static enum err find_files(const struct interpreter *interp, struct fault *fault)
{
    OWNED(buf_release) struct buf path = {0};
    enum err err = interpreter_find_file(interp, LESSON_SCENE, &path, fault);
    if (!err)
        err = interpreter_find_file(interp, LESSON_TRUTH, &path, fault);
    return err ? fault_set(
                     fault, err,
                     "the lesson needs the head " LESSON_SCENE " and its brain " LESSON_TRUTH
                     ", which are missing: install Debian's package mricron-data, or name their "
                     "folder in IFTTY_SCENES")
               : OK;
}

enum err run_tutorial(const struct options *o, struct fault *fault)
{
    struct lesson lesson = {0};
    struct interpreter interp;
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO))
        return fault_set(fault, ERR_USAGE, "the lesson needs a terminal");
    enum err err = interpreter_init(&interp, fault);
    if (!err)
        err = find_files(&interp, fault);
    interpreter_release(&interp);
    if (!err)
        err = prompt_run(o, &lesson, fault);
    free(lesson.truth);
    return err;
}
