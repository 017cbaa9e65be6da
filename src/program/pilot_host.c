#include "program/pilot_host.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "command/answers.h"
#include "engine/centre.h"
#include "engine/hints.h"
#include "engine/rival.h"
#include "program/pilot_marks.h"
#include "program/shown.h"
#include "render/mosaic.h"
#include "render/text.h"
#include "render/view.h"
#include "report/label_report.h"
#include "session/held.h"
#include "session/hinting.h"
#include "session/markers.h"
#include "session/session.h"
#include "session/session_inside.h"
#include "session/tally.h"
#include "show/draw.h"
#include "show/live_finish.h"
#include "show/slicing.h"
#include "show/window.h"
#include "tui/pilot/setup.h"

static const uint8_t marked_pane[3] = {230, 200, 90}, words_rgb[3] = {200, 200, 200};

static struct session *session_of(void *context)
{
    return ((struct pilot_interpreter *)context)->interp->session;
}

/* The plane of a pane of slices. */
static enum slice_plane plane_of(enum pilot_pane pane)
{
    return pane == PILOT_AXIAL     ? SLICE_AXIAL
           : pane == PILOT_CORONAL ? SLICE_CORONAL
                                   : SLICE_SAGITTAL;
}

static enum mosaic_pane mosaic_of(enum pilot_pane pane)
{
    static const enum mosaic_pane of[PILOT_PANES] = {
        [PILOT_AXIAL] = MOSAIC_AXIAL,
        [PILOT_CORONAL] = MOSAIC_CORONAL,
        [PILOT_SAGITTAL] = MOSAIC_SAGITTAL,
        [PILOT_RENDITION] = MOSAIC_RENDITION,
    };
    return of[pane];
}

static uint32_t cell_at_cross(const struct session *session)
{
    const uint32_t *p = session_outlook(session)->slices.cross;
    return grid_cell(&session_scene(session)->grid, p[0], p[1], p[2]);
}

static void place_of(const struct session *session, uint32_t cell, uint32_t place[3])
{
    const struct place p = grid_place(&session_scene(session)->grid, cell);
    place[0] = p.x;
    place[1] = p.y;
    place[2] = p.z;
}

/* ---- facts ---- */

/* "label 2 cerebellum 142 ml (+1.2 ml)": all of the label, and what the last edit changed of it. */
static void write_label(struct buf *out, const struct session *session, unsigned label)
{
    const uint64_t *before = session_voxels_before_edit(session);
    buf_add_text(out, "label ");
    act_write_label(out, session, label);
    if (label == 0 || session_tally(session)->stale)
        return;
    buf_add_char(out, ' ');
    act_write_volume(out, session, label, before ? before[label] : 0);
}

/* Of the labels that the last edit changed, the one of which it changed most; 0 for none. */
static unsigned changed_most(const struct session *session)
{
    const uint64_t *before = session_voxels_before_edit(session);
    uint64_t most = 0;
    unsigned found = 0;
    for (unsigned label = 1; before && label < 256; label++) {
        const uint64_t now = session_tally(session)->voxels[label];
        const uint64_t change = now > before[label] ? now - before[label] : before[label] - now;
        found = change > most ? label : found;
        most = change > most ? change : most;
    }
    return found;
}

/* "  mean 93, SD 12.3, 78 x 102 x 94 mm": of all of the label. While a command is carried out
 * it is not known. */
static void write_sums(struct buf *out, struct session *session, unsigned label)
{
    struct label_sums sums;
    if (label == 0 || session_sum_label(session, label, &sums, NULL) != OK || !sums.voxels)
        return;
    buf_add_text(out, "  ");
    label_report_write_sums(out, &sums, session_geometry(session));
}

/* "label 2 cerebellum 142 ml (+1.2 ml)  intensity 93  0.5,18.0,-2.0 mm  mean 93, ..."; in the
 * background "label 0  label 2 ... (-1.2 ml)  intensity 93": of what the last edit changed. */
