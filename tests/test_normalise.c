/* SPDX-License-Identifier: MIT */
/* Normals and light of many surfaces at once equal those of each one. */
#include "tests/check_main.h"

#include "base/least.h"
#include "render/light.h"
#include "tests/stage.h"

/* Random numbers of random size, some of them 0. */
static int32_t random_part(uint64_t *random)
{
    const int32_t part = (int32_t)(check_below(random, UINT32_MAX) >> 1);
    const unsigned bits = check_below(random, 33);
    return (check_below(random, 2) ? part : -part) >> (bits < 32 ? bits : 31);
}

static struct gradients random_gradients(uint64_t *random)
{
    struct gradients g;
    for (int i = 0; i < NORMALISED; i++) {
        const bool alike = check_below(random, 2);
        for (int a = 0; a < 3; a++) {
            g.along[a][i] = random_part(random);
            if (alike && a > 0)
                g.along[a][i] = g.along[0][i] / (int32_t)(1 + check_below(random, 9));
        }
        if (check_below(random, 200) == 0)
            g.along[0][i] = g.along[1][i] = g.along[2][i] = 0;
    }
    return g;
}

/* Check the length against the exact root, to a few units. */
static bool is_right(const struct directions *d, const struct gradients *g, int i)
{
    int16_t one[3] = {0, 0, 0};
    const int64_t gradient[3] = {g->along[0][i], g->along[1][i], g->along[2][i]};
    const bool has_one = normalise_one(one, gradient);
    int64_t squares = 0;
    for (int a = 0; a < 3; a++) {
        squares += one[a] * one[a];
        if (d->along[a][i] != one[a])
            return false;
    }
    const int64_t length = square_root((uint64_t)squares);
    return has_one ? llabs(length - (1 << NORMAL_BITS)) < 4 : squares == 0;
}

STORY(many_gradients_at_once_equal_each_one)
{
    uint64_t random = 1;
    for (unsigned round = 0; round < check_scaled(50000) && check_failures == 0; round++) {
        const struct gradients g = random_gradients(&random);
        struct directions d;
        normalise_all(&d, &g);
        for (int i = 0; i < NORMALISED; i++)
            if (!CHECK(is_right(&d, &g, i)))
                printf("# %d %d %d\n", g.along[0][i], g.along[1][i], g.along[2][i]);
    }
}

STORY(the_longest_and_the_shortest_gradients_are_no_exception)
{
    static const int32_t edge[] = {0,      1,          -1,         2,         -2,        32767,
                                   -32767, 32768,      -32768,     32769,     65535,     -65536,
                                   65537,  0x3fffffff, 0x40000000, INT32_MAX, -INT32_MAX};
    enum { EDGES = sizeof edge / sizeof edge[0] };
    struct gradients g = {0};
    struct directions d;
    unsigned i = 0;
    for (int x = 0; x < EDGES; x++)
        for (int y = 0; y < EDGES; y++)
            for (int z = 0; z < EDGES; z++) {
                g.along[0][i] = edge[x], g.along[1][i] = edge[y], g.along[2][i] = edge[z];
                i = (i + 1) % NORMALISED;
                if (i != 0 && (x < EDGES - 1 || y < EDGES - 1 || z < EDGES - 1))
                    continue;
                normalise_all(&d, &g);
                for (int k = 0; k < NORMALISED; k++)
                    CHECK(is_right(&d, &g, k));
            }
}

/* Light one surface in wide integers: a fifth of the light is ambient, the rest diffuse. */
static void light_surface(uint8_t rgb[3], const struct light *light, const struct lit *lit, int i,
                          const int16_t normal[3])
{
    int64_t toward = 0, mirror = 0;
    for (int a = 0; a < 3; a++) {
        toward += (int64_t)normal[a] * light->toward[a];
        mirror += (int64_t)normal[a] * light->half[a];
    }
    const int64_t cosine = toward < 0 ? 0 : toward >> (2 * NORMAL_BITS - LIGHT_UNIT_BITS);
    const int64_t shine = mirror < 0 ? 0 : mirror >> (2 * NORMAL_BITS - LIGHT_GLOSS_BITS);
    const int64_t gloss = light->gloss[shine > LIGHT_GLOSSES ? LIGHT_GLOSSES : shine];
    const int64_t ambient = LIGHT_UNIT / 5, diffuse = LIGHT_UNIT - ambient;
    const int64_t bright = (ambient + (diffuse * cosine >> LIGHT_UNIT_BITS)) * lit->open[i];
    for (int k = 0; k < 3; k++) {
        const int64_t all = lit->colour[k][i] * (bright >> LIGHT_UNIT_BITS) + gloss;
        const int64_t level = all * lit->cue[i] >> (2 * LIGHT_UNIT_BITS);
        rgb[k] = (uint8_t)(level > 255 ? 255 : level);
    }
}

/* Light from all directions, on surfaces of all colours and directions, at all depths. */
STORY(many_surfaces_at_once_are_lit_like_each_one)
{
    uint64_t random = 2;
    OWNED(stage_release) struct stage s;
    CHECK(stage_init(&s, (uint32_t[]){5, 5, 5}, 6, NULL) == OK);
    for (unsigned round = 0; round < check_scaled(3000) && check_failures == 0; round++) {
        const int32_t angle[2] = {(int32_t)check_below(&random, 360001) - 180000,
                                  (int32_t)check_below(&random, 180001) - 90000};
        const struct gradients g = random_gradients(&random);
        struct directions d;
        struct light light;
        struct lit lit;
        uint8_t rgb[NORMALISED][3];
        for (int i = 0; i < 3; i++)
            s.view.angle[i] = (int32_t)check_below(&random, VIEW_TURN);
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
        light_init(&light, &s.camera, angle, 0);
        normalise_all(&d, &g);
        for (int i = 0; i < NORMALISED; i++) {
            const int16_t normal[3] = {d.along[0][i], d.along[1][i], d.along[2][i]};
            for (int k = 0; k < 3; k++)
                lit.colour[k][i] = (uint8_t)check_below(&random, 256);
            lit.cue[i] = (uint16_t)check_below(&random, LIGHT_UNIT + 1);
            lit.open[i] = (uint16_t)check_below(&random, LIGHT_UNIT + 1);
            light_surface(rgb[i], &light, &lit, i, normal);
        }
        light_surfaces(&lit, &light, &d);
        for (int i = 0; i < NORMALISED; i++)
            for (int k = 0; k < 3; k++)
                CHECK_INT(lit.colour[k][i], rgb[i][k]);
    }
}
