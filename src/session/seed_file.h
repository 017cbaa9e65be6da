/* SPDX-License-Identifier: MIT */
/*
 * Seeds out of files: a list of voxels, or a label map on the scene's grid.
 *
 * Memory in, seeds out: who finds the file and reads it is the caller, and nothing is planted here.
 * A list is text, one seed a line; blank lines, comments and one header line are passed over:
 *
 *     x,y,z,label            # voxel indices from 0, a label's number or name
 *     70,110,95,brain
 *     10,10,10,0
 *     70,112,95,1,12,70,110,95     # within 12 voxels of 70,110,95, after a number alone; or 2.5mm
 *
 * Of a map, every voxel whose value is a region chosen is a seed. Erosion keeps seeds away from the
 * borders of regions, where a map drawn on another head is least to be trusted; drawing keeps their
 * number small. Drawing is by integers only: going through the voxels in order, of a region with n
 * voxels left and k seeds to be drawn yet, a voxel is drawn with chance k / n (Knuth, TAOCP 2,
 * 3.4.2, algorithm S). So a region gives exactly what is asked, no voxel twice, and what is drawn
 * of it does not depend on other regions.
 *
 * The same input gives the same seeds on every machine, in order of cells, each cell once.
 */
#ifndef SESSION_SEED_FILE_H
#define SESSION_SEED_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"
#include "engine/forest.h"
#include "engine/grid.h"
#include "session/map.h"
#include "session/markers.h"
#include "session/session.h"
#include "session/state.h"

/* Of a list, the seeds of one label and reach. Its units are 1, or 0 for those of the world, which
 * the caller knows. */
struct seed_group {
    int16_t label;
    struct reach reach;
};

enum { SEED_GROUPS_FROM = 256 };
struct seeds {
    struct edit *edit; /* without their reaches */
    size_t count;
    uint16_t *region; /* of each: that of the map, or of a list the label, or from SEED_GROUPS_FROM
                         on a group's */
    struct seed_group *group; /* of a list; NULL for none */
    size_t groups;
};
void seeds_release(struct seeds *seeds);

/* The seeds of one region after the other, each in order of cells: *cell is an array of `count`
 * that the caller frees, and end[r] is where region r ends in it; `end` has REGION_MOST + 1.
 * ERR_MEMORY; ERR_CANCELLED by the watch, or NULL. */
enum err seeds_by_region(const struct seeds *seeds, uint32_t **cell, size_t *end,
                         struct watch *watch, struct fault *fault);

/* A sum mod 2^64 over the seeds of a mix of (cell, label), and of cell and reach. */
uint64_t seeds_digest(const struct seeds *seeds);

/* A list: `length` bytes at `text`, and a NUL after them. `label` is given to all seeds, or is
 * LABEL_OWN. On the first line that is wrong, or contradicts another, *seeds stays empty and the
 * words name it: ERR_INPUT. ERR_LIMIT, ERR_MEMORY; ERR_CANCELLED by the watch, or NULL. */
enum err seeds_from_list(struct seeds *seeds, const char *text, size_t length,
                         const struct grid *grid,
                         const char (*label_name)[LABEL_NAME_BYTES], /* [256] */
                         int label, struct watch *watch, struct fault *fault);

struct region_choice {
    uint32_t first, last; /* map values, 0..REGION_MOST */
    const uint16_t *as;   /* of these, those chosen and their labels (session/map.h); NULL: all
                             of them, each as a label of its number */
    int label;            /* of all seeds, whatever `as` says, or LABEL_OWN */
    unsigned erode;       /* rounds; a voxel stays while its six neighbours are of its region */
    uint32_t each;        /* seeds drawn of each region; 0 for every voxel */
    uint64_t generator;   /* another number draws other seeds */
};

/* The label of the seeds of a region that is chosen. */
unsigned region_label(const struct region_choice *choice, uint32_t region);

struct region_tally {
    uint32_t regions;     /* that gave seeds */
    uint32_t eroded_away; /* that had voxels, and none after erosion; the first of them: */
    uint32_t first_eroded_away;
};

/* A label map; its intensities are worked over, and of no use afterwards. `place` is the scene's.
 * ERR_INPUT, with *seeds empty, where the map is of another size, runs along other axes, holds what
 * is no label, or nothing is left to plant; also where the watch (or NULL) stops it. */
enum err seeds_from_map(struct seeds *seeds, struct region_tally *tally, struct volume *map,
                        const struct grid *grid, const struct geometry *place,
                        const struct region_choice *choice, struct watch *watch,
                        struct fault *fault);

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
