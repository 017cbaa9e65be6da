/* SPDX-License-Identifier: MIT */
#include "render/palette.h"

#include <string.h>

#include "engine/weight_gradient.h"

/* The first 16 were optimised together (palette.h has the criteria), and sorted so that each
 * differs most from those before it. From 17 on each is the colour of a grid that differs most from
 * those before it, with more weight on near numbers. tests/test_palette.c has the rule: it
 * recomputes the table, and prints it if it differs. */
static const uint32_t colour[255] = {
    0xfc961e, 0x00a2fc, 0xae2490, 0x06f69c, 0xc67ec0, 0xc61812, 0x129c5a, 0x6c48d2, 0xfc9cea,
    0x968400, 0x0072ae, 0x78c072, 0x30ccfc, 0x7278fc, 0xd86c5a, 0xae5ad8, 0x1e694b, 0xe1f04b,
    0xa5f0ff, 0x785a0f, 0xa55a87, 0x872d69, 0xc3d200, 0xe196c3, 0x692db4, 0xc39600, 0x8796e1,
    0x1eb478, 0x6969c3, 0x87d2a5, 0x1e873c, 0xb4d2ff, 0xa5ff96, 0xd25aa5, 0x962d2d, 0xe14b4b,
    0x784b78, 0xf0b45a, 0xff780f, 0xb487ff, 0x78b4d2, 0x2d5aa5, 0x3c87c3, 0xa56900, 0x00e187,
    0xc3f0c3, 0xb49669, 0xa50000, 0xd24b78, 0x961e87, 0x875ae1, 0xc3c32d, 0xf0c3f0, 0x96a5ff,
    0xf087d2, 0x2d8796, 0x78782d, 0x00d296, 0x69ffa5, 0xc3873c, 0x005ac3, 0xc33c69, 0x782d96,
    0x9669f0, 0x874b3c, 0xe1e169, 0xa5b43c, 0xc3b4ff, 0x5a96b4, 0xe178e1, 0xf0b4a5, 0x87e1f0,
    0xd26900, 0x4b6996, 0x69964b, 0x783cb4, 0x6969f0, 0xb40f5a, 0xc3f087, 0x87c30f, 0x964b00,
    0x0fa5b4, 0xc396f0, 0xe1a587, 0x4be1ff, 0xe15a87, 0x2d5a87, 0x69874b, 0xa53cb4, 0x6978e1,
    0xffb4e1, 0xc3e196, 0x87b44b, 0xa53c2d, 0x3cb4c3, 0xc387f0, 0xd29687, 0xb4871e, 0xe15a69,
    0x783c78, 0xa56996, 0x2d4bc3, 0x5a78c3, 0xa5c3f0, 0x87f0b4, 0xa5c34b, 0x965a2d, 0xa5004b,
    0xb478f0, 0xffa596, 0xf078c3, 0x789669, 0xf0693c, 0xc33c96, 0x3c4ba5, 0x0078d2, 0x87b4ff,
    0xf0e1a5, 0xa5e1ff, 0x786900, 0x873c3c, 0xb4b45a, 0x78e169, 0xd278d2, 0x00a578, 0xf05a5a,
    0x8769a5, 0x872da5, 0x2d69d2, 0x2db4ff, 0x9678ff, 0xe1b4e1, 0xb45a2d, 0x96ffb4, 0xc3a55a,
    0x96d278, 0xe169b4, 0x3c9669, 0xf09696, 0x785a87, 0xa55ab4, 0x5a5ac3, 0x78a5e1, 0x8778f0,
    0x00c387, 0x4b691e, 0xe15a3c, 0x96ff78, 0xd2b43c, 0xa5e1b4, 0xa54b4b, 0xe178b4, 0xa50f78,
    0xc34ba5, 0x784b96, 0xa5b4f0, 0x4b87e1, 0x78b469, 0x006900, 0xb4782d, 0xd2e15a, 0xffa51e,
    0xd2c387, 0xa55a5a, 0xd287c3, 0x69e1b4, 0x0069b4, 0x9678b4, 0xa52d78, 0x5a87ff, 0x78a569,
    0xff6969, 0x96782d, 0x96f069, 0x4bc3f0, 0xe1b44b, 0x3c693c, 0xff96d2, 0x783c96, 0xa5c396,
    0xc35ac3, 0x1e5ad2, 0x5a78f0, 0x87a500, 0xd28778, 0x9696f0, 0x69f087, 0xa5695a, 0x4b870f,
    0x4bc3d2, 0xffa569, 0x785aa5, 0xb42d87, 0xe15ab4, 0x0096d2, 0x5a69e1, 0xb4a53c, 0xf08787,
    0x8796ff, 0x96e1a5, 0x964b4b, 0xd24b3c, 0xe1a5e1, 0xd2f069, 0x0ff0ff, 0xa54bb4, 0xa578a5,
    0xd269d2, 0xd2782d, 0xd2a53c, 0x5ac396, 0x8787f0, 0xb4d296, 0x783c87, 0x00782d, 0xc3a5e1,
    0xb4f04b, 0x78d2ff, 0x785ac3, 0x3c96a5, 0xb43c96, 0xe1785a, 0xb43c1e, 0x2dd269, 0xb469d2,
    0xe1a52d, 0x69a578, 0x2d6987, 0xa5a5e1, 0xb4e178, 0x4b784b, 0x3c69c3, 0xb4691e, 0xc378a5,
    0x7869e1, 0x784b1e, 0x87c387, 0x784ba5, 0xe1872d, 0x6996d2, 0x964b78, 0xf096f0, 0xa5d23c,
    0x96f0c3, 0x3c874b, 0xe14b0f, 0xc35a96, 0x7869d2, 0x874b00, 0xc3b478, 0x960f78, 0x2da54b,
    0xa587f0, 0x69a5d2, 0x87c3ff,
};

void palette_default(struct palette *palette)
{
    memset(palette, 0, sizeof *palette);
    for (int label = 1; label < 256; label++)
        for (int k = 0; k < 3; k++)
            palette->rgb[label][k] = (uint8_t)(colour[label - 1] >> (16 - 8 * k));
}

/* ---- the background ---- */

/* The gradient: from slate to nearly black, in shades that palettes contain (tui/picture). */
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
