/* SPDX-License-Identifier: MIT */
/* Open a scene in a session, or replace it by an interpolated one. */
#include "session/session.h"
#include "session/session_inside.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"
#include "image/reader_common.h"
#include "image/volume.h"

/* ---- memory ---- */

uint64_t session_bytes_for(const uint32_t size[3])
{
    uint64_t cells = 1;
    for (int a = 0; a < 3; a++)
        if (__builtin_mul_overflow(cells, (uint64_t)size[a] + 2, &cells) || cells > UINT64_MAX / 32)
            return UINT64_MAX;
    /* Cells; two bits; a sixteenth of the scene as changes; the longest queue, in practice two
     * voxels of three bytes; two bytes while a file is read. */
    return cells * sizeof(struct cell) + cells / 4 + cells / 2 + cells * 2;
}

/* Announce the memory of a large scene. Reject one that does not fit, with a message that ends
 * in `undone`. */
static enum err check_memory(const uint32_t size[3], const char *undone, struct watch *watch,
                             struct fault *fault)
{
    const uint64_t needed = session_bytes_for(size), available = mem_available();
    if (needed > available)
        return fault_set(fault, ERR_LIMIT,
                         "a scene of %ux%ux%u voxels needs %.1f GB of memory and %.1f GB are free; "
                         "%s",
                         size[0], size[1], size[2], (double)needed / 1e9, (double)available / 1e9,
                         undone);
    if (needed >= SWELLING_FROM)
        watch_announce(watch, "%ux%ux%u voxels: needs %.1f GB of memory, %.1f GB are free", size[0],
                       size[1], size[2], (double)needed / 1e9, (double)available / 1e9);
    return OK;
}

/* Reject a small file whose scene would take far more memory than the file has bytes. */
static enum err check_swelling(const struct volume_header *header, const char *path,
                               struct fault *fault)
{
    const uint64_t needed = session_bytes_for(header->size);
    const uint64_t voxels =
        (uint64_t)header->whole[0] * header->whole[1] * header->whole[2] * header->volumes;
    if (header->choice.huge || !swelling_needs_yes(needed, voxels, header->bytes))
        return OK;
    return fault_set(fault, ERR_LIMIT,
                     "%s: %.1f MB on disk claim a scene that needs %.1f GB of memory; `open FILE "
                     "huge=yes` opens it anyway; nothing was opened",
                     path, (double)header->bytes / 1e6, (double)needed / 1e9);
}

/* ---- opening ---- */

/* Parse "synth:geom"; "synth:geom:XYZ", with bit a of *doubled for a 2 in place a; or
 * "synth:geom:NXxNYxNZ", with *doubled GEOM_SIZED. */
enum { GEOM_SIZED = 8 };
static bool scan_geom(const char *path, unsigned *doubled, uint32_t size[3])
{
    *doubled = 0;
    memcpy(size, geom_size, sizeof geom_size);
    if (!scan_text(&path, "synth:geom"))
        return false;
    if (*path == '\0')
        return true;
    if (*path++ != ':')
        return false;
    if (strlen(path) == 3 && strspn(path, "12") == 3) {
        for (unsigned a = 0; a < 3; a++)
            if (path[a] == '2') {
                *doubled |= 1u << a;
                size[a] = 2 * size[a] - 1;
            }
        return true;
    }
    *doubled = GEOM_SIZED;
    for (unsigned a = 0; a < 3; a++) {
        int64_t n;
        if ((a > 0 && !scan_text(&path, "x")) || !scan_integer(&path, 1, UINT32_MAX, &n))
            return false;
        size[a] = (uint32_t)n;
    }
    return *path == '\0';
}

static enum err open_synthetic(struct session *session, const char *path, struct fault *fault)
{
    unsigned doubled;
    uint32_t size[3];
    struct grid grid;
    if (!scan_geom(path, &doubled, size))
        return fault_set(fault, ERR_INPUT,
                         "expected synth:geom, synth:geom:XYZ with each of X, Y, Z 1 or 2, or "
                         "synth:geom:NXxNYxNZ in voxels, not %s; nothing was opened",
                         path);
    TRY(grid_init(&grid, size, fault));
    TRY(check_memory(size, "nothing was opened", session->watch, fault));
    if (doubled == GEOM_SIZED)
        TRY(scene_new_geom_of(&session->scene, size, session->watch, fault));
    else
        TRY(scene_new_geom(&session->scene, doubled, session->watch, fault));
    session->said = (struct geometry){.slope = 1};
    memcpy(session->said.spacing_nm, session->scene->spacing_nm, sizeof session->said.spacing_nm);
    geometry_place_spaced(&session->said);
    session->said.orientation = ORIENTATION_FILE; /* by definition */
    return OK;
}

