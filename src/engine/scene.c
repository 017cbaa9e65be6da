/* SPDX-License-Identifier: MIT */
#include "engine/scene.h"

#include <assert.h>
#include <endian.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"

static void fill_rim(struct cell *cell, size_t count)
{
    for (size_t i = 0; i < count; i++)
        cell[i] = (struct cell){.flags = CELL_RIM, .direction = DIRECTION_NONE};
}

/* Fill a row of unreached voxels between two cells of the rim. NULL: 0 everywhere. */
static void fill_row(struct cell *cell, size_t width, const uint16_t *intensity,
                     const uint16_t *weight)
{
    const uint32_t state = cell_state(0, DIRECTION_NONE, 0);
    fill_rim(cell++, 1);
    for (size_t i = 0; i < width; i++) {
        cell[i].key = KEY_NONE;
        cell[i].weight = weight ? weight[i] : 0;
        cell[i].intensity = intensity ? intensity[i] : 0;
        cell[i].state = state;
    }
    fill_rim(cell + width, 1);
}

struct making {
    struct scene *scene;
    const uint16_t *intensity; /* NULL: 0 everywhere */
    struct team *team;
    scene_weigh_row *weigh;
    void *context;
};

/* Fill the planes of a slab; the rim's planes belong to the first and the last slab. */
static void make_slab(void *context, unsigned worker)
{
    const struct making *making = context;
    const struct scene *scene = making->scene;
    const struct grid *grid = &scene->grid;
    const unsigned workers = team_size(making->team);
    const struct slab slab = grid_slab(grid, worker, workers);
    const uint32_t first = slab.first + (worker > 0), end = slab.end + 1 + (worker + 1 == workers);
    const size_t width = grid->size[0], row = (size_t)grid->step[1];
    struct cell *cell = scene->cell + first * (size_t)grid->step[2];
    const uint16_t *intensity = making->intensity;
    uint16_t weight[GRID_SIDE_MOST];
    struct task task = task_begin_part(scene->watch, "room for the scene",
                                       (end - first) * (uint64_t)grid->step[2], worker);
    if (intensity)
        intensity += slab.first * width * grid->size[1];
    for (uint32_t z = first; z < end; z++)
        for (uint32_t y = 0; y < grid->size[1] + 2; y++, cell += row) {
            if (z == 0 || z > grid->size[2] || y == 0 || y > grid->size[1]) {
                fill_rim(cell, row);
            } else {
                if (making->weigh)
                    making->weigh(making->context, worker, y - 1, z - 1, weight);
                fill_row(cell, width, intensity, making->weigh ? weight : NULL);
                intensity = intensity ? intensity + width : NULL;
            }
            if (!task_advance(&task, row))
                return;
        }
}

void scene_make_cells(struct scene *scene, struct team *team, scene_weigh_row *weigh, void *context)
{
    struct making making = {scene, scene->plain, team, weigh, context};
    mem_pages_allow(scene->cell, scene->grid.cells * sizeof *scene->cell, true);
    team_run(team, make_slab, &making);
    if (watch_stops(scene->watch)) {
        mem_pages_allow(scene->cell, scene->grid.cells * sizeof *scene->cell, false);
        return;
    }
    free(scene->plain);
    scene->plain = NULL;
}

/* Free a scene that was cancelled or failed. */
static enum err finish_scene(struct scene **scene, enum err err, struct fault *fault)
{
    err = err ? err : watch_fault((*scene)->watch, fault);
    if (!err)
        return OK;
    scene_free(*scene);
    *scene = NULL;
    return err;
}

/* Allocate a scene whose cells are not initialised. */
static enum err allocate_scene(struct scene **out, const uint32_t size[3], struct watch *watch,
                               struct fault *fault)
{
    *out = NULL;
    OWNED(mem_release) struct scene *scene = mem_new(sizeof *scene);
    if (!scene)
        return fault_memory(fault, "a scene");
    TRY(grid_init(&scene->grid, size, fault));
    scene->cell = mem_pages(scene->grid.cells * sizeof *scene->cell);
    if (!scene->cell)
        return fault_memory(fault, "the voxels of a scene");
    for (int a = 0; a < 3; a++) {
        scene->spacing_nm[a] = 1000000;
        scene->world_axis[a] = (int8_t)a;
        scene->world_sign[a] = 1;
    }
    scene->watch = watch;
    *out = scene;
    scene = NULL;
    return OK;
}

