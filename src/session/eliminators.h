/*
 * Where the user has put eliminators: those that wait for a run, and those of the last run, to be
 * marked in slices. What they do is in the edits that wait (session.h); here they are only known.
 *
 * Invariant: a function of the commands that stand. The list only grows within a command, so
 * taking a command back is taking back where its two parts begin and end.
 */
#ifndef SESSION_ELIMINATORS_H
#define SESSION_ELIMINATORS_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

struct eliminators {
    uint32_t *cell;
    size_t capacity;
    size_t first, waiting, end; /* of the last run: [first, waiting); waiting: [waiting, end) */
    size_t mark[3];             /* these three as of the mark */
};

void eliminators_release(struct eliminators *eliminators);

/* One more that waits. ERR_MEMORY leaves the list as it was. */
enum err eliminators_add(struct eliminators *eliminators, uint32_t cell, struct fault *fault);

/* A run: those that waited are its own, those before are forgotten. */
void eliminators_apply(struct eliminators *eliminators);

/* All are forgotten: their cells are those of another scene. */
void eliminators_forget(struct eliminators *eliminators);

void eliminators_mark(struct eliminators *eliminators);
void eliminators_rollback(struct eliminators *eliminators);

#endif
