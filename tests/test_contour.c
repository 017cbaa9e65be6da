/* SPDX-License-Identifier: MIT */
/* Contours of areas compared with plain models. The polygon through their corners is the component
 * at a place, or otherwise the largest one, with its holes filled; only voxels within half a voxel
 * of the line may differ. Areas are random circles, rectangles and holes in slices of all three
 * planes. */
#include "session/doubtful.h"
#include "session/paint.h"
#include "tests/check_main.h"
#include "tests/paint_model.h"
#include "tests/scarce_memory.h"

enum { SIDE = 60, LABEL = 7 };

static struct scene scene;
static uint8_t *label; /* by cell */
static bool *piece;    /* by cell: the one at `from` or the largest, by the model */
static unsigned axis, across[2];
static uint32_t at, from[3]; /* the slice, and a place in it */
static uint64_t from_seed = 5;
DRAW_FROM(33)

static uint32_t cell_of(int64_t column, int64_t row)
{
    uint32_t place[3];
    place[axis] = at;
    place[across[0]] = (uint32_t)column;
    place[across[1]] = (uint32_t)row;
    return grid_cell(&scene.grid, place[0], place[1], place[2]);
}

static bool is_inside(int64_t column, int64_t row)
{
    return column >= 0 && row >= 0 && column < scene.grid.size[across[0]] &&
           row < scene.grid.size[across[1]];
}

static void begin(void)
{
    const uint32_t size[3] = {2 + below(SIDE), 2 + below(SIDE), 2 + below(SIDE)};
    axis = below(3);
    across[0] = axis == 0;
    across[1] = axis == 2 ? 1 : 2;
    at = below(size[axis]);
    for (unsigned a = 0; a < 3; a++)
        from[a] = a == axis ? at : check_below(&from_seed, size[a]);
    CHECK(grid_init(&scene.grid, size, NULL) == OK);
    label = mem_new(scene.grid.cells);
    piece = mem_new(scene.grid.cells);
}

static void end(void)
{
    free(label);
    free(piece);
}

static struct labels all_labels(void)
{
    return (struct labels){&scene, label};
}

/* Paints a circle or a rectangle of a label in the slice, or of no label. */
static void add_shape(uint8_t what)
{
    const uint32_t *size = scene.grid.size;
    const int64_t column = below(size[across[0]]), row = below(size[across[1]]),
                  wide = 1 + below(SIDE / 3), high = 1 + below(SIDE / 3);
    const bool is_round = below(3);
    for (int64_t r = row - high; r <= row + high; r++)
        for (int64_t c = column - wide; c <= column + wide; c++)
            if (is_inside(c, r) &&
                (!is_round || (c - column) * (c - column) + (r - row) * (r - row) <= wide * wide))
                label[cell_of(c, r)] = what;
}

/* The size of a component of the label, connected by faces. Marks its voxels until nothing
 * changes. */
static size_t grow(bool *marked, int64_t column, int64_t row)
{
    const uint32_t *size = scene.grid.size;
    size_t count = 1;
    marked[cell_of(column, row)] = true;
    for (bool grows = true; grows;) {
        grows = false;
        for (int64_t r = 0; r < size[across[1]]; r++)
            for (int64_t c = 0; c < size[across[0]]; c++) {
                const uint32_t cell = cell_of(c, r);
                if (marked[cell] || label[cell] != LABEL)
                    continue;
                const bool touches = (is_inside(c - 1, r) && marked[cell_of(c - 1, r)]) ||
                                     (is_inside(c + 1, r) && marked[cell_of(c + 1, r)]) ||
                                     (is_inside(c, r - 1) && marked[cell_of(c, r - 1)]) ||
                                     (is_inside(c, r + 1) && marked[cell_of(c, r + 1)]);
                marked[cell] = touches;
                grows |= touches;
                count += touches;
            }
    }
    return count;
}

/* The piece that is meant into `piece`. How many voxels it has. */
static size_t find_piece(void)
{
    const uint32_t *size = scene.grid.size;
    if (label[cell_of(from[across[0]], from[across[1]])] == LABEL)
        return grow(piece, from[across[0]], from[across[1]]);
    OWNED(mem_release) bool *one = mem_new(scene.grid.cells), *done = mem_new(scene.grid.cells);
    size_t most = 0;
    for (int64_t r = 0; r < size[across[1]]; r++)
        for (int64_t c = 0; c < size[across[0]]; c++) {
            if (label[cell_of(c, r)] != LABEL || done[cell_of(c, r)])
                continue;
            memset(one, 0, scene.grid.cells * sizeof *one);
            const size_t count = grow(one, c, r);
            for (size_t i = 0; i < scene.grid.cells; i++)
                done[i] |= one[i];
            if (count > most)
                memcpy(piece, one, scene.grid.cells * sizeof *one);
            most = count > most ? count : most;
        }
    return most;
}

