/* SPDX-License-Identifier: MIT */
/*
 * Which slice to outline next: that with the most doubt (engine/doubt.h), of all three planes.
 *
 * Slices in which an outline of the label lies already say what they can, and those beside them
 * nearly the same: they are left out. Of those of one plane that come after each other in rank, two
 * lie DOUBTFUL_APART or more slices apart, since the doubt of neighbours is the same.
 *
 * Robots who outline what comes first here reach as far with as many outlines as those who outline
 * the slice that is most wrong, which nobody can know.
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
    unsigned axis; /* at right angles to it; */
    uint32_t at;   /* and its place along that */
    uint64_t doubt;
};

/* The slices of most doubt, the first one first, for a label or FINISH_ALL_LABELS, as of the last
 * run; *count of them. Made in about the time of `finish relax`, and at once while labels, seeds
 * and steps stay. The errors of doubt_find. */
enum err doubtful_find(struct doubtful_slice slice[DOUBTFUL_MOST], size_t *count,
                       struct session *session, unsigned label, struct fault *fault);

/* A voxel in the middle of what a label has in the slice; where it has nothing there, of what it
 * has in the nearest one that it is in, moved to this one. False where it has no voxel. */
bool doubtful_place(uint32_t place[3], const struct labels *labels, unsigned label,
                    const struct doubtful_slice *slice);

/*
 * Contours: the outline of what is there already in a slice, to begin with and to be corrected.
 *
 * Of the voxels of a slice that are meant, those that hang together by faces are a piece. The
 * contour goes once around one of them, the largest unless another is asked for, from the centre of
 * one of its outer voxels to that of the next, by faces and corners, and is then simplified
 * (polyline_simplify): so the polygon through its corners (session/paint.h) has the voxels of the
 * piece, holes filled, but for those that half a voxel decides about. Of a rectangle it has its
 * four corners.
 */

/* Where pieces are equal, that which begins first counts, row by row. More corners than a hand
 * would drag are thinned out. */
enum { CONTOUR_CORNERS_MOST = 1000 };

/* The corners of a label's contour in the slice through a place, across an axis, into an empty
 * line: of the piece that has the place, else of the largest; the last one leads back to the first.
 * Fewer than three of what is no wider than a row of voxels, none where the label is not in the
 * slice. ERR_MEMORY leaves it empty. */
enum err contour_of_label(struct polyline *contour, const struct labels *labels, unsigned label,
                          unsigned axis, const uint32_t place[3], struct fault *fault);

/* The same of the voxels of a marker, without those that are joined to it: of an outline, its
 * inside. None where they do not lie in one slice. */
enum err contour_of_marker(struct polyline *contour, const struct grid *grid,
                           const struct markers *markers, uint32_t number, struct fault *fault);

/* Whether a marker has an area in one slice, more voxels than a line through it: as an outline has,
 * and a stroke has not. Then the slice: its axis, and the place along that. */
bool contour_is_area(unsigned *axis, uint32_t *at, const struct grid *grid,
                     const struct markers *markers, uint32_t number);

#endif
