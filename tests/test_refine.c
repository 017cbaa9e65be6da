/* Surfaces between voxel centres: silhouettes of known shapes, and that nothing vanishes. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "render/refine.h"
#include "tests/stage.h"

/* Whether the voxel at this place from the middle of the scene is part of a shape. */
typedef bool shape(const double at[3]);

static void stage_shape(struct stage *s, uint32_t side, shape *holds)
{
    CHECK(stage_init(s, (uint32_t[]){side, side, side}, 6, NULL) == OK);
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t x = 0; x < side; x++) {
                const double middle = (side - 1) / 2.0;
                const double at[3] = {x - middle, y - middle, z - middle};
                s->scene->cell[grid_cell(&s->scene->grid, x, y, z)].label = holds(at);
            }
    border_recount(&s->border);
}

static void draw(struct stage *s, uint32_t zoom, const int32_t angle[2])
{
    const uint32_t side = s->scene->grid.size[0] * 7 / 4 * zoom / VIEW_ZOOM_ONE;
    rendition_release(&s->rendition);
    s->view = (struct view){.angle = {angle[0], angle[1]}, .zoom = zoom};
    s->view.width = s->view.height = side;
    stage_draw(s);
}

static size_t seen(const struct rendition *r)
{
    size_t count = 0;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        count += r->cell[i] != CELL_NONE;
    return count;
}

static const int32_t side[][2] = {{0, 0},          {45000, 0},      {45000, 35264}, {100000, 46000},
                                  {153000, 69000}, {204000, 92000}, {33000, 12000}, {90000, 90000}};
enum { SIDES = sizeof side / sizeof side[0] };

/* ---- shapes ---- */

static double radius_of(const double at[3])
{
    return sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
}

static bool is_ball(const double at[3])
{
    return radius_of(at) <= 40;
}
static bool is_shell_1(const double at[3])
{
    return radius_of(at) <= 16 && radius_of(at) > 15;
}
static bool is_shell_2(const double at[3])
{
    return radius_of(at) <= 16 && radius_of(at) > 14;
}
static bool is_shell_3(const double at[3])
{
    return radius_of(at) <= 16 && radius_of(at) > 13;
}
static bool is_voxel(const double at[3])
{
    return radius_of(at) == 0;
}
static bool is_pair(const double at[3])
{
    return at[0] == at[1] && at[1] == at[2] && (at[0] == 0 || at[0] == 1);
}
static bool is_cube_of_3(const double at[3])
{
    return fabs(at[0]) <= 1 && fabs(at[1]) <= 1 && fabs(at[2]) <= 1;
}
static bool is_line(const double at[3])
{
    return at[1] == 0 && at[2] == 0 && fabs(at[0]) <= 15;
}
static bool is_oblique_line(const double at[3])
{
    return at[1] == at[0] && at[2] == floor(at[0] / 3) && fabs(at[0]) <= 15;
}
static bool is_sheet(const double at[3])
{
    return at[2] == 0;
}
static bool is_sheet_at_45_degrees(const double at[3])
{
    return at[0] + at[1] == 0;
}
static bool is_oblique_sheet(const double at[3])
{
    return at[0] + at[1] + at[2] == 0;
}
static bool is_gentle_sheet(const double at[3])
{
    return at[2] == floor(at[0] / 4);
}
static bool is_sheet_on_a_wall(const double at[3])
{
    return at[0] < -8 || at[1] == 0;
}
static bool is_line_on_a_wall(const double at[3])
{
    return at[0] < -8 || (at[1] == 0 && at[2] == 0);
}
static bool is_voxel_before_a_wall(const double at[3])
{
    return at[0] < -2 || radius_of(at) == 0;
}
static bool are_crossed_sheets(const double at[3])
{
    return at[0] == 0 || at[1] == 0 || at[2] == 2;
}
static bool are_sheets_side_by_side(const double at[3])
{
    return fmod(at[1] + 100, 2) == 0;
}
static bool is_rod_of_3(const double at[3])
{
    return fabs(at[1]) <= 1 && fabs(at[2]) <= 1;
}
/* Pits of 2x2 to 4x5 voxels in a block. */
static bool is_pitted(const double at[3])
{
    const int x = (int)(at[0] + 100) % 12, y = (int)(at[1] + 100) % 12;
    const int wide = 1 + (int)(at[0] + 100) / 12 % 3, long_ = 1 + (int)(at[1] + 100) / 12 % 4;
    const bool is_block = fabs(at[0]) < 15 && fabs(at[1]) < 15 && at[2] < 0 && at[2] > -12;
    return is_block && (x > wide || y > long_ || at[2] < -4);
}

