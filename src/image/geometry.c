/* SPDX-License-Identifier: MIT */
#include "image/geometry.h"

#include <math.h>
#include <string.h>

#include "base/choice.h"

/* Below this volume the unit axes span almost no space: the matrix cannot be inverted. A shear of
 * 89.9 degrees still has 1.7e-3. */
static const double VOLUME_LEAST = 1e-5;

/* Files hold single precision: matches closer than this are equal, so that a scene turned by 45
 * degrees has the same axes again after it was written and read. */
static const double TIE = 1e-6;

double geometry_step_mm(const struct geometry *geometry, int axis)
{
    const double x = geometry->to_mm[0][axis], y = geometry->to_mm[1][axis];
    const double z = geometry->to_mm[2][axis];
    return sqrt(x * x + y * y + z * z);
}

/* Compute the axes as unit vectors; false if one has no direction. */
static bool unit_axes(double axis[3][3], const struct geometry *geometry)
{
    for (int a = 0; a < 3; a++) {
        const double length = geometry_step_mm(geometry, a);
        if (!isfinite(length) || !(length > 0))
            return false;
        for (int w = 0; w < 3; w++) {
            axis[a][w] = geometry->to_mm[w][a] / length;
            if (!isfinite(geometry->to_mm[w][3]))
                return false;
        }
    }
    return true;
}

static double volume(double m[3][3])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

