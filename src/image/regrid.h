/* SPDX-License-Identifier: MIT */
/*
 * Regrid: a map on the grid of a scene, when it lies in the same place, by another order of its
 * axes, or by resampling.
 *
 * Two grids are the same where they have the same size and no corner voxel lies further apart, in
 * the world, than half of the scene's shortest step. Where one of both does not know its place, a
 * map of the same size and spacing is taken voxel by voxel: there is nothing to compare. A shift of
 * more than a thousandth of a voxel is noted.
 *
 * Where both know it, a map whose axes are the scene's in another order, or run the other way, is
 * the same grid too: its voxels are put in the scene's order, none is changed. Of several orders
 * the one that lies nearest counts, and which of them does not matter: they differ by axes of one
 * voxel. With `resample` the nearest voxels are taken, which are the same.
 *
 * Resampling gives each voxel of the scene the value of the map's voxel nearest to its centre,
 * halves towards higher indices, and 0 where the map ends. The way from one grid to the other is
 * worked out once, to 2^-30 of a voxel; from there on it is integers, so that a journal gives the
 * same on every machine.
 */
#ifndef IMAGE_REGRID_H
#define IMAGE_REGRID_H

#include "image/volume.h"

/* Whether a map that lies elsewhere is resampled; if not, the words by which the user asks for it:
 * of a command, or of a program. */
enum regrid_how { REGRID_AS_IT_IS, REGRID_RESAMPLE, REGRID_AS_IT_IS_FOR_PROGRAM };

/* How the voxels of a map are gone through along each axis of a scene: along which of its own, and
 * whether from the end. */
struct regrid_order {
    int axis[3];
    bool is_reversed[3];
    double apart_mm; /* of the grids, in the corner where it is most */
};

/* In which order the voxels of the map are those of the scene, one by one, where both know their
 * place; false where there is none. */
bool regrid_find_order(struct regrid_order *order, const uint32_t map_size[3],
                       const struct geometry *map, const uint32_t size[3],
                       const struct geometry *scene);

/* Whether a map of this size and place can be taken for the scene's grid, as it is or with its
 * nearest voxels. ERR_INPUT says how far off it is, and what to type. Asked of a header
 * before voxels are read. */
enum err regrid_check(const uint32_t map_size[3], const struct geometry *map,
                      const uint32_t size[3], const struct geometry *scene, enum regrid_how how,
                      struct fault *fault);

/* Brings the map there: after that its size and place are the scene's, its values what they stood
 * for; notes say what was done. ERR_INPUT as above, ERR_MEMORY, ERR_CANCELLED by the watch (or
 * NULL); the map is as it was, or to be released, then. */
enum err regrid(struct volume *map, const uint32_t size[3], const struct geometry *scene,
                enum regrid_how how, struct watch *watch, struct fault *fault);

#endif
