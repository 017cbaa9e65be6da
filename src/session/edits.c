#include "session/edits.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

struct edit_room {
    size_t holders;
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
    if (room && --room->holders == 0) {
        free(room->item);
        free(room);
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

enum err edits_add(struct edits *edits, struct edit edit, struct fault *fault)
{
    if (!have_room(edits))
        return fault_memory(fault, "an edit");
    struct edit_room *room = edits->room;
    if (!mem_grow(&room->item, &room->capacity, room->count + 1, sizeof *room->item))
        return fault_memory(fault, "an edit");
    room->item[room->count++] = edit;
    edits->end = room->count;
    return OK;
}

const struct edit *edits_first(const struct edits *edits)
{
    return edits_count(edits) ? edits->room->item + edits->first : NULL;
}

bool edits_is_copy(const struct edits *a, const struct edits *b)
{
    if (edits_count(a) == 0 || edits_count(b) == 0)
        return edits_count(a) == edits_count(b);
    return a->room == b->room && a->first == b->first && a->end == b->end;
}

size_t edits_memory(const struct edits *edits)
{
    const struct edit_room *room = edits->room;
    return room ? (sizeof *room + room->capacity * sizeof *room->item) / room->holders : 0;
}
