#include "session/history.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"

/* ---- life ---- */

static void settings_drop(struct kept_settings *kept)
{
    if (kept && --kept->holders == 0)
        free(kept);
}

static void point_release(struct point *point)
{
    free(point->command);
    free(point->appended);
    free(point->after);
    free(point->before);
    free(point->eliminator);
    settings_drop(point->settings);
    packed_release(point->mask);
    packed_release(point->weights);
    *point = (struct point){0};
}

void history_init(struct history *history)
{
    *history = (struct history){.goes_to = POINT_NONE};
}

static void forget_points(struct history *history)
{
    for (size_t i = 0; i < history->points; i++)
        point_release(history->point + i);
    history->points = history->ats = 0;
}

void history_release(struct history *history)
{
    history_settle(history, false);
    forget_points(history);
    free(history->point);
    free(history->at);
    free(history->branch);
    *history = (struct history){0};
}

static size_t point_memory(const struct point *point)
{
    size_t bytes = (point->appendeds + 2 * point->seeds) * sizeof(struct edit) +
                   point->eliminators * sizeof(uint32_t) + strlen(point->command) + 1;
    bytes += point->settings->holders ? sizeof *point->settings / point->settings->holders : 0;
    return bytes;
}

size_t history_memory(const struct history *history)
{
    size_t bytes = history->point_capacity * sizeof *history->point +
                   history->at_capacity * sizeof *history->at +
                   history->branch_capacity * sizeof *history->branch;
    for (size_t i = 0; i < history->points; i++) {
        const struct point *point = history->point + i;
        const struct point *parent = i ? history->point + point->parent : NULL;
        bytes += point_memory(point);
        if (point->mask && (!parent || parent->mask != point->mask))
            bytes += packed_memory(point->mask);
        if (point->weights && (!parent || parent->weights != point->weights))
            bytes += packed_memory(point->weights);
    }
    return bytes;
}

/* ---- ways ---- */

enum err history_before(const struct history *history, size_t count, uint32_t *point,
                        struct fault *fault)
{
    *point = history->present;
    for (size_t i = 0; i < count; i++) {
        const uint32_t parent = history->point[*point].parent;
        if (parent == POINT_NONE && i == 0)
            return fault_set(fault, ERR_INPUT,
                             "there is nothing to undo since the scene was opened");
        if (parent == POINT_NONE)
            return fault_set(fault, ERR_INPUT,
                             "only %zu commands can be undone, not %zu; nothing has changed", i,
                             count);
        *point = parent;
    }
    return OK;
}

/* Where redo leads from a point: along the branch one is on, and else the way one came. */
static uint32_t child_of(const struct history *history, uint32_t at)
{
    uint32_t child = history->point[at].latest;
    if (child == POINT_NONE || history->point[child].branch == history->on)
        return child;
    for (uint32_t i = (uint32_t)history->points - 1; i > at; i--)
        if (history->point[i].parent == at && history->point[i].branch == history->on)
            return i;
    return child;
}

enum err history_after(const struct history *history, size_t count, uint32_t *point,
                       struct fault *fault)
{
    *point = history->present;
    for (size_t i = 0; i < count; i++) {
        const uint32_t child = child_of(history, *point);
        if (child == POINT_NONE && i == 0)
            return fault_set(fault, ERR_INPUT, "there is nothing to do again");
        if (child == POINT_NONE)
            return fault_set(fault, ERR_INPUT,
                             "only %zu commands can be done again, not %zu; nothing has changed", i,
                             count);
        *point = child;
    }
    return OK;
}

enum err history_find(const struct history *history, const char *name, uint32_t *point,
                      uint32_t *branch, struct fault *fault)
{
    int64_t number;
    const char *rest = name;
    for (uint32_t i = 0; i < history->branches; i++)
        if (strcmp(history->branch[i].name, name) == 0) {
            *point = history->branch[i].point;
            *branch = i;
            return OK;
        }
    if (!scan_integer(&rest, 0, INT64_MAX, &number) || *rest)
        return fault_set(fault, ERR_INPUT,
                         "there is no branch %s: expected the number of a record or a branch, "
                         "which `history` tells",
                         name);
    if ((uint64_t)number < history->first || (uint64_t)number > history->records)
        return fault_set(fault, ERR_INPUT,
                         "expected a record %zu..%zu, or a branch, not %s; `history` tells them",
                         history->first, history->records, name);
    *point = history->at[(size_t)number - history->first];
    *branch = history->point[*point].branch;
    return OK;
}

