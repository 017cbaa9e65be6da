#include "render/slice_notes.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/marks.h"
#include "render/notes.h"
#include "render/text.h"

enum {
    LETTERS_FROM = 48, /* pixels of the picture's shorter side at which notes begin */
    BARS_FROM = 128,
};

/* ---- seeds and eliminators ---- */

static void add_mark(struct marks *marks, const struct slice_plan *plan, int64_t column_voxel,
                     int64_t row_voxel, const struct slice_mark *mark)
{
    marks_add(marks, (struct mark){slice_side_pixel(&plan->side[0], column_voxel),
                                   slice_side_pixel(&plan->side[1], row_voxel),
                                   (size_t)(row_voxel * plan->side[0].voxels + column_voxel),
                                   mark->label, mark->eliminates, mark->waits});
}

/* Every voxel of the slice counts, also those that no pixel shows. */
static void add_seeds(struct marks *marks, const struct scene *scene, const struct slice_plan *plan)
{
    for (int64_t y = 0; y < plan->side[1].voxels; y++) {
        const int64_t row = (int64_t)plan->corner + y * plan->step[1];
        for (int64_t x = 0; x < plan->side[0].voxels; x++) {
            const struct cell *cell = scene->cell + (row + x * plan->step[0]);
            if (cell->flags & CELL_SEED)
                add_mark(marks, plan, x, y, &(struct slice_mark){.label = cell->label});
        }
    }
}

static void add_others(struct marks *marks, const struct scene *scene,
                       const struct slice_plan *plan, const struct slice_choice *choice,
                       const struct slice_style *style)
{
    for (size_t i = 0; i < style->marks; i++) {
        const struct place p = grid_place(&scene->grid, style->mark[i].cell);
        const uint32_t place[3] = {p.x, p.y, p.z};
        if (place[plan->across] == choice->place[plan->across])
            add_mark(marks, plan, slice_side_counted(&plan->side[0], place),
                     slice_side_counted(&plan->side[1], place), &style->mark[i]);
    }
}

/* Dots side by side would hide what is segmented. */
static void keep_rims(struct marks *marks, const struct slice_plan *plan)
{
    struct mark_runs runs = {
        .columns = (size_t)plan->side[0].voxels, .rows = (size_t)plan->side[1].voxels, .step = 1};
    runs.run = mem_new(runs.columns * runs.rows * sizeof *runs.run);
    marks->failed = marks->failed || !runs.run;
    for (size_t i = 0; i < marks->count && !marks->failed; i++)
        runs.run[marks->mark[i].at] = mark_run(&marks->mark[i]);
    if (!marks->failed)
        marks_keep_rims(marks, &runs);
    free(runs.run);
}

static bool draw_marks(const struct canvas *canvas, const struct scene *scene,
                       const struct slice_plan *plan, const struct slice_choice *choice,
                       const struct slice_style *style)
{
    struct marks marks = {0};
    if (style->marks_seeds)
        add_seeds(&marks, scene, plan);
    if (style->marks_seeds)
        add_others(&marks, scene, plan, choice, style);
    if (style->marks_rims && marks.count)
        keep_rims(&marks, plan);
    marks_draw(canvas, &marks, plan->unit, style->palette);
    free(marks.mark);
    return !marks.failed;
}

/* ---- the cross-hair ---- */

/* A line along one side through `at` of the other, which leaves the middle free. */
static void draw_line(const struct canvas *canvas, bool upright, int64_t at, int64_t middle,
                      int64_t gap)
{
    const int64_t length = upright ? canvas->height : canvas->width;
    const int64_t breadth = upright ? canvas->width : canvas->height;
    for (int64_t i = 0; at >= 0 && at < breadth && i < length; i++) {
        if (i >= middle - gap && i <= middle + gap)
            continue;
        uint8_t *pixel = upright ? canvas_pixel(canvas, (size_t)at, (size_t)i)
                                 : canvas_pixel(canvas, (size_t)i, (size_t)at);
        for (int k = 0; k < 3; k++)
            pixel[k] = (uint8_t)((pixel[k] + 2 * notes_yellow[k] + 1) / 3);
    }
}

static void draw_cross(const struct canvas *canvas, const struct slice_plan *plan,
                       const struct slice_choice *choice)
{
    int64_t middle[2], gap = 6 * (int64_t)plan->unit;
    if (gap > notes_side(canvas) / 8)
        gap = notes_side(canvas) / 8;
    for (int i = 0; i < 2; i++) {
        const struct slice_side *side = &plan->side[i];
        const int64_t half_voxel = side->spacing_pm / (2 * side->pixel_pm) + 1;
        middle[i] = slice_side_pixel(side, slice_side_counted(side, choice->place));
        gap = half_voxel > gap ? half_voxel : gap;
    }
    draw_line(canvas, true, middle[0], middle[1], gap);
    draw_line(canvas, false, middle[1], middle[0], gap);
}

