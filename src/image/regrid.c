/* SPDX-License-Identifier: MIT */
#include "image/regrid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/grid.h"

enum { FRACTION_BITS = 30 };

static bool have_places(const struct geometry *map, const struct geometry *scene)
{
    return geometry_has_place(map) && geometry_has_place(scene);
}

/* Return true if the map's voxels correspond to the scene's, one by one. */
static bool is_the_grid(const uint32_t map_size[3], const struct geometry *map,
                        const uint32_t size[3], const struct geometry *scene)
{
    bool same_spacing = true;
    if (!same_size(map_size, size))
        return false;
    if (have_places(map, scene))
        return geometry_apart(map, scene, size) <= geometry_half_voxel(scene);
    for (int i = 0; i < 3; i++) {
        const double x = map->spacing_nm[i], y = scene->spacing_nm[i];
        same_spacing &= fabs(x - y) <= 0.01 * y;
    }
    return same_spacing || map->spacing_unknown || scene->spacing_unknown;
}

/* ---- other orders of axes ---- */

bool regrid_find_order(struct regrid_order *order, const uint32_t map_size[3],
                       const struct geometry *map, const uint32_t size[3],
                       const struct geometry *scene)
{
    static const int8_t axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                      {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    double least = geometry_half_voxel(scene);
    bool found = false;
    for (int i = 0; i < 6 * 8 && have_places(map, scene); i++) {
        struct regrid_order tried;
        struct geometry placed;
        bool fits = true;
        for (int a = 0; a < 3; a++) {
            tried.axis[a] = axes[i / 8][a];
            tried.is_reversed[a] = i >> a & 1;
            fits &= map_size[tried.axis[a]] == size[a];
        }
        if (!fits)
            continue;
        for (int w = 0; w < 3; w++) { /* the matrix in that order, and nothing else */
            placed.to_mm[w][3] = map->to_mm[w][3];
            for (int a = 0; a < 3; a++) {
                const double step = map->to_mm[w][tried.axis[a]];
                placed.to_mm[w][a] = tried.is_reversed[a] ? -step : step;
                if (tried.is_reversed[a])
                    placed.to_mm[w][3] += step * (size[a] - 1);
            }
        }
        const double apart = geometry_apart(&placed, scene, size);
        if (!(apart <= least) || (found && apart == least))
            continue;
        *order = tried;
        order->apart_mm = least = apart;
        found = true;
    }
    return found;
}

/* Copy the voxels of the map in the order of the scene. */
static void reorder_voxels(uint16_t *out, const struct volume *map, const uint32_t size[3],
                           const struct regrid_order *order, struct watch *watch)
{
    const size_t stride[3] = {1, map->size[0], (size_t)map->size[0] * map->size[1]};
    struct task task = task_begin(watch, "reordering", (uint64_t)size[0] * size[1] * size[2]);
    size_t first = 0, step[3];
    for (int a = 0; a < 3; a++) {
        const size_t along = stride[order->axis[a]];
        first += order->is_reversed[a] ? along * (size[a] - 1) : 0;
        step[a] = order->is_reversed[a] ? 0 - along : along; /* modulo 2^64 */
    }
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1] && task_advance(&task, size[0]); y++) {
            size_t at = first + z * step[2] + y * step[1];
            for (uint32_t x = 0; x < size[0]; x++, at += step[0])
                *out++ = map->intensity[at];
        }
}

enum err regrid_check(const uint32_t map_size[3], const struct geometry *map,
                      const uint32_t size[3], const struct geometry *scene, enum regrid_how how,
                      struct fault *fault)
{
    const uint32_t *is = map_size;
    const bool have = have_places(map, scene);
    struct regrid_order order;
    if (is_the_grid(map_size, map, size, scene) || (how == REGRID_RESAMPLE && have) ||
        regrid_find_order(&order, map_size, map, size, scene))
        return OK;
    const char *remedy = have && how == REGRID_AS_IT_IS ? "resample=yes uses its nearest voxels"
                         : have                         ? "--resample uses its nearest voxels"
                                : "it cannot be resampled, since the place of one of both in the "
                                  "world is unknown";
    if (!same_size(map_size, size))
        return fault_set(fault, ERR_INPUT,
                         "the map has %ux%ux%u voxels and the scene %ux%ux%u; %s; nothing has "
                         "changed",
                         is[0], is[1], is[2], size[0], size[1], size[2], remedy);
    if (!have)
        return fault_set(fault, ERR_INPUT,
                         "the map has voxels of %gx%gx%g mm and the scene of %gx%gx%g; %s; nothing "
                         "has changed",
                         map->spacing_nm[0] / 1e6, map->spacing_nm[1] / 1e6,
                         map->spacing_nm[2] / 1e6, scene->spacing_nm[0] / 1e6,
                         scene->spacing_nm[1] / 1e6, scene->spacing_nm[2] / 1e6, remedy);
    return fault_set(fault, ERR_INPUT,
                     "the map is up to %.3g mm away from the scene; %s; nothing has changed",
                     geometry_apart(map, scene, size), remedy);
}

