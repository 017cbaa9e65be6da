/* SPDX-License-Identifier: MIT */
/*
 * Picture of a comparison: three slices of the scene through one voxel, with outlines around the
 * voxels that differ, and a legend with the agreement of each label.
 *
 *     coronal | sagittal
 *     --------+---------
 *     axial   | words
 *
 * The outlines are as thick as the thin lines of the picture: white around voxels of one label in
 * both, orange around objects of A alone, blue of B alone, purple around objects with another
 * label in each. A difference of one voxel is all line, so it is visible. The colours can be
 * distinguished without red and green vision.
 */
#ifndef SHOW_COMPARISON_PICTURE_H
#define SHOW_COMPARISON_PICTURE_H

#include "image/picture.h"
#include "session/session.h"
#include "show/comparison.h"

/* Kinds of voxels by their two labels; 0: background in both. */
enum difference { AGREES = 1, A_ALONE, B_ALONE, ANOTHER_LABEL, DIFFERENCES };
extern const uint8_t difference_rgb[DIFFERENCES][3];
extern const char *const difference_words[DIFFERENCES];
enum difference difference_of(uint8_t label_a, uint8_t label_b);

/* Has the size of the session's view, goes through `place` and has notes; the caller releases the
 * picture, also on error. ERR_LIMIT for a view too small for a mosaic, ERR_MEMORY. */
enum err comparison_picture_draw(struct picture *picture, struct session *session,
                                 const struct comparison_report *report, const uint32_t place[3],
                                 struct fault *fault);

/*
 * Picture of the distance between two surfaces: the surface of A, all objects as one, coloured by
 * the distance to the nearest voxel of B's contour (show/comparison.h).
 *
 *     blue   A is inside B: it is too small here
 *     grey   on B's contour
 *     red    A is outside B: it is too large here
 *
 * Colours change in 127 steps each way. The last colour is at a round length: the least of 1, 2, 5,
 * 10, ... mm that is not less than a voxel and covers 95 of 100 of the pixels whose distance is not
 * 0. A bar shows that length. The colours can be distinguished without red and green vision.
 */

/* Uses the session's view, size, cuts and look; with `fits` a zoom at which all of A fits.
 * Visibility and colours of labels are ignored. The session's state is restored, its rendition is
 * not. The caller releases the picture, also on error. ERR_INPUT if A or B has no contour,
 * ERR_MEMORY, ERR_CANCELLED; after an error the caller rolls the session back. */
enum err distance_picture_draw(struct picture *picture, struct session *session,
                               const struct comparison_report *report, bool fits,
                               struct fault *fault);

#endif
