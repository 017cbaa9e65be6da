/* SPDX-License-Identifier: MIT */
#include "tests/bench/effort_robot.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "engine/distance.h"

enum {
    RADIUS_USUAL = 3,
    NEAR = 2, /* for the background's first ball */
    FAR = 10,
    WITHIN_DEPTHS = 3,
    CORNERS_MOST = 3000,
    DEFECTS = 4,
};

/* ---- chance ---- */

static uint32_t below(struct effort_robot *robot, uint64_t bound)
{
    robot->random += UINT64_C(0x9e3779b97f4a7c15);
    return (uint32_t)((hash_mix(robot->random) >> 32) * bound >> 32);
}

enum err effort_robot_init(struct effort_robot *robot, const struct effort_object *object,
                           struct fault *fault)
{
    *robot = (struct effort_robot){.object = object, .radius_most = RADIUS_USUAL};
    for (const char *at = object->name; *at; at++)
        robot->random = hash_mix_at(robot->random, (uint8_t)*at);
    enum err err = grid_init(&robot->grid, object->size, fault);
    if (err)
        return err;
    robot->wrong = mem_new(robot->grid.cells);
    robot->squared = mem_array(robot->grid.voxels, sizeof *robot->squared);
    robot->corner = mem_array(CORNERS_MOST, sizeof *robot->corner);
    return robot->wrong && robot->squared && robot->corner ? OK : fault_memory(fault, "a robot");
}

void effort_robot_release(struct effort_robot *robot)
{
    free(robot->wrong);
    free(robot->squared);
    free(robot->corner);
}

/* ---- boxes and depths ---- */

/* Voxels of the scene from one corner on. */
struct box {
    uint32_t first[3], size[3];
};

static size_t box_voxels(const struct box *box)
{
    return (size_t)box->size[0] * box->size[1] * box->size[2];
}

static struct box whole(const struct effort_robot *robot)
{
    const uint32_t *n = robot->grid.size;
    return (struct box){{0, 0, 0}, {n[0], n[1], n[2]}};
}

static void place_in(uint32_t at[3], const struct box *box, size_t i)
{
    at[0] = box->first[0] + (uint32_t)(i % box->size[0]);
    at[1] = box->first[1] + (uint32_t)(i / box->size[0] % box->size[1]);
    at[2] = box->first[2] + (uint32_t)(i / box->size[0] / box->size[1]);
}

/* From 0 outside a set and DISTANCE_NONE in it to squared depths. */
static enum err measure(struct effort_robot *robot, const struct box *box, struct fault *fault)
{
    const struct distance_scale scale = {{1, 1, 1}, 1};
    return distance_spread(robot->squared, box->size, &scale, NULL, NULL, fault);
}

static size_t deepest(const struct effort_robot *robot, const struct box *box)
{
    size_t best = 0;
    for (size_t i = 1; i < box_voxels(box); i++)
        best = robot->squared[i] > robot->squared[best] ? i : best;
    return best;
}

/* The largest whole number whose square is not above that. */
static uint32_t root_of(uint64_t squared)
{
    uint32_t root = 0;
    while ((uint64_t)(root + 1) * (root + 1) <= squared)
        root++;
    return root;
}

static uint32_t radius_of(uint64_t squared, uint32_t most)
{
    if (squared >= (uint64_t)(most + 1) * (most + 1))
        return most;
    return squared ? root_of(squared) - 1 : 0;
}

/* ---- the first two gestures ---- */

static void ball_at_deepest(const struct effort_robot *robot, const struct box *box, uint8_t label,
                            struct effort_gesture *gesture)
{
    const size_t i = deepest(robot, box);
    *gesture = (struct effort_gesture){.shape = SHAPE_BALL,
                                       .radius = radius_of(robot->squared[i], robot->radius_most),
                                       .label = label};
    place_in(gesture->at, box, i);
}

enum err effort_robot_object(struct effort_robot *robot, struct effort_gesture *gesture,
                             struct fault *fault)
{
    const struct box box = whole(robot);
    for (size_t i = 0; i < robot->object->voxels; i++)
        robot->squared[i] = robot->object->truth[i] ? DISTANCE_NONE : 0;
    enum err err = measure(robot, &box, fault);
    if (!err)
        ball_at_deepest(robot, &box, 1, gesture);
    return err;
}

