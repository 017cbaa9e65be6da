/* SPDX-License-Identifier: MIT */
#include "render/slice.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/labels.h"

enum {
    PART = 256, /* parts of the distance between two voxels */
    HALF = PART * PART / 2,
    HAIRLINE_DIMS = 4, /* divisor of the grey */
};

void slice_window(uint8_t grey[UINT16_MAX + 1], int32_t low, int32_t high)
{
    const int64_t width = low < high ? (int64_t)high - low : (int64_t)low - high;
    for (int64_t i = 0; i <= UINT16_MAX; i++) {
        const int64_t above = low < high ? i - low : low - i;
        grey[i] = (uint8_t)(above <= 0       ? 0
                            : above >= width ? 255
                                             : (above * 255 + width / 2) / width);
    }
}

/* ---- columns ---- */

/* The voxels that a pixel column reads in a row of voxels: two positions in the list of columns,
 * the weight of the second, and the one that contains its centre. */
struct sample {
    uint32_t low, high, near;
    uint32_t part;
};

/* A slice in progress. Columns are counted from the first that shows something. */
struct work {
    const struct canvas *canvas;
    const struct scene *scene;
    const struct slice_choice *choice;
    const struct slice_style *style;
    struct slice_plan plan;
    struct labels labels;
    uint8_t shown[256]; /* a label, or 0 if it is hidden */
    struct sample *sample;
    uint32_t *voxel;  /* [columns], the voxel that contains each centre */
    ptrdiff_t *reads; /* voxels to read, as cells from the row's first */
    size_t columns, count;
    uint8_t *label; /* [rows][columns] of the picture */

    uint16_t *intensity; /* [count] of a row of voxels */
    uint8_t *of_voxel;   /* [count], their labels */
    struct row {
        int64_t voxel;  /* number of the row of voxels, -1 for none */
        uint32_t *grey; /* [columns], intensities times PART */
        uint8_t *label; /* [columns] */
    } row[2];           /* even and odd rows, so that neighbours are available at the same time */
};

/* Return the voxel before a pixel on a side; `part` is 0 if only that voxel counts. */
static int64_t between(const struct slice_side *side, int64_t pixel, bool smooth, uint32_t *part)
{
    const int64_t last = side->voxels - 1;
    int64_t voxel = smooth ? slice_side_between(side, pixel, part) : slice_side_voxel(side, pixel);
    if (!smooth || voxel < 0 || voxel >= last)
        *part = 0;
    return voxel < 0 ? 0 : voxel > last ? last : voxel;
}

/* Voxels increase from column to column, so each is listed once. */
static void list_columns(struct work *work, bool smooth)
{
    const struct slice_side *side = &work->plan.side[0];
    const ptrdiff_t step = work->plan.step[0];
    int64_t last = -1; /* the last voxel listed */
    for (size_t x = 0; x < work->columns; x++) {
        struct sample *s = &work->sample[x];
        const int64_t pixel = side->first + (int64_t)x;
        const int64_t low = between(side, pixel, smooth, &s->part);
        const int64_t high = low + (s->part > 0);
        const int64_t begin = low > last ? low : last + 1;
        for (int64_t voxel = begin; voxel <= high; voxel++)
            work->reads[work->count++] = (ptrdiff_t)voxel * step;
        last = high > last ? high : last;
        s->low = (uint32_t)(work->count - 1 - (size_t)(last - low));
        s->high = (uint32_t)(work->count - 1 - (size_t)(last - high));
        work->voxel[x] = (uint32_t)slice_side_voxel(side, pixel);
        s->near = work->voxel[x] == low ? s->low : s->high;
    }
}

/* ---- rows ---- */

/* Return a row of voxels, interpolated along the columns. Each cell is read once: in sagittal
 * slices they are too far apart for caches. */
