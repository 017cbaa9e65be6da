/* SPDX-License-Identifier: MIT */
#include "session/between.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/least.h"
#include "engine/distance.h"

/* ---- outlines ---- */

/* Find the axes along which no voxels of a marker are in adjacent slices, if it is exact and of the
 * label. `has` has room for the longest side. */
static unsigned axes_of(const struct markers *markers, const struct marker *marker,
                        const struct grid *grid, int16_t label, bool *has, struct task *task)
{
    const struct cover *cover = markers->cover + marker->first;
    unsigned axes = 0;
    if (!marker->is_valid || !marker->is_exact || marker->yields || marker->label != label)
        return 0;
    for (int a = 0; a < 3; a++) {
        memset(has, 0, grid->size[a] * sizeof *has);
        for (size_t i = 0; i < marker->voxels && task_advance(task, 1); i++) {
            uint32_t at[3];
            grid_find(grid, cover[i].cell, at);
            has[at[a]] = true;
        }
        bool has_adjacent = false;
        for (uint32_t k = 1; k < grid->size[a]; k++)
            has_adjacent |= has[k - 1] && has[k];
        axes |= has_adjacent ? 0 : 1u << a;
    }
    return axes;
}

enum err between_find(unsigned *axes, uint8_t *map, const struct markers *markers,
                      const struct grid *grid, int16_t label, int axis, struct watch *watch,
                      struct fault *fault)
{
    struct task task = task_begin(watch, "outlines", 0);
    OWNED(mem_release) bool *has = mem_array(GRID_SIDE_MOST, sizeof *has);
    *axes = 0;
    if (!has)
        return fault_memory(fault, "outlines");
    for (size_t m = 0; m < markers->count; m++) {
        const struct marker *marker = markers->marker + m;
        const unsigned found = axes_of(markers, marker, grid, label, has, &task);
        const bool is_outline = found && !(found & (found - 1));
        *axes |= is_outline ? found : 0;
        for (size_t i = 0; map && is_outline && found == 1u << axis && i < marker->voxels; i++) {
            const uint32_t cell = markers->cover[marker->first + i].cell;
            if (task_advance(&task, 1) && markers_at(markers, cell) == m + 1)
                map[cell] = BETWEEN_OUTLINED;
        }
    }
    return watch_fault(watch, fault);
}

/* ---- sections ---- */

/* The section in a slice; places are along the two axes of the plane. */
struct section {
    uint64_t count, sum[2];
    uint32_t low[2], high[2];
};

struct filling {
    uint8_t *map;
    const struct grid *grid;
    const uint32_t *spacing_nm;
    int axis, across[2];
    struct section *section; /* by slice */
    struct team *team;
    struct watch *watch;
    struct fault *fault;
};

static void measure_sections(struct filling *f)
{
    struct grid_walk walk = grid_rows(f->grid, f->watch, "outlines");
    memset(f->section, 0, f->grid->size[f->axis] * sizeof *f->section);
    while (grid_walk_next(&walk))
        for (uint32_t c = walk.row.first; c < walk.row.end; c++) {
            const uint32_t at[3] = {c - walk.row.first, walk.y, walk.z};
            struct section *section = f->section + at[f->axis];
            if (f->map[c] != BETWEEN_OUTLINED)
                continue;
            for (int k = 0; k < 2; k++) {
                const uint32_t p = at[f->across[k]];
                section->low[k] = section->count && section->low[k] < p ? section->low[k] : p;
                section->high[k] = section->high[k] > p ? section->high[k] : p;
                section->sum[k] += p;
            }
            section->count++;
        }
}

static uint32_t cell_at(const struct filling *f, uint32_t slice, int64_t u, int64_t v)
{
    return (uint32_t)(grid_cell(f->grid, 0, 0, 0) + slice * f->grid->step[f->axis] +
                      u * f->grid->step[f->across[0]] + v * f->grid->step[f->across[1]]);
}

