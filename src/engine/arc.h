/* SPDX-License-Identifier: MIT */
/*
 * Arcs: the weight w of a step from a voxel s to its neighbour t.
 *
 *     ARC_TARGET      the weight held at t                      gradients, weights out of a file
 *     ARC_DIFFERENCE  |v(s) - v(t)|                             v: intensity
 *     ARC_POLARITY    |v(s) - v(t)| * (100 + a) / 100, rounded down, where v(s) > v(t)
 *                     |v(s) - v(t)| * (100 - a) / 100, likewise, where v(s) < v(t)
 *
 * Polarity is the oriented IFT (Miranda, Mansilla: Oriented image foresting transform segmentation
 * by seed competition, IEEE TIP 23(1), 2014): an object whose boundary is known to lead from bright
 * to dark has a > 0, so that such steps cost its paths more than those back, and its seeds stop
 * there. a, in percent, belongs to the label of the path's root. What exceeds 65535 is 65535.
 *
 * A weight may depend on the arc's direction and on the label of its root because the forest is
 * unique whatever w is, as long as an offer is above the key that makes it (engine/forest.h), and
 * the label of a root never changes: giving a seed another label is a removal and a planting.
 */
#ifndef ENGINE_ARC_H
#define ENGINE_ARC_H

#include <stdint.h>

#include "engine/scene.h"

enum arc_kind { ARC_TARGET, ARC_DIFFERENCE, ARC_POLARITY };

enum { POLARITY_MOST = 100, WEIGHT_MOST = 65535 };

/* Begins as {0}: ARC_TARGET. */
struct arc_rule {
    enum arc_kind kind;
    int8_t polarity[256]; /* a of each label, -POLARITY_MOST..POLARITY_MOST */
};

/* w of the arc (s, t) in a tree whose root has this label. `kind` is that of the rule: said apart,
 * so that a loop compiled for one kind looks at no other. */
static inline __attribute__((always_inline)) uint32_t
arc_weight(const struct arc_rule *rule, const enum arc_kind kind, const struct cell *s,
           const struct cell *t, uint8_t label)
{
    if (kind == ARC_TARGET)
        return t->weight;
    const int32_t rise = t->intensity - s->intensity;
    const int32_t difference = rise < 0 ? -rise : rise;
    if (kind == ARC_DIFFERENCE)
        return (uint32_t)difference;
    const int32_t a = rule->polarity[label];
    const uint32_t percent = (uint32_t)(POLARITY_MOST + (rise < 0 ? a : -a));
    const uint32_t weight = (uint32_t)difference * percent / POLARITY_MOST;
    return weight < WEIGHT_MOST ? weight : WEIGHT_MOST;
}

/* Of the arc from a voxel as it stands, away from the loops. */
static inline uint32_t arc_weight_now(const struct arc_rule *rule, const struct cell *s,
                                      const struct cell *t)
{
    return arc_weight(rule, rule->kind, s, t, s->label);
}

#endif
