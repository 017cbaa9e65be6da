/* SPDX-License-Identifier: MIT */
#include "show/export_picture.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "base/version.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "render/palette.h"
#include "render/view.h"
#include "session/session.h"
#include "session/setting.h"
#include "session/state.h"
#include "show/decorating.h"
#include "show/pictures.h"

/* ---- camera ---- */

#define ONE30 1073741824.0

double seen_mm_per_pixel(const struct session *session)
{
    return (double)view_unit(session->scene) / 1e6 * VIEW_ZOOM_ONE / session->now.outlook.view.zoom;
}

/* Compute a column of a matrix: the coordinate of a point of the world along a direction of the
 * picture, from voxel `from` on. `axis` is the direction along voxel axes, times 2^30. */
static void set_column(double column[4], const struct session *session, const int32_t axis[3],
                       const double from[3])
{
    const struct geometry *geometry = &session->geometry;
    const double origin[3] = {geometry->to_mm[0][3], geometry->to_mm[1][3], geometry->to_mm[2][3]};
    double steps[3], at_origin[3];
    geometry_solve(geometry, origin, at_origin);
    for (int w = 0; w < 4; w++) {
        const double unit[3] = {w == 0, w == 1, w == 2};
        geometry_solve(geometry, unit, steps);
        column[w] = 0;
        for (int a = 0; a < 3; a++)
            column[w] += axis[a] / ONE30 * (session->scene->spacing_nm[a] / 1e6) *
                         (w < 3 ? steps[a] : -at_origin[a] - from[a]);
    }
}

static void seen_from(struct picture_space *space, const struct session *session)
{
    const struct view *view = &session->now.outlook.view;
    const double pixel_mm = seen_mm_per_pixel(session);
    double middle[3], focus[3], column[3][4];
    int32_t axis[3][3];
    /* The eye is half of the scene's diagonal away, to the next millimetre, and one more. */
    const struct scene *scene = session->scene;
    double squares = 0;
    for (int a = 0; a < 3; a++) {
        const double length = scene->grid.size[a] * (scene->spacing_nm[a] / 1e6);
        squares += length * length;
    }
    *space = (struct picture_space){.eye_mm = floor(sqrt(squares) / 2) + 2,
                                    .has_world = geometry_has_place(&session->geometry)};
    if (!space->has_world)
        return;
    for (int a = 0; a < 3; a++) {
        middle[a] = (session->scene->grid.size[a] - 1) / 2.0;
        focus[a] = middle[a] + (double)view->focus[a] / (1 << VIEW_FOCUS_BITS);
    }
    view_axes(view, session->scene, axis[0], axis[1], axis[2]);
    for (int d = 0; d < 3; d++)
        set_column(column[d], session, axis[d], d < 2 ? focus : middle);
    column[2][3] += space->eye_mm;
    for (int w = 0; w < 4; w++) {
        const double half = w == 3 ? 0.5 : 0;
        for (int d = 0; d < 3; d++)
            space->to_camera[w][d] = (float)column[d][w];
        space->to_ndc[w][0] = (float)(half + column[0][w] / (view->width * pixel_mm));
        space->to_ndc[w][1] = (float)(half - column[1][w] / (view->height * pixel_mm));
        space->to_ndc[w][2] = (float)column[2][w];
    }
    space->to_camera[3][3] = space->to_ndc[3][3] = 1;
}

/* A normal is perpendicular to steps along the surface, which follow the axes: multiply it by the
 * transposed inverse of their directions. */