/* True if a section has fewer than half of its voxels in another one, which is not smaller. */
static bool is_apart(const struct filling *f, uint32_t slice, uint32_t other)
{
    const struct section *section = f->section + slice;
    uint64_t both = 0;
    for (uint32_t v = section->low[1]; v <= section->high[1]; v++)
        for (uint32_t u = section->low[0]; u <= section->high[0]; u++)
            both += f->map[cell_at(f, slice, u, v)] == BETWEEN_OUTLINED &&
                    f->map[cell_at(f, other, u, v)] == BETWEEN_OUTLINED;
    return 2 * both < section->count;
}

/* ---- a gap between two sections ---- */

/* Signed distances from both sections, in a box around the first and the second, which is moved by
 * -apart / 2 rounded up. */
struct gap {
    uint32_t first, last; /* slices */
    int64_t apart[2];     /* from the middle of the first section to that of the last, in half
                             voxels; 0 if they are not aligned */
    int64_t low[2];       /* first place of the box; its size has room for half voxels */
    uint32_t size[3];
    int64_t *from_first, *from_last; /* [size[1]][size[0]] */
    uint64_t *inside, *outside;      /* squared distances */
};

static int64_t floor_half(int64_t n)
{
    return (n - (n & 1)) / 2;
}

/* floor(16 sqrt(squared)), or the distance from no voxel. */
static int64_t sixteenths(uint64_t squared)
{
    if (squared == DISTANCE_NONE)
        return INT64_C(1) << 36;
    const uint64_t root = square_root(squared), rest = squared - root * root;
    uint64_t part = 15;
    while (part * (32 * root + part) > 256 * rest)
        part--;
    return (int64_t)(16 * root + part);
}

static enum err find_distances(int64_t *out, const struct filling *f, struct gap *gap,
                               uint32_t slice, const int64_t low[2])
{
    const uint32_t *whole = f->grid->size;
    const uint32_t spacing_nm[3] = {f->spacing_nm[f->across[0]], f->spacing_nm[f->across[1]],
                                    f->spacing_nm[f->across[0]]};
    const struct distance_scale scale = distance_scale_of(spacing_nm, gap->size);
    const size_t places = (size_t)gap->size[0] * gap->size[1];
    size_t i = 0;
    for (int64_t v = low[1]; v < low[1] + gap->size[1]; v++)
        for (int64_t u = low[0]; u < low[0] + gap->size[0]; u++, i++) {
            const bool in_scene =
                u >= 0 && v >= 0 && u < whole[f->across[0]] && v < whole[f->across[1]];
            const bool is_in = in_scene && f->map[cell_at(f, slice, u, v)] == BETWEEN_OUTLINED;
            gap->inside[i] = is_in ? 0 : DISTANCE_NONE;
            gap->outside[i] = in_scene && !is_in ? 0 : DISTANCE_NONE;
        }
    TRY(distance_spread(gap->inside, gap->size, &scale, f->team, f->watch, f->fault));
    TRY(distance_spread(gap->outside, gap->size, &scale, f->team, f->watch, f->fault));
    for (i = 0; i < places; i++)
        out[i] = gap->inside[i] ? -sixteenths(gap->inside[i]) : sixteenths(gap->outside[i]);
    return OK;
}

/* Four times the signed distance at a place in half voxels of the box. */
static int64_t distance_at(const int64_t *distance, const struct gap *gap, int64_t u2, int64_t v2)
{
    const int64_t *at = distance + v2 / 2 * gap->size[0] + u2 / 2;
    const int64_t right = u2 & 1, below = v2 & 1 ? gap->size[0] : 0;
    return at[0] + at[right] + at[below] + at[below + right];
}

