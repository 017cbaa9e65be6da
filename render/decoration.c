/* SPDX-License-Identifier: MIT */
#include "render/decoration.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/slice.h"
#include "render/projection.h"

static const uint8_t black[3];

static const struct ink *ink_of(const struct decoration *d)
{
    return d->is_bright ? &notes_dark : &notes_light;
}

/* ---- letters ---- */

/* Write the sides of the patient within some 67 degrees of a direction, the nearest first. */
static void write_sides(char word[DECORATION_WORD], const int32_t direction[3], bool sides_unknown)
{
    static const char *const side[2][3][2] = {{{"R", "L"}, {"A", "P"}, {"S", "I"}},
                                              {{"+x", "-x"}, {"+y", "-y"}, {"+z", "-z"}}};
    const int64_t least = view_sine(22500);
    bool is_taken[3] = {false};
    size_t length = 0;
    word[0] = '\0';
    for (int i = 0; i < 3; i++) {
        int nearest = -1;
        for (int a = 0; a < 3; a++)
            if (!is_taken[a] && llabs(direction[a]) >= least &&
                (nearest < 0 || llabs(direction[a]) > llabs(direction[nearest])))
                nearest = a;
        if (nearest < 0)
            return;
        is_taken[nearest] = true;
        length += (size_t)snprintf(word + length, DECORATION_WORD - length, "%s",
                                   side[sides_unknown][nearest][direction[nearest] < 0]);
    }
}

void decoration_sides(char word[4][DECORATION_WORD], const struct camera *camera)
{
    int32_t way[2][3], ahead[3];
    view_look(&camera->view, way[0], way[1], ahead);
    for (int i = 0; i < 4; i++) {
        int32_t direction[3];
        for (int a = 0; a < 3; a++) /* `up` and `right` keep their sign */
            direction[a] = i == 1 || i == 2 ? way[i / 2][a] : -way[i / 2][a];
        write_sides(word[i], direction, camera->scene->sides_unknown);
    }
}

/* ---- the scale ---- */

int64_t decoration_scale(char words[32], const struct camera *camera, uint32_t samples,
                         uint32_t width)
{
    const struct scene *scene = camera->scene;
    const uint32_t *nm = scene->spacing_nm;
    const uint64_t pixel_pm =
        (uint64_t)camera->unit_nm * 1000 * VIEW_ZOOM_ONE * samples / (uint64_t)camera->view.zoom;
    const uint64_t most = pixel_pm * width / 4, voxel_pm = (uint64_t)nm[0] * 1000;
    uint64_t length = most ? slice_round_length(most) : 0;
    if (scene->spacing_unknown && (nm[0] != nm[1] || nm[1] != nm[2] || most < voxel_pm))
        return 0;
    if (scene->spacing_unknown) {
        const uint64_t voxels = slice_round_length(most / voxel_pm);
        snprintf(words, 32, "%llu voxel%s", (unsigned long long)voxels, voxels == 1 ? "" : "s");
        length = voxels * voxel_pm;
    } else {
        slice_length_words(words, length);
    }
    return pixel_pm ? (int64_t)((length + pixel_pm / 2) / pixel_pm) : 0;
}

/* ---- the legend ---- */

/* Rows of the legend, from the top left, clear of the letters and the scale. */
struct rows {
    int64_t top, next, end; /* rows; none may end after `end` */
    int64_t hole, hole_end; /* no row may overlap this */
};

static struct rows rows_of(const struct canvas *canvas, const struct decoration *d, uint32_t tall)
{
    const int64_t letter = notes_tall_letters(notes_side(canvas)), margin = notes_margin(tall);
    const int64_t foot = d->parts & DECORATE_SCALE ? 3 * (int64_t)tall : 0;
    struct rows rows = {margin, text_line(tall), canvas->height - margin - foot, 0, 0};
    if (d->parts & DECORATE_LETTERS) {
        rows.hole = (canvas->height - letter - tall) / 2;
        rows.hole_end = rows.hole + letter + tall;
    }
    return rows;
}

