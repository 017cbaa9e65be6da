/* SPDX-License-Identifier: MIT */
/* `iftty watch`: the steps of a journal, at the terminal or as pages. */
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "command/command.h"
#include "command/complete.h"
#include "program/begin.h"
#include "program/config.h"
#include "program/console.h"
#include "program/programs.h"
#include "program/watch_host.h"
#include "steps/step_pages.h"
#include "steps/step_words.h"
#include "tui/pilot/pilot.h"
#include "tui/prompt/repl.h"
#include "verify/process.h"

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

/* ---- as pages ---- */

/*
 * A process of its own carries the journal out and writes, confined to the folder that it is given;
 * this one, which reads nothing of the journal, gives that folder its name when all is there.
 */

struct page_work {
    const struct options *options;
    const char *folder;
};

/* Hands back an error's code, and its words or the verdict; after a code of 0 or ERR_CHECK the
 * pages are there. */
static void make_pages(void *context, size_t number, struct buf *out)
{
    const struct page_work *work = context;
    const struct options *o = work->options;
    const struct step_pages pages = {.folder = work->folder,
                                     .title = file_name(o->word[0]),
                                     .first = o->from,
                                     .last = o->until,
                                     .watch = console_watch()};
    struct interpreter interp;
    struct walkthrough walk = {0};
    struct fault fault = {0};
    enum err verdict = OK;
    (void)number;
    enum err err = begin_confined(o, o->word[0], work->folder, NULL, &fault);
    if (!err) {
        err = begin_interpreter(&interp, o, &fault);
        if (!err)
            err = walkthrough_begin(&walk, &interp, o->word[0], &fault);
        if (!err)
            err = step_pages_write(&walk, &pages, &verdict, &fault);
        buf_add_char(out, (char)(err ? err : verdict));
        buf_add_char(out, err ? '-' : '+');
        if (err || verdict)
            buf_add_text(out, fault.text);
        else
            step_words_verdict(out, &walk);
        walkthrough_release(&walk);
        interpreter_release(&interp);
    } else {
        buf_printf(out, "%c-%s", (char)err, fault.text);
    }
    console_erase_progress();
}

/* OK where nothing has that name, or an empty folder, which stays until the pages are there. */
static enum err may_publish(const char *to, struct fault *fault)
{
    struct stat status;
    unsigned entries = 0;
    if (lstat(to, &status) != 0)
        return OK;
    DIR *listing = S_ISDIR(status.st_mode) ? opendir(to) : NULL;
    while (listing && readdir(listing))
        entries++; /* . and .. are two */
    if (listing)
        closedir(listing);
    return listing && entries <= 2
               ? OK
               : fault_set(fault, ERR_IO, "--pages: expected a new folder, or an empty one, not %s",
                           to);
}

static enum err publish(const char *folder, const char *to, struct fault *fault)
{
    const mode_t mask = umask(0);
    umask(mask);
    if (chmod(folder, 0777 & ~mask) != 0 || rename(folder, to) != 0)
        return fault_errno(fault, "cannot make", to);
    return OK;
}

static enum err watch_as_pages(const struct options *o, struct fault *fault)
{
    enum { WORDS_MOST = 4096 };
    struct buf parent = {0}, folder = {0}, words = {0};
    char to[PATH_MAX];
    size_t length = strlen(o->pages);
    while (length > 1 && o->pages[length - 1] == '/')
        length--;
    snprintf(to, sizeof to, "%.*s", (int)length, o->pages);
    enum err err = may_publish(to, fault);
    file_folder(&parent, to);
    if (!err)
        err = folder_passing(&folder, buf_text(&parent), fault);
    struct page_work work = {o, buf_text(&folder)};
    const struct processes how = {
        .work = make_pages, .context = &work, .most = WORDS_MOST, .watch = console_watch()};
    if (!err)
        err = process_run(&words, &how, fault);
    if (!err && words.length < 2)
        err = fault_set(fault, ERR_INPUT, "its process ended early");
    const bool is_there = !err && words.data[1] == '+';
    if (is_there)
        err = publish(buf_text(&folder), to, fault);
    if (folder.length && (err || !is_there))
        folder_remove(buf_text(&folder));
    if (!err && words.data[0]) {
        err = fault_set(fault, (enum err)words.data[0], "%s", buf_text(&words) + 2);
    } else if (!err) {
        buf_add_char(&words, '\n');
        console_print(NULL, buf_text(&words) + 2);
    }
    buf_release(&parent);
    buf_release(&folder);
    buf_release(&words);
    return err;
}

/* ---- the program ---- */

enum err run_watch(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    struct config config;
    const bool is_terminal = isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
    if (o->pages && o->quiz)
        return fault_set(fault, ERR_USAGE, "--quiz asks at a terminal, and --pages makes files");
    if (o->pages && o->until && o->from > o->until)
        return fault_set(fault, ERR_USAGE, "--from %zu --until %zu: nothing lies between", o->from,
                         o->until);
    if (!o->pages && (o->from || o->until))
        return fault_set(fault, ERR_USAGE, "--from and --until are for --pages; 20G goes there");
    if (o->pages) {
        console_handle_interrupts();
        return watch_as_pages(o, fault);
    }
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
