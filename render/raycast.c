#include "render/layers.h"
#include "render/walk.h"

/* To the first solid voxel before the ray comes to a crossing. */
static bool find_solid(struct walk *walk, const struct border *border, int64_t end)
{
    do
        if (border_is_solid(border, walk->cell))
            return true;
    while (walk_on(walk) && walk->at < end);
    return false;
}

/* Most blocks of voxels on its way are empty. */
bool raycast_pixel(const struct camera *camera, const struct border *border, uint32_t column,
                   uint32_t row, int64_t from, int64_t *depth, uint32_t *cell)
{
    struct walk blocks, walk;
    if (!walk_begin(&blocks, camera, BORDER_BLOCK_BITS, column, row, from))
        return false;
    do {
        if (border->occupied[blocks.cell] && walk_begin(&walk, camera, 0, column, row, blocks.at) &&
            find_solid(&walk, border, walk_leaves(&blocks))) {
            *depth = walk.at;
            *cell = walk.cell;
            return true;
        }
    } while (walk_on(&blocks));
    return false;
}

void raycast(struct rendition *r, const struct camera *camera, const struct border *border)
{
    if (layers_are_projected(r)) {
        layers_raycast(r, camera, border);
        return;
    }
    rendition_clear(r);
    const uint32_t *size = border->scene->grid.size;
    const uint64_t row = r->width * ((uint64_t)size[0] + size[1] + size[2]); /* steps at most */
    struct task task = task_begin(border->scene->watch, "rendition", row * r->height);
    for (uint32_t y = 0; y < r->height && task_advance(&task, row); y++)
        for (uint32_t x = 0; x < r->width; x++) {
            size_t pixel = (size_t)y * r->width + x;
            raycast_pixel(camera, border, x, y, INT64_MIN, &r->cube.depth[pixel],
                          &r->cube.cell[pixel]);
        }
}
