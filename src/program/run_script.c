/* `iftty run` and `iftty -c`: commands without a prompt. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "journal/journal.h"
#include "command/script.h"
#include "program/begin.h"
#include "program/console.h"
#include "program/programs.h"
#include "program/shown.h"
#include "tui/prompt/repl.h"

static void show_picture(void *context, struct interpreter *interp)
{
    const struct options *o = context;
    struct image_view view = shown_picture(interp, o->smooth);
    fflush(stdout);
    if (isatty(STDOUT_FILENO))
        show_picture_once(o->graphics, &view);
}

/* A word as a shell takes it. */
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

/* After lines that were stopped: what the journal has, and what to type. A script that opens its
 * scene goes on by itself (command/script.h); of another one, the rest does. */
static void say_how_to_go_on(const struct options *o, const struct journal *journal, FILE *input,
                             size_t line)
{
    struct buf text = {0};
    bool knows;
    if (!journal || !line || journal_only_looks(journal))
        return;
    buf_add_safe_text(&text, journal_path(journal));
    buf_printf(&text,
               " holds %zu record%s, up to what stands before line %zu; to go on there:\n    ",
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
    buf_add_text(&text, " --journal ");
    add_argument(&text, journal_path(journal));
    buf_add_char(&text, '\n');
    console_warn(NULL, buf_text(&text));
    buf_release(&text);
}

static enum err run_lines(const struct options *o, FILE *input, const char *name,
                          struct fault *fault)
{
    struct interpreter interp;
    const struct printer printer = {.context = (void *)(uintptr_t)o,
                                    .print = console_print,
                                    .warn = console_warn,
                                    .show = show_picture,
                                    .waits = console_wait};
    console_handle_interrupts();
    enum err err = begin_interpreter(&interp, o, fault);
    begin_to_wait(&interp);
    if (!err) {
        size_t stopped;
        err = script_run(&interp, input, name, o->keep_going, &printer, &stopped, fault);
        fault->text[0] = '\0'; /* printed with its line */
        say_how_to_go_on(o, interp.journal, input, stopped);
    }
    err = end_journal(&interp, err, fault);
    interpreter_release(&interp);
    return err;
}

enum err run_script(const struct options *o, struct fault *fault)
{
    if (strcmp(o->word[0], "-") == 0)
        return run_lines(o, stdin, "standard input", fault);
    FILE *input = fopen(o->word[0], "re");
    if (!input)
        return fault_errno(fault, "open", o->word[0]);
    const enum err err = run_lines(o, input, o->word[0], fault);
    fclose(input);
    return err;
}

/* A line for each command: semicolons part them, but not in quotes, nor in a comment, which goes on
 * to the end of its line. */
static void split_commands(struct buf *lines, const char *at)
{
    bool blank = true, comment = false, begins = true; /* a line; a word */
    char quote = '\0';                                 /* the one that is open */
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
    struct buf lines = {0};
    split_commands(&lines, o->commands);
    FILE *input = lines.failed ? NULL : fmemopen(lines.data, lines.length, "r");
    enum err err = input ? run_lines(o, input, "-c", fault) : fault_memory(fault, "commands");
    if (input)
        fclose(input);
    buf_release(&lines);
    return err;
}
