/*
 * iTerm2's inline pictures: a PNG in base64, drawn over cells. WezTerm, mintty and others have it.
 *
 *     ESC ] 1337 ; File=inline=1;size=1234;width=20;height=5;preserveAspectRatio=0;
 *         doNotMoveCursor=1 : <base64> BEL                                        (in one line)
 *
 * Nothing can be changed in place, but cells drawn over show the new picture. Sizes are told in
 * cells where the picture is whole cells, for what a pixel is depends on the screen; else in px.
 * Source: https://iterm2.com/documentation-images.html
 */
#ifndef TUI_PICTURE_ITERM_H
#define TUI_PICTURE_ITERM_H

#include "base/buf.h"
#include "tui/picture/image_view.h"
#include "image/png.h"

/* Adds a picture over columns x rows cells from the cursor on; with 0 columns as large as its
 * pixels. Without memory out->failed is set. */
void iterm_add(struct png_writer *png, const struct raster *raster, unsigned columns, unsigned rows,
               enum png_effort effort, struct buf *out);

/* Adds `view` (not empty) in its pixels: in 24 bits where it is smooth, or no hues are told. */
void iterm_encode(const struct image_view *view, struct buf *out);

#endif
