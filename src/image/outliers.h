/*
 * Outliers: whether a few numbers, far from all others, take the levels that the others need.
 *
 * A pure function of how often each number occurs: ranks of numbers and comparisons of their
 * differences, no sum, so that neither the order of voxels nor the machine matters.
 *
 * T(k) is the range that is left when the least and the greatest number, however often they occur
 * (fill values, say), and k more voxels at each end are put aside; n is the number of voxels that
 * are numbers.
 *
 *     k = 8, or n / 2^20 if that is more, or n / 128 if that is less than 8
 *     the scale goes from the least to the greatest number    where T(k) is at least a 16th of
 *                                                             that: 4096 levels, as CT has, are
 *                                                             left; or where T(k) is nothing
 *     else k becomes 8 k as long as T(8 k) is above 0 and at most a quarter of T(k), and 8 k at
 *     most n / 128: a tail of ever fewer voxels, as quotients have
 *     the core is what T(k) is the range of
 *
 * What is put aside in one step is few voxels, or thins out: an object that is bright as nothing
 * else is, of more voxels than that, stays within the scale whatever is around it.
 */
#ifndef IMAGE_OUTLIERS_H
#define IMAGE_OUTLIERS_H

#include "base/watch.h"
#include "image/order.h"

/* Numbers of 4 or 8 bytes, in the order of this machine. */
struct numbers {
    const uint8_t *at;
    size_t count;
    enum voxel_type type;
    size_t odd;               /* of them, so many have no order */
    uint64_t least, greatest; /* orders of the ends of their range; `least` is that of 0, which odd
                                 ones are taken for, where no number is below */
};

/* Whether outliers take the levels of the others, whose orders are core[0] .. core[1] then. `room`
 * is [OUTLIERS_ROOM], for the work. Of no use where the watch (or NULL) stopped it. */
enum { OUTLIERS_ROOM = 1 << 16 };
bool outliers_find(uint64_t core[2], const struct numbers *numbers, size_t *room,
                   struct watch *watch);

#endif
