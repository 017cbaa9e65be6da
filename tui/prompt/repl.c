/* SPDX-License-Identifier: MIT */
#include "tui/prompt/repl.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "tui/cells.h"
#include "tui/prompt/pager.h"
#include "tui/term.h"

enum { BARRIER_MS = 2000 };

static bool is_blank(const char *line)
{
    return line[strspn(line, " \t\r")] == '\0';
}

/* "error: words", one line. */
static void add_error(struct buf *out, enum err err, const struct fault *fault, bool coloured)
{
    buf_add_text(out, coloured ? "\033[31merror:\033[m " : "error: ");
    buf_add_text(out, fault->text[0] ? fault->text : err_name(err));
    buf_add_char(out, '\n');
}

static void end_line(struct buf *out)
{
    if (out->length > 0 && out->data[out->length - 1] != '\n')
        buf_add_char(out, '\n');
}

/* ---- plain input ---- */

static enum err print(struct buf *text, struct fault *fault)
{
    const enum err err = term_write_to(STDOUT_FILENO, buf_text(text), text->length, fault);
    buf_release(text);
    return err;
}

static enum err run_line(const struct repl_host *host, const char *line, struct fault *fault)
{
    OWNED(buf_release) struct buf output = {0}, words = {0};
    struct fault of_command = {0};
    enum err err = host->execute(host->context, line, &output, &of_command);
    end_line(&output);
    if (output.failed && !err)
        err = fault_memory(&of_command, "the output");
    if (!err && host->screen && host->wants_screen(host->context))
        err = fault_set(&of_command, ERR_USAGE,
                        "`%s` needs a terminal with a screen, and TERM=%s has none",
                        host->screen_line, probe_environment_now().term);
    const enum err written = print(&output, fault);
    if (err) {
        add_error(&words, err, &of_command, false);
        term_write_to(STDERR_FILENO, buf_text(&words), words.length, NULL);
    }
    if (!written && err && fault)
        *fault = (struct fault){.code = err};
    return written ? written : err;
}

static enum err print_prompt(const struct repl_host *host, struct fault *fault)
{
    struct buf prompt = {0};
    if (host->news)
        host->news(host->context, &prompt);
    host->prompt(host->context, &prompt);
    return print(&prompt, fault);
}

static enum err run_plain(const struct repl_host *host, bool prompts, struct fault *fault)
{
    struct pollfd ready = {.fd = STDIN_FILENO, .events = POLLIN};
    struct buf output = {0};
    OWNED(mem_release) char *line = NULL;
    size_t capacity = 0;
    enum err first = host->begin ? host->begin(host->context, &output, fault) : OK;
    end_line(&output);
    const enum err written = print(&output, first ? NULL : fault);
    if (first || written)
        return first ? first : written;
    while (!host->finished(host->context)) {
        struct fault ignored;
        if (prompts && print_prompt(host, &ignored))
            break;
        /* At a terminal that reads whole lines, Ctrl-C empties the line: show the prompt again. */
        while (prompts && poll(&ready, 1, -1) < 0 && errno == EINTR)
            if (term_write_to(STDOUT_FILENO, "\n", 1, NULL) || print_prompt(host, NULL))
                break;
        ssize_t length = getline(&line, &capacity, stdin);
        if (length < 0) {
            if (prompts) /* the next output must begin on a new line */
                term_write_to(STDOUT_FILENO, "\n", 1, &ignored);
            break;
        }
        line[strcspn(line, "\r\n")] = '\0';
        if (is_blank(line))
            continue;
        enum err err = run_line(host, line, first ? &ignored : fault);
        first = first ? first : err;
    }
    return prompts ? OK : first;
}

/* ---- at a terminal ---- */

struct prompt {
    const struct repl_host *host;
    const char *history_path; /* or NULL */
    bool pages;
    struct terminal_facts facts;
    struct graphics_probe probe;
    struct line_editor editor;
};

/* Add the picture, if there is one, and a question whose answer confirms that it has been drawn.
 * Pictures are sent only when the one before is confirmed: otherwise they would queue up on a slow
 * line. */
static void add_picture(struct prompt *p, struct buf *out)
{
    struct image_view view;
    struct line_editor *e = &p->editor;
    if (!p->host->picture || !p->host->picture(p->host->context, &view))
        return;
    if (e->answers_due > 0 && probe_await(e->answers_due, BARRIER_MS, &e->input) == 0)
        buf_add_text(out, graphics_recovery(&p->facts));
    e->answers_due = 0;
    const struct term_size size = term_size();
    size_t before = out->length;
    probe_resize(&p->facts, &size);
    show_inline(&p->facts, &view, size.columns, size.rows, out);
    if (p->facts.answers && p->facts.graphics->kind == GRAPHICS_PIXELS && out->length > before &&
        !out->failed) {
        buf_add_text(out, p->facts.barrier);
        e->answers_due = 1;
    }
    p->facts.space++;
}

