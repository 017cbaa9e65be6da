/*
 * The verification of one journal, in a process of its own: what its replay gives, what leaves it
 * unproven, and whether it is the one that is meant (--expect, --lock, --allowed-signers).
 */
#ifndef VERIFY_VERIFY_JOURNAL_H
#define VERIFY_VERIFY_JOURNAL_H

#include "verify/verify.h"
#include "verify/verify_result.h"

/* Of the journal with that number among those of the options. `result` begins as {0}. */
void verify_journal(const struct verify_options *options, size_t number,
                    struct verify_result *result);

#endif
