#include "tui/picture/kitty.h"

#include <stdlib.h>

#include "tui/picture/shaded.h"

enum { CHUNK = 4096, FEW_PIXELS = 1024 };

/* `first` and `next` are keys of the first chunk and of those that follow, each with its comma. */
static void add_chunks(const struct buf *png, const char *first, const char *next, struct buf *out)
{
    const size_t piece = CHUNK / 4 * 3;
    out->failed |= png->failed;
    for (size_t at = 0; !out->failed && at < png->length; at += piece) {
        const size_t length = png->length - at < piece ? png->length - at : piece;
        buf_printf(out, "\033_G%sq=2,m=%d;", at == 0 ? first : next, at + length < png->length);
        buf_add_base64(out, png->data + at, length);
        buf_add_text(out, "\033\\");
    }
}

void kitty_show(struct png_writer *writer, const struct raster *raster, uint32_t image,
                struct buf *out)
{
    struct buf png = {0}, keys = {0};
    png_add(writer, raster, PNG_FAST, &png);
    buf_add_text(&keys, "a=T,C=1,f=100,");
    if (image > 0)
        buf_printf(&keys, "i=%u,", image);
    png.failed |= keys.failed;
    add_chunks(&png, buf_text(&keys), "", out);
    buf_release(&png);
    buf_release(&keys);
}

void kitty_patch(struct png_writer *writer, const struct raster *part, enum png_effort effort,
                 uint32_t image, uint32_t left, uint32_t top, struct buf *out)
{
    struct buf png = {0}, pixels = {0}, first = {0}, next = {0};
    png_add(writer, part, effort, &png);
    if ((uint64_t)part->width * part->height <= FEW_PIXELS)
        png_add_pixels(writer, part, effort, &pixels);
    const bool is_png = pixels.length == 0 || png.length <= pixels.length;
    buf_printf(&next, "a=f,i=%u,r=1,", image);
    buf_printf(&first, "%sX=1,%s,x=%u,y=%u,s=%u,v=%u,", buf_text(&next),
               is_png ? "f=100" : "f=24,o=z", left, top, part->width, part->height);
    out->failed |= png.failed || pixels.failed || first.failed || next.failed;
    add_chunks(is_png ? &png : &pixels, buf_text(&first), buf_text(&next), out);
    buf_release(&png);
    buf_release(&pixels);
    buf_release(&first);
    buf_release(&next);
}

void kitty_delete(uint32_t image, struct buf *out)
{
    buf_printf(out, "\033_Ga=d,d=I,i=%u,q=2\033\\", image);
}

void kitty_encode(const struct image_view *view, struct buf *out)
{
    struct png_writer png = {0};
    struct shaded shaded = {0};
    if (shaded_take(&shaded, view, SHADED_PNG))
        kitty_show(&png, &shaded.raster, 0, out);
    else
        out->failed = true;
    shaded_release(&shaded);
    png_release(&png);
}
