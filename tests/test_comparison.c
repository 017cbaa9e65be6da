/* SPDX-License-Identifier: MIT */
/* Distances and comparisons: small cases worked by hand, and random ones beside a plain slow
 * computation, which looks from each voxel at each other one. */
#include <math.h>

#include "engine/distance.h"
#include "show/comparison.h"
#include "tests/check_main.h"
#include "tests/stopping.h"

static uint64_t seed = 1;

/* ---- distances ---- */

static uint64_t squared_between(const struct distance_scale *scale, const uint32_t size[3],
                                size_t i, size_t k)
{
    uint64_t sum = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t d = (int64_t)(i % size[a]) - (int64_t)(k % size[a]);
        sum += (uint64_t)(d * d) * scale->step[a] * scale->step[a];
        i /= size[a];
        k /= size[a];
    }
    return sum;
}

static uint64_t nearest(const uint64_t *from, const struct distance_scale *scale,
                        const uint32_t size[3], size_t i)
{
    const size_t voxels = (size_t)size[0] * size[1] * size[2];
    uint64_t least = DISTANCE_NONE;
    for (size_t k = 0; k < voxels; k++) {
        const uint64_t is = from[k] == 0 ? squared_between(scale, size, i, k) : DISTANCE_NONE;
        least = is < least ? is : least;
    }
    return least;
}

static void check_distances(const uint32_t size[3], const uint32_t spacing_nm[3], uint32_t chance,
                            struct team *team)
{
    const size_t voxels = (size_t)size[0] * size[1] * size[2];
    const struct distance_scale scale = distance_scale_of(spacing_nm, size);
    OWNED(mem_release)
    uint64_t *from = mem_array(voxels, sizeof *from), *squared = mem_array(voxels, sizeof *from);
    for (size_t i = 0; i < voxels; i++)
        squared[i] = from[i] = check_below(&seed, chance) ? DISTANCE_NONE : 0;
    CHECK(distance_spread(squared, size, &scale, team, NULL, NULL) == OK);
    for (size_t i = 0; i < voxels; i++)
        if (!CHECK(squared[i] == nearest(from, &scale, size, i)))
            break;
}

STORY(distances_are_those_to_the_nearest_voxel)
{
    OWNED(team_drop) struct team *team;
    CHECK(team_new(&team, 3, NULL) == OK);
    for (int i = 0; i < 400; i++) {
        const uint32_t size[3] = {1 + check_below(&seed, 13), 1 + check_below(&seed, 11),
                                  1 + check_below(&seed, 9)};
        uint32_t spacing_nm[3];
        for (int a = 0; a < 3; a++)
            spacing_nm[a] = i % 3 ? 100000 * (1 + check_below(&seed, 40)) : 1000000;
        if (i % 3 == 2)
            spacing_nm[i % 2] = 957031;
        check_distances(size, spacing_nm, 2 + check_below(&seed, 60), i % 2 ? team : NULL);
    }
}

STORY(units_divide_the_spacing_as_long_as_squares_fit)
{
    const uint32_t head[3] = {181, 217, 181}, body[3] = {512, 512, 800}, most[3] = {65534, 1, 1};
    struct distance_scale s =
        distance_scale_of((const uint32_t[]){1000000, 1000000, 1000000}, head);
    CHECK_INT(s.unit_nm, 1000000);
    CHECK_INT(s.step[0], 1);
    s = distance_scale_of((const uint32_t[]){500000, 750000, 3000000}, body);
    CHECK_INT(s.unit_nm, 250000);
    CHECK_INT(s.step[2], 12);
    s = distance_scale_of((const uint32_t[]){957031, 957031, 2000000}, body);
    CHECK_INT(s.unit_nm, 2); /* 1.6 m, in the 10^9 units that fit */
    CHECK_INT(s.step[0], 478516);
    s = distance_scale_of((const uint32_t[]){UINT32_MAX, 1, 1}, most);
    CHECK((uint64_t)s.step[0] * 65533 <= 1 << 30 && s.step[1] == 1 && s.step[2] == 1);
    check_distances((const uint32_t[]){300, 1, 2}, (const uint32_t[]){UINT32_MAX, 7, 1}, 40, NULL);
}

/* ---- contours ---- */

STORY(a_contour_is_what_touches_other_voxels_of_the_scene)
{
    enum { SIDE = 5, VOXELS = SIDE * SIDE * SIDE };
    uint8_t set[VOXELS], contour[VOXELS], room[VOXELS];
    struct contour_box box = {{SIDE, SIDE, SIDE}, {{true, false}, {false, false}, {false, false}}};
    memset(set, 3, sizeof set);
    set[0] = 1; /* of two sets, one has all voxels */
    contour_find(contour, set, room, &box, NULL);
    size_t first = 0, second = 0;
    for (size_t i = 0; i < VOXELS; i++) {
        first += contour[i] & 1;
        second += contour[i] >> 1 & 1;
    }
    CHECK_INT(first, VOXELS - 3 * 3 * 4);          /* at x = 0 the scene ends: no contour */
    CHECK_INT(second, VOXELS - 3 * 3 * 4 - 1 + 2); /* without that voxel, which two touch */
}

