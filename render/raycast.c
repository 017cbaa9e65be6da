#include "render/layers.h"
#include "render/walk.h"

bool raycast_pixel(const struct camera *camera, const struct border *border, uint32_t column,
                   uint32_t row, int64_t from, int64_t *depth, uint32_t *cell)
{
    struct walk walk;
    if (!walk_begin(&walk, camera, column, row, from))
        return false;
    while (!border_is_solid(border, walk.cell))
        if (!walk_on(&walk))
            return false;
    *depth = walk.at;
    *cell = walk.cell;
    return true;
}

void raycast(struct rendition *r, const struct camera *camera, const struct border *border)
{
    if (r->layers) {
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
