/* SPDX-License-Identifier: MIT */
/*
 * iTerm2's inline pictures: a PNG in base64, drawn over cells. WezTerm, mintty and others support
 * them.
 *
 *     ESC ] 1337 ; File=inline=1;size=1234;width=20;height=5;preserveAspectRatio=0;
 *         doNotMoveCursor=1 : <base64> BEL                                        (in one line)
 *
 * No pixel can be changed in place, but cells drawn over show the new picture. Sizes are in cells
 * if the picture is whole cells, since the size of a pixel depends on the screen; else in px.
 * Source: https://iterm2.com/documentation-images.html
 */
#include <stdio.h>

#include "base/mem.h"
#include "tui/picture/graphics.h"
#include "tui/picture/painter.h"

static void add_png(struct painter *p, const struct raster *raster, enum png_effort effort,
                    const char *size, struct buf *out)
{
    OWNED(buf_release) struct buf png = {0};
    png_add(&p->png, raster, effort, &png);
    out->failed |= png.failed;
    buf_printf(out, "\033]1337;File=inline=1;size=%zu;%spreserveAspectRatio=0;doNotMoveCursor=1:",
               png.length, size);
    buf_add_base64(out, buf_text(&png), png.length);
    buf_add_char(out, '\a');
}

static void once(struct painter *p, const struct raster *raster, struct buf *out)
{
    char size[64];
    snprintf(size, sizeof size, "width=%upx;height=%upx;", raster->width, raster->height);
    add_png(p, raster, PNG_FAST, size, out);
}

static void patch(struct painter *p, const struct raster *raster, const struct raster_box *box,
                  struct buf *out)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    const struct raster part = raster_part(raster, *box);
    char size[64];
    snprintf(size, sizeof size, "width=%u;height=%u;", box->width / width, box->height / height);
    painter_move_to(p, box->left / width, box->top / height, out);
    add_png(p, &part, p->effort, size, out);
}

const struct graphics graphics_iterm = {
    .name = "iterm",
    .title = "iTerm2",
    .kind = GRAPHICS_PIXELS,
    .fits = probe_is_iterm,
    .over_cells = true,
    .patch_cost = 300,
    .once = once,
    .patch = patch,
};
