/* SPDX-License-Identifier: MIT */
/* Bytes as labels, and as how their surfaces are made: these are closed whatever the labels are,
 * also once they are reduced. The first bytes are the size, which kind of surface, the triangles
 * that may be left, and how many labels there are. */
#include "tests/fuzz/fuzz.h"

#include "tests/surface_check.h"

enum { OPTIONS = 6 };

struct labels {
    uint32_t size[3];
    const uint8_t *bytes;
    size_t length;
    unsigned most;
};

static void row(void *context, uint32_t y, uint32_t z, uint8_t *label)
{
    const struct labels *labels = context;
    for (uint32_t x = 0; x < labels->size[0]; x++) {
        const size_t at = x + labels->size[0] * (y + (size_t)labels->size[1] * z);
        label[x] = (uint8_t)(at < labels->length ? labels->bytes[at] % (labels->most + 1) : 0);
    }
}

static void check(const struct surface *surface)
{
    HOLDS(surface_is_closed(surface) && surface_is_manifold(surface));
    for (size_t i = 0; i < surface->triangles; i++)
        for (int corner = 0; corner < 3; corner++)
            HOLDS(surface->triangle[i].point[corner] < surface->points);
}

void fuzz_surface(const uint8_t *bytes, size_t length)
{
    OWNED(surface_drop) struct surface *surface = NULL;
    struct surface_choice choice;
    if (length < OPTIONS)
        return;
    struct labels labels = {{1 + bytes[0] % 12u, 1 + bytes[1] % 12u, 1 + bytes[2] % 12u},
                            bytes + OPTIONS,
                            length - OPTIONS,
                            1 + bytes[5] % 255u};
    const struct surface_source source = {labels.size, row, &labels};
    choice.joins = bytes[3] & 2;
    choice.is_cubes = bytes[3] & 1;
    memset(choice.wanted, true, sizeof choice.wanted);
    choice.wanted[0] = choice.wanted[7] = false;
    HOLDS(surface_new(&surface, &source, &choice, NULL, NULL) == OK);
    check(surface);
    HOLDS(surface_reduce(surface, 4u * bytes[4], NULL, NULL) == OK);
    check(surface);
}
