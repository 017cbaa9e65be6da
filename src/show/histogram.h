/* SPDX-License-Identifier: MIT */
/*
 * A histogram: how often intensities occur, between the black and the white of a window.
 */
#ifndef REPORT_HISTOGRAM_H
#define REPORT_HISTOGRAM_H

#include "base/buf.h"
#include "show/window.h"

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

#endif
