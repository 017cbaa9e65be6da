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
 *     the core is what T(k) is the range of; T(k) is to be above 0, and at most half of all
 *     k becomes 8 k, and the core with it, as long as that is at most n / 128, and T(8 k) is above
 *     0, at most a half and at least a 32nd of T(k): a tail that thins out, as quotients have
 *     outliers take the levels of others where T(k) is less than a 16th of all in the end: 4096
 *     levels, as CT has, would be left
 *
 * So what is put aside is very few voxels, or a tail without an end of its own. An object that is
 * bright as nothing else is stays within the scale, whatever is around it: beyond its own values
 * T falls at once, which is no tail.
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
bool outliers_find(uint64_t core[2], const struct numbers *numbers, uint64_t *room,
                   struct watch *watch);

#endif
