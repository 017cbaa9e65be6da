/* SPDX-License-Identifier: MIT */
/*
 * Markers: what commands have planted and erased, each as one thing.
 *
 * A *marker* is what one command plants under one label: a ball, a stroke, a region of a file. An
 * outline has two parts, its inside and a ring of the background, and a stroke as many as commands
 * have made it: each has a number, and that of the first is the number of all. An *eraser* is a
 * marker that plants nothing: its voxels have no seed, whatever lies below. Markers are numbered
 * from 1 in the order of their commands. Where several cover a voxel, the latest that stands
 * decides; when it goes, what the one below says holds again:
 *
 *     marker 1, label 1              1 1 1 1 1 . .
 *     marker 2, label 2              . . 2 2 2 2 .
 *     eraser 3                       . . . . e e .
 *     seeds while all stand          1 1 2 2 . . .
 *     and with marker 2 taken away   1 1 1 1 . . .
 *
 * The markers of a segmentation out of a file *yield*: its seeds are walls of the thickness of a
 * voxel around each piece, so that a seed beside a border that is wrong would move nothing. A later
 * marker *frees* voxels around itself: while it stands, markers that give way to it decide nothing
 * there.
 *
 *     markers 1 and 2 of a file      1 1 1 1 2 2 2 2     3 is planted in the piece of 2,
 *     marker 3, label 1              . . . . f 3 f .     and frees what f is below
 *     seeds while all stand          1 1 1 1 . 3 . 2
 *     and with marker 3 taken away   1 1 1 1 2 2 2 2
 *
 * What is left of the piece then has seeds in the voxels beside those, corners included, though it
 * had none within: so trees of the later marker end there, however thick the piece is.
 *
 * A marker gives way to a later one of another label, of which a voxel lies in its piece, and to no
 * other: what belongs to third labels stays as it is.
 *
 * Which of them stand is part of a session's state (session/state.h); here is what they cover, of
 * all that were ever made, on every branch of the history.
 *
 * Invariants
 *   M1 the seeds are a function of the set of markers that stand, whatever the order in which they
 *      were taken away and put back;
 *   M2 a marker never changes, and its number is never given to another, unless it was dropped: so
 *      a number in a record names the same voxels for good;
 *   M3 the parts of a stroke or an outline follow each other, and a part stands only where those
 *      before it do;
 *   M4 whether a marker gives way to another, and where, follows from the two alone, and from no
 *      forest, run or third marker: so M1 and M2 hold of it too.
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
    uint32_t first, voxels; /* in `cover`: those that it has seeds in, */
    uint32_t frees;         /* and after them those that it frees, and those beside them */
    uint32_t run, runs;     /* in `run`: the piece of one that yields; none: it is its `voxels` */
    int16_t label;          /* 0..255, or EDIT_ERASE for an eraser */
    uint16_t reach;         /* of its seeds (forest_add_reach), or 0 */
    bool stands;
    bool joined; /* to the marker before, as a part of one thing (M3) */
    bool yields;
};

/* That a marker covers a voxel; or of one that gives way to it, that it frees the voxel, or is
 * beside what it frees. */
struct cover {
    uint32_t cell, marker;
    uint32_t from : 31;     /* the marker that gives way; 0: it covers the voxel */
    uint32_t is_beside : 1; /* that one has a seed here */
    uint32_t below;         /* the next older one of the same bucket; COVER_NONE for none */
};

/* {0} is empty. */
struct markers {
    struct marker *marker; /* marker[n - 1] has number n */
    size_t count, capacity;
    size_t former; /* numbers up to this one name voxels of the scene before it was interpolated */
    struct cover *cover; /* those of a marker together, in the order in which it was given them */
    size_t covers, cover_capacity;
    struct marker_run *run; /* those of a marker together and in order */
    size_t runs, run_capacity;
    uint32_t *bucket; /* by voxel: the latest cover of each, COVER_NONE for none */
    size_t buckets;   /* a power of two, or 0 */
    bool yields;      /* one of them may */
    bool ends;        /* one of them has seeds beside what is freed */
};

#define COVER_NONE UINT32_MAX

void markers_release(struct markers *markers);
size_t markers_memory(const struct markers *markers);

/* A marker that does not stand yet, over some voxels. Its number is markers->count
 * then. ERR_MEMORY, ERR_LIMIT and ERR_CANCELLED, by the watch, or NULL, leave all as it was. */
enum err markers_add(struct markers *markers, int16_t label, const uint32_t *cell, size_t count,
                     struct watch *watch, struct fault *fault);

/* The last one yields: that of a piece of a file, which it has seeds in the outer voxels of. The
 * runs are those of the piece in order, none where all its voxels have seeds. ERR_MEMORY leaves
 * all as it was. */
enum err markers_yield(struct markers *markers, const struct marker_run *run, size_t runs,
                       struct fault *fault);

/* The last one, which covers its voxels in order, frees those of `cell` in which a marker
 * gives way to it; `around` is what is beside a voxel. On errors, those of markers_add, it frees a
 * part of them, and is to be dropped. */
enum err markers_free(struct markers *markers, const struct cell *cells,
                      const struct adjacency *around, const uint32_t *cell, size_t count,
                      struct watch *watch, struct fault *fault);

/* Those above number `count` were never added. Watched, and not to be stopped. */
void markers_drop(struct markers *markers, size_t count, struct watch *watch);

/* Whether any of all markers can have a seed in a voxel. */
bool markers_can_plant(const struct markers *markers, uint32_t cell);

/* The number of the marker that decides about a voxel; 0 where none that stands covers it. It may
 * be an eraser. */
uint32_t markers_at(const struct markers *markers, uint32_t cell);

/* Whether the seed of a voxel is marked in pictures: it was placed, and is none of those in the
 * outer voxels of a piece of a file, of which all that is seen would be marks. `markers` are those;
 * a seed that none of them decides about is marked. */
bool markers_show(const void *markers, uint32_t cell);

/* The first part of a marker's stroke; and the next one that stands, 0 for none. */
uint32_t markers_stroke(const struct markers *markers, uint32_t number);
uint32_t markers_next(const struct markers *markers, uint32_t number);

/* The edit that gives a voxel the seed that those that stand give it, or none; and its label,
 * EDIT_ERASE for none. */
struct edit markers_edit(const struct markers *markers, uint32_t cell);
int16_t markers_seed(const struct markers *markers, uint32_t cell);

#endif
