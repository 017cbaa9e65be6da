/*
 * Measurements of the whole way on the T1 scene ch2 of Debian's mricron-data, or on synth:geom
 * where that is not there: run from scratch, single edits with their picture, full pictures,
 * memory, and the time from the start of the program to its prompt. Medians; nothing is compared
 * with a limit.
 */
#ifndef COMMAND_BENCH_H
#define COMMAND_BENCH_H

#include <stdbool.h>
#include <stdio.h>

#include "base/err.h"

/* `scene` names another file, or is NULL. The table goes to `out`, or one JSON object. */
enum err bench_brain(const char *scene, bool json, FILE *out, struct fault *fault);

/* Milliseconds from starting this program on `scene` (or without one where NULL) in a terminal of
 * its own until the prompt is there, and until the scene is loaded and the prompt back. False where
 * there is no pseudo-terminal. */
bool bench_prompt(const char *scene, double *prompt_ms, double *loaded_ms);

#endif
