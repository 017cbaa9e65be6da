/* SPDX-License-Identifier: MIT */
/*
 * Sending ahead: slices that may be wanted next go to a terminal that keeps them
 * (tui/picture/painter.h) while the line has nothing else to carry.
 *
 *   A1 each slice goes once. Hosts have names for slices as they are shown now, and a name that has
 *      gone is neither drawn nor sent again, until the terminal may have dropped what it had;
 *   A2 no others go than those within AHEAD_WITHIN slices of the cross-hair, on both sides and in
 *      all planes, the nearest first: when these are there nothing happens until a key;
 *   A3 none goes where one that was not sent comes within AHEAD_LATE_NS of a line's round trip
 *      anyway.
 *
 * Pure, but for the host that draws.
 */
#ifndef TUI_PILOT_AHEAD_H
#define TUI_PILOT_AHEAD_H

#include "tui/pilot/flow.h"
#include "tui/pilot/host.h"

enum {
    AHEAD_WITHIN = 4,
    AHEAD_NUMBERS = 6 * AHEAD_WITHIN,
    AHEAD_NEAR = 6,     /* numbers: the next slices of all planes */
    AHEAD_KNOWN = 512,  /* names */
    AHEAD_BYTES = 25000 /* of a slice, about */
};
#define AHEAD_LATE_NS UINT64_C(50000000)

/* {0}: nothing has gone. */
struct ahead {
    unsigned number; /* the next one that is looked at */
    uint64_t name;   /* of `view`, which the host has drawn; 0: none */
    struct image_view view;
    uint64_t known[AHEAD_KNOWN]; /* a ring */
    size_t names;                /* all that were ever put there */
};

/* Something else is shown: those around it may be wanted. */
void ahead_begin(struct ahead *ahead);

/* The terminal may lack what it had. */
void ahead_forget(struct ahead *ahead);

/* The next slice to be sent, which stays the next one until it has gone; NULL where all are
 * there. */
struct image_view *ahead_next(struct ahead *ahead, const struct pilot_host *host,
                              const struct pilot_wish *wish);
void ahead_has_gone(struct ahead *ahead);

/* Whether all have gone that are to go. */
static inline bool ahead_is_over(const struct ahead *ahead)
{
    return ahead->number >= AHEAD_NUMBERS;
}

/* A3 */
bool ahead_pays(const struct flow *flow);

#endif
