/* SPDX-License-Identifier: MIT */
/* The focus of a view: it is in the centre of the picture, and nothing else changes. */
#include "tests/check_main.h"
#include "stage.h"

/* Axes, spacings and labels of any kind. */
static void random_stage(struct stage *s, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 1 + check_below(random, check_below(random, 3) ? 30 : 4);
    CHECK(stage_init(s, size, 6, NULL) == OK);
    stage_turn_at_random(s, random);
    for (size_t i = 0; i < s->scene->grid.cells; i++)
        if (!(s->scene->cell[i].flags & CELL_RIM))
            s->scene->cell[i].label = (uint8_t)(check_below(random, 4) == 0);
    border_recount(&s->border);
    s->view.zoom = 200 + check_below(random, 5000);
    s->view.width = 1 + check_below(random, 80);
    s->view.height = 1 + check_below(random, 80);
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = (int32_t)(check_below(random, 2) ? check_below(random, 8) * 45000
                                                            : check_below(random, 360000));
}

static void draw(struct rendition *r, struct stage *s)
{
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
    CHECK(rendition_init(r, s->view.width, s->view.height, NULL) == OK);
    CHECK(mesh_update(&s->mesh, &s->border, MESH_SMOOTH, NULL, NULL, NULL) == OK);
    project_border(r, &s->camera, &s->mesh);
}

STORY(the_voxel_in_focus_is_in_the_middle_of_the_picture)
{
    uint64_t random = 1;
    for (int round = 0; round < 300 && check_failures == 0; round++) {
        OWNED(stage_release) struct stage s;
        OWNED(rendition_release) struct rendition r;
        uint32_t place[3];
        random_stage(&s, &random);
        s.view.width |= 1, s.view.height |= 1; /* an odd number of pixels has one in the middle */
        random_place(&s.scene->grid, &random, place);
        memset(s.border.visible, 0, sizeof s.border.visible);
        s.border.visible[9] = true;
        const uint32_t cell = grid_cell(&s.scene->grid, place[0], place[1], place[2]);
        s.scene->cell[cell].label = 9;
        border_recount(&s.border);
        view_focus_on(&s.view, s.scene, place);
        draw(&r, &s);
        CHECK_INT(r.cell[(size_t)(r.height / 2) * r.width + r.width / 2], cell);
    }
}

/* Return the position of a voxel's centre, in thousandths of a pixel. */
static void project(const struct stage *s, const uint32_t place[3], int64_t at[2])
{
    for (int k = 0; k < 2; k++) {
        int64_t sum = s->camera.centre[k];
        for (int a = 0; a < 3; a++)
            sum += s->camera.column[k][a] *
                   (s->camera.flip[a] ? s->scene->grid.size[a] - 1 - place[a] : place[a]);
        at[k] = (sum >> 10) * 1000 >> 20;
    }
}

STORY(a_pan_moves_what_is_seen_by_so_many_pixels_and_back)
{
    uint64_t random = 3;
    for (int round = 0; round < 500 && check_failures == 0; round++) {
        OWNED(stage_release) struct stage s;
        uint32_t place[3];
        int64_t before[2], after[2];
        random_stage(&s, &random);
        random_place(&s.scene->grid, &random, place);
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
        const int64_t right = check_below(&random, 4001) - (int64_t)2000,
                      down = check_below(&random, 4001) - (int64_t)2000;
        project(&s, place, before);
        view_pan(&s.view, &s.camera, right, down);
        if (camera_init(&s.camera, s.scene, &s.view, NULL) == OK) {
            project(&s, place, after);
            CHECK(llabs(after[0] - before[0] - right) <= 20);
            CHECK(llabs(after[1] - before[1] - down) <= 20);
            view_pan(&s.view, &s.camera, -right, -down);
            for (int a = 0; a < 3; a++)
                CHECK(llabs(s.view.focus[a]) <= 2);
        }
    }
}

/* Yaw to the left side, pitch upwards, roll counter-clockwise: the positions of three voxels. */
STORY(angles_turn_the_way_they_say)
{
    static const uint32_t end[3][3] = {{0, 10, 10}, {10, 20, 10}, {10, 10, 20}}; /* L, A, S */
    static const struct {
        int32_t angle[3];
        int at[3][2]; /* pixels to the right and down from the middle */
    } row[] = {
        {{0, 0, 0}, {{10, 0}, {0, 0}, {0, -10}}},
        {{90000, 0, 0}, {{0, 0}, {-10, 0}, {0, -10}}},
        {{0, 90000, 0}, {{10, 0}, {0, 10}, {0, 0}}},
        {{0, 0, 90000}, {{0, -10}, {0, 0}, {-10, 0}}},
    };
    OWNED(stage_release) struct stage s;
    struct rendition r;
    CHECK(stage_init(&s, (uint32_t[]){21, 21, 21}, 6, NULL) == OK);
    for (int i = 0; i < 3; i++)
        s.scene->cell[grid_cell(&s.scene->grid, end[i][0], end[i][1], end[i][2])].label = 1;
    border_recount(&s.border);
    s.view.width = s.view.height = 41;
    s.view.zoom = VIEW_ZOOM_ONE;
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        memcpy(s.view.angle, row[i].angle, sizeof s.view.angle);
        draw(&r, &s);
        for (int k = 0; k < 3; k++)
            CHECK_INT(r.cell[(size_t)(20 + row[i].at[k][1]) * 41 + (size_t)(20 + row[i].at[k][0])],
                      grid_cell(&s.scene->grid, end[k][0], end[k][1], end[k][2]));
        rendition_release(&r);
    }
}

