/* SPDX-License-Identifier: MIT */
#include "verify/gesture.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "command/command.h"
#include "command/interpreter.h"
#include "engine/forest.h"
#include "engine/overlap.h"
#include "session/session.h"
#include "verify/side.h"

#define GESTURE_NAME(kind, name) name,
const char *const gesture_kind_name[GESTURE_KIND_COUNT] = {GESTURE_KINDS(GESTURE_NAME)};

/* What comes before gestures and steps, in what a process hands back. */
struct heading {
    uint64_t gestures, steps;
};

/* ---- what a command is ---- */

/* Kinds have the names of commands, but for eliminators, and those that are kinds of `seed`. */
static bool read_kind(enum gesture_kind *kind, const struct call *call)
{
    static const char eliminator[] = "remove";
    const char *name = call->command->name;
    if (strcmp(name, eliminator) == 0)
        name = gesture_kind_name[GESTURE_ELIMINATOR];
    unsigned i = 0;
    while (i < GESTURE_KIND_COUNT && strcmp(gesture_kind_name[i], name) != 0)
        i++;
    if (i == GESTURE_KIND_COUNT)
        return false;
    *kind = (enum gesture_kind)i;
    if (*kind <= GESTURE_BOX && call_has(call, "shell"))
        *kind = GESTURE_SHELL;
    else if (*kind == GESTURE_SEED && call_has(call, "to"))
        *kind = GESTURE_STROKE;
    else if (*kind == GESTURE_SEED && call_value(call, "radius")->number > 0)
        *kind = GESTURE_BALL;
    return true;
}

struct corners {
    uint32_t first[3], last[3]; /* the box around them */
    bool are_there;
};

static void add_corner(struct corners *corners, const uint32_t place[3])
{
    for (int a = 0; a < 3; a++) {
        const bool is_first = !corners->are_there;
        if (is_first || place[a] < corners->first[a])
            corners->first[a] = place[a];
        if (is_first || place[a] > corners->last[a])
            corners->last[a] = place[a];
    }
    corners->are_there = true;
}

static void add_corners(struct corners *corners, const struct call *call)
{
    const struct parameter *p = call->command->parameter;
    for (int i = 0; p[i].type != VALUE_END; i++) {
        const struct value *value = &call->value[i];
        if (value->given && p[i].type == VALUE_POSITION && strcmp(p[i].name, "through") != 0)
            add_corner(corners, value->place);
        for (size_t c = 0; value->given && value->line && c < value->line->count; c++)
            add_corner(corners, value->line->corner[c]);
    }
}

static uint16_t read_label(enum gesture_kind kind, const struct call *call)
{
    const bool is_file = kind == GESTURE_SEED_FILE || kind == GESTURE_MAP;
    if (kind == GESTURE_ELIMINATOR)
        return GESTURE_ERASES;
    if (kind >= GESTURE_UNDO || (is_file && !call_has(call, "label")))
        return GESTURE_NO_LABEL;
    return (uint16_t)call_value(call, is_file ? "label" : "LABEL")->number;
}

/* ---- what a process hears ---- */

/* In the process of a journal: what it has heard so far. */
struct gesture_log {
    const struct side *expert;
    struct gesture *gesture;
    struct step *step;
    size_t count, capacity, steps, step_capacity;
    struct corners corners; /* of the last gesture */
    size_t points;          /* of the history, after the command before */
    uint64_t digest;        /* of the labels that these are counts of: */
    struct overlap overlap; /* A: labels as they are, B: those of the expert */
    bool is_counted;        /* B is */
    bool is_beyond;         /* there are more than there may be */
    bool has_no_memory;
};

