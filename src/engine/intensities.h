/*
 * How often each intensity occurs in a scene, and between which ones most of its voxels lie.
 */
#ifndef ENGINE_INTENSITIES_H
#define ENGINE_INTENSITIES_H

#include "base/team.h"
#include "engine/scene.h"

/* Of all voxels, or in a large scene of those of every n-th row: enough for percentiles, and few
 * enough to take no time. `team` may be NULL for one thread, which it is as well without memory. */
void intensities_count(uint32_t count[UINT16_MAX + 1], const struct scene *scene,
                       struct team *team);

/* Two intensities, the highest of those that `low` thousandths of the voxels or fewer are below,
 * and of those that fewer than `high` thousandths are below; 0 where nothing is counted. */
void intensities_range(int32_t range[2], const uint32_t count[UINT16_MAX + 1], uint64_t low,
                       uint64_t high);

#endif
