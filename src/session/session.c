/* SPDX-License-Identifier: MIT */
#include "session/session.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "session/session_inside.h"
#include "session/setting.h"

static void begin(struct session *session)
{
    session->roi = roi_none();
    session->semantics = SEMANTICS;
    session->now = state_default();
    session_mark(session);
}

enum err session_new(struct session **session, struct fault *fault)
{
    struct session *made = *session = mem_new(sizeof *made);
    if (!made)
        return fault_memory(fault, "a session");
    made->waits_from = UINT64_MAX;
    begin(made);
    return OK;
}

enum err session_take_semantics(struct session *session, unsigned semantics, struct fault *fault)
{
    const enum err err = semantics_check(semantics, fault);
    if (!err)
        session->semantics = semantics;
    return err;
}

/* What is made of a scene, or looks at one, goes before it. */
void session_close_scene(struct session *session)
{
    session_settle(session);
    if (session->pictures)
        session->follower->release(session->pictures);
    session->pictures = NULL;
    label_measures_release(&session->measures);
    finished_release(&session->finished);
    relax_kept_release(&session->relaxed);
    hinting_release(&session->hinting);
    doubting_release(&session->doubting);
    weight_work_release(&session->weight_work);
    border_release(&session->border);
    forest_free(session->forest);
    scene_free(session->scene);
    free(session->mask_room);
    free(session->levels);
    session->levels = NULL;
    session->roi = roi_none();
    session->mask_room = NULL;
    session->forest = NULL;
    session->scene = NULL;
    session->has_scene = session->waits = session->knows_window = false;
    session->stale = 0;
}

/* All that is not given from outside. */
static void end(struct session *session)
{
    session_close_scene(session);
    team_free(session->team);
    state_release(&session->now);
    state_release(&session->former);
    markers_release(&session->markers);
}

void session_begin_again(struct session *session)
{
    struct watch *watch = session->watch;
    const uint64_t waits_from = session->waits_from;
    end(session);
    *session = (struct session){.watch = watch, .waits_from = waits_from};
    begin(session);
}

void session_free(struct session *session)
{
    if (session)
        end(session);
    free(session);
}

/* ---- what it knows ---- */

const struct kept *session_kept(const struct session *session)
{
    return &session->now.kept;
}

const struct outlook *session_outlook(const struct session *session)
{
    return &session->now.outlook;
}

const struct state *session_state(const struct session *session)
{
    return &session->now;
}

const struct state *session_former(const struct session *session)
{
    return &session->former;
}

unsigned session_semantics(const struct session *session)
{
    return session->semantics;
}

bool session_skims(const struct session *session)
{
    return session->skims;
}

bool session_has_scene(const struct session *session)
{
    return session->has_scene;
}

struct scene *session_scene(const struct session *session)
{
    return session->scene;
}

const struct forest *session_forest(const struct session *session)
{
    return session->forest;
}

const struct border *session_border(const struct session *session)
{
    return &session->border;
}

const struct geometry *session_said(const struct session *session)
{
    return &session->said;
}

const struct geometry *session_geometry(const struct session *session)
{
    return &session->geometry;
}

const struct roi *session_roi(const struct session *session)
{
    return &session->roi;
}

const struct roi_tally *session_roi_tally(const struct session *session)
{
    return &session->roi_tally;
}

const struct markers *session_markers(const struct session *session)
{
    return &session->markers;
}

const struct tally *session_tally(const struct session *session)
{
    return &session->tally;
}

const struct tally *session_former_tally(const struct session *session)
{
    return &session->former_tally;
}

const struct map_part *session_part(const struct session *session)
{
    return &session->part;
}

const struct levels *session_levels(const struct session *session)
{
    return session->levels;
}

uint32_t session_series(const struct session *session)
{
    return session->series;
}

const char *session_open_notes(const struct session *session)
{
    return session->open_notes;
}

uint64_t session_scene_digest(const struct session *session)
{
    return session->scene_digest;
}

uint64_t session_weight_digest(const struct session *session)
{
    return session->weight_digest;
}

const char *session_proof(const struct session *session)
{
    return session->proof;
}

size_t session_former_markers(const struct session *session)
{
    return session->former_markers;
}

bool session_has_edited(const struct session *session)
{
    return session->edited;
}

bool session_has_regrown(const struct session *session)
{
    return session->regrown;
}

const char *session_scene_name(const struct session *session)
{
    return session->scene_file;
}

bool session_is_private(const struct session *session)
{
    return session->is_private;
}

struct pictures *session_pictures(const struct session *session)
{
    return session->pictures;
}

void session_take_pictures(struct session *session, struct pictures *pictures,
                           const struct follower *follower)
{
    assert(session->has_scene && !session->pictures);
    session->pictures = pictures;
    session->follower = follower;
}

struct team *session_team(const struct session *session)
{
    return session->team;
}

struct watch *session_watch(const struct session *session)
{
    return session->watch;
}

void session_name_scene(struct session *session, const char *name, bool is_private)
{
    snprintf(session->scene_file, sizeof session->scene_file, "%s", name);
    session->is_private = is_private;
}

void session_set_watch(struct session *session, struct watch *watch)
{
    session->watch = watch;
}