void session_place(struct session *session, const struct kept *kept)
{
    struct scene *scene = session->scene;
    struct geometry *geometry = &session->geometry;
    *geometry = session->said;
    if (*kept->orient)
        geometry_orient(geometry, kept->orient);
    memcpy(scene->spacing_nm, geometry->spacing_nm, sizeof scene->spacing_nm);
    memcpy(scene->world_axis, geometry->world_axis, sizeof scene->world_axis);
    memcpy(scene->world_sign, geometry->world_sign, sizeof scene->world_sign);
    scene->sides_unknown = geometry->orientation == ORIENTATION_UNKNOWN;
    scene->spacing_unknown = geometry->spacing_unknown;
}

static enum err read_volume(struct volume *volume, const char *path,
                            const struct volume_choice *choice, struct watch *watch,
                            struct fault *fault)
{
    OWNED(volume_close) struct volume_reader reader;
    TRY(volume_open(&reader, path, choice, watch, fault));
    TRY(check_swelling(&reader.header, path, fault));
    TRY(check_memory(reader.header.made,
                     "a part of it is opened with crop=A-B,C-D,E-F or reduce=2; nothing was opened",
                     watch, fault));
    return volume_take(volume, &reader, fault);
}

/* Keep all that opens the same volume again. */
static enum err keep_series(struct opened_series *out, const char *path,
                            const struct volume *volume, struct fault *fault)
{
    struct volume_choice *choice = &out->choice;
    *choice = volume->choice;
    choice->series = volume->series;
    choice->series_name = choice->proof = choice->data = NULL;
    choice->list = choice->names = NULL;
    memcpy(out->size, volume->size, sizeof out->size);
    out->path = strdup(path);
    out->skip = choice->skip ? strdup(choice->skip) : NULL;
    if (!out->path || (choice->skip && !out->skip))
        return fault_memory(fault, "a path");
    choice->skip = out->skip;
    return OK;
}

enum err session_find_source(const struct session *session, struct dicom_source *out,
                             bool keeps_identity, struct fault *fault)
{
    const struct opened_series *series = &session->inside->series;
    OWNED(volume_release) struct volume volume = {0};
    struct scene *scene = NULL;
    char proof[SHA256_HEX];
    uint64_t digest;
    if (!series->path)
        return fault_set(fault, ERR_INPUT,
                         "the scene is no DICOM series, and a segmentation refers to one; .nii.gz "
                         "and .seg.nrrd need none");
    struct volume_choice choice = series->choice;
    choice.references = &out->words;
    choice.keeps_identity = keeps_identity;
    TRY(volume_read(&volume, series->path, &choice, session->watch, fault));
    TRY(scene_new_plain(&scene, volume.size, volume.intensity, session->watch, fault));
    volume.intensity = NULL;
    memcpy(scene->spacing_nm, volume.geometry.spacing_nm, sizeof scene->spacing_nm);
    memcpy(scene->world_axis, volume.geometry.world_axis, sizeof scene->world_axis);
    memcpy(scene->world_sign, volume.geometry.world_sign, sizeof scene->world_sign);
    scene_identify(&digest, proof, scene, session->team);
    scene_free(scene);
    TRY(watch_fault(session->watch, fault));
    if (strcmp(proof, session->proof) != 0)
        return fault_set(fault, ERR_INPUT, "%s has changed since the scene was opened",
                         series->path);
    out->has_slices = choice.reduce <= 1 && !choice.straightens &&
                      memcmp(series->size, session->scene->grid.size, sizeof series->size) == 0;
    out->first = choice.has_crop ? choice.first[2] : 0;
    return out->words.failed ? fault_memory(fault, "references") : OK;
}

