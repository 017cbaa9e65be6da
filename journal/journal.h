/* SPDX-License-Identifier: MIT */
/*
 * The journal: a file of records. One session appends to it; later sessions resume and replay it.
 *
 * Promises; tests use the same numbers:
 *   J1 a command that changes the segmentation is acknowledged only after its record is synced:
 *      when journal_append returns OK, the record and all earlier ones are on the disk. Any other
 *      command is acknowledged when its record is written: a loss of power may remove such records
 *      of the last second from the end of the file, but no record of a command that changes the
 *      segmentation. journal_set_sync can weaken this promise;
 *   J2 the file is always header + valid records + at most one torn record;
 *   J3 the bytes of valid records never change;
 *   J4 replay reproduces every recorded word, or stops at the first one that differs and reports it
 *      (journal/replay.h);
 *   J5 if an append fails, the file is truncated to its former length and the call returns an
 *      error; the caller undoes the edit. No record is appended until the truncation is on the
 *      disk, so that a rejected record cannot reappear;
 *   J6 one writer at a time: the file is locked from journal_create or journal_open to
 *      journal_close. Readers (replay, journal_check) take no lock;
 *   J7 the session does not need the file: every byte is also in memory, so that the journal can
 *      continue in another file (journal_continue) if the disk is full or failing, or if the file
 *      was deleted.
 *
 * journal/FORMAT.md describes the bytes; record.h encodes records and iterates over them. A journal
 * has at most JOURNAL_BYTES_MAX bytes, which limits the memory of a reader.
 */
#ifndef JOURNAL_JOURNAL_H
#define JOURNAL_JOURNAL_H

#include "base/file_log.h"
#include "journal/record.h"

#define JOURNAL_BYTES_MAX ((size_t)256 << 20)

/* Begin a walk over a file; it uses the bytes, so release both. */
enum err walk_file(struct walk *walk, struct buf *bytes, const char *path, struct fault *fault);

/* Opaque, because of J1 to J3. Owned by the caller who created or opened it. */
struct journal;

/* Create the file `path`, which must not exist, and sync its header. `semantics` is the version of
 * the meaning of commands, 1..999999999. On failure there is no file and *journal is NULL. */
enum err journal_create(struct journal **journal, const char *path, unsigned semantics,
                        struct fault *fault);

struct journal_resume {
    unsigned semantics; /* for a file without a header */
    /* Called before any record, with the semantics in the header, if the file has a header. If it
     * fails, journal_open fails with its error. NULL accepts any semantics. */
    enum err (*on_semantics)(void *context, unsigned semantics, struct fault *fault);
    /* Called for every valid record in order during a first scan, before any call of on_record and
     * any change of the file; or NULL. */
    void (*on_sight)(void *context, const struct record *record);
    /* Called for every record in order, after the first scan has accepted the whole journal; or
     * NULL. If it fails, journal_open fails with its error, and the file is unchanged. */
    enum err (*on_record)(void *context, const struct record *record, struct fault *fault);
    void *context;
    bool cuts_damage; /* repair: cut off everything after the last valid record */
    bool only_looks;  /* open read-only, without a lock: appended records are only in memory
                         until journal_continue writes them; a torn tail is not cut off */
};

/* Open `path` to continue it. Move a torn tail, and with cuts_damage also a damaged one, to
 * PATH.torn-N, with the first free N; `notice` (may be NULL) then receives a line for the user,
 * safe to print, and is empty otherwise. An empty file receives a header. Without cuts_damage,
 * return ERR_INPUT for damage, and name its record, line and offset. On failure *journal is NULL
 * and the records in the file are unchanged. */
enum err journal_open(struct journal **journal, const char *path,
                      const struct journal_resume *resume, struct buf *notice, struct fault *fault);

/* Repair a journal of any semantics: keep the valid part, and move the rest to another file, as
 * journal_open does. Add a line to `notice`: the number of remaining records, the number of moved
 * bytes and their file, or that the journal is intact. ERR_INPUT if line 1 cannot be read.
 * `semantics` is for a file without a header. */
enum err journal_repair(const char *path, unsigned semantics, struct buf *notice,
                        struct fault *fault);

