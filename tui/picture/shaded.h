/*
 * A picture made ready for the wire: rounded to a palette, or in 24 bits, and grown to whole cells
 * where that is wanted. What it grows by is black.
 */
#ifndef TUI_PICTURE_SHADED_H
#define TUI_PICTURE_SHADED_H

#include <stdbool.h>

#include "tui/picture/colour_table.h"
#include "tui/picture/image_view.h"
#include "image/raster.h"
#include "tui/picture/shades.h"

/* PNG has 24 bits for pictures that are smooth or tell no hues; sixel has a palette always, and so
 * has a picture of few colours. */
enum shaded_for { SHADED_PNG, SHADED_SIXEL };

struct shaded {
    struct raster raster; /* of `bytes` and of the palette in `shades` */
    struct shades shades;
    struct colour_table sought; /* the palette of a picture whose hues are not told */
    uint8_t *bytes;
    size_t capacity;
};

/* `struct shaded s = {0}` is ready. */
void shaded_release(struct shaded *shaded);

/* Fills shaded->raster from a view that is not empty, with a palette for it. False without memory.
 */
bool shaded_take(struct shaded *shaded, const struct image_view *view, enum shaded_for what);

/* Whether such a view has a palette, however many colours it has. */
bool shaded_has_palette(const struct image_view *view, enum shaded_for what);

/* Puts the view into `bytes`, `width` x `height` pixels, which may be more than it has; its own
 * palette, if it has one, is there already. False where that has no room for another colour. */
bool shaded_fill(uint8_t *bytes, uint32_t width, uint32_t height, struct shades *shades,
                 const struct image_view *view, bool has_palette);

#endif
