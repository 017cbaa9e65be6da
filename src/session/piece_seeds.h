/* SPDX-License-Identifier: MIT */
/*
 * Markers out of a segmentation: one for each piece of each label.
 *
 * A piece is a component (engine/components.h). It is eroded by rounds, each of which removes the
 * voxels that have a face neighbour of another label; what lies beyond the scene removes none. A
 * piece of which nothing would be left has fewer rounds, and keeps its innermost voxels. So the
 * borders of the segmentation are left to the forest, as wide as the erosion, and no piece is lost.
 *
 * Seeds are the contour alone of what is left (engine/distance.h). A path to the voxels inside goes
 * through it, and it is a seed, so they belong to the same label as if all were seeds. But a seed
 * that somebody plants inside later, to correct, grows there, which it could not among seeds; and
 * seeds take memory by the surface, not by the volume. Those near it give way besides, if the
 * marker yields (session/markers.h), for which the voxels of each piece are listed as runs.
 */
#ifndef SESSION_PIECE_SEEDS_H
#define SESSION_PIECE_SEEDS_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"
#include "engine/grid.h"
#include "session/markers.h"

enum { PIECE_ERODE_MOST = 100 };

struct piece {
    size_t end;     /* of its seeds in `cell`; they begin where those of the piece before end */
    size_t run_end; /* of its runs in `run`, likewise; it has none where all its voxels are seeds */
    uint8_t label;
};

struct piece_seeds {
    uint32_t *cell; /* those of a piece in order */
    size_t count, capacity;
    struct marker_run *run; /* those of a piece in order: all of it, before the erosion */
    size_t runs, run_capacity;
    struct piece *piece; /* in the order of their first voxels */
    size_t pieces, piece_capacity;
    size_t small;         /* pieces that have fewer rounds */
    size_t left_out;      /* pieces that are too small to be planted */
    uint32_t labels[256]; /* pieces of each label */
};
void piece_seeds_release(struct piece_seeds *seeds);

/* How pieces become seeds. */
struct piece_choice {
    unsigned erode; /* rounds */
    uint32_t least; /* pieces of fewer voxels are left out */
    uint16_t rest;  /* what REGION_NONE is: a label, or REGION_NONE, which gives no seed and is
                       another label to its neighbours */
};

/* region[z][y][x] is a label 0..255, or REGION_NONE. Takes two bytes a voxel. ERR_INPUT where all
 * 256 labels are there beside a REGION_NONE that is none, ERR_MEMORY, ERR_CANCELLED by the watch,
 * or NULL; *seeds is empty then. */
enum err piece_seeds_make(struct piece_seeds *seeds, const uint16_t *region,
                          const struct grid *grid, const struct piece_choice *choice,
                          struct watch *watch, struct fault *fault);

#endif