static uint32_t depth(const struct history *history, uint32_t point)
{
    uint32_t steps = 0;
    for (; history->point[point].parent != POINT_NONE; steps++)
        point = history->point[point].parent;
    return steps;
}

/* What two points both come from. */
static uint32_t fork_of(const struct history *history, uint32_t a, uint32_t b)
{
    uint32_t deep_a = depth(history, a), deep_b = depth(history, b);
    while (a != b) {
        if (deep_a >= deep_b) {
            a = history->point[a].parent;
            deep_a--;
        } else {
            b = history->point[b].parent;
            deep_b--;
        }
    }
    return a;
}

static size_t seeds_on_way(const struct history *history, uint32_t from, uint32_t top)
{
    size_t count = 0;
    for (; from != top; from = history->point[from].parent)
        count += history->point[from].seeds;
    return count;
}

/* The edits of seeds that lead from the present point to another: those of the way up are taken
 * back, the last one first; those of the way down are done again, the first one first. NULL when
 * out of memory. */
static struct edit *edits_of_way(const struct history *history, uint32_t to, size_t *count)
{
    const uint32_t top = fork_of(history, history->present, to);
    const size_t up = seeds_on_way(history, history->present, top);
    *count = up + seeds_on_way(history, to, top);
    struct edit *edit = mem_array(*count + 1, sizeof *edit);
    size_t filled = 0, left = *count;
    for (uint32_t p = history->present; edit && p != top; p = history->point[p].parent) {
        const struct point *point = history->point + p;
        for (size_t i = 0; i < point->seeds; i++)
            edit[filled++] = point->before[i];
    }
    for (uint32_t p = to; edit && p != top; p = history->point[p].parent) {
        const struct point *point = history->point + p;
        left -= point->seeds;
        for (size_t i = 0; i < point->seeds; i++)
            edit[left + i] = point->after[i];
    }
    assert(!edit || (filled == up && left == up));
    return edit;
}

/* The edits that wait at a point: of all commands since the last run. */
static enum err list_pending(const struct history *history, uint32_t at, struct state *state,
                             struct fault *fault)
{
    size_t count = 0;
    uint32_t p;
    for (p = at; p != POINT_NONE && !history->point[p].ran; p = history->point[p].parent)
        count += history->point[p].appendeds;
    state->pendings = count;
    state->pending = mem_array(count + 1, sizeof *state->pending);
    if (!state->pending)
        return fault_memory(fault, "the edits that waited");
    for (p = at; p != POINT_NONE && !history->point[p].ran; p = history->point[p].parent) {
        const struct point *point = history->point + p;
        count -= point->appendeds;
        for (size_t i = 0; i < point->appendeds; i++)
            state->pending[count + i] = point->appended[i];
    }
    return OK;
}

/* The eliminators from `at` up to and with the last run, or to `top`; counts them where `out` is
 * NULL, else fills what ends at `end`. Where that run was. */
static uint32_t eliminators_since(const struct history *history, uint32_t at, bool with_run,
                                  uint32_t *out, size_t *count)
{
    size_t end = *count;
    if (!out)
        *count = 0;
    for (; at != POINT_NONE; at = history->point[at].parent) {
        const struct point *point = history->point + at;
        if (point->ran && !with_run)
            break;
        with_run = false;
        for (size_t i = point->eliminators; i-- > 0 && out;)
            out[--end] = point->eliminator[i];
        *count += out ? 0 : point->eliminators;
    }
    return at;
}

static enum err list_eliminators(const struct history *history, uint32_t at, struct state *state,
                                 struct fault *fault)
{
    size_t waits = 0, applied = 0;
    const uint32_t run = eliminators_since(history, at, false, NULL, &waits);
    if (run != POINT_NONE)
        eliminators_since(history, run, true, NULL, &applied);
    state->waiting = applied;
    state->eliminators = applied + waits;
    state->eliminator = mem_array(state->eliminators + 1, sizeof *state->eliminator);
    if (!state->eliminator)
        return fault_memory(fault, "eliminators");
    eliminators_since(history, at, false, state->eliminator + applied, &waits);
    if (run != POINT_NONE)
        eliminators_since(history, run, true, state->eliminator, &applied);
    return OK;
}

static enum err take_out_mask(const struct point *point, const struct session *session,
                              struct state *state, struct fault *fault)
{
    state->has_mask = true;
    if (!point->mask)
        return OK;
    state->mask = mask_new(&session->scene->grid);
    if (!state->mask)
        return fault_memory(fault, "a mask");
    return packed_take_out(point->mask, state->mask, fault);
}

