/* SPDX-License-Identifier: MIT */
#include "engine/distance.h"

#include <stdlib.h>

#include "base/mem.h"

enum { EXTENT_MOST = 1 << 30 }; /* units along an axis, so that sums of squares stay below 2^62 */

/* ---- the unit ---- */

static uint32_t common_divisor(uint32_t a, uint32_t b)
{
    while (b) {
        const uint32_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* A spacing in units, at least 1. */
static uint64_t in_units(uint32_t spacing_nm, uint64_t unit_nm)
{
    const uint64_t steps = (spacing_nm + unit_nm / 2) / unit_nm;
    return steps ? steps : 1;
}

static bool fits(const uint32_t spacing_nm[3], const uint32_t size[3], uint64_t unit_nm)
{
    for (int a = 0; a < 3; a++)
        if ((size[a] - 1) * in_units(spacing_nm[a], unit_nm) > EXTENT_MOST)
            return false;
    return true;
}

struct distance_scale distance_scale_of(const uint32_t spacing_nm[3], const uint32_t size[3])
{
    struct distance_scale scale = {
        .unit_nm = common_divisor(common_divisor(spacing_nm[0], spacing_nm[1]), spacing_nm[2])};
    while (!fits(spacing_nm, size, scale.unit_nm))
        scale.unit_nm *= 2;
    for (int a = 0; a < 3; a++)
        scale.step[a] = (uint32_t)in_units(spacing_nm[a], scale.unit_nm);
    return scale;
}

/* ---- one line ---- */

enum { COLUMNS = 8 }; /* lines processed together: a cache line of each voxel's row */

/* Working memory for lines of `length` voxels. */
struct room {
    uint64_t *from;        /* [COLUMNS][length] */
    uint32_t *at, *lowest; /* parabolas of the lower envelope, and the first voxel of each */
    size_t length;
};

static uint64_t parabola(const uint64_t *from, uint32_t at, uint32_t x, uint64_t step)
{
    const uint64_t away = (x > at ? x - at : at - x) * step;
    return from[at] + away * away;
}

/* The first voxel at which the parabola of `next` is lower than that of `at`, which precedes it and
 * is not the higher one everywhere: Meijster's Sep, plus one. */
static uint64_t first_lower(const uint64_t *from, uint32_t at, uint32_t next, uint64_t step)
{
    const uint64_t weight = step * step;
    const uint64_t squares = ((uint64_t)next * next - (uint64_t)at * at) * weight;
    return (squares + from[next] - from[at]) / (2 * weight * (next - at)) + 1;
}

/* Minimum of all parabolas, from a line of room->from to one in the box. */
static void spread_line(const struct room *room, const uint64_t *from, uint64_t *to, size_t stride,
                        uint64_t step)
{
    /* Number of parabolas in the lower envelope. */
    size_t count = 0;
    for (uint32_t x = 0; x < room->length; x++) {
        if (from[x] == DISTANCE_NONE)
            continue;
        while (count && parabola(from, room->at[count - 1], room->lowest[count - 1], step) >
                            parabola(from, x, room->lowest[count - 1], step))
            count--;
        const uint64_t first = count ? first_lower(from, room->at[count - 1], x, step) : 0;
        if (first >= room->length)
            continue;
        room->at[count] = x;
        room->lowest[count++] = (uint32_t)first;
    }
    for (uint32_t x = (uint32_t)room->length; count && x-- > 0;) {
        to[x * stride] = parabola(from, room->at[count - 1], x, step);
        count -= x == room->lowest[count - 1];
    }
}

/* ---- all lines along an axis ---- */

struct spreading {
    uint64_t *squared;
    const uint32_t *size;
    uint64_t step;
    int axis;
    struct team *team;
    struct watch *watch;
    struct room room[TEAM_MOST];
};

/* Process lines along y or z; several are adjacent along x. */
static void spread_share(void *context, unsigned worker)
{
    const struct spreading *s = context;
    const size_t row = s->size[0], plane = row * s->size[1];
    const size_t stride = s->axis == 1 ? row : plane, apart = s->axis == 1 ? plane : row;
    const struct share share = team_share(s->team, worker, s->size[s->axis == 1 ? 2 : 1]);
    const struct room *room = &s->room[worker];
    struct task task = task_begin_part(s->watch, "distances",
                                       (share.end - share.first) * row * room->length, worker);
    for (size_t sheet = share.first; sheet < share.end; sheet++)
        for (size_t x = 0; x < row; x += COLUMNS) {
            const size_t columns = row - x < COLUMNS ? row - x : COLUMNS;
            uint64_t *first = s->squared + sheet * apart + x;
            for (size_t i = 0; i < room->length; i++)
                for (size_t c = 0; c < columns; c++)
                    room->from[c * room->length + i] = first[i * stride + c];
            for (size_t c = 0; c < columns; c++)
                spread_line(room, room->from + c * room->length, first + c, stride, s->step);
            if (!task_advance(&task, columns * room->length))
                return;
        }
}

static void spread_rows(void *context, unsigned worker)
{
    const struct spreading *s = context;
    const uint64_t step = s->step;
    const uint32_t length = s->size[0];
    const size_t rows = (size_t)s->size[1] * s->size[2];
    const struct share share = team_share(s->team, worker, rows);
    struct task task =
        task_begin_part(s->watch, "distances", (share.end - share.first) * length, worker);
    for (size_t row = share.first; row < share.end && task_advance(&task, length); row++) {
        /* Initialise a row with the squares of the steps to the nearest 0, on either side. */
        uint64_t *line = s->squared + row * length;
        uint64_t away = DISTANCE_NONE;
        for (uint32_t x = 0; x < length; x++) {
            away = line[x] == 0 ? 0 : away == DISTANCE_NONE ? away : away + step;
            line[x] = away;
        }
        away = DISTANCE_NONE;
        for (uint32_t x = length; x-- > 0;) {
            away = line[x] == 0 ? 0 : away == DISTANCE_NONE ? away : away + step;
            const uint64_t nearer = line[x] < away ? line[x] : away;
            line[x] = nearer == DISTANCE_NONE ? nearer : nearer * nearer;
        }
    }
}

enum err distance_spread(uint64_t *squared, const uint32_t size[3],
                         const struct distance_scale *scale, struct team *team, struct watch *watch,
                         struct fault *fault)
{
    struct spreading s = {
        .squared = squared, .size = size, .step = scale->step[0], .team = team, .watch = watch};
    enum err err = OK;
    team_run(team, spread_rows, &s);
    for (s.axis = 1; s.axis < 3 && !err; s.axis++) {
        s.step = scale->step[s.axis];
        const size_t length = size[s.axis];
        for (unsigned i = 0; i < team_size(team); i++) {
            struct room *room = &s.room[i];
            *room = (struct room){.from = mem_array(COLUMNS * length, sizeof *room->from),
                                  .at = mem_array(length, sizeof *room->at),
                                  .lowest = mem_array(length, sizeof *room->lowest),
                                  .length = length};
            if (!room->from || !room->at || !room->lowest)
                err = fault_memory(fault, "distances");
        }
        if (!err)
            team_run(team, spread_share, &s);
        for (unsigned i = 0; i < team_size(team); i++) {
            free(s.room[i].from);
            free(s.room[i].at);
            free(s.room[i].lowest);
        }
    }
    return err ? err : watch_fault(watch, fault);
}

/* ---- contours ---- */

/* Erode `stride` adjacent lines: keep the voxels of the set whose neighbours along the line are
 * both in it. */
static void erode_lines(uint8_t *out, const uint8_t *in, size_t length, size_t stride,
                        const bool ends[2], struct task *task)
{
    for (size_t i = 0; i < length && task_advance(task, stride); i++) {
        const uint8_t *at = in + i * stride;
        const uint8_t first = i > 0 || ends[0] ? 255 : 0,
                      last = i + 1 < length || ends[1] ? 255 : 0;
        const uint8_t *before = i > 0 ? at - stride : at,
                      *after = i + 1 < length ? at + stride : at;
        for (size_t k = 0; k < stride; k++)
            out[i * stride + k] = at[k] & before[k] & after[k] & first & last;
    }
}

static void erode_along(uint8_t *out, const uint8_t *in, const struct contour_box *box, int axis,
                        struct watch *watch)
{
    size_t stride = 1, voxels = 1;
    for (int a = 0; a < 3; a++) {
        stride *= a < axis ? box->size[a] : 1;
        voxels *= box->size[a];
    }
    const size_t sheet = stride * box->size[axis];
    struct task task = task_begin(watch, "contours", voxels);
    for (size_t i = 0; i < voxels; i += sheet)
        erode_lines(out + i, in + i, box->size[axis], stride, box->ends[axis], &task);
}

/* An erosion along each axis in turn keeps exactly the voxels whose 26 neighbours are all in the
 * set. */
void contour_find(uint8_t *contour, const uint8_t *set, uint8_t *room,
                  const struct contour_box *box, struct watch *watch)
{
    const size_t voxels = (size_t)box->size[0] * box->size[1] * box->size[2];
    erode_along(contour, set, box, 0, watch);
    erode_along(room, contour, box, 1, watch);
    erode_along(contour, room, box, 2, watch);
    for (size_t i = 0; i < voxels; i++)
        contour[i] = set[i] & (uint8_t)~contour[i];
}
