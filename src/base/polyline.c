/* SPDX-License-Identifier: MIT */
#include "base/polyline.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void polyline_release(struct polyline *line)
{
    free(line->corner);
    *line = (struct polyline){0};
}

/* Return true if the line continues straight at b, from a to c. */
static bool is_straight(const uint32_t a[3], const uint32_t b[3], const uint32_t c[3])
{
    int64_t to[3], on[3];
    bool ahead = false;
    for (int i = 0; i < 3; i++) {
        to[i] = (int64_t)b[i] - a[i];
        on[i] = (int64_t)c[i] - b[i];
        ahead |= to[i] != 0 && (to[i] < 0) == (on[i] < 0) && on[i] != 0;
    }
    return ahead && to[0] * on[1] == to[1] * on[0] && to[1] * on[2] == to[2] * on[1] &&
           to[2] * on[0] == to[0] * on[2];
}

bool polyline_add(struct polyline *line, const uint32_t place[3])
{
    const size_t n = line->count;
    if (n > 0 && memcmp(line->corner[n - 1], place, sizeof line->corner[0]) == 0)
        return true;
    if (n > 1 && is_straight(line->corner[n - 2], line->corner[n - 1], place)) {
        memcpy(line->corner[n - 1], place, sizeof line->corner[0]);
        return true;
    }
    if (!mem_grow(&line->corner, &line->capacity, n + 1, sizeof *line->corner))
        return false;
    memcpy(line->corner[line->count++], place, sizeof line->corner[0]);
    return true;
}

/* ---- fewer corners ---- */

enum {
    LENGTH_MOST = 16384, /* length of a segment, in voxels: products stay below 2^63 */
    CORNERS_AHEAD = 64   /* that one segment may replace */
};

static int64_t dot(const int64_t a[3], const int64_t b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(int64_t out[3], const uint32_t a[3], const uint32_t b[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (int64_t)a[i] - b[i];
}

/* Return true if p is within half a voxel of the segment from a to b. */
static bool is_near(const uint32_t p[3], const uint32_t a[3], const uint32_t b[3])
{
    int64_t way[3], from[3], to[3];
    subtract(way, b, a);
    subtract(from, p, a);
    subtract(to, p, b);
    const int64_t along = dot(from, way), length = dot(way, way);
    if (along <= 0 || along >= length) /* places are integers: if an end is nearest, p must equal it
                                          */
        return dot(along <= 0 ? from : to, along <= 0 ? from : to) == 0;
    return 4 * (dot(from, from) * length - along * along) <= length;
}

/* Return true if the segment between two corners can replace those between them. */
static bool spans(const struct polyline *line, size_t first, size_t last)
{
    const uint32_t(*corner)[3] = (const uint32_t(*)[3])line->corner;
    for (int a = 0; a < 3; a++)
        if (llabs((int64_t)corner[last][a] - corner[first][a]) > LENGTH_MOST)
            return false;
    for (size_t i = first + 1; i < last; i++)
        if (!is_near(corner[i], corner[first], corner[last]))
            return false;
    return true;
}

void polyline_simplify(struct polyline *line)
{
    size_t kept = 0;
    for (size_t first = 0, next; first + 1 < line->count; first = next) {
        next = first + 1;
        for (size_t i = next + 1; i < line->count && i <= first + CORNERS_AHEAD; i++)
            if (spans(line, first, i))
                next = i;
        memcpy(line->corner[++kept], line->corner[next], sizeof line->corner[0]);
    }
    line->count = line->count ? kept + 1 : 0;
}
