/*
 * The kitty graphics protocol: a picture as a PNG in base64, in chunks.
 *
 *     ESC _ G a=T,C=1,q=2,f=100,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=0 ; <the rest> ESC \
 *
 * a=T transmits and shows at the cursor, C=1 leaves the cursor where it is, q=2 (on every chunk)
 * asks for no answer, f=100 means PNG, m=1 that more follows. Up to 256 colours make a PNG with a
 * palette, a third of the bytes of a 24-bit one; both are deflated at level 1, which costs little
 * time and wins most of the bytes.
 * Source: https://sw.kovidgoyal.net/kitty/graphics-protocol/
 */
#ifndef TUI_KITTY_H
#define TUI_KITTY_H

#include "base/buf.h"
#include "tui/image_view.h"

/* Adds the transmission of `view` (not empty) to `out`; without memory out->failed is set. */
void kitty_encode(const struct image_view *view, struct buf *out);

#endif
