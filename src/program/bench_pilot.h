/*
 * From a key to the picture: the pilot in a terminal of the benchmark's own, at the end of a line.
 *
 *     this program -- pty -- line -- a terminal that answers
 *
 * The program is started anew on a copy of a journal, in a pseudo-terminal of 80x42 cells of 8x16
 * pixels. What it writes travels as packets of 1400 bytes: each leaves when those before it have
 * left, at the line's rate, and arrives `one_way_ms` later; so do keys and answers on their way
 * back. The terminal at the far end takes no time to draw, and answers what kitty, or a terminal
 * with sixel graphics, answers.
 *
 * A key counts from when it is pressed there until the barrier after a frame has arrived there.
 */
#ifndef PROGRAM_BENCH_PILOT_H
#define PROGRAM_BENCH_PILOT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "tui/picture/graphics.h"

enum { PILOT_COLUMNS = 80, PILOT_ROWS = 42, PILOT_CELL_WIDTH = 8, PILOT_CELL_HEIGHT = 16 };

struct bench_line {
    double bits_per_second; /* 0: no limit */
    double one_way_ms;
};

/* Medians over the keys, in ms: until the first frame that shows what the key did, and until the
 * last byte of the finest one; and the bytes in all. */
struct bench_key {
    unsigned keys;
    double shown_ms, last_ms, bytes;
};

struct bench_keys {
    struct bench_key move, seed; /* the cross-hair by a voxel; a seed with its run */
};

/* `graphics` is kitty or sixel. ERR_IO where there is no pseudo-terminal, or
 * nothing is shown for ten seconds. */
enum err bench_pilot(const char *journal, const struct graphics *graphics,
                     const struct bench_line *line, unsigned keys, struct bench_keys *out,
                     struct fault *fault);

#endif
