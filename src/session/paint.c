/* SPDX-License-Identifier: MIT */
#include "session/paint.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void voxels_release(struct voxels *voxels)
{
    free(voxels->cell);
    *voxels = (struct voxels){0};
}

static enum err outcome(struct voxels *out, bool fits, struct watch *watch, struct fault *fault)
{
    const enum err err = fits ? watch_fault(watch, fault) : fault_memory(fault, "seeds");
    if (err)
        voxels_release(out);
    return err;
}

static bool add_row(struct voxels *out, const struct grid *grid, const uint32_t first[3],
                    uint32_t count)
{
    if (!mem_grow(&out->cell, &out->capacity, out->count + count, sizeof *out->cell))
        return false;
    const uint32_t cell = grid_cell(grid, first[0], first[1], first[2]);
    for (uint32_t i = 0; i < count; i++)
        out->cell[out->count++] = cell + i;
    return true;
}

/* ---- straight lines ---- */

int64_t paint_steps(const uint32_t from[3], const uint32_t to[3])
{
    int64_t steps = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t way = from[a] < to[a] ? to[a] - from[a] : from[a] - to[a];
        steps = way > steps ? way : steps;
    }
    return steps;
}

void paint_step(int64_t at[3], const uint32_t from[3], const uint32_t to[3], int64_t part,
                int64_t parts)
{
    for (int a = 0; a < 3; a++) {
        const int64_t way = (int64_t)to[a] - from[a], twice = 2 * way * part;
        at[a] = from[a] + (parts ? (twice + (twice < 0 ? -parts : parts)) / (2 * parts) : 0);
    }
}

/* ---- strokes ---- */

/* A bit for each voxel of the part of the grid that a stroke can cover. */
struct sheet {
    uint32_t first[3], size[3];
    uint64_t *bit;
    size_t words;
};

static bool sheet_init(struct sheet *sheet, const struct grid *grid, const struct brush *brush,
                       const uint32_t (*corner)[3], size_t corners)
{
    size_t bits = 1;
    for (int a = 0; a < 3; a++) {
        const uint32_t reach = (uint32_t)brush->reach[a], end = grid->size[a];
        uint32_t least = UINT32_MAX, most = 0;
        for (size_t i = 0; i < corners; i++) {
            least = corner[i][a] < least ? corner[i][a] : least;
            most = corner[i][a] > most ? corner[i][a] : most;
        }
        sheet->first[a] = least > reach ? least - reach : 0;
        sheet->size[a] = (most + reach < end ? most + reach + 1 : end) - sheet->first[a];
        bits *= sheet->size[a];
    }
    sheet->words = (bits + 63) / 64;
    sheet->bit = mem_new(sheet->words * sizeof *sheet->bit);
    return sheet->bit != NULL;
}

static void set_bits(uint64_t *bit, size_t first, size_t last)
{
    const uint64_t head = UINT64_MAX << (first & 63), tail = UINT64_MAX >> (63 - (last & 63));
    const size_t end = last >> 6;
    size_t word = first >> 6;
    if (word == end) {
        bit[word] |= head & tail;
        return;
    }
    bit[word++] |= head;
    while (word < end)
        bit[word++] = UINT64_MAX;
    bit[end] |= tail;
}

static void stamp(struct sheet *sheet, const struct brush *brush, const int64_t middle[3])
{
    const int64_t width = sheet->size[0], height = sheet->size[1], depth = sheet->size[2];
    const int64_t x = middle[0] - sheet->first[0];
    for (size_t i = 0; i < brush->rows; i++) {
        const struct brush_row *row = &brush->row[i];
        const int64_t y = middle[1] - sheet->first[1] + row->y;
        const int64_t z = middle[2] - sheet->first[2] + row->z;
        const int64_t first = x > row->half ? x - row->half : 0;
        const int64_t last = x + row->half < width ? x + row->half : width - 1;
        if (y >= 0 && y < height && z >= 0 && z < depth)
            set_bits(sheet->bit, (size_t)((z * height + y) * width + first),
                     (size_t)((z * height + y) * width + last));
    }
}

/* Collect the cells whose bits are set. */
static bool collect_cells(struct voxels *out, const struct sheet *sheet, const struct grid *grid)
{
    size_t count = 0, begin = 0; /* first bit of the present row */
    uint32_t y = 0, z = 0;
    for (size_t w = 0; w < sheet->words; w++)
        count += (size_t)__builtin_popcountll(sheet->bit[w]);
    out->cell = mem_array(count, sizeof *out->cell);
    if (!out->cell)
        return false;
    out->capacity = count;
    for (size_t w = 0; w < sheet->words; w++)
        for (uint64_t left = sheet->bit[w]; left; left &= left - 1) {
            const size_t at = w * 64 + (size_t)__builtin_ctzll(left);
            for (; at - begin >= sheet->size[0]; begin += sheet->size[0])
                if (++y == sheet->size[1]) {
                    y = 0;
                    z++;
                }
            out->cell[out->count++] = grid_cell(grid, sheet->first[0] + (uint32_t)(at - begin),
                                                sheet->first[1] + y, sheet->first[2] + z);
        }
    return true;
}

