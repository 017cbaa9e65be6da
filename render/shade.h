/* SPDX-License-Identifier: MIT */
/*
 * Shading: the colour of each pixel.
 *
 * It is a pure function of shown voxels, labels, intensities and depths near the pixel, and of
 * palette, look and view: shade_reach says how near. The incremental image relies on it. Where the
 * look has edges (render/edge.h), lines are drawn over the colours. A face where an object was cut
 * open (render/cut.h) shows the scene, in grey tinted with the object's colour.
 */
#ifndef RENDER_SHADE_H
#define RENDER_SHADE_H

#include "render/layers.h"
#include "render/mesh.h"
#include "render/look.h"
#include "render/palette.h"

/* Which mesh a look shows. */
enum mesh_kind shade_kind(const struct look *look);

/* How far around a voxel that appears or disappears colours may change beyond the quads that change
 * themselves: by so many voxels, 0 where they do not, and from either by so many pixels more. */
struct shade_reach {
    int voxels, pixels;
};
struct shade_reach shade_reach(const struct look *look, const struct camera *camera);

/* Shades every stale tile and marks it shaded or empty. The mesh is up to date. ERR_MEMORY, with
 * tiles still stale. With several samples a pixel, what is seen of empty tiles is for
 * rendition_reduce to make. */
enum err shade(struct rendition *rendition, const struct camera *camera, const struct mesh *mesh,
               const struct palette *palette, const struct look *look, struct shader *shader,
               struct fault *fault);

/* The same in steps, for the caller who has threads of his own: first what they need, which may be
 * ERR_MEMORY. Then a thread shades the tiles of a rendition of its own, but for edges; it ends
 * early where the watch has stopped, but does not poll it. Edges are drawn from row `first` of
 * tiles to before row `end`, and those around are looked at. */
enum err shader_prepare(struct shader *shader, const struct border *border, const struct look *look,
                        struct fault *fault);
void shade_rows(struct rendition *rendition, const struct camera *camera, const struct mesh *mesh,
                const struct palette *palette, const struct look *look,
                const struct shader *shader);
void shade_edges(struct rendition *rendition, uint32_t first, uint32_t end,
                 const struct camera *camera, const struct palette *palette,
                 const struct look *look);

#endif
