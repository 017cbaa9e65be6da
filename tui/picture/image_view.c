/* SPDX-License-Identifier: MIT */
#include "tui/picture/image_view.h"

#include "base/mem.h"

void image_view_fit(const struct image_view *view, uint32_t most_width, uint32_t most_height,
                    uint32_t *width, uint32_t *height)
{
    uint64_t w = view->width, h = view->height;
    if (w > most_width) {
        h = (h * most_width + w / 2) / w;
        w = most_width;
    }
    if (h > most_height) {
        w = ((uint64_t)view->width * most_height + view->height / 2) / view->height;
        h = most_height;
    }
    if (w > most_width)
        w = most_width;
    *width = w > 0 ? (uint32_t)w : 1;
    *height = h > 0 ? (uint32_t)h : 1;
}

static uint64_t overlap(uint64_t a0, uint64_t a1, uint64_t b0, uint64_t b1)
{
    uint64_t from = a0 > b0 ? a0 : b0;
    uint64_t to = a1 < b1 ? a1 : b1;
    return to > from ? to - from : 0;
}

/* Along an axis of `old` pixels that becomes `new`, one old pixel is `new` units long and one new
 * pixel `old` units, so that all borders fall on whole units and weights are exact. */
static void mean_of_area(const struct image_view *view, uint32_t width, uint32_t height, uint32_t x,
                         uint32_t y, uint8_t out[4])
{
    uint64_t x0 = (uint64_t)x * view->width, x1 = x0 + view->width;
    uint64_t y0 = (uint64_t)y * view->height, y1 = y0 + view->height;
    uint64_t red = 0, green = 0, blue = 0;
    uint64_t whole = (uint64_t)view->width * view->height;
    for (uint64_t t = y0 / height; t * height < y1; t++) {
        uint64_t tall = overlap(y0, y1, t * height, (t + 1) * height);
        for (uint64_t s = x0 / width; s * width < x1; s++) {
            uint64_t weight = tall * overlap(x0, x1, s * width, (s + 1) * width);
            uint32_t colour = image_view_colour(view, (size_t)(t * view->width + s));
            red += weight * (colour >> 16);
            green += weight * (colour >> 8 & 255);
            blue += weight * (colour & 255);
        }
    }
    out[0] = (uint8_t)((red + whole / 2) / whole);
    out[1] = (uint8_t)((green + whole / 2) / whole);
    out[2] = (uint8_t)((blue + whole / 2) / whole);
    out[3] = 255;
}

uint8_t *image_view_shrink(const struct image_view *view, uint32_t width, uint32_t height)
{
    size_t pixels;
    if (!size_multiply(width, height, &pixels))
        return NULL;
    uint8_t *rgba = mem_array(pixels, 4);
    if (!rgba)
        return NULL;
    uint8_t *out = rgba;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++, out += 4)
            mean_of_area(view, width, height, x, y, out);
    return rgba;
}
