#include "base/polyline.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void polyline_release(struct polyline *line)
{
    free(line->corner);
    *line = (struct polyline){0};
}

/* Whether one goes straight on at b: from a to it, and from it to c. */
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
