/* SPDX-License-Identifier: MIT */
#include "show/draw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/least.h"
#include "base/mem.h"
#include "base/watch.h"
#include "render/bands.h"
#include "render/fit.h"
#include "render/incremental.h"
#include "render/projection.h"
#include "render/view.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "session/session.h"
#include "session/state.h"
#include "show/pictures.h"

/* ---- the window ---- */

/* Convert a real value to an intensity. */
static int32_t intensity_of(const struct geometry *geometry, const struct decimal *real)
{
    static const double most = 1 << 30;
    const double slope = geometry->slope != 0 ? geometry->slope : 1;
    const double value = (decimal_value(real) - geometry->intercept) / slope;
    const double whole = floor(value + 0.5);
    return (int32_t)(whole < -most ? -most : whole > most ? most : whole);
}

void window_of(int32_t window[2], struct session *session)
{
    const struct slice_settings *s = &session->now.outlook.slices;
    const unsigned slot = session_shown_slot(session);
    const struct geometry *geometry = &session->geometry;
    const bool falls = geometry->slope < 0;
    const bool is_set = s->window_of[slot] == session_shown_digest(session);
    int32_t found[2];
    if (!is_set)
        session_find_window(session, found);
    for (int i = 0; i < 2; i++)
        window[i] = is_set ? intensity_of(geometry, &s->window[slot][i]) : found[falls ? 1 - i : i];
    if (window[0] == window[1])
        window[1] += falls ? -1 : 1;
}

void window_values(double value[2], struct session *session)
{
    const struct slice_settings *s = &session->now.outlook.slices;
    const unsigned slot = session_shown_slot(session);
    int32_t window[2];
    window_of(window, session);
    for (int i = 0; i < 2; i++)
        value[i] = s->window_of[slot] == session_shown_digest(session)
                       ? decimal_value(&s->window[slot][i])
                       : geometry_value(&session->geometry, window[i]);
}

/* Write "12.5", or four digits of a value too small for thousandths. */
static void write_value(char out[WINDOW_WORDS_BYTES], double value)
{
    const double thousandths = value * 1000;
    if (value == 0 || fabs(value) >= 1)
        snprintf(out, WINDOW_WORDS_BYTES, "%.10g", floor(thousandths + 0.5) / 1000);
    else
        snprintf(out, WINDOW_WORDS_BYTES, "%.4g", value);
}

void window_words(char least[WINDOW_WORDS_BYTES], char most[WINDOW_WORDS_BYTES],
                  struct session *session)
{
    double value[2];
    window_values(value, session);
    write_value(least, value[0]);
    write_value(most, value[1]);
}

static const struct look *look_of(const struct pictures *p)
{
    return &p->session->now.outlook.look;
}

/* ---- memory ---- */

enum { COARSE = 2 };            /* side of a coarse pixel, in pixels */
enum { FEW_CHANGES = 1 << 14 }; /* changed voxels; fewer update a rendition at once */

static void forget_coarse(struct coarse *coarse)
{
    rendition_release(&coarse->rendition);
    layers_release(&coarse->layers);
    coarse->is_last = false;
}

static void forget_context(struct context *context)
{
    free(context->frame.rgba);
    context->frame = (struct rendition){0};
}

void pictures_release_rendition(struct pictures *p)
{
    rendition_release(&p->rendition);
    rendition_release(&p->reduced);
    layers_release(&p->layers);
    forget_coarse(&p->coarse);
    free(p->decorated);
    p->decorated = NULL;
    p->decorated_pixels = 0;
    forget_context(&p->context);
    p->rendered = RENDERED_NOT;
    p->drawings++;
}

/* Forget the finished labels. */
static void drop_live(struct pictures *p)
{
    struct live_finish *live = &p->live;
    if (!live->label)
        return;
    p->drawings++;
    p->own.border = NULL;
    shader_release(&p->shader); /* it may depend on this border */
    mesh_release(&p->mesh);
    mem_pages_free(live->label, live->cells);
    border_release(&live->border);
    label_measures_release(&live->measures);
    *live = (struct live_finish){0};
    if (p->rendered == RENDERED_FINISHED)
        p->rendered = RENDERED_NOT;
}

