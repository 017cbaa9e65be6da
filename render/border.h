/* SPDX-License-Identifier: MIT */
/*
 * The border: the voxels that can be seen at all.
 *
 * A voxel is *shown* if its label is visible (never 0) and it is not cut away (render/cut.h). A
 * border voxel is a shown voxel with a face neighbour that is not shown: background, hidden, cut
 * away, or outside the scene, whatever the adjacency of the forest. Both sets have one bit per cell
 * and are updated from the changes of the forest (BDIFT), in time proportional to them; reading the
 * border is one sequential scan, where the paper has scattered lists.
 *
 * Invariant B1: between calls both sets equal a recount from labels and cut, and a block with a
 * border voxel is occupied; tests/border_check.h checks it.
 */
#ifndef RENDER_BORDER_H
#define RENDER_BORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/labels.h"
#include "render/cut.h"

enum {
    BORDER_OPAQUE = 100,   /* percent */
    BORDER_BLOCK_BITS = 3, /* log2 of the side of a block, in voxels */
};

struct changes;

struct border {
    const struct scene *scene;
    struct labels labels; /* the labels: the forest's, unless replaced */
    uint64_t *shown;      /* bit c % 64 of word c / 64: cell c is shown */
    uint64_t *border;     /* likewise: cell c is a border voxel */
    size_t words;         /* words of each set, including a spare word at the end that stays 0 */

    uint8_t *occupied; /* blocks that may contain a shown voxel, by z, y, x; until a recount also
                          blocks that did before */

    /* For results computed from `shown` and cached (render/mesh.h): every update and recount
     * increments the version, and each word records the version of its last change. */
    uint32_t version;
    uint32_t *changed;    /* [words] */
    bool visible[256];    /* labels that the view shows; [0] is false */
    uint8_t opacity[256]; /* percent, 1..100 for visible labels; used by layers (render/layers.h)
                             alone */
    struct cut cut;       /* the part of the scene that is cut away */

    /* During an update: the words of `border` to be recomputed, each once, and a bit for each. */
    uint32_t *stale;
    size_t stales;
    uint64_t *marked;
};

/* Show nothing yet: every label but 0 is visible and opaque, nothing is cut away. The scene must
 * outlive the border. */
enum err border_init(struct border *border, const struct scene *scene, struct fault *fault);
void border_release(struct border *border);

size_t border_memory(const struct border *border); /* bytes, without the labels */

/* Update after an edit of the forest, also if its changes are "everything". */
void border_update(struct border *border, const struct changes *changes);

/* Recount after a change of `visible` or `cut`, and initially: a scan of the scene, under its
 * watch. */
void border_recount(struct border *border);

static inline bool border_shows(const struct border *border, uint32_t cell)
{
    return border->shown[cell >> 6] >> (cell & 63) & 1;
}
static inline bool border_holds(const struct border *border, uint32_t cell)
{
    return border->border[cell >> 6] >> (cell & 63) & 1;
}

/* Return the 64 bits from bit `at` on; the word must have a successor, as that of every cell has.
 * */
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

/* Return true if the cell is shown except for the cut: its neighbours have faces that were cut
 * open. Reads its label and its bit, both correct while B1 holds. */
static inline bool border_is_cut(const struct border *border, uint32_t cell)
{
    return !border_shows(border, cell) && border->visible[labels_at(&border->labels, cell)];
}

/* Return true if a visible label is not opaque. */
bool border_is_translucent(const struct border *border);

size_t border_count(const struct border *border); /* border voxels */

#endif
