/* SPDX-License-Identifier: MIT */
#include "show/voxel_facts.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/hints.h"
#include "engine/margin.h"
#include "engine/measure.h"
#include "render/slice.h"
#include "session/doubtful.h"
#include "session/markers.h"
#include "session/tally.h"
#include "show/draw.h"
#include "show/label_report.h"

enum { CORNERS_LEAST = 3 };

/* In the slice, and around the place or near it. */
static bool is_near(const struct polyline *line, unsigned axis, const uint32_t place[3])
{
    for (unsigned a = 0; a < 3; a++) {
        int64_t first = INT64_MAX, last = -1;
        const int64_t near = a == axis ? 0 : OUTLINE_FACTS_NEAR;
        for (size_t i = 0; i < line->count; i++) {
            first = line->corner[i][a] < first ? line->corner[i][a] : first;
            last = line->corner[i][a] > last ? line->corner[i][a] : last;
        }
        if (place[a] < first - near || place[a] > last + near)
            return false;
    }
    return line->count >= CORNERS_LEAST;
}

/* Whether a voxel of a marker lies in the slice: else no contour of it does. */
static bool begins_in(const struct session *session, const struct marker *marker, unsigned axis,
                      const uint32_t place[3])
{
    uint32_t first[3];
    grid_find(&session_scene(session)->grid, session_markers(session)->cover[marker->first].cell,
              first);
    return first[axis] == place[axis];
}

/* The latest marker's, or 0. */
static uint32_t find_marker(struct polyline *line, const struct session *session, unsigned label,
                            unsigned axis, const uint32_t place[3])
{
    const struct markers *markers = session_markers(session);
    for (uint32_t number = (uint32_t)markers->count; number > 0; number--) {
        const struct marker *marker = markers->marker + number - 1;
        line->count = 0;
        if (marker->stands && !marker->joined && marker->label == (int)label && marker->voxels &&
            begins_in(session, marker, axis, place) &&
            contour_of_marker(line, &session_scene(session)->grid, markers, number, NULL) == OK &&
            is_near(line, axis, place))
            return number;
    }
    line->count = 0;
    return 0;
}

bool outline_facts_find(struct polyline *line, uint32_t *marker, struct session *session,
                        unsigned label, unsigned axis, const uint32_t place[3], struct buf *out)
{
    struct labels labels;
    *marker = find_marker(line, session, label, axis, place);
    if (*marker) {
        buf_printf(out, "the outline of marker %u", *marker);
        return true;
    }
    const bool found =
        session_labels(session, session_shows_finished(session), &labels, NULL) == OK &&
        contour_of_label(line, &labels, label, axis, place, NULL) == OK &&
        line->count >= CORNERS_LEAST;
    buf_add_text(out, found ? "the border of label " : "in this slice there is nothing of label ");
    label_report_write_name(out, session, label);
    return found;
}