static void leave_scene(struct pictures *p)
{
    p->own = (struct own_view){0};
    drop_live(p);
    shader_release(&p->shader);
    mesh_release(&p->mesh);
}

static void release_pictures(struct pictures *p)
{
    pictures_release_rendition(p);
    leave_scene(p);
    change_log_release(&p->waits);
    mip_release(&p->context.mip);
    free(p);
}

static void count_memory(const struct pictures *p, struct session_memory *memory)
{
    const struct rendition *frame = &p->context.frame;
    memory->answers +=
        p->live.cells + border_memory(&p->live.border) + label_measures_memory(&p->live.measures);
    memory->pictures += sizeof *p + rendition_bytes(&p->rendition) + rendition_bytes(&p->reduced) +
                        layers_bytes(&p->layers) + rendition_bytes(&p->coarse.rendition) +
                        layers_bytes(&p->coarse.layers) + mip_bytes(&p->context.mip) +
                        (size_t)4 * frame->width * frame->height + 4 * p->decorated_pixels +
                        shader_bytes(&p->shader) + mesh_bytes(&p->mesh) +
                        p->waits.capacity * sizeof *p->waits.item;
}

/* ---- the camera ---- */

static void outdate_rendition(struct pictures *p)
{
    p->rendered = RENDERED_NOT;
}

/* True for an empty rendition or one of this size. */
static bool has_size(const struct rendition *rendition, uint32_t width, uint32_t height)
{
    return !rendition->depth || (rendition->width == width && rendition->height == height);
}

static void take_camera(struct pictures *p, const struct camera *camera)
{
    const struct view *view = &p->session->now.outlook.view, *fine = &camera->view;
    if (!has_size(&p->rendition, fine->width, fine->height) ||
        !has_size(&p->reduced, view->width, view->height))
        pictures_release_rendition(p);
    p->camera = *camera;
    outdate_rendition(p);
}

/* Aim the camera at the focus of a view, at its zoom. */
static enum err take_view(struct pictures *p, const struct view *view, struct fault *fault)
{
    struct outlook outlook = p->session->now.outlook;
    const struct view *now = &p->camera.view;
    struct camera camera;
    if (now->zoom == view->zoom * outlook.look.samples &&
        memcmp(now->focus, view->focus, sizeof now->focus) == 0)
        return OK;
    outlook.view = *view;
    TRY(session_aim(p->session, &outlook, &camera, fault));
    take_camera(p, &camera);
    return OK;
}

/* ---- the context ---- */

/* The rendition of the objects, without context. */
static const struct rendition *objects_of(const struct pictures *p)
{
    return look_of(p)->samples > 1 ? &p->reduced : &p->rendition;
}

/* Draw the context of the present camera. */
static enum err draw_context(struct pictures *p, struct fault *fault)
{
    struct session *session = p->session;
    struct mip_source source = {.scene = session->scene,
                                .digest = session->scene_digest + session_shown_digest(session),
                                .cut = session->now.kept.cut};
    const uint32_t samples = look_of(p)->samples;
    struct view view = p->camera.view; /* in samples; converted to pixels below */
    struct camera camera;
    view.width /= samples;
    view.height /= samples;
    view.zoom /= samples;
    window_of(source.window, session);
    TRY(camera_init(&camera, session->scene, &view, fault));
    return mip_draw(&p->context.mip, &source, &camera, session->team, fault);
}

/* Put the context behind a new rendition. Does nothing if the outlook has none. */
static enum err put_context(struct pictures *p, struct fault *fault)
{
    struct context *context = &p->context;
    const struct rendition *rendered = objects_of(p);
    if (p->session->now.outlook.context == CONTEXT_NONE)
        return OK;
    TRY(draw_context(p, fault));
    uint8_t *rgba = context->frame.rgba;
    if (context->frame.width != rendered->width || context->frame.height != rendered->height) {
        forget_context(context);
        rgba = mem_array((size_t)rendered->width * rendered->height, 4);
    }
    if (!rgba)
        return fault_memory(fault, "a picture");
    context->frame = *rendered;
    context->frame.rgba = rgba;
    mip_put_behind(rgba, rendered->rgba, context->mip.brightness,
                   (size_t)rendered->width * rendered->height);
    return OK;
}