/* Return the top of the next row; false if it does not fit. */
static bool next_row(struct rows *rows, uint32_t tall, int64_t *top)
{
    if (rows->top + tall > rows->hole && rows->top < rows->hole_end)
        rows->top = rows->hole_end;
    *top = rows->top;
    rows->top += rows->next;
    return *top + tall <= rows->end;
}

/* Shorten the name to leave room for the amount; if too little remains, draw the name alone. */
static void draw_line(const struct canvas *canvas, const struct decoration *d, uint32_t tall,
                      int64_t top, const struct legend_line *line)
{
    const int64_t left = notes_margin(tall), halo = text_halo(tall), width = canvas->width;
    const int64_t end = top < 2 * (int64_t)tall ? width / 2 - tall : 2 * width / 3;
    const int64_t gap = tall - tall / 4, words_left = left + tall + gap, room = end - words_left;
    const int64_t amount = gap + text_width(line->amount, tall);
    const struct ink *ink = ink_of(d);
    char name[sizeof line->name + 4];
    memcpy(name, line->name, sizeof line->name);
    const bool has_amount =
        amount + text_width(name, tall) <= room || amount + 4 * (int64_t)tall <= room;
    text_cut(name, sizeof name, tall, has_amount ? room - amount : room);
    canvas_box(canvas, left - halo, top - halo, tall + 2 * halo, tall + 2 * halo, ink->outline);
    canvas_box(canvas, left, top, tall, tall, d->palette->rgb[line->label]);
    text_draw(canvas, words_left, top, tall, name, ink);
    if (has_amount)
        text_draw(canvas, words_left + text_width(name, tall) + gap, top, tall, line->amount, ink);
}

static void draw_legend(const struct canvas *canvas, const struct decoration *d, uint32_t tall)
{
    struct rows rows = rows_of(canvas, d, tall);
    size_t fit = 0;
    int64_t top;
    char words[32];
    while (fit < d->lines && next_row(&rows, tall, &top))
        fit++;
    if (fit < d->lines && fit > 0)
        fit--; /* leave a row for the number of labels left out */
    rows = rows_of(canvas, d, tall);
    for (size_t i = 0; i < fit && next_row(&rows, tall, &top); i++)
        draw_line(canvas, d, tall, top, &d->line[i]);
    snprintf(words, sizeof words, "and %zu more", d->lines - fit);
    if (fit < d->lines && next_row(&rows, tall, &top))
        text_draw(canvas, notes_margin(tall), top, tall, words, ink_of(d));
}

/* ---- seeds and the cross-hair ---- */

/* Return the pixel that contains the centre of a voxel. */
static void place_of(const struct decoration *d, uint32_t cell, int64_t place[2])
{
    const struct camera *camera = d->camera;
    int64_t centre[3];
    project_place(camera, grid_place(&camera->scene->grid, cell), centre);
    for (int i = 0; i < 2; i++) {
        const int64_t sample = (centre[i] + (1 << 29)) >> 30, n = d->samples;
        place[i] = sample >= 0 ? sample / n : -((n - 1 - sample) / n);
    }
}

static bool is_seen(const struct decoration *d, uint32_t cell)
{
    const struct footprint f = project_around(d->camera, cell, 1); /* surfaces may extend beyond the
                                                                      voxel */
    const int32_t n = (int32_t)d->samples;
    const bool is_none = f.left > f.right || f.top > f.bottom;
    for (int32_t y = f.top / n; y <= f.bottom / n && !is_none; y++)
        for (int32_t x = f.left / n; x <= f.right / n; x++)
            if (d->frame->cell[(size_t)y * d->frame->width + (size_t)x] == cell)
                return true;
    return false;
}

static void add_mark(struct marks *marks, const struct decoration *d, uint32_t cell,
                     bool eliminates)
{
    const struct rendition *r = d->frame;
    int64_t place[2];
    place_of(d, cell, place);
    marks_add(marks, (struct mark){place[0], place[1],
                                   (size_t)grid_held(place[1], r->height) * r->width +
                                       grid_held(place[0], r->width),
                                   d->camera->scene->cell[cell].label, eliminates, false});
}

