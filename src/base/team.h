/* SPDX-License-Identifier: MIT */
/*
 * A team: a few threads that do one piece of work together.
 *
 * Work is a function that every worker runs at the same time, each with its number; the work is
 * divided by that number, so which worker does which part never depends on timing. The threads
 * sleep between pieces of work; inside one they meet at team_wait, which spins for a moment before
 * it yields, since a pass over the levels of a forest meets thousands of times.
 *
 * NULL is a team of one everywhere: the caller alone.
 */
#ifndef BASE_TEAM_H
#define BASE_TEAM_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/err.h"

/* Start a thread that receives no signals: those go to the starting thread. False, with errno, on
 * failure. */
bool thread_start(pthread_t *thread, void *(*work)(void *), void *argument);

/* A condition whose time limits use CLOCK_MONOTONIC, which is never adjusted. */
void thread_condition_init(pthread_cond_t *condition);

struct team;

enum { TEAM_MOST = 64 };

/* Return the number of workers for this machine: one for each usable core, at most 8, or
 * IFTTY_THREADS, 1..64, from the environment. */
unsigned team_size_wanted(void);

/* `workers` is 1..TEAM_MOST and includes the calling thread, which receives all signals. The team
 * is smaller if threads cannot be started; ERR_MEMORY only if there is no memory for the team
 * itself. */
enum err team_new(struct team **team, unsigned workers, struct fault *fault);
void team_free(struct team *team);

unsigned team_size(const struct team *team);

/* Run work(context, worker) for every worker 0..size-1, 0 being the caller, and return when all
 * have returned. */
typedef void team_work(void *context, unsigned worker);
void team_run(struct team *team, team_work *work, void *context);

/* Inside work: wait until every worker has called this. All see what any of them wrote before. */
void team_wait(struct team *team);

/* The part first..end of `count` items for a worker, in order and nearly equal in size. */
struct share {
    size_t first, end;
};
struct share team_share(const struct team *team, unsigned worker, size_t count);

#endif
