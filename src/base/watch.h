/* SPDX-License-Identifier: MIT */
/*
 * The watch: progress and cancellation of long work.
 *
 * A long loop makes a task of its work and advances it by the units done. Now and then (never more
 * often than every TASK_STEP units) the task polls the watch: it says what is being done and how
 * far it is, and learns whether to go on. The watch knows clock, terminal and signals; the loop
 * knows none of them. A unit is a voxel looked at, or some 100 ns of other work, so that nobody
 * waits for more than 50 ms until a stop is heard (`bench looks` of tests/bench measures it).
 *
 *     struct task task = task_begin(scene->watch, "weights", grid->voxels);
 *     for (each row)
 *         if (!task_advance(&task, weigh(row)))
 *             return;
 *
 * Some work can be shown while it goes on. A watch that `wants_show` is called back by `show` as
 * soon as what is done so far can be read, by the thread that began the work, and nothing else goes
 * on meanwhile; the work goes on when `show` returns. The forest does so between two levels
 * (engine/forest.h), relaxation between sweeps, and neither while a command is taken back.
 *
 * Invariants
 *   W1 stopping is sticky: once the watch has said so, every task under it ends at its next step
 *      until watch_begin. So a loop that ends early may return nothing, and the caller of a whole
 *      sequence of them asks watch_stops once at the end, before the outcome is used;
 *   W2 a watch that ignores stops shows progress and stops nothing: for taking a command back.
 */
#ifndef BASE_WATCH_H
#define BASE_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"

struct watch {
    void *context;
    /* What is being done ("weights"; NULL: nothing to show), `done` of `total` units (0: not
     * known). True: stop. */
    bool (*poll)(void *context, const char *what, uint64_t done, uint64_t total);
    /* A line, without its line feed, that the user is to read before something large begins. May
     * be NULL. */
    void (*announce)(void *context, const char *line);
    void (*show)(void *context); /* may be NULL */
    bool wants_show;             /* set by `poll`; `show` is called once for it */
    _Atomic bool stopped;        /* W1 */
    bool ignores_stop;           /* W2 */
    bool is_quiet;               /* it shows and announces nothing, and still stops */
    uint64_t step;               /* units between two polls of a task; 0: TASK_STEP */
};

/* Any of these may be given NULL: a watch that never stops and shows nothing. */
void watch_begin(struct watch *watch); /* a new command: neither stopped nor ignoring stops */
void watch_ignore_stop(struct watch *watch);
void watch_announce(struct watch *watch, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
bool watch_poll(struct watch *watch, const char *what, uint64_t done, uint64_t total);

/* Whether what is done is to be shown; and shows it. */
bool watch_wants_show(const struct watch *watch);
void watch_show(struct watch *watch);

/* Whether the work is to stop, or has ended early already. */
bool watch_stops(struct watch *watch);
/* The same as an error, ERR_CANCELLED with words, or OK. */
enum err watch_fault(struct watch *watch, struct fault *fault);

enum { TASK_STEP = 1 << 18 };

struct task {
    struct watch *watch;
    const char *what;
    uint64_t done, total, next, step;
    bool only_stops; /* never polls */
};

struct task task_begin(struct watch *watch, const char *what, uint64_t total);

/* The part of one of several threads: the first, part 0, polls the watch, as if its own were all
 * there is; the others only notice that it has stopped. */
struct task task_begin_part(struct watch *watch, const char *what, uint64_t total, uint64_t part);

bool task_poll(struct task *task); /* for task_advance */

/* `units` more are done. False: end early. */
static inline bool task_advance(struct task *task, uint64_t units)
{
    task->done += units;
    return task->done < task->next || task_poll(task);
}

/* The same for work that is not ended early: it is looked at, and goes on. */
static inline void task_show(struct task *task, uint64_t units)
{
    if (!task_advance(task, units))
        task->next = task->done + task->step;
}

#endif
