/*
 * The verdict on one journal: what its verification found. It is made in a process of its own and
 * comes back through a pipe, in a form where everything is counted:
 *
 *     verdict ERR EXECUTED COMPARED TOOK_MS WHY LINES PICTURES\n     why  lines
 *     picture CAPTION BYTES\n                                        caption  PNG
 *
 * with ERR the number of an enum err, WHY, LINES, CAPTION and BYTES lengths in bytes, and a picture
 * as often as PICTURES says. A process that dies leaves less than that, which is refused.
 */
#ifndef VERIFY_VERDICT_H
#define VERIFY_VERDICT_H

#include "base/buf.h"
#include "base/err.h"
#include "verify/evidence.h"

struct verdict {
    enum err err;
    uint64_t executed, compared, took_ms;
    struct buf why;   /* of a failure: one line, without line feed, safe to print */
    struct buf lines; /* more about it: lines that begin with "# " */
    struct evidence evidence;
};

void verdict_release(struct verdict *verdict);

void verdict_write(struct buf *out, const struct verdict *verdict);

/* `verdict` begins as {0}, and is to be released whatever is returned. ERR_INPUT for bytes of
 * another form. */
enum err verdict_read(struct verdict *verdict, const char *bytes, size_t length,
                      struct fault *fault);

#endif
