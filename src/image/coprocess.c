/* SPDX-License-Identifier: MIT */
#include "image/coprocess.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"

enum {
    LOOK_MS = 50,        /* between two looks at the watch */
    WORK_MS = 500,       /* between two checks of its progress */
    ASLEEP_MS = 1000,    /* a wait this long shows that this process itself was stopped */
    BYTES_PER_MS = 1000, /* slower than any disk, decoder or encoder */
};

/* ---- start and stop ---- */

/* PREFIX/bin/iftty has its helpers in PREFIX/libexec/iftty, wherever the PREFIX was moved to. */
enum err coprocess_find(struct buf *out, const char *name, struct fault *fault)
{
    OWNED(buf_release) struct buf own = {0}, above = {0}, installed = {0};
    TRY(file_program_folder(&own, fault));
    file_folder(&above, buf_text(&own));
    buf_printf(&installed, "%s/libexec/iftty/%s", buf_text(&above), name);
    buf_printf(&own, "/%s", name);
    const bool is_installed =
        access(buf_text(&own), X_OK) != 0 && access(buf_text(&installed), X_OK) == 0;
    buf_add_text(out, buf_text(is_installed ? &installed : &own));
    const bool failed = own.failed || above.failed || installed.failed || out->failed;
    return failed ? fault_memory(fault, "a file name") : OK;
}

enum err coprocess_init(struct coprocess *c, const char *name, const char *program,
                        struct fault *fault)
{
    OWNED(buf_release) struct buf found = {0};
    const enum err err = program ? OK : coprocess_find(&found, name, fault);
    *c = (struct coprocess){.fd = -1};
    c->program = err ? NULL : strdup(program ? program : buf_text(&found));
    return err || c->program ? err : fault_memory(fault, name);
}

void coprocess_release(struct coprocess *c)
{
    coprocess_stop(c); /* between requests it holds nothing that could be lost */
    free(c->program);
    c->program = NULL;
}

int coprocess_stop(struct coprocess *c)
{
    int status = -1;
    pid_t ended;
    if (c->fd >= 0)
        close(c->fd);
    c->fd = -1;
    if (c->process <= 0)
        return status;
    kill(-c->process, SIGKILL); /* with its children; one that has ended keeps its status */
    do
        ended = waitpid(c->process, &status, 0);
    while (ended < 0 && errno == EINTR);
    c->process = 0;
    return ended < 0 ? -1 : status;
}

/* Standard input and output are the socket, standard error is /dev/null, and the environment is
 * empty: ours might make a decoder load plug-ins. */
static int spawn_program(pid_t *process, const char *program, int fd)
{
    char *const arguments[] = {(char *)(uintptr_t)program, NULL}, *const environment[] = {NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawn_file_actions_init(&actions); /* neither fails: they clear their argument */
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, fd, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fd, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
                                              POSIX_SPAWN_SETSIGDEF);
    const int number = posix_spawn(process, program, &actions, &attributes, arguments, environment);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return number;
}

bool coprocess_limit(struct coprocess *c, uint64_t soft, uint64_t hard)
{
    struct rlimit limit;
    if (!MEM_MAY_BE_LIMITED)
        return true;
    if (prlimit(c->process, RLIMIT_DATA, NULL, &limit) != 0)
        return false;
    if (limit.rlim_max > hard)
        limit.rlim_max = (rlim_t)hard;
    limit.rlim_cur = limit.rlim_max < soft ? limit.rlim_max : (rlim_t)soft;
    return prlimit(c->process, RLIMIT_DATA, &limit, NULL) == 0;
}

