/* SPDX-License-Identifier: MIT */
/*
 * Shading: the colour of each pixel.
 *
 * It is a pure function of the shown voxels, labels, intensities and depths near the pixel, and of
 * palette, look and view; shade_reach returns how near. The incremental image relies on this. If
 * the look has edges (render/edge.h), lines are drawn over the colours. A face where an object was
 * cut open (render/cut.h) shows the scene, in grey tinted with the object's colour.
 */
#ifndef RENDER_SHADE_H
#define RENDER_SHADE_H

#include "render/layers.h"
#include "render/mesh.h"
#include "render/look.h"
#include "render/palette.h"

/* Return the mesh that a look shows. */
enum mesh_kind shade_kind(const struct look *look);

/* The distance at which colours may change: `voxels` around a voxel that appears or disappears, 0
 * if only changed quads matter, plus `pixels` around either. */
struct shade_reach {
    int voxels, pixels;
};
struct shade_reach shade_reach(const struct look *look, const struct camera *camera);

/* Shade every stale tile and mark it shaded or empty. The mesh is up to date. ERR_MEMORY, with
 * tiles still stale. With several samples a pixel, empty tiles are filled by rendition_reduce. */
enum err shade(struct rendition *rendition, const struct camera *camera, const struct mesh *mesh,
               const struct palette *palette, const struct look *look, struct shader *shader,
               struct fault *fault);

/* The same in steps, for a caller with its own threads: first prepare shared data, which may return
 * ERR_MEMORY. Then each thread shades the tiles of its own rendition, without edges; it ends early
 * if the watch has stopped, but does not poll it. Edges are drawn from row `first` of tiles to
 * before row `end`, and read the tiles around. */
enum err shader_prepare(struct shader *shader, const struct border *border, const struct look *look,
                        struct fault *fault);
void shade_rows(struct rendition *rendition, const struct camera *camera, const struct mesh *mesh,
                const struct palette *palette, const struct look *look,
                const struct shader *shader);
void shade_edges(struct rendition *rendition, uint32_t first, uint32_t end,
                 const struct camera *camera, const struct palette *palette,
                 const struct look *look);

#endif
