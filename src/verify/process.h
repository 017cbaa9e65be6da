/* SPDX-License-Identifier: MIT */
/*
 * Work on what is not trusted, each piece in a process of its own, several at once.
 *
 * Such a process may be confined, crash or be killed, and what it changes in memory goes with it;
 * what it hands back comes through a pipe. No process outlives the one that started it, nor the
 * call that did.
 *
 *     (P1) of each piece of work that was begun the end is reported once, unless the whole ends
 *          early;
 *     (P2) the end of a process is waited for, whatever it leaves open, and its pipe is not waited
 *          for beyond its end;
 *     (P3) no process is left when processes_run returns.
 */
#ifndef VERIFY_PROCESS_H
#define VERIFY_PROCESS_H

#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"

enum { PROCESSES_MOST = 64 };

/* How a process came to its end. */
struct process_end {
    int status;       /* as of waitpid; 0 where the kernel did not say */
    bool is_too_much; /* it was killed, because it handed more back than it may */
    struct buf bytes; /* what it handed back */
};

struct processes {
    size_t count;     /* pieces of work, which are begun in their order */
    unsigned at_once; /* 1..PROCESSES_MOST */
    uint64_t most;    /* bytes that each may hand back */
    void *context;
    /* In the new process: adds to `out` the bytes to hand back. */
    void (*work)(void *context, size_t number, struct buf *out);
    /* Where the ends of all pieces of work go, for the caller to release what they handed back; or
     * NULL, and `done` is called with each. */
    struct process_end *end;
    void (*done)(void *context, size_t number, const struct process_end *end);
    struct watch
        *watch;       /* shows `what` and the work that has ended; when it stops, all are killed; */
    const char *what; /* or NULL, both */
};

/* OK when all have ended, however they did; ERR_IO: one could not be started; ERR_CANCELLED. */
enum err processes_run(const struct processes *how, struct fault *fault);

/* OK for a process that handed back all it had; ERR_INPUT, naming the signal, for one that was
 * killed, ended early, or handed too much back; ERR_MEMORY where there was no room. */
enum err process_judge(const struct process_end *end, struct fault *fault);

/* One piece of work, judged: what it hands back is in `out`, a part of it where that fails. Only
 * `work`, `context`, `most`, `watch` and `what` of `how` count. */
enum err process_run(struct buf *out, const struct processes *how, struct fault *fault);

#endif