enum err scene_new_plain(struct scene **out, const uint32_t size[3], uint16_t *intensity,
                         struct watch *watch, struct fault *fault)
{
    TRY(allocate_scene(out, size, watch, fault));
    (*out)->plain = intensity;
    mem_pages_allow((*out)->cell, (*out)->grid.cells * sizeof *(*out)->cell, false);
    return OK;
}

enum err scene_new(struct scene **out, const uint32_t size[3], const uint16_t *intensity,
                   struct watch *watch, struct fault *fault)
{
    TRY(allocate_scene(out, size, watch, fault));
    make_slab(&(struct making){.scene = *out, .intensity = intensity}, 0);
    return finish_scene(out, OK, fault);
}

struct swapping {
    struct scene *scene;
    uint16_t *intensity;
    struct team *team;
};

static void swap_part(void *context, unsigned worker)
{
    const struct swapping *s = context;
    const size_t cells = s->scene->grid.cells, workers = team_size(s->team);
    for (size_t c = cells * worker / workers; c < cells * (worker + 1) / workers; c++) {
        const uint16_t was = s->scene->cell[c].intensity;
        s->scene->cell[c].intensity = s->intensity[c];
        s->intensity[c] = was;
    }
}

void scene_swap_channel(struct scene *scene, unsigned channel, struct team *team)
{
    struct channel *other = scene->channel + channel;
    struct swapping swapping = {scene, other->intensity, team};
    const uint32_t percent = scene->percent;
    team_run(team, swap_part, &swapping);
    scene->percent = other->percent;
    other->percent = percent;
}

void scene_free(struct scene *scene)
{
    if (!scene)
        return;
    mem_pages_free(scene->cell, scene->grid.cells * sizeof *scene->cell);
    free(scene->plain);
    free(scene);
}

/* ---- histogram of the intensities ---- */

enum { INTENSITIES = UINT16_MAX + 1 };

static const size_t VOXELS_MOST = 1u << 22;

/* Each worker has its own INTENSITIES counters. */
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
    OWNED(mem_release)
    uint32_t *all = workers > 1 ? mem_new(workers * INTENSITIES * sizeof *all) : NULL;
    struct counting counting = {scene, all ? team : NULL, all ? all : count};
    memset(count, 0, INTENSITIES * sizeof *count);
    team_run(counting.team, count_part, &counting);
    for (size_t i = 0; all && i < workers * INTENSITIES; i++)
        count[i % INTENSITIES] += all[i];
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

/* ---- interpolation ---- */

void scene_interpolated_size(uint32_t out[3], const uint32_t size[3], unsigned doubled)
{
    for (unsigned a = 0; a < 3; a++)
        out[a] = doubled >> a & 1 ? 2 * size[a] - 1 : size[a];
}

/* Mean of the base voxels around a place of the interpolated scene: one along an axis, or two on
 * both sides of a half step. */
static uint16_t mean_around(const struct scene *base, const uint32_t at[3], unsigned doubled)
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
                sum += base->cell[grid_cell(&base->grid, x, y, z)].intensity;
    return (uint16_t)((sum + count / 2) / count);
}

