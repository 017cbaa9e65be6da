/* SPDX-License-Identifier: MIT */
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
#ifndef REPORT_DISTANCE_PICTURE_H
#define REPORT_DISTANCE_PICTURE_H

#include "image/picture.h"
#include "show/comparison.h"
#include "session/session.h"

/* As the session looks at its objects: view, size, cuts and look; `fits`: at a zoom at which all of
 * A fits instead. Which labels are shown, and their colours, are of no consequence. The session is
 * as before, but for what was rendered. The caller releases the picture. ERR_INPUT where A or B has
 * no contour, ERR_MEMORY, ERR_CANCELLED; on errors the session is to be rolled back. */
enum err distance_picture_draw(struct picture *picture, struct session *session,
                               const struct compared *compared,
                               const struct comparison_report *report, bool fits,
                               struct fault *fault);

#endif
