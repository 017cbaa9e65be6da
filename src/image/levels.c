/* SPDX-License-Identifier: MIT */
#include "image/levels.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/hash.h"

/* Round an end as the numbers of the file: single precision has no 0.7, but the nearest to it. */
static double end_value(const struct levels *levels, const struct decimal *end)
{
    const double value = decimal_value(end);
    return levels && levels->is_single && fabs(value) <= (double)FLT_MAX ? (double)(float)value
                                                                         : value;
}

static bool has_voxels(const struct level *level)
{
    return level->least <= level->greatest;
}

/* The level, or NULL if it is unknown. */
static const struct level *known(const struct levels *levels, int32_t i)
{
    return levels && !levels->is_blended && has_voxels(&levels->level[i]) ? &levels->level[i]
                                                                          : NULL;
}

/* Levels without a voxel of the file count by their nominal value, as exact intensities do:
 * interpolated voxels may have them. */
struct interval levels_within(const struct geometry *geometry, const struct levels *levels,
                              const struct decimal range[2])
{
    const double low = end_value(levels, &range[0]), high = end_value(levels, &range[1]);
    struct interval out = {UINT16_MAX, 0, {-1, -1}};
    for (int32_t i = 0; i < LEVELS; i++) {
        const struct level *level = known(levels, i);
        const double value = geometry_value(geometry, i);
        bool is_in = value >= low && value <= high;
        if (level) {
            const bool all = level->least >= low && level->greatest <= high;
            const bool none = level->least > high || level->greatest < low;
            if (!all && !none)
                out.split[out.split[0] >= 0] = i;
            else
                is_in = all;
        }
        if (!is_in)
            continue;
        out.low = i < out.low ? (uint16_t)i : out.low;
        out.high = (uint16_t)i;
    }
    return out;
}

double levels_value(const struct geometry *geometry, const struct levels *levels,
                    uint16_t intensity)
{
    const struct level *level = known(levels, intensity);
    return level && level->least == level->greatest ? level->least
                                                    : geometry_value(geometry, intensity);
}

void levels_write(struct buf *out, const struct geometry *geometry, const struct levels *levels,
                  uint16_t intensity)
{
    const int digits = geometry_digits(geometry);
    const struct level *level = known(levels, intensity);
    const bool is_beyond = intensity == 0 || intensity == LEVELS - 1;
    if (level && level->least == level->greatest) {
        const double value = level->least; /* a whole one with all its digits */
        const bool is_whole = fabs(value) < 1e15 && value == floor(value);
        if (isinf(value))
            buf_add_text(out, "no number");
        else
            buf_printf(out, is_whole ? "%.*f" : "%.*g", is_whole ? 0 : digits, value);
    } else if (level && levels->is_clamped && is_beyond) {
        buf_printf(out, "%.*g..%.*g", digits, level->least, digits, level->greatest);
    } else {
        buf_printf(out, "%.*g", digits, geometry_value(geometry, intensity));
        if (levels)
            buf_printf(out, " +-%.2g%s", levels->step / 2,
                       levels->is_blended && levels->beyond[0] + levels->beyond[1]
                           ? " within the scale" /* it may contain clamped values */
                           : "");
    }
}

void levels_write_scale(struct buf *out, const struct levels *levels, const char *before)
{
    static const char *const side[] = {"below", "above"};
    if (!levels)
        return;
    buf_printf(out, "%sscale %.6g..%.6g, a level is %.3g: values are known to half of it\n", before,
               levels->ends[0], levels->ends[1], levels->step);
    for (int i = 0; i < 2; i++)
        if (levels->beyond[i])
            buf_printf(out, "%s%zu voxel%s %s %.6g: counted as that\n", before, levels->beyond[i],
                       levels->beyond[i] == 1 ? " is" : "s are", side[i], levels->ends[i]);
}

uint64_t levels_digest(const struct levels *levels)
{
    uint64_t sum = 0;
    for (uint64_t i = 0; i < LEVELS; i++) {
        uint64_t bits[2];
        if (!has_voxels(&levels->level[i]))
            continue;
        memcpy(bits, &levels->level[i], sizeof bits);
        sum += hash_mix_at(2 * i, bits[0]) + hash_mix_at(2 * i + 1, bits[1]);
    }
    return sum;
}
