/* SPDX-License-Identifier: MIT */
#include "engine/overlap.h"

void overlap_count(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels)
{
    *overlap = (struct overlap){0};
    overlap_add(overlap, a, b, voxels);
}

void overlap_add(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels)
{
    overlap->voxels += voxels;
    for (size_t i = 0; i < voxels; i++) {
        overlap->a[a[i]]++;
        overlap->b[b[i]]++;
        overlap->both[a[i]] += a[i] == b[i];
        overlap->differing += a[i] != b[i];
    }
}

unsigned overlap_dice(const struct overlap *overlap, uint8_t label)
{
    const uint64_t sum = overlap->a[label] + overlap->b[label];
    const uint64_t common = 2 * overlap->both[label];
    return sum ? (unsigned)((2 * common * DICE_ONE + sum) / (2 * sum)) : DICE_ONE;
}

struct overlap_counts overlap_counts_of(const struct overlap *overlap, unsigned label)
{
    struct overlap_counts sum = {0};
    for (unsigned l = label ? label : 1; l < 256 && (l == label || !label); l++) {
        sum.a += overlap->a[l];
        sum.b += overlap->b[l];
        sum.both += overlap->both[l];
    }
    return sum;
}
