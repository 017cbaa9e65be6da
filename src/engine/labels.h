/* SPDX-License-Identifier: MIT */
/*
 * Labels as they are handed out: those of the forest, or finished ones (engine/finish.h), which lie
 * in an array of their own. What shows, saves or counts labels reads them through this, and does
 * not know which they are.
 */
#ifndef ENGINE_LABELS_H
#define ENGINE_LABELS_H

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

#endif
