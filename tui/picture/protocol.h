/* SPDX-License-Identifier: MIT */
/*
 * A way to show pictures: a row of the table in tui/picture/graphics.c, and the only place that
 * knows it. How it is found is used in graphics.c, how it draws in painter.c.
 */
#ifndef TUI_PICTURE_PROTOCOL_H
#define TUI_PICTURE_PROTOCOL_H

#include "tui/picture/image_view.h"
#include "tui/probe.h"

struct painter;
struct raster;

enum graphics_kind { GRAPHICS_NOTHING, GRAPHICS_TEXT, GRAPHICS_PIXELS };

/* How a terminal keeps parts of slices (tui/picture/painter.h): it gets one, without showing it;
 * shows it at a place, which is one of several that bear numbers; takes it off; frees it, or all it
 * has. */
struct keeping {
    void (*send)(struct painter *, const struct raster *, uint32_t number, struct buf *);
    void (*place)(const struct painter *, uint32_t number, unsigned place,
                  const struct raster_box *, struct buf *);
    void (*hide)(uint32_t number, unsigned place, struct buf *);
    void (*free)(uint32_t number, struct buf *);
    void (*free_all)(struct buf *);
    uint32_t (*lost)(const char *reply); /* the number that a reply says it has not, or 0 */
};

struct graphics {
    const char *name;  /* a word of --graphics */
    const char *title; /* the same for people */
    enum graphics_kind kind;

    /* -- finding it: NULL is nothing, or always -- */
    bool (*fits)(const struct probe_replies *, const struct probe_environment *);
    struct probe_question question; /* in the second round */
    const char *recovery;           /* ends a transmission that was cut in two; NULL: ESC \ does */
    const char *made_by; /* the terminal that has all of the protocol; NULL: all that fit, */
    const struct graphics *instead; /* and what the others that fit are shown by */

    /* -- pixels -- */
    bool over_cells;     /* drawn over cells, so patches are whole cells; else pixels are changed */
    bool palette_always; /* else 24 bits are possible as well */
    uint32_t patch_cost; /* of a patch beyond its pixels, in pixels: escape, headers, palette */
    void (*once)(struct painter *, const struct raster *, struct buf *);  /* at the cursor */
    void (*whole)(struct painter *, const struct raster *, struct buf *); /* NULL: as a patch */
    void (*patch)(struct painter *, const struct raster *, const struct raster_box *, struct buf *);
    void (*remove)(struct painter *, struct buf *); /* NULL: cells are erased */
    const struct keeping *keeping;                  /* NULL: the terminal keeps nothing */

    /* -- text -- */
    void (*cell_pixels)(const struct terminal_facts *, uint32_t *width, uint32_t *height);
    bool (*show)(struct painter *, const struct image_view *, struct buf *);
    void (*lines)(const struct terminal_facts *, const struct image_view *, uint32_t columns,
                  uint32_t rows, struct buf *);
};

#endif
