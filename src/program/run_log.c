/* SPDX-License-Identifier: MIT */
/* `iftty log`: print a journal in several forms, and repair it. */
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "command/anonymise.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "program/programs.h"
#include "session/session.h"

/* ---- anonymous commands ---- */

/* List the commands of a journal or script, one a line: journal_script without comments and
 * names. */
static enum err anonymise_script(struct buf *out, const char *bytes, size_t length,
                                 struct fault *fault)
{
    OWNED(buf_release) struct buf names = {0};
    OWNED(walk_release) struct walk walk;
    struct record record;
    TRY(walk_begin(&walk, bytes, length, fault));
    while (walk_next(&walk, &record) == WALK_RECORD) {
        anonymise_command(&names, out, record.command);
        buf_add_char(out, '\n');
    }
    return out->failed ? fault_memory(fault, "the commands of a journal")
                       : walk_judge(&walk, fault);
}

/* ---- the forms ---- */

/* Print the output of `write`, also after an error, line by line, escaped for the terminal. */
static enum err print_written(enum err (*write)(struct buf *out, const char *bytes, size_t length,
                                                struct fault *fault),
                              const struct options *o, struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0}, text = {0}, line = {0};
    enum err err = file_read(&bytes, o->word[0], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = write(&text, buf_text(&bytes), bytes.length, fault);
    if (bytes.length)
        fault_prefix(fault, err, "%s", o->word[0]);
    if (!err && text.failed)
        err = fault_memory(fault, "a journal");
    for (const char *at = buf_text(&text), *end = at + text.length; at < end;) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const size_t n = feed ? (size_t)(feed - at) : (size_t)(end - at);
        buf_clear(&line);
        buf_add_safe(&line, at, n);
        puts(buf_text(&line));
        at += n + 1;
    }
    return err;
}

/* Copy a journal unchanged, intact or not. Other files, such as scenes, are an error. */
static enum err copy_journal(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    OWNED(walk_release) struct walk walk;
    const enum err err = walk_begin(&walk, bytes, length, fault);
    if (err && !walk.is_journal)
        return err;
    buf_add(out, bytes, length);
    return OK;
}

enum err run_log(const struct options *o, struct fault *fault)
{
    return print_written(copy_journal, o, fault);
}

enum err run_log_script(const struct options *o, struct fault *fault)
{
    return print_written(journal_script, o, fault);
}

enum err run_log_anonymise(const struct options *o, struct fault *fault)
{
    return print_written(anonymise_script, o, fault);
}

/* List records: number, time, name and session of the line that signs it, each - if missing, and
 * the command. */
static enum err list_times(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    static const char *const key[] = {"at", "who", "session"};
    OWNED(walk_release) struct walk walk;
    OWNED(buf_release) struct buf signature = {0};
    struct record record;
    TRY(walk_begin(&walk, bytes, length, fault));
    while (walk_next(&walk, &record) == WALK_RECORD) {
        buf_clear(&signature);
        record_comments(NULL, &signature, bytes, &record);
        buf_printf(out, "%zu", record.number);
        for (int i = 0; i < 3; i++) {
            struct record_word word;
            const bool has = record_word_find(buf_text(&signature), key[i], strlen(key[i]), &word);
            buf_add_char(out, ' ');
            buf_add(out, has ? word.value : "-", has ? word.value_length : 1);
        }
        buf_printf(out, " %s\n", record.command);
    }
    return out->failed || signature.failed ? fault_memory(fault, "the records of a journal")
                                           : walk_judge(&walk, fault);
}

enum err run_log_times(const struct options *o, struct fault *fault)
{
    return print_written(list_times, o, fault);
}

static enum err check_journal(struct buf *out, const char *bytes, size_t length,
                              struct fault *fault)
{
    struct journal_condition condition;
    TRY(journal_check(&condition, bytes, length, fault));
    buf_printf(out, "%s\n", condition.text);
    return OK;
}

enum err run_log_check(const struct options *o, struct fault *fault)
{
    return print_written(check_journal, o, fault);
}

enum err run_log_repair(const struct options *o, struct fault *fault)
{
    OWNED(buf_release) struct buf lines = {0};
    TRY(journal_repair(o->word[0], SEMANTICS, &lines, fault));
    puts(buf_text(&lines));
    return OK;
}
