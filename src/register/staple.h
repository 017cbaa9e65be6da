/* SPDX-License-Identifier: MIT */
/*
 * STAPLE: the consensus of several raters' label maps, and how far each of them can be trusted, by
 * ITK in a process of its own (iftty-register).
 *
 * S. K. Warfield, K. H. Zou, W. M. Wells, "Simultaneous truth and performance level estimation
 * (STAPLE)", IEEE Trans. Med. Imaging 23 (2004) 903-921; of several labels at once: T. Rohlfing,
 * D. B. Russakoff, C. R. Maurer, IEEE Trans. Med. Imaging 23 (2004) 983-994.
 */
#ifndef REGISTER_STAPLE_H
#define REGISTER_STAPLE_H

#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

enum { STAPLE_RATERS_MOST = 64, STAPLE_LABELS = 256 };

/* Of one rater: 0..1 for each label that any rater has; NAN for others. Label 0, the background, is
 * one of them. */
struct staple_rater {
    double sensitivity[STAPLE_LABELS]; /* of what has the label, so much he gives it to */
    double specificity[STAPLE_LABELS]; /* of what has it not, so much he does not give it to */
};

/*
 * `maps` are `raters` (2..64) maps of one grid, [z][y][x], `consensus` is room for another (the
 * caller's arrays). Where labels are equally likely, a voxel gets the lowest that a rater says.
 * ERR_INPUT, ERR_IO where the helper is missing or ended, ERR_CANCELLED: then the arrays hold
 * nothing of use.
 */
enum err staple_find(uint8_t *consensus, struct staple_rater rater[], unsigned raters,
                     const uint8_t *const maps[], const uint32_t size[3], struct watch *watch,
                     struct fault *fault);

#endif