/* Show the output of a command with one write, or by pages if `may_page`; never page pictures. */
static enum err show(struct prompt *p, struct buf *text, bool may_page, struct fault *fault)
{
    OWNED(buf_release) struct buf out = {0};
    struct fault of_output;
    bool paged = false;
    enum err err = OK;
    cells_wrap(&out, text, term_size().columns);
    const size_t words = out.length;
    add_picture(p, &out);
    if (p->pages && may_page && out.length == words)
        err = page_text(&p->editor, text, &paged, fault);
    if (out.failed) {
        buf_release(text);
        buf_release(&out);
        add_error(text, fault_memory(&of_output, "the output"), &of_output,
                  p->facts.colours != COLOURS_NONE);
        cells_wrap(&out, text, term_size().columns);
    }
    return err || paged ? err : term_write_text(&out, "the output", fault);
}

/* Run a command, which was typed after `prompt`, and show its output. */
static enum err execute(struct prompt *p, const char *prompt, const char *line, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0};
    struct fault of_command = {0};
    enum err err = term_set_mode(TERM_QUIET, fault);
    if (err)
        return err;
    enum err failed = p->host->execute(p->host->context, line, &text, &of_command);
    err = term_set_mode(TERM_RAW, fault);
    if (failed == ERR_CANCELLED) /* so are lines that were pasted after it */
        buf_clear(&p->editor.held);
    end_line(&text);
    const bool may_page = !failed || text.length > 0; /* an error alone is not paged */
    if (failed) {
        const bool coloured = p->facts.colours != COLOURS_NONE;
        const struct caret caret = {prompt, line, of_command.at - 1, text.length == 0, coloured};
        if (of_command.at > 0)
            caret_add(&text, &caret, term_size().columns);
        add_error(&text, failed, &of_command, coloured);
    }
    return err ? err : show(p, &text, may_page, fault);
}

/* The prompt is shown before the session has begun; the output of the start replaces it. */
static enum err begin(struct prompt *p, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0}, out = {0};
    if (!p->host->begin)
        return OK;
    p->host->prompt(p->host->context, &out);
    enum err err = term_write(buf_text(&out), out.length, fault);
    if (!err)
        err = term_set_mode(TERM_QUIET, fault);
    if (!err)
        err = p->host->begin(p->host->context, &text, fault);
    if (!err)
        err = term_set_mode(TERM_RAW, fault);
    buf_clear(&out);
    buf_add_text(&out, "\r\033[K");
    end_line(&text);
    cells_wrap(&out, &text, term_size().columns);
    const enum err shown = term_write_text(&out, "the output", err ? NULL : fault);
    return err ? err : shown;
}

/* Print an error of the full screen, or the output after it; the prompt continues. */
static enum err run_screen(struct prompt *p, bool *ended, struct fault *fault)
{
    OWNED(buf_release) struct buf words = {0}, out = {0};
    struct fault why;
    enum err err = p->host->screen(p->host->context, &p->facts, &p->editor, ended, &why);
    if (err == ERR_IO) { /* the terminal is gone */
        if (fault)
            *fault = why;
        return err;
    }
    if (err)
        add_error(&words, err, &why, p->facts.colours != COLOURS_NONE);
    else if (!*ended && p->host->after_screen)
        p->host->after_screen(p->host->context, &words);
    cells_wrap(&out, &words, term_size().columns);
    return term_write_text(&out, "the output", fault);
}

/* Warn once if the history cannot be stored; the session continues. */
static void warn_of_history(struct prompt *p, enum err err, const struct fault *fault)
{
    struct buf words = {0};
    if (!err)
        return;
    p->history_path = NULL;
    buf_printf(&words, "history: %s; IFTTY_HISTORY= (empty) stores none\r\n", fault->text);
    term_write_text(&words, "a warning", NULL);
}

static enum err run_prompt(struct prompt *p, struct fault *fault)
{
    OWNED(buf_release) struct buf prompt = {0};
    struct fault of_history;
    bool ended = false;
    enum err err = begin(p, fault);
    while (!err && !p->host->finished(p->host->context)) {
        buf_clear(&prompt);
        p->host->prompt(p->host->context, &prompt);
        err = line_edit(&p->editor, buf_text(&prompt), &ended, fault);
        if (err || ended)
            break;
        if (p->history_path && p->editor.stored)
            warn_of_history(p,
                            line_history_append(&p->editor.history, p->history_path, &of_history),
                            &of_history);
        if (!is_blank(buf_text(&p->editor.line.text)))
            err = execute(p, buf_text(&prompt), buf_text(&p->editor.line.text), fault);
        if (!err && p->host->screen && p->host->wants_screen(p->host->context))
            err = run_screen(p, &ended, fault);
        if (ended)
            break;
    }
    return err;
}

