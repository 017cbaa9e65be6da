/* SPDX-License-Identifier: MIT */
/*
 * `iftty watch`: the steps of a journal in the pilot, by lines that its keys stand for:
 *
 *     step on N    step back N    step to N    step to last    step comments
 *
 * A step that is gone on to is drawn first, and carried out by the next `step on`. Any other line
 * is carried out where it only looks or asks (interpreter_look).
 */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/scan.h"
#include "command/command.h"
#include "command/complete.h"
#include "command/execute.h"
#include "program/programs.h"
#include "program/console.h"
#include "tui/pilot/pilot.h"
#include "tui/prompt/repl.h"

struct watching {
    struct pilot_interpreter pilot; /* first, as programs.h wants it */
    struct watched watched;
    struct reply reply;
    size_t last;  /* the last step that is shown */
    bool is_over; /* the verdict is shown, below that step */
    struct pilot_host host;
    struct pilot_state state;
};

/* ---- from step to step ---- */

static enum err show_end(struct watching *w, struct fault *fault)
{
    const struct watched *shown = &w->watched;
    const bool is_there = shown->at == w->last && !shown->is_drawn;
    const enum err err = is_there ? OK : watched_carry_out(&w->watched, w->last, fault);
    w->is_over = !err;
    return err;
}

static enum err step_to(struct watching *w, size_t step, struct fault *fault)
{
    return step > w->last ? show_end(w, fault) : watched_draw(&w->watched, step, fault);
}

/* Carries out a step that is drawn, as the first of them. */
static enum err step_on(struct watching *w, size_t by, struct fault *fault)
{
    const struct watched *shown = &w->watched;
    if (shown->is_drawn && --by == 0)
        return watched_carry_out(&w->watched, shown->at, fault);
    return step_to(w, w->is_over ? w->last + 1 : shown->at + by, fault);
}

static enum err step_back(struct watching *w, size_t by, struct fault *fault)
{
    const size_t from = w->is_over ? w->last + 1 : w->watched.at;
    return watched_carry_out(&w->watched, from > by ? from - by : 0, fault);
}

static enum err step_line(struct watching *w, const char *at, struct buf *output,
                          struct fault *fault)
{
    int64_t n = 0;
    const char *words = at;
    if (strcmp(at, "comments") == 0) {
        watched_comments(output, &w->watched);
        buf_add_text(output, output->length ? "" : "this step has no comment\n");
        return OK;
    }
    if (strcmp(at, "to last") == 0)
        return show_end(w, fault);
    const bool is_on = scan_text(&at, "on "), is_back = scan_text(&at, "back "),
               is_to = scan_text(&at, "to ");
    if (!(is_on || is_back || is_to) || !scan_integer(&at, is_to ? 0 : 1, 1000000, &n) || *at)
        return fault_set(fault, ERR_USAGE, "expected step on N, back N, to N or comments, not %s",
                         words);
    if (is_to && (size_t)n > w->last)
        return fault_set(fault, ERR_USAGE, "expected a step 0..%zu", w->last);
    const bool was_over = w->is_over;
    const enum err err = is_to   ? step_to(w, (size_t)n, fault)
                         : is_on ? step_on(w, (size_t)n, fault)
                                 : step_back(w, (size_t)n, fault);
    if (!err && was_over && !is_on)
        w->is_over = false;
    return err;
}

/* ---- the pilot's host ---- */

static enum err execute(void *context, const char *line, struct buf *output, struct fault *fault)
{
    struct watching *w = context;
    const char *at = line;
    enum err err;
    console_forget_interrupt();
    if (scan_text(&at, "step ")) {
        err = step_line(w, at, output, fault);
    } else {
        err = interpreter_look(w->pilot.interp, line, &w->reply, fault);
        buf_add_text(output, buf_text(err ? &w->reply.list : &w->reply.text));
    }
    console_erase_progress();
    w->pilot.former = w->is_over ? NULL : watched_former(&w->watched);
    return err;
}

static enum err sketch(void *context, const char *line, struct fault *fault)
{
    (void)context, (void)line;
    return fault_set(fault, ERR_USAGE, "nothing is drawn here");
}

static enum err drop(void *context, struct fault *fault)
{
    (void)context, (void)fault;
    return OK;
}

