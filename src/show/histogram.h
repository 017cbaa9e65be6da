/* SPDX-License-Identifier: MIT */
/*
 * A histogram: how often intensities occur, between the black and the white of a window.
 */
#ifndef REPORT_HISTOGRAM_H
#define REPORT_HISTOGRAM_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "session/session.h"

enum { HISTOGRAM_BINS = 64 };

struct histogram {
    int digits;          /* of real values that are worth to be written */
    double least, most;  /* real values: of the first intensity of the first bin, and of the last of
                            the last one */
    unsigned bins, each; /* each of so many intensities; the last one may have fewer */
    uint64_t bin[HISTOGRAM_BINS], below, above, voxels; /* below and above: by real values */
};

/* Of a scene, by its window. Large scenes are sampled, as their window is. */
void histogram_of_session(struct histogram *histogram, struct session *session);

/* Of how often each intensity occurs, between the percentiles that are the window of a scene. */
void histogram_of_counts(struct histogram *histogram, const uint32_t count[UINT16_MAX + 1],
                         const struct geometry *geometry);

/* Adds a chart, and what it shows, in lines. */
void histogram_write(struct buf *out, const struct histogram *histogram, bool has_blocks);

/*
 * Charts of text: columns that stand side by side, of blocks or in ASCII.
 *
 *        142 |  ▁▇▂
 *            | ▃███▁
 *         12 |▄█████▅
 */

enum { CHART_COLUMNS = 64 }; /* as many as fit a line of 80 with what stands before them */

struct chart {
    const uint16_t *eighths; /* how tall each column is, in eighths of a row: 0..8 * rows */
    unsigned columns, rows;
    const char *top, *bottom; /* what stands before the highest and the lowest row, */
    int margin;               /* in so many columns */
    bool has_blocks;          /* text is UTF-8: a cell has eighths; else thirds, of . : # */
};

/* Adds `rows` lines, without blanks at their ends. */
void chart_write(struct buf *out, const struct chart *chart);

#endif