static bool fill_slice(const struct filling *f, const struct gap *gap, uint32_t slice,
                       struct between_tally *tally, struct task *task)
{
    const int64_t part = slice - gap->first, parts = gap->last - gap->first;
    int64_t moved[2], begin[2], end[2]; /* the first section, in half voxels */
    size_t filled = 0;
    for (int k = 0; k < 2; k++) {
        const int64_t way = 2 * gap->apart[k] * part, most = f->grid->size[f->across[k]];
        moved[k] = (way + (way < 0 ? -parts : parts)) / (2 * parts);
        begin[k] = gap->low[k] - floor_half(-moved[k]);
        end[k] = gap->low[k] + gap->size[k] - 1 + floor_half(moved[k]);
        begin[k] = begin[k] > 0 ? begin[k] : 0;
        end[k] = end[k] < most ? end[k] : most;
    }
    for (int64_t v = begin[1]; v < end[1]; v++) {
        for (int64_t u = begin[0]; u < end[0]; u++) {
            const int64_t u2 = 2 * (u - gap->low[0]) - moved[0],
                          v2 = 2 * (v - gap->low[1]) - moved[1];
            const int64_t first = distance_at(gap->from_first, gap, u2, v2);
            const int64_t last = distance_at(gap->from_last, gap, u2 + (gap->apart[0] & 1),
                                             v2 + (gap->apart[1] & 1));
            if ((parts - part) * first + part * last < 0)
                continue;
            f->map[cell_at(f, slice, u, v)] = BETWEEN_FILLED;
            filled++;
        }
        if (end[0] > begin[0] && !task_advance(task, (uint64_t)(end[0] - begin[0])))
            return false;
    }
    tally->voxels += filled;
    tally->slices += filled > 0;
    return true;
}

static enum err fill_gap(const struct filling *f, uint32_t first, uint32_t last,
                         struct between_tally *tally)
{
    const struct section *a = f->section + first, *b = f->section + last;
    struct task task = task_begin(f->watch, "slices", 0);
    struct gap gap = {.first = first, .last = last, .size = {1, 1, 1}};
    const bool aligns = a->count <= b->count ? is_apart(f, first, last) : is_apart(f, last, first);
    int64_t low[2]; /* in the plane of the last section */
    for (int k = 0; k < 2; k++) {
        gap.apart[k] = aligns ? (int64_t)((4 * b->sum[k] + b->count) / (2 * b->count)) -
                                    (int64_t)((4 * a->sum[k] + a->count) / (2 * a->count))
                              : 0;
        const int64_t low_b = floor_half(2 * (int64_t)b->low[k] - gap.apart[k]),
                      high_b = -floor_half(gap.apart[k] - 2 * (int64_t)b->high[k]);
        gap.low[k] = (a->low[k] < low_b ? a->low[k] : low_b) - 1;
        gap.size[k] = (uint32_t)((a->high[k] > high_b ? a->high[k] : high_b) + 3 - gap.low[k]);
        low[k] = gap.low[k] + floor_half(gap.apart[k]);
    }
    const size_t places = (size_t)gap.size[0] * gap.size[1];
    const struct mem_part part[] = {{&gap.from_first, places, sizeof *gap.from_first},
                                    {&gap.from_last, places, sizeof *gap.from_last},
                                    {&gap.inside, places, sizeof *gap.inside},
                                    {&gap.outside, places, sizeof *gap.outside}};
    if (!mem_parts(part, 4))
        return fault_memory(f->fault, "slices between outlines");
    enum err err = find_distances(gap.from_first, f, &gap, first, gap.low);
    if (!err)
        err = find_distances(gap.from_last, f, &gap, last, low);
    for (uint32_t slice = first + 1; !err && slice < last; slice++)
        if (!fill_slice(f, &gap, slice, tally, &task))
            err = watch_fault(f->watch, f->fault);
    free(gap.from_first);
    return err;
}

enum err between_fill(uint8_t *map, struct between_tally *tally, const struct grid *grid,
                      const uint32_t spacing_nm[3], int axis, struct team *team,
                      struct watch *watch, struct fault *fault)
{
    OWNED(mem_release)
    struct section *section = mem_array(grid->size[axis], sizeof *section);
    struct filling f = {.map = map,
                        .grid = grid,
                        .spacing_nm = spacing_nm,
                        .axis = axis,
                        .across = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2},
                        .section = section,
                        .team = team,
                        .watch = watch,
                        .fault = fault};
    *tally = (struct between_tally){0};
    if (!section)
        return fault_memory(fault, "outlines");
    measure_sections(&f);
    enum err err = watch_fault(watch, fault);
    for (uint32_t k = 0; !err && k < grid->size[axis]; k++) {
        if (!section[k].count)
            continue;
        if (tally->sections++ == 0)
            tally->first = k;
        else if (k > tally->last + 1)
            err = fill_gap(&f, tally->last, k, tally);
        tally->last = k;
    }
    return err;
}