/* ---- the rendition ---- */

static void prepare_shader(struct pictures *p)
{
    p->shader.team = p->session->team;
    if (!cut_is_none(&p->session->now.kept.cut))
        window_of(p->shader.window, p->session);
}

/* Shade the maps of the rendition, and reduce the picture to the size of the view. */
static enum err shade_rendition(struct pictures *p, struct fault *fault)
{
    const struct look *look = look_of(p);
    prepare_shader(p);
    TRY(shade(&p->rendition, &p->camera, &p->mesh, &p->session->now.kept.palette, look, &p->shader,
              fault));
    if (look->samples > 1)
        rendition_reduce(&p->reduced, &p->rendition, look->samples, p->session->team);
    return OK;
}

/* Allocate a rendition with one pixel for `samples` of the camera, along both sides. */
static enum err make_rendition(struct pictures *p, struct rendition *rendition, uint32_t samples,
                               struct fault *fault)
{
    if (rendition->depth)
        return OK;
    outdate_rendition(p);
    return rendition_init(rendition, p->camera.view.width / samples,
                          p->camera.view.height / samples, fault);
}

/* Allocate the rendition. */
static enum err make_room(struct pictures *p, enum render_mode mode, struct fault *fault)
{
    const struct view *fine = &p->camera.view;
    const bool fits =
        mode != RENDER_ONCE && (uint64_t)fine->width * fine->height <= SAMPLES_STORED_MOST;
    enum err err = OK;
    if (p->take)
        return OK;
    if (look_of(p)->samples == 1 || fits)
        err = make_rendition(p, &p->rendition, 1, fault);
    else
        rendition_release(&p->rendition); /* bands are drawn instead */
    if (look_of(p)->samples == 1)
        rendition_release(&p->reduced);
    else if (!err)
        err = make_rendition(p, &p->reduced, look_of(p)->samples, fault);
    if (err)
        pictures_release_rendition(p);
    return err;
}

/* Draw the visible voxels of a border from scratch, into allocated memory or in bands. */
static enum err draw_border(struct pictures *p, const struct border *border, enum render_mode mode,
                            struct fault *fault)
{
    projection *project = mode == RENDER_SCENE ? project_scene
                          : mode == RENDER_RAY ? project_rays
                                               : project_border;
    const struct look *look = look_of(p);
    struct team *team = p->session->team;
    outdate_rendition(p);
    p->drawings++;
    enum err err = OK;
    TRY(mesh_update(&p->mesh, border, shade_kind(look), team, NULL, fault));
    const uint64_t begin_ns = clock_ns();
    if (!p->take && p->rendition.depth) {
        TRY(layers_attach(&p->layers, &p->rendition, border, fault));
        if (project == project_border)
            project_border_shared(&p->rendition, &p->camera, &p->mesh, team);
        else
            project(&p->rendition, &p->camera, &p->mesh);
        err = shade_rendition(p, fault);
    } else {
        const struct bands bands = {.project = project,
                                    .camera = &p->camera,
                                    .mesh = &p->mesh,
                                    .palette = &p->session->now.kept.palette,
                                    .look = look,
                                    .shader = &p->shader,
                                    .take = p->take,
                                    .context = p->take_context};
        prepare_shader(p);
        if (p->take && p->session->now.outlook.context)
            err = draw_context(p, fault);
        if (!err)
            err = bands_draw(p->take ? NULL : &p->reduced, &bands, fault);
    }
    if (!err && !p->take)
        err = put_context(p, fault);
    p->coarse.took_ns = clock_ns() - begin_ns;
    return err ? err : watch_fault(p->session->scene->watch, fault);
}

