/* SPDX-License-Identifier: MIT */
#include "session/history.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "session/session_inside.h"
#include "session/setting.h"

/* ---- settings of the points, stored compactly ---- */

/* struct kept has about 43 kB, and a command changes a few bytes of it. So points share a
 * *ground*, a whole struct kept, and store only pieces that differ from it; with too many pieces, a
 * point has a ground of its own, which shares the equal blocks of the one before. Maps as large as
 * the scene are held (kept_hold). */
enum {
    KEPT_PIECE = 64,
    KEPT_BLOCK = 16 * KEPT_PIECE,
    PIECES = (sizeof(struct kept) + KEPT_PIECE - 1) / KEPT_PIECE,
    BLOCKS = (sizeof(struct kept) + KEPT_BLOCK - 1) / KEPT_BLOCK,
    PIECES_MOST = 16, /* beyond this, a ground of its own */
};

struct block {
    size_t holders;
    uint8_t bytes[KEPT_BLOCK];
};

struct ground {
    size_t holders;
    struct block *block[BLOCKS];
};

struct piece {
    uint16_t number;
    uint8_t bytes[KEPT_PIECE];
};

struct kept_settings {
    size_t holders;
    struct ground *ground;
    unsigned pieces;
    struct piece piece[];
};

_Static_assert(PIECES <= UINT16_MAX, "the number of a piece");

/* Bytes of the piece or block at `at`; the last one is shorter. */
static size_t extent(size_t at, size_t whole)
{
    const size_t left = sizeof(struct kept) - at;
    return left < whole ? left : whole;
}

/* Find the pieces in which settings differ from a ground, PIECES_MOST at most, and return their
 * number, or one more. */
static unsigned find_pieces(uint16_t number[PIECES_MOST], const struct ground *ground,
                            const struct kept *kept)
{
    unsigned found = 0;
    for (unsigned n = 0; n < PIECES && found <= PIECES_MOST; n++) {
        const size_t at = (size_t)n * KEPT_PIECE;
        const struct block *block = ground->block[at / KEPT_BLOCK];
        if (memcmp(block->bytes + at % KEPT_BLOCK, (const char *)kept + at,
                   extent(at, KEPT_PIECE)) == 0)
            continue;
        if (found < PIECES_MOST)
            number[found] = (uint16_t)n;
        found++;
    }
    return found;
}

static void ground_drop(struct ground *ground)
{
    if (--ground->holders > 0)
        return;
    for (unsigned b = 0; b < BLOCKS; b++)
        if (ground->block[b] && --ground->block[b]->holders == 0)
            free(ground->block[b]);
    free(ground);
}

/* Make a ground with one holder; NULL without memory. `like` is a similar one, or NULL. */
static struct ground *ground_new(const struct ground *like, const struct kept *kept)
{
    struct ground *ground = mem_new(sizeof *ground);
    if (!ground)
        return NULL;
    ground->holders = 1;
    for (unsigned b = 0; b < BLOCKS; b++) {
        const char *bytes = (const char *)kept + (size_t)b * KEPT_BLOCK;
        const size_t length = extent((size_t)b * KEPT_BLOCK, KEPT_BLOCK);
        const bool is_shared = like && memcmp(like->block[b]->bytes, bytes, length) == 0;
        ground->block[b] = is_shared ? like->block[b] : mem_new(sizeof **ground->block);
        if (!ground->block[b]) {
            ground_drop(ground);
            return NULL;
        }
        ground->block[b]->holders++;
        if (!is_shared)
            memcpy(ground->block[b]->bytes, bytes, length);
    }
    return ground;
}

/* Make settings with one holder; NULL without memory. They are immutable and counted: each
 * holder drops them once. `like` is similar settings, or NULL. */