static bool finished(void *context)
{
    const struct watching *w = context;
    return w->pilot.interp->wish == WISH_QUIT;
}

static void caption(void *context, struct buf *lines)
{
    const struct watching *w = context;
    const struct watched *shown = &w->watched;
    struct buf comments = {0};
    if (w->is_over) {
        buf_printf(lines, "the end: %zu step%s, %zu record%s", shown->count, plural(shown->count),
                   shown->report.executed, plural(shown->report.executed));
        if (w->last < shown->count)
            buf_printf(lines, "; steps after %zu are left out", w->last);
        buf_add_char(lines, '\n');
        watched_verdict(lines, shown);
        buf_add_char(lines, '\n');
        return;
    }
    watched_title(lines, shown);
    buf_add_char(lines, '\n');
    watched_describe(lines, shown);
    buf_add_char(lines, '\n');
    watched_comments(&comments, shown);
    for (size_t i = 0; i + 1 < comments.length; i++)
        buf_add_char(lines, comments.data[i] == '\n' ? ' ' : comments.data[i]);
    buf_release(&comments);
}

/* ---- the program ---- */

static enum err screen(void *context, struct terminal_facts *facts, struct line_editor *editor,
                       bool *ended, struct fault *fault)
{
    struct watching *w = context;
    return pilot_run(&w->host, &w->state, facts, editor, ended, fault);
}

static void complete(void *context, const char *line, size_t cursor, struct buf *candidates,
                     size_t *word_start)
{
    const struct watching *w = context;
    command_complete(candidates, word_start, line, cursor, w->pilot.interp);
}

static enum err watch_at_terminal(const struct options *o, struct interpreter *interp,
                                  const struct config *config, struct fault *fault)
{
    static struct watching w; /* large */
    const struct repl_host host = {.context = &w, .screen = screen, .complete = complete};
    struct buf words = {0};
    w.pilot.interp = interp;
    w.pilot.smooth = o->smooth;
    w.pilot.watches = true;
    w.host = (struct pilot_host){.context = &w,
                                 .execute = execute,
                                 .sketch = sketch,
                                 .drop = drop,
                                 .finished = finished,
                                 .caption = caption};
    pilot_host_fill(&w.host);
    pilot_state_init(&w.state, &config->setup);
    w.state.watches = true;
    enum err err = watched_begin(&w.watched, interp, o->word[0], fault);
    const size_t count = w.watched.count;
    w.last = o->until && o->until < count ? o->until : count;
    if (!err && o->from > w.last)
        err = fault_set(fault, ERR_USAGE, "--from %zu: expected a step 1..%zu", o->from, w.last);
    if (!err)
        err = watched_draw(&w.watched, o->from, fault);
    console_erase_progress();
    if (!err)
        err = give_screen_once(&host, o->graphics, fault);
    if (!err) {
        watched_verdict(&words, &w.watched);
        buf_add_char(&words, '\n');
        console_print(NULL, buf_text(&words));
        if (w.watched.ended)
            err = fault_set(fault, w.watched.ended, "%s", w.watched.why.text);
    }
    buf_release(&words);
    watched_release(&w.watched);
    reply_release(&w.reply);
    pilot_interpreter_release(&w.pilot);
    pilot_state_release(&w.state);
    return err;
}

enum err run_watch(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    struct config config;
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO))
        return fault_set(fault, ERR_USAGE,
                         "watching takes a terminal; `iftty replay JOURNAL` takes none, and "
                         "`iftty log JOURNAL` lists the records");
    if (o->until && o->from > o->until)
        return fault_set(fault, ERR_USAGE, "--from %zu --until %zu: expected no later step first",
                         o->from, o->until);
    config_init(&config);
    config_read(&config); /* before the walls are there */
    if (!config.setup.theme->has_colours)
        setenv("NO_COLOR", "1", 1);
    console_handle_interrupts();
    enum err err = begin_confined(o, o->word[0], NULL, fault);
    if (!err) {
        err = begin_by_options(&interp, o, fault);
        if (!err)
            err = watch_at_terminal(o, &interp, &config, fault);
        interpreter_release(&interp);
    }
    config_release(&config);
    return err;
}
