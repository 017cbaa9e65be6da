#include "report/export.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "base/json.h"
#include "base/mem.h"
#include "engine/margin.h"
#include "image/volume.h"
#include "session/session.h"
#include "session/session_inside.h"
#include "show/decorating.h"
#include "show/draw.h"
#include "show/drawn_colours.h"
#include "session/numbering.h"
#include "show/seen_from.h"
#include "session/setting.h"

/* One pixel of depth in millimetres: crossings count 2^-24 pixels, four times. */
static double depth_unit_mm(const struct camera *camera)
{
    double pixel_mm = (double)camera->unit_nm / 1e6 * 1000.0 / camera->view.zoom;
    return pixel_mm / (double)(INT64_C(4) << 24);
}

/* Angles, zoom and size; where the middle of the picture is not the scene's, the focus as it is
 * held (render/view.h). */
static void write_view(struct buf *out, const struct view *view)
{
    buf_printf(out, "%d %d %d zoom %u size %ux%u", view->angle[0], view->angle[1], view->angle[2],
               view->zoom, view->width, view->height);
    if (view->focus[0] || view->focus[1] || view->focus[2])
        buf_printf(out, " focus %lld %lld %lld", (long long)view->focus[0],
                   (long long)view->focus[1], (long long)view->focus[2]);
}

/* The same of look 2, with units, and the middle in voxels as they are numbered. */
static void write_view_in_words(struct buf *out, const struct session *session)
{
    const struct view *view = &session_outlook(session)->view;
    buf_printf(out, "yaw %g pitch %g roll %g degrees, zoom %g, %ux%u pixels",
               view->angle[0] / 1000.0, view->angle[1] / 1000.0, view->angle[2] / 1000.0,
               view->zoom / 1000.0, view->width, view->height);
    for (int a = 0; a < 3; a++)
        buf_printf(out, "%s%.7g", a ? "," : ", voxel ",
                   (session_scene(session)->grid.size[a] - 1) / 2.0 +
                       (double)view->focus[a] / (1 << VIEW_FOCUS_BITS));
    buf_add_text(out, " in the middle");
}

/* In voxels, as it is held (render/cut.h): "kept x 0-180 y 0-216 z 40-120 plane ... box ...". */
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
    struct buf others = {0};
    for (unsigned label = 1; label < 256; label++)
        if (opacity[label] != usual)
            buf_printf(&others, ", %u %% of label %u", opacity[label], label);
    if (usual < BORDER_OPAQUE || others.length)
        buf_printf(out, "%u %%%s", usual, buf_text(&others));
    out->failed |= others.failed;
    buf_release(&others);
}

/* How the scene is seen: notes that need words made for them. */
static enum err add_view_notes(struct picture *picture, const struct session *session,
                               struct fault *fault)
{
    const struct cut *away = &session_kept(session)->cut;
    const struct outlook *outlook = session_outlook(session);
    struct buf seen = {0}, cut = {0}, opacity = {0}, look = {0};
    if (outlook->look.number == LOOK_FIRST)
        write_view(&seen, &outlook->view);
    else
        write_view_in_words(&seen, session);
    settings_write(&look, GROUP_LOOK, session_state(session));
    write_cut(&cut, away, &session_scene(session)->grid);
    export_opacity(&opacity, session_kept(session));
    const bool fits = !seen.failed && !cut.failed && !opacity.failed && !look.failed;
    enum err err = fits ? OK : fault_memory(fault, "a note on a picture");
    if (!err)
        err = picture_note(picture, "iftty:view", buf_text(&seen), fault);
    if (!err && !cut_is_none(away))
        err = picture_note(picture, "iftty:cut", buf_text(&cut), fault);
    if (!err && opacity.length)
        err = picture_note(picture, "iftty:opacity", buf_text(&opacity), fault);
    if (!err)
        err = picture_note(picture, "iftty:look", buf_text(&look), fault);
    buf_release(&seen);
    buf_release(&cut);
    buf_release(&opacity);
    buf_release(&look);
    return err;
}

