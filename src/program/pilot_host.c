/* SPDX-License-Identifier: MIT */
#include "program/programs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "command/command.h"
#include "command/execute.h"
#include "engine/hints.h"
#include "engine/margin.h"
#include "engine/measure.h"
#include "render/rendition.h"
#include "render/slice.h"
#include "session/doubtful.h"
#include "session/map.h"
#include "session/markers.h"
#include "session/session.h"
#include "session/state.h"
#include "session/tally.h"
#include "show/draw.h"
#include "show/label_report.h"
#include "show/pictures.h"
#include "program/panes.h"
#include "tui/pilot/pilot_keys.h"

/* Corners of an outline, and the largest distance of a place from it, in voxels. */
enum { CORNERS_LEAST = 3, OUTLINE_NEAR = 8 };

static struct session *session_of(void *context)
{
    return ((struct pilot_interpreter *)context)->interp->session;
}

static uint32_t cell_at(const struct session *session, const uint32_t p[3])
{
    return grid_cell(&session->scene->grid, p[0], p[1], p[2]);
}

static bool host_finished(void *context)
{
    return ((struct pilot_interpreter *)context)->interp->wish == WISH_QUIT;
}

void pilot_host_complete(void *context, const char *line, size_t cursor, struct buf *candidates,
                         size_t *word_start)
{
    command_complete(candidates, word_start, line, cursor,
                     ((struct pilot_interpreter *)context)->interp);
}

/* ---- facts ---- */

/* The label above 0 whose voxel count the last edit changed most; 0 for none. */
static unsigned changed_most(const struct session *session)
{
    const uint64_t *before, *voxels = session_shown_voxels(session, &before);
    uint64_t most = 0;
    unsigned found = 0;
    for (unsigned label = 1; before && label < 256; label++) {
        const uint64_t now = voxels[label], was = before[label];
        const uint64_t change = now > was ? now - was : was - now;
        found = change > most ? label : found;
        most = change > most ? change : most;
    }
    return found;
}

/* Write the label of a voxel as pictures show it, with its size; in the background the label that
 * the last edit changed most. */
static void write_labels(struct buf fact[PILOT_KNOWN], const struct session *session, uint32_t at)
{
    const struct cell *cell = session->scene->cell + at;
    const unsigned label = session_shown_label(session, at), changed = changed_most(session);
    const unsigned measured = label ? label : changed;
    const uint64_t *before, *voxels = session_shown_voxels(session, &before);
    OWNED(buf_release) struct buf name = {0};
    label_report_write_name(&name, session, label);
    const size_t number = strcspn(buf_text(&name), " ");
    if (cell->flags & CELL_OUTSIDE) {
        buf_add_text(&fact[PILOT_HERE], "outside the region of interest");
    } else if (cell_is_reached(cell)) {
        buf_printf(&fact[PILOT_HERE], "here %.*s", (int)number, buf_text(&name));
        buf_add_text(&fact[PILOT_NAME], buf_text(&name) + number);
    } else {
        buf_add_text(&fact[PILOT_HERE], "no label");
    }
    if (!label && changed) {
        const bool is_named = *session->now.kept.label_name[changed];
        buf_add_text(&fact[PILOT_VOLUME], is_named ? "changed: " : "changed: label ");
        label_report_write_name(&fact[PILOT_VOLUME], session, changed);
        buf_add_char(&fact[PILOT_VOLUME], ',');
    }
    if (measured && voxels) {
        buf_add_char(&fact[PILOT_VOLUME], ' ');
        label_report_write_extent(&fact[PILOT_VOLUME], session, voxels[measured]);
        label_report_write_change(&fact[PILOT_CHANGE], session, voxels[measured],
                                  before ? before[measured] : 0);
    }
    if (label != cell->label) {
        buf_add_text(&fact[PILOT_IN_FOREST], "in the forest ");
        label_report_write_name(&fact[PILOT_IN_FOREST], session, cell->label);
    }
    fact->failed |= name.failed;
}

