/* SPDX-License-Identifier: MIT */
/* Arc weights: tiny scenes worked by hand, and random ones against recomputes of whole volumes. */
#include <math.h>

#include "base/least.h"
#include "engine/weight_gradient.h"
#include "engine/weight.h"
#include "tests/check_main.h"
#include "tests/scarce_memory.h"

static const struct weight_choice morph1 = {WEIGHT_MORPH, 1}, morph2 = {WEIGHT_MORPH, 2},
                                  morph3 = {WEIGHT_MORPH, 3}, sobel = {WEIGHT_SOBEL, 0},
                                  gauss1 = {WEIGHT_GAUSS, 1000};

/* A scene of [z][y][x] intensities; freed by scene_free. */
static struct scene *scene_of(uint32_t x, uint32_t y, uint32_t z, const uint16_t *intensity)
{
    struct scene *scene;
    if (scene_new(&scene, (uint32_t[3]){x, y, z}, intensity, NULL, NULL) != OK)
        abort();
    return scene;
}

static void weigh_by_team(struct scene *scene, unsigned neighbours,
                          const struct weight_choice *choice, struct team *team)
{
    OWNED(weight_work_release) struct weight_work work = {.team = team};
    struct adjacency adjacency;
    adjacency_init(&adjacency, neighbours, &scene->grid);
    CHECK(weight_work_reserve(&work, &scene->grid, choice, NULL) == OK);
    memset(work.capacity ? work.bytes : &work, work.capacity ? 0xA5 : 0, work.capacity);
    weight_compute(scene, &adjacency, choice, &work);
}

static void weigh(struct scene *scene, unsigned neighbours, const struct weight_choice *choice)
{
    weigh_by_team(scene, neighbours, choice, NULL);
}

static uint16_t weight_at(const struct scene *scene, uint32_t x, uint32_t y, uint32_t z)
{
    return scene->cell[grid_cell(&scene->grid, x, y, z)].weight;
}

/* A row of voxels along each axis in turn has these weights. */
static void row_weighs(const uint16_t *intensity, uint32_t count, const struct weight_choice *by,
                       const uint16_t *expected)
{
    for (int axis = 0; axis < 3; axis++) {
        uint32_t size[3] = {1, 1, 1};
        size[axis] = count;
        OWNED(scene_drop) struct scene *scene = scene_of(size[0], size[1], size[2], intensity);
        weigh(scene, 6, by);
        for (uint32_t i = 0; i < count; i++)
            CHECK_INT(weight_at(scene, axis == 0 ? i : 0, axis == 1 ? i : 0, axis == 2 ? i : 0),
                      expected[i]);
    }
}

/* ---- by hand ---- */

STORY(what_is_flat_weighs_nothing)
{
    static const uint16_t level[] = {0, 1, 40000, 65535};
    const struct weight_choice choices[] = {
        morph1, morph2, morph3, sobel, gauss1, {WEIGHT_GAUSS, 500}, {WEIGHT_GAUSS, 8000}};
    for (size_t l = 0; l < 4; l++)
        for (size_t c = 0; c < 7; c++) {
            uint16_t intensity[5 * 4 * 3];
            for (size_t i = 0; i < 60; i++)
                intensity[i] = level[l];
            OWNED(scene_drop) struct scene *scene = scene_of(5, 4, 3, intensity);
            for (size_t i = 0; i < scene->grid.cells; i++) /* the previous value */
                if (!(scene->cell[i].flags & CELL_RIM))
                    scene->cell[i].weight = 7;
            weigh(scene, 26, &choices[c]);
            uint64_t sum = 0;
            for (size_t i = 0; i < scene->grid.cells; i++)
                sum += scene->cell[i].weight;
            CHECK_INT(sum, 0);
        }
}