/* {"1": {"name": "brain", "colour": "#d6b296"}, ...} of the labels that a picture shows. */
static void write_labels(struct buf *out, const struct label_set *shown, const struct kept *kept)
{
    struct json json = {.out = out};
    char number[12];
    json_object(&json, NULL);
    for (unsigned label = 1; label < 256; label++) {
        const uint8_t *rgb = kept->palette.rgb[label];
        if (!label_set_has(shown, label))
            continue;
        snprintf(number, sizeof number, "%u", label);
        json_object(&json, number);
        if (*kept->label_name[label])
            json_text(&json, "name", kept->label_name[label]);
        if (kept->label_number[label])
            json_count(&json, "number", kept->label_number[label]);
        json_format(&json, "colour", "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
        json_end(&json);
    }
    json_end(&json);
    if (!out->failed)
        out->data[--out->length] = '\0'; /* no line feed */
}

static enum err add_label_note(struct picture *picture, const struct session *session,
                               const struct label_set *shown, struct fault *fault)
{
    struct buf labels = {0};
    if (session_outlook(session)->look.number == LOOK_FIRST || !shown)
        return OK;
    write_labels(&labels, shown, session_kept(session));
    const enum err err = labels.failed
                             ? fault_memory(fault, "a note on a picture")
                             : picture_note(picture, "iftty:labels", buf_text(&labels), fault);
    buf_release(&labels);
    return err;
}

static enum err note_context(struct picture *picture, const struct session *session,
                             struct fault *fault)
{
    char words[64];
    const int32_t *window = session->context.mip.of.window;
    snprintf(words, sizeof words, "mip, intensities %d to %d", window[0], window[1]);
    return picture_note(picture, "iftty:context", words, fault);
}

enum err export_notes(struct picture *picture, const struct session *session,
                      const struct label_set *shown, struct fault *fault)
{
    char scene[32];
    snprintf(scene, sizeof scene, "%016llx", (unsigned long long)session_scene_digest(session));
    const enum orientation orientation = session_geometry(session)->orientation;
    enum err err = picture_note(picture, "Software", "iftty " PROGRAM_VERSION, fault);
    if (!err && orientation == ORIENTATION_UNKNOWN)
        err = picture_note(picture, "iftty:orientation", "unknown", fault);
    if (!err && orientation == ORIENTATION_TOLD)
        err = picture_note(picture, "iftty:orientation", "as told by the user", fault);
    if (!err && *session_scene_name(session))
        err = picture_note(picture, "iftty:scene-name", session_scene_name(session), fault);
    if (!err)
        err = picture_note(picture, "iftty:scene", scene, fault);
    if (!err)
        err = add_view_notes(picture, session, fault);
    if (!err)
        err = add_label_note(picture, session, shown, fault);
    if (!err && session_outlook(session)->context)
        err = note_context(picture, session, fault);
    picture->is_associated = session_outlook(session)->look.number > LOOK_FIRST;
    return err;
}

/* Of a rendition; slices have a scale of their own. */
static enum err add_scale_note(struct picture *picture, const struct session *session,
                               struct fault *fault)
{
    char scale[32];
    if (session_outlook(session)->look.number == LOOK_FIRST ||
        session_geometry(session)->spacing_unknown)
        return OK;
    snprintf(scale, sizeof scale, "%.9g", seen_mm_per_pixel(session));
    return picture_note(picture, "iftty:mm-per-pixel", scale, fault);
}

/* What a picture of a rendition says of itself. After an error it is released. */
static enum err describe_rendition(struct picture *picture, const struct session *session,
                                   const struct label_set *shown, struct fault *fault)
{
    enum err err = export_notes(picture, session, shown, fault);
    if (!err)
        err = add_scale_note(picture, session, fault);
    if (err)
        picture_release(picture);
    return err;
}

enum err export_picture(struct picture *picture, const struct session *session, struct fault *fault)
{
    const struct rendition shown = session_picture(session), *r = &shown;
    struct label_set labels = {{0}};
    enum err err = picture_init(picture, r->width, r->height, true, fault);
    if (err)
        return err;
    label_set_add(&labels, r);
    const double unit_mm = depth_unit_mm(session_camera(session));
    for (size_t i = 0; i < (size_t)r->width * r->height; i++) {
        bool seen = r->cell[i] != CELL_NONE;
        for (int k = 0; k < 4; k++)
            picture->rgba[4 * i + (size_t)k] = r->rgba[4 * i + (size_t)k];
        picture->depth_mm[i] = seen ? (float)((double)r->depth[i] * unit_mm) : (float)INFINITY;
        picture->label[i] = r->label[i];
        picture->voxel[i] =
            seen ? grid_voxel(&session_scene(session)->grid, r->cell[i]) : CELL_NONE;
    }
    seen_from(&picture->space, session);
    return describe_rendition(picture, session, &labels, fault);
}

enum err export_colours(struct picture *picture, const struct session *session, struct fault *fault)
{
    const struct rendition shown = session_picture(session), *r = &shown;
    struct label_set labels = {{0}};
    const enum err err = picture_init(picture, r->width, r->height, false, fault);
    if (err)
        return err;
    label_set_add(&labels, r);
    memcpy(picture->rgba, r->rgba, (size_t)4 * r->width * r->height);
    background_put(picture->rgba, r->width, r->height, session_behind_colours(session));
    picture->is_clear = session_outlook(session)->background == BACKGROUND_CLEAR;
    return describe_rendition(picture, session, &labels, fault);
}

enum err export_drawn(struct picture *picture, struct session *session, const struct labels *labels,
                      uint64_t *digest, struct fault *fault)
{
    const struct view *view = &session_outlook(session)->view;
    enum err err = picture_init(picture, view->width, view->height, false, fault);
    if (err)
        return err;
    struct drawn_colours colours = {.rgba = picture->rgba};
    err = session_draw_colours(session, labels, &colours, fault);
    if (err) {
        picture_release(picture);
        return err;
    }
    *digest = colours.digest;
    const struct label_set shown = drawn_labels(&colours);
    picture->is_clear = session_outlook(session)->background == BACKGROUND_CLEAR;
    return describe_rendition(picture, session, &shown, fault);
}

enum err export_background(struct picture *picture, const struct session *session,
                           struct fault *fault)
{
    const uint32_t background = session_outlook(session)->background;
    const size_t bytes = (size_t)4 * picture->width * picture->height;
    picture->is_clear = background == BACKGROUND_CLEAR;
    if (picture->is_clear || background == BACKGROUND_FADE)
        return OK;
    picture->shown = mem_array(bytes, 1);
    if (!picture->shown)
        return fault_memory(fault, "a picture");
    memcpy(picture->shown, picture->rgba, bytes);
    background_put(picture->shown, picture->width, picture->height, background);
    return OK;
}

void export_normals_to_world(float *out, const int16_t *normal, size_t pixels,
                             const struct scene *scene)
{
    for (size_t i = 0; i < pixels; i++)
        for (int a = 0; a < 3; a++) {
            const uint8_t axis = (uint8_t)scene->world_axis[a];
            out[3 * i + axis] =
                (float)(normal[4 * i + (size_t)a] * scene->world_sign[a]) / 16384.0f;
        }
}

enum err export_normals(struct picture *picture, const struct session *session, struct fault *fault)
{
    const struct rendition *r = session_frame(session);
    const size_t pixels = (size_t)r->width * r->height;
    enum err err = picture_add_normals(picture, fault);
    if (!err && session_outlook(session)->look.number > LOOK_FIRST)
        seen_normals(picture->normal, r->normal, pixels, session_geometry(session));
    else if (!err)
        export_normals_to_world(picture->normal, r->normal, pixels, session_scene(session));
    return err;
}

struct map_source {
    const struct session *session;
    const struct labels *labels;
    enum map map;
    uint16_t *margin;     /* by cell, where that is asked for */
    uint16_t number[256]; /* of labels, in the file, */
    bool is_wide;         /* which takes two bytes for some */
};

static void fill_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct map_source *source = context;
    const struct session *session = source->session;
    struct span row = grid_row(&session_scene(session)->grid, y, z);
    uint8_t *byte = values;
    uint16_t *pair = values;
    uint32_t *root = values;
    for (uint32_t c = row.first; c < row.end; c++) {
        const struct cell *cell = session_scene(session)->cell + c;
        bool reached = cell_is_reached(cell);
        switch (source->map) {
        case MAP_LABELS:
            if (source->is_wide)
                *pair++ = source->number[labels_at(source->labels, c)];
            else
                *byte++ = (uint8_t)source->number[labels_at(source->labels, c)];
            break;
        case MAP_BORDER:
            *byte++ = border_holds(session_border(session), c);
            break;
        case MAP_COST:
            *pair++ = reached ? (uint16_t)key_cost(cell->key) : UINT16_MAX;
            break;
        case MAP_DISTANCE:
            *pair++ = reached ? (uint16_t)key_hops(cell->key) : UINT16_MAX;
            break;
        case MAP_MARGIN:
            *pair++ = source->margin[c];
            break;
        case MAP_ROOT:
            *root++ = reached ? grid_voxel(&session_scene(session)->grid, key_root(cell->key))
                              : CELL_NONE;
            break;
        }
    }
}