/* Cells and what follows from them, and what else has a value for each voxel. */
static size_t scene_memory(const struct session *session)
{
    const struct kept *kept = &session->now.kept;
    size_t bytes = session->scene->grid.cells * sizeof(struct cell);
    bytes += forest_memory(session->forest) + session->weight_work.capacity;
    bytes += border_memory(&session->border);
    bytes += session->mask_room ? mask_bytes(&session->scene->grid) : 0;
    bytes += kept->mask ? packed_memory(kept->mask) : 0;
    bytes += session->levels ? sizeof *session->levels : 0;
    return bytes + (kept->weight_map ? packed_memory(kept->weight_map) : 0);
}

struct session_memory session_memory_parts(const struct session *session)
{
    struct session_memory parts = {.seeds = sizeof *session +
                                            edit_lists_memory(&session->now.lists) +
                                            markers_memory(&session->markers)};
    if (!session->has_scene)
        return parts;
    parts.scene = scene_memory(session);
    const struct hinting *hinting = &session->hinting;
    parts.answers = (hinting->heat ? hinting->cells : 0) +
                    hinting->hints.capacity * sizeof *hinting->hints.item +
                    session->finished.cells + relax_kept_memory(&session->relaxed) +
                    label_measures_memory(&session->measures);
    if (session->pictures)
        session->follower->count_memory(session->pictures, &parts);
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
    session_note_edit(session);
    session->former_tally = session->tally;
    session->former_has_scene = session->has_scene;
    if (session->pictures)
        session->follower->mark(session->pictures);
    session->edited = session->regrown = false;
}

void session_settle(struct session *session)
{
    struct former_scene *former = &session->former_scene;
    if (former->scene) {
        border_release(&former->border);
        forest_free(former->forest);
        scene_free(former->scene);
    }
    *former = (struct former_scene){0};
    if (!session->now.kept.finish.count) {
        finished_release(&session->finished);
        relax_kept_release(&session->relaxed);
    }
    if (session->pictures)
        session->follower->settle(session->pictures);
    if (!session->now.kept.mask) {
        free(session->mask_room);
        session->mask_room = NULL;
        session->roi.mask = NULL;
    }
}

/* The scene that was interpolated, and what hangs on it; the camera follows by session_go. */
static void take_back_scene(struct session *session)
{
    const struct former_scene former = session->former_scene;
    if (session->pictures)
        session->follower->leave_scene(session->pictures);
    label_measures_release(&session->measures);
    relax_kept_release(&session->relaxed);
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
    session->stale = former.stale | MADE_CAMERA;
    session->edited = session->knows_window = false;
    session->former_scene = (struct former_scene){0};
}

/* A command edits the seeds once at most, so that the inverse of that edit leads back. */
static void go_back(struct session *session)
{
    struct seed_changes seeds = {0};
    if (session->former_scene.scene)
        take_back_scene(session);
    if (session->edited)
        seeds = forest_seed_changes(session->forest);
    if (session_go(session, &session->former, seeds.before, seeds.count, NULL) != OK &&
        seeds.count) {
        /* The edit that leads back is there, but could not be carried out: its seeds alone are,
         * and the forest waits for memory (S5). */
        const struct seed_changes back = forest_seed_changes(session->forest);
        forest_suspend(session->forest);
        session->stale |= MADE_FOREST;
        forest_edit(session->forest, back.after, back.count, NULL);
    }
    session->tally = session->former_tally;
    if (session->pictures)
        session->follower->take_back(session->pictures);
}

void session_rollback(struct session *session)
{
    const bool cut_short = session->watch && session->watch->stopped;
    watch_ignore_stop(session->watch);
    if (session->has_scene && !session->former_has_scene)
        session_close_scene(session);
    if (cut_short)
        session_forget_pictures(session);
    if (session->has_scene)
        go_back(session);
    else
        state_assign(&session->now, &session->former);
    markers_drop(&session->markers, session->former_markers, session->watch);
    session->edited = session->regrown = false;
    watch_begin(session->watch);
    if (session->has_scene)
        session->scene->watch = NULL; /* until the next command */
}

/* ---- while a command is carried out ---- */

/* The border is that of the labels as they are, and made anew once they are final: the forest's,
 * of which nothing is finished. Tally and measures are those from which the command's changes will
 * be counted. */
void session_show_cross(struct session *session, const uint32_t place[3])
{
    memcpy(session->now.outlook.slices.cross, place, sizeof session->now.outlook.slices.cross);
}

void session_show(struct session *session, void (*draw)(void *context), void *context)
{
    const struct tally tally = session->tally, former = session->former_tally;
    const struct label_measures measures = session->measures;
    const bool shows_finished = session->now.outlook.shows_finished;
    session->now.outlook.shows_finished = false;
    session->measures = (struct label_measures){0};
    border_recount(&session->border);
    session->stale |= MADE_BORDER;
    session_forget_pictures(session);
    draw(context);
    session_forget_pictures(session);
    session->tally = tally;
    session->former_tally = former;
    label_measures_release(&session->measures);
    session->measures = measures;
    session->now.outlook.shows_finished = shows_finished;
}
