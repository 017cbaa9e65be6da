/* SPDX-License-Identifier: MIT */
/* The one way to change a session: going to a state, and making anew what does not fit it. */
#include "session/session.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/sort.h"
#include "image/levels.h"
#include "session/session_inside.h"
#include "session/setting.h"

/* ---- weights ---- */

/* Where the next weight of a map goes. */
struct filling {
    struct scene *scene;
    uint64_t rows; /* begun so far */
    struct span left;
};

static void fill(void *context, const void *piece, size_t length)
{
    struct filling *filling = context;
    const struct grid *grid = &filling->scene->grid;
    const uint16_t *weight = piece;
    for (size_t i = 0; i < length / sizeof *weight; i++) {
        if (filling->left.first == filling->left.end) {
            filling->left = grid_row(grid, (uint32_t)(filling->rows % grid->size[1]),
                                     (uint32_t)(filling->rows / grid->size[1]));
            filling->rows++;
        }
        filling->scene->cell[filling->left.first++].weight = weight[i];
    }
}

/* The forest's arcs, as the state says. */
static struct arc_rule set_arcs(struct session *session)
{
    const struct kept *kept = &session->now.kept;
    struct arc_rule arcs = {.kind = weight_arcs(kept->weight.kind)};
    for (int label = 0; label < 256; label++)
        arcs.polarity[label] = kept->polarity[label];
    forest_set_adjacency(session->forest, kept->adjacency);
    forest_set_arcs(session->forest, &arcs);
    return arcs;
}

static enum err weigh(struct session *session, struct fault *fault)
{
    const struct kept *kept = &session->now.kept;
    const struct arc_rule arcs = set_arcs(session);
    enum err err = OK;
    if (kept->weight_map)
        err = packed_read(kept->weight_map, fill, &(struct filling){.scene = session->scene},
                          session->watch, fault);
    else
        weight_compute(session->scene, forest_adjacency(session->forest), &kept->weight,
                       &session->inside->weight_work);
    session->weight_digest = weight_digest(session->scene, &arcs, session->team);
    return err ? err : watch_fault(session->watch, fault);
}

/* ---- the cells of a plain scene ---- */

bool session_may_wait(const struct session *session)
{
    const struct kept *kept = &session->now.kept;
    return !session->skims && weight_is_by_rows(&kept->weight) && !kept->mask && !kept->has_range;
}

/* Together with the weights, where these can be told. */
static enum err make_cells(struct session *session, struct fault *fault)
{
    const struct weight_choice *weight = &session->now.kept.weight;
    if (session->skims || !weight_is_by_rows(weight)) {
        scene_make_cells(session->scene, session->team, NULL, NULL);
        return watch_fault(session->watch, fault);
    }
    set_arcs(session);
    session->weight_digest =
        weight_make_cells(session->scene, forest_adjacency(session->forest), weight, session->team);
    if (!session->scene->plain)
        session->inside->stale &= ~(unsigned)MADE_WEIGHTS;
    return watch_fault(session->watch, fault);
}

enum err session_foretell(struct session *session, struct fault *fault)
{
    set_arcs(session);
    session->weight_digest = weight_plain_digest(session->scene, forest_adjacency(session->forest),
                                                 &session->now.kept.weight, session->team);
    return watch_fault(session->watch, fault);
}

/* ---- the region of interest ---- */

void roi_range(struct roi *roi, const struct geometry *geometry, const struct levels *levels,
               const struct decimal range[2])
{
    const struct interval interval = levels_within(geometry, levels, range);
    roi->low = interval.low;
    roi->high = interval.high;
}

static enum err apply_region(struct session *session, struct fault *fault)
{
    const struct kept *kept = &session->now.kept;
    const bool was_none = roi_is_none(&session->roi);
    enum err err = OK;
    session->roi = roi_none();
    if (kept->mask) {
        session->roi.mask = session->inside->mask_room;
        err = packed_take_out(kept->mask, session->inside->mask_room, session->watch, fault);
    }
    if (kept->has_range)
        roi_range(&session->roi, &session->geometry, session->levels, kept->range);
    session->roi_tally = roi_tally(&session->roi, session->scene);
    if (!was_none || !roi_is_none(&session->roi))
        roi_apply(&session->roi, session->scene);
    return err;
}

