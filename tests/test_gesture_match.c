/* SPDX-License-Identifier: MIT */
/*
 * Gestures of an expert and of a trainee that belong together, and their order: cases worked by
 * hand, and random ones beside plain slow computations.
 */
#include "verify/gesture_match.h"

#include <stdlib.h>

#include "base/mem.h"
#include "tests/check.h"

enum { MOST = 40 };

static uint64_t random_state = 1;
static const uint32_t size[3] = {100, 100, 100}, mm[3] = {1000000, 1000000, 1000000};
static struct gesture_match match;
static struct fault fault;

/* Balls of label 1 at these places along x, one after the other. */
static struct gestures row_of(struct gesture *room, const uint32_t *x, size_t count)
{
    for (size_t i = 0; i < count; i++)
        room[i] = (struct gesture){.record = i + 1,
                                   .label = 1,
                                   .kind = GESTURE_BALL,
                                   .has_place = true,
                                   .doubled = {2 * x[i], 100, 100}};
    return (struct gestures){.count = count, .gesture = room};
}

static bool make(const struct gestures *expert, const struct gestures *trainee)
{
    free(match.pair);
    return CHECK(gesture_match_make(&match, expert, trainee, size, mm, NULL, &fault) == OK);
}

static void is_pair(size_t number, uint32_t expert, uint32_t trainee, double apart_mm)
{
    if (!CHECK(number < match.pairs))
        return;
    CHECK_INT(match.pair[number].expert, expert);
    CHECK_INT(match.pair[number].trainee, trainee);
    CHECK(gesture_pair_mm(&match, &match.pair[number]) == apart_mm);
}

STORY(the_nearest_are_matched_first_each_once)
{
    struct gesture a[MOST], b[MOST];
    /* 12 is nearer to 11 than 10 is, and 10 takes what is left of it: 4. */
    const uint32_t at[] = {10, 12, 60}, by[] = {11, 4, 90, 58};
    const struct gestures expert = row_of(a, at, 3), trainee = row_of(b, by, 4);
    if (!make(&expert, &trainee))
        return;
    CHECK_INT(match.pairs, 3);
    is_pair(0, 0, 0, 1); /* as near as 12 and 11: the expert's first */
    is_pair(1, 1, 1, 8);
    is_pair(2, 2, 3, 2);
    CHECK(match.limit_mm == 10);
    CHECK_INT(match.agreeing, 3);
    CHECK_INT(match.disagreeing, 0);
    CHECK_INT(match.longest, 3);
}

STORY(of_two_as_far_apart_the_first_of_the_trainee_is_taken)
{
    struct gesture a[MOST], b[MOST];
    const uint32_t at[] = {50}, by[] = {52, 48, 48};
    const struct gestures expert = row_of(a, at, 1), trainee = row_of(b, by, 3);
    if (make(&expert, &trainee))
        is_pair(0, 0, 0, 2);
}

STORY(a_tenth_of_the_longest_side_is_matched_and_no_more)
{
    struct gesture a[MOST], b[MOST];
    const uint32_t at[] = {0}, near[] = {10}, far[] = {11};
    const struct gestures expert = row_of(a, at, 1);
    struct gestures trainee = row_of(b, near, 1);
    make(&expert, &trainee);
    CHECK_INT(match.pairs, 1);
    trainee = row_of(b, far, 1);
    make(&expert, &trainee);
    CHECK_INT(match.pairs, 0);
    CHECK_INT(match.agreeing + match.disagreeing + match.longest, 0);
}

STORY(labels_eliminators_and_what_is_taken_back_are_kept_apart)
{
    struct gesture a[MOST], b[MOST];
    const uint32_t at[] = {5, 5, 5, 5}, by[] = {5, 5, 5, 5};
    const struct gestures expert = row_of(a, at, 4), trainee = row_of(b, by, 4);
    a[0].label = 2;
    a[1].label = GESTURE_ERASES;
    a[2].is_taken_back = true;
    a[3].has_place = false;
    b[0].label = GESTURE_ERASES;
    b[1].is_taken_back = true;
    b[2].label = 3;
    if (!make(&expert, &trainee))
        return;
    CHECK_INT(match.pairs, 1);
    is_pair(0, 1, 0, 0);
}

STORY(distances_are_in_the_world)
{
    struct gesture a[MOST], b[MOST];
    const uint32_t at[] = {10}, by[] = {13}, long_mm[3] = {500000, 1000000, 3300000};
    const struct gestures expert = row_of(a, at, 1), trainee = row_of(b, by, 1);
    b[0].doubled[2] += 3; /* a voxel and a half */
    free(match.pair);
    CHECK(gesture_match_make(&match, &expert, &trainee, size, long_mm, NULL, &fault) == OK);
    CHECK_INT(match.pairs, 1);
    const double apart = gesture_pair_mm(&match, match.pair);
    CHECK(apart > 5.1722 && apart < 5.1723); /* the root of 1.5^2 + 4.95^2 */
}

/* The corners of the largest scene there can be, whose squares are the largest numbers. */
STORY(the_largest_distances_do_not_wrap_around)
{
    struct gesture a[MOST], b[MOST];
    const uint32_t at[] = {0}, by[] = {65533}, largest[3] = {65534, 65534, 65534},
                   metre[3] = {1000000000, 999999999, 999999998};
    const struct gestures expert = row_of(a, at, 1), trainee = row_of(b, by, 1);
    for (int i = 0; i < 3; i++) {
        a[0].doubled[i] = 0;
        b[0].doubled[i] = 2 * 65533;
    }
    free(match.pair);
    CHECK(gesture_match_make(&match, &expert, &trainee, largest, metre, NULL, &fault) == OK);
    CHECK_INT(match.pairs, 0);
}