static enum err open_file(struct session *session, const char *path,
                          const struct volume_choice *choice, struct fault *fault)
{
    OWNED(volume_release) struct volume volume = {0};
    TRY(read_volume(&volume, path, choice, session->watch, fault));
    TRY(scene_new_plain(&session->scene, volume.size, volume.intensity, session->watch, fault));
    volume.intensity = NULL;
    if (volume.choice.has_crop || volume.choice.reduce) {
        session->part.choice = volume.choice;
        struct volume_choice *part = &session->part.choice; /* without the options of the command */
        part->data = part->proof = part->series_name = part->skip = NULL;
        part->list = NULL;
        memcpy(session->part.whole, volume.whole, sizeof volume.whole);
        memcpy(session->part.size, volume.size, sizeof volume.size);
    }
    if (volume.series)
        TRY(keep_series(&session->inside->series, path, &volume, fault));
    session->said = volume.geometry;
    session->levels = volume.levels;
    volume.levels = NULL;
    session->series = volume.series;
    memcpy(session->open_notes, volume.notes, sizeof session->open_notes);
    return OK;
}

/* Make the objects of a scene under the settings of the session. On errors the caller releases
 * them. */
static enum err equip(struct session *session, struct scene *scene, struct forest **forest,
                      struct border *border, struct fault *fault)
{
    TRY(forest_new(forest, scene, session->now.kept.adjacency, fault));
    if (session->team || team_new(&session->team, team_size_wanted(), NULL) == OK)
        TRY(forest_set_team(*forest, session->team, fault));
    session->inside->weight_work.team = session->team;
    TRY(border_init(border, scene, fault));
    kept_show(&session->now.kept, border);
    return OK;
}

/* Compute weights and look at the middle of the scene. */
static enum err show_first(struct session *session, struct fault *fault)
{
    const uint32_t *nm = session->scene->spacing_nm;
    struct state next = session->now;
    next.outlook.view = view_default(session->scene);
    for (int a = 0; a < 3; a++)
        next.outlook.slices.cross[a] = session->scene->grid.size[a] / 2;
    session->inside->stale = MADE_WEIGHTS | MADE_ROI | MADE_CAMERA;
    enum err err = session_go(session, &next, NULL, 0, fault);
    if (err == ERR_LIMIT)
        fault_set(fault, err,
                  "voxels of %gx%gx%g mm are too long for their width: no picture could show "
                  "them; nothing was opened",
                  nm[0] / 1e6, nm[1] / 1e6, nm[2] / 1e6);
    return err;
}

void session_let_wait(struct session *session, uint64_t least)
{
    session->inside->waits_from = least;
}

enum err session_open(struct session *session, const char *path, const struct volume_choice *choice,
                      struct fault *fault)
{
    const bool is_synthetic = strncmp(path, "synth:", 6) == 0;
    if (session->has_scene)
        return fault_set(fault, ERR_USAGE,
                         "a scene is open already; `channel FILE` adds a channel to it");
    session->part = (struct map_part){0};
    if (is_synthetic && choice && (choice->has_volume || choice->has_crop || choice->reduce))
        return fault_set(fault, ERR_USAGE,
                         "volume, crop and reduce apply to files, and not to a synthetic scene; "
                         "nothing was opened");
    enum err err = is_synthetic ? open_synthetic(session, path, fault)
                                : open_file(session, path, choice, fault);
    if (!err)
        err = equip(session, session->scene, &session->forest, &session->border, fault);
    if (err) {
        session_close_scene(session);
        return err;
    }
    session->has_scene = true;
    session_place(session, &session->now.kept);
    session->tally = tally_of_none(session->scene);
    session->inside->tally_before_edit.stale = true;
    snprintf(session->scene_name, sizeof session->scene_name, "%s", file_name(path));
    scene_identify(&session->scene_digest, session->proof, session->scene, session->team);
    if (choice && choice->proof && strcmp(choice->proof, session->proof) != 0) {
        session_close_scene(session);
        memset(session->open_notes, 0, sizeof session->open_notes);
        memset(session->scene_name, 0, sizeof session->scene_name);
        return fault_set(fault, ERR_INPUT, "another scene; nothing was opened");
    }
    session->inside->waits =
        session->scene->plain && session_may_wait(session) &&
        session_bytes_for(session->scene->grid.size) >= session->inside->waits_from;
    err = session->inside->waits ? session_foretell(session, fault) : OK;
    if (!err)
        err = show_first(session, fault);
    if (err)
        session_close_scene(session);
    return err;
}

/* ---- interpolation ---- */

/* Replace scene, forest and border of the session by interpolated ones; digests, geometry and
 * weights are computed later. On error nothing has changed. */