/* ---- the forest ---- */

/* Labels are others in a way that no list says. */
static void forget_labels(struct session *session)
{
    tally_forget(&session->tally);
    label_measures_forget(&session->inside->measures);
    if (session->pictures)
        session->inside->follower->forget_labels(session->pictures);
}

/* Tally, measures, border and pictures after a change of the forest (S2). */
static void follow_forest(struct session *session)
{
    const struct changes changes = forest_changes(session->forest);
    tally_follow(&session->tally, &changes, session->watch);
    label_measures_follow(&session->inside->measures, &changes);
    if (!(session->inside->stale & MADE_BORDER)) /* it was, where the run was shown */
        border_update(&session->border, &changes);
    if (watch_stops(session->watch))
        session->inside->stale |= MADE_BORDER;
    if (session->pictures)
        session->inside->follower->follow(session->pictures, &changes);
}

/* A forest that is to grow anew, or is not wanted yet, has its seeds changed and no more. */
static enum err edit_seeds(struct session *session, const struct edit *seed, size_t seeds,
                           struct fault *fault)
{
    enum err err = forest_edit(session->forest, seed, seeds, fault);
    if (err && forest_is_suspended(session->forest))
        session->inside->stale |= MADE_FOREST;
    if (err)
        return err;
    session->has_edited = true;
    if (forest_is_suspended(session->forest))
        forget_labels(session);
    else
        follow_forest(session);
    return OK;
}

static enum err grow(struct session *session, struct fault *fault)
{
    session->has_regrown = true;
    forget_labels(session);
    session->inside->stale &= ~(unsigned)MADE_BORDER; /* all of it is made anew with the forest */
    enum err err = forest_catch_up(session->forest, fault);
    if (err)
        session->inside->stale |= MADE_BORDER;
    else
        follow_forest(session);
    return err;
}

/* ---- going ---- */

enum err session_aim(const struct session *session, const struct outlook *outlook,
                     struct camera *camera, struct fault *fault)
{
    const uint32_t samples = outlook->look.samples;
    struct view fine = outlook->view; /* `samples` pixels for each of its own, along both sides */
    fine.width *= samples;
    fine.height *= samples;
    fine.zoom *= samples;
    return camera_init(camera, session->scene, &fine, fault);
}

/* One part after the other, in the order in which they follow from each other. */
static enum err make(struct session *session, unsigned part,
                     enum err (*how)(struct session *, struct fault *), struct fault *fault)
{
    if (!(session->inside->stale & part))
        return OK;
    session->inside->stale &= ~part;
    enum err err = how(session, fault);
    err = err ? err : watch_fault(session->watch, fault);
    session->inside->stale |= err ? part : 0;
    return err;
}

static enum err count_border(struct session *session, struct fault *fault)
{
    (void)fault;
    border_recount(&session->border);
    return OK;
}

/* Makes anew what is stale; seeds are changed on the way. */
static enum err follow(struct session *session, const struct edit *seed, size_t seeds,
                       struct fault *fault)
{
    enum err err = OK;
    if (session->inside->waits)
        return OK;
    if (session->scene && session->scene->plain)
        err = make_cells(session, fault);
    if (err)
        return err;
    if (session->inside->stale & (MADE_WEIGHTS | MADE_ROI) &&
        (seeds || forest_seeds(session->forest)))
        session->inside->stale |= MADE_FOREST;
    if (session->inside->stale & MADE_FOREST)
        forest_suspend(session->forest);
    if (session->inside->stale & MADE_ROI && seeds && !roi_is_none(&session->roi)) {
        /* Seeds that come or go may lie outside the former region, or the coming one: they are
         * changed while there is none. */
        const struct roi open = roi_none();
        roi_apply(&open, session->scene);
    }
    if (seeds)
        err = edit_seeds(session, seed, seeds, fault);
    if (!err)
        err = make(session, MADE_ROI, apply_region, fault);
    if (err || session->skims)
        return err;
    err = make(session, MADE_WEIGHTS, weigh, fault);
    if (!err)
        err = make(session, MADE_FOREST, grow, fault);
    if (!err)
        err = make(session, MADE_BORDER, count_border, fault);
    return err ? err : watch_fault(session->watch, fault);
}

