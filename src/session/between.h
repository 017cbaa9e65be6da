/* SPDX-License-Identifier: MIT */
/*
 * Slices between outlines: an object that was outlined exactly in some slices is filled in the
 * slices between them (shape-based interpolation; Raya, Udupa 1990). Integers only.
 *
 * The *section* of an object in a slice is the set of its outlined voxels. The signed distance of a
 * place in the plane of a section is floor(16 d), where d is the distance from its centre to the
 * nearest centre of a voxel outside the section, or, below 0, of one inside if the place is
 * outside; in the unit of distance_scale_of for the spacing in the plane. Places outside the scene
 * are outside a section, but no voxel has a distance to them: so an object that the edge of the
 * scene cuts is not rounded there. If no voxel is outside, the distance is 2^36.
 *
 * Between two sections, which are next to each other in the order of slices, however far apart, a
 * voxel is filled if the mean of both signed distances, with the weights of linear interpolation,
 * is 0 or more: so it is filled if both sections have it, and not if none has it.
 *
 * Sections that share fewer than half the voxels of the smaller one are aligned before: the middle
 * of a section is the mean place of its voxels, rounded to half voxels, and in each slice both are
 * moved by half voxels to the point between the middles. A signed distance at a half voxel is the
 * mean of the two or four next to it.
 *
 * Nothing is filled before the first and after the last section.
 */
#ifndef SESSION_BETWEEN_H
#define SESSION_BETWEEN_H

#include <stdint.h>

#include "base/err.h"
#include "base/team.h"
#include "base/watch.h"
#include "engine/grid.h"
#include "session/markers.h"

enum { BETWEEN_OUTLINED = 1, BETWEEN_FILLED = 2 };

/* Find the axes, bit a for axis a, at right angles to outlines of a label; and, unless `map` is
 * NULL, set map[cell] in the voxels of outlines along `axis` where no later marker decides. An
 * outline is a valid exact marker with no voxels in adjacent slices along one axis, and with such
 * voxels along both others: one slice of any shape, or several of a map. ERR_MEMORY,
 * ERR_CANCELLED. */
enum err between_find(unsigned *axes, uint8_t *map, const struct markers *markers,
                      const struct grid *grid, int16_t label, int axis, struct watch *watch,
                      struct fault *fault);

struct between_tally {
    uint32_t sections, first, last; /* slices with a section, in voxels along the axis */
    uint32_t slices;                /* filled ones */
    size_t voxels;
};

/* Fill the slices between the outlined voxels of a map of the grid. The tally is valid on
 * success. ERR_MEMORY, ERR_CANCELLED. */
enum err between_fill(uint8_t *map, struct between_tally *tally, const struct grid *grid,
                      const uint32_t spacing_nm[3], int axis, struct team *team,
                      struct watch *watch, struct fault *fault);

#endif