/* Whether a place is within half a voxel of the line. */
static bool is_near_line(const struct polyline *line, int64_t column, int64_t row)
{
    for (size_t i = 0; i < line->count; i++) {
        const uint32_t *a = line->corner[i], *b = line->corner[(i + 1) % line->count];
        const double way[2] = {(double)b[across[0]] - a[across[0]],
                               (double)b[across[1]] - a[across[1]]};
        const double off_a[2] = {(double)column - a[across[0]], (double)row - a[across[1]]};
        const double length = way[0] * way[0] + way[1] * way[1];
        double part = length > 0 ? (off_a[0] * way[0] + off_a[1] * way[1]) / length : 0;
        part = part < 0 ? 0 : part > 1 ? 1 : part;
        const double off[2] = {off_a[0] - part * way[0], off_a[1] - part * way[1]};
        if (off[0] * off[0] + off[1] * off[1] <= 0.25 + 1e-9)
            return true;
    }
    return false;
}

/* By cell, whether no path by faces leads to the edge of the slice. A contour also passes through
 * corners, so it closes a bay whose ends touch at a corner. */
static bool *find_holes(void)
{
    const uint32_t *size = scene.grid.size;
    bool *outside = mem_new(scene.grid.cells), *hole = mem_new(scene.grid.cells);
    for (bool grows = true; grows;) {
        grows = false;
        for (int64_t r = 0; r < size[across[1]]; r++)
            for (int64_t c = 0; c < size[across[0]]; c++) {
                bool touches =
                    c == 0 || r == 0 || c + 1 == size[across[0]] || r + 1 == size[across[1]];
                for (int k = 1; k < 9 && !touches; k += 2)
                    touches = outside[cell_of(c + k % 3 - 1, r + k / 3 - 1)];
                if (piece[cell_of(c, r)] || outside[cell_of(c, r)] || !touches)
                    continue;
                outside[cell_of(c, r)] = grows = true;
            }
    }
    for (size_t i = 0; i < scene.grid.cells; i++)
        hole[i] = !piece[i] && !outside[i];
    free(outside);
    return hole;
}

STORY(the_polygon_of_a_contour_is_the_piece_at_a_place_or_the_largest)
{
    size_t both = 0, of_piece = 0, of_polygon = 0;
    for (int round = 0; round < 400 && check_failures == 0; round++) {
        OWNED(polyline_release) struct polyline line = {0};
        OWNED(voxels_release) struct voxels filled = {0};
        begin();
        for (uint32_t n = 1 + below(5); n > 0; n--)
            add_shape(below(4) ? LABEL : 1);
        const struct labels labels = all_labels();
        const size_t voxels = find_piece();
        CHECK(contour_of_label(&line, &labels, LABEL, axis, from, NULL) == OK);
        CHECK((line.count > 0) == (voxels > 0) && line.count <= CONTOUR_CORNERS_MOST);
        if (line.count) {
            OWNED(mem_release) bool *hole = find_holes(), *has = mem_new(scene.grid.cells);
            CHECK(paint_polygon(&filled, &scene.grid, (corners_of)line.corner, line.count, NULL,
                                NULL) == OK);
            for (size_t i = 0; i < filled.count; i++)
                has[filled.cell[i]] = true;
            for (int64_t r = 0; r < scene.grid.size[across[1]]; r++)
                for (int64_t c = 0; c < scene.grid.size[across[0]]; c++) {
                    const uint32_t cell = cell_of(c, r);
                    const bool wanted = piece[cell] || hole[cell];
                    CHECK(has[cell] == wanted || is_near_line(&line, c, r));
                    both += has[cell] && wanted;
                    of_piece += wanted;
                    of_polygon += has[cell];
                }
        }
        end();
    }
    CHECK(of_piece > 50000);
    CHECK(200 * both >= 97 * (of_piece + of_polygon)); /* Dice's coefficient */
}

STORY(of_a_rectangle_it_has_four_corners)
{
    for (int round = 0; round < 200 && check_failures == 0; round++) {
        OWNED(polyline_release) struct polyline line = {0};
        begin();
        const uint32_t *size = scene.grid.size;
        const uint32_t wide = 2 + below(size[across[0]] - 1), high = 2 + below(size[across[1]] - 1),
                       left = below(size[across[0]] - wide + 1),
                       top = below(size[across[1]] - high + 1);
        for (uint32_t r = top; r < top + high; r++)
            for (uint32_t c = left; c < left + wide; c++)
                label[cell_of(c, r)] = LABEL;
        const struct labels labels = all_labels();
        CHECK(contour_of_label(&line, &labels, LABEL, axis, from, NULL) == OK);
        CHECK_INT(line.count, 4);
        if (line.count == 4)
            for (int i = 0; i < 4; i++) {
                CHECK_INT(line.corner[i][axis], at);
                CHECK_INT(line.corner[i][across[0]], left + (i % 3 ? wide - 1 : 0));
                CHECK_INT(line.corner[i][across[1]], top + (i / 2 ? high - 1 : 0));
            }
        end();
    }
}

