#include "render/incremental.h"

#include "render/layers.h"
#include "render/projection.h"
#include "render/seams.h"
#include "render/sweep.h"

/* Splats what has appeared, and marks tiles. True where something has disappeared, of which all
 * pixels lie in those: voxels beside it, too, come to be no longer solid. */
static bool follow_voxels(struct rendition *r, const struct camera *camera,
                          const struct border *border, const struct changes *changes,
                          struct shade_reach reach, struct task *task)
{
    bool disappear = false;
    for (size_t i = 0; i < changes->count && task_advance(task, 1); i++) {
        const struct change *c = changes->item + i;
        const bool before = border->visible[c->former_label];
        const bool now = border->visible[c->label];
        const int around = r->layers ? reach.layers : before == now ? reach.labels : reach.voxels;
        if (before || now)
            rendition_mark_stale(r, splat_footprint(camera, c->cell, around), reach.pixels);
        if (now && !before) {
            /* With a skin, face neighbours may come to be solid. */
            if (border_is_hull(border, c->cell))
                splat_voxel(r, camera, c->cell);
            for (int k = 0; border->has_skin && k < 6; k++) {
                const ptrdiff_t step = border->scene->grid.step[k / 2];
                const uint32_t beside = c->cell + (uint32_t)(k % 2 ? step : -step);
                if (border_is_hull(border, beside) && !border_shows(border, beside))
                    splat_voxel(r, camera, beside);
            }
        }
        disappear = disappear || (before && !now);
    }
    return disappear;
}

void incremental_image(struct rendition *r, const struct camera *camera,
                       const struct border *border, const struct changes *changes,
                       struct shade_reach reach)
{
    const size_t tiles = (size_t)r->tiles_x * r->tiles_y;
    if (layers_are_projected(r)) {
        if (!layers_follow(r, camera, border, changes, reach)) {
            if (!seams_count(r->layers->seams, border, NULL))
                splat_border(r, camera, border);
            else
                raycast(r, camera, border);
        }
        return;
    }
    if (r->layers)
        seams_follow(r->layers->seams, border, changes, NULL); /* else shading counts them */
    if (changes->everything) {
        splat_border(r, camera, border);
        return;
    }
    struct task task = task_begin(camera->scene->watch, "rendition", changes->count);
    if (!follow_voxels(r, camera, border, changes, reach, &task))
        return;
    for (size_t i = rendition_tile(r, 0, tiles, TILE_STALE);
         i < tiles && task_advance(&task, TILE * TILE);
         i = rendition_tile(r, i + 1, tiles, TILE_STALE)) {
        /* Where a pixel of a tile shows a voxel that has disappeared, its ray goes on from there;
         * one that has appeared nearer is what it shows by now. */
        const uint32_t left = (uint32_t)(i % r->tiles_x) * TILE;
        const uint32_t top = (uint32_t)(i / r->tiles_x) * TILE;
        for (uint32_t y = top; y < top + TILE && y < r->height; y++)
            for (uint32_t x = left; x < left + TILE && x < r->width; x++) {
                const size_t pixel = (size_t)y * r->width + x;
                int64_t *depth = r->cube.depth + pixel;
                uint32_t *cell = r->cube.cell + pixel;
                if (*cell == CELL_NONE || border_is_solid(border, *cell) ||
                    raycast_pixel(camera, border, x, y, *depth, depth, cell))
                    continue;
                *depth = DEPTH_NONE;
                *cell = CELL_NONE;
            }
    }
}
