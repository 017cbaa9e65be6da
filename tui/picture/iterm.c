#include "tui/picture/iterm.h"

#include "tui/picture/shaded.h"

void iterm_add(struct png_writer *writer, const struct raster *raster, unsigned columns,
               unsigned rows, enum png_effort effort, struct buf *out)
{
    struct buf png = {0};
    png_add(writer, raster, effort, &png);
    out->failed |= png.failed;
    buf_printf(out, "\033]1337;File=inline=1;size=%zu;", png.length);
    if (columns > 0)
        buf_printf(out, "width=%u;height=%u;", columns, rows);
    else
        buf_printf(out, "width=%upx;height=%upx;", raster->width, raster->height);
    buf_add_text(out, "preserveAspectRatio=0;doNotMoveCursor=1:");
    buf_add_base64(out, buf_text(&png), png.length);
    buf_add_char(out, '\a');
    buf_release(&png);
}

void iterm_encode(const struct image_view *view, struct buf *out)
{
    struct png_writer png = {0};
    struct shaded shaded = {0};
    if (shaded_take(&shaded, view, SHADED_PNG))
        iterm_add(&png, &shaded.raster, 0, 0, PNG_FAST, out);
    else
        out->failed = true;
    shaded_release(&shaded);
    png_release(&png);
}
