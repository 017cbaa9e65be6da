#include "render/slice_notes.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/text.h"

enum {
    LETTERS_FROM = 48, /* pixels of the picture's shorter side at which notes begin */
    BARS_FROM = 128,
    LARGE_FROM = 192, /* and at which letters and marks are larger than can be */
};

static const uint8_t black[3] = {0, 0, 0}, white[3] = {255, 255, 255};
static const uint8_t ink[3] = {232, 232, 232}, cross_colour[3] = {255, 220, 0};
static const uint8_t seed_grey[3] = {225, 225, 225}, eliminator_red[3] = {255, 72, 56};

static uint32_t shorter_side(const struct canvas *canvas)
{
    return canvas->width < canvas->height ? canvas->width : canvas->height;
}

/* ---- seeds and eliminators ---- */

struct spot {
    int64_t column, row; /* the pixel of its middle */
    size_t voxel;        /* of the slice, counted row by row */
    uint8_t label;
    bool eliminates, waits;
};

struct spots {
    struct spot *spot;
    size_t count, capacity;
    bool failed;
};

static void add_spot(struct spots *spots, const struct slice_plan *plan, int64_t column_voxel,
                     int64_t row_voxel, const struct slice_mark *mark)
{
    if (!mem_grow(&spots->spot, &spots->capacity, spots->count + 1, sizeof *spots->spot)) {
        spots->failed = true;
        return;
    }
    spots->spot[spots->count++] =
        (struct spot){slice_side_pixel(&plan->side[0], column_voxel),
                      slice_side_pixel(&plan->side[1], row_voxel),
                      (size_t)(row_voxel * plan->side[0].voxels + column_voxel),
                      mark->label,
                      mark->eliminates,
                      mark->waits};
}

/* Every voxel of the slice counts, also those that no pixel shows. */
static void add_seeds(struct spots *spots, const struct scene *scene, const struct slice_plan *plan)
{
    for (int64_t y = 0; y < plan->side[1].voxels; y++) {
        const int64_t row = (int64_t)plan->corner + y * plan->step[1];
        for (int64_t x = 0; x < plan->side[0].voxels; x++) {
            const struct cell *cell = scene->cell + (row + x * plan->step[0]);
            if (cell->flags & CELL_SEED)
                add_spot(spots, plan, x, y, &(struct slice_mark){.label = cell->label});
        }
    }
}

static void add_marks(struct spots *spots, const struct scene *scene, const struct slice_plan *plan,
                      const struct slice_choice *choice, const struct slice_style *style)
{
    for (size_t i = 0; i < style->marks; i++) {
        const struct place p = grid_place(&scene->grid, style->mark[i].cell);
        const uint32_t place[3] = {p.x, p.y, p.z};
        if (place[plan->across] == choice->place[plan->across])
            add_spot(spots, plan, slice_side_counted(&plan->side[0], place),
                     slice_side_counted(&plan->side[1], place), &style->mark[i]);
    }
}

/* What is the same of the seeds of a run: their label, and whether they wait; 0 is no seed. */
static uint16_t run_of(const struct spot *spot)
{
    return (uint16_t)(spot->eliminates ? 0 : 1 + spot->label + (spot->waits ? 256 : 0));
}

static bool is_inner(const uint16_t *run, size_t voxel, size_t columns, size_t rows)
{
    const size_t x = voxel % columns, y = voxel / columns;
    const uint16_t *at = run + voxel;
    return *at && x > 0 && x + 1 < columns && y > 0 && y + 1 < rows && at[-1] == *at &&
           at[1] == *at && *(at - columns) == *at && at[columns] == *at;
}

/* Of a run of seeds only the rim stays: dots side by side would hide what is segmented. */
static void drop_inner(struct spots *spots, const struct slice_plan *plan)
{
    const size_t columns = (size_t)plan->side[0].voxels, rows = (size_t)plan->side[1].voxels;
    uint16_t *run = mem_new(columns * rows * sizeof *run);
    size_t left = 0;
    spots->failed = spots->failed || !run;
    if (spots->failed)
        return;
    for (size_t i = 0; i < spots->count; i++)
        run[spots->spot[i].voxel] = run_of(&spots->spot[i]);
    for (size_t i = 0; i < spots->count; i++)
        if (spots->spot[i].eliminates || !is_inner(run, spots->spot[i].voxel, columns, rows))
            spots->spot[left++] = spots->spot[i];
    spots->count = left;
    free(run);
}

/* Whether a mark covers a pixel so far from its middle: a disc, or two diagonals. */
static bool covers(const struct spot *spot, int64_t dx, int64_t dy, int64_t radius, int64_t around)
{
    const int64_t reach = radius + around, x = llabs(dx), y = llabs(dy);
    if (!spot->eliminates)
        return x * x + y * y <= reach * reach + reach / 2;
    return x <= reach && y <= reach && llabs(x - y) <= radius / 3 + around;
}

static void stamp(const struct canvas *canvas, const struct spot *spot, int64_t radius,
                  int64_t around, const uint8_t rgb[3])
{
    const int64_t reach = radius + around;
    for (int64_t dy = -reach; dy <= reach; dy++)
        for (int64_t dx = -reach; dx <= reach; dx++)
            if (covers(spot, dx, dy, radius, around))
                canvas_dot(canvas, spot->column + dx, spot->row + dy, rgb);
}

static const uint8_t *colour_of(const struct spot *spot, const struct palette *palette)
{
    const uint8_t *rgb = palette->rgb[spot->label];
    if (spot->eliminates)
        return eliminator_red;
    return rgb[0] || rgb[1] || rgb[2] ? rgb : seed_grey;
}

