/* SPDX-License-Identifier: MIT */
/*
 * The gestures of an expert and of a trainee beside one another: which of both belong together, and
 * how far they come in the same order.
 *
 * Those that have a place and are not taken back are matched, each with one of the other's at most,
 * of the same label (eliminators with eliminators), and no farther than a tenth of the scene's
 * longest side. Of all such pairs the nearest is taken first; of two that are as far apart, the one
 * whose gesture of the expert came first, then the one whose gesture of the trainee did; and so on
 * with what is left. Distances are compared as whole numbers: of half voxels, in the unit of
 * engine/distance.h.
 *
 * Order is that of matched gestures: two pairs agree where both came first in both journals.
 * Kendall's tau is (agreeing - disagreeing) / all pairs of pairs; ties there are none. The longest
 * common order is the most matched gestures that come one after the other in both.
 */
#ifndef VERIFY_GESTURE_MATCH_H
#define VERIFY_GESTURE_MATCH_H

#include <stdbool.h>

#include "base/watch.h"
#include "verify/gesture.h"

static inline bool gesture_may_match(const struct gesture *gesture)
{
    return gesture->has_place && !gesture->is_taken_back && gesture->label < GESTURE_NO_LABEL;
}

struct gesture_pair {
    uint32_t expert, trainee; /* which gesture of each */
    uint64_t squared;         /* distance, in half units */
};

struct gesture_match {
    struct gesture_pair *pair; /* in the expert's order */
    size_t pairs;
    double limit_mm;  /* farther than that, none are matched */
    uint64_t unit_nm; /* of a whole unit */
    uint64_t agreeing, disagreeing, longest;
};

/* More pairs to choose from are ERR_LIMIT. */
enum { GESTURE_PAIRS_MOST = 1 << 24 };

/* Of a scene of so many voxels, so far apart. ERR_MEMORY, ERR_LIMIT, ERR_CANCELLED. The caller
 * frees ->pair in any case. */
enum err gesture_match_make(struct gesture_match *match, const struct gestures *expert,
                            const struct gestures *trainee, const uint32_t size[3],
                            const uint32_t spacing_nm[3], struct watch *watch, struct fault *fault);

double gesture_pair_mm(const struct gesture_match *match, const struct gesture_pair *pair);

#endif
