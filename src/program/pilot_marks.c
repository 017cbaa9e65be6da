#include "program/pilot_marks.h"

#include <string.h>

#include "session/state.h"

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

/* ---- notes in cells of the screen ---- */

enum { BAR_FROM_COLUMNS = 16, BAR_FROM_ROWS = 7 }; /* cells of a pane */

static const uint8_t black[3] = {0, 0, 0}, ink[3] = {232, 232, 232};

struct notes {
    struct image_note *note;
    size_t count;
};

/* A pane in cells: the first ones, and the last that are no other pane's neighbours, so that no two
 * letters stand together. */
struct cells {
    uint32_t left, top, right, bottom;
};

static struct cells cells_of(const struct mosaic_screen *screen, const struct mosaic_box *box)
{
    return (struct cells){box->left / screen->cell_width, box->top / screen->cell_height,
                          (box->left + box->width) / screen->cell_width - 1,
                          (box->top + box->height) / screen->cell_height - 1};
}

static void add_note(struct notes *notes, uint32_t column, uint32_t row, char character)
{
    if (notes->count < PILOT_NOTES_MOST)
        notes->note[notes->count++] =
            (struct image_note){(uint16_t)column, (uint16_t)row, character};
}

static void add_letters(struct notes *notes, const struct scene *scene, enum slice_plane plane,
                        const struct cells *pane)
{
    const uint32_t centre = (pane->left + pane->right + 1) / 2;
    const uint32_t middle = (pane->top + pane->bottom + 1) / 2;
    char letter[4];
    slice_letters(scene, plane, letter);
    if (pane->right < pane->left + 2 || pane->bottom < pane->top + 2)
        return; /* no room for all of them, and one alone misleads */
    add_note(notes, pane->left, middle, letter[0]);
    add_note(notes, pane->right, middle, letter[1]);
    add_note(notes, centre, pane->top, letter[2]);
    add_note(notes, centre, pane->bottom, letter[3]);
}

/* Bottom left: a bar in the lower part of a row of cells, and its length above it. None where that
 * would reach the middle, where a letter is. */
static void add_bar(struct notes *notes, const struct canvas *canvas,
                    const struct mosaic_screen *screen, const struct mosaic_box *box,
                    const struct cells *pane, uint64_t pixel_pm)
{
    const uint64_t length = slice_round_length(pixel_pm * box->width / 3 + 1);
    const int64_t pixels = (int64_t)((length + pixel_pm / 2) / pixel_pm);
    const int64_t tall = screen->cell_height, thick = (tall + 2) / 3;
    const int64_t left = (pane->left + 1) * (int64_t)screen->cell_width,
                  top = (pane->bottom - 1) * tall;
    char words[32];
    slice_length_words(words, length);
    if (pane->left + 2 + strlen(words) > (pane->left + pane->right) / 2)
        return;
    canvas_box(canvas, left, top, pixels, tall - thick, black);
    canvas_box(canvas, left, top + tall - thick, pixels, thick, ink);
    for (uint32_t i = 0; words[i]; i++)
        add_note(notes, pane->left + 1 + i, pane->bottom - 2, words[i]);
}

size_t pilot_notes_add(struct image_note note[PILOT_NOTES_MOST], const struct canvas *canvas,
                       const struct session *session, const struct slicing_panel *panel)
{
    struct notes notes = {note, 0};
    const struct scene *scene = session_scene(session);
    const struct mosaic_screen *screen = &panel->screen;
    bool has_bar = false;
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const struct mosaic_box *box = &panel->layout.box[plane];
        if (box->width == 0 || !session_outlook(session)->slices.words)
            continue;
        const struct cells pane = cells_of(screen, box);
        if (!scene->sides_unknown)
            add_letters(&notes, scene, plane, &pane);
        if (!has_bar && !scene->spacing_unknown && pane.right - pane.left >= BAR_FROM_COLUMNS - 1 &&
            pane.bottom - pane.top >= BAR_FROM_ROWS - 1)
            add_bar(
                &notes, canvas, screen, box, &pane,
                mosaic_slice(scene, &panel->choice, canvas->width, canvas->height, plane).pixel_pm);
        has_bar = true;
    }
    return notes.count;
}