static const struct thing {
    const char *name;
    shape *holds;
    uint32_t rim; /* voxels from its cubes' silhouette to where there is no hole */
} thing[] = {
    {"shell of 1", is_shell_1, 2},
    {"shell of 2", is_shell_2, 2},
    {"shell of 3", is_shell_3, 2},
    {"voxel", is_voxel, 2},
    {"pair", is_pair, 2},
    {"cube of 3", is_cube_of_3, 2},
    {"line", is_line, 2},
    {"oblique line", is_oblique_line, 2},
    {"sheet", is_sheet, 2},
    {"sheet at 45 degrees", is_sheet_at_45_degrees, 2},
    {"oblique sheet", is_oblique_sheet, 2},
    {"gentle sheet", is_gentle_sheet, 2},
    {"sheet on a wall", is_sheet_on_a_wall, 2},
    {"line on a wall", is_line_on_a_wall, 2},
    {"voxel before a wall", is_voxel_before_a_wall, 2},
    {"crossed sheets", are_crossed_sheets, 2},
    {"sheets side by side", are_sheets_side_by_side, 3},
    {"rod of 3", is_rod_of_3, 2},
};
enum { THINGS = sizeof thing / sizeof thing[0] };

/* ---- what is seen of them ---- */

STORY(the_silhouette_of_a_ball_is_as_large_as_the_ball)
{
    struct stage s;
    stage_shape(&s, 85, is_ball);
    for (int i = 0; i < SIDES; i++)
        for (uint32_t zoom = 1000; zoom <= 4000; zoom *= 2) {
            draw(&s, zoom, side[i]);
            const double radius =
                sqrt((double)seen(&s.rendition) / 3.14159265358979) * VIEW_ZOOM_ONE / zoom;
            if (!CHECK(fabs(radius - 40) < 0.1))
                printf("# view %d zoom %u: radius %.3f\n", i, zoom, radius);
        }
    s.look.mode = SHADE_CUBES;
    draw(&s, 4000, side[3]);
    CHECK(sqrt((double)seen(&s.rendition) / 3.14159265358979) / 4 > 40.3);
    stage_release(&s);
}

/* Of a round silhouette at zoom 8, the distances from the middle are nearly the same; of cubes they
 * differ by up to a voxel. */
STORY(a_silhouette_is_curved)
{
    struct stage s;
    stage_shape(&s, 85, is_ball);
    for (int i = 0; i < SIDES; i++) {
        double least = 100, most = 0;
        draw(&s, 8000, side[i]);
        const struct rendition *r = &s.rendition;
        for (uint32_t y = 1; y + 1 < r->height; y++)
            for (uint32_t x = 1; x + 1 < r->width; x++) {
                const size_t p = (size_t)y * r->width + x;
                const bool is_edge =
                    r->cell[p] != CELL_NONE &&
                    (r->cell[p - 1] == CELL_NONE || r->cell[p + 1] == CELL_NONE ||
                     r->cell[p - r->width] == CELL_NONE || r->cell[p + r->width] == CELL_NONE);
                const double d = hypot(x - (r->width - 1) / 2.0, y - (r->height - 1) / 2.0) / 8;
                if (is_edge && d < least)
                    least = d;
                if (is_edge && d > most)
                    most = d;
            }
        if (!CHECK(most - least < 0.6))
            printf("# view %d: radii from %.2f to %.2f\n", i, least, most);
    }
    stage_release(&s);
}

/* Where a ball is cut open, 12.5 voxels above its middle, the scene is shown in a circle. */
STORY(a_face_that_is_cut_open_ends_where_the_surface_does)
{
    struct stage s;
    size_t open = 0;
    stage_shape(&s, 85, is_ball);
    s.border.cut.last[2] = 54;
    border_recount(&s.border);
    draw(&s, 4000, (const int32_t[]){0, 90000});
    const struct rendition *r = &s.rendition;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        open += r->cell[i] != CELL_NONE && (r->depth[i] & 3) != REFINE_WITHIN;
    const double radius = sqrt((double)open / 3.14159265358979) / 4;
    if (!CHECK(fabs(radius - sqrt(1600 - 12.5 * 12.5)) < 0.15))
        printf("# radius %.3f\n", radius);
    stage_release(&s);
}

/* Whether all pixels up to `reach` around one show a cube. */
static bool is_within(const struct rendition *r, uint32_t x, uint32_t y, uint32_t reach)
{
    if (x < reach || y < reach || x + reach >= r->width || y + reach >= r->height)
        return false;
    for (uint32_t j = y - reach; j <= y + reach; j++)
        for (uint32_t i = x - reach; i <= x + reach; i++)
            if (r->cube.cell[(size_t)j * r->width + i] == CELL_NONE)
                return false;
    return true;
}

/* Pixels so far within the silhouette of shown cubes that show nothing. */
static size_t holes_of(struct stage *s, const struct rendition *cubes, uint32_t reach)
{
    size_t holes = 0;
    for (uint32_t y = 0; y < cubes->height; y++)
        for (uint32_t x = 0; x < cubes->width; x++)
            holes += s->rendition.cell[(size_t)y * cubes->width + x] == CELL_NONE &&
                     is_within(cubes, x, y, reach);
    return holes;
}