static const struct row *row_of(struct work *work, int64_t voxel)
{
    struct row *row = &work->row[voxel & 1];
    if (row->voxel == voxel)
        return row;
    const struct cell *cell =
        work->scene->cell + ((ptrdiff_t)work->plan.corner + voxel * work->plan.step[1]);
    for (size_t i = 0; i < work->count; i++) {
        const struct cell *at = cell + work->reads[i];
        work->intensity[i] = at->intensity;
        work->of_voxel[i] =
            work->shown[labels_at(&work->labels, (uint32_t)(at - work->scene->cell))];
    }
    for (size_t x = 0; x < work->columns; x++) {
        const struct sample *s = &work->sample[x];
        row->grey[x] =
            work->intensity[s->low] * (PART - s->part) + work->intensity[s->high] * s->part;
        row->label[x] = work->of_voxel[s->near];
    }
    row->voxel = voxel;
    return row;
}

static void paint_grey(struct work *work)
{
    const struct slice_side *side = &work->plan.side[1];
    const size_t left = (size_t)work->plan.side[0].first;
    for (int64_t y = side->first; y < side->end; y++) {
        uint32_t part = 0;
        const int64_t voxel = between(side, y, work->choice->smooth, &part);
        const int64_t near = slice_side_voxel(side, y);
        const struct row *low = row_of(work, voxel);
        const struct row *high = part ? row_of(work, voxel + 1) : low;
        uint8_t *pixel = canvas_pixel(work->canvas, left, (size_t)y);
        const size_t columns = work->columns;
        for (size_t x = 0; x < columns; x++, pixel += 4) {
            const uint32_t mixed = low->grey[x] * (PART - part) + high->grey[x] * part;
            const uint8_t shade = work->style->grey[(mixed + HALF) / (PART * PART)];
            memcpy(pixel, (const uint8_t[4]){shade, shade, shade, 255}, 4);
        }
        memcpy(work->label + (size_t)(y - side->first) * work->columns,
               near == voxel ? low->label : high->label, work->columns);
    }
}

/* ---- labels ---- */

/* Return the label of a pixel: 0 outside the scene, `own` outside the picture, whose edge is no
 * contour. */
static uint8_t label_at(const struct work *work, int64_t x, int64_t y, uint8_t own)
{
    const struct slice_side *column = &work->plan.side[0], *row = &work->plan.side[1];
    if (x < 0 || y < 0 || x >= column->pixels || y >= row->pixels)
        return own;
    if (x < column->first || y < row->first || x >= column->end || y >= row->end)
        return 0;
    return work->label[(size_t)(y - row->first) * work->columns + (size_t)(x - column->first)];
}

/* Return the distance to the nearest other label left, right, above or below, up to `reach`, or
 * 0. */
static int64_t edge_near(const struct work *work, int64_t x, int64_t y, uint8_t own, int64_t reach)
{
    for (int64_t d = 1; d <= reach; d++)
        if (label_at(work, x - d, y, own) != own || label_at(work, x + d, y, own) != own ||
            label_at(work, x, y - d, own) != own || label_at(work, x, y + d, own) != own)
            return d;
    return 0;
}

/* The same if all those pixels are in the scene, as nearly everywhere. */
static int64_t edge_near_inside(const uint8_t *label, ptrdiff_t columns, int64_t reach)
{
    for (ptrdiff_t d = 1; d <= reach; d++)
        if ((label[-d] ^ *label) | (label[d] ^ *label) | (label[-d * columns] ^ *label) |
            (label[d * columns] ^ *label))
            return d;
    return 0;
}

/* Return true if eight adjacent pixels have no other label within reach. */
static bool is_plain(const uint8_t *label, ptrdiff_t columns, int64_t reach)
{
    uint64_t own, other, differs = 0;
    memcpy(&own, label, sizeof own);
    for (ptrdiff_t d = 1; d <= reach; d++) {
        const ptrdiff_t step[4] = {-d, d, -d * columns, d * columns};
        for (int i = 0; i < 4; i++) {
            memcpy(&other, label + step[i], sizeof other);
            differs |= own ^ other;
        }
    }
    return !differs;
}

/* Draw a line of the label's colour along the edge of a region, between two hairlines that darken
 * the picture: outside if there is no label, and, if there is room, inside. */
