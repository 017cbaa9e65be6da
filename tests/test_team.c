/* SPDX-License-Identifier: MIT */
/* The team: any number of workers grows the same forest, bit for bit. Also run under
 * ThreadSanitizer (test_team_racing). */
#include "tests/check_main.h"
#include "scarce_memory.h"
#include "stopping.h"
#include "world.h"

#include "base/team.h"

enum { WORKERS = 8 };

/* ThreadSanitizer has its own worlds. Each world is grown by one in SHARE of the teams. */
#ifdef __SANITIZE_THREAD__
enum { FIRST = 101 };
#else
enum { FIRST = 1 };
#endif
enum { SHARE = 2 };

/* ---- the team itself ---- */

struct sums {
    struct team *team;
    unsigned part[TEAM_MOST];
    bool fine[TEAM_MOST];
};

/* All write, meet, read what all have written, and meet again. */
static void count_rounds(void *context, unsigned worker)
{
    struct sums *sums = context;
    sums->fine[worker] = true;
    for (unsigned round = 1; round <= 200; round++) {
        sums->part[worker] = round;
        team_wait(sums->team);
        for (unsigned i = 0; i < team_size(sums->team); i++)
            sums->fine[worker] = sums->fine[worker] && sums->part[i] == round;
        team_wait(sums->team);
    }
}

STORY(workers_that_meet_see_what_the_others_wrote)
{
    for (unsigned workers = 1; workers <= WORKERS; workers++) {
        struct sums sums = {0};
        CHECK(team_new(&sums.team, workers, NULL) == OK);
        CHECK_INT(team_size(sums.team), workers);
        for (int again = 0; again < 3; again++) {
            team_run(sums.team, count_rounds, &sums);
            for (unsigned i = 0; i < workers; i++)
                CHECK(sums.fine[i]);
        }
        team_free(sums.team);
    }
}

STORY(shares_cover_everything_once)
{
    struct team *team;
    CHECK(team_new(&team, 3, NULL) == OK);
    for (size_t count = 0; count < 20; count++) {
        size_t next = 0;
        for (unsigned i = 0; i < team_size(team); i++) {
            const struct share share = team_share(team, i, count);
            CHECK_INT(share.first, next);
            CHECK(share.end - share.first <= count / 3 + 1);
            next = share.end;
        }
        CHECK_INT(next, count);
    }
    team_free(team);
    CHECK_INT(team_share(NULL, 0, 7).end, 7);
}

/* ---- forests ---- */

/* Return the same world for the same number, whatever the team. */
static struct world random_world(uint64_t number, struct team *team)
{
    uint64_t random = number;
    const uint32_t size[3] = {1 + check_below(&random, 30), 1 + check_below(&random, 30),
                              1 + check_below(&random, 30)};
    const uint32_t steep = 1 + check_below(&random, 3) * 6;
    struct arc_rule rule = {.kind = check_below(&random, 3), .polarity = {0, 50, -70}};
    struct world w = {0};
    CHECK(scene_new(&w.scene, size, NULL, NULL, NULL) == OK);
    CHECK(forest_new(&w.forest, w.scene, check_below(&random, 3) ? 6 : 26, NULL) == OK);
    CHECK(forest_set_team(w.forest, team, NULL) == OK);
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++) {
                struct cell *cell = w.scene->cell + grid_cell(&w.scene->grid, x, y, z);
                cell->weight = (uint16_t)check_below(&random, steep);
                cell->intensity = (uint16_t)check_below(&random, steep);
            }
    forest_set_arcs(w.forest, &rule);
    return w;
}

enum { BATCH = 40 };

static size_t random_batch(const struct world *w, struct edit *batch, uint64_t *random)
{
    const size_t count = 1 + check_below(random, BATCH);
    for (size_t i = 0; i < count; i++)
        batch[i] = (struct edit){random_voxel(&w->scene->grid, random),
                                 (int16_t)((int)check_below(random, 4) - 1), 0};
    return count;
}

/* Grow from scratch, edit, and recompute everything. */
static void grow(struct world *w, uint64_t number)
{
    uint64_t random = number * 31;
    struct edit batch[BATCH];
    CHECK(forest_edit(w->forest, batch, random_batch(w, batch, &random), NULL) == OK);
    CHECK(forest_edit(w->forest, batch, random_batch(w, batch, &random), NULL) == OK);
    if (number % 2)
        CHECK(forest_rebuild(w->forest, NULL) == OK);
}

STORY(one_to_eight_workers_grow_the_same_forest)
{
    struct team *team[WORKERS + 1] = {NULL};
    for (unsigned workers = 2; workers <= WORKERS; workers++)
        CHECK(team_new(&team[workers], workers, NULL) == OK);
    for (uint64_t number = FIRST; number < FIRST + check_scaled(8) && check_failures == 0;
         number++) {
        OWNED(world_free) struct world alone = random_world(number, NULL);
        grow(&alone, number);
        CHECK(forest_check(alone.forest, NULL));
        for (unsigned workers = 2; workers <= WORKERS; workers++) {
            if ((number + workers) % SHARE != 0)
                continue;
            OWNED(world_free) struct world w = random_world(number, team[workers]);
            grow(&w, number);
            CHECK(forest_check(w.forest, NULL));
            if (!CHECK(world_is_same(&alone, &w)))
                printf("# world %" PRIu64 ", %u workers\n", number, workers);
        }
    }
    for (unsigned workers = 2; workers <= WORKERS; workers++)
        team_free(team[workers]);
}

