/* SPDX-License-Identifier: MIT */
/* Change a session: go to a state, and recompute everything that does not fit it. */
#include "session/session.h"

#include <string.h>

#include "base/mem.h"
#include "base/sort.h"
#include "image/levels.h"
#include "session/session_inside.h"
#include "session/setting.h"

/* ---- weights ---- */

/* Place of the next weight of a map. */
struct filling {
    struct scene *scene;
    uint64_t rows; /* rows begun */
    struct span left;
};

static void fill_weights(void *context, const void *piece, size_t length)
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

/* Set the forest's arcs as the state says. */
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

static enum err compute_weights(struct session *session, struct fault *fault)
{
    const struct kept *kept = &session->now.kept;
    const struct arc_rule arcs = set_arcs(session);
    enum err err = OK;
    if (kept->weight_map)
        err = packed_read(kept->weight_map, fill_weights,
                          &(struct filling){.scene = session->scene}, session->watch, fault);
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
    return !session->skims && !kept_channels(kept) && weight_is_by_rows(&kept->weight) &&
           !kept->mask && !kept->has_range;
}

/* Make the cells, together with the weights if they can be computed in advance. */
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

void roi_range(struct roi *roi, const struct session *session, unsigned channel,
               const struct decimal range[2])
{
    const struct interval interval = session_within(session, channel, range);
    roi->low = interval.low;
    roi->high = interval.high;
    roi->channel = channel;
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
        roi_range(&session->roi, session, kept->range_channel, kept->range);
    session->roi_tally = roi_tally(&session->roi, session->scene);
    if (!was_none || !roi_is_none(&session->roi))
        roi_apply(&session->roi, session->scene);
    return err;
}

/* ---- the forest ---- */

/* Labels changed, extent unknown: recount. */
static void forget_labels(struct session *session)
{
    tally_forget(&session->tally);
    label_measures_forget(&session->inside->measures);
    if (session->pictures)
        session->inside->follower->forget_labels(session->pictures);
}

/* Update tally, measures, border and pictures after a change of the forest (S2). */
static void follow_forest(struct session *session)
{
    const struct changes changes = forest_changes(session->forest);
    tally_follow(&session->tally, &changes, session->watch);
    label_measures_follow(&session->inside->measures, &changes);
    if (!(session->inside->stale & MADE_BORDER))
        border_update(&session->border, &changes);
    if (watch_stops(session->watch))
        session->inside->stale |= MADE_BORDER;
    if (session->pictures)
        session->inside->follower->follow(session->pictures, &changes);
}

/* Edit seeds. A suspended forest changes its seeds only. */
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

static enum err recompute_forest(struct session *session, struct fault *fault)
{
    session->has_regrown = true;
    forget_labels(session);
    session->inside->stale &= ~(unsigned)MADE_BORDER; /* recomputed with the forest */
    enum err err = forest_catch_up(session->forest, fault);
    if (err)
        session->inside->stale |= MADE_BORDER;
    else
        follow_forest(session);
    return err;
}

/* ---- going to a state ---- */

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

/* Recompute one part if it is stale. Parts are called in the order of their dependence. */
static enum err recompute_part(struct session *session, unsigned part,
                               enum err (*how)(struct session *, struct fault *),
                               struct fault *fault)
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

/* Recompute stale parts, and edit the seeds in between. */
static enum err recompute_stale(struct session *session, const struct edit *seed, size_t seeds,
                                struct fault *fault)
{
    if (session->inside->waits)
        return OK;
    if (session->scene && session->scene->plain)
        TRY(make_cells(session, fault));
    if (session->inside->stale & (MADE_WEIGHTS | MADE_ROI) &&
        (seeds || forest_seeds(session->forest)))
        session->inside->stale |= MADE_FOREST;
    if (session->inside->stale & MADE_FOREST)
        forest_suspend(session->forest);
    if (session->inside->stale & MADE_ROI && seeds && !roi_is_none(&session->roi)) {
        /* Edited seeds may be outside the former region or the next one: edit them without a
         * region. */
        const struct roi open = roi_none();
        roi_apply(&open, session->scene);
    }
    if (seeds)
        TRY(edit_seeds(session, seed, seeds, fault));
    TRY(recompute_part(session, MADE_ROI, apply_region, fault));
    if (session->skims)
        return OK;
    TRY(recompute_part(session, MADE_WEIGHTS, compute_weights, fault));
    TRY(recompute_part(session, MADE_FOREST, recompute_forest, fault));
    TRY(recompute_part(session, MADE_BORDER, count_border, fault));
    return watch_fault(session->watch, fault);
}

