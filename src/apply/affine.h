/* SPDX-License-Identifier: MIT */
/*
 * Affine maps between worlds, in millimetres, and the one that fits pairs of places best.
 *
 * The world is NIfTI's (image/geometry.h): RAS+. Other programs have it otherwise; what reads
 * their files turns it (registration.h), so that nothing here has a second meaning. Floating
 * point: what is found here is written into a journal as digits, and no replay computes it anew.
 *
 * Rotations by unit quaternions: B. K. P. Horn, "Closed-form solution of absolute orientation using
 * unit quaternions", J. Opt. Soc. Am. A 4 (1987) 629-642. It never gives a mirror image.
 */
#ifndef REGISTER_AFFINE_H
#define REGISTER_AFFINE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/err.h"

/* y = m[.][0..2] x + m[.][3]: millimetres, RAS+ (x to the right, y to the front, z up). */
struct affine {
    double m[3][4];
};

void affine_identity(struct affine *out);
void affine_apply(const struct affine *a, const double from[3], double to[3]);

/* out(x) = second(first(x)); `out` may be one of them. */
void affine_compose(struct affine *out, const struct affine *second, const struct affine *first);

/* False, and `out` is left alone, where it is singular or not finite. `out` may be `a`. */
bool affine_invert(struct affine *out, const struct affine *a);

double affine_determinant(const struct affine *a); /* below 0: it makes mirror images */
bool affine_is_finite(const struct affine *a);

/* How much it stretches along three directions at right angles: the singular values, largest
 * first. */
void affine_stretches(const struct affine *a, double out[3]);

/* What may be fitted: turned and moved; scaled as well, all axes alike; anything. */
enum affine_kind { AFFINE_RIGID, AFFINE_SIMILARITY, AFFINE_FULL };

/* How many pairs a kind takes; and AFFINE_FULL. */
enum { AFFINE_PAIRS = 3, AFFINE_PAIRS_FULL = 4 };

/*
 * Least squares over pairs of places in millimetres: to ~ out(from), and in *rms_mm the root of the
 * mean square of what is left (0 where pairs are no more than the kind takes).
 *
 * ERR_INPUT, and `out` is left alone, where the places do not say it: too few pairs, all of them
 * on a line (in a plane, for AFFINE_FULL), or where they are mirrored, as where left and right are
 * mixed up.
 */
enum err affine_fit(struct affine *out, enum affine_kind kind, size_t n, const double (*from)[3],
                    const double (*to)[3], double *rms_mm, struct fault *fault);

#endif
