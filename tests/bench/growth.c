/* SPDX-License-Identifier: MIT */
/* The cost of one edit as the scene around it grows. */
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "tests/bench/times.h"
#include "render/border.h"
#include "engine/weight.h"
#include "session/session_inside.h"

/* Every scene is made of the same tile, synth:geom with a lattice of seeds, repeated; the edit, a
 * ball of seeds between those of the lattice, touches the same voxels in each. So whatever depends
 * on the size of the scene shows. */
enum {
    TILE_Z = 100,
    LATTICE = 25, /* voxels between seeds */
    BALL = 3,     /* radius of the edit */
    BALL_VOXELS = 123,
    ROUNDS = 31,
    SCENES = 4,
};
static uint32_t tile_side = 200; /* along x and y */
static const uint32_t tiles[SCENES][3] = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 5, 3}};

struct growth {
    struct scene *scene;
    struct forest *forest;
    struct border border;
    struct edit ball[BALL_VOXELS], undo[BALL_VOXELS];
    double scratch_ns; /* a voxel */
    size_t touched[2]; /* planting and erasing */
    double ms[2][ROUNDS];
};

/* ---- scenes ---- */

static void lay_tiles(struct scene *scene, const struct scene *tile)
{
    const struct grid *grid = &scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span to = grid_row(grid, y, z);
            const struct span from = grid_row(&tile->grid, y % tile_side, z % TILE_Z);
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                const struct cell *cell = tile->cell + from.first + x % tile_side;
                scene->cell[to.first + x].intensity = cell->intensity;
                scene->cell[to.first + x].weight = cell->weight;
            }
        }
}

static void plant_lattice(struct growth *growth)
{
    const struct grid *grid = &growth->scene->grid;
    struct edit *seed =
        must_have(grid->voxels / (LATTICE * LATTICE * LATTICE) * sizeof(struct edit));
    size_t seeds = 0;
    for (uint32_t z = LATTICE / 2; z < grid->size[2]; z += LATTICE)
        for (uint32_t y = LATTICE / 2; y < grid->size[1]; y += LATTICE)
            for (uint32_t x = LATTICE / 2; x < grid->size[0]; x += LATTICE)
                seed[seeds++] = (struct edit){grid_cell(grid, x, y, z),
                                              (int16_t)(1 + (x + y + z) / LATTICE % 3), 0};
    const uint64_t begin = clock_ns();
    must(forest_edit(growth->forest, seed, seeds, &bench_fault));
    growth->scratch_ns = (double)(clock_ns() - begin) / (double)grid->voxels;
    free(seed);
}

/* In the tile in the middle, in the middle of eight seeds. */
static void place_ball(struct growth *growth, const uint32_t count[3])
{
    const struct grid *grid = &growth->scene->grid;
    const int32_t at[3] = {(int32_t)(count[0] / 2 * tile_side + tile_side / 2),
                           (int32_t)(count[1] / 2 * tile_side + tile_side / 2),
                           (int32_t)(count[2] / 2 * TILE_Z + 2 * LATTICE)};
    size_t voxels = 0;
    for (int32_t z = -BALL; z <= BALL; z++)
        for (int32_t y = -BALL; y <= BALL; y++)
            for (int32_t x = -BALL; x <= BALL; x++)
                if (x * x + y * y + z * z <= BALL * BALL && voxels < BALL_VOXELS) {
                    const uint32_t cell = grid_cell(grid, (uint32_t)(at[0] + x),
                                                    (uint32_t)(at[1] + y), (uint32_t)(at[2] + z));
                    growth->ball[voxels] = (struct edit){cell, 7, 0};
                    growth->undo[voxels++] = (struct edit){cell, EDIT_ERASE, 0};
                }
}

static void make_scene(struct growth *growth, const struct scene *tile, const uint32_t count[3])
{
    const uint32_t size[3] = {count[0] * tile_side, count[1] * tile_side, count[2] * TILE_Z};
    must(scene_new(&growth->scene, size, NULL, NULL, &bench_fault));
    must(forest_new(&growth->forest, growth->scene, 6, &bench_fault));
    must(border_init(&growth->border, growth->scene, &bench_fault));
    lay_tiles(growth->scene, tile);
    place_ball(growth, count);
    plant_lattice(growth);
    border_recount(&growth->border);
}

/* ---- timing ---- */

