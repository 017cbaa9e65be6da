/* SPDX-License-Identifier: MIT */
/*
 * Labels as they are handed out: those of the forest, or finished ones (engine/finish.h), which lie
 * in an array of their own. What shows, saves or counts labels reads them through this, and does
 * not know which they are.
 */
#ifndef ENGINE_LABELS_H
#define ENGINE_LABELS_H

#include <stddef.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/team.h"
#include "engine/scene.h"

/* Borrowed: of use until the forest changes. */
struct labels {
    const struct scene *scene;
    const uint8_t *finished; /* [grid.cells], 0 in the rim; NULL: those of the forest */
};

/* Those of the forest. */
static inline struct labels labels_of_forest(const struct scene *scene)
{
    return (struct labels){scene, NULL};
}

/* Of a cell, 0 in the rim. */
static inline uint8_t labels_at(const struct labels *labels, uint32_t cell)
{
    return labels->finished ? labels->finished[cell] : labels->scene->cell[cell].label;
}

/* The labels of a row of voxels: a place for grid.size[0] of them. */
void labels_copy_row(const struct labels *labels, struct span row, uint8_t *out);

/* The labels of all cells into [grid.cells], 0 in the rim; shared by a thread team. Of no use where
 * the scene's watch has stopped it. */
void labels_copy(const struct labels *labels, uint8_t *out, struct team *team);

/* What one voxel adds to a digest of labels. */
static inline uint64_t label_share(uint32_t cell, uint8_t label)
{
    return hash_place(cell) * label;
}

/* A sum mod 2^64 over voxels of mixed places times labels: of the forest's labels it is
 * forest_label_digest. Of no use where the scene's watch has stopped it. */
uint64_t labels_digest(const struct labels *labels, struct team *team);

/*
 * How far two sets of labels of the same voxels differ.
 *
 * Dice's coefficient of a label is 2 |A and B| / (|A| + |B|), where |A| is how many voxels have it:
 * 1 where both have the same, 0 where none is common. It is in ten-thousandths, rounded to the
 * nearest, halves up, from the integers themselves; so 10000 may stand where very few of very many
 * differ; `differing` counts each.
 */

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
