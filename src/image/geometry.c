#include "image/geometry.h"

#include <math.h>
#include <string.h>

/* Below this volume the axes, made unit vectors, span next to nothing: the world cannot be turned
 * back into voxels. A shear of 89.9 degrees still has 1.7e-3. */
static const double VOLUME_LEAST = 1e-5;

/* Files hold single precision: matches closer than this are equal, so that a scene turned by 45
 * degrees has the same axes again after it was written and read. */
static const double TIE = 1e-6;

/* The columns of `to_mm` as unit vectors; false where one has no direction. */
static bool unit_axes(double axis[3][3], const double to_mm[3][4])
{
    for (int a = 0; a < 3; a++) {
        const double *const row[3] = {to_mm[0], to_mm[1], to_mm[2]};
        double length = sqrt(row[0][a] * row[0][a] + row[1][a] * row[1][a] + row[2][a] * row[2][a]);
        if (!isfinite(length) || !(length > 0))
            return false;
        for (int w = 0; w < 3; w++) {
            axis[a][w] = row[w][a] / length;
            if (!isfinite(row[w][3]))
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

bool geometry_place(struct geometry *geometry, const double to_mm[3][4])
{
    static const int8_t permutation[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                             {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    double axis[3][3];
    double best = -1;
    if (!unit_axes(axis, to_mm) || !(fabs(volume(axis)) >= VOLUME_LEAST))
        return false;
    for (int i = 0; i < 6; i++) {
        const int8_t *to = permutation[i];
        double match = fabs(axis[0][to[0]]) + fabs(axis[1][to[1]]) + fabs(axis[2][to[2]]);
        if (match > best + TIE) {
            best = match;
            memcpy(geometry->world_axis, to, sizeof geometry->world_axis);
        }
    }
    for (int a = 0; a < 3; a++)
        geometry->world_sign[a] = axis[a][geometry->world_axis[a]] < 0 ? -1 : 1;
    memcpy(geometry->to_mm, to_mm, sizeof geometry->to_mm);
    return true;
}

void geometry_place_plain(struct geometry *geometry, const double spacing_mm[3])
{
    memset(geometry->to_mm, 0, sizeof geometry->to_mm);
    for (int a = 0; a < 3; a++) {
        geometry->to_mm[a][a] = spacing_mm[a];
        geometry->world_axis[a] = (int8_t)a;
        geometry->world_sign[a] = 1;
    }
}

void geometry_axes(char letters[4], const struct geometry *geometry)
{
    static const char side[3][2] = {{'R', 'L'}, {'A', 'P'}, {'S', 'I'}};
    for (int a = 0; a < 3; a++)
        letters[a] = side[geometry->world_axis[a]][geometry->world_sign[a] < 0];
    letters[3] = '\0';
}

void geometry_to_lps(const struct geometry *geometry, double to_lps_mm[3][4])
{
    for (int w = 0; w < 3; w++)
        for (int i = 0; i < 4; i++)
            to_lps_mm[w][i] = w < 2 ? 0 - geometry->to_mm[w][i] : geometry->to_mm[w][i];
}

void geometry_point(const struct geometry *geometry, const uint32_t place[3], double point_mm[3])
{
    for (int w = 0; w < 3; w++) {
        const double *m = geometry->to_mm[w];
        point_mm[w] = m[0] * place[0] + m[1] * place[1] + m[2] * place[2] + m[3];
    }
}

/* Solves to_mm * (i, j, k, 1) = point. */
bool geometry_voxel(const struct geometry *geometry, const double point_mm[3], int64_t place[3])
{
    const double(*m)[4] = geometry->to_mm;
    double b[3], cofactor[3][3], determinant = 0;
    for (int i = 0; i < 3; i++) {
        b[i] = point_mm[i] - m[i][3];
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    }
    for (int j = 0; j < 3; j++)
        determinant += m[0][j] * cofactor[0][j];
    for (int j = 0; j < 3; j++) {
        double along = b[0] * cofactor[0][j] + b[1] * cofactor[1][j] + b[2] * cofactor[2][j];
        along = floor(along / determinant + 0.5);
        if (!(fabs(along) < 1e9))
            return false;
        place[j] = (int64_t)along;
    }
    return true;
}
