/* SPDX-License-Identifier: MIT */
/* `iftty serve`: a session that another program drives by lines of JSON (README.md). */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "command/command.h"
#include "command/execute.h"
#include "journal/journal.h"
#include "program/programs.h"
#include "program/serve.h"
#include "session/session.h"

/* A command reports progress after this time, and again at this interval; requests are read as
 * often as LOOK_EVERY_MS meanwhile. */
enum { PROGRESS_AFTER_MS = 500, PROGRESS_EVERY_MS = 250, LOOK_EVERY_MS = 10 };

struct server {
    struct interpreter interp;
    struct reply reply;
    struct inbox inbox;
    struct exchange exchange;
    struct watch watch;
    struct buf line; /* the line to write */
    bool has_greeted;
    bool is_gone;         /* the reader of the answers is gone */
    enum err broken;      /* error of the input, */
    struct fault reading; /* and its message */
    uint64_t begun_ns, told_ns, looked_ns;
};

/* ---- signals ---- */

static volatile sig_atomic_t terminated;
static int wake[2] = {-1, -1}; /* a pipe that ends a wait */

static void terminate(int number)
{
    const int former = errno;
    (void)number;
    terminated = 1;
    if (write(wake[1], "", 1) < 0)
        errno = former; /* the pipe is full, and ends the wait anyway */
    errno = former;
}

/* SIGTERM ends the session as the end of input does, after the current command is rolled back.
 * SIGINT, which all programs of a terminal get, only cancels the command. */
static enum err handle_signals(struct fault *fault)
{
    const struct sigaction action = {.sa_handler = terminate};
    if (pipe2(wake, O_CLOEXEC | O_NONBLOCK) != 0)
        return fault_errno(fault, "make", "a pipe");
    console_handle_interrupts();
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    return OK;
}

/* ---- output ---- */

/* Write the line and clear it. Do not wait for a client that has ended the session. */
static void put_line(struct server *s)
{
    const char *at = buf_text(&s->line);
    size_t left = s->line.failed ? 0 : s->line.length;
    while (left > 0 && !s->is_gone) {
        const ssize_t n = write(STDOUT_FILENO, at, left);
        if (n < 0 && (errno != EINTR || terminated))
            s->is_gone = true;
        at += n > 0 ? n : 0;
        left -= n > 0 ? (size_t)n : 0;
    }
    s->is_gone |= s->line.failed; /* the client would wait for the missing answer */
    buf_clear(&s->line);
}

static const char *id_at_hand(const struct server *s)
{
    const struct buf *id = &s->inbox.at_hand.id;
    return id->length ? buf_text(id) : "null";
}

static void put_notice(struct server *s, const char *line)
{
    answer_notice(&s->line, id_at_hand(s), line);
    put_line(s);
}

/* ---- while a command is carried out ---- */

static void read_requests(struct server *s)
{
    if (!s->broken)
        s->broken = inbox_read(&s->inbox, STDIN_FILENO, &s->reading);
}

static bool poll_watch(void *context, const char *what, uint64_t done, uint64_t total)
{
    const uint64_t ms = 1000000, now = clock_ns();
    struct server *s = context;
    const struct watch *console = console_watch();
    if (s->has_greeted && now - s->looked_ns >= LOOK_EVERY_MS * ms) {
        s->looked_ns = now;
        read_requests(s);
    }
    const bool stops = console->poll(console->context, NULL, 0, 0) || s->inbox.stops || terminated;
    if (what && s->has_greeted && now - s->begun_ns >= PROGRESS_AFTER_MS * ms &&
        now - s->told_ns >= PROGRESS_EVERY_MS * ms) {
        struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};
        s->told_ns = now;
        /* A line of less than PIPE_BUF bytes does not block in a pipe that has room. */
        if (poll(&out, 1, 0) == 1 && out.revents & POLLOUT) {
            answer_progress(&s->line, id_at_hand(s), what, done, total, stops);
            put_line(s);
        }
    }
    return stops;
}

static void announce(void *context, const char *line)
{
    struct server *s = context;
    if (s->has_greeted)
        put_notice(s, line);
}

/* ---- requests ---- */

static void answer_do(struct server *s, const struct request *request)
{
    const char *id = buf_text(&request->id), *line = buf_text(&request->words);
    OWNED(buf_release) struct buf picture = {0};
    struct fault fault = {0};
    enum err err = exchange_allows(&s->exchange, &s->interp, line, &fault);
    reply_clear(&s->reply);
    if (!err)
        err = interpreter_execute(&s->interp, line, &s->reply, &fault);
    if (err) {
        answer_fault(&s->line, id, &fault, line, buf_text(&s->reply.list));
    } else {
        const struct image_view view =
            s->interp.shows_picture ? shown_picture(&s->interp, true) : (struct image_view){0};
        if (view.rgba && /* an unwritten picture does not fail the command */
            picture_write(&picture, &s->exchange, view.width, view.height, view.rgba, &fault)) {
            buf_clear(&picture);
            put_notice(s, fault.text);
        }
        answer_command(&s->line, id, &s->interp, &s->reply,
                       picture.length ? buf_text(&picture) : NULL);
    }
}