/* A pane enlarges by whole numbers only. */
struct view session_view_in_room(const struct session *session, const uint32_t room[2])
{
    const struct view plain = session_fitting_view(session);
    const uint32_t width = least(room[0], VIEW_SIDE_MOST), height = least(room[1], VIEW_SIDE_MOST);
    struct view view = plain;
    if (width <= plain.width || height <= plain.height)
        return plain;
    view.width = least(width, (uint32_t)((uint64_t)height * plain.width / plain.height));
    view.height = (uint32_t)((uint64_t)view.width * plain.height / plain.width);
    view.zoom = (uint32_t)((uint64_t)plain.zoom * view.width / plain.width);
    return view.height && view.zoom <= VIEW_ZOOM_MOST ? view : plain;
}

/* Draw coarsely the present surface, which must be up to date. */
static enum err draw_coarse(struct pictures *p, const struct view *view,
                            const struct border *border, struct fault *fault)
{
    struct coarse *coarse = &p->coarse;
    struct outlook outlook = p->session->now.outlook;
    struct camera camera;
    outlook.view = *view;
    outlook.view.width = (outlook.view.width + COARSE - 1) / COARSE;
    outlook.view.height = (outlook.view.height + COARSE - 1) / COARSE;
    outlook.view.zoom /= COARSE;
    outlook.look.samples = 1;
    outlook.look.edges = 0;
    TRY(session_aim(p->session, &outlook, &camera, fault));
    if (!has_size(&coarse->rendition, outlook.view.width, outlook.view.height))
        forget_coarse(coarse);
    if (!coarse->rendition.depth)
        TRY(rendition_init(&coarse->rendition, outlook.view.width, outlook.view.height, fault));
    TRY(layers_attach(&coarse->layers, &coarse->rendition, border, fault));
    project_border_shared(&coarse->rendition, &camera, &p->mesh, p->session->team);
    prepare_shader(p);
    return shade(&coarse->rendition, &camera, &p->mesh, &p->session->now.kept.palette,
                 &outlook.look, &p->shader, fault);
}

static const struct border *border_of(const struct pictures *p, enum rendered as)
{
    return as == RENDERED_FINISHED ? &p->live.border : &p->session->border;
}

/* Update the rendition by the changes that wait. */
static enum err update_rendition(struct pictures *p, enum rendered as, struct fault *fault)
{
    const struct changes changes = {.count = p->waits.count, .item = p->waits.item};
    outdate_rendition(p);
    p->drawings++;
    TRY(incremental_image(&p->rendition, &p->camera, &p->mesh, border_of(p, as), look_of(p),
                          &changes, p->session->team, fault));
    TRY(shade_rendition(p, fault));
    TRY(put_context(p, fault));
    return watch_fault(p->session->scene->watch, fault);
}

/* Draw in this view. The session must not skim. */
static enum err draw_at(struct pictures *p, const struct view *view, enum rendered as,
                        enum render_mode mode, struct fault *fault)
{
    TRY(take_view(p, view, fault));
    TRY(make_room(p, mode, fault));
    const bool draws_anew = mode == RENDER_SCENE || mode == RENDER_BORDER || mode == RENDER_RAY;
    const bool is_updated = p->rendered == as && p->waits.follows && !draws_anew;
    if (is_updated && !p->waits.count)
        return OK;
    const enum err err =
        is_updated ? update_rendition(p, as, fault) : draw_border(p, border_of(p, as), mode, fault);
    p->rendered = err ? RENDERED_NOT : as;
    return change_log_settle(&p->waits, err);
}

/* Note a change of labels, whose border is up to date. The rendition is updated when it is
 * wanted. */
static void note_changes(struct pictures *p, enum rendered as, const struct changes *changes)
{
    mesh_note(&p->mesh, border_of(p, as), changes);
    if (p->rendered != as)
        return;
    change_log_add(&p->waits, changes, p->session->scene->grid.voxels);
    if (!p->rendition.depth)
        outdate_rendition(p);
}

