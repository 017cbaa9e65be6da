/* SPDX-License-Identifier: MIT */
/*
 * Regrid: move a map to the grid of a scene: unchanged, with its axes reordered, or resampled.
 *
 * Two grids are the same if they have the same size and the positions of each corner voxel differ
 * by at most half of the scene's shortest step. If one of both has no known place, a map of the
 * same size and spacing is used voxel by voxel, since there is nothing to compare. A shift of more
 * than a thousandth of a voxel is noted.
 *
 * If both places are known, a map whose axes are the scene's in another order, or reversed, has the
 * same grid too: its voxels are reordered, and none is changed. The nearest of several orders is
 * used; equally near ones differ by axes of one voxel alone. With `resample` the nearest voxels are
 * used, which are the same.
 *
 * Resampling sets each voxel of the scene to the value of the map's voxel nearest to its centre,
 * halves towards higher indices, and to 0 outside the map. The transform between the grids is
 * computed once, to 2^-30 of a voxel, and everything after that is integers, so that a journal has
 * the same result on every machine.
 */
#ifndef IMAGE_REGRID_H
#define IMAGE_REGRID_H

#include "image/volume.h"

/* Resample a map at another place, or refuse it; the refusal names the option of a command, or that
 * of a program. REGRID_FILL: the map is aligned, and voxels outside it are 0. */
enum regrid_how { REGRID_AS_IT_IS, REGRID_RESAMPLE, REGRID_AS_IT_IS_FOR_PROGRAM, REGRID_FILL };

/* For each axis of a scene the axis of a map that follows it, and whether it is reversed. */
struct regrid_order {
    int axis[3];
    bool is_reversed[3];
    double apart_mm; /* greatest distance of the grids, in a corner */
};

/* Find the order of axes in which the voxels of the map are those of the scene, if both places are
 * known; false if there is no such order. */
bool regrid_find_order(struct regrid_order *order, const uint32_t map_size[3],
                       const struct geometry *map, const uint32_t size[3],
                       const struct geometry *scene);

/* Return true if voxels of the map, of any size, are voxels of the scene, continued beyond its
 * sides, in any order of axes; within half a voxel, as above. */
bool regrid_is_aligned(const uint32_t map_size[3], const struct geometry *map,
                       const uint32_t size[3], const struct geometry *scene);

/* Check that a map of this size and place can be used, unchanged or resampled, before its voxels
 * are read. The message of ERR_INPUT has the distance and the option to type. */
enum err regrid_check(const uint32_t map_size[3], const struct geometry *map,
                      const uint32_t size[3], const struct geometry *scene, enum regrid_how how,
                      struct fault *fault);

/* Move the map to the scene's grid, with the same values; notes describe the change. `beyond` is
 * NULL, or all 0 and gets 1 for each voxel outside the map, which the caller fills. ERR_INPUT as
 * above, ERR_MEMORY, ERR_CANCELLED by the watch (or NULL); release the map after an error. */
enum err regrid(struct volume *map, const uint32_t size[3], const struct geometry *scene,
                enum regrid_how how, uint8_t *beyond, struct watch *watch, struct fault *fault);

#endif
