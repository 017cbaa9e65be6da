/* SPDX-License-Identifier: MIT */
/*
 * The replay of a journal by an interpreter, under the limits for journals that somebody else may
 * have written (command/trust.h), what its report says in words, and which records took longest.
 */
#ifndef VERIFY_REPLAY_FILE_H
#define VERIFY_REPLAY_FILE_H

#include "command/script.h"
#include "journal/replay.h"

/* The records that take longest, in memory that does not grow with the journal. Begins as {0}. */
enum { TIMING_MOST = 10 };
struct timing {
    struct timing_row {
        uint64_t ns;
        size_t number;      /* of the record */
        struct buf command; /* the beginning of it, safe to print */
    } row[TIMING_MOST];     /* the slowest first; of two that are equal the earlier */
    size_t rows;
};

/* Lines: "12.345 ms, record 31: run". */
void timing_write(struct buf *lines, const struct timing *timing);
void timing_release(struct timing *timing);

/* A journal that is replayed record by record. */
struct replaying {
    struct interpreter *interp;
    const struct printer *printer;    /* NULL: quietly */
    struct timing *timing;            /* NULL: none is taken */
    const struct golden_judge *judge; /* from record `first` on; or NULL */
    size_t number, first;
};

/* Reads the journal at `path`, which may be a stranger's, and has the interpreter carry out what it
 * says as a replay; and who carries its records out, for journal/replay.h. */
enum err replay_file_begin(struct interpreter *interp, const char *path, struct buf *bytes,
                           struct fault *fault);
struct replay_host replay_file_host(struct replaying *replaying);

/* Carries the journal out and compares the results, and by the interpreter's judge golden images,
 * of records `first` to `last`; 0 for all. Each command is acknowledged, unless `printer` is NULL,
 * and timed, unless `timing` is. `report` begins as {0}, and is to be released whatever is
 * returned. */
enum err replay_file(struct interpreter *interp, const char *path, size_t first, size_t last,
                     const struct printer *printer, struct timing *timing,
                     struct replay_report *report, struct fault *fault);

/* Adds what is wrong as lines that begin with "# ", safe to print; none where all is well. `fault`
 * is that of the replay. */
void replay_describe(struct buf *text, const struct replay_report *report,
                     const struct fault *fault);

/* Adds one such line: "#   what     text". */
void replay_add_detail(struct buf *lines, const char *what, const char *text, size_t length);

/*
 * What it means that a command gave other results than are recorded: in words, from the result
 * words alone ("forest=0123456789abcdef labels=... seeds=12"). Which words commands have is known
 * here and where they are made (command/interpreter.c, act_*.c), and nowhere below.
 */

/* Which two results differ, and so what they are called. */
enum divergence_of {
    DIVERGENCE_OF_REPLAY,  /* "7 was recorded, 9 now" */
    DIVERGENCE_OF_JOURNALS /* "7 in the first, 9 in the second" */
};

/* Adds lines "#   meaning   ..." : whether labels or only keys differ, or a picture, or what the
 * command read; then a line for each word that differs, counts with how many more or less, and one
 * for those that are the same. Safe to print. */
void divergence_describe(struct buf *lines, const char *expected, const char *actual,
                         enum divergence_of of);

/* The program `replay`: acknowledges every command, compares every result, and sums up. */
enum err replay_aloud(struct interpreter *interp, const char *path, const struct printer *printer,
                      struct fault *fault);

#endif