static enum err outside_ball(struct effort_robot *robot, struct effort_gesture *gesture,
                             struct fault *fault)
{
    const struct box box = whole(robot);
    for (size_t i = 0; i < robot->object->voxels; i++)
        robot->squared[i] = robot->object->truth[i] ? 0 : DISTANCE_NONE;
    enum err err = measure(robot, &box, fault);
    for (size_t i = 0; !err && i < robot->object->voxels; i++) {
        const uint64_t away = robot->squared[i];
        robot->squared[i] = away > NEAR * NEAR && away <= FAR * FAR ? DISTANCE_NONE : 0;
    }
    err = err ? err : measure(robot, &box, fault);
    if (!err)
        ball_at_deepest(robot, &box, 0, gesture);
    return err;
}

/* Corners of the box around the truth. */
static void bounds(const struct effort_robot *robot, uint32_t first[3], uint32_t last[3])
{
    const struct box box = whole(robot);
    for (int a = 0; a < 3; a++)
        first[a] = UINT32_MAX, last[a] = 0;
    for (size_t i = 0; i < robot->object->voxels; i++) {
        uint32_t at[3];
        if (!robot->object->truth[i])
            continue;
        place_in(at, &box, i);
        for (int a = 0; a < 3; a++) {
            first[a] = at[a] < first[a] ? at[a] : first[a];
            last[a] = at[a] > last[a] ? at[a] : last[a];
        }
    }
}

/* The farthest voxel of the truth, squared. Of a row only its ends can be that. */
static int64_t farthest(const struct effort_robot *robot, const int64_t from[3])
{
    const uint32_t *n = robot->object->size;
    int64_t most = 0;
    for (size_t row = 0; row < (size_t)n[1] * n[2]; row++) {
        const uint8_t *truth = robot->object->truth + row * n[0];
        const int64_t y = (int64_t)(row % n[1]) - from[1], z = (int64_t)(row / n[1]) - from[2];
        const uint8_t *first = memchr(truth, 1, n[0]), *last = memrchr(truth, 1, n[0]);
        if (!first)
            continue;
        const int64_t left = from[0] - (first - truth), right = last - truth - from[0];
        const int64_t x = left > right ? left : right;
        const int64_t squared = x * x + y * y + z * z;
        most = squared > most ? squared : most;
    }
    return most;
}

/* The smallest ball around the truth: move from the middle of the box while a neighbour has a
 * smaller radius. The radius is a convex function, so this ends at the least one or next to it. */
static int64_t smallest_ball(const struct effort_robot *robot, int64_t at[3])
{
    int64_t least = farthest(robot, at);
    for (bool moved = true; moved;) {
        moved = false;
        for (int way = 0; way < 27; way++) {
            const int64_t to[3] = {at[0] + way % 3 - 1, at[1] + way / 3 % 3 - 1,
                                   at[2] + way / 9 - 1};
            const int64_t squared = farthest(robot, to);
            if (squared >= least)
                continue;
            least = squared, moved = true;
            memcpy(at, to, sizeof to);
        }
    }
    return least;
}

enum err effort_robot_background(struct effort_robot *robot, enum effort_shape shape,
                                 struct effort_gesture *gesture, struct fault *fault)
{
    if (shape == SHAPE_BALL)
        return outside_ball(robot, gesture, fault);
    uint32_t first[3], last[3];
    int64_t at[3];
    bounds(robot, first, last);
    for (int a = 0; a < 3; a++)
        at[a] = (first[a] + last[a]) / 2;
    const uint64_t squared = (uint64_t)smallest_ball(robot, at);
    const uint32_t root = root_of(squared);
    *gesture = (struct effort_gesture){.shape = SHAPE_SPHERE};
    gesture->radius = root + ((uint64_t)root * root < squared) + 2 + below(robot, 4);
    for (int a = 0; a < 3; a++)
        gesture->at[a] = (uint32_t)at[a];
    return OK;
}

/* ---- outlines ---- */

/* The slice with most wrong voxels. */
static uint32_t worst_slice(const struct effort_robot *robot, const uint8_t *label)
{
    const uint32_t *n = robot->object->size;
    const size_t plane = (size_t)n[0] * n[1];
    uint32_t worst = 0;
    size_t most = 0;
    for (uint32_t z = 0; z < n[2]; z++) {
        size_t wrong = 0;
        for (size_t i = z * plane; i < (z + 1) * plane; i++)
            wrong += label[i] != robot->object->truth[i];
        worst = wrong > most ? z : worst;
        most = wrong > most ? wrong : most;
    }
    return worst;
}

static bool is_inside(const struct effort_robot *robot, const int32_t at[2], uint32_t z)
{
    const uint32_t *n = robot->object->size;
    return at[0] >= 0 && at[1] >= 0 && at[0] < (int32_t)n[0] && at[1] < (int32_t)n[1] &&
           robot->object->truth[((size_t)z * n[1] + (size_t)at[1]) * n[0] + (size_t)at[0]];
}

