/* SPDX-License-Identifier: MIT */
#include "tui/term.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

/* The child's descriptors. */
enum { IN, OUT, PIPE, PARENT, DESCRIPTORS };

struct watch {
    const struct guarded *guarded;
    pid_t job, shell; /* process groups */
};

/* ---- in the child: system calls alone, since other threads may have held any lock ---- */

/* If the foreground job is unknown, the modes decide. */
static void restore_terminal(const struct watch *w)
{
    const struct guarded *g = w->guarded;
    const pid_t foreground = tcgetpgrp(IN);
    const tcflag_t passing = FLUSHO | PENDIN;
    struct termios now;
    const bool ours = tcgetattr(IN, &now) == 0 && now.c_iflag == g->ours.c_iflag &&
                      now.c_oflag == g->ours.c_oflag &&
                      (now.c_lflag & ~passing) == (g->ours.c_lflag & ~passing);
    if (foreground < 0 ? !ours : foreground != w->job && foreground != w->shell)
        return;
    if (ours) {
        tcsetattr(IN, TCSANOW, &g->found);
        tcflush(IN, TCIFLUSH); /* late answers and mouse reports */
    }
    ssize_t ignored = write(OUT, g->words[g->which].text, g->words[g->which].length);
    (void)ignored; /* nothing can be done about it */
}

static _Noreturn void guard(const struct watch *w, int from[DESCRIPTORS])
{
    struct pollfd ready[2] = {{.fd = PIPE, .events = POLLIN},
                              {.fd = from[PARENT] >= 0 ? PARENT : -1, .events = POLLIN}};
    prctl(PR_SET_NAME, "iftty-guardian");
    setpgid(0, 0);
    const struct sigaction usual = {.sa_handler = SIG_DFL}, ignored = {.sa_handler = SIG_IGN};
    sigset_t none;
    for (int number = 1; number < NSIG; number++) {
        const bool crash = number == SIGSEGV || number == SIGBUS || number == SIGILL ||
                           number == SIGFPE || number == SIGABRT;
        sigaction(number, crash ? &usual : &ignored, NULL);
    }
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    /* Move the descriptors that stay to their numbers, by way of numbers that are unused. */
    for (int i = 0; i < DESCRIPTORS; i++)
        from[i] = from[i] < 0 ? -1 : fcntl(from[i], F_DUPFD, DESCRIPTORS);
    for (int i = 0; i < DESCRIPTORS; i++) {
        close(i);
        if (from[i] >= 0)
            dup2(from[i], i);
    }
    closefrom(DESCRIPTORS);
    int unused = chdir("/");
    (void)unused;
    while (poll(ready, 2, -1) <= 0)
        ;
    if (w->guarded->on)
        restore_terminal(w);
    _exit(0);
}

/* ---- in the parent ---- */

/* Start the child for the terminal that `in` reads and `out` writes. If no child can be started
 * there is no guardian, and everything else works. */
static void guardian_start(struct guardian *g, int in, int out)
{
    static struct guarded unshared;
    int ends[2];
    sigset_t all, before;
    if (!g->guarded) {
        void *place = mmap(NULL, sizeof(struct guarded), PROT_READ | PROT_WRITE,
                           MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        g->guarded = place == MAP_FAILED ? &unshared : place;
    }
    *g = (struct guardian){.guarded = g->guarded, .pipe = -1};
    if (pipe2(ends, O_CLOEXEC) != 0)
        return;
    const struct watch watch = {g->guarded, getpgrp(), getpgid(getppid())};
    int parent = (int)syscall(SYS_pidfd_open, getpid(), 0);
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, &before); /* no handler of ours runs in the child */
    const pid_t process = fork();
    if (process == 0) {
        close(ends[1]);
        guard(&watch, (int[]){in, out, ends[0], parent});
    }
    sigprocmask(SIG_SETMASK, &before, NULL);
    close(ends[0]);
    if (parent >= 0)
        close(parent);
    if (process < 0)
        close(ends[1]);
    else
        *g = (struct guardian){g->guarded, process, ends[1]};
}

