/* SPDX-License-Identifier: MIT */
/*
 * Levels: the numbers of a file that 16 bits do not distinguish.
 *
 * An intensity is then a level of a linear scale. For each level the least and the greatest number
 * of its voxels are stored: they decide most comparisons with real values as the file would, and a
 * level with one number is known exactly. The rest is reported: the size of a level, and the levels
 * that an interval cuts.
 */
#ifndef IMAGE_LEVELS_H
#define IMAGE_LEVELS_H

#include "base/scan.h"
#include "image/geometry.h"

enum { LEVELS = 65536 };

/* Real values; `least` is above `greatest` if no voxel has the level. */
struct level {
    double least, greatest;
};

struct levels {
    double step;      /* from one level to the next, in real values */
    double ends[2];   /* ends of the scale */
    bool is_clamped;  /* the scale does not reach the extremes: level 0 has all numbers beyond one
                         end of it, and the last level those beyond the other */
    size_t beyond[2]; /* voxels: below the lower end, and above the higher one */
    bool is_single;   /* unscaled numbers of single precision: compare in single precision */
    bool is_blended;  /* voxels were interpolated since: only their levels are known */
    struct level level[LEVELS];
};

/* The intensities low..high whose real values are within an interval; low is above high if there
 * are no such intensities. If an end cuts the values of a level, split[0] or split[1] is that
 * level, which counts by its nominal value; otherwise -1. */
struct interval {
    uint16_t low, high;
    int32_t split[2];
};

static inline bool interval_holds(const struct interval *interval, uint16_t intensity)
{
    return intensity >= interval->low && intensity <= interval->high;
}

static inline bool interval_splits(const struct interval *interval, uint16_t intensity)
{
    return intensity == interval->split[0] || intensity == interval->split[1];
}

/* Both ends are included. `levels` may be NULL: intensities are exact. */
struct interval levels_within(const struct geometry *geometry, const struct levels *levels,
                              const struct decimal range[2]);

/* The real value of an intensity: the one in the file, or the nominal value of its level. */
double levels_value(const struct geometry *geometry, const struct levels *levels,
                    uint16_t intensity);

/* Write the real value with the digits that distinguish it from the next one: "0.787"; of a level
 * with several values, "0.787 +-7.6e-06", or "1.5..1e+20" beyond the scale; and
 * "0.787 +-7.6e-06 within the scale" if it may be a mean of clamped voxels. */
void levels_write(struct buf *out, const struct geometry *geometry, const struct levels *levels,
                  uint16_t intensity);

/* Write the scale, the size of a level, and the numbers beyond, as lines that begin with `before`;
 * nothing if `levels` is NULL. */
void levels_write_scale(struct buf *out, const struct levels *levels, const char *before);

/* Digest of all values, for records. */
uint64_t levels_digest(const struct levels *levels);

#endif