static void write_where(struct buf *out, struct session *session, bool knows_sums)
{
    const struct cell *cell = session_scene(session)->cell + cell_at_cross(session);
    const struct geometry *geometry = session_geometry(session);
    double mm[3];
    geometry_point(geometry, session_outlook(session)->slices.cross, mm);
    if (cell->flags & CELL_OUTSIDE) {
        buf_add_text(out, "outside the region of interest");
    } else if (cell_is_reached(cell)) {
        write_label(out, session, cell->label);
    } else {
        buf_add_text(out, "no label");
    }
    if (!cell->label && changed_most(session)) {
        buf_add_text(out, "  ");
        write_label(out, session, changed_most(session));
    }
    buf_add_text(out, "  intensity ");
    levels_write(out, geometry, session_levels(session), cell->intensity);
    if (geometry_has_place(geometry))
        buf_printf(out, "  %.1f,%.1f,%.1f mm", mm[0], mm[1], mm[2]);
    else if (geometry->orientation == ORIENTATION_UNKNOWN)
        buf_add_text(out, "  orientation unknown");
    else if (geometry->orientation == ORIENTATION_TOLD)
        buf_add_text(out, "  sides as told by the user");
    if (session_shows_finished(session) && session->live.label &&
        session->live.label[cell_at_cross(session)] != cell->label) {
        buf_add_text(out, "  finished label ");
        act_write_label(out, session, session->live.label[cell_at_cross(session)]);
    }
    if (knows_sums)
        write_sums(out, session, cell->label);
}

/* A seed of an object waits, or a voxel has its label; where nobody has counted yet, so it is. */
static bool has_object(const struct session *session)
{
    const struct edit *seed = edits_first(&session_state(session)->lists.pending);
    bool has = session_tally(session)->stale;
    for (size_t i = 0; i < session_pendings(session); i++)
        has |= seed[i].label > 0;
    for (unsigned label = 1; label < 256; label++)
        has |= session_tally(session)->voxels[label] > 0;
    return has;
}

static enum pilot_labels shown_labels(const struct session *session)
{
    if (!session_shows_finished(session))
        return PILOT_FOREST;
    return session_is_rough(session) ? PILOT_ROUGH : PILOT_FINISHED;
}

static bool facts(void *context, struct pilot_facts *out)
{
    struct session *session = session_of(context);
    struct buf where = {0};
    int32_t window[2];
    if (!session_has_scene(session))
        return false;
    const struct slice_settings *s = &session_outlook(session)->slices;
    *out = (struct pilot_facts){.waiting = session_pendings(session),
                                .zoom = session_fitting_zoom(session),
                                .times = s->times,
                                .frame_width = session_outlook(session)->view.width,
                                .frame_height = session_outlook(session)->view.height,
                                .overlay = s->overlay,
                                .has_object = has_object(session),
                                .shows = shown_labels(session),
                                .has_finish = session_kept(session)->finish.count > 0};
    for (enum pilot_pane pane = PILOT_AXIAL; pane < PILOT_RENDITION; pane++) {
        out->place[pane] = s->cross[pane];
        const uint32_t first[3] = {0};
        out->axis[pane] = (unsigned)slice_axis(session_scene(session), plane_of(pane));
        out->index[pane] = slicing_number(session, plane_of(pane), s->cross);
        out->counts_down[pane] = slicing_number(session, plane_of(pane), first) !=
                                 slice_index(session_scene(session), plane_of(pane), first);
        out->plane[pane] = slice_name(session_scene(session), plane_of(pane));
    }
    out->intensity = levels_value(session_geometry(session), session_levels(session),
                                  session_scene(session)->cell[cell_at_cross(session)].intensity);
    window_of(window, session);
    for (int i = 0; i < 2; i++)
        out->window[i] = s->has_window ? decimal_value(&s->window[i])
                                       : geometry_value(session_geometry(session), window[i]);
    write_where(&where, session, !((const struct pilot_interpreter *)context)->onlooker);
    memcpy(out->where, buf_text(&where),
           where.length < sizeof out->where ? where.length + 1 : sizeof out->where - 1);
    buf_release(&where);
    return true;
}

