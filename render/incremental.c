#include "render/layers.h"

#include <stdlib.h>

#include "base/mem.h"

/* Pixels whose voxel has disappeared, with the depth from which the ray goes on. */
struct holes {
    struct hole {
        uint32_t column, row;
        int64_t depth;
    } * item;
    size_t count, capacity;
};

/* Empties the pixels that show a voxel which has disappeared. False when memory runs out. */
static bool open_holes(struct holes *holes, struct rendition *r, const struct camera *camera,
                       uint32_t cell)
{
    struct footprint f = splat_footprint(camera, cell, 0);
    for (int32_t y = f.top; y <= f.bottom; y++)
        for (int32_t x = f.left; x <= f.right; x++) {
            size_t pixel = (size_t)y * r->width + (size_t)x;
            if (r->cube.cell[pixel] != cell)
                continue;
            if (!mem_grow(&holes->item, &holes->capacity, holes->count + 1, sizeof *holes->item))
                return false;
            holes->item[holes->count++] =
                (struct hole){(uint32_t)x, (uint32_t)y, r->cube.depth[pixel]};
            r->cube.depth[pixel] = DEPTH_NONE;
            r->cube.cell[pixel] = CELL_NONE;
        }
    return true;
}

/* Continues the ray after the voxel that has disappeared; one that has appeared nearer stays. */
static void fill_hole(struct rendition *r, const struct camera *camera, const struct border *border,
                      const struct hole *hole)
{
    size_t pixel = (size_t)hole->row * r->width + hole->column;
    int64_t depth;
    uint32_t cell;
    if (raycast_pixel(camera, border, hole->column, hole->row, hole->depth, &depth, &cell) &&
        depth < r->cube.depth[pixel]) {
        r->cube.depth[pixel] = depth;
        r->cube.cell[pixel] = cell;
    }
}

/* With a skin, what the neighbours of a voxel are follows from it too. Those that are shown are
 * solid whatever becomes of it. */
static bool follow_skin(struct holes *holes, struct rendition *r, const struct camera *camera,
                        const struct border *border, uint32_t cell, bool appears)
{
    for (int i = 0; border->has_skin && i < 6; i++) {
        const ptrdiff_t step = border->scene->grid.step[i / 2];
        const uint32_t beside = cell + (uint32_t)(i % 2 ? step : -step);
        if (border_shows(border, beside) || !border_is_open(border, beside))
            continue;
        if (appears && border_is_hull(border, beside))
            splat_voxel(r, camera, beside);
        else if (!appears && !border_is_solid(border, beside) &&
                 !open_holes(holes, r, camera, beside))
            return false;
    }
    return true;
}

/* A voxel that was shown, or is from now on, and not both. */
static bool follow_voxel(struct holes *holes, struct rendition *r, const struct camera *camera,
                         const struct border *border, uint32_t cell, bool appears)
{
    if (appears && border_is_hull(border, cell))
        splat_voxel(r, camera, cell);
    else if (!appears && !border_is_solid(border, cell) && !open_holes(holes, r, camera, cell))
        return false;
    return follow_skin(holes, r, camera, border, cell, appears);
}

void incremental_image(struct rendition *r, const struct camera *camera,
                       const struct border *border, const struct changes *changes,
                       struct shade_reach reach)
{
    if (layers_are_projected(r)) {
        layers_follow(r, camera, border, changes, reach);
        return;
    }
    struct holes holes = {0};
    bool fits = !changes->everything;
    if (r->layers)
        seams_follow(r->layers->seams, border, changes, NULL); /* else shading counts them */
    struct task task = task_begin(camera->scene->watch, "rendition", changes->count);
    for (size_t i = 0; fits && i < changes->count && task_advance(&task, 1); i++) {
        const struct change *c = changes->item + i;
        const bool before = border->visible[c->former_label];
        const bool now = border->visible[c->label];
        const int around = r->layers       ? layers_reach(reach)
                           : before == now ? reach.labels
                                           : reach.voxels;
        if (before || now)
            rendition_mark_stale(r, splat_footprint(camera, c->cell, around), reach.pixels);
        if (before != now)
            fits = follow_voxel(&holes, r, camera, border, c->cell, now);
    }
    for (size_t i = 0; fits && i < holes.count && task_advance(&task, 1); i++)
        fill_hole(r, camera, border, &holes.item[i]);
    if (!fits)
        splat_border(r, camera, border);
    free(holes.item);
}
