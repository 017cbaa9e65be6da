/* SPDX-License-Identifier: MIT */
/*
 * The inbox: requests as they come in by a pipe, in order, also while a command is carried out.
 *
 * Invariants
 *   I1 lines longer than REQUEST_BYTES_MOST are passed over to their end, and stand in the order of
 *      requests as one that is refused;
 *   I2 no more is read while INBOX_WAITING_MOST requests wait, or more than INBOX_BYTES_MOST bytes
 *      of them: memory is bounded, and the sender waits;
 *   I3 a cancel is taken as soon as it is read: of the request at hand, `stops` is set; one that
 *      waits is answered as cancelled at its turn; of any other nothing comes;
 *   I4 blank lines are nothing, and a last line without its line feed is a line.
 */
#ifndef SERVE_INBOX_H
#define SERVE_INBOX_H

#include "base/buf.h"
#include "base/err.h"

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

enum { INBOX_WAITING_MOST = 1024, INBOX_BYTES_MOST = 4 << 20 };

struct inbox {
    struct buf line; /* what came of the line at hand */
    bool is_too_long;
    bool is_over;            /* nothing comes any more */
    struct request *waiting; /* `count` from `first` on, which comes next */
    size_t first, count, capacity, bytes;
    struct request at_hand; /* id: of the one that is carried out */
    bool stops;
};

/* Takes bytes that have come. ERR_MEMORY, where the stream is of no use any more. */
enum err inbox_take(struct inbox *inbox, const char *bytes, size_t length, struct fault *fault);

/* Reads once what there is in a descriptor, without waiting where that is not readable; the end is
 * `is_over`. ERR_IO, ERR_MEMORY. Does nothing while there is no room (I2). */
enum err inbox_read(struct inbox *inbox, int fd, struct fault *fault);
bool inbox_has_room(const struct inbox *inbox);

/* The next request becomes the one at hand, which stays the inbox's; NULL where none waits. */
const struct request *inbox_next(struct inbox *inbox);

void inbox_release(struct inbox *inbox);

#endif