enum err scene_new_interpolated(struct scene **out, const struct scene *base, unsigned doubled,
                                struct watch *watch, struct fault *fault)
{
    uint32_t size[3];
    scene_interpolated_size(size, base->grid.size, doubled);
    TRY(scene_new(out, size, NULL, watch, fault));
    struct scene *const scene = *out;
    for (struct grid_walk w = scene_walk(scene, "interpolation", NULL, 0); grid_walk_next(&w);)
        for (uint32_t x = 0; x < size[0]; x++)
            scene->cell[w.row.first + x].intensity =
                mean_around(base, (const uint32_t[]){x, w.y, w.z}, doubled);
    for (unsigned a = 0; a < 3; a++) {
        const uint32_t nm = base->spacing_nm[a];
        scene->spacing_nm[a] = doubled >> a & 1 ? nm / 2 + nm % 2 : nm;
        scene->world_axis[a] = base->world_axis[a];
        scene->world_sign[a] = base->world_sign[a];
    }
    scene->sides_unknown = base->sides_unknown;
    scene->spacing_unknown = base->spacing_unknown;
    return finish_scene(out, OK, fault);
}

/* ---- the synthetic scene ---- */

/* One object of the scene, in voxels of the base; later ones cover earlier ones. */
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

const uint32_t geom_size[3] = {200, 200, 100};

/* Places are counted in eighths of a voxel of the base: below 2^11, so that products fit 64
 * bits. */
enum { EIGHTHS = 8 };

static int64_t square(int64_t v)
{
    return v * v;
}

/* True if a solid contains the place at (dx, dy, dz) from its centre. Along a line through the
 * solid, it contains dx = 0 and is connected; except the torus. */
static bool solid_holds(const struct solid *solid, int64_t dx, int64_t dy, int64_t dz)
{
    const int64_t e[3] = {EIGHTHS * solid->extent[0], EIGHTHS * solid->extent[1],
                          EIGHTHS * solid->extent[2]};
    switch (solid->kind) {
    case BALL: {
        int64_t xy = square(e[0]) * square(e[1]);
        int64_t yz = square(e[1]) * square(e[2]);
        int64_t xz = square(e[0]) * square(e[2]);
        return square(dx) * yz + square(dy) * xz + square(dz) * xy <= xy * square(e[2]);
    }
    case BLOCK:
        return llabs(dx) <= e[0] && llabs(dy) <= e[1] && llabs(dz) <= e[2];
    case TUBE:
        return square(dx) + square(dy) <= square(e[0]) && llabs(dz) <= e[1];
    case TORUS: {
        int64_t p = square(dx) + square(dy) + square(dz) + square(e[0]) - square(e[1]);
        return p * p <= 4 * square(e[0]) * (square(dx) + square(dy));
    }
    }
    return false;
}

/* Half-length of a solid along x from its centre; -1 if this line does not meet it. */
static int64_t solid_reach(const struct solid *solid, int64_t dy, int64_t dz)
{
    int64_t least = -1, most = EIGHTHS * (int64_t)geom_size[0];
    while (least < most) { /* the solid contains `least`, and nothing above `most` */
        const int64_t middle = (least + most + 1) / 2;
        if (solid_holds(solid, middle, dy, dz))
            least = middle;
        else
            most = middle - 1;
    }
    return least;
}

/* Place of the centre of voxel i of n along an axis of the base, in eighths. */
static int64_t geom_place(uint64_t i, uint32_t n, unsigned axis)
{
    return (int64_t)((2 * i + 1) * geom_size[axis] * EIGHTHS / (2 * (uint64_t)n)) - EIGHTHS / 2;
}

/* Rows of the synthetic scene, for a grid of any size. */
struct geom_rows {
    uint32_t size[3];
    int16_t *place; /* [size[0]], places of voxels along x */
    uint8_t *value; /* [size[0]], without noise */
};

static void draw_solid(struct geom_rows *rows, const struct solid *solid, int64_t dy, int64_t dz)
{
    const int centre = EIGHTHS * solid->centre[0];
    const uint8_t value = (uint8_t)solid->intensity;
    if (solid->kind == TORUS) {
        if (llabs(dz) > EIGHTHS * solid->extent[1])
            return;
        for (uint32_t x = 0; x < rows->size[0]; x++)
            if (solid_holds(solid, rows->place[x] - centre, dy, dz))
                rows->value[x] = value;
        return;
    }
    const int reach = (int)solid_reach(solid, dy, dz);
    for (uint32_t x = 0; reach >= 0 && x < rows->size[0]; x++)
        rows->value[x] = abs(rows->place[x] - centre) <= reach ? value : rows->value[x];
}

