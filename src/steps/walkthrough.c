/* SPDX-License-Identifier: MIT */
#include "steps/walkthrough.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "command/command.h"
#include "command/execute.h"
#include "engine/forest.h"
#include "engine/labels.h"
#include "command/limits.h"
#include "session/tally.h"

enum { SEEDS_DRAWN_MOST = 1 << 18 };

static struct session *session_of(const struct walkthrough *w)
{
    return w->interp->session;
}

/* ---- going to a state ---- */

/* How slices go through a voxel: what is magnified goes along. */
static void aim_at(struct slice_settings *slices, const uint32_t place[3])
{
    const bool is_there = memcmp(slices->cross, place, sizeof slices->cross) == 0;
    slices->has_middle = is_there && slices->has_middle;
    memcpy(slices->cross, place, sizeof slices->cross);
    if (!slices->has_middle)
        memset(slices->middle, 0, sizeof slices->middle);
}

/* To a point, seen so, with these lists in place of its own, or NULL. All or nothing. */
static enum err go_to(struct walkthrough *w, uint32_t point, const struct outlook *outlook,
                      const struct edit_lists *lists, struct fault *fault)
{
    struct session *session = session_of(w);
    struct history *history = &w->interp->history;
    const uint32_t present = history->present;
    session_mark(session);
    if (w->comes_back)
        watch_ignore_stop(session_watch(session));
    /* An interpolated scene has none of the points before. */
    enum err err = history_look(history, session, point < history->points ? point : 0, fault);
    struct state state = *session_state(session);
    state.outlook = *outlook;
    if (lists)
        state.lists = *lists;
    if (!err)
        err = session_go(session, &state, NULL, 0, fault);
    if (err) {
        session_rollback(session);
        history->present = present;
        return err;
    }
    session_settle(session);
    watch_begin(session_watch(session));
    return OK;
}

/* ---- what is known of a step ---- */

static bool has_points(const struct walkthrough *w)
{
    return session_has_scene(session_of(w)) && w->interp->history.points;
}

/* Before a record is carried out. */
static enum err note_before(struct walkthrough *w, struct fault *fault)
{
    if (!has_points(w))
        return OK;
    const enum err err = session_count_before(session_of(w), fault);
    memcpy(w->voxels, session_tally(session_of(w))->voxels, sizeof w->voxels);
    return err;
}

/* In the middle of a box or a polygon; else where the command says, as where a stroke begins. */
static bool take_place(const struct call *call, uint32_t place[3])
{
    const struct parameter *p = call->command->parameter;
    uint64_t sum[3] = {0}, count = 0;
    for (int i = 0; p[i].type; i++) {
        const struct value *value = call->value + i;
        if (p[i].type == VALUE_POSITION && value->given && !p[i].keyed) {
            for (int a = 0; a < 3; a++)
                sum[a] += value->place[a];
            count++;
        } else if (p[i].type == VALUE_LINE && value->given && !p[i].optional) {
            for (size_t c = 1; c < value->line->count; c++, count++) /* it begins with the place */
                for (int a = 0; a < 3; a++)
                    sum[a] += value->line->corner[c][a];
        }
    }
    for (int a = 0; count && a < 3; a++)
        place[a] = (uint32_t)(sum[a] / count);
    return count > 0;
}

static const struct value *label_of(const struct call *call)
{
    const struct parameter *p = call->command->parameter;
    for (int i = 0; p[i].type; i++)
        if (p[i].type == VALUE_LABEL && call->value[i].given && !p[i].keyed)
            return call->value + i;
    return NULL;
}

/* Where a command was, and what about, with the names that labels had before it. */
static void find_place(struct walkthrough *w, struct step_seen *seen, const char *line)
{
    struct kept kept = kept_settings_get(w->interp->history.point[seen->before].settings);
    struct call call;
    if (command_parse_by(&call, line, session_of(w), &kept, NULL) || !call.command)
        return;
    seen->command = call.command;
    const struct value *label = label_of(&call);
    seen->has_place = take_place(&call, seen->place);
    if (label && label->number >= 0)
        seen->label = (int)label->number;
    seen->is_ball = seen->has_place && label && call.command->flags & COMMAND_PLANTS;
    call_release(&call);
}