STORY(order_is_worked_by_hand)
{
    struct gesture a[MOST], b[MOST];
    const uint32_t at[] = {0, 20, 40, 60}, by[] = {40, 0, 20, 60};
    const struct gestures expert = row_of(a, at, 4), trainee = row_of(b, by, 4);
    if (!make(&expert, &trainee))
        return;
    /* The trainee's order of 1 2 3 4 is 3 1 2 4: two of six pairs are the other way round. */
    CHECK_INT(match.agreeing, 4);
    CHECK_INT(match.disagreeing, 2);
    CHECK_INT(match.longest, 3);
}

/* ---- beside slow computations ---- */

static uint64_t squared(const struct gesture *a, const struct gesture *b)
{
    uint64_t sum = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t d = (int64_t)a->doubled[i] - (int64_t)b->doubled[i];
        sum += (uint64_t)(d * d);
    }
    return sum;
}

/* Looks at every pair anew for each that it takes; the limit is 20 half voxels. */
static size_t match_slowly(uint32_t *to, const struct gestures *a, const struct gestures *b)
{
    bool taken[MOST] = {false};
    size_t pairs = 0;
    for (size_t i = 0; i < a->count; i++)
        to[i] = UINT32_MAX;
    for (;; pairs++) {
        uint64_t least = 401;
        size_t best = 0, with = 0;
        for (size_t i = 0; i < a->count; i++)
            for (size_t k = 0; to[i] == UINT32_MAX && k < b->count; k++) {
                const uint64_t is = squared(&a->gesture[i], &b->gesture[k]);
                if (taken[k] || a->gesture[i].label != b->gesture[k].label || is >= least)
                    continue;
                least = is;
                best = i;
                with = k;
            }
        if (least == 401)
            return pairs;
        to[best] = (uint32_t)with;
        taken[with] = true;
    }
}

static void check_order_slowly(void)
{
    uint64_t agreeing = 0, longest = 0, ends[MOST];
    for (size_t i = 0; i < match.pairs; i++) {
        ends[i] = 1;
        for (size_t k = 0; k < i; k++) {
            const bool is_before = match.pair[k].trainee < match.pair[i].trainee;
            agreeing += is_before;
            ends[i] = is_before && ends[k] + 1 > ends[i] ? ends[k] + 1 : ends[i];
        }
        longest = ends[i] > longest ? ends[i] : longest;
    }
    CHECK_INT(match.agreeing, agreeing);
    CHECK_INT(match.agreeing + match.disagreeing,
              match.pairs ? match.pairs * (match.pairs - 1) / 2 : 0);
    CHECK_INT(match.longest, longest);
}

static struct gestures random_gestures(struct gesture *room)
{
    const size_t count = check_below(&random_state, MOST);
    for (size_t i = 0; i < count; i++)
        room[i] = (struct gesture){
            .label = (uint16_t)check_below(&random_state, 3),
            .has_place = true,
            .doubled = {check_below(&random_state, 40), check_below(&random_state, 12), 7}};
    return (struct gestures){.count = count, .gesture = room};
}

STORY(what_is_matched_is_what_a_slow_search_finds)
{
    for (int i = 0; i < 2000; i++) {
        struct gesture a[MOST], b[MOST];
        uint32_t to[MOST];
        const struct gestures expert = random_gestures(a), trainee = random_gestures(b);
        const size_t pairs = match_slowly(to, &expert, &trainee);
        if (!make(&expert, &trainee) || !CHECK(match.pairs == pairs))
            return;
        for (size_t p = 0; p < pairs; p++)
            if (!CHECK(to[match.pair[p].expert] == match.pair[p].trainee))
                return;
        check_order_slowly();
    }
}

/* ---- bounds ---- */

STORY(more_pairs_than_may_be_chosen_from_are_refused)
{
    enum { MANY = 4097 };
    struct gesture *many = mem_array(MANY, sizeof *many);
    for (size_t i = 0; i < MANY; i++)
        many[i] = (struct gesture){.label = 1, .has_place = true};
    struct gestures all = {.count = MANY, .gesture = many};
    free(match.pair);
    CHECK(gesture_match_make(&match, &all, &all, size, mm, NULL, &fault) == ERR_LIMIT);
    CHECK_HAS(fault.text, "--until N");
    all.count = 300;
    make(&all, &all);
    CHECK_INT(match.pairs, 300);
    CHECK_INT(match.longest, 300); /* of those at one place, in the order in which they came */
    free(many);
}

int main(void)
{
    const int status = RUN_STORIES(
        TELL(the_nearest_are_matched_first_each_once),
        TELL(of_two_as_far_apart_the_first_of_the_trainee_is_taken),
        TELL(a_tenth_of_the_longest_side_is_matched_and_no_more),
        TELL(labels_eliminators_and_what_is_taken_back_are_kept_apart),
        TELL(distances_are_in_the_world), TELL(the_largest_distances_do_not_wrap_around),
        TELL(order_is_worked_by_hand), TELL(what_is_matched_is_what_a_slow_search_finds),
        TELL(more_pairs_than_may_be_chosen_from_are_refused));
    free(match.pair);
    return status;
}
