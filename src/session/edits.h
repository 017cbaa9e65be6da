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

/* Puts those from the `first` on, which no other list has yet, in the order of their cells. */
void edits_sort_from(struct edits *edits, size_t first);

/* The first of edits_count items; NULL where there are none. */
const struct edit *edits_first(const struct edits *edits);

static inline size_t edits_count(const struct edits *edits)
{
    return edits->end - edits->first;
}

/*
 * The lists of a state, held, released, compared and measured together.
 *
 *     pending      edits of seeds that wait for a run; a later one of a voxel wins
 *     markers      {number, 1} for a marker that is put up, {number, EDIT_ERASE} for one that is
 *                  taken away; the last of a number decides whether it stands (session/markers.h)
 *     eliminators  where the user has put them, to be marked in slices: those of the last run, and
 *                  after them those that wait. What they do is among the pending edits
 */
struct edit_lists {
    struct edits pending, markers, eliminators;
    size_t applied; /* how many eliminators, from the first one on, were of the last run */
};

void edit_lists_hold(const struct edit_lists *lists);
void edit_lists_release(struct edit_lists *lists);

/* Whether each list is a copy of the other's; lists made apart differ unless both are empty. */
bool edit_lists_are_copies(const struct edit_lists *a, const struct edit_lists *b);

/* Bytes that they take, the memory of each divided among those that hold it. */
size_t edit_lists_memory(const struct edit_lists *lists);

#endif
