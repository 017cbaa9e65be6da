/* SPDX-License-Identifier: MIT */
#include "show/slicing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/mosaic.h"
#include "image/geometry.h"
#include "session/markers.h"
#include "session/state.h"
#include "show/draw.h"
#include "show/export_picture.h"

/* ---- style and titles ---- */

/* Memory that a slice or mosaic borrows while it is drawn. */
struct sketch {
    struct slice_style style;
    struct slice_mark *mark;
    struct under {
        const struct markers *markers;
        uint32_t marker;
    } under; /* the marker under the cross-hair */
    char least[WINDOW_WORDS_BYTES], most[WINDOW_WORDS_BYTES];
    char title[3][64];
};

/* List the seeds that wait, and eliminators. */
static bool list_marks(struct sketch *sketch, const struct session *session)
{
    const struct edit_lists *lists = &session->now.lists;
    const struct edit *seed = edits_first(&lists->pending), *put = edits_first(&lists->eliminators);
    const size_t seeds = edits_count(&lists->pending), puts = edits_count(&lists->eliminators);
    struct slice_mark *mark = sketch->mark = mem_array(seeds + puts, sizeof *mark);
    if (!mark)
        return false;
    for (size_t i = 0; i < seeds; i++)
        if (seed[i].label != EDIT_ERASE)
            *mark++ = (struct slice_mark){seed[i].cell, (uint8_t)seed[i].label, false, true};
    for (size_t i = 0; i < puts; i++)
        *mark++ = (struct slice_mark){put[i].cell, 0, true, i >= lists->applied};
    sketch->style.mark = sketch->mark;
    sketch->style.marks = (size_t)(mark - sketch->mark);
    return true;
}

/* Write "axial 90" and its place in the world, "S 18.0 mm"; a place too far away for tenths as "S
 * 1e+18 mm". With an unknown orientation: "z 90". */
static void write_title(char out[64], const struct session *session, enum slice_plane plane)
{
    static const char side[3][2] = {{'I', 'S'}, {'P', 'A'}, {'L', 'R'}};
    const uint32_t *cross = session->now.outlook.slices.cross;
    const uint32_t index = cross[slice_axis(session->scene, plane)];
    double point_mm[3];
    geometry_point(&session->geometry, cross, point_mm);
    const double mm = point_mm[2 - plane];
    const bool is_far = fabs(mm) >= 1e9;
    const long long tenths = is_far ? 0 : llround(mm * 10);
    const char *name = slice_name(session->scene, plane);
    if (session->scene->sides_unknown) {
        snprintf(out, 64, "%s %u\norientation unknown", name, index);
        return;
    }
    if (!geometry_has_place(&session->geometry)) {
        const bool is_told = session->geometry.orientation == ORIENTATION_TOLD;
        snprintf(out, 64, "%s %u%s", name, index, is_told ? "\nsides set by user" : "");
        return;
    }
    const int n =
        snprintf(out, 64, "%s %u\n%c ", name, index, side[plane][is_far ? mm > 0 : tenths >= 0]);
    if (is_far)
        snprintf(out + n, 64 - (size_t)n, "%.6g mm", fabs(mm));
    else
        snprintf(out + n, 64 - (size_t)n, "%lld.%lld mm", llabs(tenths) / 10, llabs(tenths) % 10);
}

static bool is_under(const void *of, uint32_t cell)
{
    const struct under *under = of;
    return markers_at(under->markers, cell) == under->marker;
}

static enum err sketch_init(struct sketch *sketch, struct session *session, struct fault *fault)
{
    const struct slice_settings *s = &session->now.outlook.slices;
    int32_t window[2];
    *sketch = (struct sketch){.style = {.overlay = s->overlay,
                                        .palette = &session->now.kept.palette,
                                        .visible = session->now.kept.visible,
                                        .crosses = s->crosses,
                                        .marks_seeds = s->marks,
                                        .marked = {markers_show, &session->markers},
                                        .least = sketch->least,
                                        .most = sketch->most}};
    if (s->marks && !list_marks(sketch, session))
        return fault_memory(fault, "the marks of a slice");
    window_of(window, session);
    slice_window(sketch->style.grey, window[0], window[1]);
    window_words(sketch->least, sketch->most, session);
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++)
        write_title(sketch->title[plane], session, plane);
    return OK;
}

/* A zoomed slice shows voxels without smoothing. */
static struct slice_choice slice_of(const struct session *session, enum slice_kind kind,
                                    const struct sketch *sketch)
{
    const struct slice_settings *s = &session->now.outlook.slices;
    const struct view *view = &session->now.outlook.view;
    const enum slice_plane plane = (enum slice_plane)kind;
    struct slice_choice choice = {.plane = plane, .has_middle = s->has_middle};
    for (int a = 0; a < 3; a++) {
        choice.place[a] = s->cross[a];
        choice.middle[a] = s->middle[a];
    }
    if (s->zoom)
        choice.pixel_pm = slice_zoomed_pixel(session->scene, s->zoom);
    else
        slice_magnify(&choice, session->scene,
                      slice_fitting_pixel(session->scene, plane, view->width, view->height),
                      s->times);
    if (s->words && sketch) {
        choice.notes = SLICE_LETTERS | SLICE_SCALE | SLICE_COLOURS;
        choice.title = sketch->title[kind];
    }
    return choice;
}

