/* SPDX-License-Identifier: MIT */
/* `iftty run` and `iftty -c`: commands without a prompt. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "command/script.h"
#include "journal/journal.h"
#include "program/programs.h"
#include "tui/prompt/repl.h"

static void show_picture(void *context, struct interpreter *interp)
{
    const struct options *o = context;
    struct image_view view = shown_picture(interp, o->smooth);
    fflush(stdout);
    if (isatty(STDOUT_FILENO))
        show_picture_once(o->graphics, &view);
}

/* Quote a word for a shell. */
static void add_argument(struct buf *out, const char *word)
{
    const bool is_plain =
        *word && !word[strspn(word, "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                    "abcdefghijklmnopqrstuvwxyz0123456789+,-./:_")];
    buf_add_text(out, is_plain ? "" : "'");
    for (const char *at = word; *at; at += strcspn(at, "'")) {
        if (*at == '\'') {
            buf_add_text(out, "'\\''");
            at++;
        }
        buf_add_safe(out, at, strcspn(at, "'"));
    }
    buf_add_text(out, is_plain ? "" : "'");
}

/* After an interrupted script, print the number of records and the command that continues. A script
 * that opens its scene is repeated whole (command/script.h); of others the rest is. */
static void say_how_to_go_on(const struct options *o, const struct journal *journal, FILE *input,
                             size_t line)
{
    OWNED(buf_release) struct buf text = {0};
    bool knows;
    if (!journal || !line || journal_only_looks(journal))
        return;
    buf_add_safe_text(&text, journal_path(journal));
    buf_printf(&text, " holds %zu record%s, of the lines before line %zu; to continue there:\n    ",
               journal_count(journal), plural(journal_count(journal)), line);
    const bool is_file = !o->commands && strcmp(o->word[0], "-") != 0;
    const bool is_whole =
        is_file && fseek(input, 0, SEEK_SET) == 0 && script_opens_scene(input, &knows);
    if (is_file && !is_whole) {
        buf_printf(&text, "tail -n +%zu ", line);
        add_argument(&text, o->word[0]);
        buf_add_text(&text, " | ");
    }
    buf_add_text(&text, "iftty run ");
    add_argument(&text, is_whole ? o->word[0] : "-");
    buf_add_text(&text, o->whole ? " --whole --journal " : " --journal ");
    add_argument(&text, o->whole ? o->journal : journal_path(journal));
    buf_add_char(&text, '\n');
    console_warn(NULL, buf_text(&text));
}

/* With --whole, rename the journal to its final name, which is still free, under its lock. An
 * existing complete journal must have `records` records: nothing was written to it. */
static enum err publish(const struct options *o, const struct journal *journal, size_t records,
                        struct fault *fault)
{
    if (!journal_only_looks(journal))
        return file_rename_new(journal_path(journal), o->journal, fault);
    return journal_count(journal) == records
               ? OK
               : fault_set(fault, ERR_INPUT,
                           "%s is complete, and the script has more commands: nothing was added; "
                           "begin another journal with `--journal FILE`",
                           o->journal);
}

static void print_json(const struct options *o, const struct journal *journal, bool is_done)
{
    OWNED(buf_release) struct buf text = {0};
    struct json json = {.out = &text};
    json_object(&json, NULL);
    json_boolean(&json, "done", is_done);
    if (journal) {
        json_text(&json, "journal", o->journal);
        json_count(&json, "records", journal_count(journal));
        json_text(&json, "chain", journal_chain(journal));
    }
    json_end(&json);
    console_print(NULL, buf_text(&text));
}

static void print_nothing(void *context, const char *text)
{
    (void)context;
    (void)text;
}

static enum err run_lines(const struct options *o, FILE *input, const char *name,
                          struct fault *fault)
{
    TRY(begin_check_channels(o, false, fault));
    OWNED(interpreter_release) struct interpreter interp;
    const struct printer printer = {.context = (void *)(uintptr_t)o,
                                    .print = o->json ? print_nothing : console_print,
                                    .warn = console_warn,
                                    .show = o->json ? NULL : show_picture,
                                    .waits = console_wait};
    console_handle_interrupts();
    enum err err = begin_by_options(&interp, o, fault);
    begin_to_wait(&interp);
    if (!err) {
        const size_t records = interp.journal ? journal_count(interp.journal) : 0;
        size_t stopped;
        err = script_run(&interp, input, name, o->keep_going, &printer, &stopped, fault);
        fault->text[0] = '\0'; /* it was printed with its line */
        say_how_to_go_on(o, interp.journal, input, stopped);
        err = end_journal(&interp, err, fault);
        if (!err && o->whole)
            err = publish(o, interp.journal, records, fault);
    }
    if (o->json)
        print_json(o, interp.journal, !err);
    return err;
}

enum err run_script(const struct options *o, struct fault *fault)
{
    if (strcmp(o->word[0], "-") == 0)
        return run_lines(o, stdin, "standard input", fault);
    OWNED(stream_release) FILE *input = fopen(o->word[0], "re");
    return input ? run_lines(o, input, o->word[0], fault) : fault_errno(fault, "open", o->word[0]);
}

/* Write each command on a line: semicolons separate them, except in quotes and in comments, which
 * end with their line. */
static void split_commands(struct buf *lines, const char *at)
{
    bool blank = true, comment = false, begins = true; /* at the beginning of a line; of a word */
    char quote = '\0';                                 /* the open quote */
    for (; *at; at++) {
        comment = *at != '\n' && (comment || (blank && *at == '#'));
        if (!comment && *at == quote)
            quote = '\0';
        else if (!comment && !quote && (*at == '"' || (begins && *at == '\'')))
            quote = *at;
        if (quote == '"' && *at == '\\' && at[1])
            buf_add_char(lines, *at++);
        bool parts = *at == '\n' || (*at == ';' && !quote && !comment);
        buf_add_char(lines, parts ? '\n' : *at);
        quote = parts ? '\0' : quote;
        begins = parts || *at == ' ' || *at == '\t';
        blank = parts || (blank && *at == ' ');
    }
    buf_add_char(lines, '\n');
}

enum err run_commands(const struct options *o, struct fault *fault)
{
    OWNED(buf_release) struct buf lines = {0};
    split_commands(&lines, o->commands);
    OWNED(stream_release)
    FILE *input = lines.failed ? NULL : fmemopen(lines.data, lines.length, "r");
    return input ? run_lines(o, input, "-c", fault) : fault_memory(fault, "commands");
}
