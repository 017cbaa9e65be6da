/* SPDX-License-Identifier: MIT */
/* The works as a program: works FOLDER [THREADS]. See works.h. */
#include "tests/matrix/works.h"

#include <nettle/sha2.h>
#include <stdarg.h>

#include "base/hash.h"
#include "tests/check.h"

void must(enum err err, const struct fault *fault, const char *what)
{
    if (!err)
        return;
    printf("%s failed: %s\n", what, fault->text);
    exit(1);
}

void must_hold(bool holds, const char *what)
{
    if (holds)
        return;
    printf("%s does not hold\n", what);
    exit(1);
}

void tell(uint64_t digest, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vprintf(format, list);
    va_end(list);
    printf(" %016" PRIx64 "\n", digest);
}

uint64_t bytes_digest(const void *bytes, size_t length)
{
    struct sha256_ctx state;
    uint8_t digest[SHA256_DIGEST_SIZE];
    uint64_t first = 0;
    sha256_init(&state);
    sha256_update(&state, length, bytes);
    sha256_digest(&state, sizeof digest, digest);
    for (int i = 0; i < 8; i++)
        first = first << 8 | digest[i];
    return first;
}

struct scene *works_scene(void)
{
    static const uint32_t size[3] = {46, 40, 33}, spacing[3] = {1000000, 900000, 1300000};
    static const int8_t axis[3] = {1, 0, 2}, sign[3] = {-1, 1, 1};
    struct scene *scene = NULL;
    struct fault fault;
    must(scene_new_geom_of(&scene, size, NULL, &fault), &fault, "a scene");
    memcpy(scene->spacing_nm, spacing, sizeof spacing);
    memcpy(scene->world_axis, axis, sizeof axis);
    memcpy(scene->world_sign, sign, sizeof sign);
    return scene;
}

void works_edits(struct edit edit[WORKS_SEEDS], const struct scene *scene, uint64_t random)
{
    const uint32_t *size = scene->grid.size;
    for (int i = 0; i < WORKS_SEEDS; i++) {
        const uint32_t x = check_below(&random, size[0]), y = check_below(&random, size[1]),
                       z = check_below(&random, size[2]);
        edit[i] = (struct edit){grid_cell(&scene->grid, x, y, z), (int16_t)(i % 6), 0};
        for (int k = 0; k < i; k++)
            if (edit[k].cell == edit[i].cell)
                i--, k = i;
    }
}

int main(int count, char **word)
{
    OWNED(team_drop) struct team *team = NULL;
    struct fault fault;
    const int threads = count > 2 ? atoi(word[2]) : 1;
    must_hold(count > 1 && threads >= 1 && threads <= TEAM_MOST, "works FOLDER [THREADS 1..64]");
    must(team_new(&team, (unsigned)threads, &fault), &fault, "a team");
    must_hold(team_size(team) == (unsigned)threads, "a team of as many threads");
    works_engine(team);
    works_render();
    works_journal(word[1]);
    return 0;
}
