/*
 * What GitHub Actions shows of a verification: a line "::error file=...::..." for each failure,
 * which becomes a note at the journal, and a table in the summary of the step, added to the file
 * that GITHUB_STEP_SUMMARY names. Only where GITHUB_ACTIONS is set.
 *
 * Nothing that a journal holds can be a command or markup there: in commands % , : and line feeds
 * are written as %25 %2C %3A %0A, and in the table everything but letters, digits and blanks as
 * numbered entities.
 */
#ifndef VERIFY_GITHUB_H
#define VERIFY_GITHUB_H

#include "command/script.h"
#include "verify/verify_result.h"

bool github_is_there(void);

/* The two texts. */
void github_errors(struct buf *out, const struct verify_result *result, size_t count);
void github_summary(struct buf *out, const struct verify_result *result, size_t count);

/* Where it is there: errors go to standard error, the summary to its file. A summary that cannot be
 * written is a line there, and no failure. */
void github_tell(const struct verify_result *result, size_t count, const struct printer *printer);

#endif
