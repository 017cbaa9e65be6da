/*
 * The kitty graphics protocol: pictures as PNG in base64, in chunks, and changed in place.
 *
 *     ESC _ G a=T,C=1,f=100,i=7,q=2,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=0 ; <the rest> ESC \
 *
 *     ESC _ G a=f,i=7,r=1,X=1,f=100,x=40,y=8,s=20,v=10,q=2,m=0 ; <base64> ESC \     a patch
 *     ESC _ G a=f,i=7,r=1,X=1,f=24,o=z,x=40,y=8,s=3,v=3,q=2,m=0 ; <base64> ESC \    a small one
 *     ESC _ G a=d,d=I,i=7,q=2 ESC \                                     takes it away
 *
 * a=T transmits and shows at the cursor, C=1 leaves the cursor where it is, q=2 (on every chunk)
 * asks for no answer, f=100 means PNG, f=24,o=z deflated 24-bit pixels, m=1 that more follows. a=f
 * changes a frame, r=1 the first, X=1 puts pixels in the place of pixels. Every chunk of a patch
 * carries a=f,i=,r=1: without them kitty 0.26.5 says OK and changes nothing. Source:
 * https://sw.kovidgoyal.net/kitty/graphics-protocol/
 */
#ifndef TUI_PICTURE_KITTY_H
#define TUI_PICTURE_KITTY_H

#include "base/buf.h"
#include "tui/picture/image_view.h"
#include "image/png.h"

/* Adds the transmission of `view` (not empty), which stays where it is shown, to `out`: in 24 bits
 * where it is smooth, or no hues are told. As all here, without memory out->failed is set. */
void kitty_encode(const struct image_view *view, struct buf *out);

/* A picture that can be changed: `image` is its number, not 0. */
void kitty_show(struct png_writer *png, const struct raster *raster, uint32_t image,
                struct buf *out);

/* `part` goes over the pixels from `left`, `top` of a picture that is shown. */
void kitty_patch(struct png_writer *png, const struct raster *part, enum png_effort effort,
                 uint32_t image, uint32_t left, uint32_t top, struct buf *out);

void kitty_delete(uint32_t image, struct buf *out);

#endif
