/* SPDX-License-Identifier: MIT */
#include "journal/journal.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"
#include "journal/record.h"

enum { COMMENTS_MAX = 1 << 20, WHO_MAX = 64 };

struct journal {
    struct file_log *log; /* NULL for a journal opened read-only */
    struct buf path;      /* path of the file */
    struct buf header;    /* line 1, part of the first record's chain */
    struct buf comments;  /* whole lines, for the next record */
    struct buf who;       /* name that signs records, or empty */
    bool times;           /* records are signed with their times */
    uint64_t session;     /* number of the session that signs; 0: none does */
    struct buf kept;      /* J7: the valid part; the file is longer only while it is ragged */
    enum file_sync sync;
    size_t count;
    struct record_chain chain;
};

void journal_close(struct journal *journal)
{
    if (!journal)
        return;
    file_log_close(journal->log);
    buf_release(&journal->path);
    buf_release(&journal->header);
    buf_release(&journal->comments);
    buf_release(&journal->who);
    buf_release(&journal->kept);
    free(journal);
}

static enum err journal_new(struct journal **journal, const char *path, unsigned semantics,
                            struct fault *fault)
{
    struct journal *j = *journal = calloc(1, sizeof *j);
    if (!j)
        return fault_memory(fault, "a journal");
    buf_add_text(&j->path, path);
    record_header(&j->header, semantics);
    j->chain = record_chain_zero;
    return j->header.failed || j->path.failed ? fault_memory(fault, "a journal") : OK;
}

/* Pass on a journal that was made without an error. */
static enum err finish(struct journal **out, struct journal *journal, enum err err)
{
    *out = err ? NULL : journal;
    if (err)
        journal_close(journal);
    return err;
}

/* Repair the file after earlier failures: cut rejected bytes off, write bytes whose sync failed
 * again. */
static enum err repair_failures(struct journal *journal, struct fault *fault)
{
    enum err err = OK;
    if (file_log_is_ragged(journal->log))
        err = file_log_cut(journal->log, journal->kept.length, fault);
    if (!err && file_log_is_in_doubt(journal->log))
        err = file_log_rewrite(journal->log, buf_text(&journal->kept), fault);
    return fault_prefix(fault, err, "an earlier failure is not repaired yet");
}

/* G2: find bytes that another program changed without changing the length. The log reports a
 * file that cannot be read or has another length. */
static enum err judge_content(const struct journal *journal, struct fault *fault)
{
    const struct buf *kept = &journal->kept;
    OWNED(buf_release) struct buf found = {0};
    size_t at = 0;
    if (!file_log_was_touched(journal->log))
        return OK;
    const bool is_comparable =
        file_read(&found, journal_path(journal), JOURNAL_BYTES_MAX, NULL) == OK &&
        found.length == kept->length;
    while (is_comparable && at < found.length && found.data[at] == kept->data[at])
        at++;
    const bool differs = is_comparable && at < found.length;
    if (is_comparable && !differs)
        file_log_note_times(journal->log);
    return differs ? fault_set(fault, ERR_IO,
                               "%s was changed by another program: its byte %zu differs from the "
                               "written one",
                               journal_path(journal), at)
                   : OK;
}

/* Append bytes to the file. All writes pass through here: J1, J2, J5, J7. */
static enum err append_bytes(struct journal *journal, const struct buf *bytes, bool may_wait,
                             struct fault *fault)
{
    struct buf *kept = &journal->kept;
    if (bytes->length > JOURNAL_BYTES_MAX - kept->length)
        return fault_set(fault, ERR_LIMIT, "%s would hold more than %zu bytes; nothing was written",
                         journal_path(journal), JOURNAL_BYTES_MAX);
    if (!buf_reserve(kept, bytes->length)) {
        kept->failed = false; /* the former bytes are complete */
        return fault_memory(fault, "the journal");
    }
    if (journal->log) {
        TRY(repair_failures(journal, fault));
        TRY(judge_content(journal, fault));
        assert(file_log_length(journal->log) == kept->length); /* J3 */
        TRY(file_log_append(journal->log, bytes->data, bytes->length, may_wait, fault));
    }
    buf_add(kept, bytes->data, bytes->length);
    return OK;
}

enum err journal_create(struct journal **out, const char *path, unsigned semantics,
                        struct fault *fault)
{
    struct journal *journal;
    enum err err = journal_new(&journal, path, semantics, fault);
    if (!err)
        err = file_log_open(&journal->log, path, true, fault);
    if (!err) {
        err = append_bytes(journal, &journal->header, false, fault);
        if (err)
            file_discard(path); /* created by this call */
    }
    return finish(out, journal, err);
}

