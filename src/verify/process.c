/* SPDX-License-Identifier: MIT */
#include "verify/process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    TICK_MS = 20,
    END_MS = 1, /* wait from the end of a pipe to the end of its process */
    PIECE = 1 << 16,
    STATUS_NO_MEMORY = 71 /* exit status of a process that had no memory for its output */
};

struct process {
    pid_t id;       /* 0: free */
    int descriptor; /* reading end of the pipe; -1: read to its end */
    bool is_over;   /* waited for; its id may belong to another process */
    size_t number;
    struct process_end end;
};

struct pool {
    const struct processes *how;
    struct process process[PROCESSES_MOST];
    size_t begun, ended; /* pieces of work */
};

/* ---- in the new process ---- */

/* The process ends with its parent, and by Ctrl-C as any program does. */
static _Noreturn void run_child(const struct processes *how, size_t number, int descriptor,
                                pid_t parent)
{
    struct buf bytes = {0};
    if (signal(SIGINT, SIG_DFL) == SIG_IGN)
        signal(SIGINT, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(1);
    how->work(how->context, number, &bytes);
    for (size_t sent = 0; !bytes.failed && sent < bytes.length;) {
        const ssize_t n = write(descriptor, bytes.data + sent, bytes.length - sent);
        if (n < 0 && errno != EINTR)
            _exit(STATUS_NO_MEMORY);
        sent += n > 0 ? (size_t)n : 0;
    }
    _exit(bytes.failed ? STATUS_NO_MEMORY : 0);
}

/* ---- one process, seen from the parent ---- */

static enum err start_process(struct pool *pool, struct process *process, struct fault *fault)
{
    int end[2];
    const pid_t parent = getpid();
    if (pipe2(end, O_CLOEXEC) != 0)
        return fault_errno(fault, "make", "a pipe");
    const pid_t id = fork();
    if (id == 0)
        run_child(pool->how, pool->begun, end[1], parent);
    close(end[1]);
    if (id < 0) {
        close(end[0]);
        return fault_errno(fault, "start", "a process");
    }
    *process = (struct process){.id = id, .descriptor = end[0], .number = pool->begun++};
    return OK;
}

static void close_pipe(struct process *process)
{
    if (process->descriptor >= 0)
        close(process->descriptor);
    process->descriptor = -1;
}

/* Read the available output. Kill a process that returns too much. */
static void read_output(const struct pool *pool, struct process *process)
{
    struct buf *bytes = &process->end.bytes;
    char *room = buf_reserve(bytes, PIECE);
    const ssize_t n = room ? read(process->descriptor, room, PIECE) : 0;
    if (room) {
        bytes->length += n > 0 ? (size_t)n : 0;
        bytes->data[bytes->length] = '\0';
    }
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return;
    process->end.is_too_much = bytes->length > pool->how->most;
    if ((process->end.is_too_much || bytes->failed) && !process->is_over)
        kill(process->id, SIGKILL);
    if (n <= 0 || process->end.is_too_much)
        close_pipe(process);
}

/* P2: read the rest of the pipe, though another process may still write to it. */
static void finish_process(struct pool *pool, struct process *process)
{
    struct pollfd wait = {process->descriptor, POLLIN, 0};
    while (process->descriptor >= 0 && poll(&wait, 1, 0) > 0 &&
           process->end.bytes.length < pool->how->most)
        read_output(pool, process);
    close_pipe(process);
    if (pool->how->end) {
        pool->how->end[process->number] = process->end;
    } else {
        pool->how->done(pool->how->context, process->number, &process->end);
        buf_release(&process->end.bytes);
    }
    *process = (struct process){0};
    pool->ended++;
}

/* ---- all processes ---- */

/* Wait for output or the end of any process, for one tick at most. */
static void poll_processes(struct pool *pool)
{
    struct pollfd wait[PROCESSES_MOST];
    int most_ms = TICK_MS;
    for (unsigned i = 0; i < PROCESSES_MOST; i++) {
        const struct process *process = pool->process + i;
        wait[i] = (struct pollfd){process->id ? process->descriptor : -1, POLLIN, 0};
        if (process->id && process->descriptor < 0)
            most_ms = END_MS;
    }
    if (poll(wait, PROCESSES_MOST, most_ms) > 0)
        for (unsigned i = 0; i < PROCESSES_MOST; i++)
            if (wait[i].revents)
                read_output(pool, pool->process + i);
    for (unsigned i = 0; i < PROCESSES_MOST; i++) {
        struct process *process = pool->process + i;
        const pid_t id = process->id ? waitpid(process->id, &process->end.status, WNOHANG) : 0;
        /* If the parent of this program ignores SIGCHLD, no process leaves a status. */
        process->is_over = process->id && (id == process->id || (id < 0 && errno == ECHILD));
        if (process->is_over)
            finish_process(pool, process);
    }
}

enum err processes_run(const struct processes *how, struct fault *fault)
{
    struct pool pool = {.how = how};
    enum err err = OK;
    while (!err && pool.ended < how->count) {
        for (unsigned i = 0; !err && i < how->at_once; i++)
            if (!pool.process[i].id && pool.begun < how->count)
                err = start_process(&pool, pool.process + i, fault);
        if (!err)
            poll_processes(&pool);
        if (!err && watch_poll(how->watch, how->what, how->count > 1 ? pool.ended : 0,
                               how->count > 1 ? how->count : 0))
            err = fault_set(fault, ERR_CANCELLED, "cancelled");
    }
    for (unsigned i = 0; i < PROCESSES_MOST; i++) { /* P3 */
        struct process *process = pool.process + i;
        if (!process->id)
            continue;
        kill(process->id, SIGKILL);
        close_pipe(process);
        while (waitpid(process->id, NULL, 0) < 0 && errno == EINTR)
            ;
        buf_release(&process->end.bytes);
    }
    return err;
}

/* ---- one process ---- */

enum err process_judge(const struct process_end *end, struct fault *fault)
{
    if (end->is_too_much)
        return fault_set(fault, ERR_INPUT, "its process returned more than it may");
    if (end->bytes.failed)
        return fault_memory(fault, "the output of a process");
    if (WIFSIGNALED(end->status))
        return fault_set(fault, ERR_INPUT, "its process was ended by signal %d (%s)",
                         WTERMSIG(end->status), strsignal(WTERMSIG(end->status)));
    const int status = WEXITSTATUS(end->status);
    if (status == STATUS_NO_MEMORY)
        return fault_memory(fault, "the output of a process");
    return status ? fault_set(fault, ERR_INPUT, "its process ended with status %d", status) : OK;
}

enum err process_run(struct buf *out, const struct processes *how, struct fault *fault)
{
    struct processes alone = *how;
    struct process_end end = {0};
    alone.count = alone.at_once = 1;
    alone.end = &end;
    enum err err = processes_run(&alone, fault);
    if (!err)
        err = process_judge(&end, fault);
    buf_release(out);
    *out = end.bytes;
    return err;
}
