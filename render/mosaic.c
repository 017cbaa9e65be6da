#include "render/mosaic.h"

static const uint8_t seam_grey[3] = {56, 56, 56};

static uint32_t seam_of(uint32_t width, uint32_t height)
{
    return width < 128 || height < 128 ? 1 : 2;
}

struct mosaic_box mosaic_box(uint32_t width, uint32_t height, enum mosaic_pane pane)
{
    const uint32_t seam = seam_of(width, height);
    const uint32_t left = (width - seam) / 2, top = (height - seam) / 2;
    const bool is_right = pane == MOSAIC_SAGITTAL || pane == MOSAIC_RENDITION;
    const bool is_low = pane == MOSAIC_AXIAL || pane == MOSAIC_RENDITION;
    return (struct mosaic_box){is_right ? left + seam : 0, is_low ? top + seam : 0,
                               is_right ? width - seam - left : left,
                               is_low ? height - seam - top : top};
}

/* ---- slices ---- */

static enum mosaic_pane pane_of(enum slice_plane plane)
{
    return plane == SLICE_AXIAL     ? MOSAIC_AXIAL
           : plane == SLICE_CORONAL ? MOSAIC_CORONAL
                                    : MOSAIC_SAGITTAL;
}

/* At the largest scale at which all three fit. */
static struct slice_choice slice_of(const struct scene *scene, const struct mosaic_choice *choice,
                                    uint32_t width, uint32_t height, enum slice_plane plane)
{
    struct slice_choice slice = {.plane = plane, .smooth = true, .title = choice->title[plane]};
    for (int a = 0; a < 3; a++)
        slice.place[a] = choice->place[a];
    for (enum slice_plane p = SLICE_AXIAL; p <= SLICE_SAGITTAL; p++) {
        const struct mosaic_box box = mosaic_box(width, height, pane_of(p));
        const uint64_t pixel_pm = slice_fitting_pixel(scene, p, box.width, box.height);
        slice.pixel_pm = pixel_pm > slice.pixel_pm ? pixel_pm : slice.pixel_pm;
    }
    if (choice->notes) /* the bars once: they hold for all three */
        slice.notes =
            plane == SLICE_AXIAL ? SLICE_LETTERS | SLICE_SCALE | SLICE_COLOURS : SLICE_LETTERS;
    return slice;
}

/* ---- the rendition ---- */

/* The first of the four pixels of the rendition that a pixel of its pane stands for. */
static size_t first_of_four(const struct rendition *r, const struct mosaic_box *box, uint32_t x,
                            uint32_t y)
{
    const uint32_t left = (r->width - 2 * box->width) / 2, top = (r->height - 2 * box->height) / 2;
    return (size_t)(top + 2 * y) * r->width + left + 2 * x;
}

static uint32_t rendition_cell(const struct rendition *r, size_t first)
{
    const size_t four[4] = {first, first + 1, first + r->width, first + r->width + 1};
    for (int i = 0; i < 4; i++)
        if (r->cell[four[i]] != CELL_NONE)
            return r->cell[four[i]];
    return CELL_NONE;
}

/* The mean of what four pixels look like over black. Nearly all are covered whole or not at all. */
static void average(uint8_t rgb[3], const struct rendition *r, size_t first)
{
    const uint8_t *above = r->rgba + 4 * first, *below = above + (size_t)4 * r->width;
    const uint32_t a = above[3], b = above[7], c = below[3], d = below[7];
    const bool is_whole = (a & b & c & d) == 255;
    if ((a | b | c | d) == 0) {
        rgb[0] = rgb[1] = rgb[2] = 0;
        return;
    }
    for (int k = 0; k < 3; k++) {
        const uint32_t plain = (uint32_t)above[k] + above[k + 4] + below[k] + below[k + 4];
        rgb[k] = (uint8_t)(is_whole ? (plain + 2) / 4
                                    : (above[k] * a + above[k + 4] * b + below[k] * c +
                                       below[k + 4] * d + 2 * 255) /
                                          (4 * 255));
    }
}

static void draw_rendition(const struct canvas *pane, const struct mosaic_box *box,
                           const struct rendition *r)
{
    for (uint32_t y = 0; y < pane->height; y++)
        for (uint32_t x = 0; x < pane->width; x++) {
            const size_t first = first_of_four(r, box, x, y);
            average(canvas_pixel(pane, x, y), r, first);
            if (pane->cell)
                pane->cell[y * pane->stride + x] = rendition_cell(r, first);
        }
}

/* ---- the whole ---- */

static void draw_seams(const struct canvas *canvas)
{
    const struct mosaic_box first = mosaic_box(canvas->width, canvas->height, MOSAIC_CORONAL);
    const uint32_t seam = seam_of(canvas->width, canvas->height);
    canvas_box(canvas, first.width, 0, seam, canvas->height, seam_grey);
    canvas_box(canvas, 0, first.height, canvas->width, seam, seam_grey);
}

enum err mosaic_draw(const struct canvas *canvas, const struct scene *scene,
                     const struct rendition *rendition, const struct mosaic_choice *choice,
                     const struct slice_style *style, struct fault *fault)
{
    const uint32_t width = canvas->width, height = canvas->height;
    enum err err = OK;
    draw_seams(canvas);
    for (enum slice_plane p = SLICE_AXIAL; !err && p <= SLICE_SAGITTAL; p++) {
        const struct mosaic_box box = mosaic_box(width, height, pane_of(p));
        const struct canvas pane = canvas_part(canvas, box.left, box.top, box.width, box.height);
        const struct slice_choice slice = slice_of(scene, choice, width, height, p);
        err = slice_draw(&pane, scene, &slice, style, fault);
    }
    const struct mosaic_box box = mosaic_box(width, height, MOSAIC_RENDITION);
    const struct canvas pane = canvas_part(canvas, box.left, box.top, box.width, box.height);
    draw_rendition(&pane, &box, rendition);
    return err;
}

uint32_t mosaic_cell_at(const struct scene *scene, const struct rendition *rendition,
                        const struct mosaic_choice *choice, uint32_t column, uint32_t row)
{
    const uint32_t width = rendition->width, height = rendition->height;
    for (int i = 0; i < MOSAIC_PANES; i++) {
        const enum mosaic_pane pane = (enum mosaic_pane)i;
        const struct mosaic_box box = mosaic_box(width, height, pane);
        const uint32_t x = column - box.left, y = row - box.top; /* huge where left or above */
        if (x >= box.width || y >= box.height)
            continue;
        if (pane == MOSAIC_RENDITION)
            return rendition_cell(rendition, first_of_four(rendition, &box, x, y));
        const enum slice_plane plane = pane == MOSAIC_AXIAL     ? SLICE_AXIAL
                                       : pane == MOSAIC_CORONAL ? SLICE_CORONAL
                                                                : SLICE_SAGITTAL;
        const struct slice_choice slice = slice_of(scene, choice, width, height, plane);
        return slice_cell_at(scene, &slice, box.width, box.height, x, y);
    }
    return CELL_NONE;
}
