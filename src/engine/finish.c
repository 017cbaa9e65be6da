/* The table of steps, the list, and how it is written. */
#include "engine/finish.h"

#include <string.h>

#include "base/mem.h"
#include "engine/labels.h"

#define ROW(kind, name, takes, usual, help)                                                        \
    [FINISH_##kind] = {#name, FINISH_TAKES_##takes, usual, finish_##name},
const struct finish_row finish_table[] = {FINISH_LIST(ROW, ROW)};

static enum err take_steps(struct finish_work *work, const struct finish_list *list,
                           struct fault *fault)
{
    const struct labels forest = labels_of_forest(work->scene);
    if (!work->label || !work->next)
        return fault_memory(fault, "finished labels");
    labels_copy(&forest, work->label, work->team);
    enum err err = watch_fault(work->scene->watch, fault);
    for (uint32_t i = 0; !err && i < list->count; i++)
        err = finish_table[list->step[i].kind].apply(work, &list->step[i], fault);
    return err ? err : watch_fault(work->scene->watch, fault);
}

enum err finish_make(uint8_t **label, const struct finish_list *list, const struct scene *scene,
                     struct team *team, struct fault *fault)
{
    const size_t cells = scene->grid.cells;
    *label = NULL;
    enum err err = finish_check(list, scene, fault);
    if (err)
        return err;
    struct finish_work work = {scene, team, mem_pages(cells), mem_pages(cells)};
    err = take_steps(&work, list, fault);
    mem_pages_free(work.next, cells);
    if (err)
        mem_pages_free(work.label, cells);
    *label = err ? NULL : work.label;
    return err;
}

bool finish_heeds_seeds(const struct finish_list *list)
{
    bool heeds = false;
    for (uint32_t i = 0; i < list->count; i++)
        heeds |= list->step[i].kind == FINISH_RELAX;
    return heeds;
}

void finish_take_next(struct finish_work *work)
{
    uint8_t *const made = work->next;
    work->next = work->label;
    work->label = made;
}

void finish_clear(struct finish_work *work)
{
    const struct grid *grid = &work->scene->grid;
    const size_t plane = (size_t)grid->step[2];
    struct task task = task_begin(work->scene->watch, "finished labels", grid->cells);
    for (size_t at = 0; at < grid->cells && task_advance(&task, plane / 16); at += plane)
        memset(work->next + at, 0, plane);
}

/* ---- what is refused ---- */

void finish_reach(uint32_t reach[3], const struct finish_step *step, const struct scene *scene)
{
    for (int a = 0; a < 3; a++)
        reach[a] = step->in_nm ? step->argument / scene->spacing_nm[a] : step->argument;
}

enum err finish_check(const struct finish_list *list, const struct scene *scene,
                      struct fault *fault)
{
    for (const struct finish_step *step = list->step; step < list->step + list->count; step++) {
        uint32_t reach[3] = {0};
        if (finish_table[step->kind].takes == FINISH_TAKES_RADIUS)
            finish_reach(reach, step, scene);
        for (int a = 0; a < 3; a++)
            if (reach[a] > FINISH_RADIUS_MOST)
                return fault_set(fault, ERR_LIMIT,
                                 "finish %s: the radius reaches %u voxels along %c; at most %d",
                                 finish_table[step->kind].name, reach[a], "xyz"[a],
                                 FINISH_RADIUS_MOST);
    }
    return OK;
}

/* ---- words ---- */

static void write_step(struct buf *out, const struct finish_step *step)
{
    const struct finish_row *row = &finish_table[step->kind];
    buf_add_text(out, row->name);
    if (row->takes == FINISH_TAKES_RADIUS && step->in_nm)
        buf_printf(out, " radius=%gmm", step->argument / 1e6);
    else if (row->takes == FINISH_TAKES_RADIUS)
        buf_printf(out, " radius=%u", step->argument);
    else if (row->takes == FINISH_TAKES_VOXELS)
        buf_printf(out, " voxels=%u", step->argument);
    else if (row->takes == FINISH_TAKES_SWEEPS)
        buf_printf(out, " sweeps=%u", step->argument);
    if (step->label != FINISH_ALL_LABELS)
        buf_printf(out, " label=%u", step->label);
}

void finish_write(struct buf *out, const struct finish_list *list)
{
    for (uint32_t i = 0; i < list->count; i++) {
        buf_add_text(out, i ? ", " : "");
        write_step(out, &list->step[i]);
    }
    if (!list->count)
        buf_add_text(out, "none");
}
