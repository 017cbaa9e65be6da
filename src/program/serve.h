/* SPDX-License-Identifier: MIT */
/*
 * The inbox: requests that arrive through a pipe, in order, also while a command runs.
 *
 * Invariants
 *   I1 a line longer than REQUEST_BYTES_MOST is skipped to its end, and answered in its turn with
 *      an error;
 *   I2 no more is read while INBOX_WAITING_MOST requests wait, or more than INBOX_BYTES_MOST bytes
 *      of them: memory is bounded, and the sender waits;
 *   I3 a cancel acts when it is read: for the current request `stops` is set; a waiting one
 *      is answered as cancelled in its turn; any other cancel has no effect;
 *   I4 blank lines are ignored, and a last line without its line feed is a line.
 */
#ifndef PROGRAM_SERVE_H
#define PROGRAM_SERVE_H

#include <sys/types.h>

#include "base/buf.h"
#include "base/err.h"
#include "command/interpreter.h"
#include "image/volume_format.h"

/*
 * Requests of the program that drives a session, a line of JSON each (base/json.h).
 *
 *     {"id": 1, "do": "seed 90,108,90 1 radius=6"}         a command, as at the prompt
 *     {"id": 2, "array": "labels", "finished": true}       the voxels of a map, in a file
 *     {"cancel": 1}                                        stop that command
 *
 * `id` is a whole number or a text, and is repeated in the answer; the default is null. Keys that
 * are unknown, repeated, or do not belong together are errors.
 */

enum { REQUEST_BYTES_MOST = 1 << 20 }; /* a line, without its line feed */

enum request_kind { REQUEST_COMMAND, REQUEST_ARRAY, REQUEST_CANCEL };

struct request {
    enum request_kind kind;
    struct buf id;      /* JSON text: "null", "12", "\"a\""; of a cancel the id of the request to
                         stop */
    struct buf words;   /* the command, or which array */
    bool finished;      /* for an array: labels after `finish` */
    bool is_cancelled;  /* before it began */
    struct fault fault; /* OK, or the error of the line, which is answered too */
};

enum { INBOX_WAITING_MOST = 1024, INBOX_BYTES_MOST = 4 << 20 };

struct inbox {
    struct buf line; /* the current line, as far as it was read */
    bool is_too_long;
    bool is_over;            /* end of input */
    struct request *waiting; /* `count` from `first` on, the next one first */
    size_t first, count, capacity, bytes;
    struct request at_hand; /* the request that is carried out */
    bool stops;
};

/* Add bytes of input. ERR_MEMORY: the stream is lost. */
enum err inbox_take(struct inbox *inbox, const char *bytes, size_t length, struct fault *fault);

/* Read once from a descriptor, without waiting; `is_over` is set at the end. ERR_IO, ERR_MEMORY.
 * Does nothing while there is no room (I2). */
enum err inbox_read(struct inbox *inbox, int fd, struct fault *fault);
bool inbox_has_room(const struct inbox *inbox);

/* Make the next request the current one, which the inbox owns; NULL if none waits. */
const struct request *inbox_next(struct inbox *inbox);

void inbox_release(struct inbox *inbox);

/*
 * Answers to the program that drives a session, a line of JSON each. The first key, or the key
 * after `id`, identifies the kind (src/program/README.md):
 *
 *     {"protocol": 1, "ok": true, "program": "iftty", ...}       the greeting, once
 *     {"id": 1, "ok": true, "record": 2, "command": ..., ...}    a request was carried out
 *     {"id": 1, "ok": false, "kind": "bad usage", "why": ...}    it failed; nothing has changed
 *     {"id": 1, "progress": "forest", "done": 1, "total": 4}     progress
 *     {"id": 1, "notice": "..."}                                 a line for the user
 *
 * Words are those of records (journal/FORMAT.md) and of the programs' --json. Every function adds
 * one line to `out`; out->failed is set if memory runs out.
 */

/*
 * The folder through which voxels and pictures are exchanged with the program that drives a
 * session: arrays are files, since they are large.
 *
 * Invariants
 *   E1 it is a new folder below $TMPDIR (or /tmp), with an unpredictable name and for its owner
 *      alone; it is checked before each file is written: a link, another folder, or one that is
 *      open to others in its place is an error;
 *   E2 a file in it is written as a new draft (O_EXCL) and renamed: a file or a link with its name
 *      is replaced and never followed;
 *   E3 it is removed when the session ends, or after a kill when the next one begins (folder_held
 *      of base/file.h);
 *   E4 no record depends on it: a recorded command whose file, golden image or copy of labels would
 *      be in it, once all links are resolved, is an error, and so is `journal FILE`. Only a file
 *      that the journal keeps a copy of may be read from it (`labels FILE`), and a question may
 *      write its report there.
 */

struct exchange {
    struct buf path; /* the folder, without links */
    dev_t device;
    ino_t number;
};

/* ERR_IO, ERR_MEMORY: no folder is made. */
enum err exchange_begin(struct exchange *exchange, struct fault *fault);
void exchange_end(struct exchange *exchange);

/* Check E4 for a line. ERR_INPUT, ERR_MEMORY; lines that do not parse are accepted here. */
enum err exchange_allows(const struct exchange *exchange, const struct interpreter *interp,
                         const char *line, struct fault *fault);

/* An uncompressed NIfTI, whose voxels can be read directly: x fastest, little-endian. */
struct array_file {
    struct buf path;
    const char *name; /* name of the array: "labels" */
    enum voxel_type type;
    uint64_t offset; /* byte of the first voxel */
};

/* Write a map, replacing the file before: labels|cost|root|border|distance|margin as `save` writes
 * them (show/export_map.h), or intensity. Edits that wait are applied first, and recorded as `run`.
 * ERR_USAGE for an unknown name, and errors of commands. */
enum err array_write(struct array_file *out, const struct exchange *exchange,
                     struct interpreter *interp, const char *name, bool finished,
                     struct fault *fault);

/* Write a picture as PNG, replacing the one before; *path is the file. */
enum err picture_write(struct buf *path, const struct exchange *exchange, uint32_t width,
                       uint32_t height, const uint8_t *rgba, struct fault *fault);

enum { SERVE_PROTOCOL = 1 };

/* Write the greeting; `told` are lines about opening. `fault` is the error that prevented it, or
 * NULL. */
void answer_greeting(struct buf *out, const struct interpreter *interp, const char *folder,
                     const char *told, const struct fault *fault);

/* Answer a command that succeeded; `picture` is the file of its picture, or NULL. */
void answer_command(struct buf *out, const char *id, const struct interpreter *interp,
                    const struct reply *reply, const char *picture);
void answer_array(struct buf *out, const char *id, const struct interpreter *interp,
                  const struct array_file *array);

/* `line` is the line that fault->at refers to, or NULL; `list` are lines to choose from. */
void answer_fault(struct buf *out, const char *id, const struct fault *fault, const char *line,
                  const char *list);

void answer_progress(struct buf *out, const char *id, const char *what, uint64_t done,
                     uint64_t total, bool stops);
void answer_notice(struct buf *out, const char *id, const char *line);

#endif
