/* The grey of a slice, and its labels. What lies over them is render/slice_notes.c. */
#include "render/slice.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/labels.h"
#include "render/slice_notes.h"
#include "render/slice_plan.h"

enum { PART = 256, HALF = PART * PART / 2 }; /* parts of the way from one voxel to the next */

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

/* What a pixel column takes from a row of voxels: those two in the list of columns to be read, the
 * second one's part, and which of the two its centre falls in. */
struct sample {
    uint32_t low, high, near;
    uint32_t part;
};

/* Everything that the rows of a slice share. Columns are counted from the first that shows
 * something. */
struct work {
    const struct scene *scene;
    struct labels labels;
    const struct slice_plan *plan;
    uint8_t shown[256]; /* a label, or 0 where it is hidden */
    struct sample *sample;
    ptrdiff_t *reads; /* voxels to be read, as cells from the row's first */
    size_t columns, count;
    uint8_t *label; /* [rows][columns] of the picture */

    uint16_t *intensity; /* [count] of a row of voxels */
    uint8_t *of_voxel;   /* [count], their labels */
    struct row {
        int64_t voxel;  /* which row of voxels this is, -1 for none */
        uint32_t *grey; /* [columns], intensities times PART */
        uint8_t *label; /* [columns] */
    } row[2];           /* even and odd ones: neighbours are there at the same time */
};

static void work_release(struct work *work)
{
    free(work->sample);
    free(work->reads);
    free(work->label);
    free(work->intensity);
    free(work->of_voxel);
    for (int i = 0; i < 2; i++) {
        free(work->row[i].grey);
        free(work->row[i].label);
    }
}

/* Between which voxels of a side a pixel lies; `part` is 0 where only the first one counts. */
static int64_t between(const struct slice_side *side, int64_t pixel, bool smooth, uint32_t *part)
{
    const int64_t last = side->voxels - 1;
    int64_t voxel = smooth ? slice_side_between(side, pixel, part) : slice_side_voxel(side, pixel);
    if (!smooth || voxel < 0 || voxel >= last)
        *part = 0;
    return voxel < 0 ? 0 : voxel > last ? last : voxel;
}

/* Voxels rise from column to column, so each is listed once. */
static void list_columns(struct work *work, bool smooth)
{
    const struct slice_side *side = &work->plan->side[0];
    const ptrdiff_t step = work->plan->step[0];
    int64_t last = -1; /* the voxel listed last */
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
        s->near = slice_side_voxel(side, pixel) == low ? s->low : s->high;
    }
}

static bool work_init(struct work *work, const struct scene *scene, const struct slice_plan *plan,
                      const struct slice_choice *choice, const struct slice_style *style)
{
    const size_t columns = (size_t)(plan->side[0].end - plan->side[0].first);
    const size_t rows = (size_t)(plan->side[1].end - plan->side[1].first);
    *work = (struct work){
        .scene = scene, .labels = {scene, style->finished}, .plan = plan, .columns = columns};
    for (unsigned label = 1; label < 256; label++)
        work->shown[label] = style->visible[label] ? (uint8_t)label : 0;
    work->sample = mem_array(columns, sizeof *work->sample);
    work->reads = mem_array(2 * columns, sizeof *work->reads);
    work->label = mem_array(columns * rows, 1);
    work->intensity = mem_array(2 * columns, sizeof *work->intensity);
    work->of_voxel = mem_array(2 * columns, 1);
    bool fine = work->sample && work->reads && work->label && work->intensity && work->of_voxel;
    for (int i = 0; i < 2; i++) {
        work->row[i].voxel = -1;
        work->row[i].grey = mem_array(columns, sizeof *work->row[i].grey);
        work->row[i].label = mem_array(columns, 1);
        fine = fine && work->row[i].grey && work->row[i].label;
    }
    if (fine)
        list_columns(work, choice->smooth);
    return fine;
}

/* ---- rows ---- */

/* A row of voxels, interpolated along the columns. Read once: cells of a sagittal slice lie further
 * apart than caches reach. */
