/* Meetings of objects: by their definition, and that lines between objects are no stairs. */
#include "check.h"

#include <math.h>

#include "render/refine.h"
#include "tests/stage.h"

enum { ONE = 1 << REFINE_POINT_BITS };

/* The same by sums for all labels, in 2^-7 voxels. */
static uint32_t expected_voxel(const struct stage *s, const int32_t point[3], uint32_t own)
{
    const struct grid *grid = &s->scene->grid;
    uint32_t sum[256] = {0}, nearest = 0, found = own;
    const uint8_t its = labels_at(&s->border.labels, own);
    uint8_t label = its;
    bool is_asked = false;
    int one = -1;
    for (int turn = 0; turn < 2; turn++) {
        for (uint32_t z = 0; z < grid->size[2]; z++)
            for (uint32_t y = 0; y < grid->size[1]; y++)
                for (uint32_t x = 0; x < grid->size[0]; x++) {
                    const uint32_t at[3] = {x, y, z}, cell = grid_cell(grid, x, y, z);
                    uint32_t weight = 1, narrow = 3 * 64;
                    bool is_beside = true;
                    for (int a = 0; a < 3; a++) {
                        const int32_t apart = (point[a] >> 5) - (int32_t)at[a] * 128;
                        const int32_t left = 256 - (apart < 0 ? -apart : apart);
                        weight *= left > 0 ? (uint32_t)left : 0;
                        narrow *= left > 128 ? (uint32_t)left - 128 : 0;
                        is_beside = is_beside && left > 128 - (apart < 0);
                    }
                    const uint8_t its_label = labels_at(&s->border.labels, cell);
                    if (weight == 0 || !border_shows(&s->border, cell))
                        continue;
                    is_asked = is_asked || (is_beside && one >= 0 && its_label != one);
                    one = is_beside ? its_label : one;
                    if (turn == 0)
                        sum[its_label] += weight + narrow;
                    else if (its_label == label && weight + narrow > nearest)
                        nearest = weight + narrow, found = cell;
                }
        for (int i = 255; i >= 0 && turn == 0; i--)
            if (sum[i] && sum[i] >= sum[label])
                label = (uint8_t)i;
        if (label == its || !is_asked)
            return own;
    }
    return found;
}

STORY(the_object_that_most_is_said_for_has_the_point)
{
    uint64_t random = 5;
    struct stage s;
    size_t others = 0;
    CHECK(stage_init(&s, (uint32_t[]){6, 5, 4}, 6, NULL) == OK);
    for (int i = 0; i < 3000; i++) {
        const struct grid *grid = &s.scene->grid;
        const uint32_t labels = 2 + check_below(&random, 4);
        for (uint32_t c = 0; c < 120; c++)
            s.scene->cell[grid_cell(grid, c % 6, c / 6 % 5, c / 30)].label =
                (uint8_t)check_below(&random, labels);
        border_recount(&s.border);
        int32_t point[3];
        uint32_t place[3];
        for (int a = 0; a < 3; a++) {
            point[a] = (int32_t)check_below(&random, grid->size[a] * ONE) - ONE / 2;
            place[a] = (uint32_t)((point[a] + ONE / 2) >> REFINE_POINT_BITS);
        }
        const uint32_t own = grid_cell(grid, place[0], place[1], place[2]);
        if (!border_shows(&s.border, own))
            continue;
        const uint32_t voxel = meeting_voxel(&s.border, point, own);
        CHECK_INT(voxel, expected_voxel(&s, point, own));
        others += voxel != own;
    }
    CHECK(others > 100);
    stage_release(&s);
}

/* ---- lines ---- */

enum { SIDE = 48 };

static void stage_plate(struct stage *s, double slope)
{
    CHECK(stage_init(s, (uint32_t[]){SIDE, SIDE, 8}, 6, NULL) == OK);
    for (uint32_t z = 0; z < 5; z++)
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++) {
                const double right = x + 0.5 - SIDE / 2.0, down = y + 0.5 - SIDE / 2.0;
                s->scene->cell[grid_cell(&s->scene->grid, x, y, z)].label =
                    down < slope * right ? 1 : 2;
            }
    border_recount(&s->border);
}

/* The share of pixels within a voxel of the line that show the object of its other side, where the
 * picture's x and y run as the scene's, or the other way round. */
static double wrong_near_line(const struct rendition *r, double slope, int way_x, int way_y)
{
    size_t wrong = 0, near = 0;
    for (uint32_t y = 0; y < r->height; y++)
        for (uint32_t x = 0; x < r->width; x++) {
            const size_t pixel = (size_t)y * r->width + x;
            const double right = way_x * (x + 0.5 - r->width / 2.0) / 8;
            const double down = way_y * (y + 0.5 - r->height / 2.0) / 8;
            const double below = (down - slope * right) / sqrt(1 + slope * slope);
            if (r->cell[pixel] == CELL_NONE || fabs(below) > 1)
                continue;
            near++;
            wrong += (r->label[pixel] == 1) != (below < 0);
        }
    return near ? (double)wrong / (double)near : 1;
}

static double wrong_in_look(struct stage *s, double slope, uint32_t look)
{
    double least = 1;
    s->view = (struct view){.angle = {0, 90000}, .zoom = 8000, .width = 256, .height = 256};
    s->look.number = look;
    rendition_release(&s->rendition);
    stage_draw(s);
    for (int way = 0; way < 4; way++)
        least =
            fmin(least, wrong_near_line(&s->rendition, slope, way % 2 * 2 - 1, way / 2 * 2 - 1));
    return least;
}

STORY(a_line_between_objects_is_no_stairs)
{
    static const double slope[] = {0.2, 0.35, 0.5, 0.65, 0.8};
    double all = 0;
    for (int i = 0; i < 5; i++) {
        struct stage s;
        stage_plate(&s, slope[i]);
        const double stairs = wrong_in_look(&s, slope[i], LOOK_SECOND);
        const double line = wrong_in_look(&s, slope[i], LOOK_PRESENT);
        if (!CHECK(stairs > 0.1 && line < stairs * 0.85))
            printf("# slope %.1f: %.3f of the pixels as stairs, %.3f as a line\n", slope[i], stairs,
                   line);
        all += line / stairs / 5;
        stage_release(&s);
    }
    CHECK(all < 0.78);
}

/* On a plate of another object. */
STORY(what_is_as_small_as_a_voxel_stays)
{
    struct stage s;
    stage_plate(&s, 0);
    const struct grid *grid = &s.scene->grid;
    s.scene->cell[grid_cell(grid, 20, 16, 4)].label = 3;
    for (uint32_t x = 12; x < 36; x++)
        s.scene->cell[grid_cell(grid, x, 30, 4)].label = 4;
    border_recount(&s.border);
    s.view = (struct view){.angle = {0, 90000}, .zoom = 8000, .width = 400, .height = 400};
    stage_draw(&s);
    size_t seen[5] = {0};
    for (size_t i = 0; i < 400 * 400; i++)
        seen[s.rendition.label[i] % 5]++;
    if (!CHECK(seen[3] >= 20 && seen[3] <= 64 && seen[4] > 24 * 40 && seen[4] < 24 * 80))
        printf("# %zu pixels of a voxel, %zu of 24 in a row\n", seen[3], seen[4]);
    stage_release(&s);
}

int main(void)
{
    return RUN_STORIES(TELL(the_object_that_most_is_said_for_has_the_point),
                       TELL(a_line_between_objects_is_no_stairs),
                       TELL(what_is_as_small_as_a_voxel_stays));
}