static bool draw_seeds(const struct canvas *canvas, const struct decoration *d, uint32_t unit)
{
    const size_t pixels = (size_t)d->frame->width * d->frame->height;
    const size_t zoom = d->camera->view.zoom / d->samples;
    const struct rendition *r = d->frame;
    struct marks marks = {0};
    OWNED(mem_release) uint16_t *run = mem_new(pixels * sizeof *run);
    const struct mark_runs runs = {.run = run,
                                   .columns = r->width,
                                   .rows = r->height,
                                   .step = zoom < VIEW_ZOOM_ONE ? 1 : zoom / VIEW_ZOOM_ONE};
    if (!run)
        return false;
    for (uint32_t y = 0; y < r->height; y++)
        for (uint32_t x = 0; x < r->width; x++) {
            const size_t pixel = (size_t)y * r->width + x;
            const uint32_t cell = r->cell[pixel];
            if (cell == CELL_NONE || !(d->camera->scene->cell[cell].flags & CELL_SEED) ||
                !mark_choice_has(&d->marked, cell))
                continue;
            const struct mark mark = {.label = d->camera->scene->cell[cell].label};
            run[pixel] = mark_run(&mark);
            if ((x == 0 || r->cell[pixel - 1] != cell) &&
                (y == 0 || r->cell[pixel - r->width] != cell))
                add_mark(&marks, d, cell, false);
        }
    marks_keep(&marks, &runs, MARKS_OF_RIMS);
    for (size_t i = 0; i < d->eliminators; i++)
        if (is_seen(d, d->eliminator[i]))
            add_mark(&marks, d, d->eliminator[i], true);
    marks_draw(canvas, &marks, unit, marks_more(canvas), d->palette);
    free(marks.mark);
    return !marks.failed;
}

/* Draw four arms around the voxel, leaving it free. */
static void draw_cross(const struct canvas *canvas, const struct decoration *d, int64_t unit)
{
    const int64_t zoom = d->camera->view.zoom / d->samples / VIEW_ZOOM_ONE;
    const int64_t gap = 3 * unit + zoom / 2, length = 8 * unit;
    int64_t at[2];
    if (!is_seen(d, d->cross))
        return;
    place_of(d, d->cross, at);
    for (int64_t around = unit; around >= 0; around -= unit) {
        const uint8_t *rgb = around ? black : notes_yellow;
        const int64_t wide = unit + 2 * around, arm = length + 2 * around, half = unit / 2;
        canvas_box(canvas, at[0] - gap - length - around, at[1] - half - around, arm, wide, rgb);
        canvas_box(canvas, at[0] + gap + 1 - around, at[1] - half - around, arm, wide, rgb);
        canvas_box(canvas, at[0] - half - around, at[1] - gap - length - around, wide, arm, rgb);
        canvas_box(canvas, at[0] - half - around, at[1] + gap + 1 - around, wide, arm, rgb);
    }
}

enum err decoration_draw(const struct canvas *canvas, const struct decoration *d,
                         struct fault *fault)
{
    const uint32_t side = notes_side(canvas), unit = slice_unit(side), tall = notes_tall(side);
    if (d->parts & DECORATE_SEEDS && !draw_seeds(canvas, d, unit))
        return fault_memory(fault, "the marks of a rendition");
    if (d->parts & DECORATE_CROSS)
        draw_cross(canvas, d, unit);
    if (d->parts & DECORATE_LEGEND && side >= NOTES_BARS_FROM)
        draw_legend(canvas, d, tall);
    if (d->parts & DECORATE_LETTERS && side >= NOTES_LETTERS_FROM) {
        char word[4][DECORATION_WORD];
        decoration_sides(word, d->camera);
        const char *const sides[4] = {word[0], word[1], word[2], word[3]};
        notes_draw_sides(canvas, side, sides, ink_of(d));
    }
    if (d->parts & DECORATE_SCALE && side >= NOTES_BARS_FROM) {
        char words[32];
        const int64_t pixels = decoration_scale(words, d->camera, d->samples, canvas->width);
        if (pixels > 0)
            notes_draw_scale(canvas, tall, pixels, words, ink_of(d));
    }
    return OK;
}
