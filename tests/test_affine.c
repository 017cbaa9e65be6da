/* SPDX-License-Identifier: MIT */
/* Affine maps, and fits of pairs of places. */
#include <math.h>

#include "apply/affine.h"
#include "tests/check_main.h"

static uint64_t state = 1;

static double between(double low, double high)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(state >> 11) / 0x1p53;
}

/* A random rotation about a random axis by Rodrigues' formula, independent of the fit. */
static struct affine turn_by(double most)
{
    double axis[3], length;
    do {
        for (int i = 0; i < 3; i++)
            axis[i] = between(-1, 1);
        length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    } while (length < 0.1 || length > 1);
    const double angle = between(-most, most), c = cos(angle), s = sin(angle);
    const double x = axis[0] / length, y = axis[1] / length, z = axis[2] / length;
    const double cross[3][3] = {{0, -z, y}, {z, 0, -x}, {-y, x, 0}}, u[3] = {x, y, z};
    struct affine out;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            out.m[i][j] = (i == j) * c + (1 - c) * u[i] * u[j] + s * cross[i][j];
        out.m[i][3] = between(-100, 100);
    }
    return out;
}

static struct affine turn(void)
{
    return turn_by(3.1);
}

static struct affine scaled(struct affine a, double by)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a.m[i][j] *= by;
    return a;
}

static struct affine anything(void)
{
    struct affine out = turn();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.m[i][j] += between(-0.15, 0.15);
    return out;
}

/* Upper bound of the distance, for places with coordinates up to 100 mm. */
static double difference(const struct affine *a, const struct affine *b)
{
    double distance = 0;
    for (int i = 0; i < 3; i++) {
        double apart = fabs(a->m[i][3] - b->m[i][3]);
        for (int j = 0; j < 3; j++)
            apart += 100 * fabs(a->m[i][j] - b->m[i][j]);
        distance = hypot(distance, apart);
    }
    return distance;
}

enum { PLACES = 12 };

/* None of the first four places is in the plane of the others. */
static void scatter(size_t n, double place[][3])
{
    for (size_t p = 0; p < n; p++)
        for (size_t i = 0; i < 3; i++)
            place[p][i] = p < 4 ? between(-10, 10) + (p == i ? 80 : 0) : between(-80, 80);
}

static void carry(const struct affine *a, size_t n, const double from[][3], double to[][3])
{
    for (size_t p = 0; p < n; p++)
        affine_apply(a, from[p], to[p]);
}

static double squares_left(const struct affine *a, size_t n, const double from[][3],
                           const double to[][3])
{
    double sum = 0;
    for (size_t p = 0; p < n; p++) {
        double at[3];
        affine_apply(a, from[p], at);
        for (int i = 0; i < 3; i++)
            sum += (at[i] - to[p][i]) * (at[i] - to[p][i]);
    }
    return sum;
}

#define ROWS(a) (const double(*)[3])(a)

STORY(a_map_and_its_inverse_cancel)
{
    for (int i = 0; i < 1000; i++) {
        const struct affine a = anything(), b = anything();
        struct affine back, both, identity;
        double at[3] = {between(-100, 100), between(-100, 100), between(-100, 100)}, by[3], to[3];
        affine_identity(&identity);
        CHECK(affine_invert(&back, &a));
        affine_compose(&both, &back, &a);
        CHECK(difference(&both, &identity) < 1e-9);
        affine_compose(&both, &b, &a); /* first a */
        affine_apply(&a, at, by);
        affine_apply(&b, by, by);
        affine_apply(&both, at, to);
        for (int k = 0; k < 3; k++)
            CHECK(fabs(to[k] - by[k]) < 1e-9);
        CHECK(fabs(affine_determinant(&both) - affine_determinant(&a) * affine_determinant(&b)) <
              1e-9);
    }
}

