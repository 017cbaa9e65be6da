/* SPDX-License-Identifier: MIT */
#include "render/palette.h"

#include <string.h>

#include "base/least.h"

/* The first 16 were optimised together (palette.h has the criteria), and sorted so that each
 * differs most from those before it. From 17 on each is the colour of a grid that differs most from
 * those before it, with more weight on near numbers. tests/test_palette.c has the rule: it
 * recomputes the table, and prints it if it differs. */
static const uint32_t colour[255] = {
    0xfc961e, 0x03a5ff, 0x9c1281, 0x09f69c, 0xc078ba, 0xbd2112, 0x279657, 0x7848f9, 0xfc9cea,
    0x907e00, 0x0072ab, 0x78c072, 0x30ccfc, 0x727eff, 0xd86354, 0xa854d2, 0xe1f04b, 0x1e6900,
    0xa5f0ff, 0x693ca5, 0x965a87, 0x004bc3, 0xe178f0, 0xffb41e, 0xa5c396, 0x00b487, 0xb49600,
    0xc3a5d2, 0x4b78e1, 0x5ae169, 0x4b783c, 0x961e4b, 0xc3f0c3, 0xc35a96, 0x3c5a87, 0xff5a69,
    0xa5d2ff, 0x875ab4, 0xd22d3c, 0xd2a54b, 0x9696d2, 0x3c5ad2, 0x87ff87, 0xa5d23c, 0x872d69,
    0x00c3d2, 0x0096a5, 0x007800, 0xe15aa5, 0xe1a5ff, 0x9669f0, 0xa55a4b, 0xa5965a, 0xffa596,
    0x5a4bb4, 0xe1e1a5, 0xa5f05a, 0xa52d78, 0x87e1f0, 0x3c96d2, 0x5ac33c, 0xe15a00, 0xa5a5ff,
    0x9669a5, 0x784b2d, 0x789669, 0xe196c3, 0x0f69e1, 0xf0b487, 0xd2e178, 0xc32d69, 0xa5e1ff,
    0x2dffc3, 0xa5b400, 0xe1693c, 0x7896f0, 0x694b96, 0x3c693c, 0xd25ac3, 0xa53c00, 0x3c8796,
    0xe1a578, 0xffe187, 0x00c3f0, 0xa5d2a5, 0x78ffb4, 0xc396c3, 0x96873c, 0x7887f0, 0x782d96,
    0x78b43c, 0xd24b78, 0xa50f00, 0xb44bc3, 0xd2c300, 0xffc3f0, 0xff87f0, 0x3c785a, 0x69e1b4,
    0x00b4c3, 0xd29687, 0x0f87f0, 0x695a96, 0x789600, 0xe15a87, 0xb44b2d, 0xa578c3, 0xc3c35a,
    0xe1c3ff, 0xd2f0a5, 0x692db4, 0x00e196, 0x87b4e1, 0xf08769, 0x0f96ff, 0x785a87, 0x78a500,
    0x6969f0, 0xb45a1e, 0xc369d2, 0x00874b, 0xa51e2d, 0xc3f078, 0x1e5ac3, 0x4bd2a5, 0xf0b4e1,
    0xf07878, 0x96a5e1, 0x875a96, 0xc3b45a, 0x69a53c, 0x00e1ff, 0xc378ff, 0xa5694b, 0x00a5b4,
    0xa5ff96, 0xb41e2d, 0x8769e1, 0x5ad287, 0xff691e, 0xf0a5d2, 0x5a6996, 0xd2d22d, 0x87a569,
    0x783c78, 0xd278e1, 0xa5785a, 0x5a96b4, 0xb4e1b4, 0xc33c0f, 0x7869d2, 0x1ed269, 0xe1873c,
    0xa5b4f0, 0xb43ca5, 0x87f078, 0x78b487, 0xa52d5a, 0xd269e1, 0xe15a69, 0xa578a5, 0xff87d2,
    0x87693c, 0x5a69c3, 0xb4c34b, 0xd2965a, 0x4b962d, 0xa53ca5, 0x78f0c3, 0x4bc396, 0x963c3c,
    0x784b78, 0x8778f0, 0xa56996, 0xa5c3f0, 0xe169d2, 0x695ac3, 0xb4d278, 0xf0695a, 0x00a54b,
    0x78783c, 0x963ca5, 0x00a5e1, 0xf09696, 0x873c3c, 0x2d87b4, 0x4bf0b4, 0xb4b4ff, 0xa569d2,
    0x3c87ff, 0x87c35a, 0xe1784b, 0xd24b2d, 0x00a578, 0x5a5ab4, 0x873c96, 0xc3c387, 0x964b4b,
    0xe178c3, 0xa5f0b4, 0x2d7887, 0xa596f0, 0xa569b4, 0x7878e1, 0xc3874b, 0xc35a4b, 0x69a578,
    0x78e15a, 0x3c4ba5, 0xa5c369, 0x965a2d, 0xe187c3, 0xc3e196, 0xa50f78, 0x1eb4ff, 0xb45ac3,
    0x5a87e1, 0x785ad2, 0xc3782d, 0x69b41e, 0xe17878, 0x0069a5, 0xf0a569, 0xb45a5a, 0x875a3c,
    0x96e1a5, 0x962d87, 0xd296ff, 0xb4f069, 0x7887c3, 0x6969e1, 0x96782d, 0x96960f, 0xff785a,
    0x695aa5, 0xe1b44b, 0x4bb45a, 0xa54b4b, 0x78d278, 0x69b4d2, 0xb487e1, 0x96f0a5, 0x9678b4,
    0x695ae1, 0x4b872d, 0xd25a2d, 0xf08787, 0x874bb4, 0xa55a87, 0xb4a54b, 0x2d694b, 0x96c33c,
    0x4ba569, 0xd269d2, 0xb4e187,
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
