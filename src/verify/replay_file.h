/* SPDX-License-Identifier: MIT */
/*
 * Replay of a journal by an interpreter, under the limits for untrusted journals (command/trust.h),
 * with a report in words and the slowest records.
 */
#ifndef VERIFY_REPLAY_FILE_H
#define VERIFY_REPLAY_FILE_H

#include "command/script.h"
#include "journal/replay.h"

/* The slowest records, in memory that does not grow with the journal. Begins as {0}. */
enum { TIMING_MOST = 10 };
struct timing {
    struct timing_row {
        uint64_t ns;
        size_t number;      /* record number */
        struct buf command; /* beginning of the command, safe to print */
    } row[TIMING_MOST];     /* slowest first; of two equal ones the earlier first */
    size_t rows;
};

/* Add lines: "12.345 ms, record 31: run". */
void timing_write(struct buf *lines, const struct timing *timing);
void timing_release(struct timing *timing);

/* A journal that is replayed record by record. */
struct replaying {
    struct interpreter *interp;
    const struct printer *printer;    /* NULL: print nothing */
    struct timing *timing;            /* NULL: no timing */
    const struct golden_judge *judge; /* from record `first` on; or NULL */
    size_t number, first;
};

/* Read the untrusted journal at `path` and prepare the interpreter for its replay; and the host
 * that carries out its records, for journal/replay.h. */
enum err replay_file_begin(struct interpreter *interp, const char *path, struct buf *bytes,
                           struct fault *fault);
struct replay_host replay_file_host(struct replaying *replaying);

/* Carry out the journal and compare the results, and golden images by the interpreter's judge,
 * of records `first` to `last`; 0 for all. Acknowledge each command unless `printer` is NULL, and
 * time it unless `timing` is NULL. `report` begins as {0}; always release it. */
enum err replay_file(struct interpreter *interp, const char *path, size_t first, size_t last,
                     const struct printer *printer, struct timing *timing,
                     struct replay_report *report, struct fault *fault);

/* Add all faults as lines that begin with "# ", safe to print; no line if the replay succeeded.
 * `fault` is that of the replay. */
void replay_describe(struct buf *text, const struct replay_report *report,
                     const struct fault *fault);

/* Add one such line: "#   what     text". */
void replay_add_detail(struct buf *lines, const char *what, const char *text, size_t length);

/*
 * Meaning of a command's different results, in words, from the result words alone
 * ("forest=0123456789abcdef labels=... seeds=12"). The words of commands are known only here and
 * where they are made (command/interpreter.c, act_*.c).
 */

/* Which two results differ: decides how they are named. */
enum divergence_of {
    DIVERGENCE_OF_REPLAY,  /* "7 was recorded, 9 now" */
    DIVERGENCE_OF_JOURNALS /* "7 in the first, 9 in the second" */
};

/* Add a line "#   meaning   ..." that says whether labels, only keys, a picture or an input
 * differ; a line for each word that differs, with the difference of counts; and one line for equal
 * words. Safe to print. */
void divergence_describe(struct buf *lines, const char *expected, const char *actual,
                         enum divergence_of of);

/* Program `replay`: acknowledge every command, compare every result, and print a summary. */
enum err replay_aloud(struct interpreter *interp, const char *path, const struct printer *printer,
                      struct fault *fault);

#endif
