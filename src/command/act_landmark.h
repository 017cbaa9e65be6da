/* SPDX-License-Identifier: MIT */
/* Where a journal comes from: landmarks, by which scenes are matched, and the procedure that it was
 * made by (act_landmark.c). */
#ifndef COMMAND_ACT_LANDMARK_H
#define COMMAND_ACT_LANDMARK_H

#include "base/buf.h"

struct session;

/* Adds the lines of `info` about both; none where there is nothing. */
void act_write_origin(struct buf *out, const struct session *session);

#endif