STORY(a_voxel_or_a_row_has_fewer_corners_and_nothing_has_none)
{
    struct polyline line = {0};
    begin();
    const struct labels labels = all_labels();
    CHECK(contour_of_label(&line, &labels, LABEL, axis, from, NULL) == OK);
    CHECK_INT(line.count, 0);
    label[cell_of(0, 0)] = LABEL;
    CHECK(contour_of_label(&line, &labels, LABEL, axis, from, NULL) == OK);
    CHECK_INT(line.count, 1);
    polyline_release(&line);
    label[cell_of(0, 1)] = LABEL;
    CHECK(contour_of_label(&line, &labels, LABEL, axis, from, NULL) == OK);
    CHECK_INT(line.count, 2);
    polyline_release(&line);
    end();
}

/* A comb whose teeth are a voxel wide and a voxel apart has more corners than may be. */
STORY(there_are_no_more_corners_than_a_hand_would_drag)
{
    const uint32_t size[3] = {4000, 3, 1};
    OWNED(polyline_release) struct polyline line = {0};
    CHECK(grid_init(&scene.grid, size, NULL) == OK);
    axis = 2, across[0] = 0, across[1] = 1, at = 0;
    memset(from, 0, sizeof from);
    label = mem_new(scene.grid.cells);
    for (uint32_t c = 0; c < size[0]; c++)
        label[cell_of(c, 1)] = label[cell_of(c, c % 2 ? 1 : 2)] = label[cell_of(c, c % 4 ? 1 : 0)] =
            LABEL;
    const struct labels labels = all_labels();
    CHECK(contour_of_label(&line, &labels, LABEL, axis, from, NULL) == OK);
    CHECK(line.count > 400 && line.count <= CONTOUR_CORNERS_MOST);
    free(label);
}

STORY(an_outline_that_was_drawn_is_found_again)
{
    for (int round = 0; round < 200 && check_failures == 0; round++) {
        const uint32_t size[3] = {9 + below(SIDE), 9 + below(SIDE), 9 + below(SIDE)};
        OWNED(markers_release) struct markers markers = {0};
        OWNED(polyline_release) struct polyline line = {0};
        OWNED(voxels_release) struct voxels drawn = {0}, again = {0};
        uint32_t corner[4][3];
        CHECK(grid_init(&scene.grid, size, NULL) == OK);
        axis = below(3);
        at = below(size[axis]);
        for (int i = 0; i < 4; i++)
            for (unsigned a = 0; a < 3; a++)
                corner[i][a] = a == axis ? at : below(size[a]);
        CHECK(paint_polygon(&drawn, &scene.grid, (corners_of)corner, 4, NULL, NULL) == OK);
        CHECK(markers_add(&markers, 1, drawn.cell, drawn.count, NULL, NULL) == OK);
        CHECK(contour_of_marker(&line, &scene.grid, &markers, 1, NULL) == OK);
        if (drawn.count > 1 && CHECK(line.count > 1)) {
            CHECK(paint_polygon(&again, &scene.grid, (corners_of)line.corner, line.count, NULL,
                                NULL) == OK);
            CHECK(again.count <= drawn.count + 40);
        }
    }
    const uint32_t cell[2] = {grid_cell(&scene.grid, 1, 2, 3), grid_cell(&scene.grid, 2, 3, 4)};
    OWNED(markers_release) struct markers markers = {0};
    struct polyline line = {0};
    CHECK(markers_add(&markers, 1, cell, 2, NULL, NULL) == OK); /* in no one slice */
    CHECK(contour_of_marker(&line, &scene.grid, &markers, 1, NULL) == OK);
    CHECK_INT(line.count, 0);
}

STORY(without_memory_there_is_no_contour)
{
    unsigned failed = 0;
    begin();
    for (int n = 0; n < 5; n++)
        add_shape(LABEL);
    const struct labels labels = all_labels();
    for (size_t most = 0; most < 40000; most += most / 4 + 50) {
        OWNED(polyline_release) struct polyline line = {0};
        allow_bytes(most);
        const enum err err = contour_of_label(&line, &labels, LABEL, axis, from, NULL);
        mem_allows = NULL;
        CHECK(err == OK || (err == ERR_MEMORY && line.count == 0));
        failed += err != OK;
    }
    CHECK(failed > 3);
    end();
}