static void move(void *context, const int64_t by[3], uint32_t place[3])
{
    const struct session *session = session_of(context);
    memcpy(place, session_outlook(session)->slices.cross, 3 * sizeof *place);
    for (enum pilot_pane pane = PILOT_AXIAL; pane < PILOT_RENDITION; pane++) {
        const enum slice_plane plane = plane_of(pane);
        const int64_t count = slice_count(session_scene(session), plane);
        int64_t index = (int64_t)slice_index(session_scene(session), plane, place) + by[pane];
        index = index < 0 ? 0 : index >= count ? count - 1 : index;
        slice_move(session_scene(session), plane, (uint32_t)index, place);
    }
}

static void label(void *context, unsigned number, struct buf *out)
{
    act_write_label(out, session_of(context), number);
}

/* ---- seeds and labels ---- */

static bool is_hidden(void *context, unsigned label)
{
    return !session_of(context)->now.kept.visible[label];
}

/* A voxel that stands for a marker: of those that it decides about, one in the middle. CELL_NONE
 * where others cover it. */
static uint32_t middle_of(const struct markers *markers, uint32_t number)
{
    const struct marker *marker = markers->marker + number - 1;
    for (size_t i = 0; i < marker->voxels; i++) {
        const size_t at = (marker->voxels / 2 + i) % marker->voxels;
        const uint32_t cell = markers->cover[marker->first + at].cell;
        if (markers_at(markers, cell) == number)
            return cell;
    }
    return CELL_NONE;
}

/* In the order in which they were planted. */
static bool seed(void *context, unsigned label, int64_t by, uint32_t place[3])
{
    const struct session *session = session_of(context);
    const struct markers *markers = session_markers(session);
    const uint32_t here = cell_at_cross(session);
    int64_t count = 0, at = by > 0 ? -1 : 0;
    uint32_t *cell = mem_array(markers->count + 1, sizeof *cell);
    for (uint32_t n = 1; cell && n <= markers->count; n++) {
        const struct marker *marker = markers->marker + n - 1;
        if (!marker->stands || marker->label != (int)label)
            continue;
        const uint32_t middle = middle_of(markers, n);
        if (middle == here && (by > 0 || at == 0)) /* of two at one place, the further one */
            at = count;
        if (middle != CELL_NONE)
            cell[count++] = middle;
    }
    if (count > 0)
        place_of(session, cell[((at + by) % count + count) % count], place);
    free(cell);
    return count > 0;
}

static bool centre(void *context, unsigned label, uint32_t place[3])
{
    struct session *session = session_of(context);
    return session_count_labels(session, NULL) == OK && session_tally(session)->voxels[label] > 0 &&
           centre_of_label(session_scene(session), label, place);
}

/* ---- how a voxel came to its label ---- */

static bool find_why(struct pilot_interpreter *pilot, uint32_t cell, struct rival *rival,
                     struct fault *fault)
{
    const struct session *session = session_of(pilot);
    *rival = (struct rival){.exists = false};
    return way_find(&pilot->way, session_forest(session), cell, fault) == OK &&
           (forest_arcs(session_forest(session))->kind == ARC_POLARITY ||
            rival_find(rival, session_forest(session), cell, fault) == OK);
}

/* "label 1 brain at a cost of 12, by 212 steps; its strongest edge leads into 93,40,61; next is
 * label 0, at 15" */
static bool why(void *context, const uint32_t place[3], struct pilot_way *way, struct buf *out)
{
    struct pilot_interpreter *pilot = context;
    const struct session *session = session_of(context);
    const uint32_t cell = grid_cell(&session_scene(session)->grid, place[0], place[1], place[2]);
    const struct cell *at = session_scene(session)->cell + cell;
    struct rival rival;
    struct fault fault;
    if (!cell_is_reached(at)) {
        buf_add_text(out, "no seed reaches this voxel");
        return false;
    }
    if (!find_why(pilot, cell, &rival, &fault)) {
        buf_printf(out, "error: %s", fault.text);
        return false;
    }
    *way = (struct pilot_way){.label = at->label,
                              .next = rival.exists ? rival.label : 0,
                              .has_edge = pilot->way.edge != CELL_NONE};
    place_of(session, key_root(at->key), way->root);
    buf_add_text(out, "label ");
    act_write_label(out, session, at->label);
    buf_printf(out, " at a cost of %u, %zu step%s from its seed", key_cost(at->key),
               pilot->way.count - 1, plural(pilot->way.count - 1));
    if (way->has_edge) {
        place_of(session, pilot->way.edge, way->edge);
        buf_printf(out, ", strongest edge into %u,%u,%u", way->edge[0], way->edge[1], way->edge[2]);
    }
    if (rival.exists) {
        buf_add_text(out, "; next is label ");
        act_write_label(out, session, rival.label);
        buf_printf(out, " at %u", rival.cost);
    }
    return true;
}

