/* SPDX-License-Identifier: MIT */
#include "render/background.h"

#include <string.h>

#include "engine/weight_gradient.h"

/* The gradient: slate, and shades of it down to near black, which palettes have (tui/picture). */
static const uint8_t gradient_top[3] = {62, 70, 82}, gradient_bottom[3] = {20, 22, 26};

void background_write(struct buf *out, uint32_t background)
{
    if (background == BACKGROUND_PLAIN)
        buf_add_text(out, "black");
    else if (background == BACKGROUND_GRADIENT || background == BACKGROUND_CLEAR)
        buf_add_text(out, background == BACKGROUND_CLEAR ? "transparent" : "gradient");
    else if (background == BACKGROUND_WHITE)
        buf_add_text(out, "white");
    else
        buf_printf(out, "#%06x", background & 0xffffff);
}

uint32_t background_opaque(uint32_t background)
{
    return background == BACKGROUND_CLEAR ? BACKGROUND_PLAIN : background;
}

void background_at(uint8_t rgb[3], uint32_t background, uint32_t row, uint32_t height)
{
    const uint32_t kind = background & ~UINT32_C(0xffffff), last = height > 1 ? height - 1 : 1;
    for (int k = 0; k < 3; k++) {
        if (kind == BACKGROUND_GRADIENT)
            rgb[k] =
                (uint8_t)((gradient_top[k] * (last - row) + gradient_bottom[k] * row + last / 2) /
                          last);
        else
            rgb[k] = (uint8_t)(kind == BACKGROUND_PLAIN ? background >> (16 - 8 * k) : 0);
    }
}

void background_over(uint8_t rgb[3], const uint8_t rgba[4], const uint8_t behind[3])
{
    const uint32_t covered = rgba[3], rest = 255 - covered;
    for (int k = 0; k < 3; k++) {
        const uint32_t light = covered * rgba[k] * rgba[k] + rest * behind[k] * behind[k];
        rgb[k] = covered == 0     ? behind[k]
                 : covered == 255 ? rgba[k]
                                  : (uint8_t)square_root((light + 127) / 255);
    }
}

void background_put_rows(uint8_t *rgba, uint32_t width, uint32_t top, uint32_t rows,
                         uint32_t height, uint32_t background)
{
    uint8_t behind[3];
    for (uint32_t y = top; y < top + rows && background != BACKGROUND_CLEAR; y++) {
        background_at(behind, background, y, height);
        for (uint32_t x = 0; x < width; x++, rgba += 4) {
            if (rgba[3] == 255)
                continue;
            background_over(rgba, rgba, behind);
            rgba[3] = 255;
        }
    }
}

void background_put(uint8_t *rgba, uint32_t width, uint32_t height, uint32_t background)
{
    background_put_rows(rgba, width, 0, height, height, background);
}
