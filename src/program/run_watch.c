/* `iftty watch`: the steps of a journal, at the terminal or as pages. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "command/command.h"
#include "command/complete.h"
#include "program/begin.h"
#include "program/config.h"
#include "program/console.h"
#include "program/programs.h"
#include "program/watch_host.h"
#include "steps/step_words.h"
#include "tui/pilot/pilot.h"
#include "tui/prompt/repl.h"

/* ---- at a terminal ---- */

struct watch_screen {
    struct watching watching; /* first: what the pilot's host has as its context */
    struct pilot_host host;
    struct pilot_state state;
};

static enum err screen(void *context, struct terminal_facts *facts, struct line_editor *editor,
                       bool *ended, struct fault *fault)
{
    struct watch_screen *s = context;
    return pilot_run(&s->host, &s->state, facts, editor, ended, fault);
}

static void complete(void *context, const char *line, size_t cursor, struct buf *candidates,
                     size_t *word_start)
{
    const struct watch_screen *s = context;
    command_complete(candidates, word_start, line, cursor, s->watching.pilot.interp);
}

/* What it has come to, once the screen is the shell's again. */
static void print_end(const struct watching *w)
{
    struct buf text = {0};
    step_words_verdict(&text, &w->walk);
    buf_add_char(&text, '\n');
    if (w->asks) {
        own_turns_words(&text, &w->turns);
        buf_add_char(&text, '\n');
    }
    console_print(NULL, buf_text(&text));
    buf_release(&text);
}

static enum err watch_at_terminal(const struct options *o, struct interpreter *interp,
                                  const struct config *config, struct fault *fault)
{
    static struct watch_screen s; /* large */
    const struct repl_host host = {.context = &s, .screen = screen, .complete = complete};
    struct watching *w = &s.watching;
    w->pilot.interp = interp;
    w->pilot.smooth = o->smooth;
    w->asks = o->quiz;
    watch_host_fill(&s.host, w);
    pilot_state_init(&s.state, &config->setup);
    s.state.watches = true;
    enum err err = walkthrough_begin(&w->walk, interp, o->word[0], fault);
    if (!err)
        err = walkthrough_show(&w->walk, 0, STEP_BEFORE, fault);
    console_erase_progress();
    if (!err)
        err = give_screen_once(&host, o->graphics, fault);
    if (!err) {
        print_end(w);
        if (w->walk.has_ended && w->walk.ended)
            err = fault_set(fault, w->walk.ended, "%s", w->walk.why.text);
    }
    watching_release(w);
    pilot_state_release(&s.state);
    return err;
}

/* ---- the program ---- */

enum err run_watch(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    struct config config;
    const bool is_terminal = isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
    if (!is_terminal)
        return fault_set(fault, ERR_USAGE,
                         "watching takes a terminal; `iftty watch JOURNAL --pages DIR` makes "
                         "pictures and a page of HTML");
    config_init(&config);
    config_read(&config); /* before the walls are there */
    if (!config.setup.theme->has_colours)
        setenv("NO_COLOR", "1", 1);
    console_handle_interrupts();
    enum err err = begin_confined(o, o->word[0], NULL, NULL, fault);
    if (!err) {
        err = begin_interpreter(&interp, o, fault);
        if (!err)
            err = watch_at_terminal(o, &interp, &config, fault);
        interpreter_release(&interp);
    }
    config_release(&config);
    return err;
}
