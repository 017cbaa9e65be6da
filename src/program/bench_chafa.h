/* chafa, another program that shows pictures in terminals: what a picture costs there. */
#ifndef PROGRAM_BENCH_CHAFA_H
#define PROGRAM_BENCH_CHAFA_H

#include "base/err.h"
#include "program/bench_times.h"
#include "tui/picture/graphics.h"

/* The bytes of a square picture that chafa is given as PNG and shows in cells of 8x16 pixels, and
 * the time from its start to its last byte, less what the same takes for one pixel. Nothing where
 * it is not installed. ERR_IO, ERR_MEMORY. */
enum err bench_chafa(struct bench_cost *cost, const struct graphics *by,
                     const struct image_view *view, struct fault *fault);

#endif