/* A way through the history was made where what it took back, or did again, is. */
static void borrow_place(const struct walkthrough *w, struct step_seen *seen)
{
    const struct history *history = &w->interp->history;
    const uint32_t from = seen->before > seen->after ? seen->before : seen->after;
    const size_t step = step_list_find(&w->list, history->point[from].record);
    const struct step_seen *of = walkthrough_seen(w, step);
    if (seen->before == seen->after || !of || seen->has_place)
        return;
    seen->has_place = of->has_place;
    memcpy(seen->place, of->place, sizeof seen->place);
    seen->label = of->label;
}

static enum err note_changes(struct walkthrough *w, struct step_seen *seen, struct fault *fault)
{
    struct session *session = session_of(w);
    const enum err err = session_count_labels(session, fault);
    const uint64_t *now = session_tally(session)->voxels;
    uint64_t gained = 0;
    seen->change = w->changes;
    for (unsigned label = 0; !err && label < 256; label++) {
        const int64_t voxels = (int64_t)now[label] - (int64_t)w->voxels[label];
        if (!voxels)
            continue;
        if (!mem_grow(&w->change, &w->change_capacity, w->changes + 1, sizeof *w->change))
            return fault_memory(fault, "what steps have changed");
        w->change[w->changes++] = (struct step_change){label, voxels};
        gained += voxels > 0 ? (uint64_t)voxels : 0;
    }
    seen->changes = w->changes - seen->change;
    const bool edited = session_has_edited(session) || session_has_regrown(session);
    const uint64_t changed = edited ? session_changed_voxels(session) : 0;
    seen->changed = changed == CHANGES_UNKNOWN || changed < gained ? gained : changed;
    return err;
}

static enum err note_after(struct walkthrough *w, uint32_t before, const struct outlook *outlook,
                           struct fault *fault)
{
    const struct step *step = w->list.step + w->done;
    struct step_seen seen = {.label = STEP_NO_LABEL, .outlook = *outlook};
    if (!mem_grow(&w->seen, &w->capacity, w->done + 1, sizeof *w->seen))
        return fault_memory(fault, "the steps of a journal");
    enum err err = OK;
    if (has_points(w)) {
        seen.after = w->interp->history.present;
        seen.before = before < w->interp->history.points ? before : seen.after;
        find_place(w, &seen, w->list.text.data + step->command);
        err = note_changes(w, &seen, fault);
        borrow_place(w, &seen);
    }
    if (!err)
        w->seen[w->done++] = seen;
    return err;
}

/* ---- carrying out ---- */

static enum err finish(struct walkthrough *w, enum err err)
{
    w->has_ended = true;
    w->ended = replay_end(&w->replay, err, &w->why);
    w->interp->replayed_words = NULL;
    return w->ended;
}

static enum err end_fault(const struct walkthrough *w, struct fault *fault)
{
    if (w->ended && fault)
        *fault = w->why;
    return w->ended;
}

/* The next record; the session is as the one before left it. */
static enum err carry_out(struct walkthrough *w, struct fault *fault)
{
    const bool had_scene = has_points(w);
    const uint32_t before = had_scene ? w->interp->history.present : 0;
    const struct outlook outlook = *session_outlook(session_of(w));
    enum err err = note_before(w, fault);
    if (err)
        return err;
    err = replay_next(&w->replay, &w->why);
    if (err == ERR_CANCELLED) {
        *fault = w->why;
        return err;
    }
    if (err || w->replay.is_over) {
        finish(w, err);
        return end_fault(w, fault);
    }
    const struct step *next = walkthrough_step(w, w->done + 1);
    if (next && next->record == w->replay.record.number) {
        watch_ignore_stop(session_watch(session_of(w))); /* the record has been carried out */
        err = note_after(w, before, &outlook, &w->why);
        watch_begin(session_watch(session_of(w)));
    }
    if (err) {
        finish(w, err);
        return end_fault(w, fault);
    }
    w->front = *session_outlook(session_of(w));
    w->present = has_points(w) ? w->interp->history.present : 0;
    return err;
}

