/* SPDX-License-Identifier: MIT */
/*
 * Markers: the seeds of each command, planted and erased as one unit.
 *
 * A *marker* is all seeds of one command under one label: a ball, a stroke, a region of a file. An
 * outline has two parts, its inside and a ring of the background; a stroke has as many parts as
 * commands made it. Each part has a number, and that of the first part is the number of the whole.
 * An *eraser* is a marker that plants nothing: its voxels have no seed, whatever older markers say.
 * Markers are numbered from 1 in the order of their commands. A marker is valid until it is
 * removed. If several cover a voxel, the latest valid one decides; when it is removed, the one
 * below it decides again:
 *
 *     marker 1, label 1              1 1 1 1 1 . .
 *     marker 2, label 2              . . 2 2 2 2 .
 *     eraser 3                       . . . . e e .
 *     seeds while all are valid      1 1 2 2 . . .
 *     and with marker 2 removed      1 1 1 1 . . .
 *
 * The markers of a segmentation out of a file *yield*: their seeds are walls one voxel thick around
 * each piece, so that a seed next to a wrong border would change nothing. A later marker *frees*
 * voxels around itself: while it is valid, markers that yield to it do not decide there.
 *
 *     markers 1 and 2 of a file      1 1 1 1 2 2 2 2     3 is planted in the piece of 2,
 *     marker 3, label 1              . . . . f 3 f .     and frees the voxels f
 *     seeds while all are valid      1 1 1 1 . 3 . 2
 *     and with marker 3 removed      1 1 1 1 2 2 2 2
 *
 * The remaining piece then has seeds in the voxels next to the freed ones, corners included, even
 * inside: so trees of the later marker end there, however thick the piece is.
 *
 * A marker yields to a later one of another label with a voxel in its piece, and to no other:
 * third labels are unchanged.
 *
 * An *exact* marker changes its own voxels and no others: no tree grows from its seeds. It frees
 * its own voxels alone, from markers of every label, its own too: so that the voxels of a piece
 * next to it have seeds, and no part of the piece loses its tree.
 *
 * The set of valid markers is part of a session's state (session/state.h). Here are the voxels of
 * all markers ever made, on every branch of the history.
 *
 * Invariants
 *   M1 the seeds are a function of the set of valid markers, whatever the order in which they were
 *      removed and restored;
 *   M2 a marker never changes, and its number is never reused, unless it was dropped: so a
 *      number in a record always means the same voxels;
 *   M3 the parts of a stroke or an outline follow each other, and a part is valid only if those
 *      before it are;
 *   M4 whether and where a marker yields to another depends on these two only, not on the forest,
 *      a run or a third marker: so M1 and M2 include it.
 */
#ifndef SESSION_MARKERS_H
#define SESSION_MARKERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"
#include "engine/forest.h"

/* Voxels first..end-1 of a row. */
struct marker_run {
    uint32_t first, end; /* cells */
};

struct marker {
    uint32_t first, voxels; /* in `cover`: voxels with seeds, */
    uint32_t frees;         /* followed by freed voxels and their neighbours */
    uint32_t run, runs;     /* in `run`: the piece of a yielding marker; none: the piece is
                               its `voxels` */
    int16_t label;          /* 0..255, or EDIT_ERASE for an eraser */
    uint16_t reach;         /* reach of its seeds (forest_add_reach), or 0 */
    bool is_valid;
    bool joined; /* part of the same stroke or outline as the marker before (M3) */
    bool yields;
    bool is_exact; /* no tree grows from its seeds (REACH_EXACT) */
};

/* One voxel of a marker: covered by it, freed by it from a yielding marker, or next to a freed
 * one. */
struct cover {
    uint32_t cell, marker;
    uint32_t from : 31;     /* the yielding marker; 0: the voxel is covered */
    uint32_t is_beside : 1; /* the yielding marker has a seed here */
    uint32_t below;         /* the next older cover in the bucket; COVER_NONE for none */
};

/* {0} is empty. */
struct markers {
    struct marker *marker; /* marker[n - 1] has number n */
    size_t count, capacity;
    size_t former; /* markers up to this number name voxels of the scene before interpolation */
    struct cover *cover; /* covers of a marker are contiguous, in the given order */
    size_t covers, cover_capacity;
    struct marker_run *run; /* runs of a marker are contiguous and in order */
    size_t runs, run_capacity;
    uint32_t *bucket; /* latest cover of the voxels of each bucket, or COVER_NONE */
    size_t buckets;   /* a power of two, or 0 */
    bool yields;      /* a marker may yield */
    bool ends;        /* a marker has seeds next to freed voxels */
};

#define COVER_NONE UINT32_MAX

void markers_release(struct markers *markers);
size_t markers_memory(const struct markers *markers);

/* Add a marker, not valid yet, over some voxels. Its number is then markers->count. ERR_MEMORY,
 * ERR_LIMIT and ERR_CANCELLED, by the watch, or NULL: no change. */
enum err markers_add(struct markers *markers, int16_t label, const uint32_t *cell, size_t count,
                     struct watch *watch, struct fault *fault);

/* Make the last marker yield: it is the piece of a file, with seeds in its outer voxels. The runs
 * are those of the piece in order, none if all its voxels have seeds. ERR_MEMORY, ERR_LIMIT: no
 * change. */
enum err markers_yield(struct markers *markers, const struct marker_run *run, size_t runs,
                       struct fault *fault);

/* The last marker, which covers its voxels in order, frees the voxels of `cell` in which a marker
 * yields to it; an exact marker decides there anyway, so its voxels need no covers. `around` are
 * the neighbours of a voxel. On errors, those of markers_add, drop the marker: it frees only a
 * part. */
enum err markers_free(struct markers *markers, const struct cell *cells,
                      const struct adjacency *around, const uint32_t *cell, size_t count,
                      struct watch *watch, struct fault *fault);

/* Remove the markers above number `count`. Watched, but cannot be stopped. */
void markers_drop(struct markers *markers, size_t count, struct watch *watch);

/* True if any marker can have a seed in a voxel. */
bool markers_can_plant(const struct markers *markers, uint32_t cell);

/* Number of the marker that decides about a voxel, possibly an eraser; 0 if no valid marker
 * covers it. */
uint32_t markers_at(const struct markers *markers, uint32_t cell);

/* True if the seed of a voxel is marked in pictures. Seeds in the outer voxels of a piece of a
 * file are not: marks would hide everything. A seed without a deciding marker is marked. `markers`
 * is a struct markers. */
bool markers_show(const void *markers, uint32_t cell);

/* Objects of the valid markers up to number `count`. */
struct marker_kinds {
    bool has_pieces; /* pieces of a segmentation, of a file or the session's own, */
    bool has_grown;  /* objects grown from seeds that no later segmentation has erased, */
    bool has_exact;  /* and exact markers */
};
struct marker_kinds markers_kinds(const struct markers *markers, size_t count);

/* First part of a marker's stroke; and the next valid part, or 0. */
uint32_t markers_stroke(const struct markers *markers, uint32_t number);
uint32_t markers_next(const struct markers *markers, uint32_t number);

/* The edit by which a voxel has the seed of the valid markers, or no seed; and its label, or
 * EDIT_ERASE. */
struct edit markers_edit(const struct markers *markers, uint32_t cell);
int16_t markers_seed(const struct markers *markers, uint32_t cell);

#endif
