/* SPDX-License-Identifier: MIT */
#include "session/session.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "engine/margin.h"
#include "session/session_inside.h"
#include "session/setting.h"

/*
 * Answers about labels: counts, finished labels, measures and hints. They are computed on demand
 * and stored until the labels change. An edit spends no noticeable time on them.
 */

/* ---- voxels ---- */

enum err session_count_labels(struct session *session, struct fault *fault)
{
    const struct labels labels = labels_of_forest(session->scene);
    return tally_refresh(&session->tally, &labels, session->team)
               ? OK
               : watch_fault(session->scene->watch, fault);
}

enum err session_count_before(struct session *session, struct fault *fault)
{
    TRY(session_count_labels(session, fault));
    session->former_tally = session->tally;
    return OK;
}

const uint64_t *session_voxels_before_edit(const struct session *session)
{
    const struct tally *before = session->has_edited || session->has_regrown
                                     ? &session->former_tally
                                     : &session->inside->tally_before_edit;
    return before->stale || session->tally.stale ? NULL : before->voxels;
}

/* ---- intensities ---- */

void session_find_window(struct session *session, int32_t window[2])
{
    static uint32_t count[UINT16_MAX + 1];
    if (!session->inside->knows_window) {
        intensities_count(count, session->scene, session->team);
        intensities_range(session->inside->window, count, WINDOW_BLACK, WINDOW_WHITE);
    }
    session->inside->knows_window = true;
    memcpy(window, session->inside->window, sizeof session->inside->window);
}

/* ---- finished labels ---- */

void finished_release(struct finished *finished)
{
    mem_pages_free(finished->label, finished->cells);
    *finished = (struct finished){0};
}

uint64_t session_finish_source(const struct session *session)
{
    const uint32_t *size = session->scene->grid.size;
    const struct finish_list *by = &session->now.kept.finish;
    const uint64_t keys = finish_uses_seeds(by) ? forest_digest(session->forest) : 0;
    const uint64_t roi = finish_uses_seeds(by) ? session->roi_tally.digest : 0;
    uint64_t mix = hash_mix_at(forest_label_digest(session->forest), keys);
    mix = hash_mix_at(hash_mix_at(mix, roi), (uint64_t)size[0] << 32 | size[1]);
    mix = hash_mix_at(mix, size[2]);
    for (unsigned i = 0; i < kept_channels(&session->now.kept); i++)
        mix = hash_mix_at(mix, channel_values_digest(session->now.kept.channel[i].values) ^
                                   session->now.kept.channel[i].percent);
    mix = session->scene->channels ? hash_mix_at(mix, session->now.kept.percent) : mix;
    for (size_t i = 0; i < sizeof *by; i++)
        mix = hash_mix_at(mix, ((const uint8_t *)by)[i]);
    return mix | 1;
}

const uint8_t *session_finished(const struct session *session)
{
    if (!session->has_scene)
        return NULL;
    struct finished *made = &session->inside->finished, *former = &session->inside->former_finished;
    const uint64_t of = session_finish_source(session);
    if (former->label && former->of == of) {
        const struct finished other = *made;
        *made = *former;
        *former = other;
    }
    return made->label && made->of == of ? made->label : NULL;
}

static enum err make_finished(struct session *session, struct fault *fault)
{
    struct finished *kept = &session->inside->finished, *former = &session->inside->former_finished;
    OWNED(finished_release)
    struct finished made = {.cells = session->scene->grid.cells,
                            .of = session_finish_source(session)};
    finished_release(former);
    TRY(finish_make(&made.label, &session->now.kept.finish, session->scene, session->team,
                    &session->inside->relaxed, fault));
    made.digest = labels_digest(&(struct labels){session->scene, made.label}, session->team);
    TRY(watch_fault(session->scene->watch, fault));
    *former = *kept;
    *kept = made;
    made = (struct finished){0};
    return OK;
}

enum err session_labels(struct session *session, bool finished, struct labels *labels,
                        struct fault *fault)
{
    *labels = labels_of_forest(session->scene);
    if (!finished || !session->now.kept.finish.count)
        return OK;
    TRY(session_finished(session) ? OK : make_finished(session, fault));
    labels->finished = session->inside->finished.label;
    return OK;
}

uint64_t session_finished_digest(const struct session *session)
{
    return session->now.kept.finish.count ? session->inside->finished.digest
                                          : forest_label_digest(session->forest);
}

/* ---- measures ---- */

enum err session_find_stats(struct session *session, const struct labels *labels,
                            struct label_stats *stats, struct fault *fault)
{
    OWNED(label_measures_release) struct label_measures once = {0};
    struct label_measures *measures = labels->finished ? &once : &session->inside->measures;
    return label_stats_find(stats, measures, labels, session->team, fault);
}