static void write_voxel(struct buf fact[PILOT_KNOWN], struct session *session,
                        const uint32_t place[3], bool knows_sums)
{
    const uint32_t at = cell_at(session, place);
    const struct geometry *geometry = &session->geometry;
    const unsigned label = session_shown_label(session, at);
    struct label_sums sums;
    double mm[3];
    geometry_point(geometry, place, mm);
    write_labels(fact, session, at);
    if (kept_channels(&session->now.kept))
        channel_write(&fact[PILOT_INTENSITY], session);
    buf_add_text(&fact[PILOT_INTENSITY], kept_channels(&session->now.kept) ? ": " : "intensity ");
    levels_write(&fact[PILOT_INTENSITY], geometry, session->levels,
                 session->scene->cell[at].intensity);
    if (geometry_has_place(geometry))
        buf_printf(&fact[PILOT_MM], "%.1f,%.1f,%.1f mm", mm[0], mm[1], mm[2]);
    else if (geometry->orientation == ORIENTATION_UNKNOWN)
        buf_add_text(&fact[PILOT_MM], "orientation unknown");
    else if (geometry->orientation == ORIENTATION_TOLD)
        buf_add_text(&fact[PILOT_MM], "sides set by the user");
    if (knows_sums && label && session_sum_shown(session, label, &sums, NULL) == OK && sums.voxels)
        label_report_write_sums(&fact[PILOT_SUMS], &sums, geometry);
}

/* The view of the rendition in its pane, which may not be drawn yet. */
static struct view view_of_pane(const struct pilot_interpreter *pilot)
{
    const struct mosaic_box *box = &pilot->panes.panel.layout.box[MOSAIC_RENDITION];
    return session_view_in_room(pilot->interp->session, (uint32_t[]){box->width, box->height});
}

static bool host_facts(void *context, struct pilot_facts *out)
{
    static const uint32_t first[3] = {0};
    const struct pilot_interpreter *pilot = context;
    struct session *session = session_of(context);
    struct buf fact[PILOT_KNOWN] = {{0}};
    if (!session->has_scene)
        return false;
    const struct scene *scene = session->scene;
    const struct outlook *outlook = &session->now.outlook;
    const struct slice_settings *s = &outlook->slices;
    const struct view view = view_of_pane(pilot);
    const enum proposal proposal = session_find_proposal(session);
    const uint32_t at = cell_at(session, s->cross);
    const struct sketch *sketch = &pilot->interp->sketch;
    const struct marker_kinds kinds = markers_kinds(
        &session->markers, sketch->is_begun ? sketch->markers : session->markers.count);
    *out = (struct pilot_facts){
        .waiting = session_pendings(session),
        .channel = scene->shown,
        .intensity = levels_value(&session->geometry, session->levels, scene->cell[at].intensity),
        .times = s->times,
        .frame_width = view.width,
        .frame_height = view.height,
        .overlay = s->overlay,
        .has_object = panes_have_object(session),
        .has_one_object = proposal == PROPOSE_SPHERE,
        .wants_outline = proposal == PROPOSE_OUTLINE,
        .has_pieces = kinds.has_pieces,
        .is_grown = kinds.has_grown && !kinds.has_exact,
        .has_label = cell_is_reached(scene->cell + at),
        .label = numbering_of(&session->now.kept, session_shown_label(session, at)),
        .shows = !session_shows_finished(session) ? PILOT_FOREST
                 : session_is_rough(session)      ? PILOT_ROUGH
                                                  : PILOT_FINISHED,
        .has_finish = session->now.kept.finish.count > 0};
    const struct view fitting = session_fitting_view(session);
    out->zoom = fitting.zoom;
    out->default_zoom = view_default(scene).zoom;
    out->is_fitted = memcmp(fitting.focus, outlook->view.focus, sizeof fitting.focus) != 0;
    if (out->is_fitted)
        memcpy(out->middle, session->pictures->own.place, sizeof out->middle);
    window_values(out->window, session);
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        out->size[plane] = scene->grid.size[plane];
        out->place[plane] = s->cross[plane];
        out->axis[plane] = (unsigned)slice_axis(scene, plane);
        out->counts_down[plane] = slice_index(scene, plane, first) != 0;
        out->plane[plane] = slice_name(scene, plane);
    }
    /* Sums of labels that are about to be finished would delay the first picture. */
    write_voxel(fact, session, s->cross, !pilot->onlooker && out->shows != PILOT_ROUGH);
    for (enum pilot_known i = PILOT_HERE; i < PILOT_KNOWN; i++) {
        snprintf(out->known[i], PILOT_KNOWN_BYTES, "%s", buf_text(fact + i));
        buf_release(fact + i);
    }
    return true;
}