/* Call only when `on` is 0. */
static void guardian_end(struct guardian *g)
{
    if (g->process <= 0)
        return;
    kill(g->process, SIGKILL); /* it has nothing to do, and would end later by itself */
    while (waitpid(g->process, NULL, 0) < 0 && errno == EINTR)
        ;
    close(g->pipe);
    g->process = 0;
}

/* A short text for a signal handler: written before its length is set. */
struct text {
    char bytes[TERM_WORDS];
    volatile sig_atomic_t length;
};

static struct {
    int in, out;
    volatile sig_atomic_t open;
    volatile sig_atomic_t mode; /* enum term_mode */
    bool end_written;
    pid_t owner; /* the process that opened the terminal: its children leave it alone */
    struct termios found;
    struct text begin, end, recover, question;
    volatile sig_atomic_t resized, continued;
    struct guardian guardian;
} term;

enum { SIGNALS = 12 };
static const int taken_signal[SIGNALS] = {SIGTERM, SIGHUP, SIGINT, SIGQUIT, SIGSEGV, SIGABRT,
                                          SIGBUS,  SIGILL, SIGFPE, SIGTSTP, SIGCONT, SIGWINCH};
enum { FIRST_CRASH = 4, FIRST_STOP = 9 };
static struct sigaction former[SIGNALS];
static bool is_taken[SIGNALS];

/* ---- modes ---- */

static struct termios modes_of(enum term_mode mode)
{
    struct termios t = term.found;
    if (mode == TERM_AS_FOUND)
        return t;
    t.c_iflag &= ~(tcflag_t)(BRKINT | ICRNL | INLCR | IGNCR | INPCK | ISTRIP | IXON);
    t.c_cflag |= CS8;
    t.c_lflag &= ~(tcflag_t)(ECHO | ICANON | IEXTEN | ISIG);
    t.c_lflag |= NOFLSH; /* otherwise Ctrl-C discards the rest of a picture being sent */
    if (mode == TERM_QUIET) {
        t.c_lflag |= ISIG;
        t.c_oflag |= OPOST | ONLCR; /* commands that print by themselves end lines with LF alone */
    } else {
        t.c_oflag &= ~(tcflag_t)OPOST;
    }
    t.c_cc[VMIN] = 1;
    t.c_cc[VTIME] = 0;
    return t;
}

static void set_text(struct text *text, const char *words)
{
    size_t length = strlen(words);
    if (length >= sizeof text->bytes)
        length = 0;
    text->length = 0;
    memcpy(text->bytes, words, length);
    text->length = (sig_atomic_t)length;
}

static size_t put_text(char *place, const struct text *text)
{
    memcpy(place, text->bytes, (size_t)text->length);
    return (size_t)text->length;
}

enum { ENDING = 4 * TERM_WORDS + 32 };
_Static_assert((int)ENDING <= (int)GUARDIAN_WORDS, "the guardian may have to write all of it");

/* `for_good` also shows the cursor and begins a new line, for the program that follows; `ask` adds
 * a question before the sequences that restore. */
static size_t put_ending(char words[ENDING], bool for_good, bool ask)
{
    static const struct text usual = {.bytes = "\033\\", .length = 2};
    size_t length = put_text(words, term.recover.length > 0 ? &term.recover : &usual);
    if (ask)
        length += put_text(words + length, &term.question);
    length += put_text(words + length, &term.end);
    if (for_good) {
        memcpy(words + length, "\033[m\033[?25h\r\n", 11);
        length += 11;
    }
    return length;
}

static void update_guardian(void)
{
    struct guarded *g = term.guardian.guarded;
    if (!g)
        return;
    const int other = !g->which;
    g->words[other].length = put_ending(g->words[other].text, true, false);
    g->which = other;
}

static bool is_ours(void)
{
    return term.open && term.mode != TERM_AS_FOUND && getpid() == term.owner;
}

/* Read until the end of an answer and a short silence, for at most 0.2 s. Reading from the
 * background would stop the process. */