/* Append the record of an executed command, by one write and one sync. `words` is "key=value
 * key=value" or "". NULL is for a command that does not change the segmentation: its record has no
 * words, and is synced with the next record that has words, by journal_catch_up or after a second,
 * whichever is first. On failure the journal is unchanged (J5). */
enum err journal_append(struct journal *journal, const char *command, const char *words,
                        struct fault *fault);

/* Sync the records that are not synced yet, with FILE_SYNC_ALWAYS; do nothing with other settings.
 * Call this before publishing a file that they have produced, and before the process is stopped. */
enum err journal_catch_up(struct journal *journal, struct fault *fault);

/* Store a comment line ("# why" or ""), and write it with the next record. It is lost if no record
 * follows. */
enum err journal_comment(struct journal *journal, const char *comment, struct fault *fault);

/* ERR_USAGE unless a name is 1 to 64 bytes without blanks and control characters. */
enum err journal_who_check(const char *who, struct fault *fault);

/* Sign each further record by a comment line (RECORD_SIGNATURE): with this valid name, unless it is
 * NULL, with `times` by the UTC time to the second, and with the number of this session, which
 * counts the sessions that signed records of the journal, from 1. Replays ignore it. */
enum err journal_sign(struct journal *journal, const char *who, bool times, struct fault *fault);

/* Continue in a new file: write the whole journal to `path`, which must not exist, and sync it;
 * append later records there. The former file keeps its last valid state. On failure the journal is
 * unchanged, and there is no new file. */
enum err journal_continue(struct journal *journal, const char *path, struct fault *fault);

/* Set the times at which records are synced. FILE_SYNC_EVERY_SECOND: a loss of power may remove the
 * records of the last second; FILE_SYNC_OFF: those since the last sync by the system, journal_sync
 * or journal_close. After a loss of power, records may be missing at the end, or damaged if the
 * disk wrote them in another order; synced records are always valid. */
enum err journal_set_sync(struct journal *journal, enum file_sync sync, struct fault *fault);

/* Sync every record, or return ERR_IO. Records that a failed sync may have lost are written
 * again. */
enum err journal_sync(struct journal *journal, struct fault *fault);

/* True if it was opened with only_looks, and does not continue in another file yet. */
bool journal_only_looks(const struct journal *journal);

/* Path of the lock file that is used for J6 on file systems without locks; otherwise NULL. */
const char *journal_lock_file(const struct journal *journal);

const char *journal_path(const struct journal *journal);
size_t journal_count(const struct journal *journal);            /* records */
const struct buf *journal_bytes(const struct journal *journal); /* the valid part: J7 */
const char *journal_chain(const struct journal *journal); /* 32 digits; zeros without a record */

/* Release the lock and free the journal, which may be NULL. */
void journal_close(struct journal *journal);

/* ---- without running commands ---- */

/* Append the commands of a journal or script to `out`, one per line, with comments and blank lines,
 * but without the header, lines of results and a torn tail. The result is a script. Use
 * buf_add_safe to print its bytes on a terminal. ERR_INPUT for damage (`out` holds the part before
 * it), ERR_MEMORY. */
enum err journal_script(struct buf *out, const char *bytes, size_t length, struct fault *fault);

enum journal_state {
    JOURNAL_INTACT,
    JOURNAL_SCRIPT, /* without header and results: nothing to check */
    JOURNAL_TORN,
    JOURNAL_EDITED, /* readable, but changed since it was written, from record `number` on */
    JOURNAL_DAMAGED /* not readable from record `number` on */
};

struct journal_condition {
    enum journal_state state;
    size_t records;            /* valid records, or commands of a script */
    struct record_chain chain; /* chain of the last valid record */
    unsigned semantics;
    size_t number;   /* first record that is not intact; 0 if all are */
    size_t line;     /* line of this record */
    uint64_t offset; /* offset of this record, in bytes */
    char text[512];  /* state, number, line and offset in words, safe to print */
};

/* Find the condition of a journal. OK for an intact journal or a script, otherwise ERR_CHECK, with
 * condition->text in `fault`; ERR_MEMORY. */
enum err journal_check(struct journal_condition *condition, const char *bytes, size_t length,
                       struct fault *fault);

#endif
