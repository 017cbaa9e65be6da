/* SPDX-License-Identifier: MIT */
/*
 * How far two sets of labels of the same voxels differ.
 *
 * Dice's coefficient of a label is 2 |A and B| / (|A| + |B|), where |A| is how many voxels have it:
 * 1 where both have the same, 0 where none is common. It is in ten-thousandths, rounded to the
 * nearest, halves up, from the integers themselves; so 10000 may stand where very few of very many
 * differ; `differing` counts each.
 */
#ifndef ENGINE_OVERLAP_H
#define ENGINE_OVERLAP_H

#include <stddef.h>
#include <stdint.h>

struct overlap {
    uint64_t voxels, differing;         /* all; those whose labels differ */
    uint64_t a[256], b[256], both[256]; /* voxels of each label */
};

enum { DICE_ONE = 10000 };

/* Counts `voxels` labels more; of fewer than 2^32 in all, and from {0} on. */
void overlap_add(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels);

/* Counts these alone. */
void overlap_count(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels);

/* In ten-thousandths; DICE_ONE where no voxel of either has the label. */
unsigned overlap_dice(const struct overlap *overlap, uint8_t label);

/* Voxels of a label in A, in B and in both; of 0: sums over all labels but that. */
struct overlap_counts {
    uint64_t a, b, both;
};
struct overlap_counts overlap_counts_of(const struct overlap *overlap, unsigned label);

#endif
