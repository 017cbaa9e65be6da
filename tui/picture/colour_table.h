/*
 * Few colours for a picture of many, of which nothing is known.
 *
 * The colours are cut into boxes: begin with one box that holds all, and again and again halve at
 * its mean the box and axis with the largest squared error (Wan, Prusinkiewicz and Wong, "Variance-
 * based color image quantization", 1990). Integers only: the same picture gives the same table.
 */
#ifndef TUI_PICTURE_COLOUR_TABLE_H
#define TUI_PICTURE_COLOUR_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "tui/picture/image_view.h"

enum { COLOUR_TABLE_MOST = 256 };

struct colour_table {
    uint32_t colour[COLOUR_TABLE_MOST]; /* 0xRRGGBB */
    unsigned count;
};

/* Fills the table with at most `most` (1 .. COLOUR_TABLE_MOST) colours that stand for all of the
 * view's. False without memory. */
bool colour_table_reduce(struct colour_table *table, const struct image_view *view, unsigned most);

/* Colours that are as good as one: six bits a channel, so that none moves by more than 3 of 255. */
static inline uint32_t colour_cell(uint32_t colour)
{
    return (colour >> 18 & 63) << 12 | (colour >> 10 & 63) << 6 | (colour >> 2 & 63);
}

#endif
