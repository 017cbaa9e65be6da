/* SPDX-License-Identifier: MIT */
#include "render/fit.h"

#include <stdlib.h>

#include "base/least.h"
#include "base/mem.h"

/* ---- visible voxels ---- */

/* Find the first and the last border voxel of a row; false if it has none. */
static bool find_ends(const struct border *border, struct span row, uint32_t ends[2])
{
    bool found = false;
    for (uint32_t c = row.first; c < row.end; c += 64) {
        uint64_t bits = border_bits_from(border->border, border->words, (ptrdiff_t)c);
        if (row.end - c < 64)
            bits &= (UINT64_C(1) << (row.end - c)) - 1;
        if (!bits)
            continue;
        if (!found)
            ends[0] = c - row.first + (uint32_t)__builtin_ctzll(bits);
        ends[1] = c - row.first + 63 - (uint32_t)__builtin_clzll(bits);
        found = true;
    }
    return found;
}

static void add_ends(struct fit *fit, const uint32_t x[2], uint32_t y, uint32_t z)
{
    for (int i = 0; i < 2; i++) {
        uint32_t *end = fit->end[fit->ends++];
        end[0] = x[i], end[1] = y, end[2] = z;
    }
}

enum err fit_init(struct fit *fit, const struct border *border, struct fault *fault)
{
    const struct grid *grid = &border->scene->grid;
    const uint32_t *size = grid->size, whole[2] = {0, size[0] - 1};
    uint32_t ends[2];
    *fit = (struct fit){.scene = border->scene};
    fit->end = mem_array((size_t)size[1] * size[2], 2 * sizeof *fit->end);
    if (!fit->end)
        return fault_memory(fault, "the ends of rows");
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            if (find_ends(border, grid_row(grid, y, z), ends))
                add_ends(fit, ends, y, z);
    fit->is_scene = fit->ends == 0;
    for (uint32_t y = 0; y < size[1] && fit->is_scene; y++)
        for (uint32_t z = 0; z < size[2]; z++)
            add_ends(fit, whole, y, z);
    return OK;
}

void fit_release(struct fit *fit)
{
    free(fit->end);
    *fit = (struct fit){0};
}

/* ---- lengths ---- */

enum { LENGTH_BITS = 30, COSINE_BITS = 30 };

/* Positions are from the scene's middle, in units of 2^shift / 2 nanometres, below 2^LENGTH_BITS,
 * so that products with three cosines and their sums fit 64 bits. */
struct ruler {
    const struct scene *scene;
    unsigned shift;
    int64_t half[3];    /* half a voxel */
    int32_t axis[3][3]; /* right, up, ahead along voxel axes */
};

static struct ruler ruler_of(const struct fit *fit, const struct view *view)
{
    struct ruler ruler = {.scene = fit->scene};
    uint64_t longest = 0;
    for (int a = 0; a < 3; a++) {
        const uint64_t length = (uint64_t)fit->scene->grid.size[a] * fit->scene->spacing_nm[a];
        longest = length > longest ? length : longest;
    }
    while (longest >> ruler.shift >> LENGTH_BITS)
        ruler.shift++;
    for (int a = 0; a < 3; a++)
        ruler.half[a] = (int64_t)(fit->scene->spacing_nm[a] >> ruler.shift) + 1;
    view_axes(view, fit->scene, ruler.axis[0], ruler.axis[1], ruler.axis[2]);
    return ruler;
}

static int64_t along(const struct ruler *ruler, int direction, const uint32_t place[3])
{
    int64_t sum = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t steps = 2 * (int64_t)place[a] - ruler->scene->grid.size[a] + 1;
        const int64_t length = steps * ruler->scene->spacing_nm[a];
        sum += (length >> ruler->shift) * ruler->axis[direction][a];
    }
    return sum;
}

static void find_reach(const struct fit *fit, const struct ruler *ruler, int direction,
                       int64_t reach[2])
{
    reach[0] = INT64_MAX, reach[1] = INT64_MIN;
    for (size_t i = 0; i < fit->ends; i++) {
        const int64_t at = along(ruler, direction, fit->end[i]);
        reach[0] = at < reach[0] ? at : reach[0];
        reach[1] = at > reach[1] ? at : reach[1];
    }
}

