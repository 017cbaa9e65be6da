/* SPDX-License-Identifier: MIT */
/* Statistics of labels equal a plain recount that walks over voxels and sorts; surface areas equal
 * those of balls and boxes. */
#include <math.h>

#include "engine/label_stats.h"
#include "show/label_report.h"
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
    if (scene_new(&scene, size, NULL, NULL, NULL) != OK)
        abort();
    for (int a = 0; a < 3; a++)
        scene->spacing_nm[a] = 200000 + 100000 * below(10);
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

/* Mark the voxels connected to a voxel by faces that are (or are not) of the label. Returns true if
 * they reach the edge. */
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

/* Count the pairs of a voxel with later voxels of the scene. */
static void recount_pairs(struct label_stats *stats, const struct scene *scene, const uint32_t p[3],
                          const uint32_t step[3])
{
    for (int z = 0; z <= 2; z++)
        for (int y = -2; y <= 2; y++)
            for (int x = -2; x <= 2; x++) {
                const int64_t q[3] = {p[0] + x * (int64_t)step[0], p[1] + y * (int64_t)step[1],
                                      p[2] + z * (int64_t)step[2]};
                if (z * 25 + y * 5 + x < 0 || !grid_contains(&scene->grid, q[0], q[1], q[2]))
                    continue;
                stats->pairs[abs(x) + 3 * abs(y) + 9 * z] +=
                    at(scene, (uint32_t[]){(uint32_t)q[0], (uint32_t)q[1], (uint32_t)q[2]}) ==
                    at(scene, p);
            }
}

static struct label_stats recount(const struct scene *scene, uint8_t label)
{
    struct label_stats stats = {.sums = {.first = {99, 99, 99}}};
    struct label_sums *sums = &stats.sums;
    const uint32_t *size = scene->grid.size;
    bool own[VOXELS] = {false}, other[VOXELS] = {false};
    uint16_t value[VOXELS];
    uint32_t p[3], step[3];
    label_pairs_step(step, scene->spacing_nm);
    for (p[2] = 0; p[2] < size[2]; p[2]++)
        for (p[1] = 0; p[1] < size[1]; p[1]++)
            for (p[0] = 0; p[0] < size[0]; p[0]++) {
                const uint32_t i = (p[2] * SIDE + p[1]) * SIDE + p[0];
                const uint16_t v = scene->cell[grid_cell(&scene->grid, p[0], p[1], p[2])].intensity;
                if (at(scene, p) != label) {
                    stats.holes += !other[i] && !flood(scene, other, p, label, false);
                    continue;
                }
                if (!own[i]) {
                    flood(scene, own, p, label, true);
                    stats.components++;
                }
                recount_pairs(&stats, scene, p, step);
                value[sums->voxels++] = v;
                sums->intensity += v;
                sums->intensity_squares += (uint64_t)v * v;
                for (int a = 0; a < 3; a++) {
                    sums->sum[a] += p[a];
                    sums->first[a] = p[a] < sums->first[a] ? p[a] : sums->first[a];
                    sums->last[a] = p[a] > sums->last[a] ? p[a] : sums->last[a];
                }
            }
    if (sums->voxels) {
        qsort(value, sums->voxels, sizeof *value, by_value);
        sums->least = value[0];
        sums->most = value[sums->voxels - 1];
        sums->middle[0] = value[(sums->voxels - 1) / 2];
        sums->middle[1] = value[sums->voxels / 2];
    }
    return stats;
}

static struct team *team_of[4];

STORY(all_that_is_counted_is_what_a_plain_recount_gives)
{
    for (int round = 0; round < 800; round++) {
        state = (uint64_t)round;
        OWNED(scene_drop) struct scene *scene = random_scene();
        const struct labels labels = labels_of_forest(scene);
        struct label_stats stats[256], again[256];
        struct label_measures measures[2] = {{0}};
        CHECK(label_stats_find(stats, measures, &labels, team_of[round % 4], NULL) == OK);
        CHECK(label_stats_find(again, measures + 1, &labels, team_of[(round + 1) % 4], NULL) == OK);
        CHECK(memcmp(stats, again, sizeof stats) == 0);
        for (int label = 80; label < 256; label += 80) {
            struct label_stats expected = recount(scene, (uint8_t)label);
            CHECK_INT(stats[label].sums.voxels, expected.sums.voxels);
            if (expected.sums.voxels &&
                !CHECK(memcmp(&stats[label], &expected, sizeof expected) == 0))
                printf("# round %d, label %d\n", round, label);
        }
        label_measures_release(measures);
        label_measures_release(measures + 1);
    }
}

/* ---- surfaces ---- */

struct solid {
    bool is_ball;
    double mm[3];      /* the radius, or the sides */
    double turn[3][3]; /* axes of a box */
    double spacing_mm[3];
    double shift[3]; /* shift of the middle, 0..1 voxel */
    double shear;    /* the sine by which z leans to y */
};

static double between(double low, double high)
{
    return low + (high - low) * below(1000000) / 1e6;
}

