/* SPDX-License-Identifier: MIT */
#include "session/doubtful.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "session/session_inside.h"

/* The voxels of a slice, by columns and rows. */
struct area {
    unsigned axis, across[2]; /* axes of the scene along columns and rows */
    uint32_t at, width, height;
    uint8_t *piece;  /* [height][width]: ABSENT, ASKED for, SEEN, or in the chosen piece MEANT */
    uint32_t *queue; /* places row * width + column */
};

enum { ABSENT, ASKED, SEEN, MEANT };
enum { NOWHERE = -1 };

static void area_release(struct area *area)
{
    free(area->piece);
    free(area->queue);
}

static enum err area_init(struct area *area, const struct grid *grid, unsigned axis, uint32_t at,
                          struct fault *fault)
{
    *area = (struct area){.axis = axis, .at = at, .across = {axis == 0, axis == 2 ? 1 : 2}};
    area->width = grid->size[area->across[0]];
    area->height = grid->size[area->across[1]];
    const size_t voxels = (size_t)area->width * area->height;
    area->piece = mem_new(voxels);
    area->queue = mem_array(voxels, sizeof *area->queue);
    return area->piece && area->queue ? OK : fault_memory(fault, "a contour");
}

static void find_place(const struct area *area, uint32_t column, uint32_t row, uint32_t place[3])
{
    place[area->axis] = area->at;
    place[area->across[0]] = column;
    place[area->across[1]] = row;
}

static uint32_t place_of(const struct area *area, const uint32_t place[3])
{
    return place[area->across[1]] * area->width + place[area->across[0]];
}

static bool has(const struct area *area, int64_t column, int64_t row, uint8_t what)
{
    return column >= 0 && row >= 0 && column < area->width && row < area->height &&
           area->piece[row * area->width + column] == what;
}

/* ---- the piece ---- */

/* Change all voxels connected to this one by faces to another kind, and return their number. */
static uint32_t flood(struct area *area, uint32_t from, uint8_t kind)
{
    const uint8_t former = area->piece[from];
    uint32_t done = 0, count = 1;
    area->queue[0] = from;
    for (area->piece[from] = kind; done < count; done++) {
        const int64_t column = area->queue[done] % area->width,
                      row = area->queue[done] / area->width;
        const int64_t beside[4][2] = {
            {column - 1, row}, {column + 1, row}, {column, row - 1}, {column, row + 1}};
        for (int k = 0; k < 4; k++)
            if (has(area, beside[k][0], beside[k][1], former)) {
                area->queue[count] = (uint32_t)(beside[k][1] * area->width + beside[k][0]);
                area->piece[area->queue[count++]] = kind;
            }
    }
    return count;
}

/* Mark the largest piece MEANT and find its first place; false if no voxel is asked for. */
static bool find_largest(struct area *area, uint32_t *first)
{
    const uint32_t voxels = area->width * area->height;
    uint32_t most = 0;
    for (uint32_t i = 0; i < voxels; i++) {
        const uint32_t count = area->piece[i] == ASKED ? flood(area, i, SEEN) : 0;
        if (count > most) {
            most = count;
            *first = i;
        }
    }
    if (most)
        flood(area, *first, MEANT);
    return most > 0;
}

/* ---- the way around it ---- */

