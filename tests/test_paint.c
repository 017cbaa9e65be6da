/* SPDX-License-Identifier: MIT */
/* Painting, against plain models that examine every voxel. Places are random, and grids small
 * enough for their edges to matter. */
#include "base/polyline.h"
#include "session/paint.h"
#include "tests/check_main.h"
#include "tests/paint_model.h"
#include "tests/scarce_memory.h"
#include "tests/stopping.h"

enum { SIDE = 17, CORNERS_MOST = 12 };

static struct grid grid;
static bool wanted[(SIDE + 2) * (SIDE + 2) * (SIDE + 2)]; /* by cell, according to the model */
DRAW_FROM(14)

static void begin(void)
{
    const uint32_t size[3] = {1 + below(SIDE), 1 + below(SIDE), 1 + below(SIDE)};
    CHECK(grid_init(&grid, size, NULL) == OK);
    memset(wanted, 0, sizeof wanted);
}

static void random_place(uint32_t place[3])
{
    for (int a = 0; a < 3; a++)
        place[a] = below(grid.size[a]);
}

/* Check that exactly the wanted voxels are listed, once and in order. */
static bool are_wanted(struct voxels *voxels)
{
    size_t at = 0;
    bool same = true;
    for (uint32_t cell = 0; cell < grid.cells; cell++)
        if (wanted[cell])
            same &= at < voxels->count && voxels->cell[at++] == cell;
    same &= at == voxels->count;
    voxels_release(voxels);
    return same;
}

/* ---- balls and strokes ---- */

static const uint32_t units[][3] = {{1, 1, 1}, {1000000, 1500000, 2200000}, {700, 700, 300}};

STORY(a_stroke_is_balls_at_the_voxels_nearest_to_each_step)
{
    for (int round = 0; round < 3000 && check_failures == 0; round++) {
        const uint32_t *unit = units[below(3)];
        const int64_t radius = (int64_t)below(5 * unit[0]);
        const size_t corners = 1 + below(4);
        uint32_t corner[4][3];
        struct voxels voxels = {0};
        OWNED(brush_release) struct brush brush;
        begin();
        for (size_t i = 0; i < corners; i++)
            random_place(corner[i]);
        model_stroke(wanted, &grid, (corners_of)corner, corners, unit, radius);
        CHECK(brush_init(&brush, unit, radius, BRUSH_REACH_MOST, NULL) == OK);
        CHECK(paint_stroke(&voxels, &grid, &brush, (corners_of)corner, corners, NULL, NULL) == OK);
        CHECK(are_wanted(&voxels));
    }
}

STORY(places_on_a_straight_way_are_left_out_and_the_voxels_stay)
{
    size_t places = 0, corners = 0;
    for (int round = 0; round < 3000 && check_failures == 0; round++) {
        const int64_t radius = below(3);
        uint32_t place[40][3];
        int step[3] = {0};
        const uint32_t count = 1 + below(40);
        OWNED(polyline_release) struct polyline line = {0};
        struct voxels voxels = {0};
        OWNED(brush_release) struct brush brush;
        begin();
        random_place(place[0]);
        for (uint32_t i = 1; i < count; i++) {
            memcpy(place[i], place[i - 1], sizeof place[0]);
            /* Simulate an arrow key that is held, with occasional changes of direction. */
            for (int a = 0; a < 3; a++)
                if (below(6) == 0)
                    step[a] = (int)below(3) - 1;
            for (int a = 0; a < 3; a++) {
                const int64_t to = (int64_t)place[i][a] + step[a] * (1 + (int)below(2));
                place[i][a] = to < 0 || to >= grid.size[a] ? place[i][a] : (uint32_t)to;
            }
        }
        for (uint32_t i = 0; i < count; i++)
            CHECK(polyline_add(&line, place[i]));
        model_stroke(wanted, &grid, (corners_of)place, count, units[0], radius);
        CHECK(brush_init(&brush, units[0], radius, BRUSH_REACH_MOST, NULL) == OK);
        CHECK(paint_stroke(&voxels, &grid, &brush, (corners_of)line.corner, line.count, NULL,
                           NULL) == OK);
        CHECK(are_wanted(&voxels));
        places += count;
        corners += line.count;
    }
    CHECK(corners < places * 2 / 3);
}