/* ---- where labels are uncertain ---- */

static unsigned hints(void *context)
{
    const struct hint_list *found;
    return session_find_hints(session_of(context), &found, NULL, NULL) == OK
               ? (unsigned)found->count
               : 0;
}

static enum err draw_heat(struct pilot_interpreter *pilot, struct fault *fault)
{
    struct session *session = session_of(pilot);
    const struct hint_list *found;
    const uint8_t *heat;
    const enum err err = session_find_hints(session, &found, &heat, fault);
    for (enum slice_plane p = SLICE_AXIAL; !err && p <= SLICE_SAGITTAL; p++)
        pilot_draw_heat(&pilot->canvas, &pilot->panel.layout.box[p], heat,
                        session_outlook(session)->slices.overlay == SLICE_TINT);
    return err;
}

/* ---- what an eliminator takes ---- */

/* "marker 7: 3 trees, 123 voxels, 5 seeds wait"; "the tree of the seed at 1,2,3: 9 voxels". */
static void write_held(struct buf *out, const struct session *session, const struct held *held)
{
    uint32_t seed[3];
    if (held->marker) {
        buf_printf(out, "marker %u: %s%zu tree%s, ", held->marker,
                   held->has_more ? "at least " : "", held->trees, plural(held->trees));
    } else {
        place_of(session, held->seed, seed);
        buf_printf(out, "the tree of the seed at %u,%u,%u: ", seed[0], seed[1], seed[2]);
    }
    if (held->has_more)
        buf_printf(out, "more than %d voxels", HELD_MOST);
    else
        buf_printf(out, "%zu voxel%s", held->voxels, plural(held->voxels));
    if (held->waits)
        buf_printf(out, ", %zu seed%s wait%s", held->waits, plural(held->waits),
                   held->waits == 1 ? "s" : "");
    buf_add_text(out, ", label ");
    act_write_label(out, session, held->label);
}

static bool held(void *context, const uint32_t place[3], bool tree, struct buf *out)
{
    struct pilot_interpreter *pilot = context;
    const struct session *session = session_of(pilot);
    const uint32_t cell = grid_cell(&session_scene(session)->grid, place[0], place[1], place[2]);
    const bool found = session_find_held(&pilot->held, session, cell, tree, NULL) == OK;
    if (found)
        write_held(out, session, &pilot->held);
    return found;
}

/* ---- the picture ---- */

/* A frame just inside a box. */
static void draw_frame(const struct canvas *canvas, const struct mosaic_box *box)
{
    const int64_t left = box->left, top = box->top, width = box->width, height = box->height;
    canvas_box(canvas, left, top, width, 1, marked_pane);
    canvas_box(canvas, left, top + height - 1, width, 1, marked_pane);
    canvas_box(canvas, left, top, 1, height, marked_pane);
    canvas_box(canvas, left + width - 1, top, 1, height, marked_pane);
}

/* In the middle of a box, where it has room for them. */
static void draw_lines(const struct canvas *canvas, const struct mosaic_box *box,
                       const struct buf *text, int64_t lines)
{
    const int64_t width = box->width, height = box->height;
    int64_t widest = 0;
    for (int64_t i = 0; i < lines; i++)
        widest =
            text_width(buf_text(text + i), 1) > widest ? text_width(buf_text(text + i), 1) : widest;
    const uint32_t scale = 2 * widest < width ? 2 : 1;
    const int64_t line = TEXT_LINE * scale * 3 / 2;
    if (widest > width || lines * line > height)
        return;
    for (int64_t i = 0; i < lines; i++)
        text_draw(canvas, box->left + (width - text_width(buf_text(text + i), scale)) / 2,
                  box->top + height / 2 + (2 * i - lines) * line / 2, scale, buf_text(text + i),
                  words_rgb);
}

