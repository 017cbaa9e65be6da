/* SPDX-License-Identifier: MIT */
/*
 * The look: how people have chosen that surfaces are coloured.
 */
#ifndef RENDER_LOOK_H
#define RENDER_LOOK_H

#include <stddef.h>
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

/*
 * The shader: what shading stores between one picture and the next, so that the next is made
 * faster.
 */
struct shader {
    int32_t window[2];     /* to be set where something is cut: the intensities that are black and
                          white on faces cut open; they differ, and either may be the greater */
    struct team *team;     /* to be set: the threads that share the work, or NULL */
    struct bricks *bricks; /* for ambient occlusion (render/occlusion.h); NULL: none yet */
};

/* Frees what is stored; the shader, whose window and team stay, may be used again. A new one is
 * zeroed. */
void shader_release(struct shader *shader);
size_t shader_bytes(const struct shader *shader);

#endif