enum err session_sum_label(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault)
{
    const struct labels labels = labels_of_forest(session->scene);
    return label_measures_sum(&session->inside->measures, &labels, label, session->team, sums,
                              fault);
}

/* ---- comparison with a procedure ---- */

enum err session_find_worst(struct session *session, unsigned *label, double *share,
                            struct fault *fault)
{
    const uint32_t *expected = session->now.kept.origin_mm3;
    const double voxel_mm3 = tally_voxel_mm3(&session->geometry);
    TRY(session_count_labels(session, fault));
    double worst = 0;
    *label = 0;
    *share = 1;
    for (unsigned l = 1; l < 256; l++) {
        const double now = (double)session->tally.voxels[l] * voxel_mm3 / (expected[l] + 1.0);
        const double off = now > 1 ? now : 1 / (now + 1e-9);
        if (!expected[l] || off <= worst)
            continue;
        *label = l;
        *share = now;
        worst = off;
    }
    return OK;
}

/* Put places at the border of the worst label first; keep the order otherwise. */
static enum err put_worst_first(struct hint_list *hints, struct session *session,
                                struct fault *fault)
{
    unsigned worst;
    double share;
    TRY(session_find_worst(session, &worst, &share, fault));
    size_t first = 0;
    for (size_t i = 0; worst && i < hints->count; i++) {
        const struct hint hint = hints->item[i];
        if (hint.label != worst && hint.other != worst)
            continue;
        memmove(hints->item + first + 1, hints->item + first, (i - first) * sizeof hint);
        hints->item[first++] = hint;
    }
    return OK;
}

/* ---- hints ---- */

static void hinting_release(struct hinting *hinting)
{
    hints_release(&hinting->hints);
    free(hinting->heat);
    *hinting = (struct hinting){0};
}

static enum err make_hints(struct session *session, bool with_heat, struct fault *fault)
{
    struct hinting *h = &session->inside->hinting;
    OWNED(mem_release) uint16_t *margin = NULL;
    enum err err = margin_new(&margin, session->forest, fault);
    if (!err && with_heat && !(h->heat = mem_new(h->cells)))
        err = fault_memory(fault, "the heat");
    if (!err)
        err = hints_find(&h->hints, session->forest, margin, h->heat, fault);
    if (!err)
        err = put_worst_first(&h->hints, session, fault);
    h->has_hints = err == OK;
    if (err)
        hinting_release(h);
    return err;
}

/* Digest of the inputs of hints. */
static uint64_t hints_source(const struct session *session)
{
    const struct kept *kept = &session->now.kept;
    uint64_t of = hash_mix_at(forest_digest(session->forest), forest_label_digest(session->forest));
    of = hash_mix_at(hash_mix_at(of, session->weight_digest), kept->adjacency);
    for (unsigned l = 0; l < 256; l++)
        of = hash_mix_at(of, kept->origin_mm3[l]);
    return of;
}

bool session_has_heat(const struct session *session)
{
    const struct hinting *h = &session->inside->hinting;
    return h->heat && h->cells == session->scene->grid.cells && h->of == hints_source(session);
}

enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            const uint8_t **heat, struct fault *fault)
{
    struct hinting *h = &session->inside->hinting;
    const size_t cells = session->scene->grid.cells;
    const uint64_t of = hints_source(session);
    if (h->cells != cells || h->of != of) { /* hints of another forest */
        hinting_release(h);
        *h = (struct hinting){.cells = cells, .of = of};
    }
    const bool is_made = h->has_hints && (!heat || h->heat);
    TRY(is_made ? OK : make_hints(session, heat != NULL, fault));
    *hints = &h->hints;
    if (heat)
        *heat = h->heat;
    return OK;
}

/* One block of memory, allocated and freed as one. */
struct whole {
    struct session session;
    struct session_inside inside;
};

static void init_session(struct session *session, struct watch *watch, uint64_t waits_from)
{
    struct session_inside *inside = &((struct whole *)session)->inside;
    *inside = (struct session_inside){.waits_from = waits_from};
    *session = (struct session){.inside = inside,
                                .watch = watch,
                                .roi = roi_none(),
                                .semantics = SEMANTICS,
                                .now = state_default()};
    session_mark(session);
}

enum err session_new(struct session **session, struct fault *fault)
{
    struct whole *made = mem_new(sizeof *made);
    *session = made ? &made->session : NULL;
    if (!made)
        return fault_memory(fault, "a session");
    init_session(*session, NULL, UINT64_MAX);
    return OK;
}

