/* SPDX-License-Identifier: MIT */
#include "tests/bench/procedure.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "tests/bench/times.h"

const unsigned procedure_count[PROCEDURE_STEPS] = {660,  730,  1030, 1230,
                                                   1400, 1550, 1955, PROCEDURE_SEEDS};

/* Seeds of one label: `wanted` of them, drawn evenly from the regions first..last of a map. */
struct kind {
    uint16_t first, last;
    uint8_t label;
    unsigned wanted;
};

enum {
    OUTSIDE = 117, /* AAL ends with 116 */
    DARK = 20,
    KINDS_MOST = 8,
    SPARE = 5, /* drawn for each one wanted: ch2better holds a third of ch2's background */
};

static const struct kind atlas_kind[] = {
    {1, 90, 1, 1000}, {91, 116, 2, 250}, {OUTSIDE, OUTSIDE, 0, 855}};

/* Region i + 1 of geom has the intensities of band i: noise is 4 up or down. */
static const uint16_t geom_band[][2] = {{8, 25},    {66, 74}, {116, 124}, {161, 169},
                                        {201, 209}, {28, 34}, {231, 239}};
static const struct kind geom_kind[] = {{1, 1, 0, 700}, {2, 2, 1, 500}, {3, 3, 2, 300},
                                        {4, 4, 3, 250}, {5, 5, 4, 150}, {6, 6, 5, 100},
                                        {7, 7, 6, 105}};

static const struct kind *kinds_of(const struct procedure *procedure, unsigned *count)
{
    *count = procedure->has_atlas ? sizeof atlas_kind / sizeof atlas_kind[0]
                                  : sizeof geom_kind / sizeof geom_kind[0];
    return procedure->has_atlas ? atlas_kind : geom_kind;
}

void procedure_release(struct procedure *procedure)
{
    free(procedure->place);
    *procedure = (struct procedure){0};
}

/* ---- where seeds may lie ---- */

static uint16_t geom_region(uint16_t intensity)
{
    for (size_t i = 0; i < sizeof geom_band / sizeof geom_band[0]; i++)
        if (intensity >= geom_band[i][0] && intensity <= geom_band[i][1])
            return (uint16_t)(i + 1);
    return 0;
}

/* `region` gets a number for each voxel, 0 for none. */
static void fill_regions(uint16_t *region, const struct scene *scene, const struct volume *atlas)
{
    const struct grid *grid = &scene->grid;
    size_t voxel = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, voxel++) {
                const uint16_t intensity = scene->cell[c].intensity;
                if (!atlas)
                    region[voxel] = geom_region(intensity);
                else if (atlas->intensity[voxel] == 0 && intensity < DARK)
                    region[voxel] = OUTSIDE;
                else
                    region[voxel] = atlas->intensity[voxel];
            }
        }
}

/* Draws from one kind's regions, with some to spare: a scene may be smaller than the base. */
static enum err draw_kind(struct procedure *procedure, unsigned k, const struct session *base,
                          const uint16_t *region, struct volume *work, struct fault *fault)
{
    unsigned kinds;
    const struct kind *kind = kinds_of(procedure, &kinds) + k;
    const struct grid *grid = &base->scene->grid;
    const struct region_choice choice = {
        .first = kind->first,
        .last = kind->last,
        .label = kind->label,
        .erode = 1,
        .each = SPARE * kind->wanted / (uint32_t)(kind->last - kind->first + 1) + 8,
        .generator = 1,
    };
    OWNED(seeds_release) struct seeds seeds = {0};
    struct region_tally tally;
    memcpy(work->intensity, region, grid->voxels * sizeof *region);
    enum err err = seeds_from_map(&seeds, &tally, work, grid, &choice, NULL, fault);
    if (!err && !mem_grow(&procedure->place, &procedure->capacity, procedure->places + seeds.count,
                          sizeof *procedure->place))
        err = fault_memory(fault, "a procedure");
    for (size_t i = 0; !err && i < seeds.count; i++) {
        const struct place p = grid_place(grid, seeds.edit[i].cell);
        struct procedure_place *place = &procedure->place[procedure->places++];
        *place = (struct procedure_place){
            .kind = k, .order = hash_mix_at(grid_voxel(grid, seeds.edit[i].cell), k)};
        geometry_point(&base->geometry, (const uint32_t[]){p.x, p.y, p.z}, place->mm);
    }
    return err;
}

static int compare_places(const void *a, const void *b)
{
    const struct procedure_place *x = a, *y = b;
    if (x->kind != y->kind)
        return x->kind < y->kind ? -1 : 1;
    return x->order < y->order ? -1 : x->order > y->order;
}

