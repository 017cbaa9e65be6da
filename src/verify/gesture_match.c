/* SPDX-License-Identifier: MIT */
#include "verify/gesture_match.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "engine/distance.h"

/* What pairs are chosen from. */
struct choosing {
    const struct gestures *expert, *trainee;
    struct distance_scale scale;
    uint64_t most; /* squared, in half units */
    struct watch *watch;
};

/* Less than 2^31 half units along an axis, so that the sum of three squares fits. */
static bool may_belong(uint64_t *squared, const struct choosing *c, uint32_t expert,
                       uint32_t trainee)
{
    const struct gesture *e = &c->expert->gesture[expert], *t = &c->trainee->gesture[trainee];
    *squared = 0;
    for (int a = 0; a < 3; a++) {
        const uint64_t apart = e->doubled[a] > t->doubled[a] ? e->doubled[a] - t->doubled[a]
                                                             : t->doubled[a] - e->doubled[a];
        *squared += apart * c->scale.step[a] * (apart * c->scale.step[a]);
    }
    return gesture_may_match(t) && e->label == t->label && *squared <= c->most;
}

/* All pairs, or, where there is no room for them, how many there are. */
static size_t list_pairs(struct gesture_pair *pair, const struct choosing *c)
{
    struct task task = task_begin(c->watch, "gestures", c->expert->count);
    size_t count = 0;
    uint64_t squared;
    for (uint32_t e = 0; e < c->expert->count && task_advance(&task, 1); e++)
        for (uint32_t t = 0; gesture_may_match(&c->expert->gesture[e]) && t < c->trainee->count;
             t++)
            if (may_belong(&squared, c, e, t)) {
                if (pair)
                    pair[count] = (struct gesture_pair){e, t, squared};
                count++;
            }
    return count;
}

static int compare_pairs(const void *a, const void *b)
{
    const struct gesture_pair *x = a, *y = b;
    if (x->squared != y->squared)
        return x->squared < y->squared ? -1 : 1;
    if (x->expert != y->expert)
        return x->expert < y->expert ? -1 : 1;
    return x->trainee < y->trainee ? -1 : x->trainee > y->trainee;
}

static int compare_order(const void *a, const void *b)
{
    const struct gesture_pair *x = a, *y = b;
    return x->expert < y->expert ? -1 : x->expert > y->expert;
}

/* The nearest first, as long as both are free; what is taken comes to the front. */
static size_t take_nearest(struct gesture_pair *pair, size_t count, bool *expert, bool *trainee)
{
    size_t taken = 0;
    for (size_t i = 0; i < count; i++)
        if (!expert[pair[i].expert] && !trainee[pair[i].trainee]) {
            expert[pair[i].expert] = trainee[pair[i].trainee] = true;
            pair[taken++] = pair[i];
        }
    return taken;
}

/* `last`[n]: the least gesture of the trainee that n + 1 of them in common order can end with. */
static void find_order(struct gesture_match *match, uint32_t *last)
{
    const struct gesture_pair *pair = match->pair;
    for (size_t i = 0; i < match->pairs; i++) {
        size_t at = 0;
        for (size_t j = 0; j < i; j++)
            match->agreeing += pair[j].trainee < pair[i].trainee;
        while (at < match->longest && last[at] < pair[i].trainee)
            at++;
        last[at] = pair[i].trainee;
        match->longest += at == match->longest;
    }
    match->disagreeing =
        (uint64_t)match->pairs * (match->pairs - (match->pairs > 0)) / 2 - match->agreeing;
}

double gesture_pair_mm(const struct gesture_match *match, const struct gesture_pair *pair)
{
    return sqrt((double)pair->squared) * (double)match->unit_nm / 2e6;
}

enum err gesture_match_make(struct gesture_match *match, const struct gestures *expert,
                            const struct gestures *trainee, const uint32_t size[3],
                            const uint32_t spacing_nm[3], struct watch *watch, struct fault *fault)
{
    struct choosing c = {expert, trainee, distance_scale_of(spacing_nm, size), 0, watch};
    uint64_t longest = 0;
    for (int a = 0; a < 3; a++) {
        const uint64_t side = (uint64_t)size[a] * c.scale.step[a];
        longest = side > longest ? side : longest;
    }
    c.most = 2 * longest * (2 * longest) / 100;
    *match = (struct gesture_match){.unit_nm = c.scale.unit_nm,
                                    .limit_mm = (double)longest * (double)c.scale.unit_nm / 1e7};
    const size_t count = list_pairs(NULL, &c);
    if (count > GESTURE_PAIRS_MOST)
        return fault_set(fault, ERR_LIMIT,
                         "%zu pairs of gestures lie near each other, more than %d that can be "
                         "chosen from; --until N carries out no record after N",
                         count, GESTURE_PAIRS_MOST);
    bool *taken = mem_new(expert->count + trainee->count + 1);
    uint32_t *last = mem_array(expert->count + 1, sizeof *last);
    match->pair = mem_array(count + 1, sizeof *match->pair);
    enum err err =
        taken && last && match->pair ? watch_fault(watch, fault) : fault_memory(fault, "gestures");
    if (!err) {
        list_pairs(match->pair, &c);
        qsort(match->pair, count, sizeof *match->pair, compare_pairs);
        match->pairs = take_nearest(match->pair, count, taken, taken + expert->count);
        qsort(match->pair, match->pairs, sizeof *match->pair, compare_order);
        find_order(match, last);
        err = watch_fault(watch, fault);
    }
    free(taken);
    free(last);
    return err;
}
