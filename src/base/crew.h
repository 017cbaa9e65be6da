/*
 * The crew: a few threads that do one piece of work together.
 *
 * Work is a function that every worker runs at the same time, each knowing its number; it divides
 * the work by that number, so that who does what never depends on timing. Between pieces of work
 * the threads sleep; inside one they meet at crew_wait, which spins for a moment before it yields,
 * since a pass over the levels of a forest meets thousands of times.
 *
 * Everywhere NULL is a crew of one: the caller alone.
 */
#ifndef BASE_CREW_H
#define BASE_CREW_H

#include <stddef.h>

#include "base/err.h"

struct crew;

enum { CREW_MOST = 64 };

/* Workers for this machine: one for each core that may be used, at most 8; IFTTY_THREADS in the
 * environment, 1..64, says otherwise. */
unsigned crew_size_wanted(void);

/* `workers` 1..CREW_MOST, the caller's thread among them. Signals are left to the caller's. Threads
 * that cannot be had make the crew smaller; ERR_MEMORY only where there is not even the crew. */
enum err crew_new(struct crew **crew, unsigned workers, struct fault *fault);
void crew_free(struct crew *crew);

unsigned crew_size(const struct crew *crew);

/* Runs work(context, worker) for every worker 0..size-1, 0 being the caller, and returns when all
 * have returned. */
typedef void crew_work(void *context, unsigned worker);
void crew_run(struct crew *crew, crew_work *work, void *context);

/* Inside work: returns when every worker has come here. What any of them wrote before, all see. */
void crew_wait(struct crew *crew);

/* The part first..end of `count` things that falls to a worker, in order and nearly equal. */
struct share {
    size_t first, end;
};
struct share crew_share(const struct crew *crew, unsigned worker, size_t count);

#endif