void export_labels(struct volume_label label[256], const struct kept *kept)
{
    for (int l = 0; l < 256; l++) {
        label[l].name = kept->label_name[l];
        label[l].number = numbering_of(kept, (unsigned)l);
        memcpy(label[l].rgb, kept->palette.rgb[l], sizeof label[l].rgb);
    }
}

/* What a file says that it is. */
static void describe(struct buf *out, const char *description, const struct map_source *source)
{
    buf_add_text(out, description);
    if (source->map != MAP_LABELS || !source->labels->finished)
        return;
    buf_add_text(out, ", finished: ");
    finish_write(out, &session_kept(source->session)->finish);
}

/* What labels are in the file: none of those that the map has is another. */
static enum err number_labels(struct map_source *source, struct fault *fault)
{
    const struct kept *kept = session_kept(source->session);
    const struct grid *grid = &session_scene(source->session)->grid;
    bool used[256] = {false};
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                used[labels_at(source->labels, c)] = true;
        }
    for (unsigned l = 0; l < 256; l++) {
        source->number[l] = numbering_of(kept, l);
        source->is_wide |= used[l] && source->number[l] > 255;
    }
    return numbering_check(kept, used, fault);
}

enum err export_map(const struct session *session, enum map map, const struct labels *labels,
                    const char *path, enum file_mode mode, struct fault *fault)
{
    static const struct {
        enum voxel_type type;
        const char *description;
    } form[] = {[MAP_LABELS] = {VOXEL_UINT8, "iftty labels"},
                [MAP_COST] = {VOXEL_UINT16, "iftty path cost"},
                [MAP_ROOT] = {VOXEL_UINT32, "iftty root: voxel index of the seed"},
                [MAP_BORDER] = {VOXEL_UINT8, "iftty border"},
                [MAP_DISTANCE] = {VOXEL_UINT16, "iftty plateau distance: steps since a rise"},
                [MAP_MARGIN] = {VOXEL_UINT16, "iftty margin: cost of the next best label, less"}};
    struct map_source source = {.session = session, .labels = labels, .map = map};
    struct volume_label label[256];
    struct buf description = {0};
    enum err err = map == MAP_MARGIN   ? margin_new(&source.margin, session_forest(session), fault)
                   : map == MAP_LABELS ? number_labels(&source, fault)
                                       : OK;
    if (err)
        return err;
    export_labels(label, session_kept(session));
    describe(&description, form[map].description, &source);
    const struct volume_map written = {session_scene(session)->grid.size,
                                       session_geometry(session),
                                       source.is_wide ? VOXEL_UINT16 : form[map].type,
                                       buf_text(&description),
                                       fill_row,
                                       &source,
                                       map == MAP_LABELS ? label : NULL};
    err = description.failed ? fault_memory(fault, "a map")
                             : volume_write(path, mode, &written, session_watch(session), fault);
    buf_release(&description);
    free(source.margin);
    return err;
}

