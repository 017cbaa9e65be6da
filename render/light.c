/* SPDX-License-Identifier: MIT */
#include "render/light.h"

#include <string.h>

#include "base/least.h"

enum { BARELY = 64 }; /* smallest cosine to the viewer, as a part of 1 */

/* ---- gradients to normals ---- */

/* Many gradients at once, each to a vector of its direction and of one length. It is a third of
 * the time of a large picture, so it is written as loops over arrays, which the compiler
 * vectorises. All integers, and none that would differ one by one: normalise_one defines the
 * result, and `test_normalise` compares them. */

enum { VECTOR_BITS = 15 }; /* bits of the longest of a gradient's three parts */

bool normalise_one(int16_t direction[3], const int64_t gradient[3])
{
    uint64_t all = 0;
    for (int a = 0; a < 3; a++)
        all |= (uint64_t)(gradient[a] < 0 ? -gradient[a] : gradient[a]);
    if (all == 0)
        return false;
    const int bits = 64 - __builtin_clzll(all);
    int64_t v[3];
    uint64_t squares = 0;
    for (int a = 0; a < 3; a++) {
        v[a] = bits > VECTOR_BITS ? gradient[a] >> (bits - VECTOR_BITS)
                                  : gradient[a] * (1 << (VECTOR_BITS - bits));
        squares += (uint64_t)(v[a] * v[a]);
    }
    const int64_t inverse = inverse_root(squares);
    for (int a = 0; a < 3; a++)
        direction[a] = (int16_t)(v[a] * inverse >> (45 - NORMAL_BITS));
    return true;
}

struct parts {
    uint32_t all[NORMALISED]; /* bitwise or of the absolute values */
    int32_t along[3][NORMALISED];
};

/* Return `one` where bits of `mask` are set, `other` elsewhere. */
static inline uint32_t chosen(uint32_t mask, uint32_t one, uint32_t other)
{
    return (one & mask) | (other & ~mask);
}

/* Shift left by `bits` if the upper `bits` of 31 are unused. */
static inline void shift_left(struct parts *parts, int bits)
{
    for (int i = 0; i < NORMALISED; i++) {
        const uint32_t fits = parts->all[i] >> (31 - bits) ? 0 : UINT32_MAX;
        parts->all[i] = chosen(fits, parts->all[i] << bits, parts->all[i]);
        for (int a = 0; a < 3; a++) {
            const uint32_t part = (uint32_t)parts->along[a][i];
            parts->along[a][i] = (int32_t)chosen(fits, part << bits, part);
        }
    }
}

static inline uint32_t times(uint32_t a, uint32_t b, int shift)
{
    return (uint32_t)((uint64_t)a * b >> shift);
}

WIDE void normalise_all(struct directions *directions, const struct gradients *gradients)
{
    struct directions v;
    uint32_t squares[NORMALISED], root[NORMALISED];
    /* Scale each vector so that its longest component has 31 bits; keep the first VECTOR_BITS. */
    struct parts parts;
    for (int i = 0; i < NORMALISED; i++) {
        parts.all[i] = 0;
        for (int a = 0; a < 3; a++) {
            const int32_t g = parts.along[a][i] = gradients->along[a][i];
            parts.all[i] |= (uint32_t)(g < 0 ? -g : g);
        }
    }
    shift_left(&parts, 16);
    shift_left(&parts, 8);
    shift_left(&parts, 4);
    shift_left(&parts, 2);
    shift_left(&parts, 1);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < NORMALISED; i++)
            v.along[a][i] = (int16_t)(parts.along[a][i] >> (31 - VECTOR_BITS));
    for (int i = 0; i < NORMALISED; i++)
        squares[i] = (uint32_t)(v.along[0][i] * v.along[0][i]) +
                     (uint32_t)(v.along[1][i] * v.along[1][i]) +
                     (uint32_t)(v.along[2][i] * v.along[2][i]);
    /* Compute the roots as inverse_root does. */
    const uint32_t one = UINT32_C(1) << 30;
    for (int i = 0; i < NORMALISED; i++) {
        const uint32_t doubled = squares[i] >> 30 ? 0 : UINT32_MAX;
        const uint32_t x = chosen(doubled, squares[i] << 2, squares[i]);
        const uint32_t low = (uint32_t)(((uint64_t)one * 163 - (uint64_t)x * 37) >> 7);
        const uint32_t high = (uint32_t)(((uint64_t)one * 114 - (uint64_t)x * 13) >> 7);
        uint32_t r = chosen(x >> 31 ? UINT32_MAX : 0, high, low);
        r = times(r, 3 * one - times(x, times(r, r, 30), 30), 31);
        r = times(r, 3 * one - times(x, times(r, r, 30), 30), 31);
        root[i] = chosen(doubled, r << 1, r);
    }
    /* Compute the product of 47 bits by halves of the root. */
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < NORMALISED; i++) {
            const int32_t part = v.along[a][i];
            const int32_t high = part * (int32_t)(root[i] >> 16);
            const int32_t low = part * (int32_t)(root[i] & 0xffff);
            directions->along[a][i] = (int16_t)((high + (low >> 16)) >> (45 - NORMAL_BITS - 16));
        }
}

