/* SPDX-License-Identifier: MIT */
/*
 * Balls of voxels: the brush that paints seeds and opens and closes labels, and the reach of a
 * seed.
 */
#ifndef ENGINE_BRUSH_H
#define ENGINE_BRUSH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

/* Largest number of voxels from the centre along each axis: of a full ball, and of a hollow one. */
enum { BRUSH_REACH_MOST = 128, BRUSH_HOLLOW_REACH_MOST = 512 };

/* A ball, as rows of voxels around its centre; a hollow one is its shell. */
struct brush {
    int reach[3];
    struct brush_row *row;
    size_t rows;
};
struct brush_row {
    int16_t y, z, half; /* from x - half to x + half, */
    int16_t hole;       /* except x - hole to x + hole; -1 for no hole */
};

/* Compute the ball (dx unit[0])^2 + (dy unit[1])^2 + (dz unit[2])^2 <= radius^2: in voxels with
 * units of 1, in nanometres with the spacing as units. The radius is 0..10^9. ERR_LIMIT if the ball
 * extends more than `most` voxels from its centre along an axis; ERR_MEMORY. */
enum err brush_init(struct brush *brush, const uint32_t unit[3], int64_t radius, int most,
                    struct fault *fault);

/* Keep only voxels of the ball with one of their neighbours (6 or 26) outside it. Every path over
 * such neighbours from the hole out of the ball crosses a kept voxel. On ERR_MEMORY the ball stays
 * full. */
enum err brush_hollow(struct brush *brush, unsigned neighbours, struct fault *fault);
void brush_release(struct brush *brush);

/*
 * The reach of a seed: a ball beyond which its tree does not grow.
 *
 * A user who corrects a place states how far the correction extends: a seed of reach B makes no
 * offers to voxels outside B. The equation of the forest (engine/forest.h) becomes
 *
 *     key(t) = min(own seed's key, min over neighbours s of extend(key(s), w),
 *                  if t is in the reach of the root of key(s), or that root has no reach)
 *
 * A rejected offer is an infinite one, and an offer still depends on key(s) and the arc alone and
 * is greater than key(s): of two solutions, the least key in which they differ would be offered by
 * a lesser one, in which they agree. So there is one solution, the forest stays a function of the
 * seeds with their labels and reaches, and Dijkstra's algorithm finds it. Two properties are lost:
 *
 *   - the cost of a voxel may be above the textbook's f_max cost: a tree that holds a voxel because
 *     its offer was better does not pass on the offers that it has kept out;
 *   - a voxel may have no key although a path leads to it from a seed, since every tree around it
 *     ends before it. It is background, like any voxel that no seed reaches. forest_count_refused
 *     counts them.
 *
 * The reach belongs to the seed as its label does: changing the label or the reach is a removal and
 * a planting. A voxel that loses an offer because of a reach has lost its support (engine/pass.c).
 */
enum { REACH_MOST = 512 }; /* largest reach in voxels that a user can set */

/* Radius of a reach that holds no voxel: its seeds make no offer, so that planting them changes
 * their own voxels, and others only where trees passed through these. */
enum { REACH_EXACT = -1 };

/* A ball of voxels with (dx unit[0])^2 + (dy unit[1])^2 + (dz unit[2])^2 <= radius^2 around the
 * centre: in voxels with units of 1, in nanometres with the spacing as units. The radius is
 * 0..10^9, or REACH_EXACT. */
struct reach {
    uint32_t centre[3], unit[3];
    int64_t radius;
};

static inline bool reach_holds(const struct reach *reach, int64_t x, int64_t y, int64_t z)
{
    const int64_t way[3] = {x - reach->centre[0], y - reach->centre[1], z - reach->centre[2]};
    int64_t sum = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t along = way[a] * reach->unit[a]; /* below 2^48 */
        if (along > reach->radius || along < -reach->radius)
            return false;
        sum += along * along; /* three times 10^18 at most */
    }
    return sum <= reach->radius * reach->radius;
}

#endif