static void host_move(void *context, const int64_t by[3], uint32_t place[3])
{
    panes_move(session_of(context), by, place);
}

/* ---- labels and their seeds ---- */

static int label_of(void *context, uint32_t number)
{
    return numbering_find(&session_of(context)->now.kept, number);
}

static void host_label(void *context, uint32_t number, struct buf *out)
{
    const int label = label_of(context, number);
    if (label == NUMBER_UNKNOWN)
        buf_printf(out, "%u", number);
    else
        label_report_write_name(out, session_of(context), (unsigned)label);
}

static unsigned host_labels(void *context, struct pilot_label out[PILOT_LABELS])
{
    const struct session *session = session_of(context);
    const struct kept *kept = &session->now.kept;
    const uint64_t *before, *voxels = session_shown_voxels(session, &before);
    uint32_t numbers[PILOT_LABELS];
    uint8_t order[PILOT_LABELS];
    unsigned count = 0;
    numbering_fill(numbers, kept);
    numbering_order(order, numbers);
    for (int i = 0; i < PILOT_LABELS; i++) {
        const unsigned label = order[i];
        struct pilot_label *row = out + count;
        OWNED(buf_release) struct buf volume = {0};
        if (!(voxels && voxels[label]) && !*kept->label_name[label])
            continue;
        *row = (struct pilot_label){.number = numbers[label],
                                    .is_hidden = label && !kept->visible[label]};
        memcpy(row->rgb, kept->palette.rgb[label], sizeof row->rgb);
        if (voxels)
            label_report_write_extent(&volume, session, voxels[label]);
        snprintf(row->name, sizeof row->name, "%s", kept->label_name[label]);
        snprintf(row->volume, sizeof row->volume, "%s", buf_text(&volume));
        snprintf(row->code, sizeof row->code, "%s", kept->label_code[label]);
        count++;
    }
    return count;
}

static bool host_next_label(void *context, uint32_t number, int by, uint32_t *next)
{
    const struct session *session = session_of(context);
    const int label = label_of(context, number);
    uint32_t numbers[256];
    uint8_t order[256];
    int count = 1, at = 0;
    numbering_fill(numbers, &session->now.kept);
    numbering_order(order, numbers);
    while (count < 256 && numbers[order[count]])
        count++;
    while (label != NUMBER_UNKNOWN && order[at] != label)
        at++;
    if (label == NUMBER_UNKNOWN) {
        const uint32_t cell = cell_at(session, session->now.outlook.slices.cross);
        const unsigned here = session_shown_label(session, cell);
        *next = here ? numbers[here] : numbers[order[count > 1]];
        return false;
    }
    *next = numbers[order[((at + by) % count + count) % count]];
    return true;
}

static bool host_is_hidden(void *context, uint32_t number)
{
    const int label = label_of(context, number);
    return label >= 0 && !session_of(context)->now.kept.visible[label];
}

/* A voxel in the middle of the visible part of a marker; CELL_NONE if others cover all of it. */
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

/* Seeds are visited in the order in which they were planted. */
static bool host_seed(void *context, uint32_t number, int64_t by, uint32_t place[3])
{
    const struct session *session = session_of(context);
    const struct markers *markers = &session->markers;
    const uint32_t here = cell_at(session, session->now.outlook.slices.cross);
    const int label = label_of(context, number);
    int64_t count = 0, at = by > 0 ? -1 : 0;
    OWNED(mem_release) uint32_t *cell = mem_array(markers->count + 1, sizeof *cell);
    for (uint32_t n = 1; cell && n <= markers->count; n++) {
        const struct marker *marker = markers->marker + n - 1;
        if (!marker->is_valid || marker->label != label || label == NUMBER_UNKNOWN)
            continue;
        const uint32_t middle = middle_of(markers, n);
        if (middle == here && (by > 0 || at == 0)) /* the further one of two at one place */
            at = count;
        if (middle != CELL_NONE)
            cell[count++] = middle;
    }
    if (count > 0)
        grid_find(&session->scene->grid, cell[((at + by) % count + count) % count], place);
    return count > 0;
}

static bool host_centre(void *context, uint32_t number, uint32_t place[3])
{
    struct session *session = session_of(context);
    const int label = label_of(context, number);
    return label >= 0 && session_count_labels(session, NULL) == OK &&
           session->tally.voxels[label] > 0 &&
           centre_of_label(session->scene, (unsigned)label, place);
}