/* In an empty rendition. */
static void say_how_to_begin(const struct canvas *canvas, const struct mosaic_box *box,
                             const struct pilot_setup *setup)
{
    enum { LINES = 4 };
    struct buf text[LINES] = {{0}};
    buf_add_text(text, "nothing to show yet");
    setup_add_first_key(text + 1, setup, "plant");
    buf_add_text(text + 1, " plants a seed of the label");
    setup_add_key_to(text + 2, setup, "plant-label", '0');
    buf_add_text(text + 2, " one of the background");
    setup_add_first_key(text + 3, setup, "keys");
    buf_add_text(text + 3, " shows the keys");
    draw_lines(canvas, box, text, LINES);
    for (int i = 0; i < LINES; i++)
        buf_release(text + i);
}

static enum err picture(void *context, const struct pilot_wish *wish, struct image_view *view,
                        struct fault *fault)
{
    struct pilot_interpreter *pilot = context;
    struct session *session = session_of(pilot);
    struct slicing_panel *panel = &pilot->panel;
    canvas_release(&pilot->canvas);
    pilot->canvas = (struct canvas){0};
    *panel = (struct slicing_panel){.screen = {wish->width, wish->height, wish->cell_width,
                                               wish->cell_height, !wish->is_alone,
                                               mosaic_of(wish->pane)},
                                    .words = wish->words};
    enum err err = session_count_labels(session, fault); /* for the hues */
    if (!err)
        err = slicing_draw_panel(&pilot->canvas, session, panel, fault);
    if (err)
        return err;
    if (wish->heat && !pilot->onlooker) /* which would see margins of half a forest */
        err = draw_heat(pilot, fault);
    if (err)
        return err;
    const struct mosaic_box *box = &panel->layout.box[mosaic_of(wish->pane)];
    if (!wish->is_alone)
        draw_frame(&pilot->canvas, box);
    if (wish->words && !has_object(session))
        say_how_to_begin(&pilot->canvas, &panel->layout.box[MOSAIC_RENDITION],
                         wish->setup ? wish->setup : &pilot_setup_default);
    if (wish->marks_held)
        pilot_mark_held(&pilot->canvas, session, &pilot->held);
    for (enum slice_plane p = SLICE_AXIAL; p <= SLICE_SAGITTAL; p++)
        pilot_mark_corners(&pilot->canvas, session_scene(session), panel, p, wish);
    for (enum slice_plane p = SLICE_AXIAL; wish->marks_way && p <= SLICE_SAGITTAL; p++)
        pilot_mark_way(&pilot->canvas, session_scene(session), panel, p, &pilot->way);
    if (wish->marks_pixel)
        pilot_mark_pixel(&pilot->canvas, panel, session_frame(session), wish->pixel);
    const size_t notes =
        wish->words ? 0 : pilot_notes_add(pilot->note, &pilot->canvas, session, panel);
    for (enum slice_plane p = SLICE_AXIAL; p <= SLICE_SAGITTAL; p++) {
        const struct mosaic_box *b = &panel->layout.box[p];
        pilot->slice[p] = (struct raster_box){b->left, b->top, b->width, b->height};
    }
    *view = (struct image_view){.width = wish->width,
                                .height = wish->height,
                                .rgba = pilot->canvas.rgba,
                                .focus = {box->left, box->top, box->width, box->height},
                                .words = pilot->canvas.words,
                                .note = pilot->note,
                                .notes = notes,
                                .below = pilot->canvas.below,
                                .slice = pilot->slice,
                                .slices = 3,
                                .smooth = pilot->smooth,
                                .hue = pilot->hue,
                                .hues = shown_hues(pilot->hue, session)};
    if (wish->heat && view->hues < 256)
        pilot->hue[view->hues++] = PILOT_HEAT_HUE;
    return OK;
}

