/* SPDX-License-Identifier: MIT */
/*
 * Affine maps between worlds, in millimetres, and least-squares fits of pairs of places.
 *
 * The world is NIfTI's (image/geometry.h): RAS+. Maps in the conventions of other programs are
 * converted where their files are read (registration.h). Floating point is allowed: a map is
 * recorded in a journal as digits, and no replay recomputes it.
 *
 * Rotations by unit quaternions: B. K. P. Horn, "Closed-form solution of absolute orientation using
 * unit quaternions", J. Opt. Soc. Am. A 4 (1987) 629-642. The method never returns a mirror image.
 */
#ifndef APPLY_AFFINE_H
#define APPLY_AFFINE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/err.h"

/* y = m[.][0..2] x + m[.][3]: millimetres, RAS+ (x to the right, y to the front, z up). */
struct affine {
    double m[3][4];
};

void affine_identity(struct affine *out);
void affine_apply(const struct affine *a, const double from[3], double to[3]);

/* out(x) = second(first(x)); `out` may be either of them. */
void affine_compose(struct affine *out, const struct affine *second, const struct affine *first);

/* Return false, and leave `out` alone, if `a` is singular or not finite. `out` may be `a`. */
bool affine_invert(struct affine *out, const struct affine *a);

double affine_determinant(const struct affine *a); /* negative: mirror images */
bool affine_is_finite(const struct affine *a);

/* Singular values, largest first: the stretch along three directions at right angles. */
void affine_stretches(const struct affine *a, double out[3]);

/* Degrees of freedom: rotation and translation; one scale too; all twelve. */
enum affine_kind { AFFINE_RIGID, AFFINE_SIMILARITY, AFFINE_FULL };

/* Fewest pairs for a fit; for AFFINE_FULL. */
enum { AFFINE_PAIRS = 3, AFFINE_PAIRS_FULL = 4 };

/*
 * Least squares over n pairs of places in millimetres: to ~ out(from). *rms_mm is the root mean
 * square of the residuals (0 for the fewest pairs).
 *
 * ERR_INPUT, with `out` unchanged, if the places do not determine the map: too few pairs, all
 * places on a line (in a plane, for AFFINE_FULL), or one set mirrored, as if left and right were
 * swapped.
 */
enum err affine_fit(struct affine *out, enum affine_kind kind, size_t n, const double (*from)[3],
                    const double (*to)[3], double *rms_mm, struct fault *fault);

#endif
