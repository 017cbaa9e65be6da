/* SPDX-License-Identifier: MIT */
#include "show/label_area.h"

#include <math.h>
#include <string.h>

enum {
    NORMALS_A_SIDE = 8, /* of a face of a cube in which normals end */
    TURNS = 4,          /* edges across each normal */
};

static const double edge_voxels = 10; /* edges are as many as of a box of so many steps */
static const double axis_share = 0.1; /* planes and edges along each axis, of all normals */
static const double ridge = 1e-4;     /* a solution that other spacings do not turn over */

/* The sum of squares to be least: the normal equations, of kinds 1 and more. */
struct squares {
    double pair_mm[PAIR_KINDS][4][3]; /* ways of a kind: of each two opposite ones, one */
    unsigned pairs[PAIR_KINDS];
    double voxel_mm3, step_mm;
    double matrix[PAIR_KINDS][PAIR_KINDS], right[PAIR_KINDS];
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void make_long(double v[3], double length)
{
    const double factor = length / sqrt(dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] *= factor;
}

/* Steps 0..2 along each axis, with each choice of signs that gives another pair. */
static void list_pairs(struct squares *s, double step_mm[3][3])
{
    for (int kind = 1; kind < PAIR_KINDS; kind++) {
        const int steps[3] = {kind % 3, kind / 3 % 3, kind / 9};
        const int last = steps[2] ? 2 : steps[1] ? 1 : 0;
        for (int signs = 0; signs < 8; signs++) {
            bool is_new = !(signs >> last);
            for (int a = 0; a < 3; a++)
                is_new &= steps[a] || !(signs >> a & 1);
            double *pair = s->pair_mm[kind][s->pairs[kind]];
            for (int a = 0; a < 3 && is_new; a++)
                for (int w = 0; w < 3; w++)
                    pair[w] += (signs >> a & 1 ? -1 : 1) * steps[a] * step_mm[a][w];
            s->pairs[kind] += is_new;
        }
    }
}

/* The weighted sum of `row` is to be `right`. */
static void add_equation(struct squares *s, const double row[PAIR_KINDS], double right,
                         double share)
{
    for (int i = 1; i < PAIR_KINDS; i++) {
        s->right[i] += share * row[i] * right;
        for (int j = 1; j < PAIR_KINDS; j++)
            s->matrix[i][j] += share * row[i] * row[j];
    }
}

/* A plane of 1 mm2. */
static void add_plane(struct squares *s, const double normal[3], double share)
{
    double row[PAIR_KINDS] = {0};
    for (int kind = 1; kind < PAIR_KINDS; kind++)
        for (unsigned i = 0; i < s->pairs[kind]; i++)
            row[kind] += fabs(dot(normal, s->pair_mm[kind][i])) / s->voxel_mm3;
    add_equation(s, row, 1, share);
}

/* Edges between two planes across each other, for each mm2 of a cube: of four that are parallel,
 * each pair misses two. */
static void add_edge(struct squares *s, const double n[3], const double m[3], double share)
{
    const double edge_mm = 1 / (edge_voxels * s->step_mm);
    double row[PAIR_KINDS] = {0};
    for (int kind = 1; kind < PAIR_KINDS; kind++)
        for (unsigned i = 0; i < s->pairs[kind]; i++)
            row[kind] += fabs(dot(n, s->pair_mm[kind][i]) * dot(m, s->pair_mm[kind][i])) * edge_mm /
                         s->voxel_mm3;
    add_equation(s, row, 0, share);
}

/* A normal, and edges of planes that it lies along. */
static void add_normal(struct squares *s, const double normal[3], double share)
{
    double across[3] = {-normal[1], normal[0], 0}, third[3];
    make_long(across, 1);
    cross(third, normal, across);
    add_plane(s, normal, share);
    for (int turn = 0; turn < TURNS; turn++) {
        const double t = (turn + 0.5) / TURNS;
        double n[3], m[3];
        for (int a = 0; a < 3; a++)
            n[a] = (1 - t) * across[a] + t * third[a];
        make_long(n, 1);
        cross(m, normal, n);
        add_edge(s, n, m, share / TURNS);
    }
}

/* In all directions, by the solid angles around them: of as many octants as kinds are not the same
 * in, 1 or, of sheared axes, 4. Returns the sum of their shares. */
static double add_normals(struct squares *s, int octants)
{
    double sum = 0;
    for (int n = 0; n < octants * 3 * NORMALS_A_SIDE * NORMALS_A_SIDE; n++) {
        const int octant = n % octants, a = n / octants % 3, side = n / octants / 3;
        double normal[3];
        normal[a] = 1;
        normal[(a + 1) % 3] = (side / NORMALS_A_SIDE + 0.5) / NORMALS_A_SIDE;
        normal[(a + 2) % 3] = (side % NORMALS_A_SIDE + 0.5) / NORMALS_A_SIDE;
        const double share = pow(dot(normal, normal), -1.5);
        normal[0] *= octant & 1 ? -1 : 1;
        normal[1] *= octant & 2 ? -1 : 1;
        make_long(normal, 1);
        add_normal(s, normal, share);
        sum += share;
    }
    return sum;
}

/* By elimination: the matrix is positive definite, so no pivot need be looked for. */
static void solve(struct squares *s, double weight[PAIR_KINDS])
{
    for (int i = 1; i < PAIR_KINDS; i++)
        s->matrix[i][i] *= 1 + ridge;
    for (int i = 1; i < PAIR_KINDS; i++)
        for (int k = i + 1; k < PAIR_KINDS; k++) {
            const double factor = s->matrix[k][i] / s->matrix[i][i];
            for (int j = i; j < PAIR_KINDS; j++)
                s->matrix[k][j] -= factor * s->matrix[i][j];
            s->right[k] -= factor * s->right[i];
        }
    for (int i = PAIR_KINDS - 1; i > 0; i--) {
        double rest = s->right[i];
        for (int j = i + 1; j < PAIR_KINDS; j++)
            rest -= s->matrix[i][j] * weight[j];
        weight[i] = rest / s->matrix[i][i];
    }
    weight[0] = 0;
}

void area_weights_init(struct area_weights *weights, const struct geometry *geometry)
{
    const double fill = geometry_fill(geometry);
    struct squares s = {.voxel_mm3 = fill, .step_mm = 1};
    uint32_t step[3];
    double step_mm[3][3];
    label_pairs_step(step, geometry->spacing_nm);
    geometry_steps(geometry, step_mm);
    for (int a = 0; a < 3; a++) {
        for (int w = 0; w < 3; w++)
            step_mm[a][w] *= step[a];
        s.voxel_mm3 *= geometry->spacing_nm[a] / 1e6;
        s.step_mm *= step[a] * (geometry->spacing_nm[a] / 1e6);
    }
    s.step_mm = cbrt(s.step_mm);
    list_pairs(&s, step_mm);
    /* The planes that two axes lie in. */
    const double share = axis_share * add_normals(&s, fill < 1 ? 4 : 1);
    double normal[3][3];
    for (int a = 0; a < 3; a++) {
        cross(normal[a], step_mm[(a + 1) % 3], step_mm[(a + 2) % 3]);
        make_long(normal[a], 1);
    }
    for (int a = 0; a < 3; a++) {
        add_plane(&s, normal[a], share);
        add_edge(&s, normal[a], normal[(a + 1) % 3], share);
    }
    solve(&s, weights->mm2);
}

/* A pair of one label and another is counted from both ends: of all voxels, so many ways lead to
 * another label. */
double label_area_mm2(const struct area_weights *weights, const uint64_t pairs[PAIR_KINDS])
{
    double mm2 = 0;
    for (int kind = 1; kind < PAIR_KINDS; kind++) {
        const int axes = (kind % 3 > 0) + (kind / 3 % 3 > 0) + (kind / 9 > 0);
        const uint64_t ways = UINT64_C(1) << axes;
        mm2 += weights->mm2[kind] * (double)(ways * pairs[0] - 2 * pairs[kind]);
    }
    return mm2;
}