STORY(a_step_weighs_its_height_on_both_sides)
{
    static const uint16_t step[] = {10, 10, 10, 10, 110, 110, 110, 110};
    row_weighs(step, 8, &morph1, (const uint16_t[]){0, 0, 0, 100, 100, 0, 0, 0});
    row_weighs(step, 8, &morph2, (const uint16_t[]){0, 0, 100, 100, 100, 100, 0, 0});
    row_weighs(step, 8, &morph3, (const uint16_t[]){0, 100, 100, 100, 100, 100, 100, 0});
    row_weighs(step, 8, &sobel, (const uint16_t[]){0, 0, 0, 100, 100, 0, 0, 0});
    /* Sigma 1: weights 26162 15868 3541 291 of 65536 at distances 0 to 3. One voxel further off the
     * step, 15868 + 3541 of 26162 + 15868 of the height is left: 46.18 of 100; then 9.12, 0.69. */
    row_weighs(step, 8, &gauss1, (const uint16_t[]){1, 9, 46, 100, 100, 46, 9, 1});
}

STORY(a_step_weighs_its_height_under_every_sigma)
{
    static const uint16_t height[] = {1, 100, 65535};
    uint16_t step[64];
    for (uint32_t sigma = 500; sigma <= 8000; sigma += 375)
        for (size_t h = 0; h < 3; h++) {
            for (size_t i = 0; i < 64; i++)
                step[i] = i < 32 ? 0 : height[h];
            const struct weight_choice by = {WEIGHT_GAUSS, sigma};
            OWNED(scene_drop) struct scene *scene = scene_of(1, 64, 1, step);
            weigh(scene, 6, &by);
            CHECK_INT(weight_at(scene, 0, 31, 0), height[h]);
            CHECK_INT(weight_at(scene, 0, 32, 0), height[h]);
        }
}

STORY(a_ramp_weighs_twice_its_rise)
{
    static const uint16_t ramp[] = {0, 5, 10, 15, 20, 25, 30, 35, 40};
    row_weighs(ramp, 9, &morph1, (const uint16_t[]){5, 10, 10, 10, 10, 10, 10, 10, 5});
    row_weighs(ramp, 9, &morph3, (const uint16_t[]){15, 20, 25, 30, 30, 30, 25, 20, 15});
    row_weighs(ramp, 9, &sobel, (const uint16_t[]){5, 10, 10, 10, 10, 10, 10, 10, 5});
    OWNED(scene_drop) struct scene *scene = scene_of(9, 1, 1, ramp);
    weigh(scene, 6, &gauss1);
    CHECK_INT(weight_at(scene, 4, 0, 0), 16); /* 10 * 65536 / (26162 + 15868) is 15.59 */
}