/* A uniform random rotation: that of a random unit quaternion. */
static void turn_anyhow(double turn[3][3])
{
    double q[4], squares;
    do {
        squares = 0;
        for (int i = 0; i < 4; i++) {
            q[i] = between(-1, 1);
            squares += q[i] * q[i];
        }
    } while (squares > 1 || squares < 0.01);
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(squares);
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        turn[a][a] = 1 - 2 * (q[b] * q[b] + q[c] * q[c]);
        turn[a][b] = 2 * (q[a] * q[b] + q[c] * q[3]);
        turn[a][c] = 2 * (q[a] * q[c] - q[b] * q[3]);
    }
}

static bool holds(const struct solid *solid, const double p[3])
{
    if (solid->is_ball)
        return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] <= solid->mm[0] * solid->mm[0];
    for (int a = 0; a < 3; a++) {
        const double *axis = solid->turn[a];
        if (fabs(axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]) > solid->mm[a] / 2)
            return false;
    }
    return true;
}

static double true_area(const struct solid *solid)
{
    const double *mm = solid->mm;
    return solid->is_ball ? 4 * acos(-1) * mm[0] * mm[0]
                          : 2 * (mm[0] * mm[1] + mm[1] * mm[2] + mm[0] * mm[2]);
}

static struct geometry geometry_of(const struct solid *solid)
{
    const double *mm = solid->spacing_mm, cosine = sqrt(1 - solid->shear * solid->shear);
    const double to_mm[3][4] = {
        {mm[0], 0, 0, 0}, {0, mm[1], mm[2] * solid->shear, 0}, {0, 0, mm[2] * cosine, 0}};
    struct geometry geometry = {.slope = 1};
    for (int a = 0; a < 3; a++)
        geometry_spacing(&geometry.spacing_nm[a], mm[a]);
    geometry_place(&geometry, to_mm, ORIENTATION_FILE);
    return geometry;
}

/* A scene with the solid in its middle. */
static struct scene *scene_of(const struct solid *solid)
{
    const struct geometry geometry = geometry_of(solid);
    const double *mm = solid->mm, (*to_mm)[4] = geometry.to_mm;
    const double cosine = sqrt(1 - solid->shear * solid->shear);
    double sides[3]; /* of the box around it */
    struct scene *scene;
    uint32_t size[3];
    for (int w = 0; w < 3; w++) {
        sides[w] = solid->is_ball ? 2 * mm[0] : 0;
        for (int a = 0; a < 3 && !solid->is_ball; a++)
            sides[w] += fabs(solid->turn[a][w]) * mm[a];
    }
    sides[1] += sides[2] * solid->shear / cosine;
    sides[2] /= cosine;
    for (int a = 0; a < 3; a++)
        size[a] = (uint32_t)(sides[a] / solid->spacing_mm[a]) + 8;
    if (scene_new(&scene, size, NULL, NULL, NULL) != OK)
        abort();
    for (int a = 0; a < 3; a++)
        scene->spacing_nm[a] = (uint32_t)(solid->spacing_mm[a] * 1e6 + 0.5);
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++) {
                const double from[3] = {(double)x - size[0] / 2 + solid->shift[0],
                                        (double)y - size[1] / 2 + solid->shift[1],
                                        (double)z - size[2] / 2 + solid->shift[2]};
                double p[3];
                for (int w = 0; w < 3; w++)
                    p[w] = from[0] * to_mm[w][0] + from[1] * to_mm[w][1] + from[2] * to_mm[w][2];
                scene->cell[grid_cell(&scene->grid, x, y, z)].label = holds(solid, p) ? 7 : 0;
            }
    return scene;
}

static double area_of(const struct scene *scene, const struct geometry *geometry)
{
    static struct label_stats stats[256];
    OWNED(label_measures_release) struct label_measures measures = {0};
    struct area_weights weights;
    const struct labels labels = labels_of_forest(scene);
    CHECK(label_stats_find(stats, &measures, &labels, team_of[2], NULL) == OK);
    area_weights_init(&weights, geometry);
    return label_area_mm2(&weights, stats[7].pairs);
}

/* Error of the area in percent. */
static double error_of(const struct solid *solid)
{
    OWNED(scene_drop) struct scene *scene = scene_of(solid);
    const struct geometry geometry = geometry_of(solid);
    const double mm2 = area_of(scene, &geometry);
    return 100 * (mm2 / true_area(solid) - 1);
}

static const double spacing[][3] = {{1, 1, 1},     {0.5, 0.5, 1}, {0.8, 1, 1.2}, {1, 1, 1.45},
                                    {1, 1.5, 1.5}, {2, 1, 0.7},   {0.6, 0.6, 2}, {0.7, 0.7, 5}};
enum { SPACINGS = sizeof spacing / sizeof *spacing };

/* A solid without a size; sizes are in units of the longest spacing. */
static struct solid solid_of(size_t at)
{
    struct solid solid = {.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int a = 0; a < 3; a++) {
        solid.spacing_mm[a] = spacing[at][a];
        solid.shift[a] = between(0, 1);
    }
    return solid;
}

static double longest(size_t at)
{
    return fmax(fmax(spacing[at][0], spacing[at][1]), spacing[at][2]);
}

