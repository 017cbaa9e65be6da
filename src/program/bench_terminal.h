/*
 * bench_terminal: what pictures cost on their way to a terminal, bytes and time, and how long it
 * takes from a key to the picture.
 *
 * The pictures are those at the end of examples/brain.iftty (of geom.iftty where the scene ch2 is
 * not here): its rendition of 512x512 pixels, a mosaic of 640x640, and patches of 40x40 that change
 * in the rendition, as an edit changes them: into what is seen a few pixels beside. The painter
 * sends them to a terminal with cells of 8x16 pixels, by every means that it knows.
 *
 * Beside it chafa, where that is installed: a program of its own, given the same pictures as PNG
 * and made to show them in the same size. Its time is from its start to its last byte, less what
 * the same takes for a picture of one pixel.
 *
 * Then the pilot, in a terminal of the benchmark's own (host/bench_pilot.h), at once and through a
 * line of 2 Mbit/s and 120 ms round trip.
 *
 * Medians; no time is compared with a limit.
 */
#ifndef PROGRAM_BENCH_TERMINAL_H
#define PROGRAM_BENCH_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

#include "base/err.h"

/* The table goes to `out`, or one JSON object. `quick`: few keys, and none through the slow line.
 */
enum err bench_terminal(bool json, bool quick, FILE *out, struct fault *fault);

#endif
