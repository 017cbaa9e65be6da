/* SPDX-License-Identifier: MIT */
#include "engine/net_parts.h"

#include <pthread.h>
#include <string.h>

#include "engine/net_source.h"

/* Which corners hang together with the lowest of `left` by faces, through `left`. */
static uint8_t grown_from(uint8_t left)
{
    uint32_t grown = (uint32_t)(left & -left), before;
    do {
        before = grown;
        for (uint32_t c = 0; c < NET_CORNERS; c++)
            if (grown >> c & 1)
                grown |= left & (1U << (c ^ 1) | 1U << (c ^ 2) | 1U << (c ^ 4));
    } while (grown != before);
    return (uint8_t)grown;
}

/* Halves away from 0: a mirrored cube has the mirrored mean. */
static int16_t mean_of(int32_t sum, int32_t count)
{
    return (int16_t)((2 * sum + (sum < 0 ? -count : count)) / (2 * count));
}

/* Through air on the side that has a crossing there, and is not closed. Two parts of such a side
 * lie across its middle from each other: where the other two corners are of the object. */
static void find_links(struct net_part *part, int axis, uint8_t air, uint8_t closed)
{
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const int corner[4] = {0, u, v, u | v};
    int count = 0;
    memset(part->link[axis], NET_UNLINKED, sizeof part->link[axis]);
    for (int i = 0; i < 4; i++) {
        const int c = corner[i];
        const bool beside_u = !(air >> (c ^ u) & 1), beside_v = !(air >> (c ^ v) & 1);
        if (!(part->air >> c & 1) || closed >> c & 1 || !(beside_u || beside_v))
            continue;
        if (count == 0 || (beside_u && beside_v && part->link[axis][0] == (c ^ u ^ v)))
            part->link[axis][count++] = (uint8_t)c;
    }
}

void net_cube_init(struct net_cube *cube, uint8_t air, uint8_t closed)
{
    uint8_t left = air == UINT8_MAX ? 0 : air;
    memset(cube, 0, sizeof *cube);
    while (left) {
        struct net_part *part = &cube->part[cube->count++];
        part->air = grown_from(left);
        left = (uint8_t)(left & ~part->air);
        int32_t sum[3] = {0}, crossings = 0;
        for (int c = 0; c < NET_CORNERS; c++)
            for (int a = 0; a < 3 && part->air >> c & 1; a++) {
                const int other = c ^ 1 << a;
                if (air >> other & 1)
                    continue;
                if (closed >> c & 1) {
                    part->lock |= (uint8_t)(1 << a);
                    continue;
                }
                part->lock |= NET_NATURAL;
                part->normal[a] = (int8_t)(part->normal[a] + (c >> a & 1 ? 1 : -1));
                for (int k = 0; k < 3; k++)
                    sum[k] += ((c >> k & 1) + (other >> k & 1) - 1) * (NET_ONE / 2);
                crossings++;
            }
        for (int k = 0; k < 3 && crossings > 0; k++)
            part->start[k] = part->lock >> k & 1 ? 0 : mean_of(sum[k], crossings);
        for (int a = 0; a < 3; a++)
            find_links(part, a, air, closed);
    }
}

static struct net_cube cubes[256];

static void make_cubes(void)
{
    for (int air = 0; air < 256; air++)
        net_cube_init(&cubes[air], (uint8_t)air, 0);
}

const struct net_cube *net_cubes(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, make_cubes);
    return cubes;
}