void seen_normals(float *out, const int16_t *normal, size_t pixels, const struct geometry *geometry)
{
    double turn[3][3]; /* [world][voxel axis] */
    for (int w = 0; w < 3; w++) {
        const double unit[3] = {w == 0, w == 1, w == 2};
        geometry_solve(geometry, unit, turn[w]);
        for (int a = 0; a < 3; a++)
            turn[w][a] *= geometry_step_mm(geometry, a);
    }
    for (size_t i = 0; i < pixels; i++, normal += 4, out += 3) {
        double n[3], squares = 0;
        for (int w = 0; w < 3; w++) {
            n[w] = turn[w][0] * normal[0] + turn[w][1] * normal[1] + turn[w][2] * normal[2];
            squares += n[w] * n[w];
        }
        for (int w = 0; w < 3; w++)
            out[w] = squares > 0 ? (float)(n[w] / sqrt(squares)) : 0;
    }
}

/* ---- notes ---- */

/* Write the view with units, and the voxel in the middle of the picture. */
static void write_view(struct buf *out, const struct session *session)
{
    const struct view *view = &session->now.outlook.view;
    buf_printf(out, "yaw %g pitch %g roll %g degrees, zoom %g, %ux%u pixels",
               view->angle[0] / 1000.0, view->angle[1] / 1000.0, view->angle[2] / 1000.0,
               view->zoom / 1000.0, view->width, view->height);
    for (int a = 0; a < 3; a++)
        buf_printf(out, "%s%.7g", a ? "," : ", voxel ",
                   (session->scene->grid.size[a] - 1) / 2.0 +
                       (double)view->focus[a] / (1 << VIEW_FOCUS_BITS));
    buf_add_text(out, " in the middle");
}

/* Write the cut in voxels (render/cut.h): "kept x 0-180 y 0-216 z 40-120 plane ... box ...". */
static void write_cut(struct buf *out, const struct cut *cut, const struct grid *grid)
{
    buf_add_text(out, "kept");
    for (int a = 0; a < 3; a++) {
        const uint32_t end = grid->size[a] - 1;
        const uint32_t last = cut->last[a] < end ? cut->last[a] : end;
        buf_printf(out, " %c %u-%u", 'x' + a, cut->first[a], last);
    }
    for (uint32_t i = 0; i < cut->planes; i++) {
        const struct cut_plane *p = &cut->plane[i];
        buf_printf(out, " plane %lld %lld %lld from %lld", (long long)p->normal[0],
                   (long long)p->normal[1], (long long)p->normal[2], (long long)p->least);
    }
    for (uint32_t i = 0; i < cut->boxes; i++) {
        const struct cut_box *b = &cut->box[i];
        buf_printf(out, " box %u,%u,%u %u,%u,%u", b->first[0], b->first[1], b->first[2], b->last[0],
                   b->last[1], b->last[2]);
    }
}

void export_opacity(struct buf *out, const struct kept *kept)
{
    const uint8_t *opacity = kept->opacity, usual = opacity[0];
    OWNED(buf_release) struct buf others = {0};
    for (unsigned label = 1; label < 256; label++)
        if (opacity[label] != usual)
            buf_printf(&others, ", %u %% of label %u", opacity[label], numbering_of(kept, label));
    if (usual < BORDER_OPAQUE || others.length)
        buf_printf(out, "%u %%%s", usual, buf_text(&others));
    out->failed |= others.failed;
}

enum err export_note(struct picture *picture, const char *name, struct buf *words,
                     struct fault *fault)
{
    const enum err err = words->failed ? fault_memory(fault, "a note on a picture")
                                       : picture_note(picture, name, buf_text(words), fault);
    buf_release(words);
    return err;
}

/* Notes about view, cut, opacity and look. */
static enum err add_view_notes(struct picture *picture, const struct session *session,
                               struct fault *fault)
{
    const struct cut *cut = &session->now.kept.cut;
    OWNED(buf_release) struct buf words = {0}, opacity = {0};
    write_view(&words, session);
    TRY(export_note(picture, "iftty:view", &words, fault));
    if (!cut_is_none(cut)) {
        write_cut(&words, cut, &session->scene->grid);
        TRY(export_note(picture, "iftty:cut", &words, fault));
    }
    export_opacity(&opacity, &session->now.kept);
    if (opacity.length || opacity.failed)
        TRY(export_note(picture, "iftty:opacity", &opacity, fault));
    settings_write(&words, GROUP_LOOK, &session->now);
    return export_note(picture, "iftty:look", &words, fault);
}

