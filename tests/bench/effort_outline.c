/* SPDX-License-Identifier: MIT */
#include "tests/bench/effort_outline.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "engine/overlap.h"

/* ---- slices ---- */

/* A slice across an axis: where its voxels are in [z][y][x]. */
struct plane {
    int axis, along[2];
    uint32_t at, size[2];
    size_t first, step[2];
};

static struct plane plane_of(const struct effort_object *object, int axis, uint32_t at)
{
    const size_t step[3] = {1, object->size[0], (size_t)object->size[0] * object->size[1]};
    struct plane plane = {.axis = axis, .along = {axis == 0, axis == 2 ? 1 : 2}, .at = at};
    plane.first = at * step[axis];
    for (int i = 0; i < 2; i++)
        plane.size[i] = object->size[plane.along[i]], plane.step[i] = step[plane.along[i]];
    return plane;
}

static size_t pixels(const struct plane *plane)
{
    return (size_t)plane->size[0] * plane->size[1];
}

/* Of a pixel of the slice, the voxel. */
static size_t voxel_of(const struct plane *plane, size_t pixel)
{
    return plane->first + pixel % plane->size[0] * plane->step[0] +
           pixel / plane->size[0] * plane->step[1];
}

enum err effort_outliner_init(struct effort_outliner *o, const struct effort_object *object,
                              enum outline_next next, unsigned hand, struct fault *fault)
{
    size_t largest = 0;
    *o = (struct effort_outliner){.object = object, .next = next, .hand = hand};
    for (const char *at = object->name; *at; at++)
        o->random = hash_mix_at(o->random, (uint8_t)*at);
    bool fits = true;
    for (int a = 0; a < 3; a++) {
        const struct plane plane = plane_of(object, a, 0);
        largest = pixels(&plane) > largest ? pixels(&plane) : largest;
        o->is_drawn[a] = mem_array(object->size[a], sizeof *o->is_drawn[a]);
        fits &= o->is_drawn[a] != NULL;
        if (o->is_drawn[a])
            memset(o->is_drawn[a], 0, object->size[a] * sizeof *o->is_drawn[a]);
    }
    o->covered = mem_new(object->voxels);
    o->drawn = mem_new(object->voxels);
    o->wrong.voxel = mem_array(largest, 1);
    o->piece.voxel = mem_array(largest, 1);
    o->stack = mem_array(largest, sizeof *o->stack);
    fits &= o->covered && o->drawn && o->wrong.voxel && o->piece.voxel && o->stack;
    return fits ? OK : fault_memory(fault, "a robot");
}

void effort_outliner_release(struct effort_outliner *o)
{
    for (int a = 0; a < 3; a++)
        free(o->is_drawn[a]);
    free(o->covered);
    free(o->drawn);
    free(o->wrong.voxel);
    free(o->piece.voxel);
    free(o->stack);
    hand_outline_release(&o->outline);
    *o = (struct effort_outliner){0};
}

/* ---- pieces ---- */

/* The piece (by edges) of those of a value that a pixel belongs to becomes another value; how many
 * there are. */
static size_t flood(uint8_t *pixel, const struct plane *plane, uint32_t *stack, size_t from,
                    uint8_t value)
{
    const size_t w = plane->size[0], all = pixels(plane);
    const uint8_t former = pixel[from];
    size_t top = 0, count = 0;
    pixel[from] = value;
    for (stack[top++] = (uint32_t)from; top; count++) {
        const size_t i = stack[--top], x = i % w;
        const size_t near[4] = {x > 0 ? i - 1 : i, x + 1 < w ? i + 1 : i, i >= w ? i - w : i,
                                i + w < all ? i + w : i};
        for (int n = 0; n < 4; n++)
            if (pixel[near[n]] == former) {
                pixel[near[n]] = value;
                stack[top++] = (uint32_t)near[n];
            }
    }
    return count;
}

/* The slice of `from` in `pixel`, as 0 and 1, but for voxels that have a bit. */
static void take(uint8_t *pixel, const struct plane *plane, const uint8_t *from,
                 const uint8_t *other, const uint8_t *without)
{
    for (size_t i = 0; i < pixels(plane); i++) {
        const size_t v = voxel_of(plane, i);
        pixel[i] = from[v] != (other ? other[v] : 0) && !(without && without[v] >> plane->axis & 1);
    }
}