/* ---- finished labels in panels ---- */

bool session_shows_finished(const struct session *session)
{
    return session->now.outlook.shows_finished && session->now.kept.finish.count > 0 &&
           session->has_scene && !session->skims;
}

static bool has_edited(const struct session *session)
{
    return session->has_edited || session->has_regrown;
}

uint8_t session_shown_label(const struct session *session, uint32_t cell)
{
    const struct pictures *p = session->pictures;
    return session_shows_finished(session) && p && p->live.label ? p->live.label[cell]
                                                                 : session->scene->cell[cell].label;
}

/* True if all voxels have one label, which finishing does not change. */
static bool has_one_label(const struct session *session)
{
    bool has = false;
    for (unsigned label = 0; label < 256 && !session->tally.stale; label++)
        has |= session->tally.voxels[label] == session->scene->grid.voxels;
    return has;
}

/* Begin with the exact labels if they are known, otherwise with the forest's. */
static enum err make_live(struct pictures *p, struct fault *fault)
{
    struct live_finish *live = &p->live;
    struct scene *scene = p->session->scene;
    const struct labels from = {scene, session_finished(p->session)};
    live->cells = scene->grid.cells;
    live->label = mem_pages(live->cells);
    if (!live->label)
        return fault_memory(fault, "finished labels");
    const enum err err = border_init(&live->border, scene, fault);
    if (err) {
        drop_live(p);
        return err;
    }
    labels_copy(&from, live->label, p->session->team);
    if (from.finished || has_one_label(p->session))
        live->of = session_finish_source(p->session);
    live->border.labels.finished = live->label;
    live->tally = p->session->tally;
    live->tally.stale |= from.finished != NULL;
    return OK;
}

/* True if the border has the visibility and the cut of the session. */
static bool border_fits(const struct border *border, const struct kept *kept)
{
    for (int label = 0; label < 256; label++)
        if (border->visible[label] != kept_shows(kept, label))
            return false;
    return memcmp(&border->cut, &kept->cut, sizeof kept->cut) == 0;
}

/* Prepare live labels for a picture. */
static enum err begin_live(struct pictures *p, struct fault *fault)
{
    const struct kept *kept = &p->session->now.kept;
    const bool is_new = !p->live.label;
    TRY(is_new ? make_live(p, fault) : OK);
    const bool fits = !is_new && border_fits(&p->live.border, kept);
    kept_show(kept, &p->live.border);
    if (fits)
        return OK;
    border_recount(&p->live.border);
    if (p->rendered == RENDERED_FINISHED)
        outdate_rendition(p);
    enum err err = watch_fault(p->session->scene->watch, fault);
    if (err)
        drop_live(p);
    return err;
}

/* Follow a change of the live labels. A list that could not be made, or is too long, counts as a
 * change of everything. */
static void take_changes(struct pictures *p, struct change *change, size_t count, bool everything)
{
    const struct changes changes = {.everything = everything,
                                    .count = everything ? 0 : count,
                                    .item = change,
                                    .listed = everything ? 0 : count,
                                    .voxels = count};
    border_update(&p->live.border, &changes);
    tally_follow(&p->live.tally, &changes, NULL);
    label_measures_follow(&p->live.measures, &changes);
    note_changes(p, RENDERED_FINISHED, &changes);
    p->drawings++;
    free(change);
    if (watch_stops(p->session->scene->watch))
        drop_live(p);
}

/* Follow an edit of the forest. */
static void follow_live(struct pictures *p, const struct changes *changes)
{
    struct live_finish *live = &p->live;
    struct change *change = NULL;
    size_t count = 0;
    live->of = 0;
    if (live->label && !changes->everything && session_shows_finished(p->session))
        change = mem_array(changes->count + 1, sizeof *change);
    if (!change) {
        drop_live(p);
        return;
    }
    for (size_t i = 0; i < changes->count; i++) {
        const struct change *of_forest = changes->item + i;
        uint8_t *label = live->label + of_forest->cell;
        if (*label == of_forest->label)
            continue;
        change[count++] = (struct change){of_forest->cell, *label, of_forest->label};
        *label = of_forest->label;
    }
    take_changes(p, change, count, false);
}