static void discard_answers(void)
{
    char bytes[256];
    bool answered = false;
    if (tcgetpgrp(term.in) != getpgrp())
        return;
    for (int i = 0; i < 10; i++) {
        struct pollfd ready = {.fd = term.in, .events = POLLIN};
        if (poll(&ready, 1, 20) <= 0) {
            if (answered)
                return;
            continue;
        }
        ssize_t n = read(term.in, bytes, sizeof bytes);
        if (n <= 0)
            return;
        answered |= memchr(bytes, 'c', (size_t)n) != NULL;
    }
}

/* For signal handlers: restore the terminal with one write. */
static void restore_modes(bool for_good, bool ask)
{
    char words[ENDING];
    if (!is_ours())
        return;
    ask &= term.question.length > 0;
    ssize_t ignored = write(term.out, words, put_ending(words, for_good, ask));
    (void)ignored; /* nothing can be done about it */
    if (ask)
        discard_answers();
    tcsetattr(term.in, TCSANOW, &term.found);
    term.guardian.guarded->on = 0;
}

void term_set_sequences(const char *begin, const char *end)
{
    set_text(&term.begin, begin);
    set_text(&term.end, end);
    update_guardian();
}

void term_set_recovery(const char *recover, const char *question)
{
    set_text(&term.recover, recover);
    set_text(&term.question, question ? question : "");
    update_guardian();
}

/* From now on the new end is written, although its beginning is written only below. */
enum err term_change_sequences(const char *begin, const char *end, struct fault *fault)
{
    const struct text earlier = term.end;
    sigset_t all, before;
    if (strlen(begin) >= TERM_WORDS || strlen(end) >= TERM_WORDS)
        return fault_set(fault, ERR_USAGE, "the sequences for the terminal have more than %d bytes",
                         TERM_WORDS - 1);
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, &before);
    term_set_sequences(begin, end);
    sigprocmask(SIG_SETMASK, &before, NULL);
    term.end_written = false;
    if (term.mode == TERM_AS_FOUND)
        return OK;
    enum err err = term_write(earlier.bytes, (size_t)earlier.length, fault);
    return err ? err : term_write(term.begin.bytes, (size_t)term.begin.length, fault);
}

enum err term_write_end(struct fault *fault)
{
    if (term.mode == TERM_AS_FOUND || term.end_written)
        return OK;
    term.end_written = true;
    return term_write(term.end.bytes, (size_t)term.end.length, fault);
}

enum err term_set_mode(enum term_mode mode, struct fault *fault)
{
    enum term_mode before = (enum term_mode)term.mode;
    struct guarded *guarded = term.guardian.guarded;
    struct termios modes = modes_of(mode);
    if (mode == before)
        return OK;
    term.mode = (sig_atomic_t)mode; /* first, so that a signal from here on restores */
    if (mode != TERM_AS_FOUND) {
        guarded->ours = modes;
        guarded->on = 1;
    }
    while (tcsetattr(term.in, TCSADRAIN, &modes) != 0) {
        if (errno == EINTR)
            continue;
        term.mode = (sig_atomic_t)before;
        guarded->on = before != TERM_AS_FOUND;
        return fault_errno(fault, "set the modes of", "the terminal");
    }
    enum err err = OK;
    if (mode == TERM_AS_FOUND && !term.end_written) {
        err = term_write(term.end.bytes, (size_t)term.end.length, fault);
    } else {
        term.end_written = false;
        if (mode != TERM_AS_FOUND && before == TERM_AS_FOUND)
            err = term_write(term.begin.bytes, (size_t)term.begin.length, fault);
    }
    guarded->on = mode != TERM_AS_FOUND;
    return err;
}

/* ---- signals ---- */

/* Restore the terminal and let the signal have its usual effect: it is blocked while this runs, so
 * the raise acts on return. */
static void on_end(int number)
{
    int kept = errno;
    size_t place = 0;
    while (taken_signal[place] != number)
        place++;
    restore_modes(true, number == SIGTERM || number == SIGINT || number == SIGQUIT);
    term.mode = TERM_AS_FOUND;
    sigaction(number, &former[place], NULL);
    raise(number);
    errno = kept;
}

