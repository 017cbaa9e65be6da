/* SPDX-License-Identifier: MIT */
#include "program/program.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <unistd.h>

#include "base/clock.h"
#include "command/trust.h"
#include "tui/cells.h"
#include "tui/progress.h"

static volatile sig_atomic_t interrupted, idle;
static struct progress progress;
static const char *name = "iftty";

void console_init(const char *program)
{
    name = program;
    signal(SIGPIPE, SIG_IGN); /* writing to a closed pipe returns an error instead */
    progress = (struct progress){.fd = STDERR_FILENO,
                                 .shows = isatty(STDERR_FILENO) == 1,
                                 .has_blocks = locale_is_utf8(),
                                 .columns = 80};
}

/* ---- Ctrl-C ---- */

static void interrupt(int number)
{
    interrupted = 1;
    if (idle) {
        signal(number, SIG_DFL);
        raise(number); /* once the handler has returned */
    }
}

void console_handle_interrupts(void)
{
    if (signal(SIGINT, interrupt) == SIG_IGN)
        signal(SIGINT, SIG_IGN);
}

void console_forget_interrupt(void)
{
    interrupted = 0;
}

void console_wait(void *context, bool waits)
{
    (void)context;
    idle = waits;
}

/* ---- progress ---- */

static const struct console_onlooker *onlooker;
static struct watch watch;

static bool poll_watch(void *context, const char *what, uint64_t done, uint64_t total)
{
    static bool taking_back;
    const bool stop = interrupted || (onlooker && onlooker->stops(onlooker->context));
    char words[40];
    (void)context;
    if (stop && !taking_back)
        progress.drawn_ns = 0;
    taking_back = stop;
    if (stop)
        snprintf(words, sizeof words, "taking it back%s%s", what ? ": " : "", what ? what : "");
    if (stop || what)
        progress_show(&progress, stop ? words : what, done, total, clock_ns());
    watch.wants_show = watch.wants_show || (onlooker && onlooker->wants(onlooker->context));
    return stop || limits_stop();
}

static void announce(void *context, const char *line)
{
    (void)context;
    progress_erase(&progress);
    fprintf(stderr, "%s%s: %s\n", progress.shows ? "\r" : "", name, line);
}

static void show_onlooker(void *context)
{
    (void)context;
    if (onlooker)
        onlooker->show(onlooker->context);
}

static struct watch watch = {.poll = poll_watch, .announce = announce, .show = show_onlooker};

struct watch *console_watch(void)
{
    return &watch;
}

void console_look_on(const struct console_onlooker *looks)
{
    onlooker = looks;
    progress.owns_row |= looks != NULL; /* also for the pictures after a command */
}

void console_erase_progress(void)
{
    progress_erase(&progress);
}

/* ---- printing ---- */

void console_print(void *context, const char *text)
{
    (void)context;
    progress_erase(&progress);
    fputs(text, stdout);
    fflush(stdout);
}

void console_warn(void *context, const char *text)
{
    (void)context;
    progress_erase(&progress);
    fputs(text, stderr);
}

const struct printer console_printer = {.print = console_print, .warn = console_warn};

int console_finish(enum err err, const struct fault *fault)
{
    progress_erase(&progress);
    const bool is_written = fflush(stdout) == 0 && !ferror(stdout);
    struct pollfd out = {.fd = STDOUT_FILENO};
    if (!is_written && poll(&out, 1, 0) == 1 && (out.revents & POLLERR)) {
        signal(SIGPIPE, SIG_DFL); /* end as other programs do without a reader */
        raise(SIGPIPE);
    }
    if (err && fault->text[0])
        fprintf(stderr, "%s: %s\n", name, fault->text);
    if (!is_written && !err) {
        fprintf(stderr, "%s: cannot write to standard output\n", name);
        return err_exit_status(ERR_IO);
    }
    return err_exit_status(err);
}