/* Reserve memory before the first change. */
static enum err reserve_memory(struct session *session, const struct kept *kept, unsigned parts,
                               struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    if (kept->mask && !session->inside->mask_room) {
        session->inside->mask_room = mem_array(mask_bytes(grid), 1);
        if (!session->inside->mask_room)
            return fault_memory(fault, "a mask");
    }
    TRY(session_reserve_channels(session, kept, fault));
    if (parts & MADE_WEIGHTS && !kept->weight_map)
        return weight_work_reserve(&session->inside->weight_work, grid, &kept->weight, fault);
    return OK;
}

/* Apply a list of markers, without its first `from` items: only the items that set a marker, or
 * only those removing one. Any order is correct, since each marker is set once. */
static void apply_marker_list(struct markers *markers, struct edits list, size_t from,
                              bool is_valid)
{
    while (edits_count(&list) > from) {
        size_t count;
        const struct edit *item = edits_last(&list, &count);
        const size_t before = edits_count(&list);
        for (size_t i = from > before ? from - before : 0; i < count; i++)
            if ((item[i].label != EDIT_ERASE) == is_valid)
                markers->marker[item[i].cell - 1].is_valid = is_valid;
    }
}

/* Set `is_valid` of each marker as the state says: by the new items of the list, or from the
 * beginning if the state does not follow the present one. */
static void set_valid_markers(struct session *session, const struct edits *to)
{
    const struct edits *from = &session->now.lists.markers;
    const bool goes_on = from->room == to->room && from->end <= to->end;
    const size_t since = goes_on ? edits_count(from) : 0;
    for (size_t i = 0; !goes_on && i < session->markers.count; i++)
        session->markers.marker[i].is_valid = false;
    apply_marker_list(&session->markers, *to, since, true);
    apply_marker_list(&session->markers, *to, since, false);
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
        err = reserve_memory(session, &state->kept, parts, fault);
    if (err && aims)
        session_place(session, &session->now.kept);
    if (err)
        return err;
    set_valid_markers(session, &state->lists.markers);
    const bool swaps = session->has_scene && parts & MADE_CHANNELS &&
                       (session->scene->channels || kept_channels(&state->kept));
    if (swaps)
        session_take_channels_out(session);
    state_assign(&session->now, state);
    if (!session->has_scene)
        return OK;
    if (swaps)
        session_put_channels_in(session);
    if (aims && session->pictures)
        session->inside->follower->take_camera(session->pictures, &camera);
    if (parts & (MADE_BORDER | MADE_COLOURS)) {
        session_forget_pictures(session);
        kept_show(&state->kept, &session->border);
    }
    session->inside->stale = parts & ~(unsigned)(MADE_CAMERA | MADE_COLOURS | MADE_CHANNELS);
    return recompute_stale(session, seed, seeds, fault);
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
    return recompute_stale(session, NULL, 0, fault);
}

enum err session_complete(struct session *session, struct fault *fault)
{
    if (!session->inside->waits)
        return session->inside->stale && !session->skims && session->has_scene
                   ? recompute_stale(session, NULL, 0, fault)
                   : OK;
    session->inside->waits = false;
    const enum err err = recompute_stale(session, NULL, 0, fault);
    session->inside->waits = session->scene->plain != NULL;
    return err;
}

/* ---- settings that must be checked first ---- */

/* A copy of the state borrows shared memory. New memory in it is released once the session holds
 * it. */

static void set_words(char words[FILE_WORDS_BYTES], const char *name)
{
    memset(words, 0, FILE_WORDS_BYTES);
    memcpy(words, name, strnlen(name, FILE_WORDS_BYTES - 1));
}

enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault)
{
    struct state next = session->now;
    OWNED(packed_release) struct packed *map = NULL;
    TRY(packed_new(&map, weight, session->scene->grid.voxels * sizeof *weight, session->watch,
                   fault));
    next.kept.weight = (struct weight_choice){.kind = WEIGHT_FILE};
    next.kept.weight_map = map;
    set_words(next.kept.weight_file, name);
    return session_go(session, &next, NULL, 0, fault);
}

/* Count voxels outside the region where a run would plant a seed: the last edit of each voxel
 * decides. */
static enum err count_waiting(const struct roi *roi, const struct scene *scene,
                              const struct edit *pending, size_t pendings, size_t *waiting,
                              struct fault *fault)
{
    /* cell, and index of the edit */
    OWNED(mem_release) uint64_t *rank = mem_array(pendings, sizeof *rank);
    size_t count = 0;
    if (!rank)
        return fault_memory(fault, "a region of interest");
    for (size_t i = 0; i < pendings; i++)
        if (!roi_holds(roi, scene, pending[i].cell))
            rank[count++] = (uint64_t)pending[i].cell << 32 | i;
    TRY(sort_by_upper_half(rank, count, scene->watch, fault));
    *waiting = 0;
    for (size_t i = 0; i < count; i++)
        *waiting += pending[(uint32_t)rank[i]].label != EDIT_ERASE &&
                    (i + 1 == count || rank[i + 1] >> 32 != rank[i] >> 32);
    return OK;
}

/* Reject a region that contains no voxel, or excludes a seed: a planted one, or one that a run
 * of the pending edits would plant. */
static enum err check_region(const struct session *session, const struct roi *roi,
                             struct fault *fault)
{
    size_t waiting = 0;
    TRY(count_waiting(roi, session->scene, edits_first(&session->now.lists.pending),
                      session_pendings(session), &waiting, fault));
    const struct roi_tally tally = roi_tally(roi, session->scene);
    TRY(watch_fault(session->scene->watch, fault));
    if (!tally.inside)
        return fault_set(fault, ERR_INPUT,
                         "no voxel of the scene would be inside; nothing has changed");
    if (tally.seeds_outside || waiting)
        return fault_set(fault, ERR_INPUT,
                         "%zu planted and %zu pending seeds would be outside; remove them and run "
                         "first; nothing has changed",
                         tally.seeds_outside, waiting);
    return OK;
}

enum err session_set_mask(struct session *session, const uint64_t *mask, const char *name,
                          const uint32_t regions[2], const uint16_t *rest, struct fault *fault)
{
    const struct roi roi = {mask, session->roi.low, session->roi.high, session->roi.channel};
    struct state next = session->now;
    OWNED(packed_release) struct packed *packed = NULL, *packed_rest = NULL;
    TRY(check_region(session, &roi, fault));
    if (mask)
        TRY(packed_new(&packed, mask, mask_bytes(&session->scene->grid), session->watch, fault));
    if (rest)
        TRY(packed_new(&packed_rest, rest, session->scene->grid.voxels * sizeof *rest,
                       session->watch, fault));
    next.kept.mask = packed;
    next.kept.rest = packed_rest;
    set_words(next.kept.mask_file, mask ? name : "");
    for (int i = 0; i < 2; i++)
        next.kept.mask_regions[i] = mask ? regions[i] : 0;
    return session_go(session, &next, NULL, 0, fault);
}

enum err session_take_rest(const struct session *session, uint16_t **rest, struct fault *fault)
{
    const struct packed *packed = session->now.kept.rest;
    *rest = packed ? mem_array(session->scene->grid.voxels, sizeof **rest) : NULL;
    return !packed ? OK
           : *rest ? packed_take_out(packed, *rest, session->watch, fault)
                   : fault_memory(fault, "the regions that are kept");
}

enum err session_set_range(struct session *session, unsigned channel, const struct decimal range[2],
                           struct fault *fault)
{
    struct roi roi = {session->roi.mask, 0, UINT16_MAX, 0};
    struct state next = session->now;
    if (range)
        roi_range(&roi, session, channel, range);
    TRY(check_region(session, &roi, fault));
    next.kept.has_range = range != NULL;
    next.kept.range_channel = channel;
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