/* Report why it cannot start, and how to get a missing helper. */
static enum err start_fault(const struct coprocess *c, int number, struct fault *fault)
{
    char source[160] = "";
    OWNED(buf_release) struct buf library = {0}; /* next to the program in a checkout */
    const enum err err = file_program_folder(&library, NULL);
    buf_add_text(&library, "/libiftty.a");
    if (number == ENOENT && !err && !library.failed && access(buf_text(&library), R_OK) == 0)
        snprintf(source, sizeof source, "; `make` builds it (of %s)", c->made_of);
    else if (number == ENOENT)
        snprintf(source, sizeof source,
                 "; the package %s has it, or `make install` of a checkout where it was built",
                 c->package);
    return fault_set(fault, ERR_IO, "cannot start %s %s: %s%s%s", c->kind, c->program,
                     strerror(number), c->hint ? c->hint : "", source);
}

enum err coprocess_start(struct coprocess *c, struct fault *fault)
{
    int pair[2];
    if (c->process > 0 && waitpid(c->process, NULL, WNOHANG) != 0) {
        c->process = 0;
        coprocess_stop(c);
    }
    c->trouble = FINE;
    if (c->process > 0)
        return OK;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
        return fault_errno(fault, "reach", c->program);
    int number = spawn_program(&c->process, c->program, pair[1]);
    close(pair[1]);
    if (number) {
        c->process = 0;
        close(pair[0]);
        return start_fault(c, number, fault);
    }
    c->fd = pair[0];
    if (c->memory && !coprocess_limit(c, c->memory, c->memory)) {
        const enum err err = fault_errno(fault, "limit the memory of", c->program);
        coprocess_stop(c);
        return err;
    }
    return OK;
}

/* ---- bytes ---- */

static bool set_trouble(struct coprocess *c, enum trouble trouble)
{
    c->trouble = trouble;
    return false;
}

/* The deadline for the transfer of `length` bytes. */
static uint64_t latest_ns(const struct coprocess *c, size_t length)
{
    return clock_ns() + ((uint64_t)c->patience_ms + length / BYTES_PER_MS) * 1000000;
}

/* ---- progress ---- */

enum {
    STUCK_MS = 5000, /* limit of processor time without even an allocation */
    PAGES_LEAST = 256,
    STAT_BYTES = 1024,
    PROCESSES_MOST = 8,
};

/* Add the processor time and the memory of a process, by its line in /proc: fields 14, 15, 24. */
static bool add_work(long process, uint64_t *busy_ms, uint64_t *pages)
{
    char path[64], line[STAT_BYTES];
    unsigned long long user, system;
    long resident;
    snprintf(path, sizeof path, "/proc/%ld/stat", process);
    OWNED(stream_release) FILE *file = fopen(path, "re");
    const size_t n = file ? fread(line, 1, sizeof line - 1, file) : 0;
    line[n] = '\0';
    const char *at = strrchr(line, ')'); /* its name may hold anything */
    if (!at || sscanf(at + 1,
                      " %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %llu %llu %*s %*s %*s %*s "
                      "%*s %*s %*s %*s %ld",
                      &user, &system, &resident) != 3)
        return false;
    *busy_ms += (user + system) * 1000 / (unsigned long long)sysconf(_SC_CLK_TCK);
    *pages += resident > 0 ? (uint64_t)resident : 0;
    return true;
}

static uint64_t work_ms(const struct coprocess *c)
{
    return (uint64_t)(c->work_ms ? c->work_ms : STUCK_MS);
}

/* Check progress: a working decoder fills memory, or answers, and extends the deadline. One that
 * has used much processor time without either is stuck. Without /proc only the deadline counts. */