/* Smoothed, corners are round, and lines too: nearer to a silhouette than the rim there may be
 * anything, but no shape becomes much smaller or larger than its cubes. */
STORY(what_is_thin_has_no_holes_and_does_not_vanish)
{
    for (int t = 0; t < THINGS; t++) {
        struct stage s;
        struct border border;
        stage_shape(&s, 35, thing[t].holds);
        CHECK(border_init(&border, s.scene, NULL) == OK);
        border_recount(&border);
        for (int i = 0; i < SIDES; i++)
            for (uint32_t zoom = 1000; zoom <= 8000; zoom *= zoom < 2000 ? 2 : 4) {
                struct rendition cubes;
                draw(&s, zoom, side[i]);
                CHECK(rendition_init(&cubes, s.view.width, s.view.height, NULL) == OK);
                splat_border(&cubes, &s.camera, &border);
                const uint32_t rim = thing[t].rim * zoom / VIEW_ZOOM_ONE;
                const size_t holes = holes_of(&s, &cubes, rim);
                const double share = (double)seen(&s.rendition) / (double)seen(&cubes);
                if (!CHECK(holes == 0 && share > (zoom == 1000 ? 0.2 : 0.4) &&
                           share < (zoom == 1000 ? 3 : 1.7)))
                    printf("# %s, view %d, zoom %u: %zu holes, %.2f of its cubes\n", thing[t].name,
                           i, zoom, holes, share);
                rendition_release(&cubes);
            }
        border_release(&border);
        stage_release(&s);
    }
}

/* Pixels that show the face by which their ray comes to its first solid voxel. */
static size_t seen_at_faces(const struct rendition *r)
{
    size_t count = 0;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        count += r->cell[i] != CELL_NONE && r->depth[i] == (r->cube.depth[i] | REFINE_WITHIN);
    return count;
}

/* In a pit the field comes inside further out than a face neighbour of what is shown. */
STORY(the_ground_of_a_pit_is_no_face_of_a_voxel)
{
    struct stage s;
    size_t former = 0;
    stage_shape(&s, 35, is_pitted);
    for (int i = 0; i < SIDES; i++) {
        s.look.number = LOOK_SECOND;
        draw(&s, 8000, side[i]);
        former += seen_at_faces(&s.rendition);
        s.look.number = LOOK_PRESENT;
        draw(&s, 8000, side[i]);
        const size_t faces = seen_at_faces(&s.rendition);
        if (!CHECK(faces * 10000 < seen(&s.rendition)))
            printf("# view %d: %zu of %zu pixels\n", i, faces, seen(&s.rendition));
    }
    CHECK(former > 100); /* look 2 shows them */
    stage_release(&s);
}

/* The first row of a column that shows something. */
static uint32_t top_of(const struct rendition *r, uint32_t x)
{
    uint32_t y = 0;
    while (y < r->height && r->cell[(size_t)y * r->width + x] == CELL_NONE)
        y++;
    return y;
}

/* Columns whose top lies a pixel off the middle of those beside it. */
static unsigned count_teeth(const struct rendition *r)
{
    unsigned teeth = 0;
    for (uint32_t x = r->width / 4; x < r->width * 3 / 4; x++) {
        const int64_t off = 2 * (int64_t)top_of(r, x) - top_of(r, x - 1) - top_of(r, x + 1);
        teeth += off > 1 || off < -1;
    }
    return teeth;
}

/* A ball without its upper half, from below: rays come out of it where it is cut. */
STORY(the_rim_of_a_cut_is_a_line)
{
    struct stage s;
    unsigned former = 0;
    stage_shape(&s, 85, is_ball);
    s.border.cut.last[2] = 42;
    border_recount(&s.border);
    for (int32_t pitch = -70000; pitch <= 70000; pitch += 20000) {
        s.look.number = LOOK_SECOND;
        draw(&s, 8000, (const int32_t[]){20000, pitch});
        former += count_teeth(&s.rendition);
        s.look.number = LOOK_PRESENT;
        draw(&s, 8000, (const int32_t[]){20000, pitch});
        if (!CHECK(count_teeth(&s.rendition) <= 1))
            printf("# pitch %d: %u teeth\n", pitch, count_teeth(&s.rendition));
    }
    CHECK(former > 100); /* look 2 has them */
    stage_release(&s);
}

int main(void)
{
    return RUN_STORIES(
        TELL(the_silhouette_of_a_ball_is_as_large_as_the_ball), TELL(a_silhouette_is_curved),
        TELL(a_face_that_is_cut_open_ends_where_the_surface_does),
        TELL(what_is_thin_has_no_holes_and_does_not_vanish),
        TELL(the_ground_of_a_pit_is_no_face_of_a_voxel), TELL(the_rim_of_a_cut_is_a_line));
}
