/* SPDX-License-Identifier: MIT */
/*
 * Linear light: the 256 levels of a channel as half floats, and back.
 *
 * OpenEXR stores linear light, pictures store 8-bit sRGB. Both conversions use tables of 256 halves
 * that all differ, so that the way back is exact, and the same on every machine.
 */
#ifndef IMAGE_LINEAR_H
#define IMAGE_LINEAR_H

#include <stdint.h>

enum { HALF_ONE = 0x3c00 };

/* Linear light of the levels of sRGB (IEC 61966-2-1), rounded to half precision. */
extern const uint16_t linear_half[256];

/* Fill a table for alpha, which is linear already: the half nearest to level / 255. */
void linear_alpha(uint16_t half[256]);

/* The light of a level that covers alpha / 255 of a pixel: the half nearest to the product, a
 * subnormal one below 2^-14. For each alpha above 0 the 256 halves all differ. */
uint16_t linear_associated(uint8_t level, uint8_t alpha);

/* The inverse: the level whose half for that alpha is nearest, and 0 for alpha 0. */
uint8_t linear_straight(uint16_t half, uint8_t alpha);

/* Invert a table: for each half from 0 to 1 the level whose half is nearest. */
void linear_invert(uint8_t level[HALF_ONE + 1], const uint16_t half[256]);

/* The level of any half: 0 for negative ones and NaN, 255 beyond 1. */
uint8_t linear_level(const uint8_t level[HALF_ONE + 1], uint16_t half);

#endif