STORY(only_what_lies_straight_ahead_is_no_corner)
{
    static const uint32_t place[][3] = {{1, 1, 1}, {1, 1, 1}, {2, 2, 2}, {4, 4, 4},
                                        {3, 3, 3}, {9, 3, 3}, {9, 4, 3}, {9, 6, 3}};
    OWNED(polyline_release) struct polyline line = {0};
    for (size_t i = 0; i < sizeof place / sizeof place[0]; i++)
        CHECK(polyline_add(&line, place[i]));
    CHECK_INT(line.count, 5); /* back from 4,4,4 to 3,3,3 is a corner */
    CHECK(memcmp(line.corner[1], place[3], sizeof place[0]) == 0);
    CHECK(memcmp(line.corner[4], place[7], sizeof place[0]) == 0);
}

/* Return four times the squared distance of a place from the segment from a to b, rounded down. */
static int64_t far_from(const uint32_t place[3], const uint32_t a[3], const uint32_t b[3])
{
    int64_t way[3], from[3], along = 0, length = 0, square = 0;
    for (int i = 0; i < 3; i++) {
        way[i] = (int64_t)b[i] - a[i];
        from[i] = (int64_t)place[i] - a[i];
        along += way[i] * from[i];
        length += way[i] * way[i];
    }
    along = along < 0 ? 0 : along > length ? length : along;
    for (int i = 0; i < 3; i++) {
        const int64_t off = from[i] * (length ? length : 1) - way[i] * along;
        square += off * off;
    }
    return 4 * square / (length ? length * length : 1);
}

STORY(a_simplified_line_is_within_half_a_voxel_and_keeps_its_ends)
{
    size_t before = 0, after = 0;
    for (int round = 0; round < 3000 && check_failures == 0; round++) {
        OWNED(polyline_release) struct polyline line = {0}, whole = {0};
        uint32_t place[3];
        int way[2] = {1 + (int)below(5), 1 + (int)below(5)};
        random_place(place);
        for (uint32_t i = 0; i < below(200); i++) { /* a hand with occasional turns */
            const bool both = below((uint32_t)(way[0] + way[1])) < (uint32_t)way[0];
            place[0] += both;
            place[1]++;
            if (below(30) == 0)
                way[both] = 1 + (int)below(5);
            CHECK(polyline_add(&line, place) && polyline_add(&whole, place));
        }
        polyline_simplify(&line);
        CHECK((line.count == 0) == (whole.count == 0) && line.count <= whole.count);
        size_t at = 0; /* the remaining corners are in order and include the ends */
        for (size_t i = 0; i < whole.count; i++) {
            if (memcmp(whole.corner[i], line.corner[at], sizeof place) == 0)
                at += at + 1 < line.count;
            else
                CHECK(at > 0 &&
                      far_from(whole.corner[i], line.corner[at - 1], line.corner[at]) <= 1);
        }
        CHECK(line.count == 0 || at + 1 == line.count);
        before += whole.count;
        after += line.count;
    }
    CHECK(after < before * 2 / 3);
}

STORY(a_way_of_small_steps_is_one_and_a_way_back_is_another)
{
    OWNED(polyline_release) struct polyline line = {0};
    for (uint32_t i = 0; i < 40; i++)
        CHECK(polyline_add(&line, (uint32_t[]){i + 3, (i + 1) / 3, 7}));
    CHECK(line.count > 20 && polyline_add(&line, (uint32_t[]){3, 2, 7}));
    polyline_simplify(&line);
    CHECK(line.count == 3 && line.corner[1][0] == 42 && line.corner[2][0] == 3);
}

STORY(a_ball_in_the_world_is_no_ellipsoid)
{
    static const uint32_t spacing_nm[3] = {500000, 500000, 2000000};
    const uint32_t size[3] = {40, 40, 40}, middle[1][3] = {{20, 20, 20}};
    struct voxels voxels = {0};
    struct brush brush;
    CHECK(grid_init(&grid, size, NULL) == OK);
    CHECK(brush_init(&brush, spacing_nm, 4000000, BRUSH_REACH_MOST, NULL) == OK);
    CHECK(brush.reach[0] == 8 && brush.reach[1] == 8 && brush.reach[2] == 2);
    CHECK(paint_stroke(&voxels, &grid, &brush, middle, 1, NULL, NULL) == OK);
    CHECK_INT(voxels.count, 197 + 2 * 145 + 2 * 1); /* circles of 8, sqrt(48) and 0 voxels */
    voxels_release(&voxels);
    brush_release(&brush);
    struct fault fault = {0};
    CHECK_INT(brush_init(&brush, (uint32_t[]){10, 9, 10}, 1161, BRUSH_REACH_MOST, &fault),
              ERR_LIMIT);
    CHECK_HAS(fault.text, "129 voxels along y; at most 128");
}

