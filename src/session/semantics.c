/* SPDX-License-Identifier: MIT */
#include "session/semantics.h"

static const struct meaning_row {
    unsigned since;   /* the first number that has the new meaning */
    const char *what; /* the old meaning and the new one */
} meaning_table[] = {
    /* A row for each change, such as
     *     [MEANING_FIT] = {13, "`zoom fit` showed the whole scene; it shows the shown objects"},
     * with a journal of the last number before it in tests/journals. */
    [MEANINGS] = {SEMANTICS + 1, "the end"},
};

bool semantics_has(unsigned semantics, enum meaning meaning)
{
    return semantics >= meaning_table[meaning].since;
}

enum err semantics_check(unsigned semantics, struct fault *fault)
{
    if (semantics < SEMANTICS_LEAST)
        return fault_set(fault, ERR_INPUT,
                         "it has semantics %u, of a build before 1.0, and this program knows %d: "
                         "`iftty log --script FILE` prints its commands, for `iftty run`",
                         semantics, SEMANTICS);
    if (semantics > SEMANTICS)
        return fault_set(fault, ERR_INPUT,
                         "it has semantics %u, and this program knows %d: a newer iftty verifies "
                         "and continues it",
                         semantics, SEMANTICS);
    return OK;
}
