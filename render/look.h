/* SPDX-License-Identifier: MIT */
/*
 * The look: the user's choices for the colouring of surfaces.
 */
#ifndef RENDER_LOOK_H
#define RENDER_LOOK_H

#include <stddef.h>
#include <stdint.h>

enum { SHADE_SAMPLES_MOST = 4, LIGHT_PITCH_MOST = 90000 };

/* The kinds of surface, and their names in commands. */
#define SHADE_MODES "surface|cubes"
enum shade_mode { SHADE_SURFACE, SHADE_CUBES };

struct look {
    enum shade_mode mode;
    int32_t light[2]; /* direction of the light, thousandths of a degree: yaw to the viewer's right,
                         pitch upwards; 0, 0 is from the viewer */
    uint32_t cue_percent; /* loss of light at the far end of the scene, 0..100 */
    uint32_t edges;       /* 0 or 1; all of a look is 32 bits wide, so looks are compared whole */
    uint32_t samples;     /* a pixel is the mean of samples x samples: 1, 2 or 4 */
    uint32_t creases;     /* 0 or 1: each object has its own normals, so that creases show between
                             touching objects; translucent ones always have */
    uint32_t ao_percent;  /* strength of ambient occlusion (render/occlusion.h), 0..100; ignored
                             while a visible object is translucent */
};

/* Smooth surfaces, with the light over the viewer's left shoulder. */
static inline struct look look_default(void)
{
    return (struct look){.light = {-25000, 30000}, .cue_percent = 30, .samples = 1};
}

/*
 * The shader: cached results of shading that speed up the next picture.
 */
struct shader {
    int32_t window[2];     /* must be set if something is cut: the intensities shown as black and
                              white on cut faces; they differ, in either order */
    struct team *team;     /* must be set: the threads that share the work, or NULL */
    struct bricks *bricks; /* for ambient occlusion (render/occlusion.h); NULL: not made yet */
};

/* Free the cached results; window and team stay, and the shader may be used again. A new one is
 * zeroed. */
void shader_release(struct shader *shader);
size_t shader_bytes(const struct shader *shader);

#endif