static void carry_out(struct server *s, const struct request *request)
{
    const char *id = buf_text(&request->id);
    struct array_file array = {0};
    struct fault fault = request->fault;
    console_forget_interrupt();
    s->begun_ns = clock_ns();
    if (!fault.code && request->is_cancelled)
        fault_set(&fault, ERR_CANCELLED, "cancelled; nothing has changed");
    if (fault.code) {
        answer_fault(&s->line, id, &fault, NULL, NULL);
    } else if (request->kind == REQUEST_COMMAND) {
        answer_do(s, request);
    } else {
        if (array_write(&array, &s->exchange, &s->interp, buf_text(&request->words),
                        request->finished, &fault))
            answer_fault(&s->line, id, &fault, NULL, NULL);
        else
            answer_array(&s->line, id, &s->interp, &array);
        buf_release(&array.path);
    }
    put_line(s);
}

static void serve_requests(struct server *s)
{
    while (!terminated && !s->is_gone && s->interp.wish != WISH_QUIT) {
        struct pollfd on[] = {{.fd = STDIN_FILENO, .events = POLLIN},
                              {.fd = wake[0], .events = POLLIN},
                              {.fd = STDOUT_FILENO, .events = 0}};
        const struct request *request = inbox_next(&s->inbox);
        if (request) {
            carry_out(s, request);
            continue;
        }
        if (s->inbox.is_over || s->broken)
            break;
        /* Wait for a request, for the reader of the answers to go, or for a signal. */
        if (poll(on, sizeof on / sizeof *on, -1) < 0)
            continue;
        s->is_gone |= (on[2].revents & POLLERR) != 0;
        if (on[0].revents)
            read_requests(s);
    }
}

/* ---- beginning and end ---- */

/* As the prompt: edits run at once, unless a resumed journal says how. An existing journal of
 * --journal is resumed here, under the watch. */
static enum err begin_session(struct server *s, const struct options *o, struct buf *name,
                              struct buf *told, struct fault *fault)
{
    const char *first;
    bool resumes;
    TRY(begin_check(o, &first, &resumes, fault));
    const bool goes_on = o->journal && file_exists(o->journal);
    const char *journal = resumes ? first : goes_on ? o->journal : NULL;
    OWNED(buf_release) struct buf line = {0};
    struct options plain = *o;
    plain.journal = goes_on ? NULL : o->journal;
    begin_journal_name(name, first);
    enum err err = begin_by_options(&s->interp, &plain, fault);
    begin_to_wait(&s->interp);
    session_set_watch(s->interp.session, &s->watch);
    if (!o->journal && !resumes)
        s->interp.new_journal = buf_text(name);
    if (!err)
        err = exchange_begin(&s->exchange, fault);
    if (!err && journal)
        err = interpreter_resume_journal(&s->interp, journal, told, fault);
    s->interp.has_channels = o->words > 1;
    for (int i = 0; !err && i < o->words && !resumes; i++) {
        begin_opening(&line, o->word[i], i > 0);
        err = interpreter_execute(&s->interp, buf_text(&line), &s->reply, fault);
        buf_add_text(told, buf_text(err ? &s->reply.list : &s->reply.text));
    }
    if (!err && !resumes)
        err = interpreter_execute(&s->interp, "auto on", &s->reply, fault);
    return err;
}

enum err run_serve(const struct options *o, struct fault *fault)
{
    static struct server s; /* too large for the stack */
    OWNED(buf_release) struct buf name = {0}, told = {0};
    s.watch = (struct watch){.context = &s, .poll = poll_watch, .announce = announce};
    enum err err = handle_signals(fault);
    const bool has_begun = !err;
    if (!err)
        err = begin_session(&s, o, &name, &told, fault);
    answer_greeting(&s.line, &s.interp, buf_text(&s.exchange.path), buf_text(&told),
                    err ? fault : NULL);
    put_line(&s);
    s.has_greeted = true;
    if (!err && isatty(STDIN_FILENO))
        console_warn(NULL, "lines of JSON are expected, as {\"id\": 1, \"do\": \"info\"}; Ctrl-D "
                           "ends the session\n");
    if (!err)
        serve_requests(&s);
    exchange_end(&s.exchange);
    if (!err && s.broken) {
        err = s.broken;
        *fault = s.reading;
    } else if (!err && s.is_gone && !terminated) {
        err = fault_set(fault, ERR_IO, "cannot write to standard output");
    }
    if (has_begun && s.interp.session)
        err = end_journal(&s.interp, err, fault);
    inbox_release(&s.inbox);
    reply_release(&s.reply);
    interpreter_release(&s.interp);
    buf_release(&s.line);
    return err;
}
