/* SPDX-License-Identifier: MIT */
#include "session/state.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/mem.h"
#include "engine/forest.h"
#include "render/border.h"

struct packed {
    size_t holders, length, packed_length;
    unsigned char *bytes;
};

/* zlib counts in 32 bits: longer input is processed in parts. */
static uInt part_of(size_t left, size_t most)
{
    return (uInt)(left > most ? most : left);
}

/* Deflate into `room` bytes, which suffice. False when out of memory. */
static bool deflate_all(struct packed *packed, const unsigned char *bytes, size_t room,
                        struct watch *watch)
{
    struct task task = task_begin(watch, "packing", packed->length);
    z_stream stream = {.next_in = (unsigned char *)(uintptr_t)bytes, .next_out = packed->bytes};
    int state = deflateInit(&stream, Z_BEST_SPEED);
    if (state != Z_OK)
        return false;
    for (size_t left = packed->length; state == Z_OK;) {
        const uInt part = part_of(left, TASK_STEP);
        stream.avail_in = part;
        stream.avail_out = part_of(room - (size_t)(stream.next_out - packed->bytes), UINT_MAX);
        left -= part;
        state = deflate(&stream, left ? Z_NO_FLUSH : Z_FINISH);
        if (!task_advance(&task, part))
            break;
    }
    packed->packed_length = (size_t)(stream.next_out - packed->bytes);
    deflateEnd(&stream);
    return state == Z_OK || state == Z_STREAM_END;
}

enum err packed_new(struct packed **out, const void *bytes, size_t length, struct watch *watch,
                    struct fault *fault)
{
    const size_t room = compressBound(length) + 64; /* for the parts that are deflated separately */
    OWNED(packed_release) struct packed *packed = mem_new(sizeof *packed);
    *out = NULL;
    if (!packed)
        return fault_memory(fault, "a map");
    packed->holders = 1;
    packed->length = length;
    packed->bytes = mem_array(room, 1);
    TRY(packed->bytes && deflate_all(packed, bytes, room, watch) ? watch_fault(watch, fault)
                                                                 : fault_memory(fault, "a map"));
    unsigned char *exact = realloc(packed->bytes, packed->packed_length);
    packed->bytes = exact ? exact : packed->bytes;
    *out = packed_hold(packed);
    return OK;
}

struct packed *packed_hold(struct packed *packed)
{
    if (packed)
        packed->holders++;
    return packed;
}

void packed_release(struct packed **packed)
{
    if (*packed && --(*packed)->holders == 0) {
        free((*packed)->bytes);
        free(*packed);
    }
    *packed = NULL;
}

/* Memory for the tables of inflating and its window of 32 kB: about 40 kB with zlib. */
struct room {
    size_t used;
    _Alignas(64) unsigned char bytes[96 << 10];
};

static void *take_memory(void *context, uInt items, uInt size)
{
    struct room *room = context;
    const size_t bytes = ((size_t)items * size + 63) / 64 * 64;
    if (bytes > sizeof room->bytes - room->used)
        return NULL;
    room->used += bytes;
    return room->bytes + room->used - bytes;
}

static void keep_memory(void *context, void *bytes)
{
    (void)context, (void)bytes;
}

/* Fill `out` with the next `length` bytes. */
static bool inflate_part(const struct packed *packed, z_stream *stream, unsigned char *out,
                         size_t length)
{
    int state = Z_OK;
    while (length > 0 && state == Z_OK) {
        const uInt room = part_of(length, UINT_MAX);
        const size_t read = (size_t)(stream->next_in - packed->bytes);
        stream->avail_in = part_of(packed->packed_length - read, UINT_MAX);
        stream->next_out = out;
        stream->avail_out = room;
        state = inflate(stream, Z_NO_FLUSH);
        out += room - stream->avail_out;
        length -= room - stream->avail_out;
    }
    return length == 0;
}

enum err packed_read(const struct packed *packed,
                     void (*take)(void *context, const void *piece, size_t length), void *context,
                     struct watch *watch, struct fault *fault)
{
    _Alignas(64) unsigned char piece[PACKED_PIECE];
    struct room room = {.used = 0};
    struct task task = task_begin(watch, "unpacking", packed->length);
    z_stream stream = {.zalloc = take_memory, .zfree = keep_memory, .opaque = &room};
    bool reads = inflateInit(&stream) == Z_OK;
    size_t left = packed->length;
    stream.next_in = packed->bytes;
    while (reads && left > 0) {
        const size_t part = left < sizeof piece ? left : sizeof piece;
        reads = inflate_part(packed, &stream, piece, part);
        if (reads)
            take(context, piece, part);
        left -= part;
        if (!task_advance(&task, part))
            return watch_fault(watch, fault);
    }
    return reads ? OK : fault_memory(fault, "a map of a former state");
}

static void take_copy(void *context, const void *piece, size_t length)
{
    unsigned char **to = context;
    memcpy(*to, piece, length);
    *to += length;
}

enum err packed_take_out(const struct packed *packed, void *out, struct watch *watch,
                         struct fault *fault)
{
    unsigned char *to = out;
    return packed_read(packed, take_copy, &to, watch, fault);
}

size_t packed_memory(const struct packed *packed)
{
    return packed ? sizeof *packed + packed->packed_length : 0;
}

/* ---- lists of edits ---- */

struct edit_room {
    size_t holders, rooms; /* lists and rooms that hold it; number of rooms among them */
    struct edit_room *before;
    size_t base; /* items of the list in `before`; the following ones are here */
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

/* Move the list to memory of its own if another list has appended to the shared memory, or if it
 * is empty. */
static bool own_room(struct edits *edits)
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

static enum err append(struct edits *edits, struct edit edit, struct fault *fault)
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
    return own_room(edits) ? append(edits, edit, fault) : fault_memory(fault, "an edit");
}

enum err edits_go_on(struct edits *edits, struct edit edit, struct fault *fault)
{
    struct edit_room *before = edits->room;
    assert(edits->first == 0);
    if (before && before->base + before->count == edits->end)
        return append(edits, edit, fault);
    struct edit_room *room = mem_new(sizeof *room);
    if (!room)
        return fault_memory(fault, "an edit");
    *room = (struct edit_room){.holders = 1, .before = before, .base = edits->end};
    struct edits longer = {room, 0, edits->end};
    const enum err err = append(&longer, edit, fault);
    if (err) {
        free(room);
        return err;
    }
    if (before) /* the room holds it now, instead of the list */
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
    packed_hold(kept->rest);
    for (unsigned i = 0; i < CHANNELS_MOST; i++)
        channel_values_hold(kept->channel[i].values);
}

void kept_release(struct kept *kept)
{
    packed_release(&kept->weight_map);
    packed_release(&kept->mask);
    packed_release(&kept->rest);
    for (unsigned i = 0; i < CHANNELS_MOST; i++)
        channel_values_release(&kept->channel[i].values);
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
