/* SPDX-License-Identifier: MIT */
/*
 * Strict verification: nothing that a journal leaves unproven passes.
 *
 * A replay fails where something differs. That nothing differs may also mean that nothing was
 * compared: digests can be taken out of a journal, or the end of it cut off, and the chain computed
 * anew, since the chain holds no secret. So these are failures here, each with what to do:
 *
 *     torn tail          an unfinished record at the end was left alone
 *     no records         a header and no more
 *     bare record        one without a digest, of a command that gives one
 *     no golden image    no pixel was compared; asked of whole journals alone
 *
 * What cannot be seen in a journal itself is that its last records are gone, with the digests of
 * all others in place: for that there is --expect. A recorded word that this build does
 * not give is a failure of any replay (journal/replay.h), and so is a number of semantics that it
 * does not know (session/semantics.h).
 */
#ifndef VERIFY_STRICT_H
#define VERIFY_STRICT_H

#include "journal/replay.h"

/* Whether this is a run without a person: by the environment variable CI, set to anything but "",
 * as by the services that carry out tests. Then verification is strict, and what is a person's
 * decision is refused. */
bool ci_is_set(void);

struct strictness {
    const struct replay_report *report; /* of a replay that went well */
    uint64_t goldens;                   /* golden images compared */
    bool is_part;                       /* not all records were to be compared */
};

/* OK, or ERR_CHECK with the first of the above. */
enum err strict_judge(const struct strictness *strictness, struct fault *fault);

/* ERR_CHECK in words for an unfinished record at that byte. --expect asks for it as well:
 * it says that it is that journal, whole, and no chain covers such bytes. `who` asks. */
enum err strict_refuse_torn(uint64_t offset, const char *who, struct fault *fault);

#endif