static struct kept_settings *kept_settings_new(const struct kept_settings *like,
                                               const struct kept *kept)
{
    uint16_t number[PIECES_MOST];
    struct ground *ground = like ? like->ground : NULL;
    unsigned pieces = ground ? find_pieces(number, ground, kept) : PIECES_MOST + 1;
    if (pieces > PIECES_MOST) {
        ground = ground_new(ground, kept);
        pieces = 0;
    } else {
        ground->holders++;
    }
    struct kept_settings *settings =
        ground ? mem_new(sizeof *settings + pieces * sizeof *settings->piece) : NULL;
    if (!settings) {
        if (ground)
            ground_drop(ground);
        return NULL;
    }
    settings->holders = 1;
    settings->ground = ground;
    settings->pieces = pieces;
    for (unsigned i = 0; i < pieces; i++) {
        settings->piece[i].number = number[i];
        const size_t at = (size_t)number[i] * KEPT_PIECE;
        memcpy(settings->piece[i].bytes, (const char *)kept + at, extent(at, KEPT_PIECE));
    }
    kept_hold(kept);
    return settings;
}

static void kept_settings_drop(struct kept_settings *settings)
{
    if (!settings || --settings->holders > 0)
        return;
    struct kept kept = kept_settings_get(settings);
    kept_release(&kept);
    ground_drop(settings->ground);
    free(settings);
}

struct kept kept_settings_get(const struct kept_settings *settings)
{
    struct kept kept;
    for (size_t at = 0; at < sizeof kept; at += KEPT_BLOCK)
        memcpy((char *)&kept + at, settings->ground->block[at / KEPT_BLOCK]->bytes,
               extent(at, KEPT_BLOCK));
    for (unsigned i = 0; i < settings->pieces; i++) {
        const size_t at = (size_t)settings->piece[i].number * KEPT_PIECE;
        memcpy((char *)&kept + at, settings->piece[i].bytes, extent(at, KEPT_PIECE));
    }
    return kept;
}

/* ---- creation and release ---- */

