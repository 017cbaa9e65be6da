/* SPDX-License-Identifier: MIT */
/*
 * Balls of voxels: the brush that seeds are painted with and labels are opened and closed by, and
 * the reach of a seed.
 */
#ifndef ENGINE_BRUSH_H
#define ENGINE_BRUSH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

/* Voxels from its middle along each axis: of a full ball, and of one that will be hollow. */
enum { BRUSH_REACH_MOST = 128, BRUSH_HOLLOW_REACH_MOST = 512 };

/* A ball, as rows of voxels around its middle; a hollow one is its shell. */
struct brush {
    int reach[3];
    struct brush_row *row;
    size_t rows;
};
struct brush_row {
    int16_t y, z, half; /* from x - half to x + half, */
    int16_t hole;       /* but for x - hole to x + hole; -1 for no hole */
};

/* The ball (dx unit[0])^2 + (dy unit[1])^2 + (dz unit[2])^2 <= radius^2: in voxels with units of 1,
 * in nanometres with the spacing as units. A radius of 0..10^9. ERR_LIMIT for one that reaches
 * more voxels than `most`. */
enum err brush_init(struct brush *brush, const uint32_t unit[3], int64_t radius, int most,
                    struct fault *fault);

/* Keeps the voxels that have one of so many neighbours, 6 or 26, outside the ball. No way between
 * such neighbours leads from the hole out of the ball but through what is kept. ERR_MEMORY leaves
 * the ball full. */
enum err brush_hollow(struct brush *brush, unsigned neighbours, struct fault *fault);
void brush_release(struct brush *brush);

/*
 * The reach of a seed: a ball beyond which its tree does not grow.
 *
 * A user who corrects a place says with it how far the correction goes: a seed of reach B offers
 * nothing to a voxel outside B. The equation of the forest (engine/forest.h) becomes
 *
 *     key(t) = min(own seed's key, min over neighbours s of extend(key(s), w),
 *                  where t lies in the reach of the root of key(s), or that has none)
 *
 * A refused offer is an infinite one, and an offer still depends on key(s) and the arc alone and is
 * greater than key(s): of two solutions the least key in which they differ would be offered by a
 * lesser one, in which they agree. So there is one solution, the forest stays a function of the
 * seeds with their labels and reaches, and Dijkstra finds it. What is no longer true:
 *
 *   - the cost of a voxel may be above the textbook's f_max cost: a tree that takes a voxel, for it
 *     comes first there, does not pass on what it has kept out;
 *   - a voxel may have no key, though a way leads to it from a seed: every tree around it ends
 *     before it. It is background, as any that no seed reaches. forest_count_refused counts them.
 *
 * The reach belongs to the seed as its label does: another label, or another reach, is a removal
 * and a planting. And a voxel hears of an offer that is refused where it was not before: it has
 * lost its support (engine/pass.c).
 */
enum { REACH_MOST = 512 }; /* voxels that a user may ask for */

/* The voxels with (dx unit[0])^2 + (dy unit[1])^2 + (dz unit[2])^2 <= radius^2 around the centre:
 * in voxels with units of 1, in nanometres with the spacing as units. A radius of 0..10^9. */
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
