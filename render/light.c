/* SPDX-License-Identifier: MIT */
#include "render/light.h"

#include "base/least.h"
#include "engine/weight_gradient.h"

enum {
    AMBIENT = LIGHT_UNIT / 5,
    DIFFUSE = LIGHT_UNIT - AMBIENT,
    SPECULAR = 70, /* of 255, where the light is mirrored into the eye */
    SHINE = 5,     /* squarings: the exponent is 2^5 */
    CUE_BITS = 20,
};

/* ---- where it comes from ---- */

void light_init(struct light *light, const struct camera *camera, const int32_t angle[2],
                uint32_t cue_percent)
{
    int64_t reach = 0;
    *light = (struct light){0};
    const int64_t pitch = angle[1], quarter = VIEW_TURN / 4;
    const int64_t level = view_sine((int32_t)(pitch + quarter));
    const int64_t right = times30(view_sine(angle[0]), level);
    const int64_t behind = times30(view_sine((int32_t)(angle[0] + quarter)), level);
    const int64_t up = view_sine((int32_t)pitch);
    int64_t half[3];
    uint64_t squares = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t along = times30(right, camera->right[a]) + times30(up, camera->up[a]) -
                              times30(behind, camera->ahead[a]);
        light->toward[a] = (int32_t)(along >> (30 - NORMAL_BITS));
        half[a] = (along - camera->ahead[a]) >> (30 - NORMAL_BITS);
        squares += (uint64_t)(half[a] * half[a]);
    }
    /* Light from straight ahead has no half-way vector, and is mirrored by nothing that is seen. */
    const int64_t length = squares ? square_root(squares) : 1;
    for (int a = 0; a < 3; a++)
        light->half[a] = (int32_t)(half[a] * (1 << NORMAL_BITS) / length);
    for (int64_t i = 0; i <= LIGHT_GLOSSES; i++) {
        int64_t mirrored = i * LIGHT_UNIT / LIGHT_GLOSSES;
        for (int k = 0; k < SHINE; k++)
            mirrored = mirrored * mirrored / LIGHT_UNIT;
        light->gloss[i] = (int32_t)(SPECULAR * mirrored);
    }
    for (int a = 0; a < 3; a++) {
        /* Half the scene's length along this axis, seen along the ray. */
        int64_t pixels = (int64_t)camera->scene->grid.size[a] * camera->view.zoom *
                         (int64_t)(camera->scene->spacing_nm[a] / (uint32_t)camera->unit_nm) / 1000;
        reach += pixels * (camera->ahead[a] < 0 ? -camera->ahead[a] : camera->ahead[a]) >> 31;
    }
    light->front = -(reach << 26);
    light->depth_range = (reach + 1) << 27;
    while (light->depth_range >> light->cue_shift >> CUE_BITS)
        light->cue_shift++;
    light->cue = ((int64_t)LIGHT_UNIT * cue_percent / 100 << CUE_BITS) /
                 ((light->depth_range >> light->cue_shift) + 1);
}

/* ---- what it makes of a surface ---- */

int64_t light_cue(const struct light *light, int64_t depth)
{
    int64_t behind = depth - light->front;
    behind = behind < 0 ? 0 : behind > light->depth_range ? light->depth_range : behind;
    return LIGHT_UNIT - ((behind >> light->cue_shift) * light->cue >> CUE_BITS);
}

static inline void dots(int32_t dot[NORMALISED], const struct directions *normals,
                        const int32_t way[3])
{
    const int16_t x = (int16_t)way[0], y = (int16_t)way[1], z = (int16_t)way[2];
    for (int i = 0; i < NORMALISED; i++)
        dot[i] = normals->along[0][i] * x + normals->along[1][i] * y + normals->along[2][i] * z;
}

/* In products that fit into 32 bits: of two halves where they would not. */
WIDE void light_surfaces(struct lit *lit, const struct light *light,
                         const struct directions *normals)
{
    enum { LOW = 12 };
    int32_t toward[NORMALISED], mirror[NORMALISED], gloss[NORMALISED];
    dots(toward, normals, light->toward);
    dots(mirror, normals, light->half);
    for (int i = 0; i < NORMALISED; i++) {
        const int32_t shine = mirror[i] < 0 ? 0 : mirror[i] >> (2 * NORMAL_BITS - LIGHT_GLOSS_BITS);
        gloss[i] = light->gloss[shine > LIGHT_GLOSSES ? LIGHT_GLOSSES : shine];
    }
    for (int i = 0; i < NORMALISED; i++) {
        const int32_t cosine =
            (toward[i] < 0 ? 0 : toward[i]) >> (2 * NORMAL_BITS - LIGHT_UNIT_BITS);
        const int32_t bright = AMBIENT + (DIFFUSE * cosine >> LIGHT_UNIT_BITS);
        toward[i] = bright * lit->open[i] >> LIGHT_UNIT_BITS;
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < NORMALISED; i++) {
            const int32_t all = lit->colour[k][i] * toward[i] + gloss[i], cue = lit->cue[i];
            const int32_t high = (all >> LOW) * cue, low = (all & ((1 << LOW) - 1)) * cue;
            const int32_t v = (high + (low >> LOW)) >> (2 * LIGHT_UNIT_BITS - LOW);
            lit->colour[k][i] = (uint8_t)(v > 255 ? 255 : v);
        }
}

void light_flat(uint8_t rgba[4], const uint8_t colour[3], int64_t cue)
{
    for (int k = 0; k < 3; k++)
        rgba[k] = (uint8_t)(colour[k] * cue >> LIGHT_UNIT_BITS);
    rgba[3] = 255;
}
