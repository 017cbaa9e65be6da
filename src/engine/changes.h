/* SPDX-License-Identifier: MIT */
/*
 * What edits of the forest change: the list that an edit leaves, and what is kept beyond the edit.
 *
 * The change log is of what edits have changed since somebody last looked. A reader of labels that
 * is asked now and then has the changes of each edit noted, which takes an edit about a nanosecond
 * a change, and follows them when asked. Where the labels of much of the scene have changed, to
 * count all again takes less time than to follow, and the log is given up: so it is bounded, at
 * half a byte a voxel.
 *
 * Where all grows anew there is no list. Former labels, as runs of equal ones along rows, then say
 * how many have changed. Labels lie together, so that takes little memory: 8 bytes a run, and some
 * hundred thousand runs where a head has four objects.
 */
#ifndef ENGINE_CHANGES_H
#define ENGINE_CHANGES_H

#include "engine/scene.h"

/* A voxel to which the last edit gave another label. */
struct change {
    uint32_t cell;
    uint8_t former_label, label;
};

/* The voxels to which the last edit gave another label, each once, in no order. Where the forest
 * grew from nothing, or that is more than a sixteenth of the scene, `everything` is set and `count`
 * is 0: readers scan the scene once instead. */
struct changes {
    bool everything;
    size_t count;
    const struct change *item;
    size_t listed;   /* items that are there: the first ones, where a list has become too long */
    uint64_t voxels; /* how many got another label; CHANGES_UNKNOWN where all grew anew uncounted */
};
#define CHANGES_UNKNOWN UINT64_MAX

/* What the last edit took. */
struct forest_stats {
    uint64_t served;  /* voxels whose final key was passed on to the neighbours */
    uint64_t cleared; /* voxels that lost their tree on the way */
    uint64_t raised;  /* voxels that took another root at their level, for theirs had gone */
    uint64_t touched; /* voxels whose key or label was computed again; all, from nothing */
};

/* ---- the log of a reader ---- */

/* {0} is of a reader that has looked at nothing yet. */
struct change_log {
    bool follows; /* what the reader has, and these changes, in this order, lead to what is */
    size_t count, capacity;
    struct change *item;
};

/* Those of one edit. The log is given up where they are everything, or too many for a scene of so
 * many voxels, or memory runs out. */
void change_log_add(struct change_log *log, const struct changes *changes, size_t voxels);

void change_log_give_up(struct change_log *log);

/* The reader has looked at all there is, or, on an error, lost what it had. Returns the error. */
enum err change_log_settle(struct change_log *log, enum err err);
void change_log_release(struct change_log *log);

/* ---- labels of before all grows anew ---- */

struct label_run {
    uint32_t end; /* the cell after its last one */
    uint8_t label;
};

/* {0} is of nothing. */
struct former_labels {
    struct label_run *run;
    size_t count, capacity;
    bool taken;
};

/* As labels are now, or, in the middle of an edit, were before it. Where memory runs out, or
 * the scene's watch stops it, nothing is `taken`. */
void former_labels_take(struct former_labels *former, const struct scene *scene);

/* How many voxels have another label now. Of no use where the scene's watch has stopped it. */
uint64_t former_labels_differences(const struct former_labels *former, const struct scene *scene);
void former_labels_release(struct former_labels *former);

#endif
