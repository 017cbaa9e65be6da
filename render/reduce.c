#include "render/rendition.h"

#include <string.h>

#include "engine/gradient.h"

/* Of one pixel: what lies nearest, and sums of squares of the colours. */
struct mean {
    size_t nearest;
    uint32_t seen, squares[3];
};

static struct mean mean_of(const struct rendition *fine, size_t first, uint32_t samples)
{
    struct mean mean = {.nearest = first};
    for (uint32_t j = 0; j < samples; j++)
        for (uint32_t i = 0; i < samples; i++) {
            const size_t at = first + (size_t)j * fine->width + i;
            const uint8_t *rgba = fine->rgba + 4 * at;
            if (fine->depth[at] < fine->depth[mean.nearest])
                mean.nearest = at;
            mean.seen += fine->cell[at] != CELL_NONE;
            for (int k = 0; k < 3; k++)
                mean.squares[k] += (uint32_t)rgba[k] * rgba[k];
        }
    return mean;
}

void rendition_reduce(struct rendition *out, const struct rendition *fine, uint32_t samples)
{
    const uint32_t all = samples * samples;
    for (uint32_t y = 0; y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++) {
            const size_t to = (size_t)y * out->width + x;
            const size_t first = ((size_t)y * fine->width + x) * samples;
            const struct mean mean = mean_of(fine, first, samples);
            out->depth[to] = fine->depth[mean.nearest];
            out->cell[to] = fine->cell[mean.nearest];
            out->label[to] = fine->label[mean.nearest];
            memcpy(out->normal + 4 * to, fine->normal + 4 * mean.nearest, 4 * sizeof *out->normal);
            for (int k = 0; k < 3; k++)
                out->rgba[4 * to + (size_t)k] =
                    (uint8_t)square_root(mean.seen ? mean.squares[k] / mean.seen : 0);
            out->rgba[4 * to + 3] = (uint8_t)((mean.seen * 255 + all / 2) / all);
        }
}
