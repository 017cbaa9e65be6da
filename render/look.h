/* SPDX-License-Identifier: MIT */
/*
 * The look: how people have chosen that surfaces are coloured.
 */
#ifndef RENDER_LOOK_H
#define RENDER_LOOK_H

#include <stdint.h>

enum { SHADE_SAMPLES_MOST = 4, LIGHT_PITCH_MOST = 90000 };

/* What is shown of an object, and what commands call it. */
#define SHADE_MODES "surface|cubes"
enum shade_mode { SHADE_SURFACE, SHADE_CUBES };

struct look {
    enum shade_mode mode;
    int32_t light[2]; /* where it comes from, thousandths of a degree: yaw to the viewer's right,
                         pitch above him; 0, 0 is from where he stands */
    uint32_t cue_percent; /* how much darker the far end of the scene is, 0..100 */
    uint32_t edges;       /* 0 or 1; all of a look is 32 bits wide, so looks are compared whole */
    uint32_t samples;     /* a pixel is the mean of samples x samples: 1, 2 or 4 */
    uint32_t creases;     /* 0 or 1: whether each object has normals of its own, so that a crease is
                             seen where two touch; translucent ones always have */
    uint32_t ao_percent;  /* of ambient occlusion (render/occlusion.h), 0..100; of no consequence
                             where something is translucent */
};

/* Surface; the light over the viewer's left shoulder. */
static inline struct look look_default(void)
{
    return (struct look){.light = {-25000, 30000}, .cue_percent = 30, .samples = 1};
}

#endif
