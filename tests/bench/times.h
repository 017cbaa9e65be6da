/* SPDX-License-Identifier: MIT */
/* Times and what they come to, and the files that benchmarks measure on. */
#ifndef TESTS_BENCH_TIMES_H
#define TESTS_BENCH_TIMES_H

#include <stddef.h>
#include <stdint.h>

#include "command/interpreter.h"

/* Milliseconds between two moments of clock_ns(), and from one until now. */
double times_between(uint64_t begin, uint64_t end);
double times_since(uint64_t begin);

/* Both sort `ms`, and give 0 for no times at all. The quantile is one of the times, that at the
 * share 0..1 of them; the median is the mean of the middle two where their number is even. */
double times_quantile(double *ms, size_t count, double share);
double times_median(double *ms, size_t count);

/* path = the file `name` of the folder that this program lies in, or of one above; false where it
 * was installed without it. */
bool bench_find_in_tree(struct buf *path, const char *name);

/* path = examples/brain.iftty, or examples/geom.iftty where the scene of that is not here. ERR_IO
 * where the program was installed without it. */
enum err bench_find_example(struct buf *path, const struct interpreter *interp,
                            struct fault *fault);

#endif