static bool host_why(void *context, const uint32_t place[3], struct pilot_way *out,
                     struct buf *words)
{
    struct way *way = &((struct pilot_interpreter *)context)->panes.way;
    const struct session *session = session_of(context);
    const struct forest *forest = session->forest;
    const struct grid *grid = &session->scene->grid;
    const uint32_t cell = cell_at(session, place);
    const struct cell *at = session->scene->cell + cell;
    struct rival rival = {.exists = false};
    struct fault fault;
    if (!cell_is_reached(at)) {
        buf_add_text(words, "no seed reaches this voxel");
        return false;
    }
    enum err err = way_find(way, forest, cell, &fault);
    if (!err)
        err = rival_find(&rival, forest, cell, &fault);
    if (err) {
        buf_printf(words, "error: %s", fault.text);
        return false;
    }
    const size_t steps = way->count - 1;
    const struct kept *kept = &session->now.kept;
    *out = (struct pilot_way){.label = numbering_of(kept, at->label),
                              .next = rival.exists ? numbering_of(kept, rival.label) : 0,
                              .has_edge = way->edge != CELL_NONE};
    grid_find(grid, key_root(at->key), out->root);
    buf_add_text(words, "label ");
    label_report_write_name(words, session, at->label);
    buf_printf(words, ", cost %u, %zu step%s", key_cost(at->key), steps, plural(steps));
    if (out->has_edge) {
        grid_find(grid, way->edge, out->edge);
        buf_printf(words, ", strongest edge %u,%u,%u", out->edge[0], out->edge[1], out->edge[2]);
    }
    if (rival.exists) {
        buf_add_text(words, "; next ");
        label_report_write_name(words, session, rival.label);
        buf_printf(words, " at %u", rival.cost);
    }
    return true;
}

/* Compute the heat map too: it is often wanted next, and needs little more time. */
static unsigned host_hints(void *context)
{
    const struct hint_list *found;
    const uint8_t *heat;
    return session_find_hints(session_of(context), &found, &heat, NULL) == OK
               ? (unsigned)found->count
               : 0;
}

static bool host_held(void *context, const uint32_t place[3], bool tree, struct buf *out)
{
    struct held *found = &((struct pilot_interpreter *)context)->panes.held;
    const struct session *session = session_of(context);
    uint32_t seed[3];
    if (session_find_held(found, session, cell_at(session, place), tree, NULL) != OK)
        return false;
    if (found->marker) {
        buf_printf(out, "marker %u: %s%zu tree%s, ", found->marker,
                   found->has_more ? "at least " : "", found->trees, plural(found->trees));
    } else {
        grid_find(&session->scene->grid, found->seed, seed);
        buf_printf(out, "the tree of the seed at %u,%u,%u: ", seed[0], seed[1], seed[2]);
    }
    if (found->has_more)
        buf_printf(out, "more than %d voxels", HELD_MOST);
    else
        buf_printf(out, "%zu voxel%s", found->voxels, plural(found->voxels));
    if (found->waits)
        buf_printf(out, ", %zu seed%s wait%s", found->waits, plural(found->waits),
                   found->waits == 1 ? "s" : "");
    buf_add_text(out, ", label ");
    label_report_write_name(out, session, found->label);
    return true;
}

/* ---- outlines ---- */

/* True for a line in the slice across `axis` that is around the place or near it. */
static bool is_near(const struct polyline *line, unsigned axis, const uint32_t place[3])
{
    for (unsigned a = 0; a < 3; a++) {
        int64_t first = INT64_MAX, last = -1;
        const int64_t near = a == axis ? 0 : OUTLINE_NEAR;
        for (size_t i = 0; i < line->count; i++) {
            first = line->corner[i][a] < first ? line->corner[i][a] : first;
            last = line->corner[i][a] > last ? line->corner[i][a] : last;
        }
        if (place[a] < first - near || place[a] > last + near)
            return false;
    }
    return line->count >= CORNERS_LEAST;
}