bool geometry_place(struct geometry *geometry, const double to_mm[3][4],
                    enum orientation orientation)
{
    static const int8_t permutation[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                             {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    struct geometry placed = *geometry;
    double axis[3][3];
    double best = -1;
    memcpy(placed.to_mm, to_mm, sizeof placed.to_mm);
    placed.orientation = orientation;
    if (!unit_axes(axis, &placed) || !(fabs(volume(axis)) >= VOLUME_LEAST))
        return false;
    for (int i = 0; i < 6; i++) {
        const int8_t *to = permutation[i];
        double match = fabs(axis[0][to[0]]) + fabs(axis[1][to[1]]) + fabs(axis[2][to[2]]);
        if (match > best + TIE) {
            best = match;
            memcpy(placed.world_axis, to, sizeof placed.world_axis);
        }
    }
    for (int a = 0; a < 3; a++)
        placed.world_sign[a] = axis[a][placed.world_axis[a]] < 0 ? -1 : 1;
    *geometry = placed;
    return true;
}

int geometry_digits(const struct geometry *geometry)
{
    const double last = fabs(geometry_value(geometry, UINT16_MAX));
    const double most = last > fabs(geometry->intercept) ? last : fabs(geometry->intercept);
    const double steps = geometry->slope != 0 ? most / fabs(geometry->slope) : 1;
    int digits = 6;
    for (double power = 1e6; digits < 17 && power <= steps; power *= 10)
        digits++;
    return digits;
}

/* Set voxel axes along world axes, starting at the origin. */
static void place_along(struct geometry *geometry, const int8_t axis[3], const int8_t sign[3],
                        const double spacing_mm[3])
{
    memset(geometry->to_mm, 0, sizeof geometry->to_mm);
    for (int a = 0; a < 3; a++) {
        geometry->world_axis[a] = axis[a];
        geometry->world_sign[a] = sign[a];
        geometry->to_mm[axis[a]][a] = sign[a] * spacing_mm[a];
    }
}

void geometry_place_plain(struct geometry *geometry, const double spacing_mm[3])
{
    static const int8_t axis[3] = {0, 1, 2}, sign[3] = {1, 1, 1};
    place_along(geometry, axis, sign, spacing_mm);
    geometry->orientation = ORIENTATION_UNKNOWN;
}

void geometry_place_spaced(struct geometry *geometry)
{
    const uint32_t *nm = geometry->spacing_nm;
    geometry_place_plain(geometry, (const double[3]){nm[0] / 1e6, nm[1] / 1e6, nm[2] / 1e6});
}

/* Round a spacing to whole nanometres. */
static bool round_spacing(uint32_t *nm, double spacing_nm)
{
    const double whole = floor(spacing_nm + 0.5);
    const bool is_distance = whole >= 1 && whole <= 4e9;
    *nm = is_distance ? (uint32_t)whole : 1000000;
    return is_distance;
}

bool geometry_spacing(uint32_t *nm, double mm)
{
    return round_spacing(nm, mm * 1e6);
}

void geometry_take_form(struct geometry *geometry, enum orientation form)
{
    const struct geometry_form *taken =
        form == ORIENTATION_SFORM ? &geometry->sform : &geometry->qform;
    geometry_place(geometry, (const double(*)[4])taken->to_mm, form);
}

/* For each world axis, the side in its positive direction first. */
static const char side_letters[3][3] = {"RL", "AP", "SI"};

void geometry_axes(char letters[4], const struct geometry *geometry)
{
    for (int a = 0; a < 3; a++)
        letters[a] = side_letters[geometry->world_axis[a]][geometry->world_sign[a] < 0];
    letters[3] = '\0';
}

void geometry_to_lps(const struct geometry *geometry, double to_lps_mm[3][4])
{
    for (int w = 0; w < 3; w++)
        for (int i = 0; i < 4; i++)
            to_lps_mm[w][i] = w < 2 ? 0 - geometry->to_mm[w][i] : geometry->to_mm[w][i];
}

bool geometry_orient(struct geometry *geometry, const char *how)
{
    const int form = choice_find(ORIENTATIONS, how);
    const bool by_s = form == ORIENTATION_SFORM, by_q = form == ORIENTATION_QFORM;
    if (!by_s && !by_q) {
        int8_t axis[3] = {0}, sign[3] = {0};
        double spacing_mm[3];
        unsigned seen = 0;
        if (strlen(how) != 3)
            return false;
        for (int a = 0; a < 3; a++)
            for (int8_t w = 0; w < 3; w++) {
                const char *at = strchr(side_letters[w], how[a] & ~0x20); /* as a capital */
                if (!at || !*at)
                    continue;
                seen |= 1U << w;
                axis[a] = w;
                sign[a] = at == side_letters[w] ? 1 : -1;
            }
        if (seen != 7)
            return false;
        for (int a = 0; a < 3; a++)
            spacing_mm[a] = geometry_step_mm(geometry, a);
        place_along(geometry, axis, sign, spacing_mm);
        geometry->orientation = ORIENTATION_TOLD;
        return true;
    }
    if ((by_s ? geometry->sform : geometry->qform).code <= 0)
        return false;
    geometry_take_form(geometry, (enum orientation)form);
    return true;
}

/* ---- comparison ---- */

/* The cosine of a degree: directions within it count as the same. */
static const double SAME_DIRECTION = 0.99985;

bool geometry_same_directions(const struct geometry *a, const struct geometry *b)
{
    double p[3][3], q[3][3];
    bool same_axes = true, same_lines = true;
    if (!unit_axes(p, a) || !unit_axes(q, b))
        return false;
    for (int i = 0; i < 3; i++) {
        same_axes &= a->world_axis[i] == b->world_axis[i] && a->world_sign[i] == b->world_sign[i];
        same_lines &= p[i][0] * q[i][0] + p[i][1] * q[i][1] + p[i][2] * q[i][2] >= SAME_DIRECTION;
    }
    return (same_axes || same_lines) && (volume(p) > 0) == (volume(q) > 0);
}

bool geometry_is_mirrored(const struct geometry *geometry)
{
    double axis[3][3];
    return unit_axes(axis, geometry) && volume(axis) < 0;
}

double geometry_apart(const struct geometry *a, const struct geometry *b, const uint32_t size[3])
{
    double most = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        double p[3], q[3], square = 0;
        uint32_t place[3];
        for (unsigned i = 0; i < 3; i++)
            place[i] = corner >> i & 1 ? size[i] - 1 : 0;
        geometry_point(a, place, p);
        geometry_point(b, place, q);
        for (int w = 0; w < 3; w++)
            square += (p[w] - q[w]) * (p[w] - q[w]);
        most = sqrt(square) > most ? sqrt(square) : most;
    }
    return most;
}

double geometry_half_voxel(const struct geometry *geometry)
{
    double least = geometry_step_mm(geometry, 0);
    for (int a = 1; a < 3; a++)
        least = fmin(least, geometry_step_mm(geometry, a));
    return least / 2;
}

double geometry_shear(const struct geometry *geometry)
{
    double axis[3][3], most = 0;
    if (!unit_axes(axis, geometry))
        return 0;
    for (int a = 0; a < 3; a++) {
        const double *p = axis[a], *q = axis[(a + 1) % 3];
        const double sine = fabs(p[0] * q[0] + p[1] * q[1] + p[2] * q[2]);
        most = sine > most ? sine : most;
    }
    return asin(most < 1 ? most : 1) * 180 / acos(-1);
}

double geometry_fill(const struct geometry *geometry)
{
    double axis[3][3];
    if (!unit_axes(axis, geometry))
        return 1;
    const double part = floor(fabs(volume(axis)) * 1e9 + 0.5) / 1e9;
    return part < 1 - 1e-6 ? part : 1;
}

void geometry_steps(const struct geometry *geometry, double step_mm[3][3])
{
    double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (geometry_fill(geometry) < 1)
        unit_axes(axis, geometry);
    for (int a = 0; a < 3; a++)
        for (int w = 0; w < 3; w++)
            step_mm[a][w] = axis[a][w] * (geometry->spacing_nm[a] / 1e6);
}

void geometry_along(const struct geometry *geometry, const int64_t direction[3], int64_t along[3])
{
    double axis[3][3];
    unit_axes(axis, geometry);
    for (int a = 0; a < 3; a++) {
        along[a] = 0;
        for (int w = 0; w < 3; w++)
            along[a] += direction[w] * llround(axis[a][w] * geometry->spacing_nm[a]);
    }
}

double geometry_tilt(const struct geometry *geometry)
{
    double axis[3][3], least = 1;
    if (geometry->orientation == ORIENTATION_UNKNOWN || !unit_axes(axis, geometry))
        return 0;
    for (int a = 0; a < 3; a++)
        least = fmin(least, fabs(axis[a][geometry->world_axis[a]]));
    return acos(least) * 180 / acos(-1);
}

static void derive_matrix(double to_mm[3][4], const double first[3], const double step[3])
{
    for (int w = 0; w < 3; w++)
        for (int a = 0; a < 3; a++) {
            to_mm[w][3] += to_mm[w][a] * first[a];
            to_mm[w][a] *= step[a];
        }
}

bool geometry_derive(struct geometry *geometry, const double first[3], const double step[3])
{
    uint32_t spacing_nm[3];
    for (int a = 0; a < 3; a++)
        if (!round_spacing(&spacing_nm[a], geometry->spacing_nm[a] * step[a]))
            return false;
    memcpy(geometry->spacing_nm, spacing_nm, sizeof spacing_nm);
    geometry->fields.given = false;
    derive_matrix(geometry->to_mm, first, step);
    derive_matrix(geometry->sform.to_mm, first, step);
    derive_matrix(geometry->qform.to_mm, first, step);
    return true;
}

void geometry_point(const struct geometry *geometry, const uint32_t place[3], double point_mm[3])
{
    for (int w = 0; w < 3; w++) {
        const double *m = geometry->to_mm[w];
        point_mm[w] = m[0] * place[0] + m[1] * place[1] + m[2] * place[2] + m[3];
    }
}

void geometry_solve(const struct geometry *geometry, const double b[3], double out[3])
{
    const double(*m)[4] = geometry->to_mm;
    double cofactor[3][3], determinant = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    }
    for (int j = 0; j < 3; j++)
        determinant += m[0][j] * cofactor[0][j];
    for (int j = 0; j < 3; j++)
        out[j] =
            (b[0] * cofactor[0][j] + b[1] * cofactor[1][j] + b[2] * cofactor[2][j]) / determinant;
}

/* Solves to_mm * (i, j, k, 1) = point. */
bool geometry_voxel(const struct geometry *geometry, const double point_mm[3], int64_t place[3])
{
    double b[3], along_axis[3];
    for (int i = 0; i < 3; i++)
        b[i] = point_mm[i] - geometry->to_mm[i][3];
    geometry_solve(geometry, b, along_axis);
    for (int j = 0; j < 3; j++) {
        const double along = floor(along_axis[j] + 0.5);
        if (!(fabs(along) < 1e9))
            return false;
        place[j] = (int64_t)along;
    }
    return true;
}
