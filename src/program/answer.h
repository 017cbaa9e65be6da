/* SPDX-License-Identifier: MIT */
/*
 * Answers: what a session writes to the program that drives it, a line of JSON each. The key that
 * stands first, or after `id`, says which kind it is (src/program/README.md):
 *
 *     {"protocol": 1, "ok": true, "program": "iftty", ...}       once, before all else
 *     {"id": 1, "ok": true, "record": 2, "command": ..., ...}    a request was carried out
 *     {"id": 1, "ok": false, "kind": "bad usage", "why": ...}    it was not; nothing has changed
 *     {"id": 1, "progress": "forest", "done": 1, "total": 4}     it goes on
 *     {"id": 1, "notice": "..."}                                 a line for the user
 *
 * Words are those of records (journal/FORMAT.md) and of the programs' --json. Every function adds
 * one line to `out`, whose failure says that memory ran out.
 */
#ifndef SERVE_ANSWER_H
#define SERVE_ANSWER_H

#include "program/exchange.h"
#include "program/request.h"

enum { SERVE_PROTOCOL = 1 };

/* What is open now; `told` are lines about how it was opened. `fault` is why nothing could be, or
 * NULL. */
void answer_greeting(struct buf *out, const struct interpreter *interp, const char *folder,
                     const char *told, const struct fault *fault);

/* A command that stands, or was nothing; `picture` is the file of what it has shown, or NULL. */
void answer_command(struct buf *out, const char *id, const struct interpreter *interp,
                    const struct reply *reply, const char *picture);
void answer_array(struct buf *out, const char *id, const struct interpreter *interp,
                  const struct array_file *array);

/* `line` is what fault->at counts bytes of, NULL for nothing; `list` lines to choose from. */
void answer_fault(struct buf *out, const char *id, const struct fault *fault, const char *line,
                  const char *list);

void answer_progress(struct buf *out, const char *id, const char *what, uint64_t done,
                     uint64_t total, bool stops);
void answer_notice(struct buf *out, const char *id, const char *line);

#endif