/* ---- resampling ---- */

/* Compute the columns of the transform from voxels of the scene to the map. */
static void find_columns(double column[4][3], const struct geometry *map,
                         const struct geometry *scene)
{
    for (int c = 0; c < 4; c++) {
        double from[3];
        for (int w = 0; w < 3; w++)
            from[w] = scene->to_mm[w][c] - (c == 3 ? map->to_mm[w][3] : 0);
        geometry_solve(map, from, column[c]);
    }
}

bool regrid_is_aligned(const uint32_t map_size[3], const struct geometry *map,
                       const uint32_t size[3], const struct geometry *scene)
{
    double column[4][3];
    if (!have_places(map, scene))
        return false;
    find_columns(column, map, scene);
    for (int r = 0; r < 3; r++) {
        double apart = fabs(column[3][r] - nearbyint(column[3][r]));
        int axes = 0;
        for (int c = 0; c < 3; c++) {
            const double step = nearbyint(column[c][r]);
            apart += fabs(column[c][r] - step) * fmax(size[c], map_size[r]);
            axes += fabs(step) == 1 ? 1 : step != 0 ? 3 : 0;
        }
        if (!(axes == 1 && apart < 0.5))
            return false;
    }
    return true;
}

/* The transform from voxels of the scene to the map: place = (way * (i, j, k, 1)) / 2^30. */
struct way {
    int64_t row[3][4];
    uint16_t zero; /* the intensity of value 0, for voxels outside the map */
};

/* Compute the transform; false if it overflows integers. */
static bool find_way(struct way *way, const struct geometry *map, const uint32_t size[3],
                     const struct geometry *scene)
{
    double column[4][3];
    find_columns(column, map, scene);
    for (int r = 0; r < 3; r++) {
        double reach = 0;
        for (int c = 0; c < 4; c++) {
            reach += fabs(column[c][r]) * (c < 3 ? size[c] : 1);
            if (!(reach < 1e9))
                return false;
            way->row[r][c] = (int64_t)floor(ldexp(column[c][r], FRACTION_BITS) + 0.5);
        }
        way->row[r][3] += INT64_C(1) << (FRACTION_BITS - 1); /* to the nearest */
    }
    return true;
}

/* Resample a row of the scene; returns the number of its voxels outside the map. */
static size_t resample_row(uint16_t *out, uint8_t *is_beyond, const struct volume *map,
                           const struct way *way, uint32_t count, uint32_t y, uint32_t z)
{
    const uint32_t *size = map->size;
    size_t beyond = 0;
    int64_t at[3];
    for (int r = 0; r < 3; r++)
        at[r] = way->row[r][1] * y + way->row[r][2] * z + way->row[r][3];
    for (uint32_t x = 0; x < count; x++) {
        bool inside = true;
        size_t place[3];
        for (int r = 0; r < 3; r++) {
            place[r] = (size_t)(uint64_t)at[r] >> FRACTION_BITS;
            inside &= at[r] >= 0 && place[r] < size[r];
            at[r] += way->row[r][0];
        }
        out[x] = inside ? map->intensity[(place[2] * size[1] + place[1]) * size[0] + place[0]]
                        : way->zero;
        beyond += !inside;
        if (is_beyond)
            is_beyond[x] = !inside;
    }
    return beyond;
}