/* Planes of random weights have small levels: one worker serves them for all. The planes between
 * them have large levels, for which it calls the others. */
static struct world layered_world(struct team *team)
{
    enum { SIDE = 66, PLANES = 12 };
    uint64_t random = FIRST;
    struct world w = world_new(SIDE, SIDE, PLANES, 6);
    CHECK(forest_set_team(w.forest, team, NULL) == OK);
    for (struct grid_walk rows = grid_rows(&w.scene->grid, NULL, NULL); grid_walk_next(&rows);)
        for (uint32_t c = rows.row.first; c < rows.row.end; c++)
            w.scene->cell[c].weight = (uint16_t)(10000 * (rows.z / 2) +
                                                 (rows.z / 2 % 2 ? 0 : check_below(&random, 9999)));
    return w;
}

STORY(one_worker_serves_small_levels_for_all)
{
    static const unsigned sizes[] = {2, 3, WORKERS, TEAM_MOST};
    OWNED(world_free) struct world alone = layered_world(NULL);
    const uint32_t first = grid_cell(&alone.scene->grid, 0, 0, 0);
    const struct edit seed[] = {{first, 1, 0}, {first + 50, 2, 0}};
    uint64_t random = FIRST;
    CHECK(forest_edit(alone.forest, seed, 2, NULL) == OK && forest_check(alone.forest, NULL));
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        OWNED(team_drop) struct team *team;
        CHECK(team_new(&team, sizes[i], NULL) == OK);
        OWNED(world_free) struct world w = layered_world(team);
        for (size_t n = 0; n < check_scaled(2); n++) {
            int looks = (int)check_below(&random, 20000);
            struct watch watch = {.context = &looks, .poll = stop_after_looks};
            w.scene->watch = &watch;
            if (forest_edit(w.forest, seed, 2, NULL) == OK)
                CHECK(world_is_same(&alone, &w) &&
                      forest_edit(
                          w.forest,
                          (struct edit[]){{first, EDIT_ERASE, 0}, {first + 50, EDIT_ERASE, 0}}, 2,
                          NULL) == OK);
            w.scene->watch = NULL;
            CHECK(forest_seeds(w.forest) == 0 && forest_check(w.forest, NULL));
        }
        CHECK(forest_edit(w.forest, seed, 2, NULL) == OK);
        CHECK(world_is_same(&alone, &w));
    }
}

STORY(a_shared_pass_cancelled_at_any_level_leaves_an_empty_forest)
{
    OWNED(team_drop) struct team *team;
    CHECK(team_new(&team, 3, NULL) == OK);
    for (uint64_t number = FIRST; number < FIRST + check_scaled(3) && check_failures == 0;
         number++) {
        uint64_t random = number;
        OWNED(world_free) struct world w = random_world(number, team);
        struct edit batch[BATCH];
        const size_t count = random_batch(&w, batch, &random);
        enum err err = ERR_CANCELLED;
        for (int looks = 0; err && check_failures == 0; looks++) {
            int left = looks;
            struct watch watch = {.context = &left, .poll = stop_after_looks};
            w.scene->watch = &watch;
            err = forest_edit(w.forest, batch, count, NULL);
            w.scene->watch = NULL;
            if (!err)
                break;
            CHECK_INT(err, ERR_CANCELLED);
            CHECK(forest_seeds(w.forest) == 0 && forest_digest(w.forest) == 0);
            CHECK(forest_check(w.forest, NULL));
        }
        CHECK(forest_check(w.forest, NULL));
    }
}

STORY(workers_out_of_memory_leave_an_empty_forest)
{
    OWNED(team_drop) struct team *team;
    CHECK(team_new(&team, 2, NULL) == OK);
    for (uint64_t number = 1; number <= 6; number++) {
        uint64_t random = number;
        OWNED(world_free) struct world w = random_world(number, NULL);
        struct edit batch[BATCH];
        const size_t count = random_batch(&w, batch, &random);
        enum err err = ERR_MEMORY;
        for (size_t allowed = 0; err; allowed++) {
            allow_allocations(allowed);
            err = forest_set_team(w.forest, team, NULL);
            mem_allows = NULL;
            CHECK(err == OK || err == ERR_MEMORY);
        }
        allow_allocations(0);
        CHECK_INT(forest_edit(w.forest, batch, count, NULL), ERR_MEMORY);
        mem_allows = NULL;
        CHECK(forest_seeds(w.forest) == 0 && forest_check(w.forest, NULL));
        CHECK(forest_edit(w.forest, batch, count, NULL) == OK && forest_check(w.forest, NULL));
    }
}
