/* The two parts of `iftty bench terminal`: the painter alone, and keys of the pilot. */
#ifndef PROGRAM_BENCH_TERMINAL_H
#define PROGRAM_BENCH_TERMINAL_H

#include "base/err.h"
#include "program/bench_far_end.h"
#include "tui/picture/graphics.h"

/* What a picture costs by the painter, in cells of 8x16 pixels, blocks half a cell high and colours
 * of 24 bits: medians. No bytes where nothing was measured. */
struct bench_cost {
    double bytes, ms;
};

/* Of a whole picture, square; in blocks as large as the cells allow. False without memory. */
bool bench_painter_whole(struct bench_cost *cost, const struct graphics *by,
                         const struct image_view *view);

/* Of patches of 40x40 pixels that change where an object is seen, and come back: each becomes what
 * is seen a few pixels beside it. */
bool bench_painter_patches(struct bench_cost *cost, const struct graphics *by,
                           const struct image_view *view);

/* Medians over the keys, in ms: until the barrier after the first frame that shows what the key did
 * has arrived, and until the last byte of the finest one; and the bytes in all. */
struct bench_key {
    unsigned keys;
    double shown_ms, last_ms, bytes;
};
enum bench_key_kind {
    BENCH_MOVE,
    BENCH_SEED,
    BENCH_KEYS
}; /* the cross-hair by a voxel; a seed
                                                               with its run */

/* Times so many keys, at most 100, of the pilot on a copy of the journal. ERR_IO where nothing is
 * shown for ten seconds. */
enum err bench_pilot(const char *journal, const struct graphics *graphics,
                     const struct bench_line *line, unsigned keys, struct bench_key out[BENCH_KEYS],
                     struct fault *fault);

#endif
