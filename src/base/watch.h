/*
 * The watch: how long work shows how far it has come, and learns that nobody wants it any more.
 *
 * Who works in a long loop makes a task of it and advances it by the units done. Now and then
 * (never more often than every TASK_STEP units) the watch is told what is being done and how far it
 * is, and answers whether to go on. Who watches knows clock, terminal and signals; who works knows
 * none.
 *
 *     struct task task = task_begin(scene->watch, "weights", grid->voxels);
 *     for (each row)
 *         if (!task_advance(&task, weigh(row)))
 *             return;
 *
 * Invariants
 *   W1 stopping is sticky: once the watch has said so, every task under it ends at its next step
 *      until watch_begin. So a loop that is cut short may return nothing, and whoever asked for a
 *      whole sequence of them asks watch_stops once at the end, before the outcome is used;
 *   W2 a watch that is `deaf` is told everything and stops nothing: for taking a command back. One
 *      that has stopped is told as well, by whoever takes back without looking at its answers.
 */
#ifndef BASE_WATCH_H
#define BASE_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"

struct watch {
    void *context;
    /* What is being done ("weights"; NULL: nothing to show), `done` of `total` units (0: nobody
     * knows how many). True: stop. */
    bool (*look)(void *context, const char *what, uint64_t done, uint64_t total);
    /* A line, without its line feed, that the user is to read before something large begins. May
     * be NULL. */
    void (*tell)(void *context, const char *line);
    _Atomic bool stopped; /* W1 */
    bool deaf;            /* W2 */
};

/* Any of these may be given NULL, a watch that never stops and to whom nothing is told. */
void watch_begin(struct watch *watch); /* a new command: goes on, and hears */
void watch_deafen(struct watch *watch);
void watch_tell(struct watch *watch, const char *format, ...) __attribute__((format(printf, 2, 3)));
bool watch_look(struct watch *watch, const char *what, uint64_t done, uint64_t total);

/* Whether the work is to stop, or has been cut short already. */
bool watch_stops(struct watch *watch);
/* The same as an error, ERR_CANCELLED with words, or OK. */
enum err watch_fault(struct watch *watch, struct fault *fault);

enum { TASK_STEP = 1 << 18 };

struct task {
    struct watch *watch;
    const char *what;
    uint64_t done, total, next;
    bool aside;
};

struct task task_begin(struct watch *watch, const char *what, uint64_t total);

/* The part of one of several threads: the first, part 0, has the watch look, as if its own were all
 * there is; the others only notice that it has stopped. */
struct task task_begin_part(struct watch *watch, const char *what, uint64_t total, uint64_t part);

bool task_look(struct task *task); /* for task_advance */

/* `units` more are done. False: leave off. */
static inline bool task_advance(struct task *task, uint64_t units)
{
    task->done += units;
    return task->done < task->next || task_look(task);
}

#endif
