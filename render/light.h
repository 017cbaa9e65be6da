/* SPDX-License-Identifier: MIT */
/*
 * Light: the colour of a lit surface, by Phong's model, and darker the further away it is.
 *
 * The light moves with the viewer. Vectors lie along voxel axes, and 2^NORMAL_BITS is 1.
 */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H

#include "render/normal.h"

enum {
    LIGHT_UNIT_BITS = 15,
    LIGHT_UNIT = 1 << LIGHT_UNIT_BITS, /* 1 of a brightness */
    LIGHT_GLOSS_BITS = 10,
    LIGHT_GLOSSES = 1 << LIGHT_GLOSS_BITS, /* different cosines */
};

struct light {
    int32_t toward[3], half[3];
    int64_t front, depth_range; /* of the scene, in crossings */
    int64_t cue;                /* how much the far end loses, over (depth_range >> cue_shift) */
    unsigned cue_shift;
    int32_t gloss[LIGHT_GLOSSES + 1]; /* by the cosine to `half`, times LIGHT_UNIT */
};

/* From `angle`, thousandths of a degree: yaw to the viewer's right, pitch above him. The far end of
 * the scene is darker by `cue_percent`. */
void light_init(struct light *light, const struct camera *camera, const int32_t angle[2],
                uint32_t cue_percent);

/* What the depth leaves of a colour, of LIGHT_UNIT. */
int64_t light_cue(const struct light *light, int64_t depth);

/* Many surfaces at once: `colour` is [red, green, blue][which], of surfaces and then of pixels.
 * `open` of the ambient and diffuse light comes to each, and the depth leaves `cue` of its colour:
 * both 0..LIGHT_UNIT. */
struct lit {
    uint8_t colour[3][NORMALISED];
    uint16_t open[NORMALISED], cue[NORMALISED];
};
void light_surfaces(struct lit *lit, const struct light *light, const struct directions *normals);

/* The colour of one that is as bright from every side. */
void light_flat(uint8_t rgba[4], const uint8_t colour[3], int64_t cue);

#endif
