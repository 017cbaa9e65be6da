/* SPDX-License-Identifier: MIT */
/*
 * Seeds out of files: a list of voxels, or a label map on the scene's grid.
 *
 * The caller reads the file and plants the seeds; this file converts bytes to seeds in memory. A
 * list is text, one seed per line; blank lines, comments and one header line are ignored:
 *
 *     x,y,z,label            # voxel indices from 0, a label's number or name
 *     70,110,95,brain
 *     10,10,10,0
 *     70,112,95,1,12,70,110,95     # within 12 voxels of 70,110,95, after a number only; or 2.5mm
 *     70,113,95,1,0,0,0,0          # within=0: no tree grows from it
 *
 * In a map, every voxel of a chosen region is a seed. Erosion keeps seeds away from the borders of
 * regions, where a map of another head is least reliable; drawing limits their number. Drawing uses
 * integers only: of a region with n voxels left and k seeds still to be drawn, the next voxel in
 * order is drawn with probability k / n (Knuth, TAOCP 2, 3.4.2, algorithm S). So a region yields
 * exactly the requested number, no voxel twice, independently of other regions.
 *
 * The same input yields the same seeds on every machine, in order of cells, each cell once.
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

/* Seeds of a list with one label and reach. The units of the reach are 1, or 0 for millimetres,
 * which the caller converts. */
struct seed_group {
    int16_t label;
    struct reach reach;
};

enum { SEED_GROUPS_FROM = 256 };
struct seeds {
    struct edit *edit; /* without reaches */
    size_t count;
    uint16_t *region;         /* region of each seed: that of the map; in a list the label, or the
                         group from SEED_GROUPS_FROM on */
    struct seed_group *group; /* groups of a list, or NULL */
    size_t groups;
};
void seeds_release(struct seeds *seeds);

/* Sort seeds by region, each region in order of cells: *cell is an array of `count`, freed by
 * the caller, and region r ends at end[r]; `end` has REGION_MOST + 1 entries. ERR_MEMORY;
 * ERR_CANCELLED by the watch, or NULL. */
enum err seeds_by_region(const struct seeds *seeds, uint32_t **cell, size_t *end,
                         struct watch *watch, struct fault *fault);

/* Sum mod 2^64 over the seeds of a mix of (cell, label), and of cell and reach. */
uint64_t seeds_digest(const struct seeds *seeds);

/* Read a list: `length` bytes at `text`, followed by a NUL. `kept` has the names and numbers of
 * labels; `label` is that of all seeds, or LABEL_OWN. On errors *seeds stays empty: ERR_INPUT names
 * the first line that is wrong or contradicts another; ERR_LIMIT, ERR_MEMORY; ERR_CANCELLED by the
 * watch, or NULL. */
enum err seeds_from_list(struct seeds *seeds, const char *text, size_t length,
                         const struct grid *grid, const struct kept *kept, int label,
                         struct watch *watch, struct fault *fault);

struct region_choice {
    uint32_t first, last; /* map values, 0..REGION_MOST */
    const uint16_t *as;   /* chosen regions and their labels (session/map.h); NULL: all, each
                             as the label of its number */
    int label;            /* label of all seeds, in place of `as`, or LABEL_OWN */
    unsigned erode;       /* rounds; a voxel remains while its six neighbours are of its region */
    uint32_t each;        /* seeds to draw from each region; 0 for every voxel */
    uint64_t generator;   /* another number draws other seeds */
};

/* Label of the seeds of a chosen region. */
unsigned region_label(const struct region_choice *choice, uint32_t region);

struct region_tally {
    uint32_t regions;     /* regions with seeds */
    uint32_t eroded_away; /* regions with voxels, but none after erosion; the first of them: */
    uint32_t first_eroded_away;
};

/* Read a label map on the grid (map_read); its intensities are overwritten. On errors *seeds is
 * empty: those of map_to_regions, and ERR_INPUT if a chosen region has no label, or no seed
 * remains. */
enum err seeds_from_map(struct seeds *seeds, struct region_tally *tally, struct volume *map,
                        const struct grid *grid, const struct region_choice *choice,
                        struct watch *watch, struct fault *fault);

/*
 * Markers out of a segmentation: one for each piece of each label.
 *
 * A piece is a component (engine/components.h). It is eroded in rounds: each round removes
 * voxels with a face neighbour of another label; the outside of the scene removes none. A piece
 * that would vanish has fewer rounds, and keeps its innermost voxels. So the forest decides the
 * borders of the segmentation, as wide as the erosion, and no piece is lost.
 *
 * Seeds are only the contour of the remaining voxels (engine/distance.h). A path to the voxels
 * inside passes through it, so they have the same label as if all were seeds. But a later
 * correcting seed inside can grow, unlike a seed among seeds; and seeds take memory by the
 * surface, not by the volume. Seeds near a correction also give way to it if the marker yields
 * (session/markers.h); for this, the voxels of each piece are listed as runs.
 */

enum { PIECE_ERODE_MOST = 100 };

struct piece {
    size_t end;     /* end of its seeds in `cell`; they begin at the end of the piece before */
    size_t run_end; /* end of its runs in `run`, likewise; no runs if all its voxels are seeds */
    uint8_t label;
};

struct piece_seeds {
    uint32_t *cell; /* seeds of a piece in order */
    size_t count, capacity;
    struct marker_run *run; /* runs of a piece in order: the whole piece, before the erosion */
    size_t runs, run_capacity;
    struct piece *piece; /* in the order of their first voxels */
    size_t pieces, piece_capacity;
    size_t small;         /* pieces with fewer rounds */
    size_t left_out;      /* pieces that are too small to be planted */
    uint32_t labels[256]; /* pieces of each label */
};
void piece_seeds_release(struct piece_seeds *seeds);

/* Conversion of pieces to seeds. */
struct piece_choice {
    unsigned erode; /* rounds */
    uint32_t least; /* leave out pieces of fewer voxels */
    uint16_t rest;  /* label for REGION_NONE; or REGION_NONE, which has no seeds and differs
                       from every label */
};

/* region[z][y][x] is a label 0..255, or REGION_NONE. Needs two bytes per voxel. ERR_INPUT if the
 * map has all 256 labels and a REGION_NONE without a label, ERR_MEMORY, ERR_CANCELLED by the watch,
 * or NULL; then *seeds is empty. */
enum err piece_seeds_make(struct piece_seeds *seeds, const uint16_t *region,
                          const struct grid *grid, const struct piece_choice *choice,
                          struct watch *watch, struct fault *fault);

#endif
