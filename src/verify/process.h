/* SPDX-License-Identifier: MIT */
/*
 * Work on untrusted input, each piece in a process of its own, several at once.
 *
 * Such a process may be confined, crash or be killed. Its memory is released with it, and its
 * output comes through a pipe. No process outlives its parent, nor the call that started it.
 *
 *     (P1) the end of each piece of work that was started is reported once, unless processes_run
 *          ends early;
 *     (P2) each process is waited for, whatever descriptors it leaves open, and its pipe is not
 *          read after the end of the process;
 *     (P3) no process is left when processes_run returns.
 */
#ifndef VERIFY_PROCESS_H
#define VERIFY_PROCESS_H

#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"

enum { PROCESSES_MOST = 64 };

/* End of a process. */
struct process_end {
    int status;       /* as of waitpid; 0 if the kernel did not report it */
    bool is_too_much; /* it was killed because its output was longer than `most` */
    struct buf bytes; /* output */
};

struct processes {
    size_t count;     /* pieces of work, started in order */
    unsigned at_once; /* 1..PROCESSES_MOST */
    uint64_t most;    /* bytes of output of each */
    void *context;
    /* In the new process: append the output to `out`. */
    void (*work)(void *context, size_t number, struct buf *out);
    /* Receives the ends of all pieces of work, whose bytes the caller releases; or NULL, and
     * `done` is called with each. */
    struct process_end *end;
    void (*done)(void *context, size_t number, const struct process_end *end);
    struct watch
        *watch;       /* shows `what` and the work done; when it stops, all processes are killed; */
    const char *what; /* or NULL, both */
};

/* OK when all processes have ended, with any status; ERR_IO if a process could not be started;
 * ERR_CANCELLED. */
enum err processes_run(const struct processes *how, struct fault *fault);

/* OK for a process with complete output; ERR_INPUT, naming the signal, if it was killed, ended
 * early, or returned too much; ERR_MEMORY. */
enum err process_judge(const struct process_end *end, struct fault *fault);

/* Run one piece of work and judge its end. `out` receives the output, incomplete on errors. Only
 * `work`, `context`, `most`, `watch` and `what` of `how` are used. */
enum err process_run(struct buf *out, const struct processes *how, struct fault *fault);

#endif