enum err session_set_semantics(struct session *session, unsigned semantics, struct fault *fault)
{
    if (semantics < SEMANTICS_LEAST)
        return fault_set(fault, ERR_INPUT,
                         "it has semantics %u, of a build before 1.0, and this program knows %d: "
                         "`iftty log --script FILE` prints its commands, for `iftty run`",
                         semantics, SEMANTICS);
    if (semantics > SEMANTICS)
        return fault_set(fault, ERR_INPUT,
                         "it has semantics %u, and this program knows %d: a newer iftty verifies "
                         "and continues it",
                         semantics, SEMANTICS);
    session->semantics = semantics;
    return OK;
}

/* Release everything made from the scene before the scene itself. */
void session_close_scene(struct session *session)
{
    session_settle(session);
    if (session->pictures)
        session->inside->follower->release(session->pictures);
    session->pictures = NULL;
    if (session->scene)
        session_take_channels_out(session);
    label_measures_release(&session->inside->measures);
    finished_release(&session->inside->finished);
    finished_release(&session->inside->former_finished);
    relax_kept_release(&session->inside->relaxed);
    hinting_release(&session->inside->hinting);
    doubting_release(&session->inside->doubting);
    weight_work_release(&session->inside->weight_work);
    border_release(&session->border);
    forest_free(session->forest);
    scene_free(session->scene);
    free(session->inside->mask_room);
    free(session->levels);
    free(session->inside->series.path);
    free(session->inside->series.skip);
    session->inside->series = (struct opened_series){.path = NULL};
    session->levels = NULL;
    session->roi = roi_none();
    session->inside->mask_room = NULL;
    session->forest = NULL;
    session->scene = NULL;
    session->has_scene = session->inside->waits = session->inside->knows_window = false;
    session->inside->stale = 0;
}

/* Release everything that the session owns. */
static void release_session(struct session *session)
{
    session_close_scene(session);
    team_free(session->team);
    state_release(&session->now);
    state_release(&session->former);
    markers_release(&session->markers);
}

void session_reset(struct session *session)
{
    release_session(session);
    init_session(session, session->watch, session->inside->waits_from);
}

void session_free(struct session *session)
{
    if (session)
        release_session(session);
    free(session);
}

/* ---- facts and memory ---- */

void session_set_pictures(struct session *session, struct pictures *pictures,
                          const struct follower *follower)
{
    assert(session->has_scene && !session->pictures);
    session->pictures = pictures;
    session->inside->follower = follower;
}

void session_forget_pictures(struct session *session)
{
    if (session->pictures)
        session->inside->follower->forget(session->pictures);
}

void session_name_scene(struct session *session, const char *name, bool is_private)
{
    snprintf(session->scene_name, sizeof session->scene_name, "%s", name);
    session->is_private = is_private;
}

void session_set_watch(struct session *session, struct watch *watch)
{
    session->watch = watch;
}

struct session_memory session_memory_parts(const struct session *session)
{
    struct session_memory parts = {.seeds = sizeof(struct whole) +
                                            edit_lists_memory(&session->now.lists) +
                                            markers_memory(&session->markers)};
    if (!session->has_scene)
        return parts;
    /* the cells and everything computed from them, and other values per voxel */
    const struct kept *kept = &session->now.kept;
    parts.scene = session->scene->grid.cells * sizeof(struct cell);
    parts.scene += forest_memory(session->forest) + session->inside->weight_work.capacity;
    parts.scene += border_memory(&session->border);
    parts.scene += session->inside->mask_room ? mask_bytes(&session->scene->grid) : 0;
    parts.scene += packed_memory(kept->mask) + packed_memory(kept->rest);
    parts.scene += packed_memory(kept->weight_map);
    for (unsigned i = 0; i < CHANNELS_MOST; i++)
        parts.scene += channel_values_memory(kept->channel[i].values);
    parts.scene += session->levels ? sizeof *session->levels : 0;
    const struct hinting *hinting = &session->inside->hinting;
    parts.answers = (hinting->heat ? hinting->cells : 0) +
                    hinting->hints.capacity * sizeof *hinting->hints.item +
                    session->inside->former_finished.cells + session->inside->finished.cells +
                    relax_kept_memory(&session->inside->relaxed) +
                    label_measures_memory(&session->inside->measures);
    if (session->pictures)
        session->inside->follower->count_memory(session->pictures, &parts);
    return parts;
}

size_t session_memory(const struct session *session)
{
    const struct session_memory parts = session_memory_parts(session);
    return parts.scene + parts.seeds + parts.pictures + parts.answers;
}

struct map_place session_map_place(const struct session *session, bool resample)
{
    return (struct map_place){.grid = &session->scene->grid,
                              .geometry = &session->geometry,
                              .part = &session->part,
                              .resample = resample ? REGRID_RESAMPLE : REGRID_AS_IT_IS};
}

