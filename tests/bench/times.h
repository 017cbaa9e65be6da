/* SPDX-License-Identifier: MIT */
/* Times and their statistics; errors, files and JSON of benchmarks. */
#ifndef TESTS_BENCH_TIMES_H
#define TESTS_BENCH_TIMES_H

#include <stddef.h>
#include <stdint.h>

#include "base/json.h"
#include "command/interpreter.h"

/* A benchmark ends at its first error: print bench_fault, after the subject if it is not NULL, and
 * exit with the status of `err`.
 *
 *     must(session_run(session, &bench_fault));
 */
extern struct fault bench_fault;
extern const char *bench_subject;
void must(enum err err);

/* Zeroed memory; the program ends without it. */
void *must_have(size_t bytes);

/* Milliseconds between two moments of clock_ns(), and from one until now. */
double times_between(uint64_t begin, uint64_t end);
double times_since(uint64_t begin);

/* Both sort `ms`, and return 0 without times. The quantile is the time at that share, 0..1; the
 * median is the mean of the middle two if their number is even. */
double times_quantile(double *ms, size_t count, double share);
double times_median(double *ms, size_t count);

/* Times of one kind of work. times_add adds the time since `begin`, if there is room, and returns
 * the present moment. */
enum { TIMES_MOST = 128 };
struct times {
    double ms[TIMES_MOST];
    size_t count;
};
uint64_t times_add(struct times *times, uint64_t begin);

/* Print the title of such a table; a row: median, 9 of 10 and most, multiplied by `scale`. */
void times_print_title(void);
void times_print(const char *what, struct times *times, double scale, const char *unit);

/* Write the members "median" and "most" of an object. */
void times_write(struct json *json, struct times *times);

/* The JSON of a benchmark; main calls the latter, which prints it. */
struct json *bench_json(void);
void bench_json_print(void);

/* Return the path of a new folder below `below`, or if that is NULL below the folder for temporary
 * files. It is removed when the program ends. */
const char *bench_folder(const char *below);

/* path = the file `name` in the program's folder or in one above; false if it was installed without
 * it. */
bool bench_find_in_tree(struct buf *path, const char *name);

/* path = examples/brain.iftty, or examples/geom.iftty without the scene of the former. ERR_IO if
 * the program was installed without it. */
enum err bench_find_example(struct buf *path, const struct interpreter *interp,
                            struct fault *fault);

#endif