/* Compute the intensities of the row (., y, z). */
static void geom_row(struct geom_rows *rows, uint32_t y, uint32_t z, struct cell *cell)
{
    const int64_t place_y = geom_place(y, rows->size[1], 1);
    const int64_t place_z = geom_place(z, rows->size[2], 2);
    uint64_t voxel = (uint64_t)rows->size[0] * (y + (uint64_t)rows->size[1] * z);
    for (uint32_t x = 0; x < rows->size[0]; x++) /* a graded background */
        rows->value[x] = (uint8_t)(12 + rows->place[x] / (25 * EIGHTHS) + place_z / (20 * EIGHTHS));
    for (size_t i = 0; i < sizeof geom_solid / sizeof geom_solid[0]; i++)
        draw_solid(rows, &geom_solid[i], place_y - EIGHTHS * geom_solid[i].centre[1],
                   place_z - EIGHTHS * geom_solid[i].centre[2]);
    for (uint32_t x = 0; x < rows->size[0]; x++) {
        const int value = rows->value[x] + (int)(hash_mix_at(voxel++, 0) % 9) - 4;
        cell[x].intensity = (uint16_t)(value < 0 ? 0 : value);
    }
}

enum err scene_new_geom_of(struct scene **out, const uint32_t size[3], struct watch *watch,
                           struct fault *fault)
{
    TRY(scene_new(out, size, NULL, watch, fault));
    OWNED(mem_release) int16_t *place = mem_array(size[0], sizeof *place);
    OWNED(mem_release) uint8_t *value = mem_array(size[0], sizeof *value);
    struct geom_rows rows = {{size[0], size[1], size[2]}, place, value};
    if (!place || !value)
        return finish_scene(out, fault_memory(fault, "the synthetic scene"), fault);
    for (uint32_t x = 0; x < size[0]; x++)
        place[x] = (int16_t)geom_place(x, size[0], 0);
    struct grid_walk w = scene_walk(*out, "synthetic scene", NULL, 0);
    while (grid_walk_next(&w))
        geom_row(&rows, w.y, w.z, (*out)->cell + w.row.first);
    return finish_scene(out, OK, fault);
}

enum err scene_new_geom(struct scene **out, unsigned doubled, struct watch *watch,
                        struct fault *fault)
{
    struct scene *base;
    *out = NULL;
    TRY(scene_new_geom_of(doubled ? &base : out, geom_size, watch, fault));
    if (!doubled)
        return OK;
    const enum err err = scene_new_interpolated(out, base, doubled, watch, fault);
    scene_free(base);
    return err;
}

/* ---- digest and proof, of a plain scene or of its cells ---- */

static uint64_t digest_of_geometry(const struct scene *scene)
{
    uint64_t sum = 0;
    for (unsigned a = 0; a < 3; a++) {
        uint64_t axis = (uint64_t)scene->world_axis[a] * 2 + (scene->world_sign[a] < 0);
        sum += hash_mix_at(a, scene->grid.size[a]);
        sum += hash_mix_at(a + 3, scene->spacing_nm[a]);
        sum += hash_mix_at(a + 6, axis);
    }
    return sum;
}

/* Worker 0 polls the watch. */
static uint64_t digest_of_slab(const struct scene *scene, struct slab slab, unsigned worker)
{
    const struct grid *grid = &scene->grid;
    struct grid_walk w = grid_walk(grid, scene->watch, "digest of the scene", slab, worker);
    uint64_t sum = 0, voxel = (uint64_t)slab.first * grid->size[1] * grid->size[0];
    while (grid_walk_next(&w)) {
        uint64_t place = voxel + 16;
        if (scene->plain)
            for (uint32_t x = 0; x < grid->size[0]; x++)
                sum += hash_mix(place++ << 16 | scene->plain[voxel + x]);
        else
            for (uint32_t c = w.row.first; c < w.row.end; c++) {
                scene_fetch_ahead(scene, c);
                sum += hash_mix(place++ << 16 | scene->cell[c].intensity);
            }
        voxel += grid->size[0];
    }
    return sum;
}

