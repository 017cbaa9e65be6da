/* SPDX-License-Identifier: MIT */
/*
 * The team: a few threads that do one piece of work together.
 *
 * Work is a function that every worker runs at the same time, each knowing its number; it divides
 * the work by that number, so that which worker does what never depends on timing. Between pieces
 * of work the threads sleep; inside one they meet at team_wait, which spins for a moment before it
 * yields, since a pass over the levels of a forest meets thousands of times.
 *
 * Everywhere NULL is a thread team of one: the caller alone.
 */
#ifndef BASE_TEAM_H
#define BASE_TEAM_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/err.h"

/* A thread that takes no signals: those are for the thread that starts it. False, and errno, where
 * none can be had. */
bool thread_start(pthread_t *thread, void *(*work)(void *), void *argument);

/* A condition whose time limits are of CLOCK_MONOTONIC, which nobody sets. */
void thread_condition_init(pthread_cond_t *condition);

struct team;

enum { TEAM_MOST = 64 };

/* Workers for this machine: one for each core that may be used, at most 8; IFTTY_THREADS in the
 * environment, 1..64, says otherwise. */
unsigned team_size_wanted(void);

/* `workers` 1..TEAM_MOST, the caller's thread among them. Signals are left to the caller's. Threads
 * that cannot be had make the team smaller; ERR_MEMORY only where there is not even the team. */
enum err team_new(struct team **team, unsigned workers, struct fault *fault);
void team_free(struct team *team);

unsigned team_size(const struct team *team);

/* Runs work(context, worker) for every worker 0..size-1, 0 being the caller, and returns when all
 * have returned. */
typedef void team_work(void *context, unsigned worker);
void team_run(struct team *team, team_work *work, void *context);

/* Inside work: returns when every worker has come here. What any of them wrote before, all see. */
void team_wait(struct team *team);

/* The part first..end of `count` things that falls to a worker, in order and nearly equal. */
struct share {
    size_t first, end;
};
struct share team_share(const struct team *team, unsigned worker, size_t count);

#endif