static enum err add_label_note(struct picture *picture, const struct session *session,
                               const bool shown[256], struct fault *fault)
{
    struct buf labels = {0};
    if (!shown)
        return OK;
    /* {"1": {"name": "brain", "colour": "#d6b296"}, ...} of the labels shown. */
    const struct kept *kept = &session->now.kept;
    struct json json = {.out = &labels};
    char number[12];
    json_object(&json, NULL);
    for (unsigned label = 1; label < 256; label++) {
        const uint8_t *rgb = kept->palette.rgb[label];
        if (!shown[label])
            continue;
        snprintf(number, sizeof number, "%u", numbering_of(kept, label));
        json_object(&json, number);
        if (*kept->label_name[label])
            json_text(&json, "name", kept->label_name[label]);
        json_format(&json, "colour", "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
        json_end(&json);
    }
    json_end(&json);
    if (!labels.failed)
        labels.data[--labels.length] = '\0'; /* without its line feed */
    return export_note(picture, "iftty:labels", &labels, fault);
}

enum err export_notes(struct picture *picture, const struct session *session, const bool shown[256],
                      struct fault *fault)
{
    char scene[32];
    snprintf(scene, sizeof scene, "%016llx", (unsigned long long)session->scene_digest);
    const char *orientation = session->geometry.orientation == ORIENTATION_UNKNOWN ? "unknown"
                              : session->geometry.orientation == ORIENTATION_TOLD
                                  ? "set by the user"
                                  : NULL;
    TRY(picture_note(picture, "Software", "iftty " PROGRAM_VERSION, fault));
    if (orientation)
        TRY(picture_note(picture, "iftty:orientation", orientation, fault));
    if (*session->scene_name)
        TRY(picture_note(picture, "iftty:scene-name", session->scene_name, fault));
    TRY(picture_note(picture, "iftty:scene", scene, fault));
    TRY(add_view_notes(picture, session, fault));
    TRY(add_label_note(picture, session, shown, fault));
    picture->is_associated = true;
    return OK;
}

static enum err export_rendition_notes(struct picture *picture, const struct session *session,
                                       const bool shown[256], struct fault *fault)
{
    char scale[32], context[64]; /* not for slices, which have their own scale and no context */
    const int32_t *window = session->pictures->context.mip.of.window;
    snprintf(scale, sizeof scale, "%.9g", seen_mm_per_pixel(session));
    snprintf(context, sizeof context, "mip, intensities %d to %d", window[0], window[1]);
    TRY(export_notes(picture, session, shown, fault));
    if (session->now.outlook.context)
        TRY(picture_note(picture, "iftty:context", context, fault));
    if (session->geometry.spacing_unknown)
        return OK;
    picture->pixel_mm = seen_mm_per_pixel(session);
    return picture_note(picture, "iftty:mm-per-pixel", scale, fault);
}

/* ---- planes ---- */

static void list_labels(bool shown[256], const struct rendition *r)
{
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        shown[r->label[i]] = true;
}

static void export_fill(const struct picture *to, const struct session *session,
                        const struct rendition *r, size_t first)
{
    const size_t pixels = (size_t)to->width * to->height;
    uint32_t number[256];
    numbering_fill(number, &session->now.kept);
    /* Millimetres of a unit of depth: crossings are in 2^-24 pixels, times four. */
    const struct camera *camera = &session->pictures->camera;
    const double pixel_mm = (double)camera->unit_nm / 1e6 * 1000.0 / camera->view.zoom;
    const double unit_mm = pixel_mm / (double)(INT64_C(4) << 24);
    memcpy(to->rgba, r->rgba + 4 * first, 4 * pixels);
    for (size_t i = 0; to->depth_mm && i < pixels; i++) {
        const uint32_t cell = r->cell[first + i];
        const bool seen = cell != CELL_NONE;
        to->depth_mm[i] = seen ? (float)((double)r->depth[first + i] * unit_mm) : (float)INFINITY;
        to->label[i] = number[r->label[first + i]];
        to->voxel[i] = seen ? grid_voxel(&session->scene->grid, cell) : CELL_NONE;
    }
    if (to->normal)
        seen_normals(to->normal, r->normal + 4 * first, pixels, &session->geometry);
}

void export_form(struct picture *picture, const struct session *session)
{
    const struct outlook *outlook = &session->now.outlook;
    *picture = (struct picture){.width = outlook->view.width,
                                .height = outlook->view.height,
                                .is_clear = outlook->background == BACKGROUND_CLEAR,
                                .is_associated = true};
    seen_from(&picture->space, session);
}

enum err export_picture(struct picture *picture, const struct session *session, unsigned planes,
                        struct fault *fault)
{
    const struct rendition shown = session_picture(session);
    const uint32_t background = session->now.outlook.background;
    bool labels[256] = {false};
    TRY(picture_init(picture, shown.width, shown.height, planes, fault));
    list_labels(labels, &shown);
    export_fill(picture, session, &shown, 0);
    if (planes) {
        seen_from(&picture->space, session);
    } else {
        background_put(picture->rgba, shown.width, shown.height, background);
        picture->is_clear = background == BACKGROUND_CLEAR;
    }
    return export_rendition_notes(picture, session, labels, fault);
}

enum err export_background(struct picture *picture, const struct session *session,
                           struct fault *fault)
{
    const uint32_t background = session->now.outlook.background;
    const size_t bytes = (size_t)4 * picture->width * picture->height;
    picture->is_clear = background == BACKGROUND_CLEAR;
    if (picture->is_clear)
        return OK;
    picture->shown = mem_array(bytes, 1);
    if (!picture->shown)
        return fault_memory(fault, "a picture");
    memcpy(picture->shown, picture->rgba, bytes);
    background_put(picture->shown, picture->width, picture->height, background);
    return OK;
}

enum err export_normals(struct picture *picture, const struct session *session, struct fault *fault)
{
    const struct rendition *r = session_frame(session);
    const size_t pixels = (size_t)r->width * r->height;
    picture->normal = mem_array(pixels, 3 * sizeof *picture->normal);
    if (!picture->normal)
        return fault_memory(fault, "the normals of a picture");
    seen_normals(picture->normal, r->normal, pixels, &session->geometry);
    return OK;
}

/* ---- export in rows ---- */

struct exporting {
    const struct session *session;
    const struct picture *picture;
    struct strips *file;           /* or NULL */
    struct decorating *decorating; /* or NULL */
    const struct context *context; /* or NULL */
    pthread_mutex_t lock;          /* protects the members below */
    bool labels[256];              /* that are shown */
    uint64_t digest;               /* rendition_digest */
    enum err err;
    struct fault fault;
};

bool export_is_large(const struct session *session)
{
    const struct view *view = &session->now.outlook.view;
    return (uint64_t)view->width * view->height > SAMPLES_STORED_MOST;
}

/* Add context and decorations to some rows, as the file shows them. */
static enum err finish_colours(const struct exporting *e, const struct rendition *rows,
                               uint32_t top, struct fault *fault)
{
    const uint32_t width = rows->width;
    if (e->context)
        mip_put_behind(rows->rgba, rows->rgba, e->context->mip.brightness + (size_t)top * width,
                       (size_t)rows->height * width);
    if (e->context || e->decorating)
        memset(rows->blank, 0, (size_t)rows->tiles_x * rows->tiles_y * sizeof *rows->blank);
    if (!e->decorating)
        return OK;
    const size_t pixels = (size_t)rows->height * width;
    OWNED(mem_release) uint8_t *layer = mem_new(4 * pixels);
    const struct canvas canvas = {.width = width,
                                  .height = e->picture->height,
                                  .stride = width,
                                  .rgba = layer,
                                  .from = top,
                                  .rows = rows->height};
    if (!layer)
        return fault_memory(fault, "decorations of a picture");
    TRY(decoration_draw(&canvas, &e->decorating->of, fault));
    canvas_lay_over(layer, rows->rgba, pixels);
    memcpy(rows->rgba, layer, 4 * pixels);
    return OK;
}

/* Get memory of row `top` of the picture and of those after it; false if there is no memory to
 * fill. */
static bool lend_rows(const struct exporting *e, uint32_t top, uint32_t most, struct picture *to)
{
    if (e->file)
        return strips_lend(e->file, top, most, to) > 0;
    if (e->picture->rgba)
        *to = picture_rows(e->picture, top, most);
    return e->picture->rgba;
}

static void take_rows(void *context, const struct rendition *rows, uint32_t top)
{
    struct exporting *e = context;
    const uint32_t height = e->picture->height, width = rows->width;
    bool labels[256] = {false};
    struct fault fault = {0};
    struct picture to;
    const enum err err = finish_colours(e, rows, top, &fault);
    const uint64_t digest = rendition_digest_rows(rows, top);
    list_labels(labels, rows);
    pthread_mutex_lock(&e->lock);
    for (int label = 0; label < 256; label++)
        e->labels[label] |= labels[label];
    e->digest += digest;
    if (err && !e->err) {
        e->err = err;
        e->fault = fault;
    }
    pthread_mutex_unlock(&e->lock);
    for (uint32_t y = 0; y < rows->height && lend_rows(e, top + y, rows->height - y, &to);
         y += to.height) {
        export_fill(&to, e->session, rows, (size_t)y * width);
        if (!to.depth_mm)
            background_put_rows(to.rgba, width, top + y, to.height, height,
                                e->session->now.outlook.background);
        if (e->file)
            strips_give(e->file, top + y, to.height);
    }
}

/* A stored rendition of one sample a pixel is kept, so that a rollback needs no memory; others, and
 * large ones, are released. */
static enum err draw_rows(struct exporting *e, struct session *session, const struct labels *labels,
                          enum render_mode mode, struct fault *fault)
{
    const struct outlook *outlook = &session->now.outlook;
    struct pictures *p;
    TRY(pictures_begin(&p, session, fault));
    if (outlook->decorations) {
        TRY(decorating_begin(&e->decorating, session, labels, fault));
        TRY(session_aim(session, outlook, &e->decorating->camera, fault));
    }
    if (outlook->look.samples > 1 || export_is_large(session))
        pictures_release_rendition(p);
    e->context = outlook->context ? &p->context : NULL;
    e->digest = rendition_digest_begin(outlook->view.width, outlook->view.height);
    p->rendered = RENDERED_NOT;
    p->take = take_rows;
    p->take_context = e;
    enum err err = session_draw_labels(session, labels, mode, fault);
    p->take = NULL;
    p->rendered = RENDERED_NOT;
    return !err && e->err ? fault_set(fault, e->err, "%s", e->fault.text) : err;
}

enum err export_rows(struct picture *picture, struct strips *file, struct session *session,
                     const struct labels *labels, enum render_mode mode, uint64_t *digest,
                     struct fault *fault)
{
    struct exporting e = {.session = session, .picture = picture, .file = file};
    pthread_mutex_init(&e.lock, NULL);
    const enum err err = draw_rows(&e, session, labels, mode, fault);
    pthread_mutex_destroy(&e.lock);
    decorating_end(e.decorating);
    *digest = e.digest;
    return err ? err : export_rendition_notes(picture, session, e.labels, fault);
}
