/* Steps that look at whole components, and how components are given away. */
#include "engine/finish.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* ---- giving away ---- */

struct giving {
    struct finish_work *work; /* work->next is 1 in voxels of pieces that wait, else 0 */
    const struct components *pieces;
    bool *waits;
    uint16_t *taker; /* of each piece, in the round at hand */
};

enum { NOBODY = 256 };

static uint32_t count_faces(const struct finish_work *work, uint32_t first, uint32_t end,
                            uint32_t faces[256])
{
    for (uint32_t c = first; c < end; c++)
        faces[work->label[c]] += !work->next[c];
    return end - first;
}

/* The faces of a run, but for those at the edge of the scene. */
static uint32_t count_run(const struct finish_work *work, const struct component_run *run,
                          uint32_t faces[256])
{
    const struct grid *grid = &work->scene->grid;
    const struct place p = grid_place(grid, run->first);
    const uint32_t at[3] = {p.x, p.y, p.z}, first = run->first, end = run->end;
    uint32_t looked = 2;
    if (p.x > 0)
        count_faces(work, first - 1, first, faces);
    if (p.x + (end - first) < grid->size[0])
        count_faces(work, end, end + 1, faces);
    for (int a = 1; a < 3; a++) {
        const uint32_t step = (uint32_t)grid->step[a];
        if (at[a] > 0)
            looked += count_faces(work, first - step, end - step, faces);
        if (at[a] + 1 < grid->size[a])
            looked += count_faces(work, first + step, end + step, faces);
    }
    return looked;
}

/* Who takes the piece as labels are: NOBODY where it has no face that counts. */
static uint16_t find_taker(const struct giving *g, const struct component *piece, struct task *task)
{
    uint32_t faces[256] = {0}, most = 0;
    uint16_t taker = NOBODY;
    for (uint32_t r = piece->run; r != RUN_NONE; r = g->pieces->run[r].next)
        if (!task_advance(task, count_run(g->work, &g->pieces->run[r], faces)))
            return NOBODY;
    faces[piece->label] = 0;
    for (uint16_t label = 0; label < 256; label++)
        if (faces[label] > most) {
            most = faces[label];
            taker = label;
        }
    task_advance(task, 64);
    return taker;
}

/* Writes a value at each voxel of a piece. */
static void mark(const struct components *pieces, const struct component *piece, uint8_t *at,
                 uint8_t value)
{
    for (uint32_t r = piece->run; r != RUN_NONE; r = pieces->run[r].next)
        memset(at + pieces->run[r].first, value, pieces->run[r].end - pieces->run[r].first);
}

/* False where no piece has found a taker, or the watch has stopped it. */
static bool give_round(const struct giving *g, unsigned taker, struct task *task)
{
    const struct components *pieces = g->pieces;
    bool any = false;
    for (size_t i = 0; i < pieces->count; i++)
        g->taker[i] = g->waits[i] ? find_taker(g, &pieces->item[i], task) : NOBODY;
    for (size_t i = 0; i < pieces->count && task_advance(task, 1); i++) {
        if (g->taker[i] == NOBODY)
            continue;
        if (taker == FINISH_ALL_LABELS || taker == g->taker[i])
            mark(pieces, &pieces->item[i], g->work->label, (uint8_t)g->taker[i]);
        mark(pieces, &pieces->item[i], g->work->next, 0);
        g->waits[i] = false;
        any = true;
    }
    return any && task_advance(task, 1);
}

enum err finish_give_away(struct finish_work *work, const struct components *pieces, bool *waits,
                          unsigned taker, struct fault *fault)
{
    struct giving giving = {work, pieces, waits, mem_array(pieces->count, sizeof(uint16_t))};
    struct task task = task_begin(work->scene->watch, "pieces of labels", 0);
    if (!giving.taker)
        return fault_memory(fault, "finished labels");
    finish_clear(work);
    for (size_t i = 0; i < pieces->count && task_advance(&task, 16); i++)
        if (waits[i])
            mark(pieces, &pieces->item[i], work->next, 1);
    while (give_round(&giving, taker, &task))
        ;
    free(giving.taker);
    return watch_fault(work->scene->watch, fault);
}

/* ---- which components go ---- */

typedef void choose_components(const struct components *found, const struct finish_step *step,
                               bool *waits);

static enum err give_chosen(struct finish_work *work, const struct finish_step *step,
                            choose_components *choose, unsigned taker, struct fault *fault)
{
    struct components found;
    enum err err =
        components_find(&found, &work->scene->grid, work->label, work->scene->watch, fault);
    if (err)
        return err;
    bool *waits = mem_array(found.count, sizeof *waits);
    if (waits) {
        choose(&found, step, waits);
        err = finish_give_away(work, &found, waits, taker, fault);
    } else {
        err = fault_memory(fault, "finished labels");
    }
    free(waits);
    components_release(&found);
    return err;
}

static bool may_go(const struct component *item, const struct finish_step *step)
{
    return item->label != 0 && finish_is_for(step, item->label);
}

static void choose_but_largest(const struct components *found, const struct finish_step *step,
                               bool *waits)
{
    size_t largest[256];
    uint32_t voxels[256] = {0};
    for (size_t i = 0; i < found->count; i++) {
        const struct component *item = &found->item[i];
        if (item->voxels > voxels[item->label]) {
            voxels[item->label] = item->voxels;
            largest[item->label] = i;
        }
    }
    for (size_t i = 0; i < found->count; i++)
        waits[i] = may_go(&found->item[i], step) && i != largest[found->item[i].label];
}

static void choose_small(const struct components *found, const struct finish_step *step,
                         bool *waits)
{
    for (size_t i = 0; i < found->count; i++)
        waits[i] = may_go(&found->item[i], step) && found->item[i].voxels < step->argument;
}

static void choose_holes(const struct components *found, const struct finish_step *step,
                         bool *waits)
{
    (void)step;
    for (size_t i = 0; i < found->count; i++)
        waits[i] = found->item[i].label == 0 && !found->item[i].at_edge;
}

enum err finish_largest(struct finish_work *work, const struct finish_step *step,
                        struct fault *fault)
{
    return give_chosen(work, step, choose_but_largest, FINISH_ALL_LABELS, fault);
}

enum err finish_components(struct finish_work *work, const struct finish_step *step,
                           struct fault *fault)
{
    return give_chosen(work, step, choose_small, FINISH_ALL_LABELS, fault);
}

enum err finish_holes(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    return give_chosen(work, step, choose_holes, step->label, fault);
}