static void outline_row(const struct work *work, int64_t y, const struct palette *palette)
{
    const struct slice_side *column = &work->plan.side[0], *row = &work->plan.side[1];
    const int64_t line = slice_unit(work->plan.size), hair = (line + 1) / 2;
    const int64_t reach = line > 1 ? line + hair : line;
    const bool is_inner = y - row->first >= reach && row->end - y > reach;
    const ptrdiff_t columns = (ptrdiff_t)work->columns;
    const uint8_t *label = work->label + (y - row->first) * columns;
    for (int64_t x = column->first; x < column->end; x++, label++) {
        const bool inside = is_inner && x - column->first >= reach && column->end - x >= reach + 8;
        if (inside && x % 8 == 0 && is_plain(label, columns, reach)) {
            x += 7;
            label += 7;
            continue;
        }
        uint8_t *pixel = canvas_pixel(work->canvas, (size_t)x, (size_t)y);
        const int64_t near = *label ? reach : hair;
        const int64_t edge =
            inside ? edge_near_inside(label, columns, near) : edge_near(work, x, y, *label, near);
        if (*label && edge && edge <= line)
            memcpy(pixel, palette->rgb[*label], 3);
        else
            for (int k = 0; edge && k < 3; k++)
                pixel[k] /= HAIRLINE_DIMS;
    }
}

static void paint_labels(const struct work *work)
{
    const struct slice_side *column = &work->plan.side[0], *row = &work->plan.side[1];
    const struct palette *palette = work->style->palette;
    const size_t columns = work->columns;
    for (int64_t y = row->first; y < row->end; y++) {
        uint8_t *pixel = canvas_pixel(work->canvas, (size_t)column->first, (size_t)y);
        const uint8_t *label = work->label + (size_t)(y - row->first) * columns;
        if (work->style->overlay == SLICE_CONTOUR)
            outline_row(work, y, palette);
        else
            for (size_t x = 0; x < columns; x++, pixel += 4)
                for (int k = 0; label[x] && k < 3; k++)
                    pixel[k] = (uint8_t)((2 * pixel[k] + palette->rgb[label[x]][k] + 1) / 3);
    }
}

/* ---- seeds and eliminators ---- */

static void add_mark(struct marks *marks, const struct slice_plan *plan, int64_t column_voxel,
                     int64_t row_voxel, const struct slice_mark *mark)
{
    marks_add(marks, (struct mark){slice_side_pixel(&plan->side[0], column_voxel),
                                   slice_side_pixel(&plan->side[1], row_voxel),
                                   (size_t)(row_voxel * plan->side[0].voxels + column_voxel),
                                   mark->label, mark->eliminates, mark->waits});
}

/* The runs at pixels, with a margin of `margin` empty pixels. */
struct run_map {
    const struct work *work;
    uint16_t *run; /* [rows][columns] including the margin; 0 for none */
    ptrdiff_t columns;
    int64_t margin;
};

static const uint16_t *run_at(const struct run_map *map, size_t x, int64_t y)
{
    const int64_t row = y - map->work->plan.side[1].first + map->margin;
    return map->run + row * map->columns + map->margin + (ptrdiff_t)x;
}

/* Return another run left, right, above or below, within a reach; otherwise the same run. */
static uint16_t other_near(const uint16_t *run, ptrdiff_t columns, int64_t reach)
{
    for (ptrdiff_t d = 1; d <= reach; d++) {
        const ptrdiff_t step[4] = {-d, d, -d * columns, d * columns};
        for (int i = 0; i < 4; i++)
            if (run[step[i]] != *run)
                return run[step[i]];
    }
    return *run;
}

/* Draw a line of the label's colour inside the rim, as thin as contours are, and a hairline
 * outside. */
static void draw_rim(const struct run_map *map, size_t x, int64_t y)
{
    const struct work *work = map->work;
    const struct slice_plan *plan = &work->plan;
    const struct mark_choice *filled = &work->style->filled;
    const uint16_t *run = run_at(map, x, y), own = *run;
    const uint16_t other = other_near(run, map->columns, own ? map->margin : (map->margin + 1) / 2);
    if (other == own && !(own && filled->shows))
        return;
    uint8_t *pixel = canvas_pixel(work->canvas, (size_t)plan->side[0].first + x, (size_t)y);
    const uint8_t *rgb = marks_colour(work->style->palette, (uint8_t)(own - 1));
    const int64_t cell = (int64_t)plan->corner + (int64_t)work->voxel[x] * plan->step[0] +
                         slice_side_voxel(&plan->side[1], y) * plan->step[1];
    if (own && other != own)
        memcpy(pixel, rgb, 3);
    else if (own && filled->shows(filled->of, (uint32_t)cell))
        for (int k = 0; k < 3; k++)
            pixel[k] = (uint8_t)((2 * pixel[k] + rgb[k] + 1) / 3);
    else if (!own && other > 256) /* it waits for a run */
        memset(pixel, 255, 3);
    else if (!own && other)
        for (int k = 0; k < 3; k++)
            pixel[k] /= HAIRLINE_DIMS;
}

