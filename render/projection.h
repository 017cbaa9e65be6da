/*
 * Projection: the ways to the first cube of each pixel (render/rendition.h). All give the same.
 *
 *     scene projection    splats every shown voxel
 *     border projection   takes border voxels alone, from the nearest to the furthest: a pixel that
 *                         has been given one keeps it, so that what lies behind covered pixels is
 *                         passed over, whole blocks of voxels at once
 *     ray walk            follows the ray of each pixel
 *     incremental image   repairs the former picture after an edit (render/incremental.h)
 *
 * Where objects are translucent and their layers are projected (render/layers.h), these are what
 * the four ways make.
 */
#ifndef RENDER_PROJECTION_H
#define RENDER_PROJECTION_H

#include "render/rendition.h"

/* Scene projection and border projection; the rendition has the camera's size. These, the ray walk
 * and shading are done under the scene's watch: what ends early is of no use. */
void splat_scene(struct rendition *rendition, const struct camera *camera,
                 const struct border *border);
void splat_border(struct rendition *rendition, const struct camera *camera,
                  const struct border *border);

/* Border projection by any thread, which ends early where the watch has stopped, but does not poll
 * it. */
void splat_border_quietly(struct rendition *rendition, const struct camera *camera,
                          const struct border *border);

/* Border projection by a team, each thread with rows of its own. */
void splat_border_shared(struct rendition *rendition, const struct camera *camera,
                         const struct border *border, struct team *team);

/* The ray walk over the whole picture. */
void raycast(struct rendition *rendition, const struct camera *camera, const struct border *border);

/* The first solid voxel (render/border.h) on the ray of a pixel whose depth is at least `from`: its
 * depth and cell, or false. INT64_MIN starts before the scene. */
bool raycast_pixel(const struct camera *camera, const struct border *border, uint32_t column,
                   uint32_t row, int64_t from, int64_t *depth, uint32_t *cell);

/* One voxel more is shown: its cube in the pixels that it may cover. */
void splat_voxel(struct rendition *rendition, const struct camera *camera, uint32_t cell);

#endif
