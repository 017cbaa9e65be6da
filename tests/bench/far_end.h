/* SPDX-License-Identifier: MIT */
/* iftty in a terminal of the benchmark's own, at the far end of a line.
 *
 *     iftty -- pty -- line -- a terminal that answers
 *
 * The pseudo-terminal has 80x42 cells of 8x16 pixels. What the program writes travels as packets of
 * 1400 bytes: each leaves when those before it have left, at the line's rate, and arrives
 * `one_way_ms` later; so do keys and answers on their way back. The terminal at the far end takes
 * no time to draw, and answers as kitty does, as Ghostty (kitty's graphics without frame edits), as
 * a terminal with sixel graphics, or as a plain one.
 *
 * What the program sends ahead, pictures that are not shown yet, counts as rest. */
#ifndef TESTS_BENCH_FAR_END_H
#define TESTS_BENCH_FAR_END_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "tui/picture/graphics.h"

enum { FAR_COLUMNS = 80, FAR_ROWS = 42, FAR_CELL_WIDTH = 8, FAR_CELL_HEIGHT = 16 };
enum { FAR_AWAITED_MOST = 4 };

struct far_line {
    double bits_per_second; /* 0: no limit */
    double one_way_ms;
    double still_ms; /* the terminal rests after that time without a byte, and the round trip */
};

struct far_end;

/* Starts `program`, with `argument`, ended by NULL, with `home` as its home and without a history
 * of lines; where it is NULL, build/iftty of the tree that this program lies in. `graphics` is
 * kitty, tiles, sixel or NULL. ERR_IO where iftty does not lie there, or there is no
 * pseudo-terminal. */
enum err far_end_new(struct far_end **out, const char *program, char *const *argument,
                     const char *home, const struct graphics *graphics, const struct far_line *line,
                     struct fault *fault);

/* Kill the program. */
void far_end_free(struct far_end *e);

/* Effects of pressed keys. The first ones count from the start of the program. */
struct far_result {
    uint64_t pressed_ns, last_ns;       /* the keys; the last byte */
    uint64_t came_ns[FAR_AWAITED_MOST]; /* of the awaited texts */
    uint64_t processor_ns;              /* of the program, until the terminal rests */
    size_t bytes;
    unsigned frames; /* while a key was held, */
    uint64_t gap_ns; /* and the longest time without one; from the first frame on */
};

/* Press keys, and wait until the texts of `awaited`, ended by NULL, have arrived in turn and the
 * terminal rests. ERR_IO after a minute without a byte, or after ten seconds in which the program
 * used no processor time either. */
enum err far_end_press(struct far_end *e, const char *keys, const char *const *awaited,
                       struct far_result *out, struct fault *fault);

/* Press keys, and wait only until the texts of `awaited` have arrived: the program may go on. */
enum err far_end_press_soon(struct far_end *e, const char *keys, const char *const *awaited,
                            struct far_result *out, struct fault *fault);

/* Hold a key: press it `times` times at that interval. Count the frames meanwhile, and wait as
 * above; pressed_ns is the last press. */
enum err far_end_hold(struct far_end *e, const char *key, unsigned times, double every_ms,
                      struct far_result *out, struct fault *fault);

/* Press nothing for `ms`: last_ns is the last byte, also of pictures sent ahead. */
enum err far_end_wait(struct far_end *e, double ms, struct far_result *out, struct fault *fault);

#endif
