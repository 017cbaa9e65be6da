#include "render/rendition.h"

/*
 * The walk goes from crossing to crossing in the order of (t, axis). At crossing `at` the ray is in
 * the cube whose flipped position along axis b is the number of planes of b, after plane 0, that
 * have been crossed by then.
 */
bool raycast_pixel(const struct camera *camera, const struct border *border, uint32_t column,
                   uint32_t row, int64_t from, int64_t *depth, uint32_t *cell)
{
    const struct grid *grid = &camera->scene->grid;
    int64_t first[3], next[3], at = from;
    int64_t left[3]; /* planes of each axis still ahead before the ray leaves the scene */
    for (int a = 0; a < 3; a++) {
        first[a] = camera_crossing(camera, a, 0, column, row);
        at = first[a] > at ? first[a] : at;
    }
    uint32_t here = grid_cell(grid, 0, 0, 0);
    for (int a = 0; a < 3; a++) {
        int64_t n = (at - first[a]) / camera->T[a];
        left[a] = (int64_t)grid->size[a] - n;
        if (left[a] <= 0)
            return false;
        next[a] = first[a] + (n + 1) * camera->T[a];
        int64_t along = camera->flip[a] ? left[a] - 1 : n;
        here = (uint32_t)(here + along * grid->step[a]);
    }
    while (!border_shows(border, here)) {
        int a = next[0] < next[1] ? 0 : 1;
        a = next[a] < next[2] ? a : 2;
        if (--left[a] == 0)
            return false;
        at = next[a];
        next[a] += camera->T[a];
        here -= (uint32_t)camera->toward[a];
    }
    *depth = at;
    *cell = here;
    return true;
}

void raycast(struct rendition *r, const struct camera *camera, const struct border *border)
{
    rendition_clear(r);
    const uint32_t *size = border->scene->grid.size;
    const uint64_t row = r->width * ((uint64_t)size[0] + size[1] + size[2]); /* steps at most */
    struct task task = task_begin(border->scene->watch, "rendition", row * r->height);
    for (uint32_t y = 0; y < r->height && task_advance(&task, row); y++)
        for (uint32_t x = 0; x < r->width; x++) {
            size_t pixel = (size_t)y * r->width + x;
            raycast_pixel(camera, border, x, y, INT64_MIN, &r->depth[pixel], &r->cell[pixel]);
        }
}
