/* SPDX-License-Identifier: MIT */
/* Phantoms: what is hard for seeds, by formulas in integers.
 *
 *     tube       a bent tube with a branch, 20 % brighter than what is around it, in noise of half
 *                that difference: a barrier full of gaps
 *     textures   a body of coarse grain in a ground of fine grain, whose means differ by a tenth of
 *                what the grain does, under a bias along all axes
 *     shells     a ball of shells, dark and bright in turn: its inner edges are as strong as its
 *                own border
 *     neck       a ball, joined to another of the same grey by a neck of half its width: there is
 *                no border where it ends
 *     fading     an ellipsoid that fades into the ground over 8 voxels, in noise: its border is
 *                where it has half its brightness
 *     ct         an abdomen in Hounsfield units, so that greys of the whole scene are coarse: air,
 *                fat and muscle of the body, a spine and a rib, a screw of metal; and six objects
 *                40 to 120 HU brighter or darker than what they touch, in noise of 12 HU */
#include <string.h>

#include "base/hash.h"
#include "tests/bench/effort_object.h"

enum { SIDE = PHANTOM_SIDE, MIDDLE = SIDE / 2 };

/* The sum of four even bytes, nearly normal, with the standard deviation `sigma`. */
static int noise(uint64_t place, int sigma)
{
    const uint64_t mix = hash_mix_at(place, 72);
    int sum = -510;
    for (int i = 0; i < 4; i++)
        sum += (int)(mix >> 8 * i & 255);
    return sum * sigma / 148;
}

/* Squared distance in 64ths of a voxel from p to the line between a and b. */
static int64_t away(const int p[3], const int a[3], const int b[3])
{
    int64_t along = 0, length = 0, squared = 0;
    for (int i = 0; i < 3; i++) {
        along += (int64_t)(p[i] - a[i]) * (b[i] - a[i]);
        length += (int64_t)(b[i] - a[i]) * (b[i] - a[i]);
    }
    along = along < 0 ? 0 : along > length ? length : along;
    for (int i = 0; i < 3; i++) {
        const int64_t d = 64 * (p[i] - a[i]) - 64 * along * (b[i] - a[i]) / length;
        squared += d * d;
    }
    return squared;
}

static bool is_in_tube(const int p[3])
{
    static const int corner[][3] = {{12, 16, 14}, {24, 40, 22}, {42, 46, 38},
                                    {58, 24, 58}, {33, 43, 30}, {22, 54, 56}};
    static const struct {
        int from, to, radius;
    } part[] = {{0, 1, 5}, {1, 2, 5}, {2, 3, 4}, {4, 5, 3}};
    for (size_t i = 0; i < sizeof part / sizeof *part; i++)
        if (away(p, corner[part[i].from], corner[part[i].to]) <=
            (int64_t)part[i].radius * part[i].radius * 64 * 64)
            return true;
    return false;
}

static int square(int x)
{
    return x * x;
}

static int value_of(enum phantom phantom, const int p[3], bool *is_object)
{
    const uint64_t place = (uint64_t)((p[2] * SIDE + p[1]) * SIDE + p[0]);
    if (phantom == PHANTOM_TUBE) {
        *is_object = is_in_tube(p);
        return (*is_object ? 120 : 100) + noise(place, 10);
    }
    if (phantom == PHANTOM_TEXTURES) {
        /* A body with a dent: one ball without another. */
        *is_object =
            square(p[0] - MIDDLE) + square(p[1] - MIDDLE) + square(p[2] - MIDDLE) <= square(20) &&
            square(p[0] - 52) + square(p[1] - 46) + square(p[2] - 40) > square(12);
        const uint64_t grain =
            *is_object ? (uint64_t)((p[2] / 3 * SIDE + p[1] / 3) * SIDE + p[0] / 3) : place;
        return (*is_object ? 126 : 122) + noise(grain, 20) / (*is_object ? 1 : 2) +
               (p[0] + p[1] / 2 + p[2] / 2) / 3;
    }
    if (phantom == PHANTOM_NECK) {
        const int ball = square(p[0] - 26) + square(p[1] - MIDDLE) + square(p[2] - MIDDLE);
        const int twin = square(p[0] - 52) + square(p[1] - MIDDLE) + square(p[2] - MIDDLE);
        const bool is_neck =
            p[0] > 26 && p[0] < 52 && square(p[1] - MIDDLE) + square(p[2] - MIDDLE) <= square(7);
        *is_object = ball <= square(14);
        return (*is_object || is_neck || twin <= square(12) ? 130 : 90) + noise(place, 12);
    }
    if (phantom == PHANTOM_FADING) {
        const int far = square(p[0] - MIDDLE) + 2 * square(p[1] - MIDDLE) + 3 * square(p[2] - 34);
        int reach = 0;
        while (square(reach) < far)
            reach++;
        *is_object = reach <= 24;
        return 90 + (reach <= 20 ? 40 : reach >= 28 ? 0 : 5 * (28 - reach)) + noise(place, 8);
    }
    const int squared = square(p[0] - 34) + square(p[1] - 36) + square(p[2] - 38);
    int shell = 0;
    while (shell < 4 && squared > square(6 + 6 * shell))
        shell++;
    *is_object = shell < 4;
    return (shell == 4 ? 110 : shell % 2 ? 90 : 140) + noise(place, 6);
}

