/* What the start of the program takes. */
#ifndef PROGRAM_BENCH_START_H
#define PROGRAM_BENCH_START_H

#include <stdbool.h>

/* Milliseconds from starting this program on `scene` in a terminal of its own until the prompt is
 * there, and until the scene is loaded and the prompt back. False where there is no
 * pseudo-terminal, or no prompt for five seconds. */
bool bench_start(const char *scene, double *prompt_ms, double *loaded_ms);

#endif