/* False if the watch stopped it. */
static bool draw_stroke(struct sheet *sheet, const struct brush *brush, const uint32_t (*corner)[3],
                        size_t corners, struct watch *watch)
{
    struct task task = task_begin(watch, "a stroke", 0);
    int64_t at[3];
    paint_step(at, corner[0], corner[0], 0, 0);
    stamp(sheet, brush, at);
    for (size_t c = 1; c < corners; c++) {
        const int64_t steps = paint_steps(corner[c - 1], corner[c]);
        for (int64_t i = 1; i <= steps; i++) {
            paint_step(at, corner[c - 1], corner[c], i, steps);
            stamp(sheet, brush, at);
            if (!task_advance(&task, brush->rows))
                return false;
        }
    }
    return true;
}

enum err paint_stroke(struct voxels *out, const struct grid *grid, const struct brush *brush,
                      const uint32_t (*corner)[3], size_t corners, struct watch *watch,
                      struct fault *fault)
{
    struct sheet sheet;
    const bool fits =
        sheet_init(&sheet, grid, brush, corner, corners) &&
        (!draw_stroke(&sheet, brush, corner, corners, watch) || collect_cells(out, &sheet, grid));
    free(sheet.bit);
    return outcome(out, fits, watch, fault);
}

/* ---- shells ---- */

/* Add the voxels of the scene from `first` to `last` along x. */
static bool add_run(struct voxels *out, const struct grid *grid, int64_t first, int64_t last,
                    const int64_t middle[3])
{
    const int64_t end = grid->size[0] - 1;
    first = first > 0 ? first : 0;
    last = last < end ? last : end;
    return first > last ||
           add_row(out, grid,
                   (uint32_t[]){(uint32_t)first, (uint32_t)middle[1], (uint32_t)middle[2]},
                   (uint32_t)(last - first + 1));
}

enum err paint_shell(struct voxels *out, const struct grid *grid, const struct brush *brush,
                     const uint32_t middle[3], struct watch *watch, struct fault *fault)
{
    struct task task = task_begin(watch, "a shell", brush->rows);
    bool fits = true;
    for (size_t i = 0; fits && i < brush->rows && task_advance(&task, 1); i++) {
        const struct brush_row *row = &brush->row[i];
        const int64_t at[3] = {middle[0], (int64_t)middle[1] + row->y, (int64_t)middle[2] + row->z};
        if (!grid_contains(grid, at[0], at[1], at[2]))
            continue;
        const int64_t before = row->hole < 0 ? at[0] + row->half : at[0] - row->hole - 1;
        fits = add_run(out, grid, at[0] - row->half, before, at) &&
               (row->hole < 0 || add_run(out, grid, at[0] + row->hole + 1, at[0] + row->half, at));
    }
    return outcome(out, fits, watch, fault);
}

/* ---- boxes ---- */

enum err paint_box(struct voxels *out, const struct grid *grid, const uint32_t corner[3],
                   const uint32_t opposite[3], bool is_hollow, struct watch *watch,
                   struct fault *fault)
{
    struct task task = task_begin(watch, "a box", 0);
    uint32_t first[3], last[3];
    bool fits = true;
    for (int a = 0; a < 3; a++) {
        first[a] = corner[a] < opposite[a] ? corner[a] : opposite[a];
        last[a] = corner[a] < opposite[a] ? opposite[a] : corner[a];
    }
    const uint32_t length = last[0] - first[0] + 1;
    for (uint32_t z = first[2]; fits && z <= last[2]; z++)
        for (uint32_t y = first[1]; fits && y <= last[1] && task_advance(&task, length); y++) {
            const bool whole = !is_hollow || z == first[2] || z == last[2] || y == first[1] ||
                               y == last[1] || length == 1;
            fits = add_row(out, grid, (uint32_t[]){first[0], y, z}, whole ? length : 1) &&
                   (whole || add_row(out, grid, (uint32_t[]){last[0], y, z}, 1));
        }
    return outcome(out, fits, watch, fault);
}

/* ---- polygons ---- */

/* The part of a slice that a polygon can cover: across[0] and across[1] are the axes of the
 * scene along its columns and rows. For the present row, by column: */
struct outline {
    const uint32_t (*corner)[3];
    size_t corners;
    int across[2], axis; /* the axis at right angles to the slice */
    uint32_t first[2], size[2];
    int32_t *turn; /* change of the winding number from the column before */
    bool *on;      /* the outline passes through its centre */
};

/* Return the first axis along which all corners have the same index; 3 for none. */
static int common_axis(const uint32_t (*corner)[3], size_t corners)
{
    int axis = 0;
    for (; axis < 3; axis++) {
        size_t i = 0;
        while (i < corners && corner[i][axis] == corner[0][axis])
            i++;
        if (i == corners)
            break;
    }
    return axis;
}