/* ---- shells ---- */

/* Return true if a voxel of the ball has a neighbour outside, by examining each. */
static bool is_in_shell(const int64_t at[3], const int64_t middle[3], const uint32_t unit[3],
                        int64_t radius, const struct adjacency *adjacency)
{
    bool has_outside = false;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const int64_t next[3] = {at[0] + adjacency->step[i][0], at[1] + adjacency->step[i][1],
                                 at[2] + adjacency->step[i][2]};
        has_outside |= distance_2(next, middle, unit) > radius * radius;
    }
    return has_outside && distance_2(at, middle, unit) <= radius * radius;
}

STORY(a_shell_is_what_of_a_ball_has_a_neighbour_outside)
{
    for (int round = 0; round < 3000 && check_failures == 0; round++) {
        const uint32_t *unit = units[below(3)];
        const int64_t radius = (int64_t)below(12 * unit[0]);
        struct adjacency adjacency;
        struct voxels voxels = {0};
        OWNED(brush_release) struct brush brush;
        uint32_t middle[3];
        begin();
        random_place(middle);
        adjacency_init(&adjacency, below(2) ? 6 : 26, &grid);
        const int64_t centre[3] = {middle[0], middle[1], middle[2]};
        bool *covers = wanted;
        EACH_VOXEL(&grid,
                   is_in_shell((const int64_t[]){x, y, z}, centre, unit, radius, &adjacency));
        CHECK(brush_init(&brush, unit, radius, BRUSH_HOLLOW_REACH_MOST, NULL) == OK);
        CHECK(brush_hollow(&brush, adjacency.count, NULL) == OK);
        CHECK(paint_shell(&voxels, &grid, &brush, middle, NULL, NULL) == OK && are_wanted(&voxels));
    }
}

STORY(a_box_is_all_between_two_corners_and_its_faces_are_what_a_smaller_one_leaves_of_it)
{
    for (int round = 0; round < 3000 && check_failures == 0; round++) {
        struct voxels voxels = {0};
        uint32_t a[3], b[3];
        begin();
        random_place(a);
        random_place(b);
        model_box(wanted, &grid, a, b);
        CHECK(paint_box(&voxels, &grid, a, b, false, NULL, NULL) == OK && are_wanted(&voxels));
        memset(wanted, 0, sizeof wanted);
        bool *covers = wanted;
        EACH_VOXEL(&grid, is_between(a[0], x, b[0]) && is_between(a[1], y, b[1]) &&
                              is_between(a[2], z, b[2]) &&
                              (x == a[0] || x == b[0] || y == a[1] || y == b[1] || z == a[2] ||
                               z == b[2]));
        CHECK(paint_box(&voxels, &grid, a, b, true, NULL, NULL) == OK && are_wanted(&voxels));
    }
}

/* ---- polygons ---- */

/* One of seven has a ring as well, whose model is slow. */
STORY(a_polygon_is_what_its_outline_winds_around_or_meets_and_a_ring_is_what_is_around_it)
{
    size_t filled = 0, around = 0;
    for (int round = 0; round < 4200 && check_failures == 0; round++) {
        const int axis = (int)below(3), width = (int)below(5);
        const size_t corners = 1 + below(CORNERS_MOST);
        uint32_t corner[CORNERS_MOST][3];
        OWNED(voxels_release) struct voxels inside = {0}, again = {0}, ring = {0};
        begin();
        for (size_t i = 0; i < corners; i++) {
            random_place(corner[i]);
            corner[i][axis] = corner[0][axis];
        }
        model_polygon(wanted, &grid, (corners_of)corner, corners, axis);
        CHECK(paint_polygon(&inside, &grid, (corners_of)corner, corners, NULL, NULL) == OK);
        CHECK(paint_polygon(&again, &grid, (corners_of)corner, corners, NULL, NULL) == OK);
        filled += again.count;
        CHECK(are_wanted(&again));
        if (round % 7 == 0) {
            memset(wanted, 0, sizeof wanted);
            model_ring(wanted, &grid, (corners_of)corner, corners, width);
            CHECK(paint_ring(&ring, &grid, &inside, (corners_of)corner, corners, width, NULL,
                             NULL) == OK);
            around += ring.count;
            CHECK(are_wanted(&ring));
        }
    }
    CHECK(filled > 50000 && around > 10000);
}

