/*
 * What is counted of labels: against a plain recount that walks over voxels and sorts, and surfaces
 * against balls and boxes whose area is known.
 */
#include <math.h>
#include <stdlib.h>

#include "engine/label_stats.h"
#include "engine/label_surface.h"
#include "tests/check.h"

enum { SIDE = 10, VOXELS = SIDE * SIDE * SIDE };

static uint64_t state;
static uint32_t below(uint32_t end)
{
    return (uint32_t)(check_random(&state) % end);
}

/* ---- a plain recount ---- */

static struct scene *random_scene(void)
{
    struct scene *scene;
    const uint32_t size[3] = {1 + below(SIDE), 1 + below(SIDE), 1 + below(SIDE)};
    const uint32_t labels = 1 + below(4), noise = below(3) ? below(40) : 0;
    const uint32_t range = below(2) ? 65536 : 1 + below(600);
    if (scene_new(&scene, size, NULL) != OK)
        abort();
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++) {
                struct cell *cell = &scene->cell[grid_cell(&scene->grid, x, y, z)];
                const uint32_t label = below(100) < noise ? below(labels) : (x / 3 + y / 4) % 3;
                cell->label = (uint8_t)(label * 80);
                cell->intensity = (uint16_t)below(range);
            }
    return scene;
}

static uint8_t at(const struct scene *scene, const uint32_t p[3])
{
    return scene->cell[grid_cell(&scene->grid, p[0], p[1], p[2])].label;
}

/* Marks what hangs together with a voxel by faces and is (or is not) of the label; whether it gets
 * to the edge. */
static bool flood(const struct scene *scene, bool *seen, const uint32_t p[3], uint8_t label,
                  bool is)
{
    const uint32_t *size = scene->grid.size;
    bool at_edge = false;
    seen[(p[2] * SIDE + p[1]) * SIDE + p[0]] = true;
    for (int f = 0; f < 6; f++) {
        uint32_t q[3] = {p[0], p[1], p[2]};
        if (f % 2 ? q[f / 2] == 0 : q[f / 2] + 1 == size[f / 2]) {
            at_edge = true;
            continue;
        }
        q[f / 2] += f % 2 ? UINT32_MAX : 1;
        if ((at(scene, q) == label) == is && !seen[(q[2] * SIDE + q[1]) * SIDE + q[0]])
            at_edge |= flood(scene, seen, q, label, is);
    }
    return at_edge;
}

static int by_value(const void *a, const void *b)
{
    return *(const uint16_t *)a - *(const uint16_t *)b;
}

static struct label_stats recount(const struct scene *scene, uint8_t label)
{
    struct label_stats stats = {.first = {99, 99, 99}, .least = UINT16_MAX};
    const uint32_t *size = scene->grid.size;
    bool own[VOXELS] = {false}, other[VOXELS] = {false};
    uint16_t value[VOXELS];
    uint32_t p[3];
    for (p[2] = 0; p[2] < size[2]; p[2]++)
        for (p[1] = 0; p[1] < size[1]; p[1]++)
            for (p[0] = 0; p[0] < size[0]; p[0]++) {
                const uint32_t i = (p[2] * SIDE + p[1]) * SIDE + p[0];
                const uint16_t v = scene->cell[grid_cell(&scene->grid, p[0], p[1], p[2])].intensity;
                if (at(scene, p) != label) {
                    if (!other[i] && !flood(scene, other, p, label, false) && label)
                        stats.holes++;
                    continue;
                }
                if (!own[i]) {
                    flood(scene, own, p, label, true);
                    stats.components++;
                }
                value[stats.voxels++] = v;
                stats.intensity += v;
                stats.intensity_squares += (uint64_t)v * v;
                for (int a = 0; a < 3; a++) {
                    stats.sum[a] += p[a];
                    stats.first[a] = p[a] < stats.first[a] ? p[a] : stats.first[a];
                    stats.last[a] = p[a] > stats.last[a] ? p[a] : stats.last[a];
                }
            }
    if (!stats.voxels)
        return stats;
    qsort(value, stats.voxels, sizeof *value, by_value);
    stats.least = value[0];
    stats.most = value[stats.voxels - 1];
    stats.middle[0] = value[(stats.voxels - 1) / 2];
    stats.middle[1] = value[stats.voxels / 2];
    return stats;
}