STORY(singular_and_infinite_maps_have_no_inverse)
{
    struct affine flat = {{{1, 0, 0, 5}, {0, 1, 0, 6}, {0, 0, 0, 7}}}, out = flat;
    CHECK(!affine_invert(&out, &flat) && out.m[2][3] == 7);
    flat.m[2][2] = NAN;
    CHECK(!affine_invert(&out, &flat) && !affine_is_finite(&flat));
    flat.m[2][2] = INFINITY;
    CHECK(!affine_invert(&out, &flat));
    const struct affine tiny = {{{1e-6, 0, 0, 0}, {0, 1e-6, 0, 0}, {0, 0, 1e-6, 0}}};
    CHECK(affine_invert(&out, &tiny) && fabs(out.m[0][0] - 1e6) < 1e-3);
}

STORY(stretches_are_the_singular_values)
{
    for (int i = 0; i < 200; i++) {
        const double s[3] = {between(1.2, 2), between(0.8, 1.1), between(0.2, 0.7)};
        const struct affine stretch = {{{s[2], 0, 0, 0}, {0, s[0], 0, 0}, {0, 0, -s[1], 0}}};
        const struct affine first = turn(), second = turn();
        struct affine both;
        double out[3];
        affine_compose(&both, &stretch, &first);
        affine_compose(&both, &second, &both);
        affine_stretches(&both, out);
        for (int k = 0; k < 3; k++)
            CHECK(fabs(out[k] - s[k]) < 1e-12);
        CHECK(affine_determinant(&both) < 0);
    }
}

/* Exact pairs reproduce their map, for every kind that includes it. */
STORY(exact_pairs_reproduce_their_map)
{
    for (int i = 0; i < 1000; i++) {
        const size_t n = 4 + (size_t)i % (PLACES - 4);
        double from[PLACES][3], to[PLACES][3], rms = -1;
        struct affine a = turn(), found;
        scatter(n, from);
        carry(&a, n, ROWS(from), to);
        for (int kind = AFFINE_RIGID; kind <= AFFINE_FULL; kind++) {
            CHECK_INT(
                affine_fit(&found, (enum affine_kind)kind, n, ROWS(from), ROWS(to), &rms, NULL),
                OK);
            CHECK(difference(&a, &found) < 1e-7 && rms < 1e-8);
        }
        a = scaled(a, between(0.5, 2));
        carry(&a, n, ROWS(from), to);
        CHECK_INT(affine_fit(&found, AFFINE_SIMILARITY, n, ROWS(from), ROWS(to), &rms, NULL), OK);
        CHECK(difference(&a, &found) < 1e-7 && rms < 1e-8);
        a = anything();
        carry(&a, n, ROWS(from), to);
        CHECK_INT(affine_fit(&found, AFFINE_FULL, n, ROWS(from), ROWS(to), &rms, NULL), OK);
        CHECK(difference(&a, &found) < 1e-6 && rms < 1e-8);
    }
}

/* With marks off by 2 mm, no nearby map of the kind has a smaller residual, and a larger kind has
 * none larger. */
STORY(no_nearby_map_has_a_smaller_residual)
{
    for (int i = 0; i < 300; i++) {
        double from[PLACES][3], to[PLACES][3], rms[3];
        const struct affine a = anything();
        scatter(8, from);
        carry(&a, 8, ROWS(from), to);
        for (int p = 0; p < 8; p++)
            for (int k = 0; k < 3; k++)
                to[p][k] += between(-2, 2);
        for (int kind = AFFINE_RIGID; kind <= AFFINE_FULL; kind++) {
            struct affine found;
            CHECK_INT(affine_fit(&found, (enum affine_kind)kind, 8, ROWS(from), ROWS(to),
                                 &rms[kind], NULL),
                      OK);
            const double least = squares_left(&found, 8, ROWS(from), ROWS(to));
            CHECK(fabs(sqrt(least / 8) - rms[kind]) < 1e-9);
            for (int t = 0; t < 20; t++) {
                struct affine small = turn_by(0.02), other;
                for (int r = 0; r < 3; r++)
                    small.m[r][3] = between(-0.1, 0.1);
                if (kind == AFFINE_SIMILARITY)
                    small = scaled(small, between(0.99, 1.01));
                if (kind == AFFINE_FULL)
                    small.m[t % 3][t / 3 % 3] += between(-0.01, 0.01);
                affine_compose(&other, &found, &small);
                CHECK(squares_left(&other, 8, ROWS(from), ROWS(to)) >= least - 1e-9);
            }
        }
        CHECK(rms[0] >= rms[1] - 1e-9 && rms[1] >= rms[2] - 1e-9);
    }
}

