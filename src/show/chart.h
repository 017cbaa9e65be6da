/* SPDX-License-Identifier: MIT */
/*
 * Charts of text: columns that stand side by side, of blocks or in ASCII.
 *
 *        142 |  ▁▇▂
 *            | ▃███▁
 *         12 |▄█████▅
 */
#ifndef REPORT_CHART_H
#define REPORT_CHART_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"

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