static void hear_gesture(struct gesture_log *log, const struct interpreter *interp,
                         const struct call *call)
{
    const struct history *history = &interp->history;
    enum gesture_kind kind;
    if (!read_kind(&kind, call))
        return;
    const bool goes_on = log->count && kind <= GESTURE_STROKE && call_has(call, "joined");
    if (!goes_on && log->count == GESTURES_MOST) {
        log->is_beyond = true;
        return;
    }
    if (!mem_grow(&log->gesture, &log->capacity, log->count + 1, sizeof *log->gesture)) {
        log->has_no_memory = true;
        return;
    }
    if (!goes_on) {
        log->corners = (struct corners){.are_there = false};
        log->gesture[log->count++] =
            (struct gesture){.record = history->records,
                             .point = kind < GESTURE_UNDO ? history->present : POINT_NONE,
                             .label = read_label(kind, call),
                             .kind = (uint8_t)kind};
    }
    struct gesture *gesture = &log->gesture[log->count - 1];
    add_corners(&log->corners, call);
    gesture->kind = goes_on ? GESTURE_STROKE : gesture->kind;
    gesture->has_place = log->corners.are_there;
    for (int a = 0; a < 3; a++)
        gesture->doubled[a] = log->corners.first[a] + log->corners.last[a];
}

/* The labels follow the list of what the last edit has changed, if that leads to their digest: it
 * does not where all grew anew, and there is none. */
static bool follow(struct gesture_log *log, const struct forest *forest)
{
    const struct changes changes = forest_changes(forest);
    const struct grid *grid = &forest_scene(forest)->grid;
    struct overlap *o = &log->overlap;
    uint64_t digest = log->digest;
    for (size_t i = 0; i < changes.count; i++) {
        const struct change *c = &changes.item[i];
        digest += label_share(c->cell, c->label) - label_share(c->cell, c->former_label);
    }
    if (!log->is_counted || digest != forest_label_digest(forest))
        return false;
    for (size_t i = 0; i < changes.count; i++) {
        const struct change *c = &changes.item[i];
        const uint8_t wanted = log->expert->labels[grid_voxel(grid, c->cell)];
        o->a[c->former_label]--;
        o->a[c->label]++;
        o->both[wanted] -= c->former_label == wanted;
        o->both[wanted] += c->label == wanted;
    }
    return true;
}

static void count(struct gesture_log *log, const struct scene *scene)
{
    const struct labels labels = labels_of_forest(scene);
    const uint32_t *size = scene->grid.size;
    const uint8_t *wanted = log->expert->labels;
    uint8_t row[UINT16_MAX];
    log->overlap = (struct overlap){.voxels = 0};
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++, wanted += size[0]) {
            labels_copy_row(&labels, grid_row(&scene->grid, y, z), row);
            overlap_add(&log->overlap, row, wanted, size[0]);
        }
    log->is_counted = true;
}

static void add_step(struct gesture_log *log, uint64_t record)
{
    const struct overlap *o = &log->overlap;
    const struct overlap_counts sum = overlap_counts_of(o, 0);
    const struct overlap all = {.a = {sum.a}, .b = {sum.b}, .both = {sum.both}};
    if (!mem_grow(&log->step, &log->step_capacity, log->steps + 1, sizeof *log->step)) {
        log->has_no_memory = true;
        return;
    }
    struct step *step = &log->step[log->steps++];
    *step = (struct step){.record = record, .gestures = (uint32_t)log->count};
    for (unsigned l = 0; l < 256; l++)
        step->dice[l] = (uint16_t)overlap_dice(o, (uint8_t)l);
    step->dice[DICE_OF_ALL] = (uint16_t)overlap_dice(&all, 0);
}

static void hear_labels(struct gesture_log *log, const struct interpreter *interp)
{
    const struct session *session = interp->session;
    const struct forest *forest = session_forest(session);
    const bool is_same = forest_label_digest(forest) == log->digest;
    if (is_same || !same_size(log->expert->facts->size, session_scene(session)->grid.size))
        return;
    if (log->steps == STEPS_MOST) {
        log->is_beyond = true;
        return;
    }
    if (!follow(log, forest))
        count(log, session_scene(session));
    log->digest = forest_label_digest(forest);
    add_step(log, interp->history.records);
}

static void hear(void *context, const struct interpreter *interp, const struct reply *reply)
{
    struct gesture_log *log = context;
    struct call call;
    if (log->is_beyond || log->has_no_memory || !session_has_scene(interp->session))
        return;
    if (interp->history.points < log->points) /* a history of its own: of another scene */
        for (size_t i = 0; i < log->count; i++)
            log->gesture[i].is_taken_back |= log->gesture[i].point != POINT_NONE;
    log->points = interp->history.points;
    if (!command_parse(&call, buf_text(&reply->canonical), interp->session, NULL) && call.command)
        hear_gesture(log, interp, &call);
    call_release(&call);
    if (!log->is_beyond && !log->has_no_memory)
        hear_labels(log, interp);
}