/* ---- comparisons ---- */

/* Both of one label, in a row of voxels. The result is valid until the next one. */
static const struct comparison *compare_rows(const char *a, const char *b, uint32_t spacing_nm)
{
    struct compared compared = {.size = {(uint32_t)strlen(a), 1, 1},
                                .spacing_nm = {spacing_nm, spacing_nm, spacing_nm}};
    static struct comparison comparison;
    for (int side = 0; side < 2; side++) {
        compared.label[side] = mem_array(strlen(a), 1);
        for (size_t i = 0; a[i]; i++)
            compared.label[side][i] = (uint8_t)((side ? b : a)[i] - '0');
    }
    CHECK(comparison_make(&comparison, &compared, NULL, NULL, NULL) == OK);
    free(compared.label[0]);
    free(compared.label[1]);
    return &comparison;
}

static bool is_near(double is, double expected)
{
    return fabs(is - expected) <= 1e-12 * fabs(expected);
}

STORY(rows_of_voxels_are_measured_as_worked_out_by_hand)
{
    /* Contours: A at 2 and 4, B at 4 and 7. */
    const struct comparison *c = compare_rows("0011100000", "0000111100", 1500000);
    const struct label_distances *d = &c->distance[1];
    const struct overlap_counts counts = overlap_counts_of(&c->overlap, 1);
    CHECK_INT(c->labels, 1);
    CHECK(counts.a == 3 && counts.b == 4 && counts.both == 1);
    CHECK(d->has_hausdorff && d->has_surfaces);
    CHECK(is_near(d->hausdorff_mm, 3 * 1.5)); /* from 7 to 4; from 2 to 4 it is less */
    CHECK_INT(d->farthest[0], 7);
    CHECK(is_near(d->directed_mean_mm[0], (2 + 0) / 2.0 * 1.5));
    CHECK(is_near(d->directed_mean_mm[1], (0 + 3) / 2.0 * 1.5));
    CHECK(is_near(d->mean_mm, (2 + 0 + 0 + 3) / 4.0 * 1.5));
    CHECK(is_near(d->directed_percentile_95_mm[0], 0.95 * 2 * 1.5)); /* 0 and 2 */
    CHECK(is_near(d->percentile_95_mm, 0.95 * 3 * 1.5) && is_near(d->most_mm, 3 * 1.5));
    CHECK(memcmp(d, &c->distance[0], sizeof *d) == 0); /* there is no other label */
}

STORY(sets_may_agree_more_than_their_surfaces)
{
    const struct comparison *c = compare_rows("0111011110", "0111111110", 1000000);
    CHECK(is_near(c->distance[1].hausdorff_mm, 1)); /* from 4, which A has not */
    CHECK(is_near(c->distance[1].most_mm, 3));      /* from 5, a surface of A, to 8, one of B */
}

STORY(what_is_not_there_has_no_distance)
{
    const struct comparison *c = compare_rows("0110030000", "0110000400", 1000000);
    CHECK_INT(c->labels, 3);
    CHECK(comparison_has(c, 3) && comparison_has(c, 4) && !comparison_has(c, 2));
    CHECK(c->distance[1].has_hausdorff && c->distance[1].hausdorff_mm == 0);
    CHECK(!c->distance[3].has_hausdorff && !c->distance[3].has_surfaces);
    CHECK(!c->distance[4].has_hausdorff);
    CHECK(is_near(c->distance[0].hausdorff_mm, 2)); /* all objects: from 5 to 7 */
    const struct overlap_counts all = overlap_counts_of(&c->overlap, 0);
    CHECK(all.a == 3 && all.b == 3 && all.both == 2);
    c = compare_rows("0000", "0000", 1000000);
    CHECK(c->labels == 0 && !c->distance[0].has_hausdorff);
    c = compare_rows("1111", "0100", 1000000); /* all of the scene has no contour */
    CHECK(c->distance[1].has_hausdorff && is_near(c->distance[1].hausdorff_mm, 2));
    CHECK(!c->distance[1].has_surfaces);
    c = compare_rows("0022", "0011", 1000000); /* another label is no agreement, and the same set */
    CHECK(overlap_counts_of(&c->overlap, 0).both == 0);
    CHECK(c->distance[0].has_hausdorff && c->distance[0].hausdorff_mm == 0);
}

/* ---- beside a slow computation ---- */

struct slow {
    const struct compared *c;
    size_t voxels;
    unsigned label;
};

