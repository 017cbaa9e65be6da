/* SPDX-License-Identifier: MIT */
/* Check the promises of engine/surface.h for any surface. */
#ifndef TESTS_SURFACE_CHECK_H
#define TESTS_SURFACE_CHECK_H

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/surface.h"

static inline int surface_number_order(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* U1: each edge has one triangle in either direction, and the triangles around each point are one
 * fan. */
static inline bool surface_is_closed(const struct surface *s)
{
    const size_t edges = 3 * s->triangles;
    OWNED(mem_release)
    uint64_t *ahead = calloc(edges + 1, sizeof *ahead), *back = calloc(edges + 1, sizeof *back);
    bool holds = true;
    for (size_t i = 0; i < edges; i++) {
        const uint32_t *point = s->triangle[i / 3].point;
        const uint64_t from = point[i % 3], to = point[(i + 1) % 3];
        holds &= from != to && from < s->points && to < s->points;
        ahead[i] = from << 32 | to;
        back[i] = to << 32 | from;
    }
    qsort(ahead, edges, sizeof *ahead, surface_number_order);
    qsort(back, edges, sizeof *back, surface_number_order);
    for (size_t i = 0; i < edges; i++)
        holds &= ahead[i] == back[i] && (i == 0 || ahead[i - 1] != ahead[i]);
    return holds;
}

/* The triangles around each point are one fan if linking them from one to the next meets all of
 * them. */
static inline bool surface_is_manifold(const struct surface *s)
{
    uint32_t *next = calloc(3 * s->triangles + 1, sizeof *next); /* next corner around the point */
    uint64_t *ahead = calloc(3 * s->triangles + 1, sizeof *ahead);
    uint32_t *fans = calloc(s->points + 1, sizeof *fans);
    uint8_t *seen = calloc(3 * s->triangles + 1, 1);
    bool holds = true;
    /* Index corners by the edge that leaves them, to find the one whose edge comes in. */
    uint32_t *first = calloc(s->points + 2, sizeof *first),
             *corner = calloc(3 * s->triangles + 1, 4);
    for (size_t i = 0; i < 3 * s->triangles; i++)
        first[s->triangle[i / 3].point[i % 3] + 1]++;
    for (size_t p = 0; p < s->points; p++)
        first[p + 1] += first[p];
    uint32_t *at = calloc(s->points + 1, sizeof *at);
    for (size_t i = 0; i < 3 * s->triangles; i++) {
        const uint32_t p = s->triangle[i / 3].point[i % 3];
        corner[first[p] + at[p]++] = (uint32_t)i;
    }
    for (size_t i = 0; i < 3 * s->triangles; i++) {
        const uint32_t *point = s->triangle[i / 3].point;
        const uint32_t p = point[i % 3], before = point[(i + 2) % 3];
        next[i] = UINT32_MAX;
        for (uint32_t k = first[p]; k < first[p + 1]; k++)
            if (s->triangle[corner[k] / 3].point[(corner[k] + 1) % 3] == before)
                next[i] = corner[k];
        holds &= next[i] != UINT32_MAX;
    }
    for (size_t i = 0; i < 3 * s->triangles && holds; i++) {
        if (seen[i])
            continue;
        fans[s->triangle[i / 3].point[i % 3]]++;
        for (uint32_t k = (uint32_t)i; !seen[k]; k = next[k])
            seen[k] = 1;
    }
    for (size_t p = 0; p < s->points; p++)
        holds &= fans[p] == 1;
    free(next), free(ahead), free(fans), free(seen), free(first), free(corner), free(at);
    return holds;
}

static inline int surface_place_order(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct surface_point));
}

static inline bool surface_check(const struct surface *s)
{
    return surface_is_closed(s) && surface_is_manifold(s);
}

/* Return six times the enclosed volume, in 2^-30 voxels, negative if triangles face inwards: the
 * flow of z through them. Sums mod 2^64 hold the result. */
static inline int64_t surface_volume(const struct surface *surface, const struct surface_part *part)
{
    uint64_t sum = 0;
    for (size_t i = part->triangle; i < part->triangle + part->triangles; i++) {
        int64_t at[3][3];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                at[k][a] = surface->point[surface->triangle[i].point[k]].at[a] >> (NET_BITS - 10);
        const int64_t normal = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                               (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
        sum += (uint64_t)(normal * (at[0][2] + at[1][2] + at[2][2]));
    }
    return (int64_t)sum;
}

#endif