/* As the last record left it (N1). */
static enum err return_to_front(struct walkthrough *w, struct fault *fault)
{
    return has_points(w) ? go_to(w, w->present, &w->front, NULL, fault) : OK;
}

/* Until so many steps have been carried out. */
static enum err reach(struct walkthrough *w, size_t steps, struct fault *fault)
{
    if (w->done >= steps)
        return OK;
    if (w->has_ended)
        return end_fault(w, fault);
    enum err err = return_to_front(w, fault);
    while (!err && w->done < steps && !w->has_ended)
        err = carry_out(w, fault);
    if (!err && w->done < steps)
        err = fault_set(fault, ERR_INPUT, "the journal ends before step %zu", steps);
    return err;
}

/* ---- showing ---- */

enum err walkthrough_seeds(const struct walkthrough *w, size_t step, struct edits *seeds,
                           struct fault *fault)
{
    const struct step_seen *seen = walkthrough_seen(w, step);
    *seeds = (struct edits){0};
    if (!seen || seen->before == seen->after)
        return OK;
    const struct point *after = w->interp->history.point + seen->after,
                       *before = w->interp->history.point + seen->before;
    const struct edits *waits = &after->lists.pending;
    const size_t waited = edits_count(&before->lists.pending);
    const bool ran = after->seeds > 0;
    const struct edit *edit = ran ? after->after : edits_first(waits) + waited;
    const size_t count = ran                            ? after->seeds
                         : edits_count(waits) >= waited ? edits_count(waits) - waited
                                                        : 0;
    enum err err = OK;
    if (after->parent != seen->before || count > SEEDS_DRAWN_MOST)
        return OK; /* a way through the history, or more than can be seen */
    for (size_t i = 0; !err && i < count; i++)
        if (edit[i].label != EDIT_ERASE)
            err = edits_add(seeds, edit[i], fault);
    if (err)
        edits_release(seeds);
    return err;
}

/* The lists of what is about to be done. */
static enum err draw_lists(const struct walkthrough *w, size_t step, struct edit_lists *lists,
                           struct edits *seeds, struct fault *fault)
{
    const struct step_seen *seen = walkthrough_seen(w, step);
    const struct history *history = &w->interp->history;
    *lists = history->point[seen->before].lists;
    enum err err = walkthrough_seeds(w, step, seeds, fault);
    if (edits_count(seeds))
        lists->pending = *seeds;
    if (seen->command && (seen->command->flags & COMMAND_PLANTS) && seen->before != seen->after) {
        lists->eliminators = history->point[seen->after].lists.eliminators;
        lists->applied = 0;
    }
    return err;
}

/* `own`, the view of who watches, stays unless the journal's has changed. */
static struct outlook outlook_for(struct walkthrough *w, const struct step_seen *seen,
                                  enum step_phase phase, const struct outlook *own)
{
    static const uint32_t nowhere[3];
    const struct slice_settings *recorded = &seen->outlook.slices;
    struct outlook compared = seen->outlook;
    compared.slices.has_middle = 0;
    aim_at(&compared.slices, nowhere);
    const bool follows = memcmp(&compared, &w->shown, sizeof compared) != 0;
    struct outlook out = follows ? seen->outlook : *own;
    w->shown = compared;
    out.runs_by_itself = seen->outlook.runs_by_itself;
    out.slices.marks = phase == STEP_DRAWN || recorded->marks;
    const bool has_moved = follows || memcmp(recorded->cross, w->cross, sizeof w->cross) != 0;
    memcpy(w->cross, recorded->cross, sizeof w->cross);
    if (seen->has_place || has_moved)
        aim_at(&out.slices, seen->has_place ? seen->place : recorded->cross);
    return out;
}

