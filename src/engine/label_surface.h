/*
 * The area of the surface of each label, as it would be were it not made of voxels.
 *
 * Counting the faces of voxels gives half as much again for a ball. So each face that a label has
 * to another one, or to the edge of the scene, counts by the cosine of the angle between it and the
 * surface, whose normal is the gradient of the label's share of 3 x 3 x 3 voxels, of which inner
 * ones count a little more, as the mean of both voxels beside the face, by the spacing.
 *
 * What that gives is not exact: it is too small where a surface has edges, by about a half of the
 * length of the edges times a voxel. Within 2 % are balls with a radius of 8 voxels or more, and
 * boxes of 60 voxels or more, however they are turned, at spacings up to 1 to 2 (test_stats).
 */
#ifndef ENGINE_LABEL_SURFACE_H
#define ENGINE_LABEL_SURFACE_H

#include "base/team.h"
#include "engine/scene.h"

/* Sums of cosines, of the faces across each axis: integers, so that the order of work and the
 * number of threads do not matter. By SURFACE_UNIT, and times the area of a face, they are the
 * surface. */
enum { SURFACE_UNIT = 1 << 20 };
struct label_surface {
    uint64_t cosines[256][3];
};

/* Of label[grid.cells], 0 in the rim; label 0 has none. ERR_MEMORY, or ERR_CANCELLED by the scene's
 * watch. */
enum err label_surface_find(struct label_surface *surface, const uint8_t *label,
                            const struct scene *scene, struct team *team, struct fault *fault);

#endif
