/* SPDX-License-Identifier: MIT */
/*
 * A line through voxels, corner by corner: what a pen draws, or the outline of a polygon.
 *
 * Invariant: no corner is the same as the one before it, nor lies on the straight way between its
 * neighbours. Such a place says nothing new and is left out as it comes, so that a pen that moves
 * voxel by voxel leaves few corners. A way back along the same line is a corner.
 */
#ifndef BASE_POLYLINE_H
#define BASE_POLYLINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* {0} is empty. */
struct polyline {
    uint32_t (*corner)[3]; /* each below 2^31 */
    size_t count, capacity;
};

void polyline_release(struct polyline *line);

/* The line goes on to a place. False when out of memory; nothing has changed then. */
bool polyline_add(struct polyline *line, const uint32_t place[3]);

/* Leaves out corners as long as those that go lie within half a voxel of the line that stays, whose
 * ends are kept: small steps, of a hand or of a border of voxels, become a few straight ways. */
void polyline_simplify(struct polyline *line);

#endif