/* Labels as they are now: those before the step. */
static enum err keep_former(struct walkthrough *w, size_t step, struct fault *fault)
{
    const struct scene *scene = session_scene(session_of(w));
    if (w->cells != scene->grid.cells) {
        free(w->former);
        w->cells = 0;
        w->former = mem_array(scene->grid.cells, 1);
        if (!w->former)
            return fault_memory(fault, "the labels before a step");
        w->cells = scene->grid.cells;
    }
    const struct labels labels = labels_of_forest(scene);
    labels_copy_row(&labels, (struct span){0, (uint32_t)scene->grid.cells}, w->former);
    w->former_of = step;
    return OK;
}

const uint8_t *walkthrough_former(const struct walkthrough *w)
{
    return w->at && w->phase == STEP_AFTER && w->former_of == w->at ? w->former : NULL;
}

static enum err show(struct walkthrough *w, size_t of, enum step_phase phase,
                     const struct outlook *own, struct fault *fault)
{
    const struct step_seen *seen = walkthrough_seen(w, of);
    const struct outlook outlook = phase == STEP_HIDDEN ? *own : outlook_for(w, seen, phase, own);
    struct edit_lists lists;
    struct edits seeds = {0};
    enum err err = phase == STEP_DRAWN ? draw_lists(w, of, &lists, &seeds, fault) : OK;
    if (!err)
        err = go_to(w, phase == STEP_AFTER ? seen->after : seen->before, &outlook,
                    phase == STEP_DRAWN ? &lists : NULL, fault);
    if (!err && phase != STEP_AFTER && w->former_of != of && seen->changed)
        err = keep_former(w, of, fault);
    edits_release(&seeds);
    return err;
}

enum err walkthrough_show(struct walkthrough *w, size_t step, enum step_phase phase,
                          struct fault *fault)
{
    const struct outlook own = *session_outlook(session_of(w)), shown = w->shown;
    const size_t was = w->at ? w->at : 1;
    limits_rest(false);
    phase = step ? phase : STEP_BEFORE;
    enum err err = reach(w, step ? step : 1, fault);
    if (!err)
        err = show(w, step ? step : 1, phase, &own, fault);
    if (!err) {
        w->at = step;
        w->phase = phase;
    } else if (w->is_shown) {
        w->shown = shown;
        w->comes_back = true;
        show(w, was, w->phase, &own, NULL);
        w->comes_back = false;
    }
    w->is_shown |= !err;
    limits_rest(true);
    return err;
}

enum err walkthrough_finish(struct walkthrough *w, struct fault *fault)
{
    const struct outlook outlook = *session_outlook(session_of(w));
    if (w->has_ended)
        return end_fault(w, fault);
    limits_rest(false);
    enum err err = return_to_front(w, fault);
    while (!err && !w->has_ended)
        err = carry_out(w, fault);
    w->comes_back = true;
    if (w->is_shown)
        show(w, w->at ? w->at : 1, w->phase, &outlook, NULL);
    w->comes_back = false;
    limits_rest(true);
    return err;
}

/* ---- begin and end ---- */

enum err walkthrough_begin(struct walkthrough *w, struct interpreter *interp, const char *path,
                           struct fault *fault)
{
    *w = (struct walkthrough){.interp = interp, .replaying = {.interp = interp}};
    w->host = replay_file_host(&w->replaying);
    enum err err = replay_file_begin(interp, path, &w->bytes, fault);
    if (!err)
        err = step_list_read(&w->list, buf_text(&w->bytes), w->bytes.length, fault);
    if (!err && !w->list.count)
        err = fault_set(fault, ERR_INPUT, "there is no step in this journal: nothing was planted");
    if (!err)
        err = replay_begin(&w->replay, buf_text(&w->bytes), w->bytes.length, &w->host, &w->options,
                           &w->report, fault);
    w->has_begun = !err;
    while (!err && !w->has_ended && (!w->done || !has_points(w)))
        err = carry_out(w, fault);
    if (!err && !has_points(w))
        err = fault_set(fault, ERR_INPUT, "this journal opens no scene");
    return err;
}

void walkthrough_release(struct walkthrough *w)
{
    if (w->has_begun && !w->has_ended)
        finish(w, ERR_CANCELLED);
    replay_report_release(&w->report);
    step_list_release(&w->list);
    buf_release(&w->bytes);
    free(w->seen);
    free(w->change);
    free(w->former);
}