/* List cells whose labels differ, `most` of them at most, and return their count. */
static size_t list_differences(const struct live_finish *live, const uint8_t *label,
                               struct change *change, size_t most)
{
    enum { STEP = 256 };
    size_t count = 0;
    for (size_t at = 0; at < live->cells && count <= most; at += STEP) {
        const size_t end = at + STEP < live->cells ? at + STEP : live->cells;
        if (memcmp(live->label + at, label + at, end - at) == 0)
            continue;
        for (size_t c = at; c < end && count <= most; c++)
            if (live->label[c] != label[c] && count++ < most)
                change[count - 1] = (struct change){(uint32_t)c, live->label[c], label[c]};
    }
    return count;
}

/* The same from known exact labels. */
static enum err take_exact(struct pictures *p, const struct labels *exact, struct fault *fault)
{
    struct live_finish *live = &p->live;
    TRY(begin_live(p, fault));
    if (live->of == session_finish_source(p->session))
        return OK;
    const size_t most = live->cells / 16;
    struct change *change = mem_array(most + 1, sizeof *change);
    const size_t count = change ? list_differences(live, exact->finished, change, most) : most + 1;
    memcpy(live->label, exact->finished, live->cells);
    take_changes(p, change, count, count > most);
    live->of = session_finish_source(p->session);
    return watch_fault(p->session->scene->watch, fault);
}

const uint64_t *session_shown_voxels(const struct session *session, const uint64_t **before)
{
    struct pictures *p = session->pictures;
    if (!session_shows_finished(session) || !p || !p->live.label) {
        *before = session_voxels_before_edit(session);
        return session->tally.stale ? NULL : session->tally.voxels;
    }
    const struct tally *former = has_edited(session) ? &p->former.tally : &p->tally_before_edit;
    const bool knows = tally_refresh(&p->live.tally, &p->live.border.labels, session->team);
    *before = knows && !former->stale ? former->voxels : NULL;
    return knows ? p->live.tally.voxels : NULL;
}

enum err session_sum_shown(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault)
{
    struct pictures *p = session->pictures;
    if (!session_shows_finished(session) || !p || !p->live.label)
        return session_sum_label(session, label, sums, fault);
    return label_measures_sum(&p->live.measures, &p->live.border.labels, label, session->team, sums,
                              fault);
}

bool session_is_rough(const struct session *session)
{
    const struct pictures *p = session->pictures;
    return session_shows_finished(session) && !(p && p->live.of == session_finish_source(session));
}

enum err session_refine(struct session *session, struct watch *watch, struct fault *fault)
{
    struct scene *scene = session->scene;
    struct watch *const former = scene->watch;
    struct pictures *p;
    struct labels exact;
    TRY(pictures_begin(&p, session, fault));
    scene->watch = watch;
    enum err err = session_labels(session, true, &exact, fault);
    scene->watch = NULL; /* the rest is short, and must not be stopped */
    if (!err)
        err = take_exact(p, &exact, fault);
    scene->watch = former;
    return err;
}

/* ---- following the session ---- */

static void mark_pictures(struct pictures *p)
{
    p->former.rendered = session_is_rough(p->session) ? RENDERED_NOT : p->rendered;
    p->former.drawings = p->drawings;
    p->former.waits = p->waits;
    p->former.camera = p->camera;
    if (has_edited(p->session)) /* made by the command before this one */
        p->tally_before_edit = p->former.tally;
    p->former.tally = p->live.tally;
    p->former.tally.stale |= !p->live.label;
}