/* The place of a side between voxels changes single areas, but not their mean. */
struct errors {
    double sum, most;
    int count;
};

static void add_error(struct errors *errors, double error)
{
    errors->sum += error;
    errors->most = fabs(error) > errors->most ? fabs(error) : errors->most;
    errors->count++;
}

/* `most` and `mean` are in percent. */
static void is_right(const struct errors *errors, double most, double mean, const char *what,
                     double size, size_t at)
{
    if (!CHECK(errors->most < most) || !CHECK(fabs(errors->sum / errors->count) < mean))
        printf("# %s of %g, spacing %zu: mean %+.2f %%, most %.2f %%\n", what, size, at,
               errors->sum / errors->count, errors->most);
}

STORY(the_surface_of_balls_is_right_to_two_percent)
{
    static const double radius[] = {6, 8, 11, 16, 25};
    for (size_t s = 0; s < SPACINGS; s++)
        for (size_t i = 0; i < sizeof radius / sizeof *radius; i++) {
            struct errors errors = {0};
            for (int n = 0; n < 4; n++) {
                struct solid solid = solid_of(s);
                solid.is_ball = true;
                solid.mm[0] = radius[i] * longest(s);
                add_error(&errors, error_of(&solid));
            }
            is_right(&errors, 2, 2, "ball", radius[i], s);
        }
}

STORY(the_surface_of_boxes_that_are_turned_anyhow_is_right_to_two_percent)
{
    static const double side[][2] = {{12, 3}, {20, 2.7}, {30, 2}}; /* side, and percent */
    for (size_t s = 0; s < SPACINGS; s++)
        for (size_t i = 0; i < sizeof side / sizeof *side; i++) {
            struct errors errors = {0};
            for (int n = 0; n < 5; n++) {
                struct solid solid = solid_of(s);
                for (int a = 0; a < 3; a++)
                    solid.mm[a] = side[i][0] * longest(s) * (1 + 0.1 * a);
                turn_anyhow(solid.turn);
                add_error(&errors, error_of(&solid));
            }
            is_right(&errors, side[i][1], 0.6, "box", side[i][0], s);
        }
}

/* Sides are whole voxels: voxels do not determine other sides. */
STORY(the_surface_of_boxes_along_the_axes_is_right_to_two_percent)
{
    static const int side[] = {10, 20, 40};
    for (size_t s = 0; s < SPACINGS; s++)
        for (size_t i = 0; i < sizeof side / sizeof *side; i++) {
            struct errors errors = {0};
            struct solid solid = solid_of(s);
            for (int a = 0; a < 3; a++) {
                const double voxels = ceil((side[i] + a) * longest(s) / spacing[s][a]);
                solid.mm[a] = voxels * spacing[s][a];
                solid.shift[a] = fmod(voxels, 2) ? 0.01 : 0.51;
            }
            add_error(&errors, error_of(&solid));
            is_right(&errors, 2, 2, "box along the axes", side[i], s);
        }
}

/* Sheared like a tilted gantry. */
STORY(surfaces_on_sheared_grids_are_right_too)
{
    static const double sine[] = {0.1, 0.26, 0.5}; /* 6, 15 and 30 degrees */
    for (size_t s = 0; s < SPACINGS; s++)
        for (size_t i = 0; i < sizeof sine / sizeof *sine; i++) {
            struct errors balls = {0}, boxes = {0};
            for (int n = 0; n < 4; n++) {
                struct solid solid = solid_of(s);
                solid.shear = sine[i];
                solid.is_ball = true;
                solid.mm[0] = 11 * longest(s);
                add_error(&balls, error_of(&solid));
                solid.is_ball = false;
                for (int a = 0; a < 3; a++)
                    solid.mm[a] = 25 * longest(s) * (1 + 0.1 * a);
                turn_anyhow(solid.turn);
                add_error(&boxes, error_of(&solid));
            }
            is_right(&balls, 2, 2, "sheared ball", sine[i], s);
            is_right(&boxes, sine[i] < 0.5 ? 5 : 12, sine[i] < 0.5 ? 3 : 6, "sheared box", sine[i],
                     s);
        }
}

/* A cube that fills its scene. */
STORY(the_edge_of_the_scene_is_a_surface)
{
    OWNED(scene_drop) struct scene *scene;
    if (scene_new(&scene, (const uint32_t[3]){40, 40, 40}, NULL, NULL, NULL) != OK)
        abort();
    for (uint32_t z = 0; z < 40; z++)
        for (uint32_t y = 0; y < 40; y++)
            for (uint32_t x = 0; x < 40; x++)
                scene->cell[grid_cell(&scene->grid, x, y, z)].label = 7;
    const struct solid unit = {.spacing_mm = {1, 1, 1}};
    const struct geometry geometry = geometry_of(&unit);
    CHECK(fabs(area_of(scene, &geometry) - 9600) < 0.02 * 9600);
}

int main(void)
{
    for (unsigned workers = 1; workers < 4; workers++)
        if (team_new(&team_of[workers], workers, NULL) != OK)
            abort();
    const int status = check_run();
    for (unsigned workers = 1; workers < 4; workers++)
        team_free(team_of[workers]);
    return status;
}
