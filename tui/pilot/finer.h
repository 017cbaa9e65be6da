/* SPDX-License-Identifier: MIT */
/*
 * Pictures that get finer: on a slow line what has changed is sent coarsely first, and finely when
 * nothing moves any more.
 *
 * A picture is cut into tiles. Those that are on the screen as they should be stay; of the others
 * as many are sent as a frame's budget of bytes allows, all of them in coarser pixels if need be.
 * Words stay sharp in coarse tiles, and where one looks gets fine first. What tiles cost is learnt
 * from the frames that were sent. Pure.
 *
 * Where the terminal has the greys of a slice (tui/picture/painter.h) little is left to be sent,
 * and tiles are fine at once; where it will get them tiles wait for that.
 *
 *     struct refine r = {0};
 *     refine_begin(&r, &wanted, moves, budget, &shown)    shown: what to have on the screen
 *     .. painter_show(&p, &shown, &out) ..
 *     refine_sent(&r, bytes)
 *     if (r.is_coarse) .. a further frame makes it finer ..
 */
#ifndef TUI_PILOT_FINER_H
#define TUI_PILOT_FINER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tui/picture/image_view.h"

enum { REFINE_TILE = 16, REFINE_LEVELS = 5 }; /* pixels a side; coarser by 1, 2, 4, 8, 16 */

struct refine_place {
    uint32_t left, top;
};

struct refine {
    uint32_t width, height;
    uint8_t *rgba;  /* what the screen shows */
    bool is_coarse; /* and that is not yet what it should */
    unsigned level; /* of the last frame, and how many tiles it had */
    size_t tiles;
    double cost[REFINE_LEVELS]; /* bytes a tile */
    struct refine_place *stale; /* of the frame at hand: tiles that are not as they should be */
    size_t stales, stale_capacity;
    bool waits; /* some tiles do, for the terminal to get their greys */
};

/* Has `shown`, which has the size of `wanted` and is the refine's until the next call, be the
 * picture to send. Where something moves, all of it is sent, as coarse as the budget makes it; else
 * as much as fits is made fine. False without memory. */
bool refine_begin(struct refine *r, const struct image_view *wanted, bool moves, size_t budget,
                  struct image_view *shown);

/* What the painter made of it took so many bytes. */
void refine_sent(struct refine *r, size_t bytes);

/* The screen was cleared: nothing of it is there any more. */
void refine_forget(struct refine *r);
void refine_release(struct refine *r);

#endif