static enum err replace_scene(struct session *session, unsigned doubled, struct fault *fault)
{
    struct former_scene next = {0};
    assert(!session->inside->former_scene.scene); /* once per command */
    enum err err =
        scene_new_interpolated(&next.scene, session->scene, doubled, session->watch, fault);
    if (!err)
        err = equip(session, next.scene, &next.forest, &next.border, fault);
    if (err) {
        border_release(&next.border);
        forest_free(next.forest);
        scene_free(next.scene);
        return err;
    }
    if (session->pictures)
        session->inside->follower->leave_scene(session->pictures);
    label_measures_release(&session->inside->measures);
    relax_kept_release(&session->inside->relaxed);
    session->inside->former_scene =
        (struct former_scene){.scene = session->scene,
                              .said = session->said,
                              .is_blended = session->levels && session->levels->is_blended,
                              .scene_digest = session->scene_digest,
                              .weight_digest = session->weight_digest,
                              .forest = session->forest,
                              .border = session->border,
                              .roi_tally = session->roi_tally,
                              .former_markers = session->markers.former,
                              .stale = session->inside->stale};
    if (session->levels)
        session->levels->is_blended = true;
    session->scene = next.scene;
    session->forest = next.forest;
    session->border = next.border;
    session->markers.former = session->markers.count;
    session->tally = tally_of_none(next.scene);
    session->inside->tally_before_edit.stale = true;
    session->inside->knows_window = false;
    session->inside->stale = MADE_WEIGHTS | MADE_ROI | MADE_CAMERA;
    if (session->skims)
        session_skim(session);
    return OK;
}

enum err session_interpolate(struct session *session, unsigned doubled, struct fault *fault)
{
    uint32_t size[3];
    const size_t pendings = session_pendings(session);
    if (forest_seeds(session->forest) || pendings)
        return fault_set(
            fault, ERR_USAGE,
            "a scene is interpolated before its first seed, and this one has %zu seed%s and %zu "
            "pending edit%s; nothing has changed",
            forest_seeds(session->forest), plural(forest_seeds(session->forest)), pendings,
            plural(pendings));
    if (session->now.kept.mask || session->now.kept.weight_map || kept_channels(&session->now.kept))
        return fault_set(
            fault, ERR_USAGE,
            "a mask, a channel or weights from a file belong to the present grid; interpolate "
            "first, then load them on the finer grid; nothing has changed");
    if (!cut_is_none(&session->now.kept.cut))
        return fault_set(fault, ERR_USAGE,
                         "a cut belongs to the present grid; interpolate first, or use "
                         "`clip none`, `plane none`, `cut none`; nothing has changed");
    if (*session->now.kept.landmark[0].name)
        return fault_set(fault, ERR_USAGE,
                         "landmarks belong to the present grid; interpolate first, or remove them "
                         "with `landmark NAME none`; nothing has changed");
    for (unsigned a = 0; a < 3; a++)
        if (session->scene->grid.size[a] == 1)
            doubled &= ~(1U << a);
    if (!doubled)
        return OK;
    scene_interpolated_size(size, session->scene->grid.size, doubled);
    TRY(check_memory(size, "nothing has changed", session->watch, fault));
    TRY(replace_scene(session, doubled, fault));
    static const double first[3] = {0, 0, 0};
    const double step[3] = {doubled & 1 ? 0.5 : 1, doubled & 2 ? 0.5 : 1, doubled & 4 ? 0.5 : 1};
    (void)geometry_derive(&session->said, first, step); /* half of 1 nm is 1 nm */
    session_place(session, &session->now.kept);
    session->scene_digest = scene_digest(session->scene);
    /* Keep the same places in the finer scene, viewed as a new scene of this size: with 2n - 1
     * voxels the middle stays the middle. Eliminators belong to the other scene. */
    struct state next = session->now;
    struct view *view = &next.outlook.view;
    view->zoom =
        view_fitting_zoom(session->scene, view->width, view->height, next.outlook.look.samples);
    view->zoom = view->zoom < VIEW_ZOOM_ONE ? view->zoom : VIEW_ZOOM_ONE;
    for (unsigned a = 0; a < 3; a++) {
        view->focus[a] *= 1 + (doubled >> a & 1);
        next.outlook.slices.cross[a] *= 1 + (doubled >> a & 1);
        next.outlook.slices.middle[a] *= 1 + (doubled >> a & 1);
    }
    next.lists.markers = next.lists.eliminators = (struct edits){0};
    next.lists.applied = 0;
    return session_go(session, &next, NULL, 0, fault);
}
