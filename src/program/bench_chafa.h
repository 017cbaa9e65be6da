/* chafa, another program that shows pictures in terminals, as a measure. */
#ifndef PROGRAM_BENCH_CHAFA_H
#define PROGRAM_BENCH_CHAFA_H

#include <stdbool.h>
#include <stdint.h>

/* The bytes that chafa shows the picture `path` with, `side` pixels wide and high in cells of 8x16,
 * and the median of the times from its start to its last byte. `format` is what it calls the
 * protocol: "symbols" for blocks. False where it is not installed or fails. */
bool bench_chafa(const char *format, uint32_t side, const char *path, double *bytes, double *ms);

#endif