/* Slices on both sides of those that are shown, the nearer ones first, and of the pane that keys
 * move in before the others. */
static bool ahead(void *context, const struct pilot_wish *wish, unsigned number,
                  struct image_view *view)
{
    struct pilot_interpreter *pilot = context;
    const struct session *session = session_of(pilot);
    const unsigned first = wish->pane < PILOT_RENDITION ? wish->pane : 0;
    const enum pilot_pane pane = (enum pilot_pane)((first + number % 6 / 2) % 3);
    const struct mosaic_box *box = &pilot->panel.layout.box[mosaic_of(pane)];
    int64_t by[3] = {0}, far = (int64_t)number / 6 + 1;
    uint32_t place[3], most = 0;
    for (enum pilot_pane p = PILOT_AXIAL; p < PILOT_RENDITION && session_has_scene(session); p++) {
        const uint32_t count = slice_count(session_scene(session), plane_of(p));
        most = count > most ? count : most;
    }
    if (far >= most)
        return false;
    *view = (struct image_view){.hue = pilot->hue};
    by[pane] = number % 2 ? far : -far;
    move(context, by, place);
    const int64_t index = slice_index(session_scene(session), plane_of(pane), place);
    const int64_t here =
        slice_index(session_scene(session), plane_of(pane), session_outlook(session)->slices.cross);
    if (box->width == 0 || index != here + by[pane])
        return true;
    canvas_release(&pilot->beyond);
    if (slicing_draw_below(&pilot->beyond, session_of(pilot), &pilot->panel, plane_of(pane), place,
                           NULL))
        return false;
    pilot->around = (struct raster_box){0, 0, box->width, box->height};
    view->width = box->width;
    view->height = box->height;
    view->below = pilot->beyond.below;
    view->slice = &pilot->around;
    view->slices = 1;
    return true;
}

static bool voxel_at(void *context, uint32_t column, uint32_t row, uint32_t place[3],
                     enum pilot_pane *pane)
{
    struct pilot_interpreter *pilot = context;
    const struct canvas *canvas = &pilot->canvas;
    *pane = PILOT_RENDITION;
    for (enum pilot_pane p = PILOT_AXIAL; p < PILOT_RENDITION && canvas->rgba; p++) {
        const struct mosaic_box *box = &pilot->panel.layout.box[mosaic_of(p)];
        if (column - box->left < box->width && row - box->top < box->height)
            *pane = p;
    }
    if (!canvas->rgba || column >= canvas->width || row >= canvas->height)
        return false;
    const uint32_t cell = canvas->cell[(size_t)row * canvas->stride + column];
    if (cell != CELL_NONE)
        place_of(pilot->interp->session, cell, place);
    return cell != CELL_NONE;
}

static bool pan(void *context, enum pilot_pane pane, int right, int down, uint32_t middle[3],
                uint32_t place[3])
{
    const struct pilot_interpreter *pilot = context;
    const struct mosaic_box *box = &pilot->panel.layout.box[mosaic_of(pane)];
    const struct session *session = session_of(context);
    if (!pilot->canvas.rgba || box->width == 0)
        return false;
    const struct slice_choice slice =
        mosaic_slice(session_scene(session), &pilot->panel.choice, pilot->canvas.width,
                     pilot->canvas.height, plane_of(pane));
    return slice_pan(session_scene(session), &slice, box->width, box->height,
                     (const int[]){right, down}, middle, place);
}

static uint32_t point_along(const struct pilot_interpreter *pilot, const struct rendition *r,
                            bool down, uint32_t pixel)
{
    const struct mosaic_point at =
        mosaic_point_of(pilot->canvas.width, pilot->canvas.height, &pilot->panel.choice, r,
                        down ? 0 : pixel, down ? pixel : 0);
    return down ? at.row : at.column;
}

