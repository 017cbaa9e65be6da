/*
 * Colour tables: the few colours of a picture, and which of them each pixel has.
 *
 * Our renditions are shades of a few label hues, so an exact table often exists. Where it does not,
 * the colours are cut into boxes: begin with one box that holds all, and again and again halve at
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

/* Fills the table with the distinct colours of the view, in order of appearance, and index[i] with
 * the place of pixel i's colour. False, with table and index in no useful state, where there are
 * more than `most` (1 .. COLOUR_TABLE_MOST). */
bool colour_table_exact(struct colour_table *table, const struct image_view *view, unsigned most,
                        uint8_t *index);

/* The same with at most `most` colours that stand for all. False without memory. */
bool colour_table_reduce(struct colour_table *table, const struct image_view *view, unsigned most,
                         uint8_t *index);

#endif
