/* SPDX-License-Identifier: MIT */
/*
 * Requests: what a program that drives a session writes, a line of JSON each (base/json.h).
 *
 *     {"id": 1, "do": "seed 90,108,90 1 radius=6"}         a command, as at the prompt
 *     {"id": 2, "array": "labels", "finished": true}       the voxels of a map, in a file
 *     {"cancel": 1}                                        stop that command
 *
 * `id` is a whole number or a text, and comes back with the answer; one that is left out is null.
 * Keys that are not known, come twice, or do not go with the others are refused.
 */
#ifndef SERVE_REQUEST_H
#define SERVE_REQUEST_H

#include "base/buf.h"
#include "base/err.h"

enum { REQUEST_BYTES_MOST = 1 << 20 }; /* of a line, without its line feed */

enum request_kind { REQUEST_COMMAND, REQUEST_ARRAY, REQUEST_CANCEL };

struct request {
    enum request_kind kind;
    struct buf id;    /* as JSON has it: "null", "12", "\"a\""; of a cancel that of what it stops */
    struct buf words; /* the command, or which array */
    bool finished;    /* of an array: labels as `finish` leaves them */
    bool is_cancelled;  /* before it was begun */
    struct fault fault; /* code OK, or why the line was no request: it is answered all the same */
};

/* Reads a line; the caller releases the request in any case. Its fault is ERR_USAGE or ERR_MEMORY
 * where it is none, and its id is then what was read of it. */
void request_read(struct request *request, const char *line, size_t length);
void request_release(struct request *request);

#endif