static enum err take_out_weights(const struct point *point, uint16_t **weight, struct state *state,
                                 struct fault *fault)
{
    *weight = mem_array(packed_length(point->weights), 1);
    if (!*weight)
        return fault_memory(fault, "weights");
    state->has_weights = true;
    state->weight = *weight;
    return packed_take_out(point->weights, *weight, fault);
}

enum err history_go(struct history *history, struct session *session, uint32_t to, uint32_t branch,
                    struct fault *fault)
{
    const struct point *here = history->point + history->present, *there = history->point + to;
    struct state state = {.settings = &there->settings->settings};
    uint16_t *weight = NULL;
    struct edit *edit = edits_of_way(history, to, &state.seeds);
    state.seed = edit;
    enum err err = edit ? OK : fault_memory(fault, "a way through the history");
    if (!err)
        err = list_pending(history, to, &state, fault);
    if (!err)
        err = list_eliminators(history, to, &state, fault);
    if (!err && there->mask != here->mask)
        err = take_out_mask(there, session, &state, fault);
    if (!err && there->weights && there->weights != here->weights)
        err = take_out_weights(there, &weight, &state, fault);
    if (!err) {
        err = session_restore(session, &state, fault);
        history->goes_to = to;
        history->goes_on = branch;
    } else {
        free(state.pending);
        free(state.eliminator);
        free(state.mask);
    }
    free(weight);
    free(edit);
    return err;
}

enum err history_branch(struct history *history, const char *name, struct fault *fault)
{
    for (size_t i = 0; i < history->branches; i++)
        if (strcmp(history->branch[i].name, name) == 0)
            return fault_set(fault, ERR_USAGE,
                             "there is a branch %s already; `goto %s` leads there", name, name);
    if (!mem_grow(&history->branch, &history->branch_capacity, history->branches + 1,
                  sizeof *history->branch))
        return fault_memory(fault, "a branch");
    struct branch *branch = history->branch + history->branches; /* not counted yet */
    *branch = (struct branch){.point = history->present};
    memcpy(branch->name, name, strnlen(name, BRANCH_NAME_BYTES - 1));
    history->goes_to = history->present;
    history->goes_on = (uint32_t)history->branches;
    return OK;
}

/* ---- commands ---- */

/* A copy of `count` items; NULL for none, or when out of memory, which *lacks says then. */
static void *copy_of(const void *items, size_t count, size_t size, bool *lacks)
{
    void *copy = count ? mem_array(count, size) : NULL;
    if (copy)
        memcpy(copy, items, count * size);
    *lacks |= count && !copy;
    return copy;
}

static bool changed_settings(const struct session *session)
{
    return memcmp((const char *)&session->settings + SETTINGS_KEPT,
                  (const char *)&session->mark + SETTINGS_KEPT,
                  sizeof session->settings - SETTINGS_KEPT) != 0;
}

static struct kept_settings *keep_settings(const struct session *session, bool *lacks)
{
    struct kept_settings *kept = mem_new(sizeof *kept);
    *lacks |= !kept;
    if (kept) {
        kept->holders = 1;
        kept->settings = session->settings;
    }
    return kept;
}

static struct packed *keep_mask(const struct session *session, bool *lacks)
{
    if (!session->roi.mask)
        return NULL;
    struct packed *mask = packed_new(session->roi.mask, mask_bytes(&session->scene->grid));
    *lacks |= !mask;
    return mask;
}

static struct packed *keep_weights(const struct session *session, bool *lacks)
{
    const size_t voxels = session->scene->grid.voxels;
    uint16_t *weight = mem_array(voxels, sizeof *weight);
    struct packed *weights = NULL;
    if (weight) {
        weight_copy(weight, session->scene);
        weights = packed_new(weight, voxels * sizeof *weight);
    }
    free(weight);
    *lacks |= !weights;
    return weights;
}

/* What the command did, in `point`. Whether it did anything. */
static bool describe(struct point *point, const struct session *session, bool *lacks)
{
    const size_t end = session->applied ? session->applied : session->pendings;
    const struct eliminators *e = &session->eliminators;
    point->ran = session->applied > 0;
    point->appendeds = end - session->mark_pendings;
    point->appended = copy_of(session->pending + session->mark_pendings, point->appendeds,
                              sizeof *point->appended, lacks);
    point->eliminators = e->end - e->mark[2];
    point->eliminator =
        copy_of(e->cell + e->mark[2], point->eliminators, sizeof *point->eliminator, lacks);
    if (point->ran) {
        const struct seed_changes seeds = forest_seed_changes(session->forest);
        point->seeds = seeds.count;
        point->after = copy_of(seeds.after, seeds.count, sizeof *seeds.after, lacks);
        point->before = copy_of(seeds.before, seeds.count, sizeof *seeds.before, lacks);
    }
    return point->ran || point->appendeds || point->eliminators;
}

