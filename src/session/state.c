/* SPDX-License-Identifier: MIT */
#include "session/state.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/forest.h"
#include "render/border.h"

/* ---- lists of edits ---- */

struct edit_room {
    size_t holders, rooms; /* lists and rooms that hold it; how many of them are rooms */
    struct edit_room *before;
    size_t base; /* so many items of the list lie there, and those from this one on here */
    struct edit *item;
    size_t count, capacity;
};

void edits_hold(const struct edits *edits)
{
    if (edits->room)
        edits->room->holders++;
}

void edits_release(struct edits *edits)
{
    struct edit_room *room = edits->room;
    while (room && --room->holders == 0) {
        struct edit_room *before = room->before;
        if (before)
            before->rooms--;
        free(room->item);
        free(room);
        room = before;
    }
    *edits = (struct edits){0};
}

/* Moves the list to memory of its own, where others have added to what they share, or it is empty:
 * what ran is let go of. */
static bool have_room(struct edits *edits)
{
    const size_t count = edits_count(edits);
    if (edits->room && count > 0 && edits->room->count == edits->end)
        return true;
    struct edit_room *room = mem_new(sizeof *room);
    if (!room || !mem_grow(&room->item, &room->capacity, count + 1, sizeof *room->item)) {
        free(room);
        return false;
    }
    if (count > 0)
        memcpy(room->item, edits_first(edits), count * sizeof *room->item);
    room->holders = 1;
    room->count = count;
    edits_release(edits);
    *edits = (struct edits){room, 0, count};
    return true;
}

static enum err add(struct edits *edits, struct edit edit, struct fault *fault)
{
    struct edit_room *room = edits->room;
    if (!mem_grow(&room->item, &room->capacity, room->count + 1, sizeof *room->item))
        return fault_memory(fault, "an edit");
    room->item[room->count++] = edit;
    edits->end = room->base + room->count;
    return OK;
}

enum err edits_add(struct edits *edits, struct edit edit, struct fault *fault)
{
    assert(!edits->room || !edits->room->before);
    return have_room(edits) ? add(edits, edit, fault) : fault_memory(fault, "an edit");
}

enum err edits_go_on(struct edits *edits, struct edit edit, struct fault *fault)
{
    struct edit_room *before = edits->room;
    assert(edits->first == 0);
    if (before && before->base + before->count == edits->end)
        return add(edits, edit, fault);
    struct edit_room *room = mem_new(sizeof *room);
    if (!room)
        return fault_memory(fault, "an edit");
    *room = (struct edit_room){.holders = 1, .before = before, .base = edits->end};
    struct edits longer = {room, 0, edits->end};
    const enum err err = add(&longer, edit, fault);
    if (err) {
        free(room);
        return err;
    }
    if (before) /* the room holds it from now on, and the list no more */
        before->rooms++;
    *edits = longer;
    return OK;
}

const struct edit *edits_first(const struct edits *edits)
{
    assert(!edits->room || !edits->room->before);
    return edits_count(edits) ? edits->room->item + edits->first : NULL;
}

const struct edit *edits_last(struct edits *edits, size_t *count)
{
    const struct edit_room *room = edits->room;
    const size_t end = edits->end;
    assert(edits->first == 0 && end > room->base);
    *count = end - room->base;
    *edits = (struct edits){room->before, 0, room->base};
    return room->item;
}

/* ---- the lists of a state ---- */

static bool is_copy(const struct edits *a, const struct edits *b)
{
    if (edits_count(a) == 0 || edits_count(b) == 0)
        return edits_count(a) == edits_count(b);
    return a->room == b->room && a->first == b->first && a->end == b->end;
}

static size_t memory_of(const struct edits *edits)
{
    const struct edit_room *room = edits->room;
    return room ? (sizeof *room + room->capacity * sizeof *room->item) /
                      (room->holders - room->rooms)
                : 0;
}

void edit_lists_hold(const struct edit_lists *lists)
{
    edits_hold(&lists->pending);
    edits_hold(&lists->markers);
    edits_hold(&lists->eliminators);
}

void edit_lists_release(struct edit_lists *lists)
{
    edits_release(&lists->pending);
    edits_release(&lists->markers);
    edits_release(&lists->eliminators);
}

bool edit_lists_are_copies(const struct edit_lists *a, const struct edit_lists *b)
{
    return is_copy(&a->pending, &b->pending) && is_copy(&a->markers, &b->markers) &&
           is_copy(&a->eliminators, &b->eliminators);
}

size_t edit_lists_memory(const struct edit_lists *lists)
{
    return memory_of(&lists->pending) + memory_of(&lists->markers) + memory_of(&lists->eliminators);
}

/* ---- states ---- */

void kept_show(const struct kept *kept, struct border *border)
{
    for (int label = 0; label < 256; label++)
        border->visible[label] = kept_shows(kept, label);
    memcpy(border->opacity, kept->opacity, sizeof border->opacity);
    border->cut = kept->cut;
}

void kept_hold(const struct kept *kept)
{
    packed_hold(kept->weight_map);
    packed_hold(kept->mask);
}

void kept_release(struct kept *kept)
{
    packed_release(kept->weight_map);
    packed_release(kept->mask);
    kept->weight_map = kept->mask = NULL;
}

void state_release(struct state *state)
{
    kept_release(&state->kept);
    edit_lists_release(&state->lists);
}

void state_assign(struct state *to, const struct state *from)
{
    struct state former = *to;
    kept_hold(&from->kept);
    edit_lists_hold(&from->lists);
    *to = *from;
    state_release(&former);
}
