#include "engine/scene.h"

#include <stdlib.h>

#include "base/hash.h"
#include "base/mem.h"

static void fill_with(struct cell *cell, size_t count, struct cell value)
{
    for (size_t i = 0; i < count; i++)
        cell[i] = value;
}

/* Everything is rim at first; then each row of voxels becomes unreached voxels. */
static void scene_clear(struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    const struct cell rim = {.flags = CELL_RIM, .direction = DIRECTION_NONE};
    const struct cell voxel = {.key = KEY_NONE, .direction = DIRECTION_NONE};
    fill_with(scene->cell, (size_t)grid->step[2], rim);
    for (uint32_t z = 0; z < grid->size[2]; z++) {
        fill_with(scene->cell + (z + 1) * (size_t)grid->step[2], (size_t)grid->step[2], rim);
        for (uint32_t y = 0; y < grid->size[1]; y++)
            fill_with(scene->cell + grid_row(grid, y, z).first, grid->size[0], voxel);
    }
    fill_with(scene->cell + (grid->size[2] + 1) * (size_t)grid->step[2], (size_t)grid->step[2],
              rim);
}

enum err scene_new(struct scene **out, const uint32_t size[3], struct fault *fault)
{
    *out = NULL;
    struct scene *scene = mem_new(sizeof *scene);
    if (!scene)
        return fault_memory(fault, "a scene");
    enum err err = grid_init(&scene->grid, size, fault);
    if (!err) {
        scene->cell = mem_pages(scene->grid.cells * sizeof *scene->cell);
        if (!scene->cell)
            err = fault_memory(fault, "the voxels of a scene");
    }
    if (err) {
        free(scene);
        return err;
    }
    for (int a = 0; a < 3; a++) {
        scene->spacing_nm[a] = 1000000;
        scene->world_axis[a] = (int8_t)a;
        scene->world_sign[a] = 1;
    }
    scene_clear(scene);
    *out = scene;
    return OK;
}

void scene_free(struct scene *scene)
{
    if (!scene)
        return;
    mem_pages_free(scene->cell, scene->grid.cells * sizeof *scene->cell);
    free(scene);
}

void scene_fill(struct scene *scene, const uint16_t *intensity)
{
    const struct grid *grid = &scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                scene->cell[c].intensity = *intensity++;
        }
}

uint64_t scene_digest(const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    uint64_t sum = 0;
    for (unsigned a = 0; a < 3; a++) {
        uint64_t axis = (uint64_t)scene->world_axis[a] * 2 + (scene->world_sign[a] < 0);
        sum += hash_mix_at(a, grid->size[a]);
        sum += hash_mix_at(a + 3, scene->spacing_nm[a]);
        sum += hash_mix_at(a + 6, axis);
    }
    uint64_t voxel = 16;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                sum += hash_mix(voxel++ << 16 | scene->cell[c].intensity);
        }
    return sum;
}

/* ---- the synthetic scene ---- */

/* One object of the scene, in voxels of the 200x200x100 base; later ones lie over earlier ones. */
struct solid {
    enum { BALL, BLOCK, TUBE, TORUS } kind;
    int centre[3];
    int extent[3]; /* BALL: semi-axes. BLOCK: half sides. TUBE: radius, half length along z.
                      TORUS: ring radius, tube radius. */
    int intensity;
};

static const struct solid geom_solid[] = {
    {BALL, {100, 100, 50}, {88, 84, 44}, 70},  {BALL, {66, 84, 50}, {34, 40, 30}, 120},
    {BLOCK, {136, 78, 52}, {26, 24, 22}, 165}, {TORUS, {100, 140, 50}, {26, 10, 0}, 205},
    {TUBE, {66, 84, 50}, {9, 40, 0}, 30},      {BALL, {136, 78, 52}, {12, 12, 12}, 235},
};

static int square(int v)
{
    return v * v;
}

static bool solid_holds(const struct solid *solid, int x, int y, int z)
{
    const int *e = solid->extent;
    int dx = x - solid->centre[0], dy = y - solid->centre[1], dz = z - solid->centre[2];
    switch (solid->kind) {
    case BALL: {
        int64_t xy = (int64_t)square(e[0]) * square(e[1]);
        int64_t yz = (int64_t)square(e[1]) * square(e[2]);
        int64_t xz = (int64_t)square(e[0]) * square(e[2]);
        return square(dx) * yz + square(dy) * xz + square(dz) * xy <= xy * square(e[2]);
    }
    case BLOCK:
        return abs(dx) <= e[0] && abs(dy) <= e[1] && abs(dz) <= e[2];
    case TUBE:
        return square(dx) + square(dy) <= square(e[0]) && abs(dz) <= e[1];
    case TORUS: {
        int64_t p = square(dx) + square(dy) + square(dz) + square(e[0]) - square(e[1]);
        return p * p <= (int64_t)4 * square(e[0]) * (square(dx) + square(dy));
    }
    }
    return false;
}

static uint16_t geom_intensity(int x, int y, int z)
{
    int value = 12 + x / 25 + z / 20; /* a graded background */
    for (size_t i = 0; i < sizeof geom_solid / sizeof geom_solid[0]; i++)
        if (solid_holds(&geom_solid[i], x, y, z))
            value = geom_solid[i].intensity;
    uint64_t place = (uint64_t)((z * 200 + y) * 200 + x);
    value += (int)(hash_mix_at(place, 0) % 9) - 4;
    return (uint16_t)(value < 0 ? 0 : value);
}

/* The voxel at half steps is the mean, rounded down, of the 1, 2, 4 or 8 base voxels around. */
static uint16_t geom_between(const uint16_t *base, const uint32_t at[3], unsigned doubled)
{
    uint32_t low[3], high[3], sum = 0, count = 0;
    for (unsigned a = 0; a < 3; a++) {
        unsigned twice = doubled >> a & 1;
        low[a] = at[a] >> twice;
        high[a] = low[a] + (at[a] & twice);
    }
    for (uint32_t z = low[2]; z <= high[2]; z++)
        for (uint32_t y = low[1]; y <= high[1]; y++)
            for (uint32_t x = low[0]; x <= high[0]; x++, count++)
                sum += base[(z * 200 + y) * 200 + x];
    return (uint16_t)(sum / count);
}

enum err scene_new_geom(struct scene **out, unsigned doubled, struct fault *fault)
{
    uint32_t size[3] = {200, 200, 100};
    *out = NULL;
    uint16_t *base = mem_array((size_t)size[0] * size[1] * size[2], sizeof *base);
    if (!base)
        return fault_memory(fault, "the synthetic scene");
    uint16_t *next = base;
    for (int z = 0; z < 100; z++)
        for (int y = 0; y < 200; y++)
            for (int x = 0; x < 200; x++)
                *next++ = geom_intensity(x, y, z);
    for (unsigned a = 0; a < 3; a++)
        if (doubled >> a & 1)
            size[a] = 2 * size[a] - 1;
    struct scene *scene;
    enum err err = scene_new(&scene, size, fault);
    if (err)
        goto done;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++)
                scene->cell[grid_cell(&scene->grid, x, y, z)].intensity =
                    geom_between(base, (uint32_t[]){x, y, z}, doubled);
    for (unsigned a = 0; a < 3; a++)
        if (doubled >> a & 1)
            scene->spacing_nm[a] = 500000;
    *out = scene;
done:
    free(base);
    return err;
}