/* Rows of pixels without runs within reach are skipped. */
static bool draw_rims(const struct work *work, const struct mark_runs *runs)
{
    const struct slice_side *row = &work->plan.side[1];
    const int64_t margin = slice_unit(work->plan.size), rows = row->end - row->first + 2 * margin;
    const size_t columns = work->columns + 2 * (size_t)margin;
    OWNED(mem_release) uint16_t *run_of = mem_new(columns * (size_t)rows * sizeof *run_of);
    const struct run_map map = {work, run_of, (ptrdiff_t)columns, margin};
    OWNED(mem_release) uint8_t *is_used = mem_new((size_t)rows); /* rows with runs within reach */
    const bool fine = map.run && is_used;
    for (int64_t y = row->first; y < row->end && fine; y++) {
        const uint16_t *of = runs->run + (size_t)slice_side_voxel(row, y) * runs->columns;
        uint16_t *run = (uint16_t *)run_at(&map, 0, y), any = 0;
        for (size_t x = 0; x < work->columns; x++)
            any |= run[x] = of[work->voxel[x]];
        if (any)
            memset(is_used + (y - row->first), 1, (size_t)(2 * margin + 1));
    }
    for (int64_t y = row->first; y < row->end && fine; y++)
        for (size_t x = 0; x < work->columns && is_used[y - row->first + margin]; x++)
            draw_rim(&map, x, y);
    return fine;
}

/* Draw seeds and eliminators. False if memory runs out. */
static bool draw_marks(const struct work *work)
{
    struct marks marks = {0};
    if (work->style->marks_seeds) {
        /* Collect every voxel of the slice, also those without pixels. */
        const struct slice_plan *plan = &work->plan;
        for (int64_t y = 0; y < plan->side[1].voxels; y++) {
            const int64_t row = (int64_t)plan->corner + y * plan->step[1];
            for (int64_t x = 0; x < plan->side[0].voxels; x++) {
                const struct cell *cell = work->scene->cell + (row + x * plan->step[0]);
                if (cell->flags & CELL_SEED &&
                    mark_choice_has(&work->style->marked, (uint32_t)(cell - work->scene->cell)))
                    add_mark(&marks, plan, x, y, &(struct slice_mark){.label = cell->label});
            }
        }
        for (size_t i = 0; i < work->style->marks; i++) {
            const struct slice_mark *mark = &work->style->mark[i];
            const struct place p = grid_place(&work->scene->grid, mark->cell);
            const uint32_t place[3] = {p.x, p.y, p.z};
            if (place[plan->across] == work->choice->place[plan->across])
                add_mark(&marks, plan, slice_side_counted(&plan->side[0], place),
                         slice_side_counted(&plan->side[1], place), mark);
        }
    }
    if (marks.count) {
        /* Adjacent dots would hide the object. */
        const size_t columns = (size_t)work->plan.side[0].voxels;
        const size_t rows = (size_t)work->plan.side[1].voxels;
        OWNED(mem_release) uint16_t *run = mem_new(columns * rows * sizeof *run);
        const struct mark_runs runs = {.run = run, .columns = columns, .rows = rows, .step = 1};
        marks.failed = marks.failed || !run;
        for (size_t i = 0; i < marks.count && !marks.failed; i++)
            run[marks.mark[i].at] = mark_run(&marks.mark[i]);
        if (!marks.failed && work->style->thin)
            marks.failed = !draw_rims(work, &runs);
        if (run)
            marks_keep(&marks, &runs, work->style->thin ? MARKS_ALONE : MARKS_OF_RIMS);
    }
    marks_draw(work->canvas, &marks, slice_unit(work->plan.size),
               work->style->thin ? 0 : marks_more(work->canvas), work->style->palette);
    free(marks.mark);
    return !marks.failed;
}