static void on_stop(int number)
{
    int kept = errno;
    struct sigaction usual = {.sa_handler = SIG_DFL}, ours;
    sigset_t this_one;
    restore_modes(false, false);
    sigaction(number, &usual, &ours);
    sigemptyset(&this_one);
    sigaddset(&this_one, number);
    raise(number);
    sigprocmask(SIG_UNBLOCK, &this_one, NULL); /* the process stops here, until SIGCONT */
    sigaction(number, &ours, NULL);
    errno = kept;
}

/* In the background, tcsetattr stops the process again until it is in the foreground. */
static void on_continue(int number)
{
    int kept = errno;
    (void)number;
    if (is_ours()) {
        struct termios modes = modes_of((enum term_mode)term.mode);
        while (tcsetattr(term.in, TCSADRAIN, &modes) != 0 && errno == EINTR)
            ;
        term.guardian.guarded->on = 1;
        ssize_t ignored = write(term.out, term.begin.bytes, (size_t)term.begin.length);
        (void)ignored;
    }
    term.continued = 1;
    term.resized = 1;
    errno = kept;
}

static void on_resize(int number)
{
    (void)number;
    term.resized = 1;
}

/* ---- open, close ---- */

static void at_exit(void)
{
    if (!term.open || getpid() != term.owner)
        return;
    restore_modes(true, false);
    term.open = 0;
    guardian_end(&term.guardian);
}

enum err term_open(int in, int out, struct fault *fault)
{
    static bool registered;
    if (!isatty(in) || !isatty(out) || tcgetattr(in, &term.found) != 0)
        return fault_set(fault, ERR_IO, "this needs a terminal for both input and output");
    if (!registered && atexit(at_exit) != 0)
        return fault_memory(fault, "restoring the terminal");
    registered = true;
    term.in = in;
    term.out = out;
    term.mode = TERM_AS_FOUND;
    term.resized = term.continued = 0;
    term.end_written = false;
    term.owner = getpid();
    guardian_start(&term.guardian, in, out);
    term.guardian.guarded->on = 0;
    term.guardian.guarded->found = term.found;
    set_text(&term.begin, "");
    set_text(&term.end, "");
    set_text(&term.recover, "");
    set_text(&term.question, "");
    /* Handlers need a stack of their own in case the main stack has overflowed. */
    static char stack[65536];
    stack_t now, own = {.ss_sp = stack, .ss_size = sizeof stack};
    if (sigaltstack(NULL, &now) == 0 && (now.ss_flags & SS_DISABLE))
        sigaltstack(&own, NULL);
    for (size_t i = 0; i < SIGNALS; i++) {
        struct sigaction action = {.sa_flags = SA_ONSTACK | SA_RESTART};
        int number = taken_signal[i];
        bool crash = i >= FIRST_CRASH && i < FIRST_STOP;
        sigaction(number, NULL, &former[i]);
        is_taken[i] =
            crash || (!(former[i].sa_flags & SA_SIGINFO) && former[i].sa_handler == SIG_DFL);
        if (!is_taken[i])
            continue;
        sigemptyset(&action.sa_mask);
        if (i < FIRST_STOP)
            sigaddset(&action.sa_mask, SIGTTOU); /* so that restoring never stops the process */
        action.sa_handler = i < FIRST_STOP      ? on_end
                            : number == SIGTSTP ? on_stop
                            : number == SIGCONT ? on_continue
                                                : on_resize;
        sigaction(number, &action, NULL);
    }
    term.open = 1;
    return OK;
}

void term_close(void)
{
    if (!term.open)
        return;
    term_set_mode(TERM_AS_FOUND, NULL);
    term.open = 0;
    guardian_end(&term.guardian);
    for (size_t i = 0; i < SIGNALS; i++)
        if (is_taken[i])
            sigaction(taken_signal[i], &former[i], NULL);
}

/* ---- size, input, output ---- */

