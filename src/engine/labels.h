/* SPDX-License-Identifier: MIT */
/*
 * Labels for display, files and counts: those of the forest, or finished ones (engine/finish.h),
 * which are stored in a separate array. Readers use this interface for both.
 */
#ifndef ENGINE_LABELS_H
#define ENGINE_LABELS_H

#include <stddef.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/team.h"
#include "engine/scene.h"

/* A view, valid until the forest changes. */
struct labels {
    const struct scene *scene;
    const uint8_t *finished; /* [grid.cells], 0 in the rim; NULL: those of the forest */
};

/* View of the forest's labels. */
static inline struct labels labels_of_forest(const struct scene *scene)
{
    return (struct labels){scene, NULL};
}

/* Label of a cell, 0 in the rim. */
static inline uint8_t labels_at(const struct labels *labels, uint32_t cell)
{
    return labels->finished ? labels->finished[cell] : labels->scene->cell[cell].label;
}

/* Copy the labels of a row of voxels to `out`, [grid.size[0]]. */
void labels_copy_row(const struct labels *labels, struct span row, uint8_t *out);

/* Copy the labels of all cells to `out`, [grid.cells], 0 in the rim; by a thread team. Undefined if
 * the scene's watch has stopped it. */
void labels_copy(const struct labels *labels, uint8_t *out, struct team *team);

/* Contribution of a voxel to a digest of labels. */
static inline uint64_t label_share(uint32_t cell, uint8_t label)
{
    return hash_place(cell) * label;
}

/* Digest: a sum mod 2^64 over voxels of mixed places times labels; for the forest's labels it
 * equals forest_label_digest. Undefined if the scene's watch has stopped it. */
uint64_t labels_digest(const struct labels *labels, struct team *team);

/*
 * Overlap of two sets of labels of the same voxels.
 *
 * Dice's coefficient of a label is 2 |A and B| / (|A| + |B|), where |A| is its number of voxels in
 * A: 1 if both have the same voxels, 0 if they have none in common. It is in ten-thousandths,
 * rounded to the nearest, halves up, from the integers themselves. So 10000 is possible for very
 * large labels that differ in very few voxels; `differing` is exact.
 */

struct overlap {
    uint64_t voxels, differing;         /* all voxels; voxels whose labels differ */
    uint64_t a[256], b[256], both[256]; /* voxels of each label */
};

enum { DICE_ONE = 10000 };

/* Add `voxels` labels; fewer than 2^32 in total, starting from {0}. */
void overlap_add(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels);

/* Dice's coefficient in ten-thousandths; DICE_ONE if the label has no voxel in either. */
unsigned overlap_dice(const struct overlap *overlap, uint8_t label);

/* Voxels of a label in A, in B and in both; for label 0, sums over all other labels. */
struct overlap_counts {
    uint64_t a, b, both;
};
struct overlap_counts overlap_counts_of(const struct overlap *overlap, unsigned label);

#endif
