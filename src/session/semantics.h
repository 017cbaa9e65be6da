/* SPDX-License-Identifier: MIT */
/*
 * Semantics: the meaning of commands and of their results, as a number.
 *
 * A journal has the number in line 1 (journal/FORMAT.md), and a session carries the number of its
 * journal; new journals have the present one. Each change of meaning raises SEMANTICS and is a row
 * of one table. Code that such a row is about asks semantics_has and does as before for older
 * journals, which are verified and continued under their own meaning.
 *
 * The table is empty: 12 is the number of version 1.0, and stays open until 1.0 is frozen. Numbers
 * below it belong to builds before 1.0, whose meanings are gone.
 */
#ifndef SESSION_SEMANTICS_H
#define SESSION_SEMANTICS_H

#include <stdbool.h>

#include "base/err.h"

/* The number of new journals, the highest that is known; and the lowest. */
enum { SEMANTICS = 12, SEMANTICS_LEAST = 12 };

/* One row each, such as
 *     MEANING_FIT,
 */
enum meaning { MEANINGS };

bool semantics_has(unsigned semantics, enum meaning meaning);

/* ERR_INPUT for a number that is not known, with what to do about it. */
enum err semantics_check(unsigned semantics, struct fault *fault);

#endif
