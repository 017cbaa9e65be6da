/* SPDX-License-Identifier: MIT */
#include "image/raster.h"

#include <string.h>

struct raster raster_part(const struct raster *raster, struct raster_box box)
{
    struct raster part = *raster;
    part.width = box.width;
    part.height = box.height;
    part.bytes += box.top * raster->stride + box.left * raster_pixel_bytes(raster);
    return part;
}

unsigned raster_used(const struct raster *raster, uint8_t place[RASTER_COLOURS_MOST],
                     uint32_t used[RASTER_COLOURS_MOST], bool *is_clear)
{
    bool occurs[RASTER_COLOURS_MOST] = {false};
    unsigned count = 0;
    for (uint32_t y = 0; y < raster->height; y++) {
        const uint8_t *row = raster->bytes + y * raster->stride;
        occurs[row[0]] = true;
        /* Most pixels are as their neighbours are: eight at a time are passed over where all are
         * `same`. */
        uint64_t same = 0, eight;
        uint32_t x = 0;
        for (; x + 8 <= raster->width; x += 8) {
            memcpy(&eight, row + x, 8);
            if (eight == same)
                continue;
            for (uint32_t k = 0; k < 8; k++)
                occurs[row[x + k]] = true;
            same = row[x + 7] * UINT64_C(0x0101010101010101);
        }
        for (; x < raster->width; x++)
            occurs[row[x]] = true;
    }
    memset(place, 0, RASTER_COLOURS_MOST);
    if (is_clear)
        *is_clear = raster->has_clear && occurs[RASTER_CLEAR];
    if (raster->has_clear && occurs[RASTER_CLEAR])
        used[count++] = 0;
    for (unsigned p = 0; p < raster->colours; p++)
        if (occurs[p]) {
            place[p] = (uint8_t)count;
            used[count++] = raster->colour[p];
        }
    return count;
}