enum err walk_file(struct walk *walk, struct buf *bytes, const char *path, struct fault *fault)
{
    *walk = (struct walk){0};
    TRY(file_read(bytes, path, JOURNAL_BYTES_MAX, fault));
    return walk_begin(walk, buf_text(bytes), bytes->length, fault);
}

/* ---- opening an existing journal -------------------------------------------------------------
 * */

/* Walk over the sound part, change nothing, and reject whatever must be rejected. The caller
 * releases the walk, which owns its memory. */
static enum err survey(struct walk *walk, const struct buf *bytes,
                       const struct journal_resume *resume, struct fault *fault)
{
    struct record record;
    TRY(walk_begin(walk, bytes->data, bytes->length, fault));
    if (!walk->is_journal)
        return fault_set(fault, ERR_INPUT,
                         "it has no header: this is a script, not a journal; run it instead");
    if (walk->semantics && resume->on_semantics)
        TRY(resume->on_semantics(resume->context, walk->semantics, fault));
    while (walk_next_sound(walk, &record) == WALK_RECORD)
        if (resume->on_sight)
            resume->on_sight(resume->context, &record);
    if (walk->over == WALK_DAMAGED && !resume->cuts_damage)
        return fault_set(
            fault, ERR_INPUT,
            "%s; nothing was changed (`iftty log --repair` keeps the records before it)",
            walk->fault.text);
    return OK;
}

/* Save the bytes after the sound part, cut them off, and report it. In this order the bytes are
 * always in one of the two files. */
static enum err cut_tail(struct journal *journal, const struct buf *bytes, const struct walk *sound,
                         struct buf *notice, struct fault *fault)
{
    OWNED(buf_release) struct buf name = {0};
    const size_t lost = bytes->length - sound->offset;
    TRY(file_write_beside(&name, journal_path(journal), "torn", bytes->data + sound->offset, lost,
                          fault));
    TRY(file_log_cut(journal->log, sound->offset, fault));
    if (notice) {
        buf_printf(notice, "%s; %zu byte%s stored in ", sound->fault.text, lost, plural(lost));
        buf_add_safe_text(notice, buf_text(&name));
        buf_printf(notice, " and cut off; %zu record%s left", sound->records,
                   plural(sound->records));
    }
    return OK;
}

/* Take over the sound part. Cut off the rest, unless the journal is read-only. */
static enum err take_over(struct journal *journal, const struct buf *bytes,
                          const struct walk *sound, struct buf *notice, struct fault *fault)
{
    const bool has_tail = sound->over != WALK_END && bytes->length > 0;
    buf_add(&journal->kept, buf_text(bytes), sound->offset);
    if (journal->kept.failed)
        return fault_memory(fault, "the journal");
    if (has_tail && journal->log)
        TRY(cut_tail(journal, bytes, sound, notice, fault));
    else if (has_tail && notice)
        buf_printf(notice, "%s; it was left where it is", sound->fault.text);
    journal->count = sound->records;
    journal->chain = sound->chain;
    if (sound->offset > 0) { /* line 1 of the file, for the first record's chain */
        buf_clear(&journal->header);
        record_header(&journal->header, sound->semantics);
        return journal->header.failed ? fault_memory(fault, "the journal") : OK;
    }
    /* The program that created the file may have ended before this sync. */
    TRY(journal->log ? file_sync_folder(journal_path(journal), fault) : OK);
    return append_bytes(journal, &journal->header, false, fault);
}

enum err journal_open(struct journal **out, const char *path, const struct journal_resume *resume,
                      struct buf *notice, struct fault *fault)
{
    struct journal *journal;
    OWNED(walk_release) struct walk sound = {0}, walk = {0};
    struct record record;
    OWNED(buf_release) struct buf bytes = {0};
    if (notice)
        buf_clear(notice);
    enum err err = journal_new(&journal, path, resume->semantics, fault);
    if (!err && !resume->only_looks)
        err = file_log_open(&journal->log, path, false, fault); /* J6 */
    if (!err)
        err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (!err && journal->log && bytes.length != file_log_length(journal->log))
        err = fault_set(fault, ERR_IO, "%s changed while it was opened", path);
    if (!err) {
        err = survey(&sound, &bytes, resume, fault);
        if (!err && resume->on_record && sound.records > 0) {
            err = walk_begin(&walk, bytes.data, sound.offset, fault);
            while (!err && walk_next_sound(&walk, &record) == WALK_RECORD)
                err = resume->on_record(resume->context, &record, fault);
            assert(err || walk.records == sound.records);
        }
        if (err)
            fault_prefix(fault, err, "cannot continue %s", path);
        else
            err = take_over(journal, &bytes, &sound, notice, fault);
    }
    return finish(out, journal, err);
}