static struct mosaic_choice mosaic_of(const struct session *session, const struct sketch *sketch)
{
    const struct slice_settings *s = &session->now.outlook.slices;
    const bool says = s->words && sketch;
    struct mosaic_choice choice = {.notes = says,
                                   .team = session->team,
                                   .times = s->times,
                                   .has_middle = s->has_middle,
                                   .background = session->now.outlook.background};
    for (int i = 0; i < 3; i++) {
        choice.place[i] = s->cross[i];
        choice.middle[i] = s->middle[i];
        choice.title[i] = says ? sketch->title[i] : NULL;
    }
    return choice;
}

struct mosaic_choice slicing_choice(const struct session *session)
{
    return mosaic_of(session, NULL);
}

enum err slicing_check_size(const struct view *view, struct fault *fault)
{
    if (view->width >= MOSAIC_SIDE_LEAST && view->height >= MOSAIC_SIDE_LEAST)
        return OK;
    return fault_set(fault, ERR_LIMIT,
                     "a mosaic needs %dx%d pixels or more, and the view has %ux%u; enlarge it with "
                     "`size`; nothing has changed",
                     MOSAIC_SIDE_LEAST, MOSAIC_SIDE_LEAST, view->width, view->height);
}

static enum err prepare_mosaic(struct session *session, enum slice_kind kind,
                               const struct labels *labels, struct fault *fault)
{
    if (kind != SLICE_KIND_MOSAIC)
        return OK;
    TRY(slicing_check_size(&session->now.outlook.view, fault));
    return labels ? session_draw_labels(session, labels, RENDER_AS_KEPT, fault)
                  : session_draw(session, RENDER_AS_KEPT, fault);
}

/* Fill a canvas, which is released on error: a slice, a mosaic, or that of a panel with its
 * rendition. */
static enum err draw_canvas(struct canvas *canvas, struct session *session, enum slice_kind kind,
                            const struct labels *labels, struct slicing_panel *panel,
                            const struct glance *glance, struct fault *fault)
{
    struct sketch sketch;
    enum err err = sketch_init(&sketch, session, fault);
    sketch.style.finished = labels ? labels->finished : NULL;
    if (panel) {
        /* Marks on a screen are thin, so that they hide little; those of the marker under the
         * cross-hair are filled. Files have always had larger marks. */
        const uint32_t *cross = session->now.outlook.slices.cross;
        const uint32_t cell = grid_cell(&session->scene->grid, cross[0], cross[1], cross[2]);
        sketch.under.markers = &session->markers;
        sketch.under.marker = markers_at(sketch.under.markers, cell);
        sketch.style.thin = true;
        if (sketch.under.marker)
            sketch.style.filled = (struct mark_choice){is_under, &sketch.under};
    }
    if (!err && kind == SLICE_KIND_MOSAIC) {
        struct mosaic_choice choice = mosaic_of(session, panel && !panel->words ? NULL : &sketch);
        choice.layout = panel ? &panel->layout : NULL;
        choice.coarse = glance ? glance->coarse : 1;
        err =
            mosaic_draw(canvas, session->scene, glance ? glance->rendition : session_frame(session),
                        &choice, &sketch.style, fault);
        choice.coarse = 1; /* queries refer to pixels of the full rendition */
        for (int i = 0; i < 3; i++)
            choice.title[i] = NULL;
        if (panel)
            panel->choice = choice;
    } else if (!err) {
        const struct slice_choice choice = slice_of(session, kind, &sketch);
        err = slice_draw(canvas, session->scene, &choice, &sketch.style, fault);
    }
    free(sketch.mark);
    if (err)
        canvas_release(canvas);
    return err;
}

enum err slicing_draw(struct canvas *canvas, struct session *session, enum slice_kind kind,
                      const struct labels *labels, bool tells_cells, struct fault *fault)
{
    const struct view *view = &session->now.outlook.view;
    *canvas = (struct canvas){0};
    TRY(prepare_mosaic(session, kind, labels, fault));
    TRY(canvas_init(canvas, view->width, view->height, tells_cells ? CANVAS_CELLS : 0, fault));
    return draw_canvas(canvas, session, kind, labels, NULL, NULL, fault);
}

