/* SPDX-License-Identifier: MIT */
#include "verify/verify.h"
#include "verify/verify_inside.h"

#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"
#include "command/command.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "verify/replay_file.h"

/* A walk through one of the two files, with its present command. */
struct two_replays {
    const char *name;
    enum first_of of;
    struct walk walk;
    struct record record;
    bool has_command;
    struct buf words; /* words of the command for FIRST_COMMAND, each ended by NUL */
};

/* Split a command into words. A command that cannot be parsed is one word. */
static void take_words(struct buf *words, const char *command)
{
    buf_clear(words);
    for (const char *at = command; scan_blanks(&at), *at;)
        if (!command_take_word(&at, words)) {
            buf_clear(words);
            buf_add(words, command, strlen(command) + 1);
            return;
        }
}

static bool is_recorded(const struct two_replays *f)
{
    const struct command *command =
        f->walk.is_journal || !f->words.length ? NULL : command_find(buf_text(&f->words));
    return !command || (command->flags & COMMAND_RECORDED);
}

static enum err step(struct two_replays *f, size_t last, struct fault *fault)
{
    if (f->of == FIRST_RECORD)
        f->has_command = walk_next_sound(&f->walk, &f->record) == WALK_RECORD;
    else
        do {
            f->has_command = walk_next(&f->walk, &f->record) == WALK_RECORD &&
                             (!last || f->record.number <= last);
            if (f->has_command)
                take_words(&f->words, f->record.command);
        } while (f->has_command && !is_recorded(f));
    if (f->words.failed)
        return fault_memory(fault, "a command");
    return f->walk.over == WALK_DAMAGED
               ? fault_set(fault, ERR_INPUT, "%s: %s", f->name, f->walk.fault.text)
               : OK;
}

static enum err begin(struct two_replays *f, const struct buf *bytes, struct fault *fault)
{
    TRY(fault_prefix(fault, walk_begin(&f->walk, buf_text(bytes), bytes->length, fault), "%s",
                     f->name));
    if (f->of == FIRST_RECORD && !f->walk.is_journal)
        return fault_set(fault, ERR_INPUT, "%s is a script, not a journal: it has no results",
                         f->name);
    return OK;
}

static bool are_same(const struct two_replays f[2])
{
    if (!f[0].has_command || !f[1].has_command)
        return false;
    if (f[0].of == FIRST_RECORD)
        return command_is_same(f[0].record.command, f[1].record.command) &&
               strcmp(f[0].record.result, f[1].record.result) == 0;
    return f[0].words.length == f[1].words.length &&
           memcmp(buf_text(&f[0].words), buf_text(&f[1].words), f[0].words.length) == 0;
}

static enum err note(struct first_difference *first, const struct two_replays f[2],
                     struct fault *fault)
{
    first->is_there = f[0].has_command || f[1].has_command;
    for (int i = 0; i < 2; i++) {
        first->side[i].has_command = f[i].has_command;
        if (!f[i].has_command)
            continue;
        first->side[i].number = f[i].record.number;
        first->side[i].line = f[i].record.line;
        buf_add_text(&first->side[i].command, f[i].record.command);
        buf_add_text(&first->side[i].result, f[i].record.result);
        if (first->side[i].command.failed || first->side[i].result.failed)
            return fault_memory(fault, "a command");
    }
    return OK;
}

enum err first_difference_find(struct first_difference *first, enum first_of of,
                               const char *const name[2], const struct buf bytes[2], size_t last,
                               struct fault *fault)
{
    struct two_replays f[2] = {{.name = name[0], .of = of}, {.name = name[1], .of = of}};
    enum err err = begin(f, bytes, fault);
    if (!err)
        err = begin(f + 1, bytes + 1, fault);
    for (bool differs = false; !err && !differs;) {
        err = step(f, last, fault);
        if (!err)
            err = step(f + 1, last, fault);
        differs = !err && !are_same(f);
        first->same += !err && !differs;
        if (differs)
            err = note(first, f, fault);
    }
    for (int i = 0; i < 2; i++) {
        while (!err && of == FIRST_RECORD && f[i].has_command) /* check that the rest is sound */
            err = step(f + i, last, fault);
        walk_release(&f[i].walk);
        buf_release(&f[i].words);
    }
    return err;
}

enum err first_difference_of_files(struct first_difference *first, enum first_of of,
                                   const char *const name[2], const char *const path[2],
                                   size_t last, struct fault *fault)
{
    struct buf bytes[2] = {{0}, {0}};
    enum err err = file_read(bytes, path[0], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = file_read(bytes + 1, path[1], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = first_difference_find(first, of, name, bytes, last, fault);
    buf_release(bytes);
    buf_release(bytes + 1);
    return err;
}

void first_difference_release(struct first_difference *first)
{
    for (int i = 0; i < 2; i++) {
        buf_release(&first->side[i].command);
        buf_release(&first->side[i].result);
    }
}

/* ---- the report ---- */

static void write_place(struct buf *text, const struct first_difference *first, int which,
                        const char *name)
{
    buf_add_text(text, "#   in       ");
    buf_add_safe_text(text, name);
    if (first->side[which].has_command) {
        buf_printf(text, ", line %zu: ", first->side[which].line);
        buf_add_safe_text(text, buf_text(&first->side[which].command));
    } else {
        buf_printf(text, ": it ends with record %zu", first->same);
    }
    buf_add_char(text, '\n');
}

enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault)
{
    const char *const path[2] = {a, b};
    OWNED(first_difference_release) struct first_difference first = {0};
    struct buf text = {0};
    TRY(first_difference_of_files(&first, FIRST_RECORD, path, path, 0, fault));
    buf_printf(&text, "%s 1 - ", first.is_there ? "not ok" : "ok");
    buf_add_safe_text(&text, a);
    buf_add_text(&text, " and ");
    buf_add_safe_text(&text, b);
    buf_printf(&text, " (%zu record%s the same)\n", first.same, plural(first.same));
    const struct buf *one = &first.side[0].command, *other = &first.side[1].command;
    const bool are_there = first.side[0].has_command && first.side[1].has_command;
    const bool is_result = are_there && command_is_same(buf_text(one), buf_text(other));
    if (first.is_there) {
        buf_printf(&text, "# record %zu is the first that differs: %s\n", first.same + 1,
                   is_result    ? "the results of the command differ"
                   : !are_there ? "only one of the two has this record"
                                : "the commands differ");
        write_place(&text, &first, 0, a);
        write_place(&text, &first, 1, b);
    }
    if (is_result)
        divergence_describe(&text, buf_text(&first.side[0].result), buf_text(&first.side[1].result),
                            DIVERGENCE_OF_JOURNALS);
    buf_add_text(&text, "1..1\n");
    TRY(print_text(&text, printer->print, printer, fault));
    if (first.is_there)
        return fault_set(fault, ERR_CHECK, "record %zu is the first that differs", first.same + 1);
    return OK;
}