/* Find the latest marker whose contour is near the place; 0 for none. */
static uint32_t find_marker(struct polyline *line, const struct session *session, unsigned number,
                            unsigned axis, const uint32_t place[3])
{
    const struct grid *grid = &session->scene->grid;
    const struct markers *markers = &session->markers;
    for (uint32_t n = (uint32_t)markers->count; n > 0; n--) {
        const struct marker *marker = markers->marker + n - 1;
        uint32_t first[3];
        line->count = 0;
        if (!marker->is_valid || marker->joined || marker->label != (int)number || !marker->voxels)
            continue;
        grid_find(grid, markers->cover[marker->first].cell, first);
        if (first[axis] == place[axis] && /* otherwise it has no contour in the slice */
            contour_of_marker(line, grid, markers, n, NULL) == OK && is_near(line, axis, place))
            return n;
    }
    line->count = 0;
    return 0;
}

static bool host_outline(void *context, uint32_t number, enum pilot_pane pane,
                         const uint32_t place[3], struct polyline *line, uint32_t *marker,
                         struct buf *out)
{
    struct session *session = session_of(context);
    const unsigned axis = (unsigned)slice_axis(session->scene, (enum slice_plane)pane);
    struct labels labels;
    const int label = label_of(context, number);
    if (label == NUMBER_UNKNOWN) {
        buf_printf(out, "there is no label %u", number);
        return false;
    }
    *marker = find_marker(line, session, (unsigned)label, axis, place);
    if (*marker) {
        buf_printf(out, "the outline of marker %u", *marker);
        return true;
    }
    const bool found =
        session_labels(session, session_shows_finished(session), &labels, NULL) == OK &&
        contour_of_label(line, &labels, (unsigned)label, axis, place, NULL) == OK &&
        line->count >= CORNERS_LEAST;
    buf_add_text(out, found ? "the border of label " : "in this slice there is nothing of label ");
    label_report_write_name(out, session, (unsigned)label);
    return found;
}

static bool host_doubt(void *context, uint32_t number, unsigned rank, enum pilot_pane *pane,
                       uint32_t place[3], struct buf *out)
{
    struct session *session = session_of(context);
    struct doubtful_slice slice[DOUBTFUL_MOST];
    struct labels labels;
    struct fault why;
    size_t count = 0;
    const int found = label_of(context, number);
    const unsigned label = (unsigned)found;
    if (found <= 0) {
        buf_add_text(out, "the background has no outline: choose a label first");
        return false;
    }
    enum err err = doubtful_find(slice, &count, session, label, &why);
    if (!err)
        err = session_labels(session, session_shows_finished(session), &labels, &why);
    if (err) {
        buf_add_text(out, why.text);
        return false;
    }
    if (rank > count || !doubtful_place(place, &labels, label, &slice[rank - 1])) {
        buf_printf(out, "no%s slice has anything in doubt of label ", rank > 1 ? " further" : "");
        label_report_write_name(out, session, label);
        return false;
    }
    *pane = (enum pilot_pane)label_report_write_doubt(out, session, &slice[rank - 1]);
    return true;
}

/* ---- the picture ---- */

static enum err draw(struct pilot_interpreter *pilot, const struct pilot_wish *wish,
                     struct fault *fault)
{
    const struct pilot_setup *setup = wish->setup ? wish->setup : &pilot_setup_default;
    struct buf line[PANES_LINES] = {{0}};
    struct pilot_wish now = *wish;
    now.heat &= !pilot->onlooker; /* margins of an unfinished forest are wrong */
    buf_add_text(line, "nothing to show yet");
    if (!pilot->watches) {
        setup_say(line + 1, setup, "", "{plant} plants a seed of the label");
        setup_say(line + 2, setup, "", "{plant-label:0} one of the background");
    }
    setup_say(line + 3, setup, "", "{keys} shows the keys");
    const enum err err = panes_draw(&pilot->panes, session_of(pilot), &now, line, fault);
    for (int i = 0; i < PANES_LINES; i++)
        buf_release(line + i);
    return err;
}

static bool poll_drawing(void *context, const char *what, uint64_t done, uint64_t total)
{
    const struct pilot_wish *wish = *(const struct pilot_wish **)context;
    (void)what, (void)done, (void)total;
    return wish->onlooker->stops(wish->onlooker->context);
}

