/* SPDX-License-Identifier: MIT */
/* The centre of a label, compared with two searches of the whole scene. */
#include "engine/measure.h"
#include "tests/check_main.h"
#include "tests/interpreting.h"

/* By the definition in measure.h. */
static bool slow_centre(const struct scene *scene, unsigned label, uint32_t place[3])
{
    int64_t sum[3] = {0}, count = 0, best = INT64_MAX;
    for (int look = 0; look < 2; look++)
        for (size_t c = 0; c < scene->grid.cells; c++) {
            const struct cell *cell = scene->cell + c;
            if (cell->flags & CELL_RIM || !cell_is_reached(cell) || cell->label != label)
                continue;
            const struct place p = grid_place(&scene->grid, (uint32_t)c);
            const int64_t at[3] = {p.x, p.y, p.z};
            int64_t squared = 0;
            count += look == 0;
            for (int a = 0; a < 3; a++) {
                sum[a] += look == 0 ? at[a] : 0;
                squared += (at[a] - sum[a] / count) * (at[a] - sum[a] / count);
            }
            if (look == 0 || squared >= best)
                continue;
            best = squared;
            for (int a = 0; a < 3; a++)
                place[a] = (uint32_t)at[a];
        }
    return count > 0;
}

STORY(a_centre_equals_a_slow_search)
{
    static const uint32_t size[3] = {23, 17, 12};
    uint64_t random = 3;
    unsigned found = 0, none = 0;
    OWNED(interpreter_release) struct interpreter interp;
    CHECK(interpreter_init(&interp, NULL) == OK);
    must(&interp, "open synth:geom:23x17x12");
    for (int round = 0; round < 60 && check_failures == 0; round++) {
        char line[64];
        const unsigned radius = check_below(&random, 4) ? 0 : 3;
        snprintf(line, sizeof line, "seed %u,%u,%u %u radius=%u", check_below(&random, size[0]),
                 check_below(&random, size[1]), check_below(&random, size[2]),
                 check_below(&random, 5), radius);
        must(&interp, line);
        must(&interp, "run");
        for (unsigned label = 0; label < 6; label++) {
            uint32_t fast[3] = {0}, slow[3] = {0};
            const bool is_there = slow_centre(interp.session->scene, label, slow);
            CHECK(centre_of_label(interp.session->scene, label, fast) == is_there);
            CHECK(memcmp(fast, slow, sizeof fast) == 0);
            found += is_there;
            none += !is_there;
        }
    }
    CHECK(found > 100 && none > 50);
}

static bool stop(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)context;
    (void)what;
    (void)done;
    (void)total;
    return true;
}

STORY(the_search_for_it_can_be_stopped)
{
    OWNED(interpreter_release) struct interpreter interp;
    struct watch watch = {.poll = stop, .step = 1};
    uint32_t place[3];
    CHECK(interpreter_init(&interp, NULL) == OK);
    must(&interp, "open synth:geom:23x17x12; seed 3,4,5 2; run");
    CHECK(centre_of_label(interp.session->scene, 2, place));
    interp.session->scene->watch = &watch;
    CHECK(!centre_of_label(interp.session->scene, 2, place));
    interp.session->scene->watch = NULL;
}
