/* SPDX-License-Identifier: MIT */
/*
 * Replay: carries out every command of a journal again and compares what it gives with what the
 * journal says it gave.
 *
 *   J4 replay reproduces every recorded word, or stops at the first that differs and says which.
 *
 * Who carries a command out is not known here: a host does it, by the same function as keyboard
 * and script. A recorded word (key=value) must be there now with the very same value; words that
 * are new are fine, so that later versions may say more. A script has no results: it is carried
 * out and nothing is compared.
 *
 * A journal whose chain does not fit was edited or damaged. That is a failure in itself, but the
 * replay goes on, because the first command that gives something else is what the reader needs.
 */
#ifndef JOURNAL_REPLAY_H
#define JOURNAL_REPLAY_H

#include "journal/record.h"

struct replay_host {
    void *context;
    /* Carries `command` out and adds its result words to `words` (empty at the call): "" or
     * "key=value key=value". */
    enum err (*execute)(void *context, const char *command, struct buf *words, struct fault *fault);
    /* Called before each record is carried out; NULL calls nobody. */
    void (*on_record)(void *context, const struct record *record);
    /* Called by replay_begin with the number of a journal's header. An error ends the replay. NULL
     * calls nobody. */
    enum err (*begin)(void *context, unsigned semantics, struct fault *fault);
};

struct replay_options {
    size_t first; /* records before it are carried out, and neither compared nor judged */
    size_t last;  /* stop after this record; 0: go to the end */
};

enum replay_outcome {
    REPLAY_SAME,     /* every recorded word was reproduced */
    REPLAY_DIVERGED, /* a word differs or is missing: number, line, command, word, both values */
    REPLAY_FAILED,   /* a command that worked then fails now: number, line, command, actual = why */
    REPLAY_UNREADABLE /* the bytes are damaged: number, line; or the semantics are not known */
};

struct replay_report {
    enum replay_outcome outcome;
    bool is_journal;    /* false: a script */
    unsigned semantics; /* of the journal; 0 for a script */
    size_t executed;    /* commands carried out, and given what is recorded */
    size_t compared;    /* those among them with a result to compare with */
    size_t digests;     /* of their words, the digests that are the same */
    size_t bare;        /* of those carried out, the ones that record no digest though the command
                           gives one: nothing says that it is the same */
    size_t bare_number; /* the first of them, and its line */
    size_t bare_line;
    struct record_chain chain; /* of the last record seen, as the journal says it */

    bool is_intact;       /* every record seen was sound */
    size_t edited_number; /* where not: the first that was not, */
    size_t edited_line;   /* the line of its command */
    uint64_t edited_offset;
    bool is_torn; /* an unfinished record stood at the end and was left alone */
    uint64_t torn_offset;

    size_t number; /* of the record it stopped at, and its line; 0 for REPLAY_SAME */
    size_t line;
    struct buf command; /* bytes of the file: print them by buf_add_safe */
    struct buf word;    /* the key */
    struct buf expected;
    struct buf actual;                       /* "" where the word is missing */
    struct buf expected_words, actual_words; /* all of the record, for REPLAY_DIVERGED */
};

/* `struct replay_report r = {0}` is to be released, whatever became of the replay. */
void replay_report_release(struct replay_report *report);

/* Carries one record out and compares; for resuming a journal. Counts in `report` and fills it
 * where something differs: ERR_CHECK. A host that fails with ERR_USAGE or ERR_CHECK gives
 * ERR_CHECK, with any other error that error. */
enum err replay_record(const struct record *record, const struct replay_host *host,
                       struct replay_report *report, struct fault *fault);

/* A replay record by record, for who looks at each: what replay_run does in one go. */
struct replay {
    struct walk walk;
    struct record record;           /* that was carried out last */
    bool is_over;                   /* there is no more */
    const struct replay_host *host; /* borrowed, and these: */
    const struct replay_options *options;
    struct replay_report *report;
};

/* `report` begins as {0}. ERR_INPUT, ERR_MEMORY, those of the host's begin: then there is nothing
 * to end. */
enum err replay_begin(struct replay *replay, const char *bytes, size_t length,
                      const struct replay_host *host, const struct replay_options *options,
                      struct replay_report *report, struct fault *fault);

/* Carries the next record out and compares, as replay_record; at the end of them `is_over` is set,
 * and nothing done. After an error there is none. */
enum err replay_next(struct replay *replay, struct fault *fault);

/* What the whole comes to, where `err` is what the last record gave; and releases the walk. */
enum err replay_end(struct replay *replay, enum err err, struct fault *fault);

/* Replays `length` bytes. OK when everything was reproduced and the journal is intact (a torn tail
 * is only reported); ERR_CHECK for a divergence or an edited journal; ERR_INPUT where it cannot be
 * read; else the host's error. `report` begins as {0}. */
enum err replay_run(const char *bytes, size_t length, const struct replay_host *host,
                    const struct replay_options *options, struct replay_report *report,
                    struct fault *fault);

#endif