static enum err host_picture(void *context, const struct pilot_wish *wish, struct image_view *view,
                             struct fault *fault)
{
    struct pilot_interpreter *pilot = context;
    const struct panes *panes = &pilot->panes;
    struct scene *scene = session_of(context)->scene;
    struct watch *const former = scene->watch, watch = {.context = &wish, .poll = poll_drawing};
    scene->watch = wish->onlooker ? &watch : former;
    const enum err err = draw(pilot, wish, fault);
    scene->watch = former;
    if (err)
        return err;
    for (enum pilot_pane pane = PILOT_AXIAL; pane < PILOT_RENDITION; pane++)
        pilot->slice[pane] = panes_box(panes, pane);
    *view = (struct image_view){.width = wish->width,
                                .height = wish->height,
                                .rgba = panes->canvas.rgba,
                                .focus = panes_box(panes, wish->pane),
                                .words = panes->canvas.words,
                                .note = panes->note,
                                .notes = panes->notes,
                                .below = panes->canvas.below,
                                .slice = pilot->slice,
                                .slices = PANES_SLICES,
                                .smooth = pilot->smooth,
                                .has_tints = wish->marks_outline,
                                .has_balls = session_of(context)->markers.count > 0,
                                .is_hasty = panes->panel.is_hasty,
                                .hue = pilot->hue,
                                .hues = shown_hues(pilot->hue, session_of(context))};
    if (wish->heat && view->hues < 256)
        pilot->hue[view->hues++] = PANES_HEAT_HUE;
    const int label = label_of(context, wish->label);
    if (wish->marks_outline && view->hues < 256 && label >= 0) { /* it may have no voxels yet */
        const uint8_t *rgb = session_of(context)->now.kept.palette.rgb[label];
        const uint32_t hue = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
        bool is_new = true;
        for (unsigned i = 0; i < view->hues; i++)
            is_new &= pilot->hue[i] != hue;
        if (is_new)
            pilot->hue[view->hues++] = hue;
    }
    return OK;
}

/* Slices of the focused pane come first. */
static enum pilot_pane first_of(const struct pilot_wish *wish)
{
    return wish->pane < PILOT_RENDITION ? wish->pane : PILOT_AXIAL;
}

static uint64_t host_name_ahead(void *context, const struct pilot_wish *wish, unsigned number)
{
    const struct pilot_interpreter *pilot = context;
    return panes_name_beyond(&pilot->panes, session_of(context), first_of(wish), number);
}

static bool host_ahead(void *context, const struct pilot_wish *wish, unsigned number,
                       struct image_view *view)
{
    struct pilot_interpreter *pilot = context;
    const struct canvas *beyond = &pilot->panes.beyond;
    if (!panes_draw_beyond(&pilot->panes, session_of(context), first_of(wish), number))
        return false;
    pilot->beyond = (struct raster_box){0, 0, beyond->width, beyond->height};
    *view = (struct image_view){.width = beyond->width,
                                .height = beyond->height,
                                .hue = pilot->hue,
                                .below = beyond->below,
                                .slice = &pilot->beyond,
                                .slices = 1};
    return true;
}

static bool find_voxel(const struct session *session, uint32_t cell, uint32_t place[3])
{
    if (cell != CELL_NONE)
        grid_find(&session->scene->grid, cell, place);
    return cell != CELL_NONE;
}

static bool host_voxel_at(void *context, uint32_t column, uint32_t row, uint32_t place[3],
                          enum pilot_pane *pane)
{
    const struct panes *panes = &((struct pilot_interpreter *)context)->panes;
    const struct canvas *canvas = &panes->canvas;
    *pane = PILOT_RENDITION;
    for (enum pilot_pane a = PILOT_AXIAL; a < PILOT_RENDITION && canvas->rgba; a++) {
        const struct mosaic_box *box = &panes->panel.layout.box[a];
        if (column - box->left < box->width && row - box->top < box->height)
            *pane = a;
    }
    return canvas->rgba && column < canvas->width && row < canvas->height &&
           find_voxel(session_of(context), canvas->cell[(size_t)row * canvas->stride + column],
                      place);
}

static bool host_pan(void *context, enum pilot_pane pane, int right, int down, uint32_t middle[3],
                     uint32_t place[3])
{
    const struct pilot_interpreter *pilot = context;
    return panes_pan(&pilot->panes, session_of(context), pane, (int[]){right, down}, middle, place);
}