static enum err open_terminal(int in, struct graphics_probe *probe, bool prompts,
                              struct terminal_facts *facts, struct buf *typed, struct fault *fault)
{
    enum err err = term_open(in, STDOUT_FILENO, fault);
    if (err)
        return err;
    term_set_sequences(prompts ? TERM_PROMPT_BEGINS : "", prompts ? TERM_PROMPT_ENDS : "");
    err = term_set_mode(TERM_RAW, fault);
    if (!err)
        graphics_probe(probe, 0, facts, typed);
    return err;
}

/* The prompt at a terminal, or the screen alone. */
static enum err run_interactive(const struct repl_host *host, const struct repl_options *options,
                                bool is_screen, struct fault *fault)
{
    struct prompt p = {.host = host,
                       .history_path = options->history_path,
                       .pages = options->pages,
                       .probe.wish = options->graphics,
                       .editor = {.probe = &p.probe,
                                  .facts = &p.facts,
                                  .line.history = &p.editor.history,
                                  .complete = host->complete,
                                  .knows = host->knows,
                                  .find = host->find,
                                  .news = host->news,
                                  .news_descriptor = host->news ? host->news_descriptor : -1,
                                  .pager = options->pages ? options->pager : NULL,
                                  .line_of_ctrl_o = host->screen_line,
                                  .context = host->context}};
    struct line_editor *e = &p.editor;
    struct fault of_history = {0};
    enum err loaded = OK;
    bool ended;
    if (options->history_path)
        loaded = line_history_load(&e->history, options->history_path, &of_history);
    enum err err = open_terminal(STDIN_FILENO, &p.probe, true, &p.facts, &e->input, fault);
    if (!err)
        warn_of_history(&p, loaded, &of_history);
    e->hint = p.facts.colours != COLOURS_NONE ? host->hint : NULL;
    e->unanswered = !p.facts.answers;
    const struct theme *theme = theme_for(options->theme, p.facts.is_light);
    e->grey = p.facts.colours == COLOURS_16 ? theme->hint_16 : theme->hint;
    if (!err && host->terminal)
        host->terminal(host->context, &p.facts);
    if (!err)
        err = is_screen ? host->screen(host->context, &p.facts, e, &ended, fault)
                        : run_prompt(&p, fault);
    probe_leave(&p.facts, e->answers_due + graphics_due(&p.probe));
    term_close();
    line_editor_release(e);
    return err;
}

enum err repl_run(const struct repl_host *host, const struct repl_options *options,
                  struct fault *fault)
{
    bool terminal = isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
    if (terminal && !probe_is_plain(probe_environment_now().term))
        return run_interactive(host, options, false, fault);
    return run_plain(host, terminal, fault);
}

enum err run_screen_once(const struct repl_host *host, struct graphics_wish wish,
                         struct fault *fault)
{
    const struct repl_options options = {.graphics = wish};
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO) ||
        probe_is_plain(probe_environment_now().term))
        return fault_set(fault, ERR_USAGE, "this needs a terminal with a screen");
    return run_interactive(host, &options, true, fault);
}

/* ---- one picture ---- */

bool show_picture_once(struct graphics_wish wish, const struct image_view *view)
{
    struct terminal_facts facts;
    struct graphics_probe probe = {.wish = wish};
    OWNED(buf_release) struct buf out = {0}, typed = {0};
    bool own = !isatty(STDIN_FILENO), shown = false;
    if (!isatty(STDOUT_FILENO))
        return false;
    int in = own ? open("/dev/tty", O_RDWR | O_CLOEXEC | O_NOCTTY) : STDIN_FILENO;
    if (in < 0)
        return false;
    if (tcgetpgrp(in) == getpgrp() &&
        open_terminal(in, &probe, false, &facts, &typed, NULL) == OK) {
        const struct term_size size = term_size();
        show_inline(&facts, view, size.columns, size.rows, &out);
        shown = out.length > 0 && !out.failed && term_write(out.data, out.length, NULL) == OK;
        facts.reports |= shown && facts.graphics->kind == GRAPHICS_PIXELS;
        probe_leave(&facts, 0);
    }
    term_close();
    if (own)
        close(in);
    return shown;
}