static void point_release(struct point *point)
{
    free(point->command);
    free(point->after);
    free(point->before);
    kept_settings_drop(point->settings);
    edit_lists_release(&point->lists);
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

/* Count a map at the first point that has it, and shared memory in equal parts. */
static size_t point_memory(const struct point *point, const struct point *parent)
{
    const struct kept kept = kept_settings_get(point->settings),
                      before = parent ? kept_settings_get(parent->settings) : (struct kept){0};
    size_t bytes = 2 * point->seeds * sizeof(struct edit) + strlen(point->command) + 1;
    const struct kept_settings *settings = point->settings; /* without the maps: */
    size_t ground = sizeof *settings->ground;
    for (unsigned b = 0; b < BLOCKS; b++)
        ground += sizeof(struct block) / settings->ground->block[b]->holders;
    bytes += (sizeof *settings + settings->pieces * sizeof *settings->piece +
              ground / settings->ground->holders) /
             settings->holders;
    bytes += edit_lists_memory(&point->lists);
    bytes += before.mask == kept.mask ? 0 : packed_memory(kept.mask);
    bytes += before.rest == kept.rest ? 0 : packed_memory(kept.rest);
    bytes += before.weight_map == kept.weight_map ? 0 : packed_memory(kept.weight_map);
    return bytes;
}

size_t history_memory(const struct history *history)
{
    size_t bytes = history->point_capacity * sizeof *history->point +
                   history->at_capacity * sizeof *history->at +
                   history->branch_capacity * sizeof *history->branch;
    for (size_t i = 0; i < history->points; i++) {
        const struct point *point = history->point + i;
        bytes += point_memory(point, i ? history->point + point->parent : NULL);
    }
    return bytes;
}

/* ---- ways between points ---- */

/* The point before all of a stroke. */
static uint32_t parent_of(const struct history *history, uint32_t at)
{
    while (history->point[at].joins)
        at = history->point[at].parent;
    return history->point[at].parent;
}

/* The point after `at` for redo: on the present branch, otherwise the one visited last. */
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

/* The last point of the next stroke. */
static uint32_t next_of(const struct history *history, uint32_t at)
{
    uint32_t next = child_of(history, at), on = next;
    while (on != POINT_NONE && (on = child_of(history, on)) != POINT_NONE &&
           history->point[on].joins)
        next = on;
    return next;
}

enum err history_step(const struct history *history, bool back, size_t *count, uint32_t *point,
                      struct fault *fault)
{
    const size_t wanted = *count;
    *point = history->present;
    for (*count = 0; *count < wanted; ++*count) {
        const uint32_t next = (back ? parent_of : next_of)(history, *point);
        if (next == POINT_NONE)
            break;
        *point = next;
    }
    return *count ? OK
                  : fault_set(fault, ERR_INPUT,
                              back ? "there is nothing to undo since the scene was opened"
                                   : "there is nothing to do again");
}

/* Index of the branch with this name; history->branches if no branch has it. */
static uint32_t branch_named(const struct history *history, const char *name)
{
    uint32_t i = 0;
    while (i < history->branches && strcmp(history->branch[i].name, name) != 0)
        i++;
    return i;
}

enum err history_find(const struct history *history, const char *name, uint32_t *point,
                      uint32_t *branch, struct fault *fault)
{
    int64_t number;
    const char *rest = name;
    *branch = branch_named(history, name);
    if (*branch < history->branches) {
        *point = history->branch[*branch].point;
        return OK;
    }
    if (!scan_integer(&rest, 0, INT64_MAX, &number) || *rest)
        return fault_set(fault, ERR_INPUT,
                         "there is no branch %s: expected the number of a record or a branch, "
                         "which `history` lists",
                         name);
    if ((uint64_t)number < history->first || (uint64_t)number > history->records)
        return fault_set(fault, ERR_INPUT,
                         "expected a record %zu..%zu, or a branch, not %s; `history` lists them",
                         history->first, history->records, name);
    *point = history->at[(size_t)number - history->first];
    *branch = history->point[*point].branch;
    return OK;
}

const struct kept_settings *history_settings_after(const struct history *history, size_t record)
{
    const size_t since = record < history->first ? 0 : record - history->first;
    const uint32_t point = since < history->ats ? history->at[since] : 0; /* the root precedes it */
    return history->points ? history->point[point].settings : NULL;
}

/* Find the common ancestor of two points. A point has a greater number than its parent. */
static uint32_t fork_of(const struct history *history, uint32_t a, uint32_t b)
{
    while (a != b)
        if (a > b)
            a = history->point[a].parent;
        else
            b = history->point[b].parent;
    return a;
}

static size_t seeds_on_way(const struct history *history, uint32_t from, uint32_t top)
{
    size_t count = 0;
    for (; from != top; from = history->point[from].parent)
        count += history->point[from].seeds;
    return count;
}

/* False if the task is stopped. */
static bool copy_edits(struct edit *to, const struct edit *from, size_t count, struct task *task)
{
    enum { AT_ONCE = 1 << 16 };
    for (size_t i = 0; i < count; i += AT_ONCE) {
        const size_t part = count - i < AT_ONCE ? count - i : AT_ONCE;
        memcpy(to + i, from + i, part * sizeof *to);
        if (!task_advance(task, part))
            return false;
    }
    return true;
}

/* Collect the edits of seeds that lead from the present point to another: undo those of the way
 * up, the last first, then do those of the way down, the first first. The caller frees *out, even
 * on errors. */
static enum err edits_of_way(struct edit **out, size_t *count, const struct history *history,
                             uint32_t to, struct watch *watch, struct fault *fault)
{
    const uint32_t top = fork_of(history, history->present, to);
    const size_t up = seeds_on_way(history, history->present, top);
    *count = up + seeds_on_way(history, to, top);
    struct edit *edit = *out = mem_array(*count + 1, sizeof *edit);
    if (!edit)
        return fault_memory(fault, "a way through the history");
    struct task task = task_begin(watch, "edits", *count);
    size_t filled = 0, left = *count;
    bool goes_on = true;
    for (uint32_t p = history->present; goes_on && p != top; p = history->point[p].parent) {
        const struct point *point = history->point + p;
        goes_on = copy_edits(edit + filled, point->before, point->seeds, &task);
        filled += point->seeds;
    }
    for (uint32_t p = to; goes_on && p != top; p = history->point[p].parent) {
        const struct point *point = history->point + p;
        left -= point->seeds;
        goes_on = copy_edits(edit + left, point->after, point->seeds, &task);
    }
    assert(!goes_on || (filled == up && left == up));
    return goes_on ? OK : watch_fault(watch, fault);
}

enum err history_go(struct history *history, struct session *session, uint32_t to, uint32_t branch,
                    bool moves_tip, struct fault *fault)
{
    const struct point *there = history->point + to;
    struct state state = session->now;
    OWNED(mem_release) struct edit *edit = NULL;
    size_t seeds;
    enum err err = edits_of_way(&edit, &seeds, history, to, session->watch, fault);
    state.kept = kept_settings_get(there->settings);
    state.lists = there->lists;
    if (!err)
        err = session_go(session, &state, edit, seeds, fault);
    history->goes_to = to;
    history->goes_on = branch;
    history->moves_tip = moves_tip;
    return err;
}

enum err history_look(struct history *history, struct session *session, uint32_t point,
                      struct fault *fault)
{
    const enum err err = history_go(history, session, point, history->on, false, fault);
    history->goes_to = POINT_NONE;
    if (!err)
        history->present = point;
    return err;
}

enum err history_branch(struct history *history, const char *name, struct fault *fault)
{
    if (branch_named(history, name) < history->branches)
        return fault_set(fault, ERR_USAGE, "there is a branch %s already; `goto %s` leads there",
                         name, name);
    if (!mem_grow(&history->branch, &history->branch_capacity, history->branches + 1,
                  sizeof *history->branch))
        return fault_memory(fault, "a branch");
    struct branch *branch = history->branch + history->branches; /* not counted yet */
    *branch = (struct branch){.point = history->present};
    memcpy(branch->name, name, strnlen(name, BRANCH_NAME_BYTES - 1));
    history->goes_to = history->present;
    history->goes_on = (uint32_t)history->branches;
    history->moves_tip = true;
    return OK;
}

/* ---- commands ---- */

static enum err keep_seeds(struct point *point, const struct session *session, struct fault *fault)
{
    const struct seed_changes seeds = forest_seed_changes(session->forest);
    struct task task = task_begin(session->watch, "edits", 2 * seeds.count);
    point->seeds = seeds.count;
    point->after = mem_array(seeds.count, sizeof *point->after);
    point->before = mem_array(seeds.count, sizeof *point->before);
    if (seeds.count && (!point->after || !point->before))
        return fault_memory(fault, "the history");
    return copy_edits(point->after, seeds.after, seeds.count, &task) &&
                   copy_edits(point->before, seeds.before, seeds.count, &task)
               ? OK
               : watch_fault(session->watch, fault);
}

/* Note no point if the command left the segmentation unchanged. */
static enum err note_point(struct history *history, const struct session *session,
                           struct fault *fault)
{
    struct kept_settings *before = history->point[history->present].settings;
    const struct state *now = &session->now;
    struct point *point = &history->noted;
    const struct kept kept = kept_settings_get(before);
    const bool sets = !kept_equals(&now->kept, &kept);
    if (!sets && !session->has_edited && edit_lists_are_copies(&now->lists, &session->former.lists))
        return OK;
    point->parent = history->present;
    point->branch = history->on;
    point->settings = sets ? kept_settings_new(before, &now->kept) : before;
    before->holders += !sets;
    point->lists = now->lists;
    edit_lists_hold(&point->lists);
    point->plants = session->markers.count == session->former_markers + 1;
    point->joins = point->plants && session->markers.marker[session->former_markers].joined;
    if (!point->settings)
        return fault_memory(fault, "the history");
    return session->has_edited ? keep_seeds(point, session, fault) : OK;
}

enum err history_note(struct history *history, const struct session *session, const char *command,
                      struct fault *fault)
{
    history->is_noted = true;
    if (!session->has_scene)
        return OK;
    if (!session->inside->former_has_scene || session->inside->former_scene.scene) {
        struct point *root = &history->noted;
        const bool lacks =
            !mem_grow(&history->branch, &history->branch_capacity, 1, sizeof *history->branch);
        history->is_root = true;
        root->parent = POINT_NONE;
        root->settings = kept_settings_new(NULL, &session->now.kept);
        root->lists = session->now.lists;
        edit_lists_hold(&root->lists);
        if (lacks || !root->settings)
            return fault_memory(fault, "the history");
    } else if (history->goes_to == POINT_NONE)
        TRY(note_point(history, session, fault));
    struct point *point = &history->noted;
    if (point->settings) {
        const size_t bytes = strlen(command) + 1;
        point->latest = POINT_NONE;
        point->record = history->records + 1;
        point->command = mem_array(bytes, 1);
        if (!point->command || !mem_grow(&history->point, &history->point_capacity,
                                         history->points + 1, sizeof *history->point))
            return fault_memory(fault, "the history");
        memcpy(point->command, command, bytes);
    }
    return mem_grow(&history->at, &history->at_capacity, history->ats + 1, sizeof *history->at)
               ? OK
               : fault_memory(fault, "the history");
}

bool history_moves(const struct history *history)
{
    return history->is_root || history->noted.settings || history->goes_to != POINT_NONE;
}

void history_settle(struct history *history, bool is_final)
{
    if (is_final && history->is_noted) {
        history->records++;
        if (history->is_root) { /* it replaces the whole former tree */
            forget_points(history);
            history->first = history->records;
            history->branch[0] = (struct branch){.name = "main"};
            history->branches = 1;
            history->on = 0;
        }
        if (history->noted.settings) {
            /* The noted point becomes the present one. */
            const uint32_t next = (uint32_t)history->points++;
            history->point[next] = history->noted;
            history->noted = (struct point){0};
            if (history->point[next].parent != POINT_NONE)
                history->point[history->present].latest = next;
            history->present = next;
            history->branch[history->on].point = next;
        } else if (history->goes_to != POINT_NONE) {
            /* Let redo lead to `point` from every point on the way to it. */
            const uint32_t point = history->goes_to, branch = history->goes_on;
            const uint32_t top = fork_of(history, history->present, point);
            for (uint32_t p = point; p != top; p = history->point[p].parent)
                history->point[history->point[p].parent].latest = p;
            history->present = point;
            history->on = branch;
            if (branch == history->branches)
                history->branches++; /* a new branch */
            if (history->moves_tip)
                history->branch[branch].point = point;
        }
        if (history->points)
            history->at[history->ats++] = history->present;
    }
    point_release(&history->noted);
    history->is_noted = history->is_root = false;
    history->goes_to = POINT_NONE;
}

/* ---- forgotten commands ---- */

struct history_place history_place(const struct history *history)
{
    return (struct history_place){.points = history->points,
                                  .ats = history->ats,
                                  .records = history->records,
                                  .present = history->present,
                                  .latest = history->point[history->present].latest,
                                  .tip = history->branch[history->on].point};
}

void history_forget(struct history *history, const struct history_place *place)
{
    while (history->points > place->points)
        point_release(&history->point[--history->points]);
    history->ats = place->ats;
    history->records = place->records;
    history->present = place->present;
    history->point[place->present].latest = place->latest;
    history->branch[history->on].point = place->tip;
    history->goes_to = POINT_NONE;
}
