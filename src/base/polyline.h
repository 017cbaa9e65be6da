/* SPDX-License-Identifier: MIT */
/*
 * A line through voxels, corner by corner: the path of a pen, or the outline of a polygon.
 *
 * Invariant: no corner equals the one before it, nor is on the straight line between its
 * neighbours. Such places are dropped as they are added, so a pen that moves voxel by voxel leaves
 * few corners. A turn back along the same line is a corner.
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

/* Extend the line to a place. False if memory runs out; nothing has changed then. */
bool polyline_add(struct polyline *line, const uint32_t place[3]);

/* Remove corners while every removed one stays within half a voxel of the line; both ends are kept.
 * Small steps, of a hand or of a border of voxels, become a few straight segments. */
void polyline_simplify(struct polyline *line);

#endif
