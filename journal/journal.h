/* SPDX-License-Identifier: MIT */
/*
 * The journal: a file of records that one session appends to, and that others resume and replay.
 *
 * Promises, by numbers that the tests use too:
 *   J1 a command is acknowledged only after its record is synced: when journal_append returns OK,
 *      the record is on the disk, with all before it. A command that changes nothing of the
 *      segmentation is acknowledged when its record is written: a loss of power may remove such
 *      records of the last second from the end, and never a record of another command. A caller
 *      can ask for less by journal_set_sync;
 *   J2 the file is always header + valid records + at most one torn record;
 *   J3 bytes before the end of the valid part never change;
 *   J4 replay reproduces every recorded word, or stops at the first that differs and says which
 *      (journal/replay.h);
 *   J5 if an append fails, the file is cut back to what it was and the answer is an error; the
 *      caller undoes the edit. Nothing is appended until the cut is on the disk as well, so that a
 *      record which was refused cannot come back;
 *   J6 one writer at a time: the file is locked from journal_create or journal_open to
 *      journal_close. Readers (replay, journal_check) take no lock;
 *   J7 the session outlives the file: every byte is in memory too, so that the record can continue
 *      in another file (journal_continue) when this one is full, gone or failing.
 *
 * journal/FORMAT.md describes the bytes; they are encoded and walked by record.h. A
 * journal holds at most JOURNAL_BYTES_MAX bytes, so that a reader knows what memory it takes.
 */
#ifndef JOURNAL_JOURNAL_H
#define JOURNAL_JOURNAL_H

#include "base/file_log.h"
#include "journal/record.h"

#define JOURNAL_BYTES_MAX ((size_t)256 << 20)

/* Opaque, because of J1 to J3. Owned by the caller who created or opened it. */
struct journal;

/* Creates `path`, which must not exist, with its header synced. `semantics` is the version of what
 * commands mean, 1..999999999. On failure there is no file and *journal is NULL. */
enum err journal_create(struct journal **journal, const char *path, unsigned semantics,
                        struct fault *fault);

struct journal_resume {
    unsigned semantics; /* of a file without a header */
    /* Called with the number of the header before any record; not for a file without one. An error
     * ends the opening with that error. NULL calls nobody, and any number is taken. */
    enum err (*on_semantics)(void *context, unsigned semantics, struct fault *fault);
    /* Called for every sound record in order while the file is looked through, before anything is
     * carried out or changed. NULL calls nobody. */
    void (*on_sight)(void *context, const struct record *record);
    /* Called for every record in order, once it is known that the journal can be opened. An error
     * ends the opening with that error, the file as it was. NULL calls nobody. */
    enum err (*on_record)(void *context, const struct record *record, struct fault *fault);
    void *context;
    bool cuts_damage; /* repair on request: what follows the last sound record is cut off */
    bool only_looks;  /* takes no lock and never writes: what is appended is held in memory alone,
                         from where journal_continue takes it; a torn tail is left where it is */
};

/* Opens `path` to continue it. A torn tail (and damage, where asked for) is saved as PATH.torn-N,
 * N being the first that is free, and then cut off; `notice` (which may be NULL) then gets a line
 * for the user, safe to print, and is empty otherwise. An empty file gets a header. Damage is
 * refused with its record, line and offset: ERR_INPUT. On failure *journal is NULL and the records
 * in the file are what they were. */
enum err journal_open(struct journal **journal, const char *path,
                      const struct journal_resume *resume, struct buf *notice, struct fault *fault);

/* Keeps what is sound of the journal at `path`, whatever its semantics, saves the rest beside it as
 * journal_open does, and adds a line to `notice`: how many records are left, what was cut off, from
 * which byte, and where it is now; or that there was nothing to do. ERR_INPUT where not even line 1
 * can be read. `semantics` is for a file that has no header yet. */
enum err journal_repair(const char *path, unsigned semantics, struct buf *notice,
                        struct fault *fault);

/* Appends the record of a command that has been carried out: one write, one sync. Words are
 * "key=value key=value" or "". NULL is for a command that changes nothing of the segmentation: its
 * record has no words, and its sync waits for a second at most, or for the next record with words
 * or journal_catch_up. On failure the journal is what it was (J5). */
enum err journal_append(struct journal *journal, const char *command, const char *words,
                        struct fault *fault);

/* What waits so is synced: before a file is published that it led to, or the process is stopped. */
enum err journal_catch_up(struct journal *journal, struct fault *fault);

/* Keeps one comment line ("# why" or "") for the next record, which it becomes part of. It is lost
 * if there is none. */
enum err journal_comment(struct journal *journal, const char *comment, struct fault *fault);

/* Goes on in a new file: the whole journal so far is written to `path`, which must not exist, and
 * synced; what follows is recorded there. The former file stays as it was when it was last right.
 * On failure nothing has changed, and there is no new file. */
enum err journal_continue(struct journal *journal, const char *path, struct fault *fault);

/* When records are synced. FILE_SYNC_EVERY_SECOND: a loss of power may take the records of the last
 * second; FILE_SYNC_OFF: those since the system, journal_sync or journal_close last synced. Records
 * may then be lost from the end, or, where the disk wrote them in another order, damaged: what was
 * synced is sound in either case. */
enum err journal_set_sync(struct journal *journal, enum file_sync sync, struct fault *fault);

/* Every record is on the disk, or ERR_IO. What a failed sync may have lost is written again. */
enum err journal_sync(struct journal *journal, struct fault *fault);
bool journal_only_looks(const struct journal *journal);

/* The file beside it that stands for the lock of J6, where the file system has none; or NULL. */
const char *journal_lock_file(const struct journal *journal);

const char *journal_path(const struct journal *journal);
size_t journal_count(const struct journal *journal);            /* records */
const struct buf *journal_bytes(const struct journal *journal); /* the valid part: J7 */
const char *journal_chain(const struct journal *journal); /* 32 digits; zeros without a record */

/* Gives up the lock; fine with NULL. */
void journal_close(struct journal *journal);

/* ---- without running it ---- */

/* Adds the commands of a journal or script to `out`, a line each, with their comments and blank
 * lines; header, result lines and a torn tail are left out. What comes out is a script. The bytes
 * are those of the file: use buf_add_safe where they go to a terminal. ERR_INPUT for damage (what
 * was read until there is in `out`), ERR_MEMORY. */
enum err journal_script(struct buf *out, const char *bytes, size_t length, struct fault *fault);

enum journal_state {
    JOURNAL_INTACT,
    JOURNAL_SCRIPT, /* no header and no results: there is nothing to check */
    JOURNAL_TORN,
    JOURNAL_EDITED, /* it can be read, but from `number` on it is not as it was written */
    JOURNAL_DAMAGED /* it cannot be read from `number` on */
};

struct journal_condition {
    enum journal_state state;
    size_t records;            /* sound ones, or commands of a script */
    struct record_chain chain; /* of the last of them */
    unsigned semantics;
    size_t number;   /* where it is not intact: the first record that is not, */
    size_t line;     /* its line */
    uint64_t offset; /* and byte */
    char text[512];  /* the same in words, safe to print */
};

/* OK for what is intact or a script, ERR_CHECK for all else, with the words in fault as well. */
enum err journal_check(struct journal_condition *condition, const char *bytes, size_t length,
                       struct fault *fault);

#endif