static enum err note_what_stands(struct gesture_log *log, const struct history *history,
                                 struct fault *fault)
{
    bool *stands = mem_new(history->points);
    if (!stands)
        return fault_memory(fault, "gestures");
    for (uint32_t at = history->present; at != POINT_NONE; at = history->point[at].parent)
        stands[at] = true;
    for (size_t i = 0; i < log->count; i++)
        log->gesture[i].is_taken_back |=
            log->gesture[i].point != POINT_NONE && !stands[log->gesture[i].point];
    free(stands);
    return OK;
}

static enum err add(void *context, const struct interpreter *interp, const struct side_facts *facts,
                    const uint8_t *label, struct buf *out, struct fault *fault)
{
    struct gesture_log *log = context;
    const struct heading heading = {log->count, log->steps};
    (void)facts;
    (void)label;
    if (log->has_no_memory)
        return fault_memory(fault, "gestures");
    if (log->is_beyond)
        return fault_set(fault, ERR_LIMIT,
                         "there are more than %d gestures, or commands after which labels are "
                         "others; --until N carries out no record after N",
                         GESTURES_MOST);
    const enum err err = note_what_stands(log, &interp->history, fault);
    buf_add(out, &heading, sizeof heading);
    if (!err && log->count)
        buf_add(out, log->gesture, log->count * sizeof *log->gesture);
    if (!err && log->steps)
        buf_add(out, log->step, log->steps * sizeof *log->step);
    return err;
}

/* ---- from outside ---- */

/* What came back is of the form it should be, whatever has become of the process. */
static bool is_whole(struct gestures *gestures, const struct side *side)
{
    const struct heading *heading = side->more;
    const size_t length = side->facts->more;
    if (length < sizeof *heading || heading->gestures > GESTURES_MOST ||
        heading->steps > STEPS_MOST ||
        length != sizeof *heading + heading->gestures * sizeof(struct gesture) +
                      heading->steps * sizeof(struct step))
        return false;
    gestures->count = heading->gestures;
    gestures->steps = heading->steps;
    gestures->gesture = (const struct gesture *)(const void *)(heading + 1);
    gestures->step = (const struct step *)(const void *)(gestures->gesture + heading->gestures);
    for (size_t i = 0; i < gestures->count; i++) {
        const struct gesture *g = &gestures->gesture[i];
        bool is_inside = g->kind < GESTURE_KIND_COUNT && g->label <= GESTURE_NO_LABEL;
        for (int a = 0; a < 3; a++)
            is_inside &= !g->has_place || g->doubled[a] < 2 * side->facts->size[a];
        if (!is_inside)
            return false;
    }
    for (size_t i = 0; i < gestures->steps; i++)
        for (int l = 0; l <= DICE_OF_ALL; l++)
            if (gestures->step[i].dice[l] > DICE_ONE || gestures->step[i].gestures > GESTURES_MOST)
                return false;
    return true;
}

enum err gestures_carry_out(struct gestures *gestures, struct side *side, const char *path,
                            const struct side_options *options, const struct side *expert,
                            struct fault *fault)
{
    struct gesture_log log = {.expert = expert};
    const struct side_work work = {.context = &log,
                                   .hear = hear,
                                   .add = add,
                                   .most = sizeof(struct heading) +
                                           GESTURES_MOST * sizeof(struct gesture) +
                                           STEPS_MOST * sizeof(struct step)};
    const uint32_t *size = expert->facts->size;
    enum err err = side_carry_out(side, path, options, &work, fault);
    if (err)
        return err;
    if (!same_size(size, side->facts->size))
        return fault_set(fault, ERR_INPUT,
                         "%s: a scene of %ux%ux%u voxels, and the expert's has %ux%ux%u: expected "
                         "two of one size, whose labels can be compared",
                         path, side->facts->size[0], side->facts->size[1], side->facts->size[2],
                         size[0], size[1], size[2]);
    return is_whole(gestures, side)
               ? OK
               : fault_set(fault, ERR_INPUT, "%s: its process hands back what makes no sense",
                           path);
}
