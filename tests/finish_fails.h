/* SPDX-License-Identifier: MIT */
/* What programs about the steps of `finish` share: the teams; and if a step is stopped or memory
 * runs out at any point, it is an error that changes nothing, and the next call is correct. */
#ifndef TESTS_FINISH_FAILS_H
#define TESTS_FINISH_FAILS_H

#include "engine/finish.h"
#include "tests/check.h"
#include "tests/scarce_memory.h"
#include "tests/stopping.h"

enum { TEAMS = 5 }; /* none, and those of 1, 2, 3 and 8 threads */
static struct team *team_of[TEAMS];

/* Whether labels [cells] of a scene are those of a model. */
typedef bool finish_judge(const void *expected, const struct scene *scene, const uint8_t *label);

/* Returns how often it was tried, each time with another team. */
static inline int stop_finish_everywhere(struct scene *scene, const struct finish_list *list,
                                         finish_judge *is_right, const void *expected)
{
    enum err err = ERR_CANCELLED;
    int tries = 0;
    for (; err == ERR_CANCELLED && tries < 100000; tries++) {
        int looks = tries;
        struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
        uint8_t *label;
        scene->watch = &watch;
        err = finish_make(&label, list, scene, team_of[tries % 4], NULL, NULL);
        CHECK(err == ERR_CANCELLED ? !label : err == OK && is_right(expected, scene, label));
        mem_pages_free(label, scene->grid.cells);
    }
    scene->watch = NULL;
    CHECK(err == OK);
    return tries;
}

static inline size_t starve_finish_everywhere(const struct scene *scene,
                                              const struct finish_list *list,
                                              finish_judge *is_right, const void *expected)
{
    enum err err = ERR_MEMORY;
    size_t allocations = 0;
    for (; err == ERR_MEMORY && allocations < 1000; allocations++) {
        uint8_t *label;
        allow_allocations(allocations);
        err = finish_make(&label, list, scene, NULL, NULL, NULL);
        mem_allows = NULL;
        CHECK(err == ERR_MEMORY ? !label : err == OK && is_right(expected, scene, label));
        mem_pages_free(label, scene->grid.cells);
    }
    CHECK(err == OK);
    return allocations;
}

int main(void)
{
    for (unsigned i = 1; i < TEAMS; i++)
        if (team_new(&team_of[i], i < 4 ? i : 8, NULL) != OK)
            abort();
    const int status = check_run();
    for (unsigned i = 1; i < TEAMS; i++)
        team_free(team_of[i]);
    return status;
}

#endif