static void time_edit(struct growth *growth, int erases, int round)
{
    const uint64_t begin = clock_ns();
    must(forest_edit(growth->forest, erases ? growth->undo : growth->ball, BALL_VOXELS,
                     &bench_fault));
    const struct changes changes = forest_changes(growth->forest);
    border_update(&growth->border, &changes);
    growth->ms[erases][round] = times_since(begin);
    growth->touched[erases] = (size_t)forest_stats(growth->forest).touched;
}

static double median(double *ms)
{
    return times_median(ms, ROUNDS);
}

static void print_table(struct growth *growth, size_t scenes)
{
    printf("one edit, %d seeds planted and erased again, in scenes that grow around it: forest,\n"
           "digests and border. Medians of %d rounds in turn, one core.\n\n"
           "                        planted           erased        ns a touched voxel    both,\n"
           "      voxels       ms   touched      ms   touched   plant   erase  scratch   first=1\n",
           BALL_VOXELS, ROUNDS);
    double first = 0;
    for (size_t i = 0; i < scenes; i++) {
        struct growth *g = growth + i;
        const double plant = median(g->ms[0]), erase = median(g->ms[1]);
        first = i == 0 ? plant + erase : first;
        printf("%12zu %8.3f %9zu %7.3f %9zu %7.1f %7.1f %8.1f %9.2f\n", g->scene->grid.voxels,
               plant, g->touched[0], erase, g->touched[1], plant * 1e6 / (double)g->touched[0],
               erase * 1e6 / (double)g->touched[1], g->scratch_ns, (plant + erase) / first);
    }
}

static void write_table(struct growth *growth, size_t scenes)
{
    struct json *json = bench_json();
    json_object(json, NULL);
    json_count(json, "rounds", ROUNDS);
    json_count(json, "seeds", BALL_VOXELS);
    json_array(json, "scenes");
    for (size_t i = 0; i < scenes; i++) {
        struct growth *g = growth + i;
        json_object(json, NULL);
        json_count(json, "voxels", g->scene->grid.voxels);
        json_array(json, "touched");
        json_count(json, NULL, g->touched[0]);
        json_count(json, NULL, g->touched[1]);
        json_end(json);
        json_fixed(json, "plant_ms", median(g->ms[0]), 4);
        json_fixed(json, "erase_ms", median(g->ms[1]), 4);
        json_fixed(json, "scratch_ns", g->scratch_ns, 2);
        json_end(json);
    }
    json_end(json);
    json_end(json);
}

/* As many of the scenes as memory holds together, one at least. */
static size_t scenes_that_fit(size_t most)
{
    uint64_t bytes = 0;
    size_t scenes = 0;
    for (; scenes < most; scenes++) {
        const uint32_t size[3] = {tiles[scenes][0] * tile_side, tiles[scenes][1] * tile_side,
                                  tiles[scenes][2] * TILE_Z};
        bytes += session_bytes_for(size);
        if (scenes > 0 && bytes > mem_available() / 10 * 9)
            break;
    }
    return scenes;
}

enum err run_growth(const struct options *o, struct fault *fault)
{
    tile_side = bench_options(o)->quick ? 100 : tile_side;
    const size_t scenes = scenes_that_fit(bench_options(o)->quick ? 2 : SCENES);
    struct watch *watch = console_watch();
    OWNED(mem_release) struct growth *growth = must_have(SCENES * sizeof *growth);
    OWNED(scene_drop) struct scene *tile = NULL;
    struct adjacency adjacency;
    (void)fault;
    console_handle_interrupts();
    must(scene_new_geom(&tile, 0, watch, &bench_fault));
    adjacency_init(&adjacency, 6, &tile->grid);
    weight_compute(tile, &adjacency, &(struct weight_choice){WEIGHT_MORPH, 1},
                   &(struct weight_work){0});
    for (size_t i = 0; i < scenes; i++) {
        watch_poll(watch, "making scenes", i, scenes);
        make_scene(growth + i, tile, tiles[i]);
    }
    for (int round = -1; round < ROUNDS; round++) { /* the first warms up */
        if (watch_poll(watch, "edits", (uint64_t)round + 1, ROUNDS))
            must(fault_set(&bench_fault, ERR_CANCELLED, "cancelled"));
        for (size_t i = 0; i < 2 * scenes; i++)
            time_edit(growth + i / 2, i % 2, round < 0 ? 0 : round);
    }
    (o->json ? write_table : print_table)(growth, scenes);
    for (size_t i = 0; i < scenes; i++) {
        border_release(&growth[i].border);
        forest_free(growth[i].forest);
        scene_free(growth[i].scene);
    }
    return OK;
}
