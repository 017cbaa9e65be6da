/*
 * Shading: the colour of each pixel, by Phong's model, in integers.
 *
 * The normal at a visible voxel is the direction in which what is shown thins out: the gradient
 * of the shown voxels smoothed by a binomial kernel over SHADE_RADIUS voxels each way. So shading
 * is a pure function of what is shown within that radius, of the labels' colours, and of the view;
 * the incremental image relies on it. The light stands over the viewer's left shoulder. What lies
 * deeper is a little darker.
 */
#ifndef RENDER_SHADE_H
#define RENDER_SHADE_H

#include "render/rendition.h"

enum { SHADE_RADIUS = 3 };

struct palette {
    uint8_t rgb[256][3]; /* sRGB, per label */
};

/* Distinct colours that people who cannot tell red from green tell apart too, in turn. */
void palette_default(struct palette *palette);

/* Shades every stale tile and marks it fresh. */
void shade(struct rendition *rendition, const struct camera *camera, const struct border *border,
           const struct palette *palette);

#endif
