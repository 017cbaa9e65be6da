/* SPDX-License-Identifier: MIT */
#include "engine/doubt.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/relax.h"

/* Sums of each worker, one after another: over slices across x, across y and across z. */
struct summing {
    const struct relax_field *field; /* current field */
    struct team *team;
    uint64_t *sum;
    size_t slices; /* number of slices across all axes */
};

static void sum_part(void *context, unsigned worker)
{
    const struct summing *s = context;
    const struct relax_field *f = s->field;
    const uint32_t *size = f->scene->grid.size, *first = f->box.first;
    uint64_t *const across_x = s->sum + worker * s->slices + first[0];
    uint64_t *const across_y = s->sum + worker * s->slices + size[0] + first[1];
    uint64_t *const across_z = s->sum + worker * s->slices + size[0] + size[1] + first[2];
    const struct share planes = team_share(s->team, worker, f->size[2]);
    struct task task = task_begin_part(f->scene->watch, "doubt", 0, worker);
    for (uint32_t z = (uint32_t)planes.first; z < planes.end; z++)
        for (uint32_t y = 0; y < f->size[1] && task_advance(&task, f->size[0]); y++)
            for (struct relax_part part = {0}; relax_field_next(f, y, z, &part);)
                for (uint32_t i = 0; i < part.count; i++) {
                    const uint64_t u = (uint64_t)part.value[i];
                    const uint64_t doubt = 4 * u * (RELAX_ONE - u) / RELAX_ONE;
                    across_x[part.x + i] += doubt;
                    across_y[y] += doubt;
                    across_z[z] += doubt;
                }
}

static void sum_field(void *context, const struct relax_field *field)
{
    struct summing *s = context;
    s->field = field;
    team_run(s->team, sum_part, s);
}

enum err doubt_find(struct doubt *doubt, const struct finish_list *list, const struct scene *scene,
                    struct team *team, unsigned label, struct fault *fault)
{
    const uint32_t *size = scene->grid.size;
    const size_t slices = (size_t)size[0] + size[1] + size[2];
    struct finish_list before = *list;
    uint32_t sweeps = finish_table[FINISH_RELAX].usual;
    for (before.count = 0; before.count < list->count; before.count++)
        if (list->step[before.count].kind == FINISH_RELAX) {
            sweeps = list->step[before.count].argument;
            break;
        }
    *doubt = (struct doubt){{size[0], size[1], size[2]}, {NULL}, 0};
    struct finish_work work = {.scene = scene, .team = team};
    struct summing s = {NULL, team, mem_new(team_size(team) * slices * sizeof *s.sum), slices};
    enum err err = s.sum ? finish_make(&work.label, &before, scene, team, NULL, fault)
                         : fault_memory(fault, "doubt");
    if (!err)
        err = relax_each(&work, label, sweeps, FINISH_BAND_MOST, sum_field, &s, fault);
    mem_pages_free(work.label, scene->grid.cells);
    if (err) {
        free(s.sum);
        *doubt = (struct doubt){0};
        return err;
    }
    for (size_t i = slices; i < team_size(team) * slices; i++)
        s.sum[i % slices] += s.sum[i];
    doubt->slice[0] = s.sum;
    doubt->slice[1] = s.sum + size[0];
    doubt->slice[2] = s.sum + size[0] + size[1];
    for (uint32_t x = 0; x < size[0]; x++)
        doubt->all += doubt->slice[0][x];
    return OK;
}

void doubt_release(struct doubt *doubt)
{
    free(doubt->slice[0]);
    *doubt = (struct doubt){0};
}

bool doubt_worst(const struct doubt *doubt, unsigned *axis, uint32_t *at)
{
    uint64_t most = 0;
    for (unsigned a = 0; a < 3; a++)
        for (uint32_t i = 0; i < doubt->size[a]; i++)
            if (doubt->slice[a][i] > most) {
                most = doubt->slice[a][i];
                *axis = a;
                *at = i;
            }
    return most > 0;
}
