#include "program/pilot_marks.h"

#include <string.h>

static const uint8_t marked_tree[3] = {255, 255, 255}, marked_pixel[3] = {255, 255, 255},
                     marked_way[3] = {230, 200, 90};

/* ---- what an eliminator takes ---- */

void pilot_mark_held(const struct canvas *canvas, const struct session *session,
                     const struct held *held)
{
    for (uint32_t y = 0; y < canvas->height; y++)
        for (uint32_t x = y % 2; x < canvas->width; x += 2) { /* hatched: seen without colours */
            const uint32_t at = canvas->cell[y * canvas->stride + x];
            if (at != CELL_NONE && session_is_held(session, held, at))
                memcpy(canvas_pixel(canvas, x, y), marked_tree, sizeof marked_tree);
        }
}

/* ---- points ---- */

/* A cross of short lines around a pixel. */
static void mark_point(const struct canvas *canvas, int64_t column, int64_t row, int gap)
{
    enum { ARM = 6 };
    for (int i = gap; i < gap + ARM; i++) {
        canvas_dot(canvas, column - i, row, marked_pixel);
        canvas_dot(canvas, column + i, row, marked_pixel);
        canvas_dot(canvas, column, row - i, marked_pixel);
        canvas_dot(canvas, column, row + i, marked_pixel);
    }
}

void pilot_mark_pixel(const struct canvas *canvas, const struct slicing_panel *panel,
                      const struct rendition *r, const uint32_t pixel[2])
{
    const struct mosaic_point at =
        mosaic_point_of(canvas->width, canvas->height, &panel->choice, r, pixel[0], pixel[1]);
    mark_point(canvas, at.column, at.row, 2);
}

void pilot_mark_corners(const struct canvas *canvas, const struct scene *scene,
                        const struct slicing_panel *panel, enum slice_plane plane,
                        const struct pilot_wish *wish)
{
    const struct mosaic_box *box = &panel->layout.box[plane];
    const struct slice_choice slice =
        mosaic_slice(scene, &panel->choice, canvas->width, canvas->height, plane);
    uint32_t pixel[2];
    for (size_t i = 0; i < wish->corners && box->width > 0; i++)
        if (slice_pixel_of(scene, &slice, box->width, box->height, wish->corner[i], pixel))
            mark_point(canvas, (int64_t)box->left + pixel[0], (int64_t)box->top + pixel[1], 1);
}

/* ---- a path ---- */

/* The pixel that stands for a voxel in a slice, be it of that slice or not. False beside it. */
static bool find_pixel(const struct scene *scene, const struct slice_choice *slice,
                       const struct mosaic_box *box, uint32_t cell, int64_t pixel[2])
{
    const struct place p = grid_place(&scene->grid, cell);
    uint32_t place[3] = {p.x, p.y, p.z}, found[2];
    slice_move(scene, slice->plane, slice_index(scene, slice->plane, slice->place), place);
    if (!slice_pixel_of(scene, slice, box->width, box->height, place, found))
        return false;
    pixel[0] = (int64_t)box->left + found[0];
    pixel[1] = (int64_t)box->top + found[1];
    return true;
}

static bool is_in_slice(const struct scene *scene, const struct slice_choice *slice, uint32_t cell)
{
    const struct place p = grid_place(&scene->grid, cell);
    const uint32_t place[3] = {p.x, p.y, p.z};
    return slice_index(scene, slice->plane, place) ==
           slice_index(scene, slice->plane, slice->place);
}

void pilot_mark_way(const struct canvas *canvas, const struct scene *scene,
                    const struct slicing_panel *panel, enum slice_plane plane,
                    const struct way *way)
{
    const struct mosaic_box *box = &panel->layout.box[plane];
    const struct slice_choice slice =
        mosaic_slice(scene, &panel->choice, canvas->width, canvas->height, plane);
    int64_t pixel[2];
    for (size_t i = 0; i < way->count && box->width > 0; i++) {
        if (!find_pixel(scene, &slice, box, way->cell[i], pixel))
            continue;
        canvas_box(canvas, pixel[0], pixel[1], 2, 2,
                   is_in_slice(scene, &slice, way->cell[i]) ? marked_pixel : marked_way);
    }
    if (box->width > 0 && way->edge != CELL_NONE &&
        find_pixel(scene, &slice, box, way->edge, pixel))
        mark_point(canvas, pixel[0], pixel[1], 3);
}

/* ---- heat ---- */

/* The grey of a pixel, mixed with half of the heat's colour, or with three quarters of it. */
static void mix(uint8_t *pixel, uint8_t grey, uint8_t heat)
{
    const unsigned quarters = heat + 1u;
    for (int k = 0; k < 3; k++) {
        const unsigned hue = PILOT_HEAT_HUE >> (16 - 8 * k) & 255;
        pixel[k] = (uint8_t)((hue * quarters + grey * (4 - quarters)) / 4);
    }
}

void pilot_draw_heat(const struct canvas *canvas, const struct mosaic_box *box, const uint8_t *heat,
                     bool over_tint)
{
    for (uint32_t y = box->top; y < box->top + box->height; y++)
        for (uint32_t x = box->left; x < box->left + box->width; x++) {
            const size_t at = y * canvas->stride + x;
            const uint32_t cell = canvas->cell[at];
            const uint8_t grey = canvas->below[at], *pixel = canvas_pixel(canvas, x, y);
            const bool is_grey = pixel[0] == grey && pixel[1] == grey && pixel[2] == grey;
            if (cell != CELL_NONE && heat[cell] && !canvas->words[at] && (is_grey || over_tint))
                mix(canvas_pixel(canvas, x, y), grey, heat[cell]);
        }
}
