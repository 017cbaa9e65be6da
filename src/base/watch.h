/* SPDX-License-Identifier: MIT */
/*
 * The watch: progress and cancellation of long work.
 *
 * A long loop makes a task of its work and advances it by the units done. At most once every
 * TASK_STEP units the task polls the watch: it reports the work and its progress, and learns
 * whether to continue. The watch knows clock, terminal and signals; the loop knows none of them. A
 * unit is one voxel, or some 100 ns of other work, so that a stop is noticed within 50 ms (`bench
 * looks` of tests/bench measures it).
 *
 *     struct task task = task_begin(scene->watch, "weights", grid->voxels);
 *     for (each row)
 *         if (!task_advance(&task, weigh(row)))
 *             return;
 *
 * Some work can be shown while it runs. If the watch `wants_show`, the thread that began the work
 * calls `show` as soon as the partial result can be read, and the work waits until `show` returns.
 * The forest does so between two levels (engine/forest.h), relaxation between sweeps, and neither
 * while a command is undone.
 *
 * Invariants
 *   W1 stopping is sticky: after a stop, every task under the watch ends at its next step, until
 *      watch_begin. So a loop that ends early need not report it: the caller of a sequence of loops
 *      calls watch_stops once at the end, before using the result;
 *   W2 a watch that ignores stops shows progress and stops nothing: for undoing a command.
 */
#ifndef BASE_WATCH_H
#define BASE_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"

struct watch {
    void *context;
    /* Report that `done` of `total` units (0: unknown) of the work `what` are done ("weights";
     * NULL: nothing to show). Return true to stop. */
    bool (*poll)(void *context, const char *what, uint64_t done, uint64_t total);
    /* Show a line, without its line feed, before a large piece of work begins. May be NULL. */
    void (*announce)(void *context, const char *line);
    void (*show)(void *context); /* may be NULL */
    bool wants_show;             /* set by `poll`; `show` is called once for it */
    _Atomic bool stopped;        /* W1 */
    bool ignores_stop;           /* W2 */
    bool is_quiet;               /* shows and announces nothing, but still stops */
    uint64_t step;               /* units between two polls of a task; 0: TASK_STEP */
};

/* All of these accept NULL: a watch that never stops and shows nothing. */
void watch_begin(struct watch *watch); /* a new command: clear both kinds of state */
void watch_ignore_stop(struct watch *watch);
void watch_announce(struct watch *watch, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
bool watch_poll(struct watch *watch, const char *what, uint64_t done, uint64_t total);

/* Return true if the partial result is to be shown; and show it. */
bool watch_wants_show(const struct watch *watch);
void watch_show(struct watch *watch);

/* Return true if the work is to stop, or was stopped before. */
bool watch_stops(struct watch *watch);
/* The same as an error: ERR_CANCELLED with a text, or OK. */
enum err watch_fault(struct watch *watch, struct fault *fault);

enum { TASK_STEP = 1 << 18 };

struct task {
    struct watch *watch;
    const char *what;
    uint64_t done, total, next, step;
    bool only_stops; /* never polls */
};

struct task task_begin(struct watch *watch, const char *what, uint64_t total);

/* A task of one of several threads: part 0 polls the watch with its own progress; the others only
 * notice that it has stopped. */
struct task task_begin_part(struct watch *watch, const char *what, uint64_t total, uint64_t part);

bool task_poll(struct task *task); /* for task_advance */

/* Advance by `units`. False: end early. */
static inline bool task_advance(struct task *task, uint64_t units)
{
    task->done += units;
    return task->done < task->next || task_poll(task);
}

/* The same for work that cannot end early: poll the watch and continue. */
static inline void task_show(struct task *task, uint64_t units)
{
    if (!task_advance(task, units))
        task->next = task->done + task->step;
}

#endif
