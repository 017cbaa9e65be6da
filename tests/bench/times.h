/* SPDX-License-Identifier: MIT */
/* Times and their statistics, and the files that benchmarks use. */
#ifndef TESTS_BENCH_TIMES_H
#define TESTS_BENCH_TIMES_H

#include <stddef.h>
#include <stdint.h>

#include "command/interpreter.h"

/* Milliseconds between two moments of clock_ns(), and from one until now. */
double times_between(uint64_t begin, uint64_t end);
double times_since(uint64_t begin);

/* Both sort `ms`, and return 0 without times. The quantile is the time at that share, 0..1; the
 * median is the mean of the middle two if their number is even. */
double times_quantile(double *ms, size_t count, double share);
double times_median(double *ms, size_t count);

/* path = the file `name` in the program's folder or in one above; false if it was installed without
 * it. */
bool bench_find_in_tree(struct buf *path, const char *name);

/* path = examples/brain.iftty, or examples/geom.iftty without the scene of the former. ERR_IO if
 * the program was installed without it. */
enum err bench_find_example(struct buf *path, const struct interpreter *interp,
                            struct fault *fault);

#endif
