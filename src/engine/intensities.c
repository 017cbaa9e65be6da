#include "engine/intensities.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { INTENSITIES = UINT16_MAX + 1 };

static const size_t VOXELS_MOST = 1u << 22;

/* Each worker counts for itself, in INTENSITIES counts of its own. */
struct counting {
    const struct scene *scene;
    struct team *team;
    uint32_t *count;
};

static void count_part(void *context, unsigned worker)
{
    const struct counting *c = context;
    const struct grid *grid = &c->scene->grid;
    const size_t each = (grid->voxels + VOXELS_MOST - 1) / VOXELS_MOST;
    const size_t rows = ((size_t)grid->size[1] * grid->size[2] + each - 1) / each;
    const struct share share = team_share(c->team, worker, rows);
    uint32_t *count = c->count + (size_t)worker * INTENSITIES;
    for (size_t i = share.first; i < share.end; i++) {
        const size_t r = i * each;
        const struct span row =
            grid_row(grid, (uint32_t)(r % grid->size[1]), (uint32_t)(r / grid->size[1]));
        for (uint32_t at = row.first; at < row.end; at++)
            count[c->scene->cell[at].intensity]++;
    }
}

void intensities_count(uint32_t count[UINT16_MAX + 1], const struct scene *scene, struct team *team)
{
    const size_t workers = team_size(team);
    uint32_t *all = workers > 1 ? mem_new(workers * INTENSITIES * sizeof *all) : NULL;
    struct counting counting = {scene, all ? team : NULL, all ? all : count};
    memset(count, 0, INTENSITIES * sizeof *count);
    team_run(counting.team, count_part, &counting);
    for (size_t i = 0; all && i < workers * INTENSITIES; i++)
        count[i % INTENSITIES] += all[i];
    free(all);
}

void intensities_range(int32_t range[2], const uint32_t count[UINT16_MAX + 1], uint64_t low,
                       uint64_t high)
{
    uint64_t below = 0, all = 0;
    for (int32_t i = 0; i <= UINT16_MAX; i++)
        all += count[i];
    range[0] = range[1] = 0;
    for (int32_t i = 0; i <= UINT16_MAX; i++) {
        if (below * 1000 <= all * low)
            range[0] = i;
        if (below * 1000 < all * high)
            range[1] = i;
        below += count[i];
    }
}