static bool makes_progress(struct coprocess *c, uint64_t *until)
{
    uint64_t busy_ms = 0, pages = 0;
    char path[64];
    long child;
    snprintf(path, sizeof path, "/proc/%ld/task/%ld/children", (long)c->process, (long)c->process);
    OWNED(stream_release) FILE *file = fopen(path, "re");
    for (int i = 0; file && i < PROCESSES_MOST && fscanf(file, "%ld", &child) == 1; i++)
        add_work(child, &busy_ms, &pages);
    if (!add_work(c->process, &busy_ms, &pages))
        return true;
    const bool is_first = !c->pages || busy_ms < c->busy_ms; /* one of them has ended */
    const bool has_grown = pages >= c->pages + PAGES_LEAST;
    if (!is_first && !has_grown)
        return busy_ms - c->busy_ms < work_ms(c) || set_trouble(c, STUCK);
    const uint64_t later = clock_ns() + (uint64_t)c->patience_ms * 1000000;
    if (!is_first && later > *until)
        *until = later;
    c->busy_ms = busy_ms;
    c->pages = pages > c->pages ? pages : c->pages;
    return true;
}

/* Wait until a descriptor is ready: false after the deadline, or if the watch stops. */
static bool wait_for(struct coprocess *c, int fd, short events, uint64_t *until)
{
    for (uint64_t looked = clock_ns();;) {
        struct pollfd wanted = {.fd = fd, .events = events};
        const uint64_t now = clock_ns();
        if (now - looked >= (uint64_t)WORK_MS * 1000000) {
            looked = now;
            if (!makes_progress(c, until))
                return false;
        }
        if (now >= *until)
            return set_trouble(c, SILENT);
        const uint64_t left_ms = (*until - now + 999999) / 1000000;
        const uint64_t most_ms = c->watch ? LOOK_MS : WORK_MS;
        const int ready = poll(&wanted, 1, (int)(left_ms < most_ms ? left_ms : most_ms));
        const uint64_t waited = clock_ns() - now;
        if (waited >= (uint64_t)ASLEEP_MS * 1000000)
            *until += waited;
        if (ready > 0)
            return true;
        if (ready < 0 && errno != EINTR)
            return set_trouble(c, GONE);
        if (watch_poll(c->watch, c->doing, 0, 0))
            return set_trouble(c, STOPPED);
    }
}

bool coprocess_transmit(struct coprocess *c, const void *bytes, size_t length)
{
    const char *at = bytes;
    uint64_t until = latest_ns(c, length);
    while (length > 0) {
        const ssize_t n = send(c->fd, at, length, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n >= 0) {
            at += n;
            length -= (size_t)n;
        } else if (errno == EAGAIN) {
            if (!wait_for(c, c->fd, POLLOUT, &until))
                return false;
        } else if (errno != EINTR) {
            return set_trouble(c, GONE);
        }
    }
    return true;
}

static bool receive_until(struct coprocess *c, void *bytes, size_t length, uint64_t *until)
{
    char *at = bytes;
    bool reset = false;
    while (length > 0) {
        const ssize_t n = recv(c->fd, at, length, MSG_DONTWAIT);
        if (n > 0) {
            at += n;
            length -= (size_t)n;
            c->pages = 0;
        } else if (n < 0 && errno == EAGAIN) {
            if (!wait_for(c, c->fd, POLLIN, until))
                return false;
        } else if (n < 0 && errno == ECONNRESET && !reset) {
            reset = true; /* reported once, before the bytes that it sent */
        } else if (n == 0 || errno != EINTR) {
            return set_trouble(c, GONE);
        }
    }
    return true;
}

bool coprocess_receive(struct coprocess *c, void *bytes, size_t length)
{
    uint64_t until = latest_ns(c, length);
    return receive_until(c, bytes, length, &until);
}

bool coprocess_odd(struct coprocess *c)
{
    return set_trouble(c, ODD);
}

/* Byte by byte: lines are few and short, and later bytes must remain in the socket. */
bool coprocess_receive_line(struct coprocess *c, char line[COPROCESS_LINE])
{
    uint64_t until = latest_ns(c, COPROCESS_LINE);
    for (size_t i = 0; i < COPROCESS_LINE; i++) {
        if (!receive_until(c, &line[i], 1, &until))
            return false;
        if (line[i] == '\n') {
            line[i] = '\0';
            return true;
        }
    }
    return coprocess_odd(c);
}