static struct team *team_of[4];

STORY(all_that_is_counted_is_what_a_plain_recount_gives)
{
    for (int round = 0; round < 800; round++) {
        state = (uint64_t)round;
        struct scene *scene = random_scene();
        const struct labels labels = labels_of_forest(scene);
        struct label_stats stats[256], again[256];
        CHECK(label_stats_find(stats, &labels, team_of[round % 4], NULL) == OK);
        CHECK(label_stats_find(again, &labels, team_of[(round + 1) % 4], NULL) == OK);
        CHECK(memcmp(stats, again, sizeof stats) == 0);
        for (int label = 0; label < 256; label += 80) {
            struct label_stats expected = recount(scene, (uint8_t)label);
            memcpy(expected.cosines, stats[label].cosines, sizeof expected.cosines);
            CHECK_INT(stats[label].voxels, expected.voxels);
            if (expected.voxels && !CHECK(memcmp(&stats[label], &expected, sizeof expected) == 0))
                printf("# round %d, label %d\n", round, label);
        }
        scene_free(scene);
    }
}

/* ---- surfaces ---- */

struct solid {
    bool is_ball;
    double mm[3];   /* the radius, or the sides */
    double turn[3]; /* of a box, radians around z, y, x */
    double spacing_mm[3];
};

static void rotation(double out[3][3], const double turn[3])
{
    const double a = turn[0], b = turn[1], c = turn[2];
    const double r[3][3] = {{cos(a) * cos(b), cos(a) * sin(b) * sin(c) - sin(a) * cos(c),
                             cos(a) * sin(b) * cos(c) + sin(a) * sin(c)},
                            {sin(a) * cos(b), sin(a) * sin(b) * sin(c) + cos(a) * cos(c),
                             sin(a) * sin(b) * cos(c) - cos(a) * sin(c)},
                            {-sin(b), cos(b) * sin(c), cos(b) * cos(c)}};
    memcpy(out, r, sizeof r);
}

static bool holds(const struct solid *solid, double r[3][3], const double p[3])
{
    if (solid->is_ball)
        return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] <= solid->mm[0] * solid->mm[0];
    for (int a = 0; a < 3; a++)
        if (fabs(r[0][a] * p[0] + r[1][a] * p[1] + r[2][a] * p[2]) > solid->mm[a] / 2)
            return false;
    return true;
}

static double true_area(const struct solid *solid)
{
    const double *mm = solid->mm;
    return solid->is_ball ? 4 * acos(-1) * mm[0] * mm[0]
                          : 2 * (mm[0] * mm[1] + mm[1] * mm[2] + mm[0] * mm[2]);
}

/* In the middle of a scene with some room around it. */
static struct scene *scene_of(const struct solid *solid)
{
    const double *mm = solid->mm;
    const double reach =
        solid->is_ball ? mm[0] : sqrt(mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]) / 2;
    struct scene *scene;
    uint32_t size[3];
    double r[3][3];
    for (int a = 0; a < 3; a++)
        size[a] = (uint32_t)(2 * reach / solid->spacing_mm[a]) + 8;
    if (scene_new(&scene, size, NULL) != OK)
        abort();
    rotation(r, solid->turn);
    for (int a = 0; a < 3; a++)
        scene->spacing_nm[a] = (uint32_t)(solid->spacing_mm[a] * 1e6);
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++) {
                const double p[3] = {(x - size[0] / 2.0 + 0.37) * solid->spacing_mm[0],
                                     (y - size[1] / 2.0 + 0.21) * solid->spacing_mm[1],
                                     (z - size[2] / 2.0 + 0.44) * solid->spacing_mm[2]};
                scene->cell[grid_cell(&scene->grid, x, y, z)].label = holds(solid, r, p) ? 7 : 0;
            }
    return scene;
}