/* ---- the cross-hair ---- */

/* Draw a line along one side through `at` of the other, with a gap in the middle. */
static void draw_line(const struct canvas *canvas, const uint8_t rgb[3], bool upright, int64_t at,
                      int64_t middle, int64_t gap)
{
    const int64_t length = upright ? canvas->height : canvas->width;
    const int64_t breadth = upright ? canvas->width : canvas->height;
    for (int64_t i = 0; at >= 0 && at < breadth && i < length; i++) {
        if (i >= middle - gap && i <= middle + gap)
            continue;
        uint8_t *pixel = upright ? canvas_pixel(canvas, (size_t)at, (size_t)i)
                                 : canvas_pixel(canvas, (size_t)i, (size_t)at);
        for (int k = 0; k < 3; k++)
            pixel[k] = (uint8_t)((pixel[k] + 2 * rgb[k] + 1) / 3);
    }
}

static void draw_cross(const struct work *work)
{
    const struct canvas *canvas = work->canvas;
    const uint8_t *rgb = work->style->thin ? notes_lime : notes_yellow;
    int64_t middle[2], gap = 6 * (int64_t)slice_unit(work->plan.size);
    if (gap > notes_side(canvas) / 8)
        gap = notes_side(canvas) / 8;
    for (int i = 0; i < 2; i++) {
        const struct slice_side *side = &work->plan.side[i];
        const int64_t half_voxel = side->spacing_pm / (2 * side->pixel_pm) + 1;
        middle[i] = slice_side_pixel(side, slice_side_counted(side, work->choice->place));
        gap = half_voxel > gap ? half_voxel : gap;
    }
    draw_line(canvas, rgb, true, middle[0], middle[1], gap);
    draw_line(canvas, rgb, false, middle[1], middle[0], gap);
}

/* ---- letters and bars ---- */

/* Draw the bar of greys at the bottom right, with values left of its ends. */
static void draw_greys(const struct canvas *canvas, uint32_t tall, const struct slice_style *style)
{
    const int64_t wide = 2 * tall / 3, high = canvas->height / 4, frame = text_halo(tall);
    const int64_t margin = notes_margin(tall) + frame, bottom = canvas->height - margin;
    const int64_t left = canvas->width - wide - margin, before = left - tall / 2 - frame;
    canvas_box(canvas, left - frame, bottom - high - frame, wide + 2 * frame, high + 2 * frame,
               notes_light.rgb);
    for (int64_t i = 0; i < high; i++) {
        const uint8_t grey = (uint8_t)(255 * i / (high - 1));
        canvas_box(canvas, left, bottom - 1 - i, wide, 1, (uint8_t[3]){grey, grey, grey});
    }
    text_draw(canvas, before - text_width(style->most, tall), bottom - high, tall, style->most,
              &notes_light);
    text_draw(canvas, before - text_width(style->least, tall), bottom - tall, tall, style->least,
              &notes_light);
}

static void draw_notes(const struct work *work)
{
    const struct scene *scene = work->scene;
    const struct slice_choice *choice = work->choice;
    const uint32_t side = notes_side(work->canvas), tall = notes_tall(work->plan.size);
    if (work->style->crosses)
        draw_cross(work);
    if (choice->notes & SLICE_LETTERS && side >= NOTES_LETTERS_FROM && !scene->sides_unknown) {
        char letter[4];
        slice_letters(scene, choice->plane, letter);
        const char *const word[4] = {(char[]){letter[0], 0}, (char[]){letter[1], 0},
                                     (char[]){letter[2], 0}, (char[]){letter[3], 0}};
        notes_draw_sides(work->canvas, work->plan.size, word, &notes_light);
    }
    if (choice->notes & SLICE_SCALE && side >= NOTES_BARS_FROM && !scene->spacing_unknown) {
        /* At most a quarter of the picture's width. */
        const int64_t pixel_pm = work->plan.side[0].pixel_pm;
        const uint64_t most = (uint64_t)pixel_pm * work->canvas->width / 4 + 1;
        const uint64_t length = slice_round_length(most);
        char words[32];
        slice_length_words(words, length);
        notes_draw_scale(work->canvas, tall, ((int64_t)length + pixel_pm / 2) / pixel_pm, words,
                         &notes_light);
    }
    if (choice->notes & SLICE_COLOURS && side >= NOTES_BARS_FROM)
        draw_greys(work->canvas, tall, work->style);
    if (choice->title && side >= NOTES_BARS_FROM)
        text_draw(work->canvas, notes_margin(tall), notes_margin(tall), tall, choice->title,
                  &notes_light);
}