bool outline_facts_next(unsigned *axis, uint32_t place[3], struct session *session, unsigned label,
                        size_t rank, struct buf *out)
{
    struct doubtful_slice slice[DOUBTFUL_MOST];
    struct labels labels;
    struct fault why;
    size_t count = 0;
    if (label == 0) {
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
    *axis = slice[rank - 1].axis;
    voxel_facts_write_doubt(out, session, &slice[rank - 1]);
    return true;
}

static uint32_t cell_at(const struct session *session, const uint32_t p[3])
{
    return grid_cell(&session_scene(session)->grid, p[0], p[1], p[2]);
}

/* ---- of a voxel ---- */

/* Of the labels that the last edit changed, the one of which it changed most; 0 for none. */
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

/* All of a label, as pictures show it, and what the last edit changed of it. */
static void write_volume(struct buf fact[VOXEL_FACTS], const struct session *session,
                         unsigned label)
{
    const uint64_t *before, *voxels = session_shown_voxels(session, &before);
    if (label == 0 || !voxels)
        return;
    buf_add_char(&fact[FACT_VOLUME], ' ');
    label_report_write_extent(&fact[FACT_VOLUME], session, voxels[label]);
    label_report_write_change(&fact[FACT_CHANGE], session, voxels[label],
                              before ? before[label] : 0);
}

static void write_labels(struct buf fact[VOXEL_FACTS], const struct session *session, uint32_t at)
{
    const struct cell *cell = session_scene(session)->cell + at;
    const unsigned label = session_shown_label(session, at), changed = changed_most(session);
    struct buf name = {0};
    label_report_write_name(&name, session, label);
    const size_t number = strcspn(buf_text(&name), " ");
    if (cell->flags & CELL_OUTSIDE) {
        buf_add_text(&fact[FACT_HERE], "outside the region of interest");
    } else if (cell_is_reached(cell)) {
        buf_printf(&fact[FACT_HERE], "here %.*s", (int)number, buf_text(&name));
        buf_add_text(&fact[FACT_NAME], buf_text(&name) + number);
    } else {
        buf_add_text(&fact[FACT_HERE], "no label");
    }
    if (!label && changed) {
        buf_add_text(&fact[FACT_VOLUME], "changed ");
        label_report_write_name(&fact[FACT_VOLUME], session, changed);
    }
    write_volume(fact, session, label ? label : changed);
    if (label != cell->label) {
        buf_add_text(&fact[FACT_IN_FOREST], "in the forest ");
        label_report_write_name(&fact[FACT_IN_FOREST], session, cell->label);
    }
    fact->failed |= name.failed;
    buf_release(&name);
}

void voxel_facts_write(struct buf fact[VOXEL_FACTS], struct session *session,
                       const uint32_t place[3], bool knows_sums)
{
    const uint32_t at = cell_at(session, place);
    const struct cell *cell = session_scene(session)->cell + at;
    const struct geometry *geometry = session_geometry(session);
    const unsigned label = session_shown_label(session, at);
    struct label_sums sums;
    double mm[3];
    geometry_point(geometry, place, mm);
    write_labels(fact, session, at);
    buf_add_text(&fact[FACT_INTENSITY], "intensity ");
    levels_write(&fact[FACT_INTENSITY], geometry, session_levels(session), cell->intensity);
    if (geometry_has_place(geometry))
        buf_printf(&fact[FACT_PLACE], "%.1f,%.1f,%.1f mm", mm[0], mm[1], mm[2]);
    else if (geometry->orientation == ORIENTATION_UNKNOWN)
        buf_add_text(&fact[FACT_PLACE], "orientation unknown");
    else if (geometry->orientation == ORIENTATION_TOLD)
        buf_add_text(&fact[FACT_PLACE], "sides as told by the user");
    if (knows_sums && label && session_sum_shown(session, label, &sums, NULL) == OK && sums.voxels)
        label_report_write_sums(&fact[FACT_SUMS], &sums, geometry);
}

double voxel_facts_intensity(const struct session *session, const uint32_t place[3])
{
    return levels_value(session_geometry(session), session_levels(session),
                        session_scene(session)->cell[cell_at(session, place)].intensity);
}

void voxel_why_release(struct voxel_why *why)
{
    way_release(&why->way);
}

bool voxel_why_find(struct voxel_why *why, const struct session *session, const uint32_t place[3],
                    struct buf *out)
{
    const struct forest *forest = session_forest(session);
    const uint32_t cell = cell_at(session, place);
    const struct cell *at = session_scene(session)->cell + cell;
    struct rival rival = {.exists = false};
    struct fault fault;
    if (!cell_is_reached(at)) {
        buf_add_text(out, "no seed reaches this voxel");
        return false;
    }
    enum err err = way_find(&why->way, forest, cell, &fault);
    if (!err && forest_arcs(forest)->kind != ARC_POLARITY)
        err = rival_find(&rival, forest, cell, &fault);
    if (err) {
        buf_printf(out, "error: %s", fault.text);
        return false;
    }
    const size_t steps = why->way.count - 1;
    why->label = at->label;
    why->next = rival.exists ? rival.label : 0;
    why->has_edge = why->way.edge != CELL_NONE;
    grid_find(&session_scene(session)->grid, key_root(at->key), why->root);
    buf_add_text(out, "label ");
    label_report_write_name(out, session, at->label);
    buf_printf(out, ", cost %u, %zu step%s", key_cost(at->key), steps, plural(steps));
    if (why->has_edge) {
        grid_find(&session_scene(session)->grid, why->way.edge, why->edge);
        buf_printf(out, ", strongest edge %u,%u,%u", why->edge[0], why->edge[1], why->edge[2]);
    }
    if (rival.exists) {
        buf_add_text(out, "; next ");
        label_report_write_name(out, session, rival.label);
        buf_printf(out, " at %u", rival.cost);
    }
    return true;
}

bool voxel_facts_find_held(struct held *held, const struct session *session,
                           const uint32_t place[3], bool tree, struct buf *out)
{
    uint32_t seed[3];
    if (session_find_held(held, session, cell_at(session, place), tree, NULL) != OK)
        return false;
    if (held->marker) {
        buf_printf(out, "marker %u: %s%zu tree%s, ", held->marker,
                   held->has_more ? "at least " : "", held->trees, plural(held->trees));
    } else {
        grid_find(&session_scene(session)->grid, held->seed, seed);
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
    label_report_write_name(out, session, held->label);
    return true;
}

unsigned voxel_facts_hints(struct session *session)
{
    const struct hint_list *found;
    return session_find_hints(session, &found, NULL, NULL) == OK ? (unsigned)found->count : 0;
}

void voxel_facts_write_doubt(struct buf *out, const struct session *session,
                             const struct doubtful_slice *slice)
{
    const struct scene *scene = session_scene(session);
    const uint64_t voxels = (slice->doubt + DOUBT_VOXEL / 2) / DOUBT_VOXEL;
    int plane = SLICE_AXIAL;
    while (slice_axis(scene, (enum slice_plane)plane) != (int)slice->axis)
        plane++;
    if (!scene->sides_unknown)
        buf_printf(out, "%s ", slice_name(scene, (enum slice_plane)plane));
    buf_printf(out, "%c=%u: ", "xyz"[slice->axis], slice -> at);
    if (session_geometry(session)->spacing_unknown)
        buf_printf(out, "%" PRIu64 " voxel%s", voxels, plural(voxels));
    else
        tally_write_volume(out, session_geometry(session), voxels);
    buf_add_text(out, " in doubt");
}

/* ---- of a label ---- */

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

bool voxel_facts_next_seed(const struct session *session, unsigned label, int64_t by,
                           uint32_t place[3])
{
    const struct markers *markers = session_markers(session);
    const uint32_t here = cell_at(session, session_outlook(session)->slices.cross);
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
        grid_find(&session_scene(session)->grid, cell[((at + by) % count + count) % count], place);
    free(cell);
    return count > 0;
}

bool voxel_facts_centre(struct session *session, unsigned label, uint32_t place[3])
{
    return session_count_labels(session, NULL) == OK && session_tally(session)->voxels[label] > 0 &&
           centre_of_label(session_scene(session), label, place);
}
