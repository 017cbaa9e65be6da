/* SPDX-License-Identifier: MIT */
#include "verify/strict.h"

#include <inttypes.h>
#include <stdlib.h>

bool ci_is_set(void)
{
    const char *ci = getenv("CI");
    return ci && *ci;
}

enum err strict_refuse_torn(uint64_t offset, const char *who, struct fault *fault)
{
    return fault_set(fault, ERR_CHECK,
                     "%s: it ends with an unfinished record, at byte %" PRIu64
                     ", which no chain covers: going on with the journal, or iftty log --repair, "
                     "cuts that off",
                     who, offset);
}

enum err strict_judge(const struct strictness *s, struct fault *fault)
{
    const struct replay_report *report = s->report;
    if (report->is_torn)
        return strict_refuse_torn(report->torn_offset, "strict", fault);
    if (!report->executed)
        return fault_set(fault, ERR_CHECK, "strict: it has a header and no records");
    if (report->bare)
        return fault_set(fault, ERR_CHECK,
                         "strict: %zu record%s without a digest of what the command gives, the "
                         "first is record %zu (line %zu): iftty log --reseal records them",
                         report->bare, plural(report->bare), report->bare_number,
                         report->bare_line);
    if (!s->is_part && !s->goldens)
        return fault_set(fault, ERR_CHECK,
                         "strict: no golden image was compared: `golden NAME` in a session makes "
                         "one, --no-strict asks for none");
    return OK;
}
