/* SPDX-License-Identifier: MIT */
/*
 * The journal: a file of records that one session appends to, and that others resume and replay.
 *
 * Promises; tests use the same numbers:
 *   J1 a command is acknowledged only after its record is synced: when journal_append returns OK,
 *      the record and all earlier ones are on the disk. A command that does not change the
 *      segmentation is acknowledged when its record is written: a loss of power may remove such
 *      records of the last second from the end, but no record of another command. journal_set_sync
 *      weakens this promise on request;
 *   J2 the file is always header + valid records + at most one torn record;
 *   J3 bytes before the end of the valid part never change;
 *   J4 replay reproduces every recorded word, or stops at the first that differs and names it
 *      (journal/replay.h);
 *   J5 if an append fails, the file is cut back to its former length and the call returns an error;
 *      the caller undoes the edit. No record is appended until the cut is on the disk, so that a
 *      rejected record cannot reappear;
 *   J6 one writer at a time: the file is locked from journal_create or journal_open to
 *      journal_close. Readers (replay, journal_check) take no lock;
 *   J7 the session outlives the file: every byte is also in memory, so that the journal can
 *      continue in another file (journal_continue) when this one is full, deleted or failing.
 *
 * journal/FORMAT.md describes the bytes; record.h encodes and walks them. A journal holds at most
 * JOURNAL_BYTES_MAX bytes, which bounds the memory of a reader.
 */
#ifndef JOURNAL_JOURNAL_H
#define JOURNAL_JOURNAL_H

#include "base/file_log.h"
#include "journal/record.h"

#define JOURNAL_BYTES_MAX ((size_t)256 << 20)

/* Opaque, because of J1 to J3. Owned by the caller who created or opened it. */
struct journal;

/* Create `path`, which must not exist, with its header synced. `semantics` is the version of the
 * meaning of commands, 1..999999999. On failure no file was created and *journal is NULL. */
enum err journal_create(struct journal **journal, const char *path, unsigned semantics,
                        struct fault *fault);

struct journal_resume {
    unsigned semantics; /* for a file without a header */
    /* Called with the number of the header before any record, if the file has one. If it fails,
     * journal_open fails with its error. NULL accepts any number. */
    enum err (*on_semantics)(void *context, unsigned semantics, struct fault *fault);
    /* Called for every sound record in order while the file is surveyed, before any call of
     * on_record and any change of the file; or NULL. */
    void (*on_sight)(void *context, const struct record *record);
    /* Called for every record in order, after the whole journal was accepted; or NULL. If it fails,
     * journal_open fails with its error, and the file is unchanged. */
    enum err (*on_record)(void *context, const struct record *record, struct fault *fault);
    void *context;
    bool cuts_damage; /* repair on request: cut off everything after the last sound record */
    bool only_looks;  /* take no lock and never write: appended records are kept in memory
                         only, until journal_continue stores them; a torn tail is left as it
                         is */
};

/* Open `path` to continue it. Save a torn tail (and damage, on request) as PATH.torn-N, with the
 * first free N, and cut it off; `notice` (may be NULL) then receives a line for the user, safe to
 * print, and is empty otherwise. An empty file receives a header. Damage is rejected with its
 * record, line and offset: ERR_INPUT. On failure *journal is NULL and the records in the file are
 * unchanged. */
enum err journal_open(struct journal **journal, const char *path,
                      const struct journal_resume *resume, struct buf *notice, struct fault *fault);

/* Keep the sound part of the journal at `path`, of any semantics, save the rest next to it as
 * journal_open does, and add a line to `notice`: the number of remaining records, the bytes cut off
 * and their file; or that the journal is intact. ERR_INPUT if line 1 cannot be read. `semantics` is
 * for a file without a header. */
enum err journal_repair(const char *path, unsigned semantics, struct buf *notice,
                        struct fault *fault);

/* Append the record of an executed command: one write, one sync. Words are "key=value key=value" or
 * "". NULL is for a command that does not change the segmentation: its record has no words, and is
 * synced within a second, or with the next record with words, or by journal_catch_up. On failure
 * the journal is unchanged (J5). */
enum err journal_append(struct journal *journal, const char *command, const char *words,
                        struct fault *fault);

/* Sync waiting records. Call this before a file that they produced is published, and before the
 * process is stopped.
 * */
enum err journal_catch_up(struct journal *journal, struct fault *fault);

/* Keep one comment line ("# why" or "") and write it with the next record. It is lost if no record
 * follows. */
enum err journal_comment(struct journal *journal, const char *comment, struct fault *fault);

/* Continue in a new file: write the whole journal to `path`, which must not exist, and sync it;
 * later records are appended there. The former file keeps its last sound state. On failure the
 * journal is unchanged, and no new file exists. */
enum err journal_continue(struct journal *journal, const char *path, struct fault *fault);

/* Set when records are synced. FILE_SYNC_EVERY_SECOND: a loss of power may remove the records of
 * the last second; FILE_SYNC_OFF: those since the last sync by the system, journal_sync or
 * journal_close. Records may then be missing at the end, or be damaged if the disk wrote them in
 * another order: synced records are sound in either case. */
enum err journal_set_sync(struct journal *journal, enum file_sync sync, struct fault *fault);

/* Sync every record, or return ERR_IO. Records that a failed sync may have lost are written
 * again. */
enum err journal_sync(struct journal *journal, struct fault *fault);
bool journal_only_looks(const struct journal *journal);

/* Path of the file that replaces the lock of J6 on file systems without locks; or NULL. */
const char *journal_lock_file(const struct journal *journal);

const char *journal_path(const struct journal *journal);
size_t journal_count(const struct journal *journal);            /* records */
const struct buf *journal_bytes(const struct journal *journal); /* the valid part: J7 */
const char *journal_chain(const struct journal *journal); /* 32 digits; zeros without a record */

/* Release the lock and free the journal; NULL is fine. */
void journal_close(struct journal *journal);

/* ---- without running commands ---- */

/* Append the commands of a journal or script to `out`, a line each, with their comments and
 * blank lines, but without header, result lines and a torn tail. The result is a script. Use
 * buf_add_safe to print its bytes on a terminal. ERR_INPUT for damage (`out` holds the part before
 * it), ERR_MEMORY. */
enum err journal_script(struct buf *out, const char *bytes, size_t length, struct fault *fault);

enum journal_state {
    JOURNAL_INTACT,
    JOURNAL_SCRIPT, /* no header and no results: nothing to check */
    JOURNAL_TORN,
    JOURNAL_EDITED, /* readable, but changed from record `number` on */
    JOURNAL_DAMAGED /* not readable from record `number` on */
};

struct journal_condition {
    enum journal_state state;
    size_t records;            /* sound records, or commands of a script */
    struct record_chain chain; /* chain of the last of them */
    unsigned semantics;
    size_t number;   /* first record that is not intact, */
    size_t line;     /* its line */
    uint64_t offset; /* and byte */
    char text[512];  /* the same in words, safe to print */
};

/* OK for an intact journal or a script, otherwise ERR_CHECK, with the words in `fault` too. */
enum err journal_check(struct journal_condition *condition, const char *bytes, size_t length,
                       struct fault *fault);

#endif