/* All that can fail for want of room. */
static enum err make_room(struct session *session, const struct kept *kept, unsigned parts,
                          struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    if (kept->mask && !session->inside->mask_room) {
        session->inside->mask_room = mem_array(mask_bytes(grid), 1);
        if (!session->inside->mask_room)
            return fault_memory(fault, "a mask");
    }
    if (parts & MADE_WEIGHTS && !kept->weight_map)
        return weight_work_reserve(&session->inside->weight_work, grid, &kept->weight, fault);
    return OK;
}

/* Of a list of markers, without its first `from` items: those that put up one, or those that take
 * one away, in any order, since each is put up once. */
static void toggle(struct markers *markers, struct edits list, size_t from, bool stands)
{
    while (edits_count(&list) > from) {
        size_t count;
        const struct edit *item = edits_last(&list, &count);
        const size_t before = edits_count(&list);
        for (size_t i = from > before ? from - before : 0; i < count; i++)
            if ((item[i].label != EDIT_ERASE) == stands)
                markers->marker[item[i].cell - 1].stands = stands;
    }
}

/* Those stand that the state says: what was added to the list since, or all of it anew where the
 * state is not one that follows the present one. */
static void stand(struct session *session, const struct edits *to)
{
    const struct edits *from = &session->now.lists.markers;
    const bool goes_on = from->room == to->room && from->end <= to->end;
    const size_t since = goes_on ? edits_count(from) : 0;
    for (size_t i = 0; !goes_on && i < session->markers.count; i++)
        session->markers.marker[i].stands = false;
    toggle(&session->markers, *to, since, true);
    toggle(&session->markers, *to, since, false);
}

enum err session_go(struct session *session, const struct state *state, const struct edit *seed,
                    size_t seeds, struct fault *fault)
{
    const unsigned parts = session->inside->stale | state_difference(&session->now, state);
    const bool aims = session->has_scene && parts & MADE_CAMERA;
    struct camera camera;
    if (aims)
        session_place(session, &state->kept);
    enum err err = aims ? session_aim(session, &state->outlook, &camera, fault) : OK;
    if (!err && session->has_scene)
        err = make_room(session, &state->kept, parts, fault);
    if (err && aims)
        session_place(session, &session->now.kept);
    if (err)
        return err;
    stand(session, &state->lists.markers);
    state_assign(&session->now, state);
    if (!session->has_scene)
        return OK;
    if (aims && session->pictures)
        session->inside->follower->take_camera(session->pictures, &camera);
    if (parts & (MADE_BORDER | MADE_COLOURS)) {
        session_forget_pictures(session);
        kept_show(&state->kept, &session->border);
    }
    session->inside->stale = parts & ~(unsigned)(MADE_CAMERA | MADE_COLOURS);
    return follow(session, seed, seeds, fault);
}

void session_skim(struct session *session)
{
    session->skims = true;
    session_forget_pictures(session);
    session->inside->stale |= MADE_FOREST;
    forest_suspend(session->forest);
}

enum err session_catch_up(struct session *session, struct fault *fault)
{
    if (!session->skims)
        return OK;
    session->skims = false;
    return follow(session, NULL, 0, fault);
}

enum err session_complete(struct session *session, struct fault *fault)
{
    if (!session->inside->waits)
        return session->inside->stale && !session->skims && session->has_scene
                   ? follow(session, NULL, 0, fault)
                   : OK;
    session->inside->waits = false;
    const enum err err = follow(session, NULL, 0, fault);
    session->inside->waits = session->scene->plain != NULL;
    return err;
}

/* ---- settings that take more than a change of the state ---- */

/* A copy of it borrows what it shares with the present one; what is new in it is released once the
 * session holds it. */

static void set_words(char words[FILE_WORDS_BYTES], const char *name)
{
    memset(words, 0, FILE_WORDS_BYTES);
    memcpy(words, name, strnlen(name, FILE_WORDS_BYTES - 1));
}

enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault)
{
    struct state next = session->now;
    struct packed *map;
    enum err err = packed_new(&map, weight, session->scene->grid.voxels * sizeof *weight,
                              session->watch, fault);
    if (err)
        return err;
    next.kept.weight = (struct weight_choice){.kind = WEIGHT_FILE};
    next.kept.weight_map = map;
    set_words(next.kept.weight_file, name);
    err = session_go(session, &next, NULL, 0, fault);
    packed_release(map);
    return err;
}

/* Voxels outside where a run would plant a seed: the last edit of each decides. */
static enum err count_waiting(const struct roi *roi, const struct scene *scene,
                              const struct edit *pending, size_t pendings, size_t *waiting,
                              struct fault *fault)
{
    uint64_t *rank = mem_array(pendings, sizeof *rank); /* cell and place among the edits */
    size_t count = 0;
    if (!rank)
        return fault_memory(fault, "a region of interest");
    for (size_t i = 0; i < pendings; i++)
        if (!roi_holds(roi, scene, pending[i].cell))
            rank[count++] = (uint64_t)pending[i].cell << 32 | i;
    const enum err err = sort_by_upper_half(rank, count, scene->watch, fault);
    *waiting = 0;
    for (size_t i = 0; !err && i < count; i++)
        *waiting += pending[(uint32_t)rank[i]].label != EDIT_ERASE &&
                    (i + 1 == count || rank[i + 1] >> 32 != rank[i] >> 32);
    free(rank);
    return err;
}

/* Nothing may be inside that no voxel is, nor seeds be outside: those planted in the scene, and
 * those that a run of the pending edits, in their order, would plant. */
static enum err check_region(const struct session *session, const struct roi *roi,
                             struct fault *fault)
{
    size_t waiting = 0;
    enum err err = count_waiting(roi, session->scene, edits_first(&session->now.lists.pending),
                                 session_pendings(session), &waiting, fault);
    if (err)
        return err;
    const struct roi_tally tally = roi_tally(roi, session->scene);
    err = watch_fault(session->scene->watch, fault);
    if (err)
        return err;
    if (!tally.inside)
        return fault_set(fault, ERR_INPUT,
                         "no voxel of the scene would be inside; nothing has changed");
    if (tally.seeds_outside || waiting)
        return fault_set(fault, ERR_INPUT,
                         "%zu planted and %zu waiting seeds would be outside; remove them and run "
                         "first; nothing has changed",
                         tally.seeds_outside, waiting);
    return OK;
}

enum err session_set_mask(struct session *session, const uint64_t *mask, const char *name,
                          const uint32_t regions[2], struct fault *fault)
{
    const struct roi roi = {mask, session->roi.low, session->roi.high};
    struct state next = session->now;
    struct packed *packed = NULL;
    enum err err = check_region(session, &roi, fault);
    if (!err && mask)
        err = packed_new(&packed, mask, mask_bytes(&session->scene->grid), session->watch, fault);
    if (err)
        return err;
    next.kept.mask = packed;
    set_words(next.kept.mask_file, mask ? name : "");
    for (int i = 0; i < 2; i++)
        next.kept.mask_regions[i] = mask ? regions[i] : 0;
    err = session_go(session, &next, NULL, 0, fault);
    packed_release(packed);
    return err;
}

enum err session_set_range(struct session *session, const struct decimal range[2],
                           struct fault *fault)
{
    struct roi roi = {session->roi.mask, 0, UINT16_MAX};
    struct state next = session->now;
    if (range)
        roi_range(&roi, &session->geometry, session->levels, range);
    enum err err = check_region(session, &roi, fault);
    if (err)
        return err;
    next.kept.has_range = range != NULL;
    for (int i = 0; i < 2; i++)
        next.kept.range[i] = range ? range[i] : (struct decimal){0, 0, 0};
    return session_go(session, &next, NULL, 0, fault);
}

enum err session_set_view(struct session *session, const struct view *view, struct fault *fault)
{
    struct state next = session->now;
    next.outlook.view = *view;
    return session_go(session, &next, NULL, 0, fault);
}
