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
#include "render/look.h"
#include "render/palette.h"
#include "render/shader.h"

/* Whether a picture shows surfaces between voxel centres. */
bool shade_refines(const struct look *look, const struct camera *camera,
                   const struct border *border);

/* layers_take with the shader's seams; they are refined where the look says so. */
enum err shade_take_layers(struct shader *shader, struct layers *layers,
                           struct rendition *rendition, const struct camera *camera,
                           const struct border *border, const struct look *look,
                           struct fault *fault);

/* Has what is stored for creases follow an edit, of which the border knows already. */
void shade_follow(struct shader *shader, const struct border *border,
                  const struct changes *changes);

/* How far colours depend on what is around. */
struct shade_reach shade_reach(const struct look *look, const struct camera *camera);

/* Shades every stale tile and marks it shaded or empty, or such that one sample stands for each
 * pixel. ERR_MEMORY, with tiles still stale. Where the look is refined and was not before, or the
 * other way round, all tiles are stale. With several samples a pixel, what is seen of empty tiles
 * is for rendition_reduce to make. */
enum err shade(struct rendition *rendition, const struct camera *camera,
               const struct border *border, const struct palette *palette, const struct look *look,
               struct shader *shader, struct fault *fault);

/* The same in two steps, for the caller who has threads of his own: first what `threads` of them
 * need, which may be ERR_MEMORY. Then thread `number` shades tiles of a rendition of its own, from
 * row `first` of tiles to before row `end`, and only looks at the others; it ends early where the
 * watch has stopped, but does not poll it. */
enum err shader_prepare(struct shader *shader, unsigned threads, const struct camera *camera,
                        const struct border *border, const struct look *look, struct fault *fault);
void shade_rows(struct rendition *rendition, uint32_t first, uint32_t end,
                const struct camera *camera, const struct border *border,
                const struct palette *palette, const struct look *look, struct shader *shader,
                unsigned number);

#endif
