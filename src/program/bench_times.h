/* Times of a benchmark: taking them, and what they come to. */
#ifndef PROGRAM_BENCH_TIMES_H
#define PROGRAM_BENCH_TIMES_H

#include <stddef.h>
#include <stdint.h>

/* Milliseconds between two moments of clock_ns(), and from one until now. */
double times_between(uint64_t begin, uint64_t end);
double times_since(uint64_t begin);

/* Both sort `ms`, and give 0 for no times at all. The quantile is one of the times, that at the
 * share 0..1 of them; the median is the mean of the middle two where their number is even. */
double times_quantile(double *ms, size_t count, double share);
double times_median(double *ms, size_t count);

/* What a picture takes: medians. No bytes where nothing was measured. */
struct bench_cost {
    double bytes, ms;
};

#endif