static bool outline_init(struct outline *o, const uint32_t (*corner)[3], size_t corners, int axis)
{
    *o = (struct outline){.corner = corner,
                          .corners = corners,
                          .axis = axis,
                          .across = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}};
    for (int k = 0; k < 2; k++) {
        uint32_t least = UINT32_MAX, most = 0;
        for (size_t i = 0; i < corners; i++) {
            const uint32_t at = corner[i][o->across[k]];
            least = at < least ? at : least;
            most = at > most ? at : most;
        }
        o->first[k] = least;
        o->size[k] = most - least + 1;
    }
    o->turn = mem_array(o->size[0], sizeof *o->turn);
    o->on = mem_array(o->size[0], sizeof *o->on);
    return o->turn && o->on;
}

/* Add the edge from a to b (column, row) to a row: it changes the winding number where it
 * crosses the row. Of its two ends, the lower one counts as crossed. */
static void cross_row(struct outline *o, const int64_t a[2], const int64_t b[2], int64_t row)
{
    const int64_t low = a[1] < b[1] ? a[1] : b[1], high = a[1] < b[1] ? b[1] : a[1];
    if (row < low || row > high)
        return;
    if (low == high) {
        const int64_t end = a[0] < b[0] ? b[0] : a[0];
        for (int64_t column = a[0] < b[0] ? a[0] : b[0]; column <= end; column++)
            o->on[column] = true;
        return;
    }
    const int sign = a[1] < b[1] ? 1 : -1;
    const int64_t rows = high - low, over = sign * (row - a[1]) * (b[0] - a[0]);
    const int64_t whole = over / rows, rest = over % rows;
    if (rest == 0)
        o->on[a[0] + whole] = true;
    if (row < high) {
        o->turn[0] += sign;
        o->turn[a[0] + whole + (rest > 0)] -= sign;
    }
}

static bool fill_row(struct voxels *out, struct outline *o, const struct grid *grid, uint32_t row)
{
    memset(o->turn, 0, o->size[0] * sizeof *o->turn);
    memset(o->on, 0, o->size[0] * sizeof *o->on);
    for (size_t i = 0; i < o->corners; i++) {
        const uint32_t *from = o->corner[i], *to = o->corner[i + 1 < o->corners ? i + 1 : 0];
        int64_t a[2], b[2];
        for (int k = 0; k < 2; k++) {
            a[k] = (int64_t)from[o->across[k]] - o->first[k];
            b[k] = (int64_t)to[o->across[k]] - o->first[k];
        }
        cross_row(o, a, b, row);
    }
    uint32_t place[3];
    int32_t winds = 0;
    place[o->axis] = o->corner[0][o->axis];
    place[o->across[1]] = o->first[1] + row;
    for (uint32_t column = 0; column < o->size[0]; column++) {
        winds += o->turn[column];
        place[o->across[0]] = o->first[0] + column;
        if ((winds || o->on[column]) && !add_row(out, grid, place, 1))
            return false;
    }
    return true;
}

enum err paint_polygon(struct voxels *out, const struct grid *grid, const uint32_t (*corner)[3],
                       size_t corners, struct watch *watch, struct fault *fault)
{
    struct task task = task_begin(watch, "a polygon", 0);
    struct outline o;
    const int axis = common_axis(corner, corners);
    if (axis == 3)
        return fault_set(fault, ERR_INPUT,
                         "the corners of a polygon must be in one slice, with the same x, y or z; "
                         "nothing was planted");
    bool fits = outline_init(&o, corner, corners, axis);
    for (uint32_t row = 0; fits && row < o.size[1] && task_advance(&task, o.size[0] + corners);
         row++)
        fits = fill_row(out, &o, grid, row);
    free(o.turn);
    free(o.on);
    return outcome(out, fits, watch, fault);
}

enum err paint_ring(struct voxels *out, const struct grid *grid, const struct voxels *inside,
                    const uint32_t (*corner)[3], size_t corners, int width, struct watch *watch,
                    struct fault *fault)
{
    struct task task = task_begin(watch, "a ring", 0);
    OWNED(brush_release) struct brush brush = {0};
    struct sheet sheet;
    TRY(brush_init(&brush, (uint32_t[]){1, 1, 1}, width, BRUSH_REACH_MOST, fault));
    brush.reach[common_axis(corner, corners)] = 0; /* the sheet is one slice */
    const bool fits = sheet_init(&sheet, grid, &brush, corner, corners);
    for (size_t i = 0; fits && i < inside->count && task_advance(&task, brush.rows); i++) {
        const struct place p = grid_place(grid, inside->cell[i]);
        stamp(&sheet, &brush, (int64_t[]){p.x, p.y, p.z});
    }
    for (size_t i = 0; fits && i < inside->count; i++) {
        const struct place p = grid_place(grid, inside->cell[i]);
        const size_t x = p.x - sheet.first[0], y = p.y - sheet.first[1], z = p.z - sheet.first[2];
        const size_t at = (z * sheet.size[1] + y) * sheet.size[0] + x;
        sheet.bit[at >> 6] &= ~(UINT64_C(1) << (at & 63));
    }
    enum err err = outcome(
        out, fits && (watch_fault(watch, NULL) || collect_cells(out, &sheet, grid)), watch, fault);
    free(sheet.bit);
    return err;
}
