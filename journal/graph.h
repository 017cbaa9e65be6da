/* SPDX-License-Identifier: MIT */
/*
 * The graph of a journal: the tree of the alternatives in it, drawn oldest first, as the journal
 * reads.
 *
 *     * 1 open brain.nii
 *     * 2 seed 2,3,4 1
 *     |\
 *     | * 3 (first) seed 6,10,8 2
 *     | (4 goto 2: at 2)
 *     * 5 branch second
 *     @ 6 (second, present) seed 6,10,7 2
 *
 * Which record follows which is the tree's (journal/tree.h). What at=N says is a note between
 * parentheses; a name stands beside the last record of its alternative in the journal.
 *
 * Invariants
 *     (G1) a record that others follow stays in its lane until the last of them is drawn, which
 *          takes the lane over; the ones before branch off to the right. So what was given up is
 *          drawn beside, and the line that goes on is straight;
 *     (G2) there are at most GRAPH_LANES lanes. A record that no lane is left for says in words
 *          which one it follows. So the drawing takes time and room in proportion to the journal.
 */
#ifndef JOURNAL_GRAPH_H
#define JOURNAL_GRAPH_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

enum { GRAPH_LANES = 24 };

/* Adds the drawing to `out`, lines that are safe to print, in ASCII or with the box-drawing
 * characters of Unicode. ERR_INPUT for a script (which has no such words), for damage, and where
 * at=N names no record before; nothing was added then. ERR_MEMORY. */
enum err graph_draw(struct buf *out, const char *bytes, size_t length, bool unicode,
                    struct fault *fault);

#endif