/* Pixels that are still there are shown again, without new memory; others are redrawn. */
static void take_back_pictures(struct pictures *p)
{
    struct labels labels;
    const enum rendered as = p->former.rendered;
    if (!as) {
        outdate_rendition(p);
    } else if (p->drawings == p->former.drawings) {
        p->camera = p->former.camera;
        p->rendered = as;
        p->waits.follows = p->former.waits.follows && (p->waits.follows || !p->former.waits.count);
        p->waits.count = p->former.waits.count;
    } else if (!session_labels(p->session, as == RENDERED_FINISHED, &labels, NULL)) {
        session_draw_labels(p->session, &labels, RENDER_AS_KEPT, NULL);
    }
}

static void settle_pictures(struct pictures *p)
{
    if (!session_shows_finished(p->session))
        drop_live(p);
}

static void follow_edit(struct pictures *p, const struct changes *changes)
{
    note_changes(p, RENDERED_FOREST, changes);
    follow_live(p, changes);
}

enum err pictures_begin(struct pictures **pictures, struct session *session, struct fault *fault)
{
    static const struct follower follower = {.mark = mark_pictures,
                                             .take_back = take_back_pictures,
                                             .settle = settle_pictures,
                                             .follow = follow_edit,
                                             .forget_labels = drop_live,
                                             .take_camera = take_camera,
                                             .forget = outdate_rendition,
                                             .leave_scene = leave_scene,
                                             .release = release_pictures,
                                             .count_memory = count_memory};
    struct pictures *p = *pictures = session->pictures;
    if (p)
        return OK;
    p = mem_new(sizeof *p);
    if (!p)
        return fault_memory(fault, "a picture");
    p->session = session;
    p->former.tally.stale = p->tally_before_edit.stale = true;
    const enum err err = session_aim(session, &session->now.outlook, &p->camera, fault);
    if (err) {
        free(p);
        return err;
    }
    session_set_pictures(session, p, &follower);
    *pictures = p;
    return OK;
}

/* ---- drawing ---- */

/* Draw labels with a border of their own, which is released: shader and mesh must not refer to
 * it. */
static enum err draw_finished(struct pictures *p, const struct labels *labels,
                              enum render_mode mode, struct fault *fault)
{
    OWNED(border_release) struct border border;
    TRY(border_init(&border, p->session->scene, fault));
    border.labels = *labels;
    kept_show(&p->session->now.kept, &border);
    border_recount(&border);
    enum err err = watch_fault(p->session->watch, fault);
    if (!err)
        err = draw_border(p, &border, mode, fault);
    shader_release(&p->shader);
    mesh_release(&p->mesh);
    return err;
}

enum err session_draw_labels(struct session *session, const struct labels *labels,
                             enum render_mode mode, struct fault *fault)
{
    const struct view *view = &session->now.outlook.view;
    struct pictures *p;
    if (session->skims || session->is_shown)
        return OK;
    TRY(pictures_begin(&p, session, fault));
    if (!labels->finished)
        return draw_at(p, view, RENDERED_FOREST, mode, fault);
    if (session_shows_finished(session)) { /* their border is kept */
        TRY(take_exact(p, labels, fault));
        return draw_at(p, view, RENDERED_FINISHED, mode, fault);
    }
    TRY(take_view(p, view, fault));
    TRY(make_room(p, mode, fault));
    return draw_finished(p, labels, mode, fault);
}

enum err session_draw(struct session *session, enum render_mode mode, struct fault *fault)
{
    const struct labels labels = labels_of_forest(session->scene);
    return session_draw_labels(session, &labels, mode, fault);
}

/* Choose the zoom at which the objects fit, around their own middle if that makes them an eighth
 * larger. Choose again when they no longer fit, or could be a quarter larger. */
