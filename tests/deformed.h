/* SPDX-License-Identifier: MIT */
/* Subjects that are made of one scene: turned, stretched, bent, noisy, unevenly lit, mirrored, cut;
 * the way back to it is known. */
#ifndef TESTS_DEFORMED_H
#define TESTS_DEFORMED_H

#include <math.h>
#include <stdlib.h>

#include "base/hash.h"
#include "base/mem.h"
#include "image/volume_format.h"
#include "apply/registration.h"

struct deformation {
    double degrees[3], scale[3], shift_mm[3]; /* about the middle of the scene; no scale: 1 */
    double elastic_mm;                        /* at most, along each axis */
    double noise, bias;                       /* parts of the brightest, and of each */
    bool mirrored;          /* left and right are swapped in the file, not in what it means */
    uint32_t first, planes; /* axial ones that are kept; 0: all */
    enum { OF_SCENE, OF_NOTHING, OF_NOISE } content;
};

struct subject {
    struct scene *scene;
    struct geometry geometry;
    double brightest;    /* of the scene that it was made from */
    struct affine truth; /* subject's world -> the scene's, without the elastic part */
};

static inline struct placed_scene subject_placed(const struct subject *subject)
{
    return (struct placed_scene){subject->scene, &subject->geometry};
}

static inline struct affine deformed_truth(const struct deformation *d, const double middle[3])
{
    struct affine out = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (int a = 0; a < 3; a++) {
        const double angle = d->degrees[a] * acos(-1) / 180, c = cos(angle), s = sin(angle);
        struct affine turn = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
        const int i = (a + 1) % 3, j = (a + 2) % 3;
        turn.m[i][i] = turn.m[j][j] = c;
        turn.m[i][j] = -s;
        turn.m[j][i] = s;
        affine_compose(&out, &turn, &out);
    }
    for (int i = 0; i < 3; i++) {
        out.m[i][3] = middle[i] + d->shift_mm[i];
        for (int j = 0; j < 3; j++) {
            out.m[i][j] *= d->scale[j] != 0 ? d->scale[j] : 1;
            out.m[i][3] -= out.m[i][j] * middle[j];
        }
    }
    return out;
}

/* Smooth, at most 1 and at least -1; another for each `which`. */
static inline double wave(const double mm[3], int which)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        const double phase = 1.7 * which + 2.3 * k;
        sum += sin(mm[k] / (17 + 3 * which + k) + 0.6 * mm[(k + 1) % 3] / 23 + phase);
    }
    return sum / 3;
}

/* Between the eight voxels about a place; 0 outside. */
static inline double value_between(const struct volume *base, const double at[3])
{
    double sum = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        size_t index = 0, step = 1;
        double part = 1;
        for (unsigned a = 0; a < 3; a++) {
            const double low = floor(at[a]), place = low + (corner >> a & 1);
            part *= corner >> a & 1 ? at[a] - low : 1 - (at[a] - low);
            if (place < 0 || place >= base->size[a])
                part = 0;
            else
                index += step * (size_t)place;
            step *= base->size[a];
        }
        sum += part > 0 ? part * base->intensity[index] : 0;
    }
    return sum;
}

static inline double chance(uint64_t voxel)
{
    double sum = 0;
    for (uint64_t i = 0; i < 4; i++)
        sum += (double)(hash_mix_at(voxel, i) >> 11) / 0x1p53 - 0.5;
    return sum * 1.7; /* a deviation of 1 */
}

static inline double subject_value(const struct volume *base, const struct subject *subject,
                                   const struct deformation *d, const uint32_t place[3],
                                   uint64_t voxel)
{
    double mm[3], from[3], at[3];
    geometry_point(&subject->geometry, place, mm);
    affine_apply(&subject->truth, mm, from);
    for (int i = 0; i < 3; i++)
        from[i] += d->elastic_mm * wave(mm, i) - base->geometry.to_mm[i][3];
    geometry_solve(&base->geometry, from, at);
    const double value = value_between(base, at) * (1 + d->bias * wave(mm, 3));
    return value + d->noise * subject->brightest * chance(voxel) * (value > 0 ? 1 : 0.3);
}

/* On the grid of the base, `factor` times as coarse. The caller frees the scene. */
static inline enum err subject_make(struct subject *out, const struct volume *base,
                                    const struct deformation *d, uint32_t factor)
{
    uint32_t size[3], middle[3];
    double middle_mm[3];
    size_t voxels = 1;
    for (int a = 0; a < 3; a++) {
        size[a] = base->size[a] / factor;
        middle[a] = base->size[a] / 2;
    }
    size[2] = d->planes ? d->planes : size[2];
    for (int a = 0; a < 3; a++)
        voxels *= size[a];
    out->geometry = base->geometry;
    const double half = (factor - 1) / 2.0, step = factor;
    geometry_derive(&out->geometry, (double[3]){half, half, half + step * d->first},
                    (double[3]){step, step, step});
    geometry_point(&base->geometry, middle, middle_mm);
    out->truth = deformed_truth(d, middle_mm);
    out->brightest = 1;
    for (size_t i = 0; i < (size_t)base->size[0] * base->size[1] * base->size[2]; i++)
        out->brightest = fmax(out->brightest, base->intensity[i]);
    uint16_t *intensity = mem_array(voxels, sizeof *intensity);
    if (!intensity)
        return ERR_MEMORY;
    for (size_t i = 0; i < voxels; i++) {
        uint32_t place[3] = {(uint32_t)(i % size[0]), (uint32_t)(i / size[0] % size[1]),
                             (uint32_t)(i / size[0] / size[1])};
        if (d->mirrored)
            place[0] = size[0] - 1 - place[0];
        double value = d->content == OF_SCENE   ? subject_value(base, out, d, place, i)
                       : d->content == OF_NOISE ? UINT16_MAX * (0.5 + chance(i) / 8)
                                                : 1000;
        value = fmin(fmax(value, 0), UINT16_MAX);
        intensity[i] = (uint16_t)value;
    }
    return scene_new_plain(&out->scene, size, intensity, NULL, NULL);
}

/* The largest error of a map in the head: at the corners of a box of 140 mm about the middle. */
static inline double subject_error(const struct subject *subject, const struct affine *found)
{
    const double low[3] = {-60, -90, -50}, high[3] = {60, 60, 70};
    double most = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        double from[3], to[3], is[3];
        for (unsigned i = 0; i < 3; i++)
            from[i] = corner >> i & 1 ? high[i] : low[i];
        affine_apply(&subject->truth, from, to);
        affine_apply(found, from, is);
        most = fmax(most, hypot(hypot(to[0] - is[0], to[1] - is[1]), to[2] - is[2]));
    }
    return most;
}

#endif
