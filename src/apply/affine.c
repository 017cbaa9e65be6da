/* SPDX-License-Identifier: MIT */
#include "apply/affine.h"

#include <math.h>
#include <string.h>

void affine_identity(struct affine *out)
{
    *out = (struct affine){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

void affine_apply(const struct affine *a, const double from[3], double to[3])
{
    const double x = from[0], y = from[1], z = from[2];
    for (int i = 0; i < 3; i++)
        to[i] = a->m[i][0] * x + a->m[i][1] * y + a->m[i][2] * z + a->m[i][3];
}

void affine_compose(struct affine *out, const struct affine *second, const struct affine *first)
{
    struct affine both;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            both.m[i][j] = j == 3 ? second->m[i][3] : 0;
            for (int k = 0; k < 3; k++)
                both.m[i][j] += second->m[i][k] * first->m[k][j];
        }
    *out = both;
}

static double cofactor(const struct affine *a, int i, int j)
{
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return a->m[i1][j1] * a->m[i2][j2] - a->m[i1][j2] * a->m[i2][j1];
}

double affine_determinant(const struct affine *a)
{
    return a->m[0][0] * cofactor(a, 0, 0) + a->m[0][1] * cofactor(a, 0, 1) +
           a->m[0][2] * cofactor(a, 0, 2);
}

bool affine_is_finite(const struct affine *a)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(a->m[i][j]))
                return false;
    return true;
}

bool affine_invert(struct affine *out, const struct affine *a)
{
    const double determinant = affine_determinant(a);
    struct affine back;
    double size = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            size = fmax(size, fabs(a->m[i][j]));
    /* Relative to the size of the matrix: nanometres and metres work alike. */
    if (!affine_is_finite(a) || !(fabs(determinant) > 1e-12 * size * size * size))
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            back.m[i][j] = cofactor(a, j, i) / determinant;
    for (int i = 0; i < 3; i++)
        back.m[i][3] =
            -(back.m[i][0] * a->m[0][3] + back.m[i][1] * a->m[1][3] + back.m[i][2] * a->m[2][3]);
    if (!affine_is_finite(&back))
        return false;
    *out = back;
    return true;
}

/* ---- eigenvalues ---- */

enum { SIDE = 4 };

/* Eigenvalues and eigenvectors of a symmetric matrix of n <= 4 rows, by Jacobi's rotations. The
 * values are left on the diagonal of `matrix`, the vectors in the columns of `vector`. */
static void eigen(int n, double matrix[SIDE][SIDE], double vector[SIDE][SIDE])
{
    enum { SWEEPS = 60 };
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            vector[i][j] = i == j;
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                if (matrix[p][q] == 0)
                    continue;
                const double theta = (matrix[q][q] - matrix[p][p]) / (2 * matrix[p][q]);
                const double t = copysign(1, theta) / (fabs(theta) + hypot(theta, 1));
                const double c = 1 / hypot(t, 1), s = t * c;
                for (int k = 0; k < n; k++) {
                    const double kp = matrix[k][p], kq = matrix[k][q];
                    matrix[k][p] = c * kp - s * kq;
                    matrix[k][q] = s * kp + c * kq;
                }
                for (int k = 0; k < n; k++) {
                    const double pk = matrix[p][k], qk = matrix[q][k];
                    const double vp = vector[k][p], vq = vector[k][q];
                    matrix[p][k] = c * pk - s * qk;
                    matrix[q][k] = s * pk + c * qk;
                    vector[k][p] = c * vp - s * vq;
                    vector[k][q] = s * vp + c * vq;
                }
            }
}

/* Square roots of the eigenvalues of m' m, or of a sum of x x' (`squared`), largest first. */
static void spread(const struct affine *squared, double out[3])
{
    double matrix[SIDE][SIDE] = {{0}}, vector[SIDE][SIDE];
    for (int i = 0; i < 3; i++)
        memcpy(matrix[i], squared->m[i], 3 * sizeof *matrix[i]);
    eigen(3, matrix, vector);
    for (int i = 0; i < 3; i++)
        out[i] = sqrt(fmax(matrix[i][i], 0));
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++)
            if (out[j] > out[i]) {
                const double held = out[i];
                out[i] = out[j];
                out[j] = held;
            }
}