struct term_size term_size(void)
{
    struct winsize w = {0};
    struct term_size size = {.columns = 80, .rows = 24};
    if (ioctl(term.out, TIOCGWINSZ, &w) != 0 || w.ws_col == 0 || w.ws_row == 0)
        return size;
    return (struct term_size){w.ws_col, w.ws_row, w.ws_xpixel, w.ws_ypixel};
}

unsigned term_columns(int fd)
{
    struct winsize size = {0};
    return ioctl(fd, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

enum err term_write_to(int fd, const void *bytes, size_t length, struct fault *fault)
{
    const char *at = bytes;
    while (length > 0) {
        ssize_t n = write(fd, at, length);
        if (n < 0 && errno == EAGAIN) {
            struct pollfd ready = {.fd = fd, .events = POLLOUT};
            poll(&ready, 1, -1);
        } else if (n < 0 && errno != EINTR) {
            return fault_errno(fault, "write", "the output");
        } else if (n > 0) {
            at += n;
            length -= (size_t)n;
        }
    }
    return OK;
}

/* If the process stopped in the middle of a picture, the sequences that end our modes would be
 * inserted into it, and its rest would be printed as text. */
enum err term_write(const void *bytes, size_t length, struct fault *fault)
{
    sigset_t stops, before;
    sigemptyset(&stops);
    sigaddset(&stops, SIGTSTP);
    sigaddset(&stops, SIGCONT);
    sigprocmask(SIG_BLOCK, &stops, &before);
    enum err err = term_write_to(term.out, bytes, length, fault);
    sigprocmask(SIG_SETMASK, &before, NULL);
    return err;
}

enum err term_write_text(struct buf *text, const char *what, struct fault *fault)
{
    const enum err err =
        text->failed ? fault_memory(fault, what) : term_write(buf_text(text), text->length, fault);
    buf_release(text);
    return err;
}

/* Wait for input. Signals that set a flag are unblocked only during the wait, so none is lost
 * between the test of the flags and the wait. */
static int wait_for_input(int timeout_ms, int other, bool *only_other)
{
    struct pollfd ready[2] = {{.fd = term.in, .events = POLLIN}, {.fd = other, .events = POLLIN}};
    struct timespec limit = {timeout_ms / 1000, timeout_ms % 1000 * 1000000L};
    sigset_t flags, before;
    sigemptyset(&flags);
    sigaddset(&flags, SIGWINCH);
    sigaddset(&flags, SIGCONT);
    sigprocmask(SIG_BLOCK, &flags, &before);
    int n = -1;
    errno = EINTR;
    if (!term.resized && !term.continued)
        n = ppoll(ready, 2, timeout_ms < 0 ? NULL : &limit, &before);
    int kept = errno;
    sigprocmask(SIG_SETMASK, &before, NULL);
    errno = kept;
    *only_other = n > 0 && ready[0].revents == 0;
    return n;
}

enum term_input term_read(struct buf *out, int timeout_ms, int other)
{
    bool only_other;
    int ready = wait_for_input(timeout_ms, other, &only_other);
    if (only_other)
        return TERM_OTHER;
    if (ready == 0)
        return TERM_TIMEOUT;
    if (ready < 0)
        return errno == EINTR ? TERM_SIGNAL : TERM_CLOSED;
    char *place = buf_reserve(out, 65536);
    if (!place)
        return TERM_CLOSED;
    ssize_t n = read(term.in, place, 65536);
    if (n > 0) {
        out->length += (size_t)n;
        place[n] = '\0';
        return TERM_BYTES;
    }
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return TERM_SIGNAL;
    return TERM_CLOSED;
}

bool term_was_resized(void)
{
    const bool was = term.resized;
    term.resized = 0;
    return was;
}

bool term_was_continued(void)
{
    const bool was = term.continued;
    term.continued = term.resized = 0;
    return was;
}

static void (*before_suspending)(void *context);
static void *suspending_context;

void term_on_suspend(void (*before)(void *context), void *context)
{
    before_suspending = before;
    suspending_context = context;
}

void term_suspend(void)
{
    if (before_suspending)
        before_suspending(suspending_context);
    kill(0, SIGTSTP);
}
