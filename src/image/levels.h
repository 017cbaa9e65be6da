/* SPDX-License-Identifier: MIT */
/*
 * Levels: what a scene still knows of its file's numbers where 16 bits do not tell them apart.
 *
 * An intensity is a level then, of a linear scale. For each there are the least and the greatest
 * number of the file's voxels that have it: most comparisons with real values are decided by them
 * as by the file, and where a level has one number, that is known exactly. What stays open is said:
 * how large a level is, and which ones an interval cuts.
 */
#ifndef IMAGE_LEVELS_H
#define IMAGE_LEVELS_H

#include "base/scan.h"
#include "image/geometry.h"

enum { LEVELS = 65536 };

/* Real values; `least` is above `greatest` where no voxel has the level. */
struct level {
    double least, greatest;
};

struct levels {
    double step;      /* from one level to the next, in real values */
    double ends[2];   /* of the scale */
    bool is_clamped;  /* the scale does not reach the extremes: level 0 is all that lies beyond one
                         end of it, and the last level beyond the other */
    size_t beyond[2]; /* voxels: below the lower end, and above the higher one */
    bool is_single;   /* the numbers are of single precision, unscaled: so are others compared */
    bool is_blended;  /* voxels have been interpolated since: their levels alone are known */
    struct level level[LEVELS];
};

/* The intensities whose real values lie within an interval, low..high; low is above high where
 * there are none. An end may lie among the values of one level: then split[0], or split[1], is that
 * level, which is taken by the value that stands for it; else -1. */
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

/* The real value of an intensity: the one that it has in the file, or what its level stands for. */
double levels_value(const struct geometry *geometry, const struct levels *levels,
                    uint16_t intensity);

/* The same in words, with as many digits as tell it from the next: "0.787"; of a level that has
 * several, "0.787 +-7.6e-06", or "1.5..1e+20" beyond the scale; and
 * "0.787 +-7.6e-06 within the scale" where it may be a mean of voxels that were put to its ends. */
void levels_write(struct buf *out, const struct geometry *geometry, const struct levels *levels,
                  uint16_t intensity);

/* The scale, the size of a level, and what is beyond: lines, each after `before`; none where
 * `levels` is NULL. */
void levels_write_scale(struct buf *out, const struct levels *levels, const char *before);

/* Of all values; for records. */
uint64_t levels_digest(const struct levels *levels);

#endif