/* ---- all or nothing ---- */

void session_mark(struct session *session)
{
    session_settle(session);
    watch_begin(session->watch);
    if (session->has_scene)
        session->scene->watch = session->watch;
    state_assign(&session->former, &session->now);
    session->former_markers = session->markers.count;
    if (session->has_edited || session->has_regrown)
        session->inside->tally_before_edit = session->former_tally;
    session->former_tally = session->tally;
    session->inside->former_has_scene = session->has_scene;
    if (session->pictures)
        session->inside->follower->mark(session->pictures);
    session->has_edited = session->has_regrown = false;
}

void session_settle(struct session *session)
{
    struct former_scene *former = &session->inside->former_scene;
    if (former->scene) {
        border_release(&former->border);
        forest_free(former->forest);
        scene_free(former->scene);
    }
    *former = (struct former_scene){0};
    if (!session->now.kept.finish.count) {
        finished_release(&session->inside->finished);
        finished_release(&session->inside->former_finished);
        relax_kept_release(&session->inside->relaxed);
    }
    if (session->pictures)
        session->inside->follower->settle(session->pictures);
    if (!session->now.kept.mask) {
        free(session->inside->mask_room);
        session->inside->mask_room = NULL;
        session->roi.mask = NULL;
    }
}

/* Restore the scene before interpolation, with its forest and border; session_go restores the
 * camera. */
static void restore_scene(struct session *session)
{
    const struct former_scene former = session->inside->former_scene;
    if (session->pictures)
        session->inside->follower->leave_scene(session->pictures);
    label_measures_release(&session->inside->measures);
    relax_kept_release(&session->inside->relaxed);
    border_release(&session->border);
    forest_free(session->forest);
    scene_free(session->scene);
    session->scene = former.scene;
    session->said = former.said;
    if (session->levels)
        session->levels->is_blended = former.is_blended;
    session_place(session, &session->now.kept);
    session->scene_digest = former.scene_digest;
    session->weight_digest = former.weight_digest;
    session->forest = former.forest;
    session->border = former.border;
    session->roi_tally = former.roi_tally;
    session->markers.former = former.former_markers;
    session->inside->stale = former.stale | MADE_CAMERA;
    session->has_edited = session->inside->knows_window = false;
    session->inside->former_scene = (struct former_scene){0};
}

/* A command edits the seeds at most once, so the inverse of that edit leads back. */
static void restore_state(struct session *session)
{
    struct seed_changes seeds = {0};
    if (session->inside->former_scene.scene)
        restore_scene(session);
    if (session->has_edited)
        seeds = forest_seed_changes(session->forest);
    if (session_go(session, &session->former, seeds.before, seeds.count, NULL) != OK &&
        seeds.count) {
        /* The edit that leads back exists, but could not be carried out: change its seeds only,
         * and let the forest wait for memory (S5). */
        const struct seed_changes back = forest_seed_changes(session->forest);
        forest_suspend(session->forest);
        session->inside->stale |= MADE_FOREST;
        forest_edit(session->forest, back.after, back.count, NULL);
    }
    session->tally = session->former_tally;
    if (session->pictures)
        session->inside->follower->take_back(session->pictures);
}

void session_rollback(struct session *session)
{
    const bool cut_short = session->watch && session->watch->stopped;
    watch_ignore_stop(session->watch);
    if (session->has_scene && !session->inside->former_has_scene)
        session_close_scene(session);
    if (cut_short)
        session_forget_pictures(session);
    if (session->has_scene)
        restore_state(session);
    else
        state_assign(&session->now, &session->former);
    markers_drop(&session->markers, session->former_markers, session->watch);
    session->has_edited = session->has_regrown = false;
    watch_begin(session->watch);
    if (session->has_scene)
        session->scene->watch = NULL; /* until the next command */
}

/* ---- showing the session during a command ---- */

void session_show_cross(struct session *session, const uint32_t place[3])
{
    memcpy(session->now.outlook.slices.cross, place, sizeof session->now.outlook.slices.cross);
}

/* Tally and measures are restored, since the command counts its changes from them. */
void session_show(struct session *session, void (*draw)(void *context), void *context)
{
    const struct tally tally = session->tally, former = session->former_tally;
    const struct label_measures measures = session->inside->measures;
    const bool shows_finished = session->now.outlook.shows_finished;
    session->now.outlook.shows_finished = false;
    session->inside->measures = (struct label_measures){0};
    session->is_shown = true;
    draw(context);
    session->is_shown = false;
    session->tally = tally;
    session->former_tally = former;
    label_measures_release(&session->inside->measures);
    session->inside->measures = measures;
    session->now.outlook.shows_finished = shows_finished;
}