/* ---- letters ---- */

/* The patient's side towards which a side of the picture begins, or ends. */
static const char *letter_of(const struct scene *scene, const struct slice_side *side, bool begins)
{
    static const char *const letter[3][2] = {{"L", "R"}, {"P", "A"}, {"I", "S"}};
    const bool towards_high_indices = side->backwards == begins;
    const bool axis_is_worlds = scene->world_sign[side->axis] > 0;
    return letter[scene->world_axis[side->axis]][towards_high_indices == axis_is_worlds];
}

void slice_letters(const struct scene *scene, enum slice_plane plane, char letter[4])
{
    const struct slice_choice choice = {.plane = plane};
    struct slice_plan plan;
    slice_plan_init(&plan, scene, &choice, 1, 1);
    for (int i = 0; i < 4; i++)
        letter[i] = *letter_of(scene, &plan.side[i / 2], i % 2 == 0);
}

static void draw_letters(const struct canvas *canvas, const struct scene *scene,
                         const struct slice_plan *plan)
{
    const char *const word[4] = {
        letter_of(scene, &plan->side[0], true), letter_of(scene, &plan->side[0], false),
        letter_of(scene, &plan->side[1], true), letter_of(scene, &plan->side[1], false)};
    notes_draw_sides(canvas, plan->unit, word, &notes_light);
}

/* ---- bars ---- */

uint64_t slice_round_length(uint64_t most)
{
    static const uint64_t first[3] = {5, 2, 1};
    uint64_t power = 1;
    while (power <= most / 10)
        power *= 10;
    for (int i = 0; i < 2; i++)
        if (first[i] <= most / power)
            return first[i] * power;
    return power;
}

void slice_length_words(char out[32], uint64_t pm)
{
    int n = snprintf(out, 32, "%llu.%09llu", (unsigned long long)(pm / 1000000000),
                     (unsigned long long)(pm % 1000000000));
    while (out[n - 1] == '0')
        n--;
    n -= out[n - 1] == '.';
    snprintf(out + n, 32 - (size_t)n, " mm");
}

/* About a fifth of the picture's width. */
static void draw_scale(const struct canvas *canvas, const struct slice_plan *plan)
{
    const int64_t pixel_pm = plan->side[0].pixel_pm;
    const uint64_t length = slice_round_length((uint64_t)pixel_pm * canvas->width / 4 + 1);
    char words[32];
    slice_length_words(words, length);
    notes_draw_scale(canvas, plan->unit, ((int64_t)length + pixel_pm / 2) / pixel_pm, words,
                     &notes_light);
}

/* Bottom right, with the values left of its ends. */
static void draw_greys(const struct canvas *canvas, int64_t unit, const struct slice_style *style)
{
    const int64_t wide = 5 * unit, tall = canvas->height / 4;
    const int64_t left = canvas->width - wide - 4 * unit, bottom = canvas->height - 4 * unit;
    const int64_t before = left - 3 * unit;
    const uint32_t scale = (uint32_t)unit;
    canvas_box(canvas, left - unit, bottom - tall - unit, wide + 2 * unit, tall + 2 * unit,
               notes_light.rgb);
    for (int64_t i = 0; i < tall; i++) {
        const uint8_t grey = (uint8_t)(255 * i / (tall - 1));
        canvas_box(canvas, left, bottom - 1 - i, wide, 1, (uint8_t[3]){grey, grey, grey});
    }
    text_draw(canvas, before - text_width(style->most, scale), bottom - tall, scale, style->most,
              notes_light.rgb);
    text_draw(canvas, before - text_width(style->least, scale), bottom - TEXT_TALL * unit, scale,
              style->least, notes_light.rgb);
}

bool slice_notes_draw(const struct canvas *canvas, const struct scene *scene,
                      const struct slice_plan *plan, const struct slice_choice *choice,
                      const struct slice_style *style)
{
    const uint32_t side = notes_side(canvas), unit = plan->unit;
    const bool fine = draw_marks(canvas, scene, plan, choice, style);
    if (style->crosses)
        draw_cross(canvas, plan, choice);
    if (choice->notes & SLICE_LETTERS && side >= LETTERS_FROM && !scene->sides_unknown)
        draw_letters(canvas, scene, plan);
    if (choice->notes & SLICE_SCALE && side >= BARS_FROM && !scene->spacing_unknown)
        draw_scale(canvas, plan);
    if (choice->notes & SLICE_COLOURS && side >= BARS_FROM)
        draw_greys(canvas, plan->unit, style);
    if (choice->title && side >= BARS_FROM)
        text_draw(canvas, 4 * unit, 4 * unit, unit, choice->title, notes_light.rgb);
    return fine;
}