static enum err fit_shown(struct pictures *p, const struct border *border, struct fault *fault)
{
    const struct outlook *outlook = &p->session->now.outlook;
    const struct view *view = &outlook->view;
    const uint32_t samples = outlook->look.samples;
    struct own_view *own = &p->own, next = {.has_place = true};
    struct fit fit;
    if (own->border == border && own->version == border->version && own->width == view->width &&
        own->height == view->height && own->samples == samples)
        return OK;
    TRY(fit_init(&fit, border, fault));
    fit_middle(&fit, next.place);
    next.zoom = fit_all_round(&fit, view, next.place, samples);
    const uint32_t plain = fit_all_round(&fit, view, NULL, samples);
    const uint32_t fits = own->has_place ? fit_all_round(&fit, view, own->place, samples) : plain;
    if (next.zoom <= plain + plain / 8)
        next = (struct own_view){.zoom = plain};
    if (!own->zoom || next.zoom > own->zoom + own->zoom / 4 || fits < own->zoom)
        *own = next;
    own->border = border, own->version = border->version;
    own->width = view->width, own->height = view->height, own->samples = samples;
    fit_release(&fit);
    return OK;
}

static struct glance last_glance(const struct session *session, bool is_hasty)
{
    const struct pictures *p = session->pictures;
    if (p && p->coarse.is_last)
        return (struct glance){&p->coarse.rendition, COARSE, is_hasty};
    return (struct glance){session_frame(session), 1, is_hasty};
}

enum err session_draw_fitting(struct session *session, const uint32_t room[2], uint64_t within_ns,
                              struct glance *glance, struct labels *labels, struct fault *fault)
{
    const bool finished = session_shows_finished(session);
    const enum rendered as = finished ? RENDERED_FINISHED : RENDERED_FOREST;
    struct pictures *p;
    *labels = labels_of_forest(session->scene);
    *glance = last_glance(session, session->is_shown);
    if (session->skims || session->is_shown)
        return OK;
    TRY(pictures_begin(&p, session, fault));
    const struct labels exact = {session->scene, finished ? session_finished(session) : NULL};
    if (finished)
        TRY(exact.finished ? take_exact(p, &exact, fault) : begin_live(p, fault));
    TRY(fit_shown(p, border_of(p, as), fault));
    const struct view view = session_view_in_room(session, room);
    TRY(take_view(p, &view, fault));
    labels->finished = finished ? p->live.label : NULL;
    const struct border *border = border_of(p, as);
    const bool is_current = mesh_is_current(&p->mesh, border, shade_kind(look_of(p)));
    const bool is_soon = (p->rendered == as && p->waits.follows && p->waits.count <= FEW_CHANGES) ||
                         (p->coarse.took_ns && p->coarse.took_ns < within_ns && is_current);
    *glance = last_glance(session, within_ns && !is_soon && !session->now.outlook.context);
    if (glance->is_hasty && !is_current)
        return OK;
    TRY(glance->is_hasty ? draw_coarse(p, &view, border, fault)
                         : draw_at(p, &view, as, RENDER_AS_KEPT, fault));
    p->coarse.is_last = glance->is_hasty;
    *glance = last_glance(session, glance->is_hasty);
    return OK;
}

struct view session_fitting_view(const struct session *session)
{
    struct view view = session->now.outlook.view;
    const struct scene *scene = session->scene;
    const struct pictures *p = session->pictures;
    const uint32_t samples = session->now.outlook.look.samples;
    const bool is_known = p && p->own.width == view.width && p->own.height == view.height;
    const uint32_t fitting = is_known && p->own.zoom
                                 ? p->own.zoom
                                 : view_fitting_zoom(scene, view.width, view.height, samples);
    if (view.zoom != view_default(scene).zoom || view.zoom >= fitting)
        return view;
    view.zoom = fitting;
    if (p && p->own.has_place && !(view.focus[0] | view.focus[1] | view.focus[2]))
        view_focus_on(&view, scene, p->own.place);
    return view;
}

enum err session_render(struct session *session, enum render_mode mode, struct fault *fault)
{
    TRY(session_run(session, fault));
    return session_draw(session, mode, fault);
}

enum rendered session_rendered(const struct session *session)
{
    const struct pictures *p = session->pictures;
    return p ? p->rendered : RENDERED_NOT;
}

const struct rendition *session_frame(const struct session *session)
{
    static const struct rendition none;
    const struct pictures *p = session->pictures;
    if (!p)
        return &none;
    return session->now.outlook.context && p->context.frame.rgba ? &p->context.frame
                                                                 : objects_of(p);
}
