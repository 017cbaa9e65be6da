/*
 * What the rows that speak kitty's protocol share: kitty.c, which tells it, and tiles.c.
 */
#ifndef TUI_PICTURE_KITTY_H
#define TUI_PICTURE_KITTY_H

#include "tui/picture/painter.h"

/* Numbers of pictures from here on, which others hardly use; and those of strips. */
enum { KITTY_FIRST = 26982, KITTY_STRIPS = 270000 };

/* Adds pixels as PNG by p->effort, in chunks; `keys` are those of the first, each with its
 * comma. */
void kitty_show(struct painter *p, const struct raster *raster, const char *keys, struct buf *out);

/* The same as PNG or as deflated pixels, whichever is less, by p->effort; `next` are the keys of
 * the chunks that follow. The keys of the size are added. */
void kitty_send(struct painter *p, const struct raster *part, const char *first, const char *next,
                struct buf *out);

/* Adds what frees a picture, wherever it is shown. */
void kitty_delete(uint32_t image, struct buf *out);

#endif