/* ---- the whole ---- */

enum err slice_draw(const struct canvas *canvas, const struct scene *scene,
                    const struct slice_choice *choice, const struct slice_style *style,
                    struct fault *fault)
{
    struct work work = {.canvas = canvas, .scene = scene, .choice = choice, .style = style};
    slice_plan_init(&work.plan, scene, choice, canvas->width, canvas->height);
    /* Allocate the rows of samples, and list the columns. */
    const struct slice_side *side = work.plan.side;
    const size_t columns = (size_t)(side[0].end - side[0].first);
    const size_t rows = (size_t)(side[1].end - side[1].first);
    work.labels = (struct labels){work.scene, work.style->finished};
    work.columns = columns;
    for (unsigned label = 1; label < 256; label++)
        work.shown[label] = work.style->visible[label] ? (uint8_t)label : 0;
    work.row[0].voxel = work.row[1].voxel = -1;
    const struct mem_part parts[] = {{&work.sample, columns, sizeof *work.sample},
                                     {&work.voxel, columns, sizeof *work.voxel},
                                     {&work.reads, 2 * columns, sizeof *work.reads},
                                     {&work.label, columns * rows, sizeof *work.label},
                                     {&work.intensity, 2 * columns, sizeof *work.intensity},
                                     {&work.of_voxel, 2 * columns, sizeof *work.of_voxel},
                                     {&work.row[0].grey, columns, sizeof *work.row[0].grey},
                                     {&work.row[0].label, columns, sizeof *work.row[0].label},
                                     {&work.row[1].grey, columns, sizeof *work.row[1].grey},
                                     {&work.row[1].label, columns, sizeof *work.row[1].label}};
    bool fine = mem_parts(parts, sizeof parts / sizeof *parts);
    if (fine) {
        list_columns(&work, work.choice->smooth);
        /* Fill the surroundings of the scene with black. */
        static const uint8_t black[3];
        const struct slice_side *column = &work.plan.side[0], *row = &work.plan.side[1];
        canvas_box(canvas, 0, 0, column->pixels, row->first, black);
        canvas_box(canvas, 0, row->end, column->pixels, row->pixels - row->end, black);
        canvas_box(canvas, 0, row->first, column->first, row->end - row->first, black);
        canvas_box(canvas, column->end, row->first, column->pixels - column->end,
                   row->end - row->first, black);
        paint_grey(&work);
        for (uint32_t y = 0; y < canvas->height && canvas->below; y++) {
            const uint8_t *pixel = canvas_pixel(canvas, 0, y);
            uint8_t *below = canvas->below + y * canvas->stride;
            for (size_t x = 0; x < canvas->width; x++)
                below[x] = pixel[4 * x];
        }
        if (style->overlay != SLICE_PLAIN)
            paint_labels(&work);
        if (canvas->cell) {
            for (int64_t y = 0; y < row->pixels; y++) {
                uint32_t *cell = canvas->cell + (size_t)y * canvas->stride;
                for (int64_t x = 0; x < column->pixels; x++)
                    cell[x] = CELL_NONE;
                if (y < row->first || y >= row->end)
                    continue;
                const int64_t first =
                    (int64_t)work.plan.corner + slice_side_voxel(row, y) * work.plan.step[1];
                for (size_t x = 0; x < work.columns; x++)
                    cell[(size_t)column->first + x] =
                        (uint32_t)(first + (int64_t)work.voxel[x] * work.plan.step[0]);
            }
        }
        fine = draw_marks(&work);
        draw_notes(&work);
    }
    free(work.sample);
    return fine ? OK : fault_memory(fault, "a slice");
}
