/*
 * The look: how people have chosen that surfaces are coloured.
 *
 * Looks have numbers: what is drawn under one stays as it is, so that images that were made under
 * it can be made again. A session draws under that of its journal's semantics. From look 2 on
 * surfaces are smooth; from look 3 on most of their pixels lie in patches (render/patch.h), and
 * pits and rims of cuts are looked at closely (render/refine.h); from look 4 on one sample stands
 * for a pixel where a patch shows one object, blocks of tiles are patches, and layers of
 * translucent objects are smooth too where voxels are large (render/layers.h).
 */
#ifndef RENDER_LOOK_H
#define RENDER_LOOK_H

#include <stdbool.h>
#include <stdint.h>

enum { LOOK_FIRST = 1, LOOK_SECOND, LOOK_THIRD, LOOK_PRESENT };

enum { SHADE_SAMPLES_MOST = 4, LIGHT_PITCH_MOST = 90000 };

/* What is shown of an object, and what commands call it. The last two are nobody's any more. */
#define SHADE_MODES "surface|cubes"
enum shade_mode { SHADE_SURFACE, SHADE_CUBES, SHADE_SCENE, SHADE_DEPTH };

struct look {
    uint32_t number; /* LOOK_FIRST..LOOK_PRESENT */
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
static inline struct look look_default(uint32_t number)
{
    return (struct look){
        .number = number, .light = {-25000, 30000}, .cue_percent = 30, .samples = 1};
}

/* Whether it shows surfaces between voxel centres (render/refine.h), for which a border has a skin:
 * what is not of cubes, from look 2 on. What the border has no skin for is shown as cubes, and so
 * are translucent objects where their layers are not refined. */
static inline bool look_is_refined(const struct look *look)
{
    return look->number > LOOK_FIRST && look->mode != SHADE_CUBES;
}

#endif
