/*
 * The change log: what edits have changed since somebody last looked.
 *
 * A reader of labels that is asked now and then has the changes of each edit noted, which takes an
 * edit about a nanosecond a change, and follows them when asked. Where the labels of much of the
 * scene have changed, to count all again takes less time than to follow, and the log is given up:
 * so it is bounded, at half a byte a voxel.
 */
#ifndef ENGINE_CHANGE_LOG_H
#define ENGINE_CHANGE_LOG_H

#include "engine/forest.h"

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

#endif