STORY(the_focus_changes_no_depth)
{
    OWNED(stage_release) struct stage s;
    OWNED(rendition_release) struct rendition centred, panned;
    CHECK(stage_init(&s, (uint32_t[]){40, 30, 20}, 6, NULL) == OK);
    for (uint32_t x = 12; x < 28; x++)
        s.scene->cell[grid_cell(&s.scene->grid, x, 7 + x / 3, 10)].label = 1;
    border_recount(&s.border);
    s.view.width = s.view.height = 99;
    s.view.zoom = 2000;
    draw(&centred, &s);
    view_pan(&s.view, &s.camera, 10000, -4000);
    draw(&panned, &s);
    unsigned seen = 0;
    for (uint32_t y = 4; y < 99; y++)
        for (uint32_t x = 0; x < 89; x++) {
            const size_t from = y * 99 + x, to = (y - 4) * 99 + x + 10;
            CHECK_INT(panned.cell[to], centred.cell[from]);
            /* A 64th of a pixel of 2^24: cosines of 0 are a 4096th (render/view.h). */
            CHECK(panned.cell[to] == CELL_NONE ||
                  llabs(panned.depth[to] - centred.depth[from]) < 4 << 18);
            seen += centred.cell[from] != CELL_NONE;
        }
    CHECK(seen > 50);
}

STORY(a_focus_beyond_all_proportion_is_refused)
{
    OWNED(stage_release) struct stage s;
    struct fault fault;
    CHECK(stage_init(&s, (uint32_t[]){100, 50, 1}, 6, NULL) == OK);
    for (int a = 0; a < 3; a++) {
        s.view.focus[a] = INT64_C(100) << VIEW_FOCUS_BITS;
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
        s.view.focus[a] = -(INT64_C(160) << VIEW_FOCUS_BITS);
        CHECK_INT(camera_init(&s.camera, s.scene, &s.view, &fault), ERR_LIMIT);
        CHECK_HAS(fault.text, "too far from the scene; the view is unchanged");
        s.view.focus[a] = INT64_MAX;
        CHECK_INT(camera_init(&s.camera, s.scene, &s.view, NULL), ERR_LIMIT);
        s.view.focus[a] = 0;
    }
}

/* A ball of millimetres has the same width and height from every direction, whatever the spacing.
 * */
STORY(a_ball_is_round_from_everywhere)
{
    static const uint32_t spacing[5][3] = {{2000000, 1000000, 3000000},
                                           {1000000, 1000000, 1000000},
                                           {500000, 3000000, 700000},
                                           {937500, 937500, 1500000},
                                           {3000000, 1000000, 1000000}};
    uint64_t random = 4;
    for (int round = 0; round < 60; round++) {
        OWNED(stage_release) struct stage s;
        OWNED(rendition_release) struct rendition r;
        uint32_t size[3], first[2] = {300, 300}, last[2] = {0, 0};
        const uint32_t *nm = spacing[round % 5];
        uint32_t least = nm[0], most = nm[0];
        for (int a = 0; a < 3; a++) {
            size[a] = 64000000 / nm[a] | 1;
            least = nm[a] < least ? nm[a] : least;
            most = nm[a] > most ? nm[a] : most;
        }
        CHECK(stage_init(&s, size, 6, NULL) == OK);
        memcpy(s.scene->spacing_nm, nm, sizeof size);
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++)
                for (uint32_t x = 0; x < size[0]; x++) {
                    const uint32_t at[3] = {x, y, z};
                    int64_t squares = 0;
                    for (int a = 0; a < 3; a++) {
                        const int64_t mm1000 =
                            ((int64_t)at[a] - size[a] / 2) * (int64_t)(nm[a] / 1000);
                        squares += mm1000 * mm1000;
                    }
                    if (squares <= INT64_C(28000) * 28000)
                        s.scene->cell[grid_cell(&s.scene->grid, x, y, z)].label = 1;
                }
        border_recount(&s.border);
        for (int i = 0; i < 3 && round >= 5; i++)
            s.view.angle[i] = (int32_t)check_below(&random, 360000);
        s.view.width = s.view.height = 300;
        s.view.zoom = (uint32_t)(4 * (uint64_t)least / 1000); /* 4 pixels a millimetre */
        draw(&r, &s);
        for (uint32_t y = 0; y < 300; y++)
            for (uint32_t x = 0; x < 300; x++)
                if (r.cell[y * 300 + x] != CELL_NONE) {
                    const uint32_t at[2] = {x, y};
                    for (int k = 0; k < 2; k++) {
                        first[k] = at[k] < first[k] ? at[k] : first[k];
                        last[k] = at[k] > last[k] ? at[k] : last[k];
                    }
                }
        /* 56 mm; its cubes extend by half of their diagonal at most. */
        const uint32_t margin = 4 * most / 1000000 * 7 / 4 + 1;
        for (int k = 0; k < 2; k++) {
            const uint32_t wide = last[k] - first[k] + 1;
            CHECK(wide + margin >= 224 && wide <= 224 + margin);
        }
    }
}
