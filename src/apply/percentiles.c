/* SPDX-License-Identifier: MIT */
#include "apply/percentiles.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/scene.h"
#include "image/levels.h"

enum { INTENSITIES = UINT16_MAX + 1 };

double percentiles_value(const struct session *session, uint32_t cell)
{
    return levels_value(session_geometry(session), session_levels(session),
                        session_scene(session)->cell[cell].intensity);
}

/* The least intensity that a tenth of `tenths` of the voxels do not exceed. */
static uint16_t find(const uint32_t *count, uint64_t voxels, unsigned tenths)
{
    uint64_t below = 0;
    unsigned at = 0;
    while (at < UINT16_MAX && (below += count[at]) * 10 < voxels * tenths)
        at++;
    return (uint16_t)at;
}

static bool count_all(uint32_t *count[256], struct percentiles *out, const struct session *session,
                      const uint16_t *label)
{
    const struct scene *scene = session_scene(session);
    const struct grid *grid = &scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, label++) {
                if (*label > 255)
                    continue;
                if (!count[*label] && !(count[*label] = mem_new(INTENSITIES * sizeof **count)))
                    return false;
                count[*label][scene->cell[c].intensity]++;
                out->voxels[*label]++;
            }
        }
    return true;
}

enum err percentiles_find(struct percentiles *out, const struct session *session,
                          const uint16_t *label, struct fault *fault)
{
    uint32_t *count[256] = {NULL};
    *out = (struct percentiles){.voxels = {0}};
    const bool fine = count_all(count, out, session, label);
    for (unsigned l = 0; l < 256; l++) {
        if (fine && count[l]) {
            const double low = levels_value(session_geometry(session), session_levels(session),
                                            find(count[l], out->voxels[l], 1)),
                         high = levels_value(session_geometry(session), session_levels(session),
                                             find(count[l], out->voxels[l], 9));
            out->low[l] = low < high ? low : high; /* a slope may be below 0 */
            out->high[l] = low < high ? high : low;
        }
        free(count[l]);
    }
    return fine ? OK : fault_memory(fault, "the intensities of labels");
}