void affine_stretches(const struct affine *a, double out[3])
{
    struct affine squared = {{{0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                squared.m[i][j] += a->m[k][i] * a->m[k][j];
    spread(&squared, out);
}

/* ---- the fit ---- */

/* A smaller spread, relative to the largest, counts as zero: the error of a mark in a head. */
static const double FLAT = 0.01;

/* The places are mirrored if a mirror image leaves less than this part of a rotation's residual. */
static const double MIRRORED = 0.5;

/* Sums over both sets of places, relative to their means. */
struct moments {
    double from_mean[3], to_mean[3];
    struct affine from_from, to_to, to_from; /* sums of products */
};

static void take_moments(struct moments *out, size_t n, const double (*from)[3],
                         const double (*to)[3])
{
    *out = (struct moments){.from_mean = {0}};
    for (size_t p = 0; p < n; p++)
        for (int i = 0; i < 3; i++) {
            out->from_mean[i] += from[p][i] / (double)n;
            out->to_mean[i] += to[p][i] / (double)n;
        }
    for (size_t p = 0; p < n; p++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const double fi = from[p][i] - out->from_mean[i];
                const double fj = from[p][j] - out->from_mean[j];
                const double ti = to[p][i] - out->to_mean[i], tj = to[p][j] - out->to_mean[j];
                out->from_from.m[i][j] += fi * fj;
                out->to_to.m[i][j] += ti * tj;
                out->to_from.m[i][j] += ti * fj;
            }
}

/* Test whether a set of places is flat: on a line (size 2) or in a plane (size 3). */
static bool is_flat(const struct affine *squared, int size)
{
    double length[3];
    spread(squared, length);
    return !(length[size - 1] > FLAT * length[0]) || !isfinite(length[0]);
}

/* Compute the rotation that maps `from` closest to `to`. */
static void rotation(struct affine *out, const struct affine *to_from)
{
    /* Horn's N, with the sums S_ab of from_a to_b: s is its transpose. */
    const double(*s)[4] = to_from->m;
    double n[SIDE][SIDE] = {
        {s[0][0] + s[1][1] + s[2][2], s[2][1] - s[1][2], s[0][2] - s[2][0], s[1][0] - s[0][1]},
        {0, s[0][0] - s[1][1] - s[2][2], s[1][0] + s[0][1], s[0][2] + s[2][0]},
        {0, 0, s[1][1] - s[0][0] - s[2][2], s[2][1] + s[1][2]},
        {0, 0, 0, s[2][2] - s[0][0] - s[1][1]}};
    double vector[SIDE][SIDE];
    int largest = 0;
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < i; j++)
            n[i][j] = n[j][i];
    eigen(SIDE, n, vector);
    for (int i = 1; i < SIDE; i++)
        largest = n[i][i] > n[largest][largest] ? i : largest;
    const double w = vector[0][largest], x = vector[1][largest], y = vector[2][largest],
                 z = vector[3][largest];
    *out = (struct affine){
        {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
         {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
         {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
}

/* Test whether a mirror image would fit far better than any rotation. By the singular values s of
 * the sums, the residual is the total less twice s0 + s1 + s2 for the mirror image, s0 + s1 - s2
 * for the rotation. */
static bool is_mirrored(const struct moments *sums)
{
    double s[3], from = 0, to = 0;
    for (int i = 0; i < 3; i++) {
        from += sums->from_from.m[i][i];
        to += sums->to_to.m[i][i];
    }
    if (!(affine_determinant(&sums->to_from) < 0))
        return false;
    affine_stretches(&sums->to_from, s);
    const double scale = (s[0] + s[1] + s[2]) / from; /* an upper bound for each kind */
    const double mirrored = to - scale * (s[0] + s[1] + s[2]);
    const double rotated = to - (s[0] + s[1] - s[2]) * (s[0] + s[1] - s[2]) / from;
    return fmax(mirrored, 0) < MIRRORED * MIRRORED * rotated;
}

enum err affine_fit(struct affine *out, enum affine_kind kind, size_t n, const double (*from)[3],
                    const double (*to)[3], double *rms_mm, struct fault *fault)
{
    const bool is_full = kind == AFFINE_FULL;
    const size_t least = is_full ? AFFINE_PAIRS_FULL : AFFINE_PAIRS;
    struct moments sums;
    struct affine found;
    if (n < least)
        return fault_set(fault, ERR_INPUT, "%zu pair%s of places; a %s map needs %zu or more", n,
                         n == 1 ? "" : "s",
                         kind == AFFINE_RIGID        ? "rigid"
                         : kind == AFFINE_SIMILARITY ? "similarity"
                                                     : "affine",
                         least);
    take_moments(&sums, n, from, to);
    if (is_flat(&sums.from_from, is_full ? 3 : 2) || is_flat(&sums.to_to, is_full ? 3 : 2))
        return fault_set(fault, ERR_INPUT,
                         is_full
                             ? "all places are in one plane, or nearly so, which does not "
                               "determine an affine map; add a place well off that plane"
                             : "all places are on one line, or nearly so, which does not determine "
                               "the rotation about it; add a place well off that line");
    if (is_mirrored(&sums))
        return fault_set(fault, ERR_INPUT,
                         "the places are mirror images of each other, as if left and right were "
                         "swapped; expected the same places on the same sides");
    if (!is_full)
        rotation(&found, &sums.to_from);
    else if (affine_invert(&found, &sums.from_from))
        affine_compose(&found, &sums.to_from, &found);
    else
        return fault_set(fault, ERR_INPUT, "the places do not determine an affine map");
    double turned = 0, whole = 0;
    for (int i = 0; i < 3; i++) {
        whole += sums.from_from.m[i][i];
        for (int j = 0; j < 3; j++)
            turned += found.m[i][j] * sums.to_from.m[i][j];
    }
    const double scale = kind == AFFINE_SIMILARITY ? turned / whole : 1;
    for (int i = 0; i < 3; i++) {
        found.m[i][3] = sums.to_mean[i];
        for (int j = 0; j < 3; j++) {
            found.m[i][j] *= scale;
            found.m[i][3] -= found.m[i][j] * sums.from_mean[j];
        }
    }
    if (!affine_is_finite(&found) || !(affine_determinant(&found) > 0))
        return fault_set(
            fault, ERR_INPUT,
            "the map would turn the scene inside out; expected the same places on the same sides");
    double squares = 0;
    for (size_t p = 0; p < n; p++) {
        double at[3];
        affine_apply(&found, from[p], at);
        for (int i = 0; i < 3; i++)
            squares += (at[i] - to[p][i]) * (at[i] - to[p][i]);
    }
    *out = found;
    *rms_mm = sqrt(squares / (double)n);
    return OK;
}