/* Leaves the largest piece, as 1; false where there is none. */
static bool keep_largest(uint8_t *pixel, const struct plane *plane, uint32_t *stack)
{
    size_t best = 0, most = 0;
    for (size_t i = 0; i < pixels(plane); i++) {
        const size_t count = pixel[i] == 1 ? flood(pixel, plane, stack, i, 2) : 0;
        best = count > most ? i : best;
        most = count > most ? count : most;
    }
    if (most)
        flood(pixel, plane, stack, best, 3);
    for (size_t i = 0; i < pixels(plane); i++)
        pixel[i] = pixel[i] == 3;
    return most > 0;
}

/* Of those of the object in `piece`, as 1, the piece that is nearest to what is set in `wrong`, at
 * most `reach` voxels from it. */
static bool keep_nearest(uint8_t *piece, const uint8_t *wrong, const struct plane *plane,
                         uint32_t *stack, int reach)
{
    const int w = (int)plane->size[0], h = (int)plane->size[1];
    int least = reach * reach + 1;
    size_t best = 0;
    for (int i = 0; i < w * h; i++) {
        if (!wrong[i])
            continue;
        for (int dy = -reach; dy <= reach; dy++)
            for (int dx = -reach; dx <= reach; dx++) {
                const int x = i % w + dx, y = i / w + dy, far = dx * dx + dy * dy;
                if (far >= least || x < 0 || y < 0 || x >= w || y >= h || !piece[y * w + x])
                    continue;
                least = far;
                best = (size_t)(y * w + x);
            }
    }
    const bool found = least <= reach * reach;
    if (found)
        flood(piece, plane, stack, best, 3);
    for (size_t i = 0; i < pixels(plane); i++)
        piece[i] = piece[i] == 3;
    return found;
}

/* ---- what is drawn ---- */

/* Notes what a piece of the object, or the outline of one and a ring, covers. */
static void note(uint8_t *map, const struct plane *plane, const uint8_t *pixel, int reach)
{
    const int w = (int)plane->size[0], h = (int)plane->size[1];
    const uint8_t bit = (uint8_t)(1 << plane->axis);
    for (int i = 0; i < w * h; i++)
        for (int dy = -reach; pixel[i] && dy <= reach; dy++)
            for (int dx = -reach; dx <= reach; dx++) {
                const int x = i % w + dx, y = i / w + dy;
                if (dx * dx + dy * dy <= reach * reach && x >= 0 && y >= 0 && x < w && y < h)
                    map[voxel_of(plane, (size_t)(y * w + x))] |= bit;
            }
}

static enum err draw(struct effort_outliner *o, const struct plane *plane, uint8_t label, bool ring,
                     struct effort_gesture *gesture, struct fault *fault)
{
    memcpy(o->piece.size, plane->size, sizeof o->piece.size);
    const enum err err = hand_draw(&o->outline, &o->piece, o->hand, &o->random, fault);
    if (err)
        return err;
    struct polyline *line = &o->outline.line;
    for (size_t i = 0; i < line->count; i++) {
        const uint32_t at[2] = {line->corner[i][0], line->corner[i][1]};
        line->corner[i][plane->axis] = plane->at;
        for (int a = 0; a < 2; a++)
            line->corner[i][plane->along[a]] = at[a];
    }
    *gesture = (struct effort_gesture){
        .shape = SHAPE_OUTLINE,
        .label = label,
        .corner = (const uint32_t(*)[3])line->corner,
        .corners = line->count,
        .ring = ring ? OUTLINE_RING : 0,
        .path = o->outline.path,
        .clicks = o->outline.clicks,
    };
    return OK;
}

/* Where a slice has nothing to draw, *found is false. */
static enum err draw_in(struct effort_outliner *o, const struct plane *plane, const uint8_t *label,
                        struct effort_gesture *gesture, bool *found, struct fault *fault)
{
    const uint8_t *truth = o->object->truth;
    uint8_t value = 1;
    take(o->wrong.voxel, plane, label, truth, o->covered);
    take(o->piece.voxel, plane, truth, NULL, o->drawn);
    const bool is_wrong = keep_largest(o->wrong.voxel, plane, o->stack);
    bool ring = is_wrong
                    ? keep_nearest(o->piece.voxel, o->wrong.voxel, plane, o->stack, OUTLINE_RING)
                    : keep_largest(o->piece.voxel, plane, o->stack);
    *found = is_wrong || ring;
    if (!*found)
        return OK;
    if (!ring) {
        memcpy(o->piece.voxel, o->wrong.voxel, pixels(plane));
        const uint8_t *first = memchr(o->piece.voxel, 1, pixels(plane));
        value = truth[voxel_of(plane, (size_t)(first - o->piece.voxel))];
    } else {
        note(o->drawn, plane, o->piece.voxel, 0);
    }
    note(o->covered, plane, o->piece.voxel, ring ? OUTLINE_RING : 0);
    o->is_drawn[plane->axis][plane->at] = true;
    return draw(o, plane, value, ring, gesture, fault);
}

