/*
 * What has changed between two pictures of one size, as a few boxes.
 *
 * Pictures are looked through tile by tile. Where pixels can be changed one by one, boxes fit
 * tightly; where cells are drawn over, they are whole tiles. Boxes are joined where one costs no
 * more than two: each has a fixed cost, as that of so many pixels. They may overlap.
 */
#ifndef TUI_PICTURE_STALE_H
#define TUI_PICTURE_STALE_H

#include <stdbool.h>

#include "image/raster.h"

enum { STALE_MOST = 32 };

struct stale {
    struct raster_box box[STALE_MOST];
    unsigned count;
    uint64_t cost; /* pixels in all boxes, and what the boxes cost themselves */
};

struct stale_rule {
    uint32_t tile_width, tile_height;
    bool whole_tiles;
    uint32_t box_cost; /* pixels */
};

/* Finds where the bytes of two rasters of one size and one kind of pixels differ. */
void stale_find(struct stale *stale, const struct raster *now, const struct raster *then,
                const struct stale_rule *rule);

#endif