/* ---- of pixels ---- */

int64_t normal_stride(const struct camera *camera)
{
    const int64_t pixels = (camera->view.zoom + VIEW_ZOOM_ONE / 2) / VIEW_ZOOM_ONE;
    return pixels < 1 ? 1 : pixels;
}

void normals_init(struct normals *normals, const struct camera *camera, const struct mesh *mesh)
{
    drawer_init(&normals->drawer, camera, mesh);
    for (int a = 0; a < 3; a++)
        normals->viewer[a] = -camera->ahead[a] >> (30 - NORMAL_BITS);
}

/* Turn a normal that faces away so that it barely faces the viewer. */
static void turn_to_viewer(struct directions *normal, unsigned i, const struct normals *normals)
{
    int64_t along = 0, across[3];
    int16_t turned[3];
    for (int a = 0; a < 3; a++)
        along += normal->along[a][i] * normals->viewer[a];
    if (along >= (1 << (2 * NORMAL_BITS)) / BARELY)
        return;
    for (int a = 0; a < 3; a++)
        across[a] = normal->along[a][i] - (along * normals->viewer[a] >> (2 * NORMAL_BITS)) +
                    normals->viewer[a] / BARELY;
    const bool has_one = normalise_one(turned, across);
    for (int a = 0; a < 3; a++)
        normal->along[a][i] = has_one ? turned[a] : (int16_t)normals->viewer[a];
}

static inline int64_t share_at(const struct edge_function *e, uint32_t x, uint32_t y)
{
    return e->at + e->right * x + e->down * y;
}

/* Interpolate the normals of the corners. */
static inline void blend_normals(struct gradients *outward, unsigned i, const struct seen *seen,
                                 uint32_t x, uint32_t y)
{
    enum { SHARE_BITS = 15 };
    const int bits = 64 - __builtin_clzll((uint64_t)seen->all | 1);
    const int shift = bits > SHARE_BITS ? bits - SHARE_BITS : 0;
    const int64_t first = share_at(&seen->share[0], x, y), second = share_at(&seen->share[1], x, y);
    const int32_t share[3] = {(int32_t)(first >> shift), (int32_t)(second >> shift),
                              (int32_t)((seen->all - first - second) >> shift)};
    for (int a = 0; a < 3; a++)
        outward->along[a][i] = share[0] * seen->normal[0][a] + share[1] * seen->normal[1][a] +
                               share[2] * seen->normal[2][a];
}

void triangles_init(struct triangles *triangles)
{
    for (unsigned k = 0; k < 1 << TRIANGLES_BITS; k++)
        triangles->seen[k].cell = CELL_NONE;
}

void normals_of(struct directions *out, uint8_t open[NORMALISED], const struct normals *normals,
                struct triangles *triangles, const struct tile_pixels *pixels)
{
    struct gradients outward;
    for (int a = 0; a < 3; a++)
        memset(outward.along[a] + pixels->count, 0,
               (NORMALISED - pixels->count) * sizeof *outward.along[a]);
    for (unsigned i = 0; i < pixels->count; i++) {
        const uint32_t cell = pixels->cell[i];
        const unsigned number = (unsigned)(pixels->depth[i] & NUMBER_MASK);
        const uint32_t mixed = cell * (NUMBER_MASK + 1) + number;
        struct seen *seen = &triangles->seen[mixed * UINT32_C(2654435769) >> (32 - TRIANGLES_BITS)];
        if (seen->cell != cell || seen->number != number)
            drawer_triangle(&normals->drawer, seen, number, cell);
        open[i] = seen->open;
        if (!open[i]) {
            blend_normals(&outward, i, seen, pixels->x[i], pixels->y[i]);
            continue;
        }
        for (unsigned a = 0; a < 3; a++)
            outward.along[a][i] = a == (number >> 2) ? (number & 2 ? 1 : -1) : 0;
    }
    normalise_all(out, &outward);
    for (unsigned i = 0; i < pixels->count; i++)
        turn_to_viewer(out, i, normals);
}

enum {
    AMBIENT = LIGHT_UNIT / 5,
    DIFFUSE = LIGHT_UNIT - AMBIENT,
    SPECULAR = 70, /* 0..255, in the direction of the mirrored light */
    SHINE = 5,     /* squarings: the exponent is 2^5 */
    CUE_BITS = 20,
};

/* ---- its direction ---- */

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
    /* Light from straight ahead has no half-way vector; no visible surface mirrors it. */
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
        /* Project half the scene's length along this axis onto the ray. */
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

/* ---- lit surfaces ---- */

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

/* Products fit into 32 bits: larger ones are computed in two halves. */
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