static void host_frame_pixel(void *context, uint32_t column, uint32_t row, uint32_t pixel[2])
{
    const struct panes *panes = &((struct pilot_interpreter *)context)->panes;
    const struct rendition *r = session_frame(session_of(context));
    const uint32_t size[2] = {r->width, r->height}, wanted[2] = {column, row};
    if (!panes->canvas.rgba || !session_rendered(session_of(context)))
        return;
    for (int i = 0; i < 2; i++) {
        uint32_t low = 0, high = size[i];
        while (high - low > 1) {
            const uint32_t middle = low + (high - low) / 2;
            const struct mosaic_point at =
                mosaic_point_of(panes->canvas.width, panes->canvas.height, &panes->panel.choice, r,
                                i ? 0 : middle, i ? middle : 0);
            *((i ? at.row : at.column) <= wanted[i] ? &low : &high) = middle;
        }
        pixel[i] = low;
    }
}

static bool host_voxel_of_frame(void *context, uint32_t column, uint32_t row, uint32_t place[3])
{
    const struct session *session = session_of(context);
    const struct rendition *r = session_frame(session);
    const struct view view = view_of_pane(context);
    const bool is_drawn =
        session_rendered(session) && r->width == view.width && r->height == view.height;
    return is_drawn && column < r->width && row < r->height &&
           find_voxel(session, r->cell[(size_t)row * r->width + column], place);
}

/* ---- while a command is carried out ---- */

static bool onlooker_wants(void *context)
{
    const struct pilot_interpreter *pilot = context;
    return session_of(context)->has_scene && pilot->onlooker->wants(pilot->onlooker->context);
}

static bool onlooker_stops(void *context)
{
    const struct pilot_interpreter *pilot = context;
    return pilot->onlooker->stops && pilot->onlooker->stops(pilot->onlooker->context);
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

static void host_look_on(void *context, const struct pilot_onlooker *onlooker)
{
    struct pilot_interpreter *pilot = context;
    pilot->onlooker = onlooker;
    pilot->looks_on =
        (struct console_onlooker){pilot, onlooker_wants, show_to_onlooker, onlooker_stops};
    console_look_on(onlooker ? &pilot->looks_on : NULL);
}

/* ---- while the pilot is idle ---- */

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

static void show_finishing(void *context)
{
    struct finishing *f = context;
    struct scene *scene = f->session->scene;
    struct watch *const watch = scene->watch;
    scene->watch = NULL; /* the watch of the work must not stop pictures */
    f->onlooker->draw(f->onlooker->context);
    scene->watch = watch;
}

static enum err host_finish(void *context, const struct pilot_onlooker *onlooker, struct buf *news,
                            struct fault *fault)
{
    struct pilot_interpreter *pilot = context;
    struct finishing f = {session_of(context),
                          onlooker,
                          {.context = &f, .poll = poll_finishing, .show = show_finishing}};
    struct scene *scene = f.session->scene;
    struct watch *const former = scene->watch;
    struct labels exact;
    scene->watch = &f.watch;
    enum err err = session_labels(f.session, true, &exact, fault);
    scene->watch = former;
    if (!err)
        err = interpreter_write_losses(pilot->interp, &f.watch, news, fault);
    return err ? err : session_refine(f.session, &f.watch, fault);
}

static void host_preview_cross(void *context, const uint32_t place[3])
{
    struct pilot_interpreter *pilot = context;
    struct session *session = session_of(context);
    if (place && !pilot->peeks)
        memcpy(pilot->cross, session->now.outlook.slices.cross, sizeof pilot->cross);
    if (place || pilot->peeks)
        session_show_cross(session, place ? place : pilot->cross);
    pilot->peeks = place != NULL;
}

/* ---- the host ---- */

void pilot_host_fill(struct pilot_host *host)
{
    host->finished = host_finished;
    host->facts = host_facts;
    host->move = host_move;
    host->picture = host_picture;
    host->pan = host_pan;
    host->name_ahead = host_name_ahead;
    host->ahead = host_ahead;
    host->voxel_at = host_voxel_at;
    host->voxel_of_frame = host_voxel_of_frame;
    host->frame_pixel = host_frame_pixel;
    host->label = host_label;
    host->labels = host_labels;
    host->next_label = host_next_label;
    host->held = host_held;
    host->why = host_why;
    host->hints = host_hints;
    host->look_on = host_look_on;
    host->finish = host_finish;
    host->preview_cross = host_preview_cross;
    host->outline = host_outline;
    host->doubt = host_doubt;
    host->seed = host_seed;
    host->centre = host_centre;
    host->is_hidden = host_is_hidden;
}