/* All outlines first, so that a ball of seeds is one thing with one outline; x over dots. */
static void draw_spots(const struct canvas *canvas, const struct spots *spots, int64_t unit,
                       const struct palette *palette)
{
    const int64_t more = shorter_side(canvas) >= LARGE_FROM;
    for (int pass = 0; pass < 4; pass++)
        for (size_t i = 0; i < spots->count; i++) {
            const struct spot *spot = &spots->spot[i];
            const int64_t radius = (spot->eliminates ? 2 * unit : unit) + more;
            if (spot->eliminates != (pass >= 2))
                continue;
            if (pass % 2 == 0)
                stamp(canvas, spot, radius, unit, spot->waits ? white : black);
            else
                stamp(canvas, spot, radius, 0, colour_of(spot, palette));
        }
}

static bool draw_marks(const struct canvas *canvas, const struct scene *scene,
                       const struct slice_plan *plan, const struct slice_choice *choice,
                       const struct slice_style *style)
{
    struct spots spots = {0};
    if (style->marks_seeds)
        add_seeds(&spots, scene, plan);
    if (style->marks_seeds)
        add_marks(&spots, scene, plan, choice, style);
    if (style->marks_rims && spots.count)
        drop_inner(&spots, plan);
    draw_spots(canvas, &spots, plan->unit, style->palette);
    free(spots.spot);
    return !spots.failed;
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
            pixel[k] = (uint8_t)((pixel[k] + 2 * cross_colour[k] + 1) / 3);
    }
}

static void draw_cross(const struct canvas *canvas, const struct slice_plan *plan,
                       const struct slice_choice *choice)
{
    int64_t middle[2], gap = 6 * (int64_t)plan->unit;
    if (gap > shorter_side(canvas) / 8)
        gap = shorter_side(canvas) / 8;
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
    const uint32_t scale = plan->unit + (shorter_side(canvas) >= LARGE_FROM);
    const int64_t wide = text_width("R", scale), tall = TEXT_TALL * (int64_t)scale;
    const int64_t margin = 2 * scale;
    const int64_t right = canvas->width - margin - wide, bottom = canvas->height - margin - tall;
    const int64_t centre = (canvas->width - wide) / 2, middle = (canvas->height - tall) / 2;
    text_draw(canvas, margin, middle, scale, letter_of(scene, &plan->side[0], true), ink);
    text_draw(canvas, right, middle, scale, letter_of(scene, &plan->side[0], false), ink);
    text_draw(canvas, centre, margin, scale, letter_of(scene, &plan->side[1], true), ink);
    text_draw(canvas, centre, bottom, scale, letter_of(scene, &plan->side[1], false), ink);
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

/* Bottom left; about a fifth of the picture's width. */
static void draw_scale(const struct canvas *canvas, const struct slice_plan *plan)
{
    const int64_t unit = plan->unit, pixel_pm = plan->side[0].pixel_pm;
    const uint64_t length = slice_round_length((uint64_t)pixel_pm * canvas->width / 4 + 1);
    const int64_t pixels = ((int64_t)length + pixel_pm / 2) / pixel_pm;
    const int64_t left = 4 * unit, bottom = canvas->height - 4 * unit, tick = 3 * unit;
    char words[32];
    slice_length_words(words, length);
    canvas_box(canvas, left - unit, bottom - 2 * unit, pixels + 2 * unit, 3 * unit, black);
    canvas_box(canvas, left - unit, bottom - unit - tick, 3 * unit, tick + 2 * unit, black);
    canvas_box(canvas, left + pixels - 2 * unit, bottom - unit - tick, 3 * unit, tick + 2 * unit,
               black);
    canvas_box(canvas, left, bottom - unit, pixels, unit, ink);
    canvas_box(canvas, left, bottom - tick, unit, tick, ink);
    canvas_box(canvas, left + pixels - unit, bottom - tick, unit, tick, ink);
    text_draw(canvas, left, bottom - tick - (TEXT_TALL + 3) * unit, (uint32_t)unit, words, ink);
}

/* Bottom right, with the values left of its ends. */
static void draw_greys(const struct canvas *canvas, int64_t unit, const struct slice_style *style)
{
    const int64_t wide = 5 * unit, tall = canvas->height / 4;
    const int64_t left = canvas->width - wide - 4 * unit, bottom = canvas->height - 4 * unit;
    const int64_t before = left - 3 * unit;
    const uint32_t scale = (uint32_t)unit;
    canvas_box(canvas, left - unit, bottom - tall - unit, wide + 2 * unit, tall + 2 * unit, ink);
    for (int64_t i = 0; i < tall; i++) {
        const uint8_t grey = (uint8_t)(255 * i / (tall - 1));
        canvas_box(canvas, left, bottom - 1 - i, wide, 1, (uint8_t[3]){grey, grey, grey});
    }
    text_draw(canvas, before - text_width(style->most, scale), bottom - tall, scale, style->most,
              ink);
    text_draw(canvas, before - text_width(style->least, scale), bottom - TEXT_TALL * unit, scale,
              style->least, ink);
}

bool slice_notes_draw(const struct canvas *canvas, const struct scene *scene,
                      const struct slice_plan *plan, const struct slice_choice *choice,
                      const struct slice_style *style)
{
    const uint32_t side = shorter_side(canvas), unit = plan->unit;
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
        text_draw(canvas, 4 * unit, 4 * unit, unit, choice->title, ink);
    return fine;
}
