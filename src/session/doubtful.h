/* SPDX-License-Identifier: MIT */
/*
 * The slice to outline next: that with the most doubt (engine/doubt.h), of all three planes.
 *
 * Slices that have an outline of the label are excluded, and so are their neighbours, which would
 * add little. Slices of one plane that follow each other in rank are at least DOUBTFUL_APART slices
 * apart, since neighbours have nearly the same doubt.
 *
 * In simulations, outlining the first slice of this list is as efficient as outlining the slice
 * with the largest error, which is unknown in practice.
 */
#ifndef SESSION_DOUBTFUL_H
#define SESSION_DOUBTFUL_H

#include "base/err.h"
#include "base/polyline.h"
#include "engine/doubt.h"
#include "engine/labels.h"
#include "session/markers.h"
#include "session/session.h"

enum { DOUBTFUL_MOST = 5, DOUBTFUL_APART = 5 };

struct doubtful_slice {
    unsigned axis; /* axis at right angles to the slice; */
    uint32_t at;   /* index along that axis */
    uint64_t doubt;
};

/* Find the slices with the most doubt, the highest first, for a label or FINISH_ALL_LABELS, as
 * of the last run; *count of them. The time is about that of `finish relax`; no time while labels,
 * seeds and steps are unchanged. The errors of doubt_find. */
enum err doubtful_find(struct doubtful_slice slice[DOUBTFUL_MOST], size_t *count,
                       struct session *session, unsigned label, struct fault *fault);

/* Find a voxel in the middle of the slice's part of a label, or of all labels but 0 for
 * FINISH_ALL_LABELS. If it has none there, take the nearest slice with the label and project its
 * voxel. False if the label has no voxel. */
bool doubtful_place(uint32_t place[3], const struct labels *labels, unsigned label,
                    const struct doubtful_slice *slice);

/*
 * Contours: the outline of a label or marker in a slice, as a polygon to be corrected.
 *
 * Voxels connected by faces are a piece. The contour is a polygon around one piece, the largest
 * unless another is chosen. It goes from the centre of one outer voxel to that of the next, by
 * faces and corners, and is then simplified (polyline_simplify). Filling the polygon
 * (session/paint.h) fills the piece and its holes, to half a voxel. The contour of a rectangle has
 * four corners.
 */

/* The first of equal pieces counts, row by row. A contour with more corners is thinned out. */
enum { CONTOUR_CORNERS_MOST = 1000 };

/* Find the corners of a label's contour in the slice through a place, across an axis, into an
 * empty line: of the piece with the place, otherwise of the largest. The last corner leads back to
 * the first. A piece as narrow as a row of voxels has fewer than three corners; the line stays
 * empty if the label is not in the slice, and on ERR_MEMORY. */
enum err contour_of_label(struct polyline *contour, const struct labels *labels, unsigned label,
                          unsigned axis, const uint32_t place[3], struct fault *fault);

/* The same for the voxels of a marker without joined markers: for an outline, its inside. No
 * corners if they are not in one slice. */
enum err contour_of_marker(struct polyline *contour, const struct grid *grid,
                           const struct markers *markers, uint32_t number, struct fault *fault);

/* True if a marker is an area in one slice, with more voxels than a line through it: an outline
 * is, a stroke is not. Then *axis and *at are those of the slice. */
bool contour_is_area(unsigned *axis, uint32_t *at, const struct grid *grid,
                     const struct markers *markers, uint32_t number);

#endif