/* Follow the border of a piece clockwise from a voxel without one to its left; twice the area
 * inside, negative for a hole. */
static int64_t trace(struct effort_robot *robot, uint32_t x, uint32_t y, uint32_t z,
                     size_t *corners)
{
    static const int8_t step[8][2] = {{-1, 0}, {-1, -1}, {0, -1}, {1, -1},
                                      {1, 0},  {1, 1},   {0, 1},  {-1, 1}};
    int32_t at[2] = {(int32_t)x, (int32_t)y};
    unsigned begin = 0, first = 8;
    int64_t area = 0;
    for (*corners = 0; *corners < CORNERS_MOST;) {
        int32_t next[2] = {0};
        unsigned way = 0;
        for (; way < 8; way++) {
            for (int a = 0; a < 2; a++)
                next[a] = at[a] + step[(begin + way) % 8][a];
            if (is_inside(robot, next, z))
                break;
        }
        const unsigned to = (begin + way) % 8;
        if (way == 8 || (*corners && to == first && at[0] == (int32_t)x && at[1] == (int32_t)y))
            return area;
        first = *corners ? first : to;
        robot->corner[*corners][0] = (uint32_t)at[0];
        robot->corner[(*corners)++][1] = (uint32_t)at[1];
        area += (int64_t)at[0] * next[1] - (int64_t)next[0] * at[1];
        begin = (to + (to % 2 ? 6 : 7)) % 8;
        memcpy(at, next, sizeof at);
    }
    return 0; /* too long */
}

void effort_robot_outline(struct effort_robot *robot, const uint8_t *label,
                          struct effort_gesture *gesture)
{
    const uint32_t *n = robot->object->size, z = worst_slice(robot, label);
    uint32_t best[2] = {0};
    int64_t most = 0;
    for (uint32_t y = 0; y < n[1]; y++)
        for (uint32_t x = 0; x < n[0]; x++) {
            const int32_t at[2] = {(int32_t)x, (int32_t)y}, left[2] = {at[0] - 1, at[1]};
            if (!is_inside(robot, at, z) || is_inside(robot, left, z))
                continue;
            size_t corners;
            const int64_t area = trace(robot, x, y, z, &corners);
            if (area <= most)
                continue;
            most = area;
            best[0] = x, best[1] = y;
        }
    *gesture = (struct effort_gesture){.shape = SHAPE_OUTLINE, .label = 1};
    if (most)
        trace(robot, best[0], best[1], z, &gesture->corners);
    gesture->at[0] = best[0], gesture->at[1] = best[1], gesture->at[2] = z;
    gesture->corner = (const uint32_t(*)[2])robot->corner;
}

/* ---- defects ---- */

static bool is_border(const struct effort_object *object, size_t i)
{
    const size_t n[3] = {object->size[0], object->size[1], object->size[2]};
    const size_t step[3] = {1, n[0], n[0] * n[1]};
    for (int a = 0; a < 3; a++) {
        const size_t at = i / step[a] % n[a];
        if (object->truth[i] &&
            ((at && !object->truth[i - step[a]]) || (at + 1 < n[a] && !object->truth[i + step[a]])))
            return true;
    }
    return false;
}

void effort_robot_damage(struct effort_robot *robot, uint8_t *label)
{
    const struct effort_object *object = robot->object;
    const struct box box = whole(robot);
    memcpy(label, object->truth, object->voxels);
    for (int defect = 0; defect < DEFECTS; defect++) {
        const int64_t radius = 3 + below(robot, 4);
        size_t at = below(robot, object->voxels), tried = 0;
        uint32_t middle[3], p[3];
        while (tried++ < object->voxels && !is_border(object, at))
            at = at + 1 < object->voxels ? at + 1 : 0;
        place_in(middle, &box, at);
        for (size_t i = 0; i < object->voxels; i++) {
            int64_t squared = 0;
            place_in(p, &box, i);
            for (int a = 0; a < 3; a++)
                squared += ((int64_t)p[a] - middle[a]) * ((int64_t)p[a] - middle[a]);
            if (squared <= radius * radius)
                label[i] = defect % 2 != 0;
        }
    }
}

/* ---- what is wrong ---- */

static void mark_wrong(struct effort_robot *robot, const uint8_t *label)
{
    const struct grid *grid = &robot->grid;
    const uint8_t *truth = robot->object->truth;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            uint8_t *wrong = robot->wrong + grid_row(grid, y, z).first;
            for (uint32_t x = 0; x < grid->size[0]; x++)
                wrong[x] = *label++ != *truth++;
        }
}

