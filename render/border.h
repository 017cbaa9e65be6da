/* SPDX-License-Identifier: MIT */
/*
 * The border: which voxels can be seen at all.
 *
 * A voxel is *shown* where its label is one that the view shows (never 0) and it is not cut away
 * (render/cut.h). A border voxel is a shown voxel with a face neighbour that is not: background,
 * hidden, cut away, or outside the scene, whatever the adjacency of the forest. Both sets are held
 * as one bit per cell and updated from the changes of the forest (BDIFT), in time
 * proportional to them; reading the border is one sequential scan. It answers the scattered border
 * lists of the paper with ordered access.
 *
 * Invariant B1: between calls both sets equal a recount from labels and cut, and a block that
 * holds a border voxel is occupied; tests/border_check.h checks it.
 */
#ifndef RENDER_BORDER_H
#define RENDER_BORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/labels.h"
#include "render/cut.h"

enum {
    BORDER_OPAQUE = 100,   /* percent */
    BORDER_BLOCK_BITS = 3, /* of the voxels a side of a block */
};

struct changes;

struct border {
    const struct scene *scene;
    struct labels labels; /* by which voxels are shown: the forest's, unless others are set */
    uint64_t *shown;      /* bit c % 64 of word c / 64: cell c is shown */
    uint64_t *border;     /* likewise: cell c is a border voxel */
    size_t words;         /* of each, with one spare word at the end that stays 0 */

    uint8_t *occupied; /* blocks in which a voxel may be shown, by z, y, x; until a recount also
                          those in which one has been */

    /* For results that were made of `shown` and stored (render/mesh.h): every update and recount
     * has a number, and each word that of the last one in which it changed. */
    uint32_t version;
    uint32_t *changed;    /* [words] */
    bool visible[256];    /* which labels the view shows; [0] is false */
    uint8_t opacity[256]; /* of each label, percent, 1..100 where it is visible: for layers
                             (render/layers.h) alone, all else is the same for any */
    struct cut cut;       /* what is cut away of the scene */

    /* During an update: words of `border` to be made anew, each once, and a bit for each. */
    uint32_t *stale;
    size_t stales;
    uint64_t *marked;
};

/* Nothing shown yet; every label but 0 visible and opaque, nothing cut away. The scene outlives the
 * border. */
enum err border_init(struct border *border, const struct scene *scene, struct fault *fault);
void border_release(struct border *border);

size_t border_memory(const struct border *border); /* bytes, without the labels */

/* After an edit of the forest. Also right after one whose changes are "everything". */
void border_update(struct border *border, const struct changes *changes);

/* After `visible` or `cut` has changed, or to start with: a scan of the scene, under its watch. */
void border_recount(struct border *border);

static inline bool border_shows(const struct border *border, uint32_t cell)
{
    return border->shown[cell >> 6] >> (cell & 63) & 1;
}
static inline bool border_holds(const struct border *border, uint32_t cell)
{
    return border->border[cell >> 6] >> (cell & 63) & 1;
}

/* The 64 bits from bit `at` on, whose word has one after it, as that of every cell has. */
static inline uint64_t border_bits_at(const uint64_t *words, size_t at)
{
    const uint64_t *word = words + (at >> 6);
    return word[0] >> (at & 63) | word[1] << 1 << (63 - (at & 63));
}

/* The same; bits before the first and after the last are 0. */
static inline uint64_t border_bits_from(const uint64_t *words, size_t count, ptrdiff_t at)
{
    if (at < 0)
        return at > -64 ? words[0] << -at : 0;
    const size_t word = (size_t)at >> 6;
    if (word + 1 >= count)
        return word < count ? words[word] >> (at & 63) : 0;
    return border_bits_at(words, (size_t)at);
}

/* Whether the cell would be shown, were it not cut away: beside such a cell the scene has been cut
 * open. Reads its label and its bit, both right while B1 holds. */
static inline bool border_is_cut(const struct border *border, uint32_t cell)
{
    return !border_shows(border, cell) && border->visible[labels_at(&border->labels, cell)];
}

/* Whether a visible label is not opaque. */
bool border_is_translucent(const struct border *border);

size_t border_count(const struct border *border); /* border voxels */

#endif
