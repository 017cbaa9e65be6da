/* SPDX-License-Identifier: MIT */
/*
 * Gradients as arc weights: the length of the gradient of the intensities, in integers.
 *
 * Both work in voxel units, independent of the spacing, and replicate edge voxels to the outside.
 * Both are scaled so that a step of height h between two flat halves has weight h at the two voxels
 * next to it, along each axis; weights above 65535 are 65535. A ramp that rises by g a voxel has 2
 * g under `sobel`, and more under `gauss`, where a wide ramp costs as much as a step that the
 * smoothing has made as wide.
 *
 * sobel: along each axis the central difference I(+1) - I(-1), smoothed by 1-2-1 along the two
 * other axes. The weight is floor(sqrt(gx^2 + gy^2 + gz^2) / 16). Work memory: three rows.
 *
 * gauss: the central differences S(+1) - S(-1) of the scene S smoothed by a Gaussian. S has 16
 * binary places: exact along z; then along y, then along x, to the nearest after each. With the
 * halves d = floor(|S(+1) - S(-1)| / 2) in 2^-16 and m = floor(sqrt(dx^2 + dy^2 + dz^2)), the
 * weight is 2 m / (weight[0] + weight[1]) to the nearest: a step has the largest possible
 * difference. Work memory: four planes of 32 bits; planes of 16 bits, their number the width of the
 * Gaussian or the depth of the scene; and some rows.
 *
 * Promises
 *   D1 the weights are a function of size and intensities alone, the same on every machine and
 *      for every division of the scene into slabs;
 *   D2 mirroring the scene along an axis mirrors its weights.
 */
#ifndef ENGINE_WEIGHT_GRADIENT_H
#define ENGINE_WEIGHT_GRADIENT_H

#include <stdint.h>

enum { GAUSS_RADIUS_MOST = 24 };

/*
 * A Gaussian of integer weights: weight[k] at distance k up to `radius` = sigma times 3, rounded
 * up; weight[0] + 2 (weight[1] + ... + weight[radius]) is GAUSS_SUM exactly.
 *
 *     x      = floor(k^2 10^6 2^32 / (2 sigma^2)), in 2^-32    sigma in thousandths of a voxel
 *     e(k)   = exp(-x) in 2^-32: with f the fraction of x, from p = 2^32 on,
 *              p = 2^32 - floor(floor(f p / 2^32) / i) for i = 12, 11 ... 1 (Taylor, by Horner);
 *              then p = floor(p 1580030169 / 2^32) (1/e) for each whole 1 in x
 *     weight = e(k) GAUSS_SUM / (e(0) + 2 (e(1) + ... + e(radius))), to the nearest, for k > 0;
 *              weight[0] is the remainder.
 */
enum { GAUSS_SUM = 65536 };
struct gauss {
    uint32_t radius;
    uint32_t weight[GAUSS_RADIUS_MOST + 1];
};
void gauss_init(struct gauss *gauss, uint32_t sigma_thousandths); /* SIGMA_LEAST..SIGMA_MOST */

#endif
