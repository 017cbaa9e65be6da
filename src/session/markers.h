/*
 * Markers: what commands have planted and erased, each as one thing.
 *
 * A *marker* is what one command plants under one label: a ball, a stroke, a region of a file. An
 * *eraser* is a marker that plants nothing: its voxels have no seed, whatever lies below. Markers
 * are numbered from 1 in the order of their commands. Where several cover a voxel, the latest that
 * stands decides; when it goes, what the one below says holds again:
 *
 *     marker 1, label 1            1 1 1 1 1 . .
 *     marker 2, label 2            . . 2 2 2 2 .
 *     eraser 3                     . . . . e e .
 *     seeds while all stand        1 1 2 2 . . .
 *     and with marker 2 taken away 1 1 1 1 . . .
 *
 * Each marker *stands* or not: that is the state of the segmentation. Each is *planted* or not: that
 * is what the forest has. An edit of the forest leads from the seeds of those planted to the seeds
 * of those that are planned to be.
 *
 * Invariants
 *   M1 the seed of a voxel is a function of the set of markers, whatever the order in which they
 *      were taken away and put back;
 *   M2 a marker never changes and its number is never given to another, unless it was dropped
 *      before the next one was added: so a number names the same voxels for ever.
 */
#ifndef SESSION_MARKERS_H
#define SESSION_MARKERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "engine/forest.h"

struct marker {
    size_t first, voxels; /* in `covered` */
    int16_t label;        /* 0..255, or EDIT_ERASE for an eraser */
    bool stands, planted, planned;
};

/* That a marker covers a voxel. */
struct cover {
    uint32_t cell, marker;
    uint32_t below; /* the next older one of the same bucket */
};

struct markers {
    struct marker *marker; /* marker[n - 1] has number n */
    size_t count, capacity;
    struct cover *covered; /* those of a marker together, in the order in which it was given them */
    size_t covers, cover_capacity;
    uint32_t *bucket; /* the latest cover of each, COVER_NONE for none */
    size_t buckets;   /* a power of two, or 0 */
};

#define COVER_NONE UINT32_MAX

void markers_release(struct markers *markers);
size_t markers_memory(const struct markers *markers);

/* A marker that stands and is not planted, over voxels that are each named once. Its number is
 * markers->count then. ERR_MEMORY, ERR_LIMIT leave all as it was. */
enum err markers_add(struct markers *markers, int16_t label, const uint32_t *cell, size_t count,
                     struct fault *fault);

/* The latest marker, which is neither planted nor planned, as if it had not been added. */
void markers_drop(struct markers *markers);

/* Which set of markers is asked about. */
enum marker_set { MARKERS_STANDING, MARKERS_PLANTED, MARKERS_PLANNED };

/* The marker of the set that decides about a voxel: 0 where none covers it. It may be an eraser. */
uint32_t markers_at(const struct markers *markers, enum marker_set set, uint32_t cell);

/* The label of the seed that a set gives a voxel, or EDIT_ERASE for none. */
int16_t markers_seed(const struct markers *markers, enum marker_set set, uint32_t cell);

/* From now on those are planned that stand. */
void markers_plan_standing(struct markers *markers);

/* The edits that lead from the seeds of those planted to the seeds of those planned, each voxel
 * once: an array that the caller frees. ERR_MEMORY. */
enum err markers_edits(const struct markers *markers, struct edit **edit, size_t *count,
                       struct fault *fault);

/* The forest has taken these edits. */
void markers_plant(struct markers *markers);

#endif