/* The parts of the abdomen, from the outside in: a later one replaces an earlier one. Radii along
 * the axes are those of an ellipsoid; a part with no radius along z is a cylinder. */
static const struct part {
    int middle[3], radius[3], value, object;
} abdomen[] = {
    {{36, 36, 36}, {35, 30, 0}, -100, 0}, /* fat */
    {{36, 36, 36}, {32, 27, 0}, 50, 0},   /* muscle */
    {{36, 34, 36}, {28, 22, 0}, -90, 0},  /* fat inside */
    {{22, 30, 38}, {15, 15, 26}, 105, 1}, /* liver */
    {{18, 28, 40}, {5, 5, 5}, 60, 5},     /* a lesion in it */
    {{46, 44, 34}, {8, 7, 12}, 160, 2},   /* kidney, which touches muscle and spleen */
    {{55, 30, 40}, {9, 11, 14}, 115, 3},  /* spleen */
    {{36, 30, 30}, {9, 7, 20}, 45, 0},    /* bowel */
    {{36, 49, 36}, {8, 7, 0}, 700, 0},    /* spine */
    {{36, 49, 36}, {4, 4, 0}, 250, 0},    /* its marrow */
    {{38, 38, 36}, {4, 4, 0}, 170, 4},    /* aorta, before the spine */
    {{27, 37, 40}, {2, 2, 30}, 170, 6},   /* a vessel between liver and bowel */
    {{32, 53, 20}, {2, 5, 2}, 2900, 0},   /* a screw */
    {{61, 52, 50}, {4, 4, 5}, 1100, 0},   /* a rib */
};

static bool is_in_part(const struct part *part, const int p[3])
{
    int64_t sum = 0;
    for (int a = 0; a < 3; a++)
        sum +=
            part->radius[a] ? 1000 * square(p[a] - part->middle[a]) / square(part->radius[a]) : 0;
    return sum <= 1000;
}

/* At twice the resolution, so that borders have mixed values. */
static int abdomen_at(int object, const int p[3], bool *is_object)
{
    int sum = 0, inside = 0;
    for (int i = 0; i < 8; i++) {
        int value = -1000, here = 0;
        for (size_t k = 0; k < sizeof abdomen / sizeof *abdomen; k++) {
            struct part twice = abdomen[k];
            for (int a = 0; a < 3; a++)
                twice.middle[a] *= 2, twice.radius[a] *= 2;
            if (!is_in_part(&twice, (const int[]){2 * p[0] + (i & 1), 2 * p[1] + (i >> 1 & 1),
                                                  2 * p[2] + (i >> 2)}))
                continue;
            value = abdomen[k].value;
            here = abdomen[k].object;
        }
        sum += value;
        inside += here == object || (object == 1 && here == 5); /* a liver has its lesion */
    }
    *is_object = inside >= 4;
    return sum / 8 + noise((uint64_t)((p[2] * SIDE + p[1]) * SIDE + p[0]), 12);
}

void phantom_fill(enum phantom phantom, int object, uint16_t *image, uint8_t *truth)
{
    size_t voxel = 0;
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++, voxel++) {
                const int p[3] = {x, y, z};
                bool is_object;
                const int value = phantom == PHANTOM_CT
                                      ? abdomen_at(object, p, &is_object) + HOUNSFIELD_ZERO
                                      : value_of(phantom, p, &is_object);
                image[voxel] = (uint16_t)(value < 0 ? 0 : value);
                truth[voxel] = is_object;
            }
}