enum err procedure_make(struct procedure *procedure, const struct session *base,
                        const struct volume *atlas, struct fault *fault)
{
    const struct grid *grid = &base->scene->grid;
    *procedure = (struct procedure){.has_atlas = atlas != NULL};
    if (atlas) {
        enum err err = map_check_size(atlas->size, grid, fault);
        if (err)
            return err;
    }
    OWNED(volume_release) struct volume work = {.geometry = base->geometry};
    memcpy(work.size, grid->size, sizeof work.size);
    work.geometry.slope = 1, work.geometry.intercept = 0;
    work.intensity = must_have(grid->voxels * sizeof *work.intensity);
    OWNED(mem_release) uint16_t *region = must_have(grid->voxels * sizeof *region);
    enum err err = OK;
    fill_regions(region, base->scene, atlas);
    unsigned kinds;
    kinds_of(procedure, &kinds);
    for (unsigned k = 0; !err && k < kinds; k++)
        err = draw_kind(procedure, k, base, region, &work, fault);
    if (err) {
        procedure_release(procedure);
        return err;
    }
    qsort(procedure->place, procedure->places, sizeof *procedure->place, compare_places);
    return OK;
}

void procedure_open(struct interpreter *interp, const char *name)
{
    OWNED(buf_release) struct buf path = {0};
    must(interpreter_find_scene(interp, 0, name, false, &path, &bench_fault));
    must(session_open(interp->session, buf_text(&path), NULL, &bench_fault));
}

void procedure_load(struct procedure *procedure, struct interpreter *interp, const char *base,
                    const char *atlas)
{
    OWNED(volume_release) struct volume map = {0};
    OWNED(buf_release) struct buf path = {0};
    procedure_open(interp, base);
    if (atlas) {
        must(interpreter_find_file(interp, atlas, &path, &bench_fault));
        must(volume_read(&map, buf_text(&path), NULL, NULL, &bench_fault));
    }
    must(procedure_make(procedure, interp->session, atlas ? &map : NULL, &bench_fault));
}

/* ---- the seeds of a scene ---- */

struct turn {
    struct edit edit;
    uint32_t when; /* (2 j + 1) / wanted for the j-th of a kind, as a fraction of 2^20 */
    unsigned kind;
};

static int compare_turns(const void *a, const void *b)
{
    const struct turn *x = a, *y = b;
    if (x->when != y->when)
        return x->when < y->when ? -1 : 1;
    return x->kind < y->kind ? -1 : x->kind > y->kind;
}

/* Cell of a place in the scene; CELL_NONE outside. */
static uint32_t cell_of(const struct session *session, const struct procedure_place *place)
{
    const struct grid *grid = &session->scene->grid;
    int64_t at[3];
    if (!geometry_voxel(&session->geometry, place->mm, at) ||
        !grid_contains(grid, at[0], at[1], at[2]))
        return CELL_NONE;
    return grid_cell(grid, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
}

/* The first `wanted` of each kind that lie in the scene, with their turns. */
static enum err take_turns(struct turn *turn, const struct procedure *procedure,
                           const struct session *session, struct fault *fault)
{
    unsigned kinds, had[KINDS_MOST] = {0};
    const struct kind *kind = kinds_of(procedure, &kinds);
    size_t turns = 0;
    for (size_t i = 0; i < procedure->places; i++) {
        const struct procedure_place *place = &procedure->place[i];
        const unsigned k = place->kind;
        const uint32_t cell = cell_of(session, place);
        if (cell == CELL_NONE || had[k] == kind[k].wanted)
            continue;
        turn[turns++] =
            (struct turn){{cell, kind[k].label, 0}, ((2 * had[k] + 1) << 20) / kind[k].wanted, k};
        had[k]++;
    }
    for (unsigned k = 0; k < kinds; k++)
        if (had[k] < kind[k].wanted)
            return fault_set(fault, ERR_INPUT,
                             "the procedure wants %u seeds of label %u, and %u places were found",
                             kind[k].wanted, kind[k].label, had[k]);
    return OK;
}

enum err procedure_seeds(struct seeds *seeds, const struct procedure *procedure,
                         const struct session *session, struct fault *fault)
{
    *seeds = (struct seeds){.edit = must_have(PROCEDURE_SEEDS * sizeof *seeds->edit)};
    OWNED(mem_release) struct turn *turn = must_have(PROCEDURE_SEEDS * sizeof *turn);
    const enum err err = take_turns(turn, procedure, session, fault);
    qsort(turn, PROCEDURE_SEEDS, sizeof *turn, compare_turns);
    for (size_t i = 0; !err && i < PROCEDURE_SEEDS; i++)
        seeds->edit[seeds->count++] = turn[i].edit;
    if (err)
        seeds_release(seeds);
    return err;
}