STORY(corners_in_several_slices_are_refused)
{
    const uint32_t size[3] = {9, 9, 9};
    const uint32_t corner[3][3] = {{1, 1, 1}, {5, 5, 1}, {1, 5, 2}};
    struct voxels voxels = {0};
    struct fault fault = {0};
    CHECK(grid_init(&grid, size, NULL) == OK);
    CHECK_INT(paint_polygon(&voxels, &grid, corner, 3, NULL, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "the corners of a polygon must be in one slice");
    CHECK(voxels.count == 0 && !voxels.cell);
}

/* ---- what is not there, or takes too long ---- */

/* Paint everything, under a watch or a limit of memory. */
static unsigned paint_all(struct watch *watch, enum err expected)
{
    static const uint32_t corner[4][3] = {{1, 2, 3}, {90, 80, 3}, {40, 99, 3}, {3, 3, 3}};
    const struct voxels inside = {(uint32_t[]){grid_cell(&grid, 40, 60, 3)}, 1, 1};
    struct voxels voxels = {0};
    struct brush brush;
    unsigned failed = 0;
    enum err err = brush_init(&brush, units[0], 6, BRUSH_REACH_MOST, NULL);
    if (!err)
        err = paint_stroke(&voxels, &grid, &brush, corner, 4, watch, NULL);
    brush_release(&brush);
    for (int i = 0; i < 4; i++) {
        CHECK((err == OK || err == expected) && (err == OK) == (voxels.count > 0));
        failed += err != OK;
        voxels_release(&voxels);
        if (i == 0)
            err =
                paint_box(&voxels, &grid, corner[0], (uint32_t[]){90, 80, 99}, false, watch, NULL);
        else if (i == 1)
            err = paint_polygon(&voxels, &grid, corner, 4, watch, NULL);
        else if (i == 2)
            err = paint_ring(&voxels, &grid, &inside, corner, 4, 99, watch, NULL);
    }
    return failed;
}

STORY(without_memory_or_time_nothing_is_painted)
{
    const uint32_t size[3] = {100, 100, 100};
    unsigned failed = 0;
    int looks = 0;
    CHECK(grid_init(&grid, size, NULL) == OK);
    for (size_t most = 0; most < 20000000; most += most / 2 + 100) {
        allow_bytes(most);
        failed += paint_all(NULL, ERR_MEMORY);
    }
    mem_allows = NULL;
    CHECK(failed > 20);
    struct watch watch = {.context = &looks, .poll = stop_after_looks};
    watch_begin(&watch);
    CHECK(paint_all(&watch, ERR_CANCELLED) > 0);
}

/* A journal written by hand may have a pen of any length. */
STORY(a_million_corners_take_no_more_memory_than_the_scene)
{
    enum { MANY = 1000000 };
    const uint32_t size[3] = {64, 64, 64};
    uint32_t(*corner)[3] = malloc(MANY * sizeof *corner);
    OWNED(voxels_release) struct voxels voxels = {0};
    OWNED(brush_release) struct brush brush;
    CHECK(grid_init(&grid, size, NULL) == OK);
    CHECK(brush_init(&brush, units[0], 2, BRUSH_REACH_MOST, NULL) == OK);
    for (size_t i = 0; corner && i < MANY; i++)
        random_place(corner[i]);
    allow_bytes((64 * 64 * 64) * 5);
    CHECK(corner &&
          paint_stroke(&voxels, &grid, &brush, (corners_of)corner, MANY, NULL, NULL) == OK);
    mem_allows = NULL;
    CHECK_INT(voxels.count, 64 * 64 * 64);
    free(corner);
}