static bool is_in(const struct slow *s, int side, size_t i)
{
    const uint8_t is = s->c->label[side][i];
    return s->label ? is == s->label : is > 0;
}

static bool on_contour(const struct slow *s, int side, size_t i)
{
    const uint32_t *n = s->c->size;
    const int64_t x = (int64_t)(i % n[0]), y = (int64_t)(i / n[0] % n[1]);
    const int64_t z = (int64_t)(i / n[0] / n[1]);
    if (!is_in(s, side, i))
        return false;
    for (int64_t v = z - 1; v <= z + 1; v++)
        for (int64_t u = y - 1; u <= y + 1; u++)
            for (int64_t t = x - 1; t <= x + 1; t++)
                if (t >= 0 && u >= 0 && v >= 0 && t < n[0] && u < n[1] && v < n[2] &&
                    !is_in(s, side, (size_t)(t + n[0] * (u + n[1] * v))))
                    return true;
    return false;
}

/* From a voxel to the nearest of a set or contour. */
static double slow_distance(const struct slow *s, size_t i, int side, bool contour)
{
    const uint32_t *n = s->c->size, *nm = s->c->spacing_nm;
    double least = INFINITY;
    for (size_t k = 0; k < s->voxels; k++) {
        if (contour ? !on_contour(s, side, k) : !is_in(s, side, k))
            continue;
        const double x = ((double)(i % n[0]) - (double)(k % n[0])) * nm[0] / 1e6;
        const double y = ((double)(i / n[0] % n[1]) - (double)(k / n[0] % n[1])) * nm[1] / 1e6;
        const double z = ((double)(i / n[0] / n[1]) - (double)(k / n[0] / n[1])) * nm[2] / 1e6;
        least = fmin(least, sqrt(x * x + y * y + z * z));
    }
    return least;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void check_label(const struct slow *s, const struct label_distances *d)
{
    OWNED(mem_release) double *surface = mem_array(s->voxels, sizeof *surface);
    double hausdorff = 0, sum = 0, percentile = 0;
    size_t count = 0;
    bool has_surfaces = true;
    for (int side = 0; side < 2; side++) {
        size_t n = 0;
        for (size_t i = 0; i < s->voxels; i++) {
            if (is_in(s, side, i))
                hausdorff = fmax(hausdorff, slow_distance(s, i, !side, false));
            if (on_contour(s, side, i))
                surface[n++] = slow_distance(s, i, !side, true);
        }
        qsort(surface, n, sizeof *surface, compare_doubles);
        double one = 0;
        for (size_t i = 0; i < n; i++)
            one += surface[i];
        has_surfaces = has_surfaces && n && surface[n - 1] < INFINITY;
        if (n && has_surfaces) {
            const double rank = 0.95 * (double)(n - 1), low = surface[(size_t)rank];
            const double high = surface[(size_t)rank + ((size_t)rank + 1 < n)];
            percentile = fmax(percentile, low + (high - low) * (rank - floor(rank)));
            CHECK(fabs(d->directed_mean_mm[side] - one / (double)n) < 1e-9);
        }
        sum += one;
        count += n;
    }
    CHECK(d->has_hausdorff && fabs(d->hausdorff_mm - hausdorff) < 1e-9);
    if (CHECK(d->has_surfaces == has_surfaces) && has_surfaces) {
        CHECK(fabs(d->mean_mm - sum / (double)count) < 1e-9);
        CHECK(fabs(d->percentile_95_mm - percentile) < 1e-9);
    }
}

/* Boxes of random labels, of which B has some moved. */
static void paint(const struct compared *c)
{
    const uint32_t *n = c->size;
    memset(c->label[0], 0, (size_t)n[0] * n[1] * n[2]);
    memset(c->label[1], 0, (size_t)n[0] * n[1] * n[2]);
    for (int i = 0; i < 6; i++) {
        const uint8_t label = (uint8_t)(1 + check_below(&seed, 3));
        uint32_t from[3], to[3];
        for (int a = 0; a < 3; a++) {
            from[a] = check_below(&seed, n[a]);
            to[a] = from[a] + check_below(&seed, n[a] - from[a]);
        }
        const bool in_a = check_below(&seed, 4), in_b = check_below(&seed, 4);
        for (uint32_t z = from[2]; z <= to[2]; z++)
            for (uint32_t y = from[1]; y <= to[1]; y++)
                for (uint32_t x = from[0]; x <= to[0]; x++) {
                    const size_t at = x + n[0] * (y + (size_t)n[1] * z);
                    c->label[0][at] = in_a ? label : c->label[0][at];
                    c->label[1][at] = in_b ? label : c->label[1][at];
                }
    }
}

STORY(random_labels_are_as_far_apart_as_a_slow_computation_finds)
{
    static struct comparison comparison;
    OWNED(team_drop) struct team *team;
    CHECK(team_new(&team, 2, NULL) == OK);
    for (int i = 0; i < 60; i++) {
        struct compared c = {.size = {2 + check_below(&seed, 7), 2 + check_below(&seed, 7),
                                      2 + check_below(&seed, 6)},
                             .spacing_nm = {1000000, 1000000, 1000000}};
        if (i % 2)
            memcpy(c.spacing_nm, (const uint32_t[]){957031, 500000, 3300000}, sizeof c.spacing_nm);
        struct slow slow = {&c, (size_t)c.size[0] * c.size[1] * c.size[2], 0};
        c.label[0] = mem_array(slow.voxels, 1);
        c.label[1] = mem_array(slow.voxels, 1);
        paint(&c);
        CHECK(comparison_make(&comparison, &c, team, NULL, NULL) == OK);
        for (slow.label = 0; slow.label < 4; slow.label++) {
            const struct overlap_counts counts = overlap_counts_of(&comparison.overlap, slow.label);
            CHECK(comparison.distance[slow.label].has_hausdorff == (counts.a && counts.b));
            if (counts.a && counts.b)
                check_label(&slow, &comparison.distance[slow.label]);
        }
        free(c.label[0]);
        free(c.label[1]);
    }
}

/* ---- stopped ---- */

STORY(a_stop_is_heard_wherever_it_comes)
{
    static struct comparison comparison;
    struct compared c = {.size = {9, 8, 7}, .spacing_nm = {1000000, 1000000, 1000000}};
    c.label[0] = mem_array(9 * 8 * 7, 1);
    c.label[1] = mem_array(9 * 8 * 7, 1);
    paint(&c);
    enum err err = ERR_CANCELLED;
    int polls = 0;
    for (; err == ERR_CANCELLED && polls < 100000; polls++) {
        int looks = polls;
        struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
        err = comparison_make(&comparison, &c, NULL, &watch, NULL);
    }
    CHECK(err == OK && polls > 1000);
    free(c.label[0]);
    free(c.label[1]);
}

/* ---- classes ---- */

enum { BOX = 9 };

static uint8_t class_at(const uint8_t *class, const struct grid *grid, uint32_t x, uint32_t y,
                        uint32_t z)
{
    return class[grid_cell(grid, x, y, z)];
}

/* A is a cube of 5 around B, a cube of 3, whose contour is all but its middle: up to 2 mm, and with
 * voxels of 2 mm along x. */
STORY(classes_are_signed_distances_to_the_contour_of_b)
{
    static uint8_t a[BOX * BOX * BOX], b[BOX * BOX * BOX];
    struct compared c = {{BOX, BOX, BOX}, {1000000, 1000000, 1000000}, {a, b}};
    struct grid grid;
    CHECK(grid_init(&grid, c.size, NULL) == OK);
    OWNED(mem_release) uint8_t *class = mem_new(grid.cells);
    for (int i = 0; i < BOX * BOX * BOX; i++) {
        const int at[3] = {i % BOX, i / BOX % BOX, i / BOX / BOX};
        bool in_a = true, in_b = true;
        for (int k = 0; k < 3; k++) {
            in_a = in_a && at[k] >= 2 && at[k] <= 6;
            in_b = in_b && at[k] >= 3 && at[k] <= 5;
        }
        a[i] = in_a * 7; /* whichever label: objects are one */
        b[i] = in_b;
    }
    CHECK(comparison_classify(class, &grid, &c, 2, NULL, NULL, NULL) == OK);
    CHECK_INT(class_at(class, &grid, 1, 4, 4), 0);
    CHECK_INT(class_at(class, &grid, 2, 4, 4), 128 + 64);  /* 63.5 steps outside */
    CHECK_INT(class_at(class, &grid, 6, 6, 6), 128 + 110); /* 1.73 mm */
    CHECK_INT(class_at(class, &grid, 3, 4, 4), 128);
    CHECK_INT(class_at(class, &grid, 4, 4, 4), 128 - 64);
    c.spacing_nm[0] = 2000000;
    CHECK(comparison_classify(class, &grid, &c, 1.5, NULL, NULL, NULL) == OK);
    CHECK_INT(class_at(class, &grid, 2, 4, 4), 255); /* no more than all steps */
    CHECK_INT(class_at(class, &grid, 4, 2, 4), 128 + 85);
    c.label[0] = b, c.label[1] = a; /* too small now */
    memset(class, 0, grid.cells);
    CHECK(comparison_classify(class, &grid, &c, 1.5, NULL, NULL, NULL) == OK);
    CHECK_INT(class_at(class, &grid, 4, 3, 4), 128 - 85);
    CHECK_INT(class_at(class, &grid, 2, 4, 4), 0);
}
