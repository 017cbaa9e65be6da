/* SPDX-License-Identifier: MIT */
/* A small test driver: each test program is one file of named stories, run in the order of the
 * file.
 *
 *     STORY(planting_a_seed_claims_the_scene) { CHECK(a == b); CHECK_INT(n, 3); }
 *     int main(void) { return check_run(); }
 *
 * A story goes on after a failed check; it counts once, as passed or failed. Output is TAP:
 * "ok 1 - name" or "not ok 1 - name" with the failed checks before it as comments. What this
 * machine cannot do is said by SKIP("why"): "ok 1 - name # SKIP why", which does not count as
 * passed. */
#ifndef TESTS_CHECK_H
#define TESTS_CHECK_H

#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/drop.h" /* OWNED */

static unsigned check_failures;   /* of the current story */
static const char *check_missing; /* why it, or a part of it, was not done; or NULL */

static inline bool check_report(bool fine, const char *file, int line, const char *text)
{
    if (!fine && check_failures++ < 10)
        printf("# %s:%d: %s\n", file, line, text);
    return fine;
}

#define CHECK(condition) check_report((condition), __FILE__, __LINE__, #condition)
/* The same, and say more if it fails: CHECK_WITH(err == OK, "%s", fault.text). */
#define CHECK_WITH(condition, ...)                                                                 \
    do {                                                                                           \
        if (!check_report((condition), __FILE__, __LINE__, #condition)) {                          \
            printf("#   ");                                                                        \
            printf(__VA_ARGS__);                                                                   \
            putchar('\n');                                                                         \
        }                                                                                          \
    } while (0)
#define CHECK_INT(actual, expected)                                                                \
    do {                                                                                           \
        int64_t check_a = (int64_t)(actual), check_e = (int64_t)(expected);                        \
        if (!check_report(check_a == check_e, __FILE__, __LINE__, #actual " == " #expected))       \
            printf("#   is %" PRId64 ", expected %" PRId64 "\n", check_a, check_e);                \
    } while (0)
#define CHECK_TEXT(actual, expected)                                                               \
    do {                                                                                           \
        const char *check_a = (actual), *check_e = (expected);                                     \
        if (!check_report(strcmp(check_a, check_e) == 0, __FILE__, __LINE__,                       \
                          #actual " == " #expected))                                               \
            printf("#   is \"%s\"\n#   expected \"%s\"\n", check_a, check_e);                      \
    } while (0)
#define CHECK_HAS(text, part)                                                                      \
    do {                                                                                           \
        const char *check_a = (text), *check_e = (part);                                           \
        if (!check_report(strstr(check_a, check_e) != NULL, __FILE__, __LINE__,                    \
                          #text " has " #part))                                                    \
            printf("#   is \"%s\"\n#   expected a part \"%s\"\n", check_a, check_e);               \
    } while (0)

#define SKIP(why) (void)(check_missing = (why))

struct story {
    const char *name;
    void (*run)(void);
    int line;
    struct story *next;
};
static struct story *check_stories; /* ordered by line */

static inline void check_register(struct story *story)
{
    struct story **at = &check_stories;
    while (*at && (*at)->line < story->line)
        at = &(*at)->next;
    story->next = *at;
    *at = story;
}

/* Define a story, which registers itself before main begins. */
#define STORY(told)                                                                                \
    static void story_##told(void);                                                                \
    __attribute__((constructor)) static void check_add_##told(void)                                \
    {                                                                                              \
        static struct story entry = {.name = #told, .run = story_##told, .line = __LINE__};        \
        check_register(&entry);                                                                    \
    }                                                                                              \
    static void story_##told(void)

/* Define a story with a statement before and one after it. */
#define STORY_WITHIN(told, begin, end)                                                             \
    static void told_##told(void);                                                                 \
    STORY(told)                                                                                    \
    {                                                                                              \
        begin;                                                                                     \
        told_##told();                                                                             \
        end;                                                                                       \
    }                                                                                              \
    static void told_##told(void)

/* Functions that are called before and after each story, or NULL. */
static void (*check_before)(void), (*check_after)(void);
#define EACH_STORY(begin, end)                                                                     \
    __attribute__((constructor)) static void check_each(void)                                      \
    {                                                                                              \
        check_before = begin;                                                                      \
        check_after = end;                                                                         \
    }

/* Run all stories in the order of the file; return the status of the program. */
static inline int check_run(void)
{
    unsigned count = 0, failed = 0;
    for (const struct story *story = check_stories; story; story = story->next) {
        check_failures = 0;
        check_missing = NULL;
        if (check_before)
            check_before();
        story->run();
        if (check_after)
            check_after();
        failed += check_failures > 0;
        printf("%s %u - %s", check_failures ? "not ok" : "ok", ++count, story->name);
        if (check_missing && !check_failures)
            printf(" # SKIP %s", check_missing);
        putchar('\n');
        fflush(stdout);
    }
    printf("1..%u\n", count);
    return failed ? 1 : 0;
}

/* A small deterministic generator for property tests (splitmix64). */
static inline uint64_t check_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}
static inline uint32_t check_below(uint64_t *state, uint32_t bound)
{
    return (uint32_t)((check_random(state) >> 32) * (uint64_t)bound >> 32);
}

/* Define below(bound), a random number from the generator `seed`. */
#define DRAW_FROM(first)                                                                           \
    static uint64_t seed = first;                                                                  \
    static uint32_t below(uint32_t bound)                                                          \
    {                                                                                              \
        return check_below(&seed, bound);                                                          \
    }

/* So many rounds, or as many times more as `make test-long` asks for. */
static inline unsigned check_scaled(unsigned count)
{
    const char *factor = getenv("IFTTY_TEST_SCALE");
    return factor ? count * (unsigned)atoi(factor) : count;
}

#endif
