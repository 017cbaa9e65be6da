#include "render/canvas.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "engine/grid.h"

static const uint8_t black[3];

enum err canvas_init(struct canvas *canvas, uint32_t width, uint32_t height, bool with_cells,
                     struct fault *fault)
{
    const size_t pixels = (size_t)width * height;
    *canvas = (struct canvas){.width = width, .height = height, .stride = width};
    canvas->rgba = mem_array(pixels, 4);
    if (with_cells)
        canvas->cell = mem_array(pixels, sizeof *canvas->cell);
    if (!canvas->rgba || (with_cells && !canvas->cell)) {
        canvas_release(canvas);
        return fault_memory(fault, "a picture");
    }
    for (size_t i = 0; with_cells && i < pixels; i++)
        canvas->cell[i] = CELL_NONE;
    canvas_box(canvas, 0, 0, width, height, black);
    return OK;
}

enum err canvas_remember(struct canvas *canvas, struct fault *fault)
{
    canvas->words = mem_new(canvas->stride * canvas->height);
    canvas->below = mem_new(canvas->stride * canvas->height);
    return canvas->words && canvas->below ? OK : fault_memory(fault, "a picture");
}

void canvas_release(struct canvas *canvas)
{
    free(canvas->rgba);
    free(canvas->cell);
    free(canvas->words);
    free(canvas->below);
    *canvas = (struct canvas){0};
}

struct canvas canvas_part(const struct canvas *canvas, uint32_t left, uint32_t top, uint32_t width,
                          uint32_t height)
{
    const size_t first = (size_t)top * canvas->stride + left;
    return (struct canvas){.width = width,
                           .height = height,
                           .stride = canvas->stride,
                           .rgba = canvas->rgba + 4 * first,
                           .cell = canvas->cell ? canvas->cell + first : NULL,
                           .words = canvas->words ? canvas->words + first : NULL,
                           .below = canvas->below ? canvas->below + first : NULL};
}

void canvas_box(const struct canvas *canvas, int64_t left, int64_t top, int64_t width,
                int64_t height, const uint8_t rgb[3])
{
    const int64_t right = left + width < canvas->width ? left + width : canvas->width;
    const int64_t end = canvas_end(canvas), bottom = top + height < end ? top + height : end;
    const uint8_t rgba[4] = {rgb[0], rgb[1], rgb[2], 255};
    left = left > 0 ? left : 0;
    for (int64_t y = top > canvas->from ? top : canvas->from; y < bottom; y++) {
        uint8_t *row = canvas_pixel(canvas, 0, (size_t)y);
        for (int64_t x = left; x < right; x++)
            memcpy(row + 4 * x, rgba, 4);
    }
}

static uint64_t pixel_bits(const uint8_t *rgba)
{
    return (uint64_t)rgba[0] | (uint64_t)rgba[1] << 8 | (uint64_t)rgba[2] << 16 |
           (uint64_t)rgba[3] << 24;
}

/* Two pixels to a mix, and the place in it: pictures are made faster than they could be mixed pixel
 * by pixel. */
uint64_t canvas_digest(const struct canvas *canvas)
{
    const size_t pixels = (size_t)canvas->width * canvas->height;
    const uint8_t *at = canvas->rgba;
    uint64_t sum = hash_mix_at(canvas->width, canvas->height);
    for (size_t i = 0; i < pixels; i += 2, at += 8) {
        const uint64_t second = i + 1 < pixels ? pixel_bits(at + 4) : 0;
        sum += hash_mix((pixel_bits(at) | second << 32) ^ (i + 1) * UINT64_C(0x9e3779b97f4a7c15));
    }
    return sum;
}