/* ---- which slice ---- */

static size_t count_wrong(const struct effort_outliner *o, const struct plane *plane,
                          const uint8_t *label)
{
    size_t count = 0;
    for (size_t i = 0; i < pixels(plane); i++) {
        const size_t v = voxel_of(plane, i);
        count += label[v] != o->object->truth[v] && !(o->covered[v] >> plane->axis & 1);
    }
    return count;
}

static bool has_object(const struct effort_outliner *o, const struct plane *plane)
{
    for (size_t i = 0; i < pixels(plane); i++)
        if (o->object->truth[voxel_of(plane, i)])
            return true;
    return false;
}

static bool is_near_drawn(const struct effort_outliner *o, int axis, uint32_t at)
{
    const bool *is_drawn = o->is_drawn[axis];
    return is_drawn[at] || (at > 0 && is_drawn[at - 1]) ||
           (at + 1 < o->object->size[axis] && is_drawn[at + 1]);
}

/* What speaks for a slice: 0 for none. */
static uint64_t worth(struct effort_outliner *o, const struct plane *plane, const uint8_t *label,
                      const struct doubt *doubt)
{
    switch (o->next) {
    case NEXT_WRONG:
        return count_wrong(o, plane, label);
    case NEXT_DOUBT:
        return is_near_drawn(o, plane->axis, plane->at) ? 0 : doubt->slice[plane->axis][plane->at];
    case NEXT_CHANCE:
        return !o->is_drawn[plane->axis][plane->at] && has_object(o, plane)
                   ? 1 + hand_random(&o->random) / 2
                   : 0;
    case NEXT_NONE:
        break;
    }
    return 0;
}

enum err effort_outline_next(struct effort_outliner *o, const uint8_t *label,
                             const struct doubt *doubt, struct effort_gesture *gesture, bool *found,
                             struct fault *fault)
{
    enum err err = OK;
    *found = false;
    for (bool goes_on = true; goes_on && !*found && !err;) {
        struct plane best = {0};
        uint64_t most = 0;
        for (int a = 0; a < 3; a++)
            for (uint32_t at = 0; at < o->object->size[a]; at++) {
                const struct plane plane = plane_of(o->object, a, at);
                const uint64_t is = worth(o, &plane, label, doubt);
                best = is > most ? plane : best;
                most = is > most ? is : most;
            }
        goes_on = most > 0;
        if (goes_on)
            err = draw_in(o, &best, label, gesture, found, fault);
        if (goes_on)
            o->is_drawn[best.axis][best.at] = true; /* even where nothing was to be drawn */
    }
    return err;
}

/* ---- every slice ---- */

/* All pieces of the object in the slices across an axis, as the hand draws them. */
static enum err draw_all(struct effort_outliner *o, int axis, uint8_t *map, struct fault *fault)
{
    const struct effort_object *object = o->object;
    struct effort_gesture gesture;
    struct grid grid;
    enum err err = grid_init(&grid, object->size, fault);
    for (uint32_t at = 0; at < object->size[axis] && !err; at++) {
        const struct plane plane = plane_of(object, axis, at);
        for (bool found = true; found && !err;) {
            struct voxels voxels = {0};
            take(o->piece.voxel, &plane, object->truth, NULL, o->drawn);
            found = keep_largest(o->piece.voxel, &plane, o->stack);
            if (!found)
                continue;
            note(o->drawn, &plane, o->piece.voxel, 0);
            err = draw(o, &plane, 1, true, &gesture, fault);
            err = err ? err : effort_gesture_voxels(&voxels, &gesture, &grid, fault);
            for (size_t i = 0; i < voxels.count; i++)
                map[grid_voxel(&grid, voxels.cell[i])] = 1;
            voxels_release(&voxels);
        }
    }
    return err;
}

enum err effort_outline_most(unsigned *dice, const struct effort_object *object, unsigned hand,
                             struct fault *fault)
{
    struct effort_outliner o;
    uint8_t *map = mem_new(object->voxels);
    enum err err = effort_outliner_init(&o, object, NEXT_NONE, hand, map ? fault : NULL);
    *dice = 0;
    if (!map)
        err = fault_memory(fault, "an object");
    for (int a = 0; a < 3 && !err; a++) {
        struct overlap overlap;
        memset(map, 0, object->voxels);
        err = draw_all(&o, a, map, fault);
        overlap_count(&overlap, map, object->truth, object->voxels);
        *dice = overlap_dice(&overlap, 1) > *dice ? overlap_dice(&overlap, 1) : *dice;
    }
    effort_outliner_release(&o);
    free(map);
    return err;
}