enum err slicing_draw_panel(struct canvas *canvas, struct session *session,
                            struct slicing_panel *panel, struct fault *fault)
{
    const struct mosaic_screen *screen = &panel->screen;
    struct labels labels;
    struct glance glance;
    if (!mosaic_fits(screen)) {
        canvas_release(canvas);
        return fault_set(
            fault, ERR_LIMIT, "the panes need %dx%d pixels or more, in %dx%d characters",
            MOSAIC_SIDE_LEAST, MOSAIC_SIDE_LEAST, MOSAIC_COLUMNS_LEAST, MOSAIC_ROWS_LEAST);
    }
    mosaic_lay_out(&panel->layout, session->scene, screen);
    const struct mosaic_box *box = &panel->layout.box[MOSAIC_RENDITION];
    const uint32_t room[] = {box->width, box->height};
    enum err err = session_draw_fitting(session, room, panel->within_ns, &glance, &labels, fault);
    panel->is_hasty = !err && glance.is_hasty;
    if (err)
        canvas_release(canvas);
    else
        err = canvas_renew(canvas, screen->width, screen->height, fault);
    return err ? err
               : draw_canvas(canvas, session, SLICE_KIND_MOSAIC, &labels, panel, &glance, fault);
}

enum err slicing_draw_below(struct canvas *canvas, struct session *session,
                            const struct slicing_panel *panel, enum slice_plane plane,
                            const uint32_t place[3], struct fault *fault)
{
    const struct mosaic_box *box = &panel->layout.box[plane];
    struct mosaic_choice choice = panel->choice;
    struct slice_style style = {.overlay = SLICE_PLAIN,
                                .palette = &session->now.kept.palette,
                                .visible = session->now.kept.visible};
    int32_t window[2];
    choice.layout = &panel->layout;
    choice.notes = false;
    memcpy(choice.place, place, sizeof choice.place);
    window_of(window, session);
    slice_window(style.grey, window[0], window[1]);
    const struct slice_choice slice =
        mosaic_slice(session->scene, &choice, panel->screen.width, panel->screen.height, plane);
    enum err err = canvas_init(canvas, box->width, box->height, CANVAS_NOTES, fault);
    if (!err)
        err = slice_draw(canvas, session->scene, &slice, &style, fault);
    if (err)
        canvas_release(canvas);
    return err;
}

enum err slicing_cell_at(uint32_t *cell, struct session *session, enum slice_kind kind,
                         const struct labels *labels, uint32_t column, uint32_t row,
                         struct fault *fault)
{
    const struct view *view = &session->now.outlook.view;
    TRY(prepare_mosaic(session, kind, labels, fault));
    if (kind == SLICE_KIND_MOSAIC) {
        const struct mosaic_choice choice = mosaic_of(session, NULL);
        *cell = mosaic_cell_at(session->scene, view->width, view->height, session_frame(session),
                               &choice, column, row);
    } else {
        const struct slice_choice choice = slice_of(session, kind, NULL);
        *cell = slice_cell_at(session->scene, &choice, view->width, view->height, column, row);
    }
    return OK;
}

/* ---- export ---- */

/* Note "axial" or "mosaic", with the cross-hair's place and the zoom. */
static enum err note_kind(struct picture *picture, const struct session *session,
                          enum slice_kind kind, struct fault *fault)
{
    const struct slice_settings *s = &session->now.outlook.slices;
    const bool is_mosaic = kind == SLICE_KIND_MOSAIC;
    struct buf words = {0};
    buf_printf(&words, is_mosaic ? "mosaic%s through " : "%s through ",
               is_mosaic ? "" : slice_name(session->scene, (enum slice_plane)kind));
    buf_printf(&words, "%u,%u,%u", s->cross[0], s->cross[1], s->cross[2]);
    if (s->zoom && !is_mosaic)
        buf_printf(&words, " zoom %u", s->zoom);
    if (s->times != SLICE_TIMES_ONE)
        buf_printf(&words, " magnified %u", s->times);
    if (s->has_middle)
        buf_printf(&words, " around %u,%u,%u", s->middle[0], s->middle[1], s->middle[2]);
    return export_note(picture, "iftty:slice", &words, fault);
}

enum err slicing_export(struct picture *picture, const struct session *session,
                        enum slice_kind kind, const struct labels *labels,
                        const struct canvas *canvas, struct fault *fault)
{
    const size_t pixels = (size_t)canvas->width * canvas->height;
    bool shown[256] = {false};
    uint32_t number[256];
    numbering_fill(number, &session->now.kept);
    TRY(picture_init(picture, canvas->width, canvas->height, PICTURE_LABEL | PICTURE_VOXEL, fault));
    memcpy(picture->rgba, canvas->rgba, 4 * pixels);
    for (size_t i = 0; i < pixels; i++) {
        const uint32_t cell = canvas->cell[i];
        const bool shows = cell != CELL_NONE;
        const uint8_t label = shows ? labels_at(labels, cell) : 0;
        shown[label] = true;
        picture->label[i] = number[label];
        picture->voxel[i] = shows ? grid_voxel(&session->scene->grid, cell) : CELL_NONE;
    }
    TRY(export_notes(picture, session, shown, fault));
    return note_kind(picture, session, kind, fault);
}
