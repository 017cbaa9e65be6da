/* SPDX-License-Identifier: MIT */
/*
 * Histogram of intensities between the black and the white of a window.
 */
#ifndef SHOW_HISTOGRAM_H
#define SHOW_HISTOGRAM_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "session/session.h"

enum { HISTOGRAM_BINS = 64 };

struct histogram {
    int digits;          /* significant digits of real values */
    double least, most;  /* real values of the first intensity of the first bin and the last of the
                            last bin */
    unsigned bins, each; /* number of bins, and intensities of each; the last bin may have fewer */
    uint64_t bin[HISTOGRAM_BINS], below, above, voxels; /* below and above by real values */
};

/* Histogram of a scene, by its window. Large scenes are sampled, as for their window. */
void histogram_of_session(struct histogram *histogram, struct session *session);

/* Histogram of counts, between the percentiles that are the window of a scene. */
void histogram_of_counts(struct histogram *histogram, const uint32_t count[UINT16_MAX + 1],
                         const struct geometry *geometry);

/* Add a chart and its legend, in lines. */
void histogram_write(struct buf *out, const struct histogram *histogram, bool has_blocks);

/*
 * Charts of text: columns of blocks, or of ASCII characters.
 *
 *        142 |  ▁▇▂
 *            | ▃███▁
 *         12 |▄█████▅
 */

enum { CHART_COLUMNS = 64 }; /* fits a line of 80 with its margin */

struct chart {
    const uint16_t *eighths; /* height of each column, in eighths of a row: 0..8 * rows */
    unsigned columns, rows;
    const char *top, *bottom; /* text before the highest and the lowest row, */
    int margin;               /* right-aligned in this width */
    bool has_blocks;          /* UTF-8: eighths of a cell; otherwise thirds, by . : # */
};

/* Add `rows` lines, without trailing blanks. */
void chart_write(struct buf *out, const struct chart *chart);

#endif
