/* SPDX-License-Identifier: MIT */
#include "show/outline_mark.h"

#include <stdlib.h>
#include <string.h>

#include "session/paint.h"

static const uint8_t white[3] = {255, 255, 255}, black[3] = {0, 0, 0};

static bool is_inside(const struct voxels *inside, uint32_t cell)
{
    size_t low = 0, high = inside->count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        *(inside->cell[middle] <= cell ? &low : &high) = middle;
    }
    return inside->count > 0 && inside->cell[low] == cell;
}

static void fill(const struct canvas *pane, const struct voxels *inside, const uint8_t rgb[3])
{
    uint32_t last = CELL_NONE;
    bool is_filled = false;
    for (uint32_t y = 0; y < pane->height; y++)
        for (uint32_t x = 0; x < pane->width; x++) {
            const size_t at = y * pane->stride + x;
            uint8_t *pixel = canvas_pixel(pane, x, y);
            if (pane->cell[at] != last) { /* pixels of a voxel are neighbours */
                last = pane->cell[at];
                is_filled = is_inside(inside, last);
            }
            if (is_filled && !pane->words[at] && x % 2 == 0 && y % 2 == 0)
                memcpy(pixel, rgb, 3);
        }
}

/* Whether a line from one to the other stays on one side of the pane. */
static bool is_beside(const struct canvas *pane, const int64_t from[2], const int64_t to[2])
{
    const int64_t size[2] = {pane->width, pane->height};
    for (int i = 0; i < 2; i++)
        if ((from[i] < 0 && to[i] < 0) || (from[i] >= size[i] && to[i] >= size[i]))
            return true;
    return false;
}

/* From pixel to pixel; dotted ones are every third. */
static void draw_line(const struct canvas *pane, const int64_t from[2], const int64_t to[2],
                      bool is_dotted)
{
    const int64_t way[2] = {to[0] - from[0], to[1] - from[1]};
    const int64_t across = llabs(way[0]), down = llabs(way[1]);
    const int64_t steps = across > down ? across : down, parts = steps ? steps : 1;
    for (int64_t i = 0; i <= steps; i++) {
        const int64_t column = from[0] + way[0] * i / parts, row = from[1] + way[1] * i / parts;
        if (!is_dotted || i % 3 == 0) {
            canvas_dot(pane, column + (across < down), row + (across >= down), black);
            canvas_dot(pane, column, row, white);
        }
    }
}

void outline_mark_draw(const struct canvas *canvas, const struct scene *scene,
                       const struct slice_choice *slice, const struct mosaic_box *box,
                       const struct outline_mark *mark)
{
    const struct canvas pane = canvas_part(canvas, box->left, box->top, box->width, box->height);
    struct voxels inside = {0};
    struct slice_plan plan;
    slice_plan_init(&plan, scene, slice, box->width, box->height);
    for (size_t i = 0; i < mark->corners; i++)
        if (mark->corner[i][plan.across] != slice->place[plan.across])
            return;
    if (paint_polygon(&inside, &scene->grid, mark->corner, mark->corners, NULL, NULL) == OK)
        fill(&pane, &inside, mark->rgb);
    voxels_release(&inside);
    for (size_t i = 0; i < mark->corners; i++) {
        const uint32_t *end[2] = {mark->corner[i], mark->corner[(i + 1) % mark->corners]};
        int64_t at[2][2];
        for (int k = 0; k < 4; k++) {
            const struct slice_side *side = &plan.side[k % 2];
            at[k / 2][k % 2] = slice_side_pixel(side, slice_side_counted(side, end[k / 2]));
        }
        if (!is_beside(&pane, at[0], at[1]))
            draw_line(&pane, at[0], at[1], i + 1 == mark->corners);
    }
}