/* The state that the command led to, where it is another than that of the point before. */
static bool describe_state(struct point *point, const struct point *before,
                           const struct session *session, bool *lacks)
{
    const bool sets = changed_settings(session);
    const bool excludes = session->roi_changed && session->roi.mask != session->mark_roi.mask;
    const bool reads = session->read_weights;
    if (sets || excludes || reads)
        point->settings = keep_settings(session, lacks);
    else {
        point->settings = before->settings;
        point->settings->holders++;
    }
    point->mask = excludes ? keep_mask(session, lacks) : packed_hold(before->mask);
    if (reads)
        point->weights = keep_weights(session, lacks);
    else if (session->settings.weight.kind == WEIGHT_FILE)
        point->weights = packed_hold(before->weights);
    return sets || excludes || reads;
}

static enum err note_root(struct history *history, const struct session *session,
                          struct fault *fault)
{
    struct point *root = &history->noted;
    bool lacks = !mem_grow(&history->branch, &history->branch_capacity, 1, sizeof *history->branch);
    history->is_root = true;
    root->parent = POINT_NONE;
    root->settings = keep_settings(session, &lacks);
    return lacks ? fault_memory(fault, "the history") : OK;
}

static enum err note_point(struct history *history, const struct session *session,
                           struct fault *fault)
{
    struct point *point = &history->noted;
    bool lacks = false;
    point->parent = history->present;
    point->branch = history->on;
    const bool did = describe(point, session, &lacks);
    const bool led = describe_state(point, history->point + history->present, session, &lacks);
    if (!did && !led)
        point_release(point);
    return lacks ? fault_memory(fault, "the history") : OK;
}

enum err history_note(struct history *history, const struct session *session, const char *command,
                      struct fault *fault)
{
    enum err err = OK;
    history->is_noted = true;
    if (!session->has_scene)
        return OK;
    if (!session->mark_has_scene || session->former.scene)
        err = note_root(history, session, fault);
    else if (history->goes_to == POINT_NONE)
        err = note_point(history, session, fault);
    if (err)
        return err;
    struct point *point = &history->noted;
    if (point->settings) {
        bool lacks = false;
        point->latest = POINT_NONE;
        point->record = history->records + 1;
        point->command = copy_of(command, strlen(command) + 1, 1, &lacks);
        if (lacks || !mem_grow(&history->point, &history->point_capacity, history->points + 1,
                               sizeof *history->point))
            return fault_memory(fault, "the history");
    }
    if (!mem_grow(&history->at, &history->at_capacity, history->ats + 1, sizeof *history->at))
        return fault_memory(fault, "the history");
    return OK;
}

/* The root takes the place of all that was. */
static void begin_anew(struct history *history)
{
    forget_points(history);
    history->first = history->records;
    history->branch[0] = (struct branch){.name = "main"};
    history->branches = 1;
    history->on = 0;
}

/* Redo leads to `point` from wherever it has left the way to the present one. */
static void arrive(struct history *history, uint32_t point, uint32_t branch)
{
    const uint32_t top = fork_of(history, history->present, point);
    for (uint32_t p = point; p != top; p = history->point[p].parent)
        history->point[history->point[p].parent].latest = p;
    history->present = point;
    history->on = branch;
    if (branch == history->branches)
        history->branches++; /* a new one */
    history->branch[branch].point = point;
}

/* What was noted is the present point from now on. */
static void advance(struct history *history)
{
    const uint32_t next = (uint32_t)history->points++;
    history->point[next] = history->noted;
    history->noted = (struct point){0};
    if (history->point[next].parent != POINT_NONE)
        history->point[history->present].latest = next;
    history->present = next;
    history->branch[history->on].point = next;
}

static void stand(struct history *history)
{
    history->records++;
    if (history->is_root)
        begin_anew(history);
    if (history->noted.settings)
        advance(history);
    else if (history->goes_to != POINT_NONE)
        arrive(history, history->goes_to, history->goes_on);
    if (history->points)
        history->at[history->ats++] = history->present;
}

void history_settle(struct history *history, bool stands)
{
    if (stands && history->is_noted)
        stand(history);
    point_release(&history->noted);
    history->is_noted = history->is_root = false;
    history->goes_to = POINT_NONE;
}
