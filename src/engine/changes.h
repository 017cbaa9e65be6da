/* SPDX-License-Identifier: MIT */
/*
 * Changes made by edits of the forest: the list of the last edit, and logs over several edits.
 *
 * A change log collects the changes since its reader last refreshed. A reader of labels that is
 * refreshed now and then appends the changes of each edit, about a nanosecond a change, and applies
 * them on demand. If the labels of much of the scene have changed, a recount is faster, and the log
 * is discarded: so its size is bounded, at half a byte a voxel.
 */
#ifndef ENGINE_CHANGES_H
#define ENGINE_CHANGES_H

#include "engine/scene.h"

/* A voxel that the last edit relabelled. */
struct change {
    uint32_t cell;
    uint8_t former_label, label;
};

/* The voxels that the last edit relabelled, each once, in no order. After a rebuild, or for more
 * than a sixteenth of the scene, `everything` is set and `count` is 0: readers scan the scene
 * instead. */
struct changes {
    bool everything;
    size_t count;
    const struct change *item;
    size_t listed;   /* items in the list: the first ones of a list that became too long */
    uint64_t voxels; /* number of relabelled voxels */
};

/* Work of the last edit. */
struct forest_stats {
    uint64_t served;  /* voxels whose final key was offered to the neighbours */
    uint64_t cleared; /* voxels that lost their tree on the way */
    uint64_t touched; /* voxels whose key or label was recomputed; all, in a rebuild */
};

/* ---- the log of a reader ---- */

/* {0} is a log that does not follow yet: its reader has not counted anything. */
struct change_log {
    bool follows; /* the items, in order, lead from the reader's state to the current one */
    size_t count, capacity;
    struct change *item;
};

/* Append the changes of one edit. The log is discarded if they are everything, too many for a scene
 * of `voxels`, or if memory runs out. */
void change_log_add(struct change_log *log, const struct changes *changes, size_t voxels);

void change_log_give_up(struct change_log *log);

/* Restart the log after the reader has refreshed; on an error, discard it. Return the error. */
enum err change_log_settle(struct change_log *log, enum err err);
void change_log_release(struct change_log *log);

#endif
