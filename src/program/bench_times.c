#include "program/bench_times.h"

#include <stdlib.h>

#include "base/clock.h"

double times_between(uint64_t begin, uint64_t end)
{
    return (double)(end - begin) / 1e6;
}

double times_since(uint64_t begin)
{
    return times_between(begin, clock_ns());
}

static int compare_ms(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static void sort(double *ms, size_t count)
{
    if (count > 0)
        qsort(ms, count, sizeof *ms, compare_ms);
}

double times_quantile(double *ms, size_t count, double share)
{
    sort(ms, count);
    return count ? ms[(size_t)(share * (double)(count - 1) + 0.5)] : 0;
}

double times_median(double *ms, size_t count)
{
    sort(ms, count);
    return count ? (ms[(count - 1) / 2] + ms[count / 2]) / 2 : 0;
}