enum err journal_repair(const char *path, unsigned semantics, struct buf *notice,
                        struct fault *fault)
{
    struct journal *journal;
    const struct journal_resume how = {.semantics = semantics, .cuts_damage = true};
    TRY(journal_open(&journal, path, &how, notice, fault));
    if (notice->length == 0)
        buf_printf(notice, "intact, %zu record%s; nothing was changed", journal_count(journal),
                   plural(journal_count(journal)));
    journal_close(journal);
    return OK;
}

/* ---- writing --------------------------------------------------------------------------------- */

enum err journal_who_check(const char *who, struct fault *fault)
{
    const size_t length = strlen(who);
    TRY(record_line_check("a name", who, fault));
    return length >= 1 && length <= WHO_MAX && !strchr(who, ' ')
               ? OK
               : fault_set(fault, ERR_USAGE,
                           "expected a name of 1 to %d bytes without blanks, not %.200s", WHO_MAX,
                           who);
}

enum err journal_sign(struct journal *journal, const char *who, bool times, struct fault *fault)
{
    OWNED(walk_release) struct walk walk;
    OWNED(buf_release) struct buf signature = {0};
    struct record record;
    struct record_word word;
    TRY(walk_begin(&walk, buf_text(&journal->kept), journal->kept.length, fault));
    while (walk_next(&walk, &record) == WALK_RECORD) {
        record_comments(NULL, &signature, walk.bytes, &record);
        const char *at =
            record_word_find(buf_text(&signature), "session", 7, &word) ? word.value : "";
        int64_t number;
        if (scan_integer(&at, 1, INT32_MAX, &number) && (uint64_t)number > journal->session)
            journal->session = (uint64_t)number;
    }
    journal->session++;
    journal->times = times;
    buf_add_text(&journal->who, who ? who : "");
    return signature.failed || journal->who.failed ? fault_memory(fault, "a name") : OK;
}

/* The line that signs a record made now; nothing if records are not signed. */
static void add_signature(struct buf *out, const struct journal *journal)
{
    const time_t now = time(NULL);
    struct tm utc;
    char text[32];
    if (!journal->session)
        return;
    buf_add_text(out, "#@");
    if (journal->who.length)
        buf_printf(out, " who=%s", buf_text(&journal->who));
    if (journal->times && gmtime_r(&now, &utc) &&
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc))
        buf_printf(out, " at=%s", text);
    buf_printf(out, " session=%llu\n", (unsigned long long)journal->session);
}

enum err journal_append(struct journal *journal, const char *command, const char *words,
                        struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0}, comments = {0};
    struct record_chain chain = journal->chain;
    const struct record record = {
        .number = journal->count + 1, .command = command, .result = words ? words : ""};
    const char *header = journal->count == 0 ? buf_text(&journal->header) : "";
    buf_add(&comments, journal->comments.data, journal->comments.length);
    add_signature(&comments, journal);
    enum err err = comments.failed
                       ? fault_memory(fault, "a record")
                       : record_encode(&bytes, &chain, header, buf_text(&comments), &record, fault);
    if (!err)
        err = append_bytes(journal, &bytes, words == NULL, fault);
    TRY(fault_prefix(fault, err, "not recorded"));
    journal->count++;
    journal->chain = chain;
    buf_clear(&journal->comments);
    return OK;
}

enum err journal_comment(struct journal *journal, const char *comment, struct fault *fault)
{
    struct buf *comments = &journal->comments;
    const size_t before = comments->length;
    TRY(record_comment_check(comment, fault));
    if (before + strlen(comment) >= COMMENTS_MAX)
        return fault_set(fault, ERR_LIMIT,
                         "the comments before one command are limited to %d bytes", COMMENTS_MAX);
    if (!buf_reserve(comments, strlen(comment) + 1)) {
        comments->failed = false; /* the former bytes are complete */
        return fault_memory(fault, "a comment");
    }
    buf_printf(comments, "%s\n", comment);
    return OK;
}

/* ---- another file, and when to sync ---------------------------------------------------------- */

enum err journal_continue(struct journal *journal, const char *path, struct fault *fault)
{
    struct file_log *log = NULL;
    struct buf name = {0};
    buf_add_text(&name, path);
    enum err err = name.failed ? fault_memory(fault, "a path") : OK;
    if (!err)
        err = file_log_open(&log, path, true, fault);
    if (!err)
        err = file_log_append(log, journal->kept.data, journal->kept.length, false, fault);
    if (!err)
        err = file_log_set_sync(log, journal->sync, fault);
    if (err) {
        if (log)
            file_discard(path); /* created by this call */
        file_log_close(log);
        buf_release(&name);
        return err;
    }
    if (journal->log && file_log_is_ragged(journal->log)) /* last attempt */
        file_log_cut(journal->log, journal->kept.length, NULL);
    file_log_close(journal->log);
    buf_release(&journal->path);
    journal->log = log;
    journal->path = name;
    return OK;
}