/* Replace the voxels of the map, unless NULL, and its geometry by the scene's. */
static void replace_grid(struct volume *map, uint16_t *intensity, const uint32_t size[3],
                         const struct geometry *scene)
{
    const double slope = map->geometry.slope, intercept = map->geometry.intercept;
    if (intensity) {
        free(map->intensity);
        map->intensity = intensity;
    }
    memcpy(map->size, size, sizeof map->size);
    map->geometry = *scene;
    map->geometry.slope = slope;
    map->geometry.intercept = intercept;
}

/* Note a shift. Headers round places to a few digits: a thousandth of a voxel is not noted. */
static void note_shift(struct volume *map, double apart_mm, const struct geometry *scene)
{
    if (apart_mm > geometry_half_voxel(scene) / 500)
        volume_note(map->notes,
                    "the map is %.3g mm off the scene's grid, less than half a voxel: used voxel "
                    "for voxel; saved maps have the scene's place",
                    apart_mm);
}

static enum err resample_map(struct volume *map, uint16_t *out, uint8_t *is_beyond,
                             const uint32_t size[3], const struct geometry *scene,
                             enum regrid_how how, struct watch *watch, struct fault *fault)
{
    struct way way = {.zero = 0};
    if (!find_way(&way, &map->geometry, size, scene))
        return fault_set(fault, ERR_INPUT,
                         "the map and the scene are too far apart, or their voxels differ too much "
                         "in size, to be resampled; nothing has changed");
    struct task task = task_begin(watch, "resampling", (uint64_t)size[0] * size[1] * size[2]);
    size_t beyond = 0;
    const double zero = floor(-map->geometry.intercept / map->geometry.slope + 0.5);
    const bool has_zero =
        zero >= 0 && zero <= UINT16_MAX &&
        fabs(geometry_value(&map->geometry, zero)) <= fabs(map->geometry.slope) / 2;
    way.zero = has_zero ? (uint16_t)zero : 0;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1] && task_advance(&task, size[0]); y++, out += size[0]) {
            beyond += resample_row(out, is_beyond, map, &way, size[0], y, z);
            is_beyond = is_beyond ? is_beyond + size[0] : NULL;
        }
    if (beyond && !has_zero)
        return fault_set(fault, ERR_INPUT,
                         "%zu voxels of the scene are outside the map, which has no value 0 for "
                         "them; nothing has changed",
                         beyond);
    if (how == REGRID_FILL)
        return watch_fault(watch, fault);
    if (beyond)
        volume_note(map->notes, "%zu voxels of the scene are outside the map: %s", beyond,
                    is_beyond ? "they keep their labels, or are background" : "set to 0");
    volume_note(map->notes, "resampled from %ux%ux%u voxels by the nearest", map->size[0],
                map->size[1], map->size[2]);
    return watch_fault(watch, fault);
}

enum err regrid(struct volume *map, const uint32_t size[3], const struct geometry *scene,
                enum regrid_how how, uint8_t *beyond, struct watch *watch, struct fault *fault)
{
    struct regrid_order order;
    if (how != REGRID_FILL)
        TRY(regrid_check(map->size, &map->geometry, size, scene, how, fault));
    if (is_the_grid(map->size, &map->geometry, size, scene)) {
        if (have_places(&map->geometry, scene))
            note_shift(map, geometry_apart(&map->geometry, scene, size), scene);
        replace_grid(map, NULL, size, scene);
        return OK;
    }
    const bool is_ordered = how != REGRID_RESAMPLE && how != REGRID_FILL &&
                            regrid_find_order(&order, map->size, &map->geometry, size, scene);
    OWNED(mem_release)
    uint16_t *out = mem_array((size_t)size[0] * size[1] * size[2], sizeof *out);
    if (!out)
        return fault_memory(fault, "a map");
    if (is_ordered) {
        char is[4], becomes[4];
        geometry_axes(is, &map->geometry);
        geometry_axes(becomes, scene);
        reorder_voxels(out, map, size, &order, watch);
        volume_note(map->notes,
                    "its axes run towards %s and the scene's towards %s: taken voxel by voxel, in "
                    "the scene's order",
                    is, becomes);
        note_shift(map, order.apart_mm, scene);
        TRY(watch_fault(watch, fault));
    } else {
        TRY(resample_map(map, out, beyond, size, scene, how, watch, fault));
    }
    replace_grid(map, out, size, scene);
    out = NULL;
    return OK;
}
