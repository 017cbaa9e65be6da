/* SPDX-License-Identifier: MIT */
/*
 * Semantics: which meaning commands and their results have.
 *
 * A journal says in line 1 under which number it was made (journal/FORMAT.md); a session carries
 * the number of its journal, and new journals have the present one. What has changed its meaning
 * since is a row of one table. Code that has a row asks semantics_has, and does as it was before
 * for older journals: they are verified, and gone on with, under their own meaning, for good.
 *
 * Where the former meaning cannot be had any more, the row names the words of the records that are
 * lost with it: under such a number a command gives them no more, unless it knows that they are
 * what they were, and one that is recorded and not given is not compared. Reports say how many.
 */
#ifndef SESSION_SEMANTICS_H
#define SESSION_SEMANTICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "engine/forest.h"

/* The number of new journals, and the highest that can be gone on with. */
enum { SEMANTICS = 12 };

/* One row each. */
enum meaning {
    MEANING_LABEL_SUM,
    MEANING_MARKERS,
    MEANING_BRANCH_TIPS,
    MEANING_STROKES,
    MEANING_QUOTES,
    MEANING_ORIENTATION,
    MEANING_PLACES,
    MEANING_OPEN_WEIGHT,
    MEANING_FIT,
    MEANING_APPLIED,
    MEANING_SHEAR,
    MEANING_LEVELS,
    MEANING_WHOLE_LABELS,
    MEANING_SLICE_NUMBERS,
    MEANING_FOLDERS,
    MEANING_SURFACE,
    MEANING_SIDES,
    MEANINGS
};

bool semantics_has(unsigned semantics, enum meaning meaning);

/* Whether the word of a record is lost under this number. */
bool semantics_lost(unsigned semantics, const char *word, size_t length);

/* Adds a line for each row that has lost words under this number; none where nothing is lost. */
void semantics_tell_lost(struct buf *out, unsigned semantics);

/* What records say of labels, as this number has it. */
uint64_t semantics_label_digest(unsigned semantics, const struct forest *forest);

#endif
