/* SPDX-License-Identifier: MIT */
/* Dice over the gestures of an expert and of a trainee, drawn as two curves in one frame: of all
 * labels, and below of each, up to nine of them. */
#ifndef VERIFY_GESTURE_PICTURE_H
#define VERIFY_GESTURE_PICTURE_H

#include "image/picture.h"
#include "verify/gesture_report.h"

/* The caller releases the picture. ERR_MEMORY. */
enum err gesture_picture_draw(struct picture *picture, const struct gesture_report *report,
                              struct fault *fault);

#endif