/* Find the largest component of the wrong voxels; NULL if every label is right. */
static const struct component *choose(const struct components *pieces)
{
    const struct component *best = NULL;
    for (size_t i = 0; i < pieces->count; i++)
        if (pieces->item[i].label && (!best || pieces->item[i].voxels > best->voxels))
            best = &pieces->item[i];
    return best;
}

/* The box around a component, and a voxel more where the scene has one; the set is it. */
static struct box lay_out(struct effort_robot *robot, const struct components *pieces,
                          const struct component *piece)
{
    const struct grid *grid = &robot->grid;
    uint32_t first[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, last[3] = {0};
    struct box box;
    for (uint32_t r = piece->run; r != RUN_NONE; r = pieces->run[r].next) {
        const struct place p = grid_place(grid, pieces->run[r].first);
        const uint32_t end = p.x + pieces->run[r].end - pieces->run[r].first - 1;
        const uint32_t low[3] = {p.x, p.y, p.z}, high[3] = {end, p.y, p.z};
        for (int a = 0; a < 3; a++) {
            first[a] = low[a] < first[a] ? low[a] : first[a];
            last[a] = high[a] > last[a] ? high[a] : last[a];
        }
    }
    for (int a = 0; a < 3; a++) {
        box.first[a] = first[a] - (first[a] > 0);
        box.size[a] = last[a] + (last[a] + 1 < grid->size[a]) - box.first[a] + 1;
    }
    memset(robot->squared, 0, box_voxels(&box) * sizeof *robot->squared);
    for (uint32_t r = piece->run; r != RUN_NONE; r = pieces->run[r].next) {
        const struct place p = grid_place(grid, pieces->run[r].first);
        uint64_t *row =
            robot->squared +
            ((size_t)(p.z - box.first[2]) * box.size[1] + p.y - box.first[1]) * box.size[0];
        for (uint32_t i = 0; i < pieces->run[r].end - pieces->run[r].first; i++)
            row[p.x - box.first[0] + i] = DISTANCE_NONE;
    }
    return box;
}

/* An exact ball around a voxel of the component whose box and set are laid out. */
static enum err exact_ball(struct effort_robot *robot, const struct box *box, const uint8_t *label,
                           struct effort_gesture *gesture, struct fault *fault)
{
    const struct box all = whole(robot);
    const uint32_t *n = robot->grid.size;
    const uint8_t former = !gesture->label;
    size_t best = 0;
    for (size_t i = 0; i < robot->object->voxels; i++) {
        const bool is_right = label[i] == robot->object->truth[i];
        robot->squared[i] = is_right && label[i] == former ? 0 : DISTANCE_NONE;
    }
    const enum err err = measure(robot, &all, fault);
    for (size_t i = 0; !err && i < box_voxels(box); i++) {
        uint32_t at[3];
        place_in(at, box, i);
        const size_t v = ((size_t)at[2] * n[1] + at[1]) * n[0] + at[0];
        const bool is_wrong =
            robot->wrong[grid_cell(&robot->grid, at[0], at[1], at[2])] && label[v] == former;
        if (is_wrong && (!best || robot->squared[v] > robot->squared[best - 1]))
            best = v + 1;
    }
    if (err || !best)
        return err;
    const uint64_t squared = robot->squared[best - 1];
    place_in(gesture->at, &all, best - 1);
    gesture->radius = squared > (uint64_t)robot->radius_most * robot->radius_most
                          ? robot->radius_most
                          : root_of(squared - 1);
    return OK;
}

enum err effort_robot_next(struct effort_robot *robot, const uint8_t *label,
                           struct effort_gesture *gesture, bool *found, struct fault *fault)
{
    OWNED(components_release) struct components pieces = {0};
    mark_wrong(robot, label);
    enum err err = components_find(&pieces, &robot->grid, robot->wrong, NULL, fault);
    const struct component *piece = err ? NULL : choose(&pieces);
    *found = piece != NULL;
    if (piece) {
        const struct box box = lay_out(robot, &pieces, piece);
        err = measure(robot, &box, fault);
        ball_at_deepest(robot, &box, 0, gesture);
        gesture->within = WITHIN_DEPTHS * root_of(robot->squared[deepest(robot, &box)]);
        const uint32_t *n = robot->grid.size, *at = gesture->at;
        gesture->label = robot->object->truth[((size_t)at[2] * n[1] + at[1]) * n[0] + at[0]];
        if (!err && robot->is_exact)
            err = exact_ball(robot, &box, label, gesture, fault);
    }
    return err;
}