uint64_t scene_digest(const struct scene *scene)
{
    return digest_of_geometry(scene) + digest_of_slab(scene, grid_slab(&scene->grid, 0, 1), 0);
}

/* Buffer of intensities for SHA-256. The first piece completes the head to a whole block; all later
 * pieces are whole blocks, which are hashed fastest. */
enum { PROOF_HEAD = 28, PROOF_PIECE = 2048, PROOF_FIRST = (64 - PROOF_HEAD) / 2 };

struct proof {
    struct sha256_ctx sha;
    uint16_t piece[PROOF_PIECE];
    uint32_t held, most;
};

/* Hash plain intensities, or those of cells (plain is NULL). */
static void hash_row(struct proof *proof, const uint16_t *plain, const struct cell *cell,
                     uint32_t count)
{
    for (uint32_t done = 0, n; done < count; done += n) {
        const uint32_t room = proof->most - proof->held, left = count - done;
        uint16_t *out = proof->piece + proof->held;
        n = left < room ? left : room;
        if (plain)
            for (uint32_t i = 0; i < n; i++)
                out[i] = htole16(plain[done + i]);
        else
            for (uint32_t i = 0; i < n; i++)
                out[i] = htole16(cell[done + i].intensity);
        proof->held += n;
        if (proof->held == proof->most) {
            sha256_update(&proof->sha, proof->held * sizeof *proof->piece,
                          (const uint8_t *)proof->piece);
            proof->held = 0;
            proof->most = PROOF_PIECE;
        }
    }
}

void scene_proof(char out[SHA256_HEX], const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    struct proof proof = {.most = PROOF_FIRST};
    const uint16_t *plain = scene->plain;
    struct {
        uint32_t size[3], spacing_nm[3];
        uint8_t axis[4];
    } head = {{0}, {0}, {0}};
    for (unsigned a = 0; a < 3; a++) {
        head.size[a] = htole32(grid->size[a]);
        head.spacing_nm[a] = htole32(scene->spacing_nm[a]);
        head.axis[a] = (uint8_t)(scene->world_axis[a] * 2 + (scene->world_sign[a] < 0));
    }
    static_assert(sizeof head == PROOF_HEAD, "no gaps");
    *out = '\0';
    sha256_init(&proof.sha);
    sha256_update(&proof.sha, sizeof head, (const uint8_t *)&head);
    for (struct grid_walk w = scene_walk(scene, "proof of the scene", NULL, 0);
         grid_walk_next(&w);) {
        hash_row(&proof, plain, scene->cell + w.row.first, grid->size[0]);
        plain = plain ? plain + grid->size[0] : NULL;
    }
    if (scene->watch && scene->watch->stopped)
        return;
    sha256_update(&proof.sha, proof.held * sizeof *proof.piece, (const uint8_t *)proof.piece);
    sha256_hex(out, &proof.sha, SHA256_DIGEST_SIZE);
}

struct identifying {
    const struct scene *scene;
    unsigned workers;
    char *proof;
    uint64_t sum[TEAM_MOST];
};

/* A proof is one long chain: the first worker computes it and polls the watch; the others share the
 * digest, which needs about the same time in total. */
static void identify_part(void *context, unsigned worker)
{
    struct identifying *i = context;
    const unsigned alone = i->workers == 1, parts = i->workers - !alone;
    if (worker == 0)
        scene_proof(i->proof, i->scene);
    if (worker > 0 || alone) {
        const struct slab slab = grid_slab(&i->scene->grid, worker - !alone, parts);
        i->sum[worker] = digest_of_slab(i->scene, slab, worker);
    }
}

void scene_identify(uint64_t *digest, char proof[SHA256_HEX], const struct scene *scene,
                    struct team *team)
{
    struct identifying identifying = {scene, team_size(team), proof, {0}};
    team_run(team, identify_part, &identifying);
    *digest = digest_of_geometry(scene);
    for (unsigned worker = 0; worker < identifying.workers; worker++)
        *digest += identifying.sum[worker];
}