static double area_of(const uint64_t cosines[3], const double mm[3])
{
    double area = 0;
    for (int a = 0; a < 3; a++)
        area += (double)cosines[a] / SURFACE_UNIT * mm[(a + 1) % 3] * mm[(a + 2) % 3];
    return area;
}

/* How many percent more than the true area. */
static double error_of(const struct solid *solid)
{
    static struct label_stats stats[256];
    struct scene *scene = scene_of(solid);
    const struct labels labels = labels_of_forest(scene);
    CHECK(label_stats_find(stats, &labels, team_of[2], NULL) == OK);
    const double mm2 = area_of(stats[7].cosines, solid->spacing_mm);
    scene_free(scene);
    return 100 * (mm2 / true_area(solid) - 1);
}

STORY(the_surface_of_balls_and_boxes_is_right_to_two_percent)
{
    static const double spacing[][3] = {{1, 1, 1}, {0.5, 0.5, 1}, {0.8, 1, 1.2}};
    static const double turn[][3] = {{0, 0, 0},       {0.3, 0, 0},         {0.785, 0, 0},
                                     {0.4, 0.7, 1.1}, {0.785, 0.615, 0.2}, {0.1, 0.05, 0.02}};
    static const double radius[] = {8, 11, 16, 25};
    for (size_t s = 0; s < sizeof spacing / sizeof *spacing; s++) {
        struct solid solid = {.is_ball = true};
        memcpy(solid.spacing_mm, spacing[s], sizeof solid.spacing_mm);
        for (size_t i = 0; i < sizeof radius / sizeof *radius; i++) {
            solid.mm[0] = radius[i];
            const double error = error_of(&solid);
            if (!CHECK(fabs(error) < 2))
                printf("# ball of %g, spacing %zu: %+.2f %%\n", radius[i], s, error);
        }
        solid = (struct solid){.mm = {60, 66, 72}};
        memcpy(solid.spacing_mm, spacing[s], sizeof solid.spacing_mm);
        for (size_t i = 0; i < sizeof turn / sizeof *turn; i++) {
            memcpy(solid.turn, turn[i], sizeof solid.turn);
            const double error = error_of(&solid);
            if (!CHECK(fabs(error) < 2))
                printf("# box turned %zu, spacing %zu: %+.2f %%\n", i, s, error);
        }
    }
}

/* The face of a voxel that is alone, and of a plate that goes from edge to edge. */
STORY(the_edge_of_the_scene_is_a_surface)
{
    struct scene *scene;
    struct label_surface surface;
    if (scene_new(&scene, (const uint32_t[3]){40, 40, 40}, NULL) != OK)
        abort();
    uint8_t *label = calloc(scene->grid.cells, 1);
    for (uint32_t z = 0; z < 40; z++)
        for (uint32_t y = 0; y < 40; y++)
            for (uint32_t x = 0; x < 40; x++)
                label[grid_cell(&scene->grid, x, y, z)] = 1;
    CHECK(label_surface_find(&surface, label, scene, NULL, NULL) == OK);
    const double whole = area_of(surface.cosines[1], (const double[]){1, 1, 1});
    CHECK(whole > 0.96 * 9600 && whole < 9600);
    CHECK(surface.cosines[0][0] == 0);
    free(label);
    scene_free(scene);
}

int main(void)
{
    for (unsigned workers = 1; workers < 4; workers++)
        if (team_new(&team_of[workers], workers, NULL) != OK)
            abort();
    const int status = RUN_STORIES(TELL(all_that_is_counted_is_what_a_plain_recount_gives),
                                   TELL(the_surface_of_balls_and_boxes_is_right_to_two_percent),
                                   TELL(the_edge_of_the_scene_is_a_surface));
    for (unsigned workers = 1; workers < 4; workers++)
        team_free(team_of[workers]);
    return status;
}
