/* SPDX-License-Identifier: MIT */
/*
 * Replay: carry out every command of a journal again and compare the results with the recorded
 * ones.
 *
 *   J4 replay reproduces every recorded word, or stops at the first that differs and names it.
 *
 * A host carries out the commands, by the same function as keyboard and script; it is not known
 * here. A recorded word (key=value) must be present with the same value; additional words are
 * accepted, so that later versions may add some. A script has no results: it is carried out without
 * a comparison.
 *
 * A chain that does not fit shows that the journal was edited or damaged. That is a failure, but
 * the replay continues, because the reader needs the first command whose result differs.
 */
#ifndef JOURNAL_REPLAY_H
#define JOURNAL_REPLAY_H

#include "journal/record.h"

struct replay_host {
    void *context;
    /* Carry out `command` and append its result words to `words` (empty at the call): "" or
     * "key=value key=value". */
    enum err (*execute)(void *context, const char *command, struct buf *words, struct fault *fault);
    /* Called before each record is carried out; or NULL. */
    void (*on_record)(void *context, const struct record *record);
    /* Called by replay_begin with the number of a journal's header; or NULL. An error ends the
     * replay. */
    enum err (*begin)(void *context, unsigned semantics, struct fault *fault);
};

struct replay_options {
    size_t first; /* records before it are carried out, but neither compared nor judged */
    size_t last;  /* last record; 0: all */
};

enum replay_outcome {
    REPLAY_SAME,      /* every recorded word was reproduced */
    REPLAY_DIVERGED,  /* a word differs or is missing: number, line, command, word, both values */
    REPLAY_FAILED,    /* a recorded command fails now: number, line, command, actual = why */
    REPLAY_UNREADABLE /* the bytes are damaged: number, line; or the semantics are unknown */
};

struct replay_report {
    enum replay_outcome outcome;
    bool is_journal;    /* false: a script */
    size_t executed;    /* commands that were carried out with their recorded results */
    size_t compared;    /* commands among them that have a recorded result */
    size_t digests;     /* digests among the equal words */
    size_t bare;        /* records without the digest that their command computes: their
                           results are unproven */
    size_t bare_number; /* first of them, and its line */
    size_t bare_line;
    struct record_chain chain; /* chain written in the last record seen */

    bool is_intact;       /* every record seen was sound */
    size_t edited_number; /* otherwise the first unsound record, */
    size_t edited_line;   /* the line of its command */
    uint64_t edited_offset;
    bool is_torn; /* an unfinished record at the end was ignored */
    uint64_t torn_offset;

    size_t number; /* record at which the replay stopped, and its line; 0 for REPLAY_SAME */
    size_t line;
    struct buf command; /* bytes of the file: print them by buf_add_safe */
    struct buf word;    /* key */
    struct buf expected;
    struct buf actual;                       /* "" if the word is missing */
    struct buf expected_words, actual_words; /* all words of the record, for REPLAY_DIVERGED */
};

/* Always release a `struct replay_report r = {0}`, even after errors. */
void replay_report_release(struct replay_report *report);

/* Carry out one record and compare; for resuming a journal. Count in `report`, and fill it if
 * something differs: ERR_CHECK. If the host fails with ERR_USAGE or ERR_CHECK, return ERR_CHECK,
 * for any other error that error. */
enum err replay_record(const struct record *record, const struct replay_host *host,
                       struct replay_report *report, struct fault *fault);

/* A replay record by record, for callers that inspect each; replay_run does it in one call. */
struct replay {
    struct walk walk;
    struct record record;           /* the record carried out last */
    bool is_over;                   /* no record is left */
    const struct replay_host *host; /* borrowed, as are: */
    const struct replay_options *options;
    struct replay_report *report;
};

/* `report` begins as {0}. ERR_INPUT, ERR_MEMORY, and errors of the host's begin: then do not
 * call replay_end. */
enum err replay_begin(struct replay *replay, const char *bytes, size_t length,
                      const struct replay_host *host, const struct replay_options *options,
                      struct replay_report *report, struct fault *fault);

/* Carry out the next record and compare, as replay_record; set `is_over` at the end. The
 * replay is over after an error. */
enum err replay_next(struct replay *replay, struct fault *fault);

/* Return the result of the whole replay, where `err` is that of the last record, and release the
 * walk. */
enum err replay_end(struct replay *replay, enum err err, struct fault *fault);

/* Replay `length` bytes. OK if everything was reproduced and the journal is intact (a torn tail
 * is only reported); ERR_CHECK for a different result or an edited journal; ERR_INPUT if it cannot
 * be read; otherwise the host's error. `report` begins as {0}. */
enum err replay_run(const char *bytes, size_t length, const struct replay_host *host,
                    const struct replay_options *options, struct replay_report *report,
                    struct fault *fault);

#endif
