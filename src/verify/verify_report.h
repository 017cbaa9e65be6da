/* SPDX-License-Identifier: MIT */
/*
 * What a verification found: for programs that read JUnit's XML or JSON, and as one HTML page, with
 * the pictures of each failure side by side, without a script, and with nothing to be fetched from
 * anywhere, which the page itself forbids.
 */
#ifndef VERIFY_VERIFY_REPORT_H
#define VERIFY_VERIFY_REPORT_H

#include "command/script.h"
#include "verify/verify_result.h"

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
