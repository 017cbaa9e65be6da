/* SPDX-License-Identifier: MIT */
/*
 * How keys come, and so how long a picture may take.
 *
 * A rendition that takes long is drawn coarsely first, and as it is when keys rest (pilot_wish). A
 * coarse one takes half as long. After a single key both are drawn, so it pays only where the fine
 * one takes very long; while a key is held it is drawn instead of it. On one core, where a turn
 * takes 30 ms, that is 29 frames a second of a key that is held, not 25, and a sixth less of the
 * processor.
 *
 * Pure: the time is an argument, in ns of any clock that never goes back.
 */
#ifndef TUI_PILOT_PACE_H
#define TUI_PILOT_PACE_H

#include <stdbool.h>
#include <stdint.h>

/* Keys rest when none has come for so long, which is longer than from one to the next of a key that
 * is held; where drawing delays them they come later. */
#define PACE_REST_NS UINT64_C(40000000)
#define PACE_HELD_NS UINT64_C(100000000)

/* What a rendition may take, to be drawn at once: after a single key, and while one is held. */
#define PACE_SINGLE_NS  UINT64_C(50000000)
#define PACE_BETWEEN_NS UINT64_C(25000000)

/* {0}: no key has come. */
struct pace {
    uint64_t key_ns; /* the last one; 0: none */
    bool is_held;    /* it came soon after the one before */
};

static inline void pace_key(struct pace *pace, uint64_t now_ns)
{
    pace->is_held = pace->key_ns > 0 && now_ns < pace->key_ns + PACE_HELD_NS;
    pace->key_ns = now_ns;
}

/* When keys are taken to rest. */
static inline uint64_t pace_rests_ns(const struct pace *pace)
{
    return pace->key_ns + PACE_REST_NS;
}

static inline uint64_t pace_within_ns(const struct pace *pace)
{
    return pace->is_held ? PACE_BETWEEN_NS : PACE_SINGLE_NS;
}

#endif
