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

#include <sys/types.h>

#include "base/buf.h"
#include "base/err.h"
#include "command/interpreter.h"
#include "image/volume_format.h"

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

/*
 * The folder by which voxels and pictures go to the program that drives a session, and come from
 * it: arrays are files, since they are large.
 *
 * Invariants
 *   E1 it is below $TMPDIR (or /tmp), under a name that nobody can foresee, made anew, and for its
 *      owner alone; before each file is written it is looked at again: what has become a link,
 *      another folder, or open to others is refused;
 *   E2 a file in it is written as a draft that was not there before (O_EXCL), and renamed: what
 *      stands under its name, a link too, is replaced and never followed;
 *   E3 it goes when the session ends, and where that is killed, when the next one begins
 *      (folder_held of base/file.h);
 *   E4 no record depends on it: a command that is recorded and whose file, golden image or copy of
 *      labels would be in it, once all links are resolved, is refused, and so is `journal FILE`.
 *      Only a file of which the journal keeps a copy may be read from it (`labels FILE`), and a
 *      question may write its report there.
 */

struct exchange {
    struct buf path; /* of the folder, without links */
    dev_t device;
    ino_t number;
};

/* ERR_IO, ERR_MEMORY: then there is none. */
enum err exchange_begin(struct exchange *exchange, struct fault *fault);
void exchange_end(struct exchange *exchange);

/* E4, before a line is carried out. ERR_INPUT, ERR_MEMORY; what does not parse is fine here. */
enum err exchange_allows(const struct exchange *exchange, const struct interpreter *interp,
                         const char *line, struct fault *fault);

/* An uncompressed NIfTI, whose voxels can be read as they stand: x fastest, little-endian. */
struct array_file {
    struct buf path;
    const char *name; /* which: "labels" */
    enum voxel_type type;
    uint64_t offset; /* of the first voxel, in bytes */
};

/* Writes the map of that name, which replaces the one before it: labels|cost|root|border|distance|
 * margin as `save` has them (show/export_map.h), or intensity. Edits that wait are applied first,
 * as by `run`, which is recorded. ERR_USAGE for a name that is none, and what commands return. */
enum err array_write(struct array_file *out, const struct exchange *exchange,
                     struct interpreter *interp, const char *name, bool finished,
                     struct fault *fault);

/* Writes a picture as PNG, which replaces the one before it; *path is the file. */
enum err picture_write(struct buf *path, const struct exchange *exchange, uint32_t width,
                       uint32_t height, const uint8_t *rgba, struct fault *fault);

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