/* The last pixel that is shown no further than where one points. */
static void frame_pixel(void *context, uint32_t column, uint32_t row, uint32_t pixel[2])
{
    const struct pilot_interpreter *pilot = context;
    const struct rendition *r = session_frame(session_of(context));
    const uint32_t size[2] = {r->width, r->height}, wanted[2] = {column, row};
    if (!pilot->canvas.rgba || !session_of(context)->rendered)
        return;
    for (int i = 0; i < 2; i++) {
        uint32_t low = 0, high = size[i];
        while (high - low > 1) {
            const uint32_t middle = low + (high - low) / 2;
            if (point_along(pilot, r, i == 1, middle) <= wanted[i])
                low = middle;
            else
                high = middle;
        }
        pixel[i] = low;
    }
}

static bool voxel_of_frame(void *context, uint32_t column, uint32_t row, uint32_t place[3])
{
    const struct session *session = session_of(context);
    const struct rendition *r = session_frame(session);
    if (!session_rendered(session) || column >= r->width || row >= r->height)
        return false;
    const uint32_t cell = r->cell[(size_t)row * r->width + column];
    if (cell != CELL_NONE)
        place_of(session, cell, place);
    return cell != CELL_NONE;
}

/* ---- while a command is carried out ---- */

static bool onlooker_wants(void *context)
{
    const struct pilot_interpreter *pilot = context;
    return session_of(context)->has_scene && pilot->onlooker->wants(pilot->onlooker->context);
}

static void onlooker_draws(void *context)
{
    const struct pilot_interpreter *pilot = context;
    pilot->onlooker->draw(pilot->onlooker->context);
}

static void show_to_onlooker(void *context)
{
    session_show(session_of(context), onlooker_draws, context);
}

static void look_on(void *context, const struct pilot_onlooker *onlooker)
{
    struct pilot_interpreter *pilot = context;
    pilot->onlooker = onlooker;
    pilot->looks_on = (struct console_onlooker){pilot, onlooker_wants, show_to_onlooker};
    console_look_on(onlooker ? &pilot->looks_on : NULL);
}

/* ---- while nobody waits ---- */

struct finishing {
    struct session *session;
    const struct pilot_onlooker *onlooker;
    struct watch watch;
};

static bool poll_finishing(void *context, const char *what, uint64_t done, uint64_t total)
{
    struct finishing *f = context;
    (void)what, (void)done, (void)total;
    f->watch.wants_show |= f->onlooker->wants(f->onlooker->context);
    return f->onlooker->stops(f->onlooker->context);
}

/* The picture is not part of what can be stopped. */
static void show_finishing(void *context)
{
    struct finishing *f = context;
    session_scene(f->session)->watch = NULL;
    f->onlooker->draw(f->onlooker->context);
    session_scene(f->session)->watch = &f->watch;
}

static enum err finish(void *context, const struct pilot_onlooker *onlooker, struct fault *fault)
{
    struct finishing f = {session_of(context),
                          onlooker,
                          {.context = &f, .poll = poll_finishing, .show = show_finishing}};
    return session_refine(f.session, &f.watch, fault);
}

static void peek(void *context, const uint32_t place[3])
{
    struct pilot_interpreter *pilot = context;
    uint32_t *cross = session_of(context)->now.outlook.slices.cross;
    if (place && !pilot->peeks)
        memcpy(pilot->cross, cross, sizeof pilot->cross);
    if (place || pilot->peeks)
        memcpy(cross, place ? place : pilot->cross, sizeof pilot->cross);
    pilot->peeks = place != NULL;
}

/* ---- the whole ---- */

void pilot_host_fill(struct pilot_host *host)
{
    host->facts = facts;
    host->move = move;
    host->picture = picture;
    host->pan = pan;
    host->ahead = ahead;
    host->voxel_at = voxel_at;
    host->voxel_of_frame = voxel_of_frame;
    host->frame_pixel = frame_pixel;
    host->label = label;
    host->held = held;
    host->why = why;
    host->hints = hints;
    host->look_on = look_on;
    host->finish = finish;
    host->peek = peek;
    host->seed = seed;
    host->centre = centre;
    host->is_hidden = is_hidden;
}

void pilot_interpreter_release(struct pilot_interpreter *pilot)
{
    canvas_release(&pilot->canvas);
    canvas_release(&pilot->beyond);
    way_release(&pilot->way);
}
