/* SPDX-License-Identifier: MIT */
#include "render/cut.h"

#include <stdlib.h>

struct cut cut_none(void)
{
    return (struct cut){.last = {UINT32_MAX, UINT32_MAX, UINT32_MAX}};
}

bool cut_is_none(const struct cut *cut)
{
    bool whole = true;
    for (int a = 0; a < 3; a++)
        whole = whole && cut->first[a] == 0 && cut->last[a] == UINT32_MAX;
    return whole && cut->planes == 0 && cut->boxes == 0;
}

static bool lies_within(const uint32_t first[3], const uint32_t last[3], const uint32_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] < first[a] || at[a] > last[a])
            return false;
    return true;
}

bool cut_removes(const struct cut *cut, const struct grid *grid, uint32_t cell)
{
    if (cut_is_none(cut))
        return false;
    const struct place p = grid_place(grid, cell);
    const uint32_t at[3] = {p.x, p.y, p.z};
    if (!lies_within(cut->first, cut->last, at))
        return true;
    for (uint32_t i = 0; i < cut->boxes; i++)
        if (lies_within(cut->box[i].first, cut->box[i].last, at))
            return true;
    for (uint32_t i = 0; i < cut->planes; i++) {
        const struct cut_plane *plane = &cut->plane[i];
        int64_t along = 0;
        for (int a = 0; a < 3; a++)
            along += plane->normal[a] * at[a];
        if (along < plane->least)
            return true;
    }
    return false;
}

struct cut_plane cut_plane_at(const int64_t into[3], const uint32_t place[3], int64_t behind)
{
    struct cut_plane plane = {{0, 0, 0}, 0};
    int64_t largest = 0;
    int shift = 0;
    for (int a = 0; a < 3; a++)
        largest = llabs(into[a]) > largest ? llabs(into[a]) : largest;
    while (largest >> shift >> CUT_NORMAL_BITS)
        shift++;
    const int64_t unit = INT64_C(1) << shift;
    plane.least = -(behind / unit - (behind % unit < 0));
    for (int a = 0; a < 3; a++) {
        plane.normal[a] = into[a] / unit; /* towards 0, so that both sides are alike */
        plane.least += plane.normal[a] * place[a];
    }
    return plane;
}

/* ---- rows ---- */

/* The voxels first..end-1 of a row; empty where first >= end. */
struct stretch {
    int64_t first, end;
};

/* Return the voxels that a plane leaves of the row 0..size-1. */
static struct stretch left_by_plane(const struct cut_plane *plane, int64_t size, uint32_t y,
                                    uint32_t z)
{
    const int64_t along = plane->normal[0];
    const int64_t missing = plane->least - plane->normal[1] * y - plane->normal[2] * z;
    if (along == 0)
        return (struct stretch){0, missing <= 0 ? size : 0};
    if (along > 0) /* x * along >= missing */
        return (struct stretch){missing <= 0 ? 0 : (missing - 1) / along + 1, size};
    return (struct stretch){0, missing > 0 ? 0 : missing / along + 1};
}

/* Return the voxels that slabs and planes leave of a row: the intersection of intervals. */
static struct stretch left_of_row(const struct cut *cut, const struct grid *grid, uint32_t y,
                                  uint32_t z)
{
    const int64_t size = grid->size[0];
    struct stretch left = {cut->first[0], cut->last[0] < size ? cut->last[0] + INT64_C(1) : size};
    if (y < cut->first[1] || y > cut->last[1] || z < cut->first[2] || z > cut->last[2])
        left.end = 0;
    for (uint32_t i = 0; i < cut->planes; i++) {
        const struct stretch by = left_by_plane(&cut->plane[i], size, y, z);
        left.first = by.first > left.first ? by.first : left.first;
        left.end = by.end < left.end ? by.end : left.end;
    }
    return left.first < left.end ? left : (struct stretch){0, 0};
}

static void clear_bits(uint64_t *bits, uint64_t first, uint64_t end)
{
    while (first < end) {
        const uint64_t word = first >> 6, next = (word + 1) << 6;
        uint64_t mask = UINT64_MAX << (first & 63);
        if (end < next)
            mask &= ~(UINT64_MAX << (end & 63));
        bits[word] &= ~mask;
        first = next;
    }
}

bool cut_clear(const struct cut *cut, const struct scene *scene, uint64_t *bits)
{
    const struct grid *grid = &scene->grid;
    if (cut_is_none(cut))
        return true;
    struct task task = task_begin(scene->watch, "shown voxels", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            if (!task_advance(&task, grid->size[0]))
                return false;
            const struct span row = grid_row(grid, y, z);
            const struct stretch left = left_of_row(cut, grid, y, z);
            clear_bits(bits, row.first, row.first + (uint64_t)left.first);
            clear_bits(bits, row.first + (uint64_t)left.end, row.end);
            for (uint32_t i = 0; i < cut->boxes; i++) {
                const struct cut_box *box = &cut->box[i];
                if (y >= box->first[1] && y <= box->last[1] && z >= box->first[2] &&
                    z <= box->last[2])
                    clear_bits(bits, row.first + (uint64_t)box->first[0],
                               row.first + (uint64_t)box->last[0] + 1);
            }
        }
    return true;
}