/* Clockwise from east; rows run down. */
static const int8_t step[8][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                  {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

/* Return the first direction to a voxel of the piece, clockwise from `from`; 8 for a single
 * voxel. */
static unsigned find_direction(const struct area *area, const int64_t at[2], unsigned from)
{
    for (unsigned k = 0; k < 8; k++) {
        const unsigned d = (from + k) % 8;
        if (has(area, at[0] + step[d][0], at[1] + step[d][1], MEANT))
            return d;
    }
    return 8;
}

static bool add_place(struct polyline *line, const struct area *area, const int64_t at[2])
{
    uint32_t place[3];
    find_place(area, (uint32_t)at[0], (uint32_t)at[1], place);
    return polyline_add(line, place);
}

/* Moore's tracing: keep the outside on the left until the walk leaves the first voxel in the
 * first direction again. No voxel precedes the first place, so the walk enters it from the west. */
static bool trace_border(struct polyline *line, const struct area *area, uint32_t first)
{
    const int64_t begin[2] = {first % area->width, first / area->width};
    const unsigned leaves = find_direction(area, begin, 0);
    int64_t at[2] = {begin[0], begin[1]};
    bool fits = add_place(line, area, at), goes_on = leaves < 8;
    for (unsigned d = leaves; fits && goes_on;) {
        at[0] += step[d][0];
        at[1] += step[d][1];
        fits = add_place(line, area, at);
        d = find_direction(area, at, d + 5); /* from the direction after the one back */
        goes_on = at[0] != begin[0] || at[1] != begin[1] || d != leaves;
    }
    return fits;
}

/* Mark the piece with the voxel `from` MEANT and find its first place; false if it is in none.
 * */
static bool find_piece(struct area *area, int64_t from, uint32_t *first)
{
    if (from == NOWHERE || area->piece[from] != ASKED)
        return false;
    flood(area, (uint32_t)from, MEANT);
    for (*first = 0; area->piece[*first] != MEANT;)
        ++*first;
    return true;
}

/* Trace the piece with `from`; if there is no such piece, the largest one. */
static enum err trace(struct polyline *contour, struct area *area, int64_t from,
                      struct fault *fault)
{
    uint32_t first;
    if ((find_piece(area, from, &first) || find_largest(area, &first)) &&
        !trace_border(contour, area, first)) {
        polyline_release(contour);
        return fault_memory(fault, "a contour");
    }
    polyline_simplify(contour);
    if (contour->count > 1) /* the last corner repeats the first */
        contour->count--;
    for (; contour->count > CONTOUR_CORNERS_MOST; contour->count = (contour->count + 1) / 2)
        for (size_t i = 0; 2 * i < contour->count; i++)
            memmove(contour->corner[i], contour->corner[2 * i], sizeof contour->corner[0]);
    return OK;
}

/* ---- contours of labels and markers ---- */

enum err contour_of_label(struct polyline *contour, const struct labels *labels, unsigned label,
                          unsigned axis, const uint32_t place[3], struct fault *fault)
{
    const struct grid *grid = &labels->scene->grid;
    OWNED(area_release) struct area area = {0};
    TRY(area_init(&area, grid, axis, place[axis], fault));
    for (uint32_t row = 0, p[3]; row < area.height; row++)
        for (uint32_t column = 0; column < area.width; column++) {
            find_place(&area, column, row, p);
            const uint32_t cell = grid_cell(grid, p[0], p[1], p[2]);
            area.piece[row * area.width + column] = labels_at(labels, cell) == label;
        }
    return trace(contour, &area, place_of(&area, place), fault);
}

/* Find the box around the voxels of a marker, and the last axis along which it is one voxel
 * thick, 3 for no axis. */
static unsigned find_box(uint32_t first[3], uint32_t last[3], const struct grid *grid,
                         const struct markers *markers, uint32_t number)
{
    const struct marker *marker = &markers->marker[number - 1];
    const struct cover *cover = &markers->cover[marker->first];
    unsigned axis = 3;
    grid_find(grid, cover[0].cell, first);
    memcpy(last, first, 3 * sizeof *last);
    for (uint32_t i = 1, place[3]; i < marker->voxels; i++) {
        grid_find(grid, cover[i].cell, place);
        for (int a = 0; a < 3; a++) {
            first[a] = place[a] < first[a] ? place[a] : first[a];
            last[a] = place[a] > last[a] ? place[a] : last[a];
        }
    }
    for (unsigned a = 0; a < 3; a++)
        axis = first[a] == last[a] ? a : axis;
    return axis;
}

bool contour_is_area(unsigned *axis, uint32_t *at, const struct grid *grid,
                     const struct markers *markers, uint32_t number)
{
    uint32_t first[3], last[3];
    uint64_t around = 0;
    *axis = find_box(first, last, grid, markers, number);
    for (unsigned a = 0; a < 3; a++)
        around += a == *axis ? 0 : last[a] - first[a] + 1;
    *at = *axis < 3 ? first[*axis] : 0;
    return *axis < 3 && markers->marker[number - 1].voxels > around;
}

enum err contour_of_marker(struct polyline *contour, const struct grid *grid,
                           const struct markers *markers, uint32_t number, struct fault *fault)
{
    const struct marker *marker = &markers->marker[number - 1];
    uint32_t first[3], place[3];
    const unsigned axis = find_box(first, place, grid, markers, number);
    OWNED(area_release) struct area area = {0};
    if (axis == 3)
        return OK;
    TRY(area_init(&area, grid, axis, first[axis], fault));
    for (size_t i = 0; i < marker->voxels; i++) {
        grid_find(grid, markers->cover[marker->first + i].cell, place);
        area.piece[place_of(&area, place)] = ASKED;
    }
    return trace(contour, &area, NOWHERE, fault);
}

void doubting_release(struct doubting *doubting)
{
    doubt_release(&doubting->doubt);
    *doubting = (struct doubting){0};
}

/* Update the doubt of the present labels, if they have changed. */
static enum err update_doubt(struct session *session, unsigned label, struct fault *fault)
{
    struct doubting *d = &session->inside->doubting;
    const uint64_t of = hash_mix_at(hash_mix_at(session_finish_source(session), label),
                                    forest_digest(session->forest) ^ session->roi_tally.digest);
    if (d->doubt.all && d->of == of)
        return OK;
    doubting_release(d);
    d->of = of;
    return doubt_find(&d->doubt, &session->now.kept.finish, session->scene, session->team, label,
                      fault);
}

/* ---- the slices ---- */

/* Exclude slices from..to of an axis. */
static void leave_out(struct doubt *doubt, unsigned axis, int64_t from, int64_t to)
{
    for (int64_t at = from < 0 ? 0 : from; at <= to && at < doubt->size[axis]; at++)
        doubt->slice[axis][at] = 0;
}

enum err doubtful_find(struct doubtful_slice slice[DOUBTFUL_MOST], size_t *count,
                       struct session *session, unsigned label, struct fault *fault)
{
    const struct doubt *doubt = &session->inside->doubting.doubt;
    *count = 0;
    TRY(update_doubt(session, label, fault));
    /* Copy the sums, so that slices can be excluded. */
    const size_t slices = (size_t)doubt->size[0] + doubt->size[1] + doubt->size[2];
    OWNED(doubt_release) struct doubt left = *doubt;
    left.slice[0] = mem_array(slices, sizeof *left.slice[0]);
    if (!left.slice[0])
        return fault_memory(fault, "doubt");
    memcpy(left.slice[0], doubt->slice[0], slices * sizeof *left.slice[0]);
    left.slice[1] = left.slice[0] + left.size[0];
    left.slice[2] = left.slice[1] + left.size[1];
    const struct markers *markers = &session->markers;
    unsigned axis;
    uint32_t at;
    for (uint32_t n = 1; n <= markers->count; n++) {
        const struct marker *marker = &markers->marker[n - 1];
        if (marker->is_valid && marker->label > 0 &&
            (marker->label == (int)label || label == FINISH_ALL_LABELS) &&
            contour_is_area(&axis, &at, &session->scene->grid, markers, n))
            leave_out(&left, axis, (int64_t)at - 1, (int64_t)at + 1);
    }
    for (; *count < DOUBTFUL_MOST && doubt_worst(&left, &axis, &at); (*count)++) {
        slice[*count] = (struct doubtful_slice){axis, at, left.slice[axis][at]};
        leave_out(&left, axis, (int64_t)at - DOUBTFUL_APART + 1, (int64_t)at + DOUBTFUL_APART - 1);
    }
    return OK;
}

/* ---- a place in a slice ---- */

static int64_t distance_2(const uint32_t place[3], const uint64_t sum[3], uint64_t count)
{
    int64_t squared = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t way = (int64_t)place[a] - (int64_t)(sum[a] / count);
        squared += way * way;
    }
    return squared;
}

/* Find the voxel of a label in a slice nearest to the mean of all its voxels; the first of equal
 * ones. */
static bool find_middle(uint32_t middle[3], const struct labels *labels, unsigned label,
                        unsigned axis, uint32_t at)
{
    const struct grid *grid = &labels->scene->grid;
    const unsigned u = axis == 0, v = axis == 2 ? 1 : 2;
    uint64_t count = 0, sum[3] = {0};
    int64_t nearest = INT64_MAX;
    uint32_t place[3];
    place[axis] = at;
    for (int pass = 0; pass < 2; pass++)
        for (place[v] = 0; place[v] < grid->size[v]; place[v]++)
            for (place[u] = 0; place[u] < grid->size[u]; place[u]++) {
                const unsigned has =
                    labels_at(labels, grid_cell(grid, place[0], place[1], place[2]));
                if (label == FINISH_ALL_LABELS ? !has : has != label)
                    continue;
                if (pass == 0) {
                    for (int a = 0; a < 3; a++)
                        sum[a] += place[a];
                    count++;
                } else if (distance_2(place, sum, count) < nearest) {
                    nearest = distance_2(place, sum, count);
                    memcpy(middle, place, sizeof place);
                }
            }
    return count > 0;
}

bool doubtful_place(uint32_t place[3], const struct labels *labels, unsigned label,
                    const struct doubtful_slice *slice)
{
    const uint32_t size = labels->scene->grid.size[slice->axis];
    bool found = false;
    for (uint32_t away = 0; !found && away < size; away++)
        found =
            (slice->at + away < size &&
             find_middle(place, labels, label, slice->axis, slice->at + away)) ||
            (away <= slice->at && find_middle(place, labels, label, slice->axis, slice->at - away));
    place[slice->axis] = slice->at;
    return found;
}