/* Three pairs are in a plane: enough for a rotation, with errors or without. */
STORY(three_pairs_fit_a_rotation_and_no_mirror_image)
{
    for (int i = 0; i < 500; i++) {
        double from[3][3], to[3][3], rms;
        const struct affine a = turn();
        struct affine found;
        scatter(3, from);
        carry(&a, 3, ROWS(from), to);
        if (affine_fit(&found, AFFINE_RIGID, 3, ROWS(from), ROWS(to), &rms, NULL) == OK)
            CHECK(difference(&a, &found) < 1e-5);
        for (int p = 0; p < 3; p++)
            to[p][p] += between(-2, 2);
        if (affine_fit(&found, AFFINE_RIGID, 3, ROWS(from), ROWS(to), &rms, NULL) == OK)
            CHECK(fabs(affine_determinant(&found) - 1) < 1e-12);
    }
}

STORY(places_that_do_not_determine_a_map_are_refused)
{
    const double line[4][3] = {{0, 0, 0}, {10, 10, 0}, {20, 20, 0}, {40, 40.1, 0}};
    const double plane[4][3] = {{0, 0, 0}, {50, 0, 0}, {0, 50, 0}, {40, 40, 0.2}};
    const double solid[4][3] = {{0, 0, 0}, {50, 0, 0}, {0, 50, 0}, {0, 0, 50}};
    const double point[4][3] = {{3, 3, 3}, {3, 3, 3}, {3, 3, 3}, {3, 3, 3}};
    double mirrored[4][3], broken[4][3], rms = 7;
    struct affine out = {{{42}}};
    struct fault fault;
    memcpy(broken, solid, sizeof broken);
    broken[2][1] = NAN;
    for (int p = 0; p < 4; p++)
        for (int k = 0; k < 3; k++)
            mirrored[p][k] = k == 0 ? -solid[p][k] : solid[p][k];
    const struct {
        enum affine_kind kind;
        size_t n;
        const double (*from)[3], (*to)[3];
        const char *words;
    } cases[] = {{AFFINE_RIGID, 2, solid, solid, "2 pairs of places; a rigid map needs 3 or more"},
                 {AFFINE_FULL, 3, solid, solid, "affine map needs 4"},
                 {AFFINE_RIGID, 4, line, solid, "on one line"},
                 {AFFINE_SIMILARITY, 4, solid, line, "on one line"},
                 {AFFINE_RIGID, 4, point, solid, "on one line"},
                 {AFFINE_RIGID, 4, ROWS(broken), solid, "on one line"},
                 {AFFINE_FULL, 4, plane, solid, "in one plane"},
                 {AFFINE_FULL, 4, solid, plane, "in one plane"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        CHECK_INT(
            affine_fit(&out, cases[i].kind, cases[i].n, cases[i].from, cases[i].to, &rms, &fault),
            ERR_INPUT);
        CHECK_HAS(fault.text, cases[i].words);
    }
    for (int kind = AFFINE_RIGID; kind <= AFFINE_FULL; kind++) {
        CHECK_INT(affine_fit(&out, (enum affine_kind)kind, 4, solid, ROWS(mirrored), &rms, &fault),
                  ERR_INPUT);
        CHECK_HAS(fault.text, "left and right");
    }
    CHECK(out.m[0][0] == 42 && rms == 7);
    CHECK_INT(affine_fit(&out, AFFINE_RIGID, 4, plane, plane, &rms, &fault), OK);
}