/* ",12,70,110,95" for a seed that has a reach. */
static void write_reach(struct buf *out, const struct reach *reach)
{
    if (!reach)
        return;
    if (reach->unit[0] == 1)
        buf_printf(out, ",%lld", (long long)reach->radius);
    else
        buf_printf(out, ",%lld.%06lldmm", (long long)(reach->radius / 1000000),
                   (long long)(reach->radius % 1000000));
    buf_printf(out, ",%u,%u,%u", reach->centre[0], reach->centre[1], reach->centre[2]);
}

enum err export_seeds(struct buf *out, const struct session *session, struct fault *fault)
{
    const struct grid *grid = &session_scene(session)->grid;
    struct task task = task_begin(session_watch(session), "seeds", grid->voxels);
    buf_add_text(out, forest_limited_seeds(session_forest(session))
                          ? "x,y,z,label,within,of x,of y,of z\n"
                          : "x,y,z,label\n");
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                if (session_scene(session)->cell[c].flags & CELL_SEED) {
                    buf_printf(out, "%u,%u,%u,%u", c - row.first, y, z,
                               session_scene(session)->cell[c].label);
                    write_reach(out, forest_reach(session_forest(session), c));
                    buf_add_char(out, '\n');
                }
        }
    return out->failed ? fault_memory(fault, "a list of seeds")
                       : watch_fault(session_watch(session), fault);
}
