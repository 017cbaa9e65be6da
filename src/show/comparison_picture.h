/* SPDX-License-Identifier: MIT */
/*
 * The picture of a comparison: three slices of the scene through one voxel, in which the voxels
 * that differ are outlined, and beside them what the colours mean and how far each label agrees.
 *
 *     coronal | sagittal
 *     --------+---------
 *     axial   | words
 *
 * A line as thick as a thin one of the picture outlines each region: white what both have under one
 * label, orange what A alone has for an object, blue what B alone has, purple what is another
 * object in each. A difference of one voxel is all line, so it is seen. People who cannot
 * distinguish red from green can distinguish these colours.
 */
#ifndef REPORT_COMPARISON_PICTURE_H
#define REPORT_COMPARISON_PICTURE_H

#include "image/picture.h"
#include "session/session.h"
#include "show/comparison.h"

/* How the labels of a voxel differ; 0 where neither is an object. */
enum difference { AGREES = 1, A_ALONE, B_ALONE, ANOTHER_LABEL, DIFFERENCES };
extern const uint8_t difference_rgb[DIFFERENCES][3];
extern const char *const difference_words[DIFFERENCES];
enum difference difference_of(uint8_t label_a, uint8_t label_b);

/* At the size of the session's view, through `place`, with notes; the caller releases the picture.
 * ERR_LIMIT for a view too small for a mosaic, ERR_MEMORY. */
enum err comparison_picture_draw(struct picture *picture, struct session *session,
                                 const struct compared *compared,
                                 const struct comparison_report *report, const uint32_t place[3],
                                 struct fault *fault);

/*
 * The picture of how far a surface lies from another: the surface of A, all objects as one,
 * coloured by the distance to the nearest voxel of B's contour, as a comparison measures it
 * (show/comparison.h).
 *
 *     blue   A lies inside B: it is too small here
 *     grey   where B's contour is
 *     red    A lies outside B: it is too large here
 *
 * Colours change in 127 steps each way, and reach their ends at a round length: the least of 1, 2,
 * 5, 10, ... mm that 95 of 100 pixels that show another distance than 0 are within, and no less
 * than a voxel. A bar says which. These colours stay apart for people who cannot distinguish red
 * from green.
 */

/* As the session looks at its objects: view, size, cuts and look; `fits`: at a zoom at which all of
 * A fits instead. Which labels are shown, and their colours, are of no consequence. The session is
 * as before, but for what was rendered. The caller releases the picture. ERR_INPUT where A or B has
 * no contour, ERR_MEMORY, ERR_CANCELLED; on errors the session is to be rolled back. */
enum err distance_picture_draw(struct picture *picture, struct session *session,
                               const struct compared *compared,
                               const struct comparison_report *report, bool fits,
                               struct fault *fault);

#endif
