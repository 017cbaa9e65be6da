/* SPDX-License-Identifier: MIT */
/* By what scenes are known apart: a digest and a proof, of a plain scene or of its cells. */
#include "engine/scene.h"

#include <endian.h>
#include <nettle/sha2.h>

/* ---- digest ---- */

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

/* The voxels of row y, z, the first of which has this index. */
static uint64_t digest_of_row(const struct scene *scene, uint32_t y, uint32_t z, uint64_t voxel)
{
    const struct span row = grid_row(&scene->grid, y, z);
    const uint16_t *plain = scene->plain ? scene->plain + voxel : NULL;
    uint64_t sum = 0, place = voxel + 16;
    if (plain)
        for (uint32_t x = 0; x < scene->grid.size[0]; x++)
            sum += hash_mix(place++ << 16 | plain[x]);
    else
        for (uint32_t c = row.first; c < row.end; c++) {
            scene_fetch_ahead(scene, c);
            sum += hash_mix(place++ << 16 | scene->cell[c].intensity);
        }
    return sum;
}

/* Worker 0 looks at the watch. */
static uint64_t digest_of_slab(const struct scene *scene, struct slab slab, unsigned worker)
{
    const struct grid *grid = &scene->grid;
    uint64_t sum = 0, voxel = (uint64_t)slab.first * grid->size[1] * grid->size[0];
    struct task task =
        task_begin_part(scene->watch, "digest of the scene", slab_voxels(grid, slab), worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++, voxel += grid->size[0]) {
            sum += digest_of_row(scene, y, z, voxel);
            if (!task_advance(&task, grid->size[0]))
                return 0;
        }
    return sum;
}

uint64_t scene_digest(const struct scene *scene)
{
    return digest_of_geometry(scene) + digest_of_slab(scene, grid_slab(&scene->grid, 0, 1), 0);
}

/* ---- proof ---- */

static void put_le32(uint8_t *out, uint32_t value)
{
    for (unsigned i = 0; i < 4; i++)
        out[i] = (uint8_t)(value >> 8 * i);
}

/* Intensities on their way to SHA-256. What follows the head makes it up to a whole block; from
 * then on pieces are whole blocks, which are taken fastest. */
enum { PROOF_PIECE = 2048, PROOF_FIRST = (64 - 28) / 2 };

struct proof {
    struct sha256_ctx sha;
    uint16_t piece[PROOF_PIECE];
    uint32_t held, most;
};

/* Of plain intensities, or (NULL) of cells. */
static void prove_row(struct proof *proof, const uint16_t *plain, const struct cell *cell,
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
    struct task task = task_begin(scene->watch, "proof of the scene", grid->voxels);
    *out = '\0';
    sha256_init(&proof.sha);
    uint8_t head[28] = {0};
    for (unsigned a = 0; a < 3; a++) {
        put_le32(head + 4 * a, scene->grid.size[a]);
        put_le32(head + 12 + 4 * a, scene->spacing_nm[a]);
        head[24 + a] = (uint8_t)(scene->world_axis[a] * 2 + (scene->world_sign[a] < 0));
    }
    sha256_update(&proof.sha, sizeof head, head);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            prove_row(&proof, plain, scene->cell + grid_row(grid, y, z).first, grid->size[0]);
            plain = plain ? plain + grid->size[0] : NULL;
            if (!task_advance(&task, grid->size[0]))
                return;
        }
    sha256_update(&proof.sha, proof.held * sizeof *proof.piece, (const uint8_t *)proof.piece);
    sha256_hex(out, &proof.sha, SHA256_DIGEST_SIZE);
}

/* ---- both ---- */

struct identifying {
    const struct scene *scene;
    unsigned workers;
    char *proof;
    uint64_t sum[TEAM_MOST];
};

/* A proof is one long chain: the first worker makes it, and looks at the watch meanwhile; the
 * others share the digest, which takes about as long in all. */
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
