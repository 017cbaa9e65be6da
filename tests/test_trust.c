/* What others' journals are measured by: SHA-256 and the proof of a scene. */
#include <stdlib.h>

#include "base/hash.h"
#include "check.h"
#include "engine/scene.h"

/* ---- SHA-256 ---- */

static void digest_in_pieces(char hex[SHA256_HEX], const uint8_t *bytes, size_t length,
                             uint64_t *random, uint32_t most)
{
    struct sha256 sha;
    uint8_t digest[SHA256_BYTES];
    sha256_init(&sha);
    while (length > 0) {
        size_t n = 1 + check_below(random, most);
        n = n < length ? n : length;
        sha256_add(&sha, bytes, n);
        bytes += n;
        length -= n;
    }
    sha256_end(&sha, digest);
    hash_hex(hex, digest, sizeof digest);
}

STORY(the_digests_of_the_standard)
{
    char hex[SHA256_HEX];
    uint64_t random = 1;
    uint8_t *many = malloc(1000000);
    CHECK(many != NULL);
    if (!many)
        return;
    memset(many, 'a', 1000000);
    for (int plain = 0; plain < 2; plain++) {
        sha256_is_plain = plain;
        digest_in_pieces(hex, (const uint8_t *)"abc", 3, &random, 3);
        CHECK_TEXT(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        digest_in_pieces(hex, many, 1000000, &random, 1000000);
        CHECK_TEXT(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }
    sha256_is_plain = false;
    free(many);
}

STORY(fast_and_plain_digests_agree_however_the_bytes_are_cut)
{
    uint8_t bytes[5000];
    char fast[SHA256_HEX], plain[SHA256_HEX];
    uint64_t random = 2;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)check_random(&random);
    for (int round = 0; round < 3000; round++) {
        const size_t length = check_below(&random, sizeof bytes);
        const uint32_t most = 1 + check_below(&random, round % 2 ? 70 : 700);
        digest_in_pieces(fast, bytes, length, &random, most);
        sha256_is_plain = true;
        digest_in_pieces(plain, bytes, length, &random, most);
        sha256_is_plain = false;
        CHECK_TEXT(fast, plain);
    }
}

/* ---- the proof of a scene ---- */

static struct scene *small_scene(void)
{
    static const uint32_t size[3] = {37, 5, 3};
    struct scene *scene = NULL;
    CHECK_INT(scene_new(&scene, size, NULL), OK);
    uint64_t random = 3;
    for (uint32_t z = 0; scene && z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++)
                scene->cell[grid_cell(&scene->grid, x, y, z)].intensity =
                    (uint16_t)check_random(&random);
    return scene;
}

/* The bytes as engine/scene.h tells them, one by one. */
static void plain_proof(char hex[SHA256_HEX], const struct scene *scene)
{
    struct sha256 sha;
    uint8_t digest[SHA256_BYTES];
    sha256_init(&sha);
    for (int i = 0; i < 24; i++) {
        const uint32_t of = i < 12 ? scene->grid.size[i / 4] : scene->spacing_nm[i / 4 - 3];
        sha256_add(&sha, &(uint8_t){(uint8_t)(of >> 8 * (i % 4))}, 1);
    }
    for (int a = 0; a < 3; a++)
        sha256_add(&sha,
                   &(uint8_t){(uint8_t)(2 * scene->world_axis[a] + (scene->world_sign[a] < 0))}, 1);
    sha256_add(&sha, "", 1);
    for (uint32_t z = 0; z < scene->grid.size[2]; z++)
        for (uint32_t y = 0; y < scene->grid.size[1]; y++)
            for (uint32_t x = 0; x < scene->grid.size[0]; x++) {
                const uint16_t v = scene->cell[grid_cell(&scene->grid, x, y, z)].intensity;
                sha256_add(&sha, (uint8_t[2]){(uint8_t)v, (uint8_t)(v >> 8)}, 2);
            }
    sha256_end(&sha, digest);
    hash_hex(hex, digest, sizeof digest);
}

STORY(the_proof_is_what_its_header_says)
{
    struct scene *scene = small_scene();
    char proof[SCENE_PROOF_HEX], expected[SHA256_HEX];
    if (!scene)
        return;
    scene->spacing_nm[1] = 1234567;
    scene->world_axis[0] = 2;
    scene->world_axis[2] = 0;
    scene->world_sign[1] = -1;
    scene_proof(proof, scene);
    plain_proof(expected, scene);
    CHECK_TEXT(proof, expected);
    scene_free(scene);
}

STORY(whatever_changes_in_a_scene_changes_its_proof)
{
    struct scene *scene = small_scene();
    char before[SCENE_PROOF_HEX], after[SCENE_PROOF_HEX];
    if (!scene)
        return;
    scene_proof(before, scene);
    for (uint32_t x = 0; x < 37; x++) {
        struct cell *cell = &scene->cell[grid_cell(&scene->grid, x, x % 5, x % 3)];
        cell->intensity ^= 1;
        scene_proof(after, scene);
        CHECK(strcmp(before, after) != 0);
        cell->intensity ^= 1;
    }
    scene->spacing_nm[2]++;
    scene_proof(after, scene);
    CHECK(strcmp(before, after) != 0);
    scene->spacing_nm[2]--;
    scene->world_sign[0] = -1;
    scene_proof(after, scene);
    CHECK(strcmp(before, after) != 0);
    scene->world_sign[0] = 1;
    scene->cell[grid_cell(&scene->grid, 1, 1, 1)].label = 7; /* not of the scene itself */
    scene_proof(after, scene);
    CHECK_TEXT(after, before);
    scene_free(scene);
}

int main(void)
{
    const struct story story[] = {
        TELL(the_digests_of_the_standard),
        TELL(fast_and_plain_digests_agree_however_the_bytes_are_cut),
        TELL(the_proof_is_what_its_header_says),
        TELL(whatever_changes_in_a_scene_changes_its_proof),
    };
    return check_run(story, sizeof story / sizeof *story);
}
