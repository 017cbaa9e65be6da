/* SPDX-License-Identifier: MIT */
/*
 * Charts as SVG: grouped bars, or lines over steps, of a few series of numbers from 0 up.
 *
 * Plain SVG 1.1 without script or style sheet: what draws SVG at all draws it alike. Memory in,
 * text out; who writes the file is the caller. Colours are told apart in print and by those who
 * cannot tell red from green (Okabe and Ito's set), and lines have their own marks.
 */
#ifndef TESTS_BENCH_PLOT_H
#define TESTS_BENCH_PLOT_H

#include <stddef.h>

#include "base/buf.h"

enum { PLOT_SERIES_MOST = 6 };

struct plot_series {
    const char *name;
    const double *value; /* [plot.groups], each 0 or above */
    unsigned colour;     /* 0..PLOT_SERIES_MOST - 1: the same for the same thing in every chart */
};

struct plot {
    const char *title, *caption; /* one line each */
    const char *unit;            /* of the values */
    const char *const *group;    /* [groups]: under the bars, or under the points */
    size_t groups;
    const char *groups_are; /* "scenes"; NULL for nothing */
    const struct plot_series *series;
    size_t count; /* of series, at most PLOT_SERIES_MOST */
};

void plot_bars(struct buf *svg, const struct plot *plot);
void plot_lines(struct buf *svg, const struct plot *plot);

/* The least round number (1, 2 or 5 times a power of ten) of which at most `most` reach `value`. */
double plot_tick(double value, unsigned most);

#endif