STORY(a_corner_counts_for_sobel_by_its_square_root)
{
    static const uint16_t corner[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 16,
                                      0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    OWNED(scene_drop) struct scene *scene = scene_of(3, 3, 3, corner);
    weigh(scene, 6, &sobel);
    CHECK_INT(weight_at(scene, 1, 1, 1), 0);
    CHECK_INT(weight_at(scene, 0, 1, 1), 4); /* 4 * 16 / 16 */
    CHECK_INT(weight_at(scene, 0, 0, 1), 2); /* sqrt(2) * 2 = 2.8 */
    CHECK_INT(weight_at(scene, 2, 2, 0), 1); /* sqrt(3) = 1.7 */
    weigh(scene, 6, &morph2);
    CHECK_INT(weight_at(scene, 0, 0, 1), 16);
    CHECK_INT(weight_at(scene, 0, 0, 0), 0); /* three steps away */
    weigh(scene, 26, &morph1);
    CHECK_INT(weight_at(scene, 0, 0, 0), 16);
}

STORY(a_single_voxel_weighs_nothing)
{
    static const uint16_t one[] = {65535}, none[] = {0};
    const struct weight_choice gauss8 = {WEIGHT_GAUSS, 8000};
    row_weighs(one, 1, &morph1, none);
    row_weighs(one, 1, &morph3, none);
    row_weighs(one, 1, &sobel, none);
    row_weighs(one, 1, &gauss1, none);
    row_weighs(one, 1, &gauss8, none);
}

/* Steps of 65535 along all three axes at once: sqrt(3) times that does not fit. */
STORY(the_largest_intensities_do_not_overflow)
{
    uint16_t intensity[512];
    for (size_t i = 0; i < 512; i++)
        intensity[i] = (i & 7) + (i >> 3 & 7) + (i >> 6) > 10 ? 65535 : 0;
    OWNED(scene_drop) struct scene *scene = scene_of(8, 8, 8, intensity);
    const struct weight_choice sharp = {WEIGHT_GAUSS, 500}, choices[] = {sobel, sharp, gauss1};
    for (size_t c = 0; c < 3; c++) {
        uint16_t most = 0;
        weigh(scene, 6, &choices[c]);
        for (uint32_t i = 0; i < 512; i++) {
            uint16_t w = weight_at(scene, i & 7, i >> 3 & 7, i >> 6);
            most = w > most ? w : most;
        }
        CHECK_INT(most, 65535);
        CHECK_INT(weight_at(scene, 0, 0, 0), 0);
    }
    weigh(scene, 6, &morph3);
    CHECK_INT(weight_at(scene, 4, 3, 3), 65535);
    CHECK_INT(weight_at(scene, 0, 0, 0), 0);
}

STORY(the_gaussian_is_a_gaussian_and_sums_up)
{
    for (uint32_t sigma = SIGMA_LEAST; sigma <= SIGMA_MOST; sigma++) {
        struct gauss g;
        double sum = 1, two_sigma_squared = 2e-6 * sigma * sigma;
        uint32_t total;
        gauss_init(&g, sigma);
        total = g.weight[0];
        for (uint32_t k = 1; k <= g.radius; k++) {
            sum += 2 * exp(-(double)(k * k) / two_sigma_squared);
            total += 2 * g.weight[k];
        }
        CHECK_INT(total, GAUSS_SUM);
        CHECK(g.radius >= 3 * sigma / 1000 && g.radius <= GAUSS_RADIUS_MOST);
        CHECK(fabs(g.weight[0] - GAUSS_SUM / sum) < 26); /* the error of rounding */
        for (uint32_t k = 1; k <= g.radius; k++) {
            CHECK(fabs(g.weight[k] - exp(-(double)(k * k) / two_sigma_squared) * GAUSS_SUM / sum) <
                  0.501);
            CHECK(g.weight[k] <= g.weight[k - 1]);
        }
    }
}

/* ---- at random, against plain slow recomputes ---- */

static uint64_t seed = 1;

STORY(square_roots_are_rounded_down)
{
    CHECK_INT(square_root(0), 0);
    for (uint32_t i = 0; i < 2000000; i++) {
        const uint64_t any = (check_random(&seed) >> 32 >> i % 32) + 1;
        const uint64_t r = i < 100000 ? i + 1 : i < 200000 ? UINT32_MAX - (i - 100000) : any;
        if (r > UINT32_MAX)
            continue;
        if (!CHECK(square_root(r * r) == r) || !CHECK(square_root(r * r - 1) == r - 1))
            return;
        if (r < UINT32_MAX && !CHECK(square_root(r * r + 2 * r) == r))
            return;
    }
}

enum { SIDE_MOST = 12 };

struct volume {
    uint32_t size[3];
    int64_t value[SIDE_MOST * SIDE_MOST * SIDE_MOST];
};

static size_t index_of(const struct volume *v, const uint32_t at[3])
{
    return at[0] + (size_t)v->size[0] * (at[1] + (size_t)v->size[1] * at[2]);
}

static size_t count_of(const struct volume *v)
{
    return (size_t)v->size[0] * v->size[1] * v->size[2];
}

static void place_of(const struct volume *v, size_t i, uint32_t at[3])
{
    for (int a = 0; a < 3; a++) {
        at[a] = (uint32_t)(i % v->size[a]);
        i /= v->size[a];
    }
}

static int64_t value_near(const struct volume *v, size_t i, int dx, int dy, int dz)
{
    const int step[3] = {dx, dy, dz};
    uint32_t at[3];
    place_of(v, i, at);
    for (int a = 0; a < 3; a++) {
        const int64_t to = (int64_t)at[a] + step[a];
        at[a] = to < 0 ? 0 : to >= v->size[a] ? v->size[a] - 1 : (uint32_t)to;
    }
    return v->value[index_of(v, at)];
}

/* Random, with few or many levels, thin now and then. */
static struct volume random_volume(void)
{
    struct volume v;
    const uint32_t levels = (const uint32_t[]){2, 10, 256, 65536}[check_below(&seed, 4)];
    for (int a = 0; a < 3; a++)
        v.size[a] = 1 + check_below(&seed, check_below(&seed, 4) ? SIDE_MOST : 2);
    for (size_t i = 0; i < count_of(&v); i++)
        v.value[i] = (int64_t)check_below(&seed, levels) * 65535 / (levels - 1);
    return v;
}

static struct scene *scene_of_volume(const struct volume *v)
{
    uint16_t intensity[SIDE_MOST * SIDE_MOST * SIDE_MOST];
    for (size_t i = 0; i < count_of(v); i++)
        intensity[i] = (uint16_t)v->value[i];
    return scene_of(v->size[0], v->size[1], v->size[2], intensity);
}

/* The first floor(sqrt), by halving. */
static int64_t root_of(int64_t n)
{
    int64_t low = 0, high = INT64_C(3037000499);
    while (low < high) {
        int64_t middle = (low + high + 1) / 2;
        if (middle * middle <= n)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static int64_t at_most(int64_t n)
{
    return n < 65535 ? n : 65535;
}

/* One round over the adjacency: the largest (sign 1) or the smallest (-1). */
static struct volume one_round(const struct volume *v, unsigned neighbours, int sign)
{
    struct volume out = *v;
    for (size_t i = 0; i < count_of(v); i++) {
        for (int n = 0; n < 27; n++) { /* a replicated edge adds nothing new to an extremum... */
            int d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            if (neighbours == 6 && abs(d[0]) + abs(d[1]) + abs(d[2]) > 1)
                continue; /* ...as each voxel held inside is a neighbour or the voxel itself */
            int64_t value = value_near(v, i, d[0], d[1], d[2]);
            if (sign * value > sign * out.value[i])
                out.value[i] = value;
        }
    }
    return out;
}

static struct volume slow_morph(const struct volume *v, unsigned neighbours, uint32_t radius)
{
    struct volume high = *v, low = *v;
    for (uint32_t r = 0; r < radius; r++) {
        high = one_round(&high, neighbours, 1);
        low = one_round(&low, neighbours, -1);
    }
    for (size_t i = 0; i < count_of(v); i++)
        high.value[i] -= low.value[i];
    return high;
}

static struct volume slow_sobel(const struct volume *v, unsigned neighbours, uint32_t nothing)
{
    (void)neighbours, (void)nothing;
    struct volume out = *v;
    for (size_t i = 0; i < count_of(v); i++) {
        int64_t g[3] = {0, 0, 0};
        for (int n = 0; n < 27; n++) {
            const int d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            for (int a = 0; a < 3; a++)
                g[a] += value_near(v, i, d[0], d[1], d[2]) * d[a] * (2 - abs(d[(a + 1) % 3])) *
                        (2 - abs(d[(a + 2) % 3]));
        }
        out.value[i] = at_most(root_of(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / 16);
    }
    return out;
}

static struct volume smoothed_along(const struct volume *v, const struct gauss *g, int axis)
{
    struct volume out = *v;
    for (size_t i = 0; i < count_of(v); i++) {
        int64_t sum = 0;
        for (int k = -(int)g->radius; k <= (int)g->radius; k++)
            sum += g->weight[abs(k)] *
                   value_near(v, i, axis == 0 ? k : 0, axis == 1 ? k : 0, axis == 2 ? k : 0);
        out.value[i] = (sum + 32768) / 65536;
    }
    return out;
}

static struct volume slow_gauss(const struct volume *v, unsigned neighbours, uint32_t sigma)
{
    (void)neighbours;
    struct gauss g;
    struct volume s = *v, out = *v;
    gauss_init(&g, sigma);
    for (size_t i = 0; i < count_of(v); i++)
        s.value[i] *= 65536;
    for (int axis = 2; axis >= 0; axis--)
        s = smoothed_along(&s, &g, axis);
    for (size_t i = 0; i < count_of(v); i++) {
        int64_t square = 0;
        for (int a = 0; a < 3; a++) {
            int64_t d = value_near(&s, i, a == 0, a == 1, a == 2) -
                        value_near(&s, i, -(a == 0), -(a == 1), -(a == 2));
            square += llabs(d) / 2 * (llabs(d) / 2);
            CHECK(square >= 0);
        }
        const int64_t step = (int64_t)g.weight[0] + g.weight[1];
        out.value[i] = at_most((2 * root_of(square) + step / 2) / step);
    }
    return out;
}

static bool weighs_as(const struct scene *scene, const struct volume *expected)
{
    bool same = true;
    for (size_t i = 0; i < count_of(expected); i++) {
        uint32_t at[3];
        place_of(expected, i, at);
        same &= weight_at(scene, at[0], at[1], at[2]) == expected->value[i];
    }
    return same;
}

/* What each weight of the table is, computed in another way: for a voxel, or for the arc between
 * two. */
static int64_t slow_difference(int64_t from, int64_t to, int64_t percent)
{
    (void)percent;
    return from > to ? from - to : to - from;
}

/* A step down costs a percentage more, and a step up as much less. */
static int64_t slow_polarity(int64_t from, int64_t to, int64_t percent)
{
    return at_most(from > to ? (from - to) * (100 + percent) / 100
                             : (to - from) * (100 - percent) / 100);
}

static const struct oracle {
    struct volume (*of_voxels)(const struct volume *, unsigned neighbours, uint32_t argument);
    int64_t (*of_arc)(int64_t from, int64_t to, int64_t percent);
} oracles[WEIGHT_FILE] = {[WEIGHT_MORPH] = {.of_voxels = slow_morph},
                          [WEIGHT_SOBEL] = {.of_voxels = slow_sobel},
                          [WEIGHT_GAUSS] = {.of_voxels = slow_gauss},
                          [WEIGHT_DIFFERENCE] = {.of_arc = slow_difference},
                          [WEIGHT_POLARITY] = {.of_arc = slow_polarity}};

static void arcs_weigh_as(enum arc_kind kind, const struct oracle *oracle)
{
    for (unsigned i = 0; i < 3000 && check_failures < 3; i++) {
        const int percent = (int)check_below(&seed, 2 * POLARITY_MOST + 1) - POLARITY_MOST;
        const uint32_t levels = check_below(&seed, 2) ? 65536 : 300;
        const struct cell from = {.intensity = (uint16_t)check_below(&seed, levels)};
        const struct cell to = {.intensity = (uint16_t)check_below(&seed, levels)};
        struct arc_rule rule = {.kind = kind};
        rule.polarity[3] = (int8_t)percent;
        CHECK_INT(arc_weight(&rule, kind, &from, &to, 3),
                  oracle->of_arc(from.intensity, to.intensity, percent));
    }
}

STORY(every_weight_of_the_table_is_what_its_oracle_says)
{
    for (enum weight_kind kind = 0; kind < WEIGHT_FILE; kind++) {
        const struct oracle *oracle = &oracles[kind];
        const struct weight_row *row = &weight_table[kind];
        const bool of_voxels = weight_arcs(kind) == ARC_TARGET;
        if (!CHECK(of_voxels ? oracle->of_voxels != NULL : oracle->of_arc != NULL)) {
            printf("#   %s has no oracle here\n", row->name);
            continue;
        }
        if (!of_voxels)
            arcs_weigh_as(weight_arcs(kind), oracle);
        const unsigned rounds = kind == WEIGHT_MORPH ? 1830 : kind == WEIGHT_SOBEL ? 530 : 330;
        for (unsigned i = 0; of_voxels && i < rounds && check_failures < 3; i++) {
            const uint32_t most = check_below(&seed, 2) ? 1500 : SIGMA_MOST;
            const uint32_t argument = row->takes == WEIGHT_TAKES_RADIUS ? 1 + i / 2 % RADIUS_MOST
                                      : row->takes == WEIGHT_TAKES_SIGMA
                                          ? SIGMA_LEAST + check_below(&seed, most - SIGMA_LEAST + 1)
                                          : 0;
            const unsigned neighbours = i % 2 ? 26 : 6;
            const struct weight_choice by = {kind, argument};
            const struct volume v = random_volume();
            const struct volume expected = oracle->of_voxels(&v, neighbours, argument);
            OWNED(scene_drop) struct scene *scene = scene_of_volume(&v);
            weigh(scene, neighbours, &by);
            CHECK(weighs_as(scene, &expected));
        }
    }
}

static uint16_t morph_by_cell(const struct cell *cell, const struct adjacency *adjacency)
{
    uint16_t low = cell->intensity, high = low;
    for (unsigned n = 0; n < adjacency->count; n++) {
        const struct cell *neighbour = cell + adjacency->offset[n];
        if (neighbour->flags & CELL_RIM)
            continue;
        low = neighbour->intensity < low ? neighbour->intensity : low;
        high = neighbour->intensity > high ? neighbour->intensity : high;
    }
    return (uint16_t)(high - low);
}

STORY(scenes_wider_and_higher_than_tiles_have_the_same_morph)
{
    static const uint32_t sizes[][3] = {{515, 3, 2}, {256, 33, 3}, {257, 64, 2}, {1, 97, 4}};
    for (unsigned i = 0; i < 8; i++) {
        const uint32_t *size = sizes[i / 2];
        const unsigned neighbours = i % 2 ? 26 : 6;
        OWNED(scene_drop) struct scene *scene = NULL;
        struct adjacency adjacency;
        CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK);
        adjacency_init(&adjacency, neighbours, &scene->grid);
        for (size_t k = 0; k < scene->grid.cells; k++)
            if (!(scene->cell[k].flags & CELL_RIM))
                scene->cell[k].intensity = (uint16_t)check_below(&seed, 65536);
        weigh(scene, neighbours, &morph1);
        size_t wrong = 0;
        for (size_t k = 0; k < scene->grid.cells; k++) {
            const struct cell *cell = scene->cell + k;
            const bool is_rim = cell->flags & CELL_RIM;
            wrong += cell->weight != (is_rim ? 0 : morph_by_cell(cell, &adjacency));
        }
        CHECK(wrong == 0);
    }
}

static struct volume mirrored(const struct volume *v, unsigned axes)
{
    struct volume out = *v;
    for (size_t i = 0; i < count_of(v); i++) {
        uint32_t at[3];
        place_of(v, i, at);
        for (unsigned a = 0; a < 3; a++)
            at[a] = axes >> a & 1 ? v->size[a] - 1 - at[a] : at[a];
        out.value[index_of(v, at)] = v->value[i];
    }
    return out;
}

STORY(a_mirrored_scene_has_mirrored_weights)
{
    const struct weight_choice choices[] = {morph1, morph2, morph3,
                                            sobel,  gauss1, {WEIGHT_GAUSS, 3333}};
    for (unsigned i = 0; i < 48; i++) {
        const struct weight_choice *by = &choices[i % 6];
        const struct volume v = random_volume(), m = mirrored(&v, i / 6);
        OWNED(scene_drop) struct scene *scene = scene_of_volume(&v), *mirror = scene_of_volume(&m);
        struct volume weights = v;
        weigh(scene, 26, by);
        weigh(mirror, 26, by);
        for (size_t k = 0; k < count_of(&v); k++) {
            uint32_t at[3];
            place_of(&v, k, at);
            weights.value[k] = weight_at(scene, at[0], at[1], at[2]);
        }
        weights = mirrored(&weights, i / 6);
        CHECK(weighs_as(mirror, &weights));
    }
}

STORY(every_team_gives_the_same_weights)
{
    const struct arc_rule arcs = {0};
    const struct weight_choice choices[] = {morph1, morph2, morph3,
                                            sobel,  gauss1, {WEIGHT_GAUSS, 4200}};
    for (unsigned workers = 1; workers < SIDE_MOST + 3; workers++) { /* more than planes, too */
        OWNED(team_drop) struct team *team;
        CHECK(team_new(&team, workers, NULL) == OK);
        for (unsigned i = 0; i < 30; i++) {
            const struct volume v = random_volume();
            OWNED(scene_drop) struct scene *scene = scene_of_volume(&v);
            weigh(scene, 26, &choices[i % 6]);
            const uint64_t alone = weight_digest(scene, &arcs, NULL);
            for (size_t k = 0; k < scene->grid.cells; k++)
                scene->cell[k].weight ^= 0x5A5A;
            weigh_by_team(scene, 26, &choices[i % 6], team);
            CHECK(weight_digest(scene, &arcs, NULL) == alone);
            CHECK(weight_digest(scene, &arcs, team) == alone);
        }
    }
}

/* ---- plain scenes ---- */

static struct scene *plain_scene(const uint32_t size[3], const uint16_t *intensity)
{
    const size_t count = (size_t)size[0] * size[1] * size[2];
    uint16_t *own = mem_array(count, sizeof *own);
    struct scene *scene = NULL;
    if (own)
        memcpy(own, intensity, count * sizeof *own);
    CHECK(own && scene_new_plain(&scene, size, own, NULL, NULL) == OK);
    return scene;
}

static void check_plain(const uint32_t size[3], const uint16_t *intensity, unsigned neighbours,
                        struct team *team)
{
    const struct arc_rule arcs = {0};
    OWNED(scene_drop) struct scene *expected = scene_of(size[0], size[1], size[2], intensity);
    struct scene *scene = plain_scene(size, intensity);
    struct adjacency adjacency;
    char proof[SHA256_HEX], expected_proof[SHA256_HEX];
    uint64_t digest;
    adjacency_init(&adjacency, neighbours, &scene->grid);
    weigh(expected, neighbours, &morph1);
    const uint64_t weights = weight_digest(expected, &arcs, NULL);
    scene_proof(expected_proof, expected);
    scene_identify(&digest, proof, scene, team);
    CHECK(digest == scene_digest(expected) && digest == scene_digest(scene));
    CHECK_TEXT(proof, expected_proof);
    CHECK(weight_plain_digest(scene, &adjacency, &morph1, team) == weights);
    CHECK(weight_make_cells(scene, &adjacency, &morph1, team) == weights && !scene->plain);
    CHECK(memcmp(scene->cell, expected->cell, scene->grid.cells * sizeof *scene->cell) == 0);
    scene_identify(&digest, proof, scene, team);
    CHECK(digest == scene_digest(expected));
    CHECK_TEXT(proof, expected_proof);
    scene_free(scene);
    scene = plain_scene(size, intensity);
    scene_make_cells(scene, team, NULL, NULL);
    weigh_by_team(scene, neighbours, &morph1, team);
    CHECK(memcmp(scene->cell, expected->cell, scene->grid.cells * sizeof *scene->cell) == 0);
    scene_free(scene);
}

STORY(a_plain_scene_tells_what_its_cells_will_hold)
{
    enum { VALUES = 70 * 4 * 5 };
    static uint16_t intensity[VALUES];
    for (unsigned workers = 1; workers < 8; workers++) { /* more than planes, too */
        OWNED(team_drop) struct team *team;
        CHECK(team_new(&team, workers, NULL) == OK);
        for (uint32_t width = 1; width <= 70 && check_failures == 0; width++) {
            const uint32_t size[3] = {width, 1 + check_below(&seed, 4), 1 + check_below(&seed, 5)};
            for (size_t i = 0; i < VALUES; i++)
                intensity[i] = (uint16_t)(check_below(&seed, 65536) >> (i / 300 % 3) * 7);
            check_plain(size, intensity, width % 2 ? 26 : 6, team);
            check_plain(size, intensity, width % 2 ? 6 : 26, team);
        }
    }
    CHECK(weight_is_by_rows(&morph1) && !weight_is_by_rows(&morph2) && !weight_is_by_rows(&sobel));
}

/* ---- memory ---- */

STORY(without_memory_the_room_is_what_it_was)
{
    static const uint16_t values[24] = {0};
    OWNED(scene_drop) struct scene *scene = scene_of(4, 3, 2, values);
    OWNED(weight_work_release) struct weight_work work = {0};
    struct fault fault = {.text = ""};
    CHECK(weight_work_reserve(&work, &scene->grid, &sobel, &fault) == OK);
    const struct weight_work before = work;
    allow_allocations(0);
    CHECK(weight_work_reserve(&work, &scene->grid, &gauss1, &fault) == ERR_MEMORY);
    CHECK(weight_work_reserve(&work, &scene->grid, &sobel, &fault) == OK);
    CHECK(weight_work_reserve(&work, &scene->grid, &morph1, &fault) == OK);
    mem_allows = NULL;
    CHECK(work.bytes == before.bytes && work.capacity == before.capacity);
    CHECK(weight_work_reserve(&work, &scene->grid, &gauss1, &fault) == OK);
}