/* ---- the answers ---- */

void fit_place(const struct fit *fit, const struct view *view, uint32_t place[3])
{
    const struct ruler ruler = ruler_of(fit, view);
    int64_t middle[3] = {0, 0, 0}; /* along voxel axes */
    for (int d = 0; d < 3; d++) {
        int64_t reach[2];
        find_reach(fit, &ruler, d, reach);
        const int64_t between = (reach[0] + reach[1]) >> (COSINE_BITS + 1);
        for (int a = 0; a < 3; a++)
            middle[a] += between * ruler.axis[d][a] >> COSINE_BITS;
    }
    for (int a = 0; a < 3; a++) {
        const int64_t spacing = fit->scene->spacing_nm[a], most = fit->scene->grid.size[a] - 1;
        const int64_t twice = middle[a] * (INT64_C(1) << ruler.shift) + spacing * (most + 1);
        const int64_t at = twice / (2 * spacing); /* truncated: the nearest voxel */
        place[a] = (uint32_t)(at < 0 ? 0 : at > most ? most : at);
    }
}

/* Return half the extent of the picture needed in a direction, in half nanometres. */
static uint64_t needed(const struct fit *fit, const struct ruler *ruler, int direction,
                       const uint32_t place[3])
{
    const int64_t middle = along(ruler, direction, place);
    int64_t reach[2], half = 0;
    find_reach(fit, ruler, direction, reach);
    for (int a = 0; a < 3; a++)
        half += ruler->half[a] * llabs((int64_t)ruler->axis[direction][a]);
    const int64_t before = middle - reach[0], after = reach[1] - middle;
    const int64_t length = (before > after ? before : after) + half;
    return (uint64_t)((length >> COSINE_BITS) + 1) << ruler->shift;
}

void fit_middle(const struct fit *fit, uint32_t place[3])
{
    for (int a = 0; a < 3; a++) {
        uint32_t least = UINT32_MAX, most = 0;
        for (size_t i = 0; i < fit->ends; i++) {
            least = fit->end[i][a] < least ? fit->end[i][a] : least;
            most = fit->end[i][a] > most ? fit->end[i][a] : most;
        }
        place[a] = least + (most - least) / 2;
    }
}

uint32_t fit_all_round(const struct fit *fit, const struct view *view, const uint32_t *place,
                       uint32_t samples)
{
    const uint32_t *size = fit->scene->grid.size;
    uint64_t most = 0, side[3];
    view_sides(side, fit->scene);
    for (size_t i = 0; i < fit->ends; i++) {
        uint32_t around[3]; /* size of the box about that middle with this voxel at a corner */
        for (int a = 0; a < 3; a++) {
            const int64_t twice = place ? 2 * (int64_t)place[a] : (int64_t)size[a] - 1;
            around[a] = (uint32_t)llabs(2 * (int64_t)fit->end[i][a] - twice) + 1;
        }
        const uint64_t squares = view_squares(side, around);
        most = squares > most ? squares : most;
    }
    const uint32_t zoom = view_zoom_across(fit->scene, view->width, view->height, samples, most);
    return place ? view_possible_zoom(fit->scene, view, place, samples, zoom) : zoom;
}

uint32_t fit_zoom(const struct fit *fit, const struct view *view, const uint32_t place[3],
                  uint32_t samples)
{
    const struct ruler ruler = ruler_of(fit, view);
    const uint32_t shorter = least(view->width, view->height), margin = shorter / FIT_MARGIN;
    const uint64_t width = UINT64_C(1000) * (view->width - 2 * margin) * view_unit(fit->scene);
    const uint64_t height = UINT64_C(1000) * (view->height - 2 * margin) * view_unit(fit->scene);
    const uint64_t across = width / needed(fit, &ruler, 0, place);
    const uint64_t down = height / needed(fit, &ruler, 1, place);
    const uint64_t zoom = across < down ? across : down;
    return view_possible_zoom(fit->scene, view, place, samples, zoom);
}