static const struct row *row_of(struct work *work, int64_t voxel)
{
    struct row *row = &work->row[voxel & 1];
    if (row->voxel == voxel)
        return row;
    const struct cell *cell =
        work->scene->cell + ((ptrdiff_t)work->plan->corner + voxel * work->plan->step[1]);
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

static void paint_row(uint8_t *pixel, const uint32_t *low, const uint32_t *high, uint32_t part,
                      const uint8_t *grey, size_t columns)
{
    for (size_t x = 0; x < columns; x++, pixel += 4) {
        const uint32_t mixed = low[x] * (PART - part) + high[x] * part;
        const uint8_t shade = grey[(mixed + HALF) / (PART * PART)];
        memcpy(pixel, (const uint8_t[4]){shade, shade, shade, 255}, 4);
    }
}

static void paint_grey(const struct canvas *canvas, struct work *work, bool smooth,
                       const uint8_t *grey)
{
    const struct slice_side *side = &work->plan->side[1];
    const size_t left = (size_t)work->plan->side[0].first;
    for (int64_t y = side->first; y < side->end; y++) {
        uint32_t part = 0;
        const int64_t voxel = between(side, y, smooth, &part), near = slice_side_voxel(side, y);
        const struct row *low = row_of(work, voxel);
        const struct row *high = part ? row_of(work, voxel + 1) : low;
        paint_row(canvas_pixel(canvas, left, (size_t)y), low->grey, high->grey, part, grey,
                  work->columns);
        memcpy(work->label + (size_t)(y - side->first) * work->columns,
               near == voxel ? low->label : high->label, work->columns);
    }
}

/* ---- labels ---- */

static void tint_row(uint8_t *pixel, const uint8_t *label, size_t columns,
                     const struct palette *palette)
{
    for (size_t x = 0; x < columns; x++, pixel += 4)
        for (int k = 0; label[x] && k < 3; k++)
            pixel[k] = (uint8_t)((2 * pixel[k] + palette->rgb[label[x]][k] + 1) / 3);
}

/* The label of a pixel: 0 beside the scene, `own` beside the picture, whose edge is no contour. */
static uint8_t label_at(const struct work *work, int64_t x, int64_t y, uint8_t own)
{
    const struct slice_side *column = &work->plan->side[0], *row = &work->plan->side[1];
    if (x < 0 || y < 0 || x >= column->pixels || y >= row->pixels)
        return own;
    if (x < column->first || y < row->first || x >= column->end || y >= row->end)
        return 0;
    return work->label[(size_t)(y - row->first) * work->columns + (size_t)(x - column->first)];
}

static bool on_contour(const struct work *work, int64_t x, int64_t y, uint8_t own, int64_t reach)
{
    for (int64_t d = 1; d <= reach; d++)
        if (label_at(work, x - d, y, own) != own || label_at(work, x + d, y, own) != own ||
            label_at(work, x, y - d, own) != own || label_at(work, x, y + d, own) != own)
            return true;
    return false;
}

/* The same where all voxels read lie in the scene and all pixels in the picture, as nearly all
 * does. */
static bool on_contour_inside(const uint8_t *label, ptrdiff_t columns, int64_t reach)
{
    unsigned differs = 0;
    for (ptrdiff_t d = 1; d <= reach; d++)
        differs |= (unsigned)(label[-d] ^ *label) | (unsigned)(label[d] ^ *label) |
                   (unsigned)(label[-d * columns] ^ *label) |
                   (unsigned)(label[d * columns] ^ *label);
    return differs;
}

static void outline_row(uint8_t *pixel, const struct work *work, int64_t y, int64_t reach,
                        const struct palette *palette)
{
    const struct slice_side *column = &work->plan->side[0], *row = &work->plan->side[1];
    const bool is_inner = y - row->first >= reach && row->end - y > reach;
    const uint8_t *label = work->label + (size_t)(y - row->first) * work->columns;
    for (int64_t x = column->first; x < column->end; x++, pixel += 4, label++) {
        const bool inside = is_inner && x - column->first >= reach && column->end - x > reach;
        if (*label && (inside ? on_contour_inside(label, (ptrdiff_t)work->columns, reach)
                              : on_contour(work, x, y, *label, reach)))
            memcpy(pixel, palette->rgb[*label], 3);
    }
}

static void paint_labels(const struct canvas *canvas, const struct work *work,
                         const struct slice_style *style)
{
    const struct slice_side *column = &work->plan->side[0], *row = &work->plan->side[1];
    const int64_t reach = work->plan->unit;
    for (int64_t y = row->first; y < row->end; y++) {
        uint8_t *pixel = canvas_pixel(canvas, (size_t)column->first, (size_t)y);
        if (style->overlay == SLICE_TINT)
            tint_row(pixel, work->label + (size_t)(y - row->first) * work->columns, work->columns,
                     style->palette);
        else
            outline_row(pixel, work, y, reach, style->palette);
    }
}

/* ---- the whole ---- */

static void tell_cells(const struct canvas *canvas, const struct slice_plan *plan)
{
    const struct slice_side *column = &plan->side[0], *row = &plan->side[1];
    for (int64_t y = 0; y < row->pixels; y++) {
        uint32_t *cell = canvas->cell + (size_t)y * canvas->stride;
        for (int64_t x = 0; x < column->pixels; x++)
            cell[x] = CELL_NONE;
        if (y < row->first || y >= row->end)
            continue;
        const int64_t first = (int64_t)plan->corner + slice_side_voxel(row, y) * plan->step[1];
        for (int64_t x = column->first; x < column->end; x++)
            cell[x] = (uint32_t)(first + slice_side_voxel(column, x) * plan->step[0]);
    }
}

static void tell_below(const struct canvas *canvas)
{
    for (uint32_t y = 0; y < canvas->height; y++)
        for (uint32_t x = 0; x < canvas->width; x++)
            canvas->below[y * canvas->stride + x] = *canvas_pixel(canvas, x, y);
}

/* Black beyond the scene. */
static void clear_around(const struct canvas *canvas, const struct slice_plan *plan)
{
    static const uint8_t black[3];
    const struct slice_side *column = &plan->side[0], *row = &plan->side[1];
    canvas_box(canvas, 0, 0, column->pixels, row->first, black);
    canvas_box(canvas, 0, row->end, column->pixels, row->pixels - row->end, black);
    canvas_box(canvas, 0, row->first, column->first, row->end - row->first, black);
    canvas_box(canvas, column->end, row->first, column->pixels - column->end, row->end - row->first,
               black);
}

enum err slice_draw(const struct canvas *canvas, const struct scene *scene,
                    const struct slice_choice *choice, const struct slice_style *style,
                    struct fault *fault)
{
    struct slice_plan plan;
    struct work work;
    slice_plan_init(&plan, scene, choice, canvas->width, canvas->height);
    const bool fine = work_init(&work, scene, &plan, choice, style);
    if (fine) {
        clear_around(canvas, &plan);
        paint_grey(canvas, &work, choice->smooth, style->grey);
        if (canvas->below)
            tell_below(canvas);
        if (style->overlay != SLICE_PLAIN)
            paint_labels(canvas, &work, style);
        if (canvas->cell)
            tell_cells(canvas, &plan);
    }
    work_release(&work);
    if (!fine || !slice_notes_draw(canvas, scene, &plan, choice, style))
        return fault_memory(fault, "a slice");
    return OK;
}
