/*
 * Edits in order: a list that is a value.
 *
 * A copy takes no time and shares the memory; adding to one list changes no other, even where they
 * share. So every state of a session has its own list of the edits that wait for a run, and all of
 * them together take the memory of one.
 *
 * Invariant: items before `end` of any list that holds the room are never written again.
 */
#ifndef SESSION_EDITS_H
#define SESSION_EDITS_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/forest.h"

struct edit_room;

/* {0} is empty. */
struct edits {
    struct edit_room *room;
    size_t first, end; /* items of the room that are in the list */
};

/* One holder of the memory more, or fewer. A released list is empty. */
void edits_hold(const struct edits *edits);
void edits_release(struct edits *edits);

/* Adds to a list that is held. ERR_MEMORY leaves it as it was. */
enum err edits_add(struct edits *edits, struct edit edit, struct fault *fault);

/* The first of edits_count items; NULL where there are none. */
const struct edit *edits_first(const struct edits *edits);

static inline size_t edits_count(const struct edits *edits)
{
    return edits->end - edits->first;
}

/* Whether one list is a copy of the other; lists made apart differ unless both are empty. */
bool edits_is_copy(const struct edits *a, const struct edits *b);

/* Bytes that the list takes, its memory divided among those that hold it. */
size_t edits_memory(const struct edits *edits);

#endif
