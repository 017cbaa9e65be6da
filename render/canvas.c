/* SPDX-License-Identifier: MIT */
#include "render/canvas.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "base/least.h"
#include "engine/grid.h"

static const uint8_t black[3];

static void empty(struct canvas *canvas)
{
    const size_t pixels = (size_t)canvas->width * canvas->height;
    for (size_t i = 0; canvas->cell && i < pixels; i++)
        canvas->cell[i] = CELL_NONE;
    if (canvas->words) {
        memset(canvas->words, 0, pixels);
        memset(canvas->below, 0, pixels);
    }
    canvas_box(canvas, 0, 0, canvas->width, canvas->height, black);
}

enum err canvas_init(struct canvas *canvas, uint32_t width, uint32_t height, unsigned maps,
                     struct fault *fault)
{
    const size_t pixels = (size_t)width * height;
    const size_t cells = maps & CANVAS_CELLS ? pixels : 0, notes = maps & CANVAS_NOTES ? pixels : 0;
    *canvas = (struct canvas){.width = width, .height = height, .stride = width};
    const struct mem_part parts[] = {{&canvas->rgba, pixels, 4},
                                     {&canvas->cell, cells, sizeof *canvas->cell},
                                     {&canvas->words, notes, sizeof *canvas->words},
                                     {&canvas->below, notes, sizeof *canvas->below}};
    if (!mem_parts(parts, sizeof parts / sizeof *parts)) {
        canvas_release(canvas);
        return fault_memory(fault, "a picture");
    }
    canvas->cell = cells ? canvas->cell : NULL;
    canvas->words = notes ? canvas->words : NULL;
    canvas->below = notes ? canvas->below : NULL;
    empty(canvas);
    return OK;
}

enum err canvas_renew(struct canvas *canvas, uint32_t width, uint32_t height, struct fault *fault)
{
    if (canvas->words && canvas->cell && canvas->width == width && canvas->height == height) {
        empty(canvas);
        return OK;
    }
    canvas_release(canvas);
    return canvas_init(canvas, width, height, CANVAS_CELLS | CANVAS_NOTES, fault);
}

void canvas_release(struct canvas *canvas)
{
    free(canvas->rgba);
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
    const uint8_t *first = NULL;
    left = left > 0 ? left : 0;
    for (int64_t y = top > canvas->from ? top : canvas->from; y < bottom && left < right; y++) {
        uint8_t *row = canvas_pixel(canvas, (size_t)left, (size_t)y);
        if (first)
            memcpy(row, first, 4 * (size_t)(right - left));
        for (int64_t x = 0; !first && x < right - left; x++)
            memcpy(row + 4 * x, rgba, 4);
        first = row;
    }
}

void canvas_blend(uint8_t pixel[4], const uint8_t rgb[3], uint32_t share)
{
    if (share == 255 || pixel[3] == 0) {
        memcpy(pixel, rgb, 3);
        pixel[3] = (uint8_t)share;
        return;
    }
    const uint32_t over = 255 * share, below = pixel[3] * (255 - share), all = over + below;
    const bool is_grey =
        pixel[0] == pixel[1] && pixel[0] == pixel[2] && rgb[0] == rgb[1] && rgb[0] == rgb[2];
    for (int k = 0; k < 3; k++) {
        const uint32_t light = over * rgb[k] * rgb[k] + below * pixel[k] * pixel[k];
        pixel[k] = is_grey && k ? pixel[0] : (uint8_t)square_root((light + all / 2) / all);
    }
    pixel[3] = (uint8_t)((all + 127) / 255);
}

/* Most pixels of a layer are clear, so runs of them are copied at once. */
void canvas_lay_over(uint8_t *layer, const uint8_t *below, size_t pixels)
{
    enum { RUN = 64 };
    static const uint8_t clear[4 * RUN];
    for (size_t i = 0, end; i < pixels; i = end) {
        end = pixels - i < RUN ? pixels : i + RUN;
        if (memcmp(layer + 4 * i, clear, 4 * (end - i)) == 0) {
            memcpy(layer + 4 * i, below + 4 * i, 4 * (end - i));
            continue;
        }
        for (size_t k = 4 * i; k < 4 * end; k += 4) {
            uint8_t laid[4];
            if (layer[k + 3] == 255)
                continue;
            memcpy(laid, below + k, 4);
            if (layer[k + 3])
                canvas_blend(laid, layer + k, layer[k + 3]);
            memcpy(layer + k, laid, 4);
        }
    }
}

static uint64_t pixel_bits(const uint8_t *rgba)
{
    return (uint64_t)rgba[0] | (uint64_t)rgba[1] << 8 | (uint64_t)rgba[2] << 16 |
           (uint64_t)rgba[3] << 24;
}

/* Mix two pixels with their position at a time: drawing is faster than mixing pixel by pixel. */
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
