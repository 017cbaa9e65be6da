/* SPDX-License-Identifier: MIT */
/*
 * The outline that is there in a slice, to be corrected: that of a marker, or else the border of a
 * label as it is shown; and in which slice to outline next.
 */
#ifndef REPORT_OUTLINE_FACTS_H
#define REPORT_OUTLINE_FACTS_H

#include "base/buf.h"
#include "base/polyline.h"
#include "session/session.h"

/* A marker counts that stands, lies in the slice alone and has the place within a few voxels of
 * itself; of several, the latest. */
enum { OUTLINE_FACTS_NEAR = 8 };

/* Finds it, in the slice across an axis through a place, and adds in words what it is of. The line
 * is empty before; `marker` is 0 where it is of the label's border, of the largest piece
 * (session/doubtful.h). False, with words, where there is none. */
bool outline_facts_find(struct polyline *line, uint32_t *marker, struct session *session,
                        unsigned label, unsigned axis, const uint32_t place[3], struct buf *out);

/* The slice in which it is the `rank`th least certain, from 1 on, where the label ends
 * (session/doubtful.h): the axis that it lies across, a place in it, and in words how much is in
 * doubt. False, with words, where there is none of that rank. */
bool outline_facts_next(unsigned *axis, uint32_t place[3], struct session *session, unsigned label,
                        size_t rank, struct buf *out);

#endif