enum err journal_set_sync(struct journal *journal, enum file_sync sync, struct fault *fault)
{
    if (journal->log && sync == FILE_SYNC_ALWAYS)
        TRY(repair_failures(journal, fault));
    if (journal->log)
        TRY(file_log_set_sync(journal->log, sync, fault));
    journal->sync = sync;
    return OK;
}

enum err journal_sync(struct journal *journal, struct fault *fault)
{
    if (!journal->log)
        return OK;
    TRY(repair_failures(journal, fault));
    return file_log_sync(journal->log, fault);
}

enum err journal_catch_up(struct journal *journal, struct fault *fault)
{
    return journal->sync == FILE_SYNC_ALWAYS ? journal_sync(journal, fault) : OK;
}

bool journal_only_looks(const struct journal *journal)
{
    return journal->log == NULL;
}

const char *journal_lock_file(const struct journal *journal)
{
    return journal->log ? file_log_lock_file(journal->log) : NULL;
}

const char *journal_path(const struct journal *journal)
{
    return buf_text(&journal->path);
}

size_t journal_count(const struct journal *journal)
{
    return journal->count;
}

const struct buf *journal_bytes(const struct journal *journal)
{
    return &journal->kept;
}

const char *journal_chain(const struct journal *journal)
{
    return journal->chain.hex;
}

/* ---- without carrying it out -----------------------------------------------------------------
 * */

enum err journal_script(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    OWNED(walk_release) struct walk walk;
    struct record record;
    TRY(walk_begin(&walk, bytes, length, fault));
    while (walk_next(&walk, &record) == WALK_RECORD) {
        record_comments(out, NULL, walk.bytes, &record);
        buf_add(out, walk.bytes + record.command_offset,
                (size_t)(record.result_offset - record.command_offset));
        if (out->length && out->data[out->length - 1] != '\n')
            buf_add_char(out, '\n');
    }
    if (walk.over == WALK_END) /* last comments of a script */
        buf_add(out, walk.bytes + walk.offset, walk.length - walk.offset);
    return out->failed ? fault_memory(fault, "the commands of a journal")
                       : walk_judge(&walk, fault);
}

static enum err condition_set(struct journal_condition *condition, enum journal_state state,
                              const struct record *place, const char *text, struct fault *fault)
{
    condition->state = state;
    condition->number = place->number;
    condition->line = place->line;
    condition->offset = place->offset;
    snprintf(condition->text, sizeof condition->text, "%s", text);
    return fault_set(fault, ERR_CHECK, "%s", text);
}

/* Place of a fault in the header, which belongs to the first record. */
static const struct record line_1 = {.number = 1, .line = 1};

enum err journal_check(struct journal_condition *condition, const char *bytes, size_t length,
                       struct fault *fault)
{
    OWNED(walk_release) struct walk walk;
    struct record record;
    struct fault words;
    *condition = (struct journal_condition){.chain = record_chain_zero};
    enum err err = walk_begin(&walk, bytes, length, &words);
    if (err == ERR_INPUT)
        return condition_set(condition, JOURNAL_DAMAGED, &line_1, words.text, fault);
    if (err)
        return fault_set(fault, err, "%s", words.text);
    condition->semantics = walk.semantics;
    while (!err && walk_next(&walk, &record) == WALK_RECORD) {
        if (walk.is_journal && record_judge(&record, &words)) {
            err = condition_set(condition, JOURNAL_EDITED, &record, words.text, fault);
        } else if (!walk.is_journal && record.has_result) {
            err = condition_set(condition, JOURNAL_EDITED, &line_1,
                                "there are result lines, but line 1 is not a journal's header",
                                fault);
        } else {
            condition->records++;
            condition->chain = record.chain;
        }
    }
    if (err)
        return err;
    if (walk.over == WALK_TORN)
        return condition_set(condition, JOURNAL_TORN, &record, walk.fault.text, fault);
    if (walk.over == WALK_DAMAGED)
        return condition_set(condition, JOURNAL_DAMAGED, &record, walk.fault.text, fault);
    condition->state = walk.is_journal ? JOURNAL_INTACT : JOURNAL_SCRIPT;
    snprintf(condition->text, sizeof condition->text, "%s, %zu %s%s",
             walk.is_journal ? "intact" : "a script", condition->records,
             walk.is_journal ? "record" : "command", plural(condition->records));
    return OK;
}
