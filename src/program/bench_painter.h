/*
 * What a picture costs on its way to a terminal by the painter: bytes, and the time to make them.
 * Cells are of 8x16 pixels, blocks half a cell high, colours of 24 bits.
 */
#ifndef PROGRAM_BENCH_PAINTER_H
#define PROGRAM_BENCH_PAINTER_H

#include "program/bench_times.h"
#include "tui/picture/graphics.h"

/* Of a whole picture, square; in blocks as large as the cells allow. False without memory. */
bool bench_painter_whole(struct bench_cost *cost, const struct graphics *by,
                         const struct image_view *view);

/* Of patches of 40x40 pixels that change where an object is seen, and come back: each becomes what
 * is seen a few pixels beside it. */
bool bench_painter_patches(struct bench_cost *cost, const struct graphics *by,
                           const struct image_view *view);

#endif
