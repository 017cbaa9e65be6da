/* SPDX-License-Identifier: MIT */
/*
 * What the verification of one journal found. It is made in a process of its own and comes back
 * through a pipe, in a form where everything is counted:
 *
 *     result ERR EXECUTED COMPARED DIGESTS GOLDENS PIXELS TOOK_MS PICTURES\n
 *     part BYTES\n...     why, lines, chain, orphans, slowest, and for each
 *                         picture its caption and its PNG
 *
 * with ERR the number of an enum err. A process that dies leaves less than that, which is refused.
 */
#ifndef VERIFY_VERIFY_RESULT_H
#define VERIFY_VERIFY_RESULT_H

#include "verify/evidence.h"

struct verify_result {
    const char *path; /* of the journal; borrowed, and not sent */
    bool is_known;    /* its verification is over; not sent either */
    bool is_skipped;  /* nor this: another failed before, and that was to be the end */
    enum err err;     /* OK, ERR_CHECK where something differs, else why it could not be verified */
    uint64_t executed, compared; /* commands; those of them whose recorded result is the same */
    uint64_t digests;            /* of those results, the words that are digests */
    uint64_t took_ms;
    struct buf why;     /* of a failure: one line, without line feed, safe to print */
    struct buf lines;   /* more about it: lines that begin with "# " */
    struct buf chain;   /* 32 digits: of the last record that was carried out; "" for none */
    struct buf orphans; /* golden images that it does not name: their files, each ended by NUL */
    struct buf slowest; /* of its records, where that was asked for: lines, as of timing_write */
    struct evidence evidence;
};

void verify_result_release(struct verify_result *result);

/* Notes a failure, if it is one; its words are a line as well, unless the lines say it already. */
void verify_result_fail(struct verify_result *result, enum err err, bool is_told,
                        const struct fault *fault);

/* Adds what was compared: "10 commands, 10 results with 14 digests, 1 golden image of 1200
 * pixels". */
void verify_result_describe(struct buf *out, const struct verify_result *result);

void verify_result_write(struct buf *out, const struct verify_result *result);

/* Fills in what was sent. To be released, whatever is returned. ERR_INPUT for bytes of another
 * form. */
enum err verify_result_read(struct verify_result *result, const struct buf *bytes,
                            struct fault *fault);

/* Of several. */
struct verify_sum {
    size_t count, verified, failed, skipped; /* journals */
    size_t unreadable;                       /* that failed by another error than ERR_CHECK */
    uint64_t took_ms;
    enum err worst; /* any other error is worse than ERR_CHECK */
};
struct verify_sum verify_sum(const struct verify_result *result, size_t count);

/* ---- reports ---- */

/*
 * For programs that read JUnit's XML or JSON, and as one HTML page, with the pictures of each
 * failure side by side, without a script, and with nothing to be fetched from anywhere, which the
 * page itself forbids.
 */

/* Adds text that stands between tags or in an attribute between quotes: the one way by which bytes
 * from outside reach a report. What is not printable UTF-8 becomes \xNN, as on a terminal
 * (base/safe.h), so that XML allows what is left; then & < > " ' become entities. A line feed stays
 * one. */
void markup_add(struct buf *out, const char *text);

enum verify_form { VERIFY_JUNIT, VERIFY_HTML, VERIFY_JSON };

/* The report on `count` journals as text. */
void verify_report_text(struct buf *out, enum verify_form form, const struct verify_result *result,
                        size_t count);

/* Writes it as `file`, whole or not at all, over what is there. */
enum err verify_report(const char *file, enum verify_form form, const struct verify_result *result,
                       size_t count, struct fault *fault);

#endif