bool coprocess_numbers(const char *line, unsigned count, const int64_t most[], int64_t out[])
{
    for (unsigned i = 0; i < count; i++)
        if ((i > 0 && !scan_text(&line, " ")) || !scan_integer(&line, 0, most[i], &out[i]))
            return false;
    return *line == '\0';
}

/* ---- errors ---- */

enum err coprocess_fault(struct coprocess *c, const char *doing, const char *path,
                         struct fault *fault)
{
    /* A program that closed the socket is about to end, and its status has the reason; one that
     * keeps running counts as silent. */
    const int end_of_it = c->trouble == GONE ? (int)syscall(SYS_pidfd_open, c->process, 0) : -1;
    if (end_of_it >= 0) {
        uint64_t until = latest_ns(c, 0);
        wait_for(c, end_of_it, POLLIN, &until);
        close(end_of_it);
    }
    const int status = coprocess_stop(c);
    char end[128] = "ended early";
    if (c->trouble == STOPPED)
        return watch_fault(c->watch, fault);
    if (c->trouble == SILENT)
        snprintf(end, sizeof end, "did not answer for %d s and was ended",
                 (c->patience_ms + 999) / 1000);
    else if (c->trouble == STUCK)
        snprintf(end, sizeof end, "worked for %d s without progress and was ended",
                 (int)(work_ms(c) / 1000));
    else if (c->trouble == ODD)
        snprintf(end, sizeof end, "sent an invalid answer and was ended");
    else if (status != -1 && WIFSIGNALED(status))
        snprintf(end, sizeof end, "died (%s)", strsignal(WTERMSIG(status)));
    else if (status != -1 && WIFEXITED(status))
        snprintf(end, sizeof end, "ended with status %d", WEXITSTATUS(status));
    fault_set(fault, ERR_IO, "%s %s %s", c->kind, c->program, end);
    return path ? fault_prefix(fault, ERR_IO, "cannot %s %s", doing, path) : ERR_IO;
}

enum err coprocess_answer(struct coprocess *c, char line[COPROCESS_LINE], const char *doing,
                          const char *path, struct fault *fault)
{
    char words[400];
    int64_t length;
    if (!coprocess_receive_line(c, line))
        return coprocess_fault(c, doing, path, fault);
    const char *at = line;
    if (!scan_text(&at, "error "))
        return OK;
    const int64_t most = sizeof words - 1;
    if (!coprocess_numbers(at, 1, &most, &length))
        coprocess_odd(c);
    else if (coprocess_receive(c, words, (size_t)length)) {
        words[length] = '\0';
        fault_set(fault, ERR_INPUT, "%s", words);
        return path ? fault_prefix(fault, ERR_INPUT, "cannot %s %s", doing, path) : ERR_INPUT;
    }
    return coprocess_fault(c, doing, path, fault);
}

void coprocess_add_versions(struct buf *out, const char *name, const char *package)
{
    enum { ANSWER_MS = 10000 };
    static const int64_t most = 400;
    OWNED(coprocess_release) struct coprocess c = {.fd = -1};
    char line[COPROCESS_LINE], words[400];
    const char *at = line;
    int64_t length = 0;
    if (coprocess_init(&c, name, NULL, NULL) != OK || access(c.program, X_OK) != 0) {
        buf_printf(out, "missing; the package %s has it", package);
    } else {
        c.patience_ms = ANSWER_MS;
        const bool answers = coprocess_start(&c, NULL) == OK &&
                             coprocess_transmit(&c, "versions\n", 9) &&
                             coprocess_receive_line(&c, line) && scan_text(&at, "versions ") &&
                             coprocess_numbers(at, 1, &most, &length) &&
                             coprocess_receive(&c, words, (size_t)length);
        buf_add(out, words, answers ? (size_t)length : 0);
        if (!answers)
            buf_add_text(out, "no answer: it is of another version, or broken");
    }
}
