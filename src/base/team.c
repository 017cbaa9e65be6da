/* SPDX-License-Identifier: MIT */
#include "base/team.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#include "base/mem.h"

enum {
    SPINS = 4000, /* some microseconds: longer than most levels of a forest */
    WORKERS_UNASKED = 8,
};

struct worker {
    struct team *team;
    unsigned number;
    pthread_t thread;
};

struct team {
    unsigned size, spins;            /* turns before a yield; none with more workers than cores */
    struct worker worker[TEAM_MOST]; /* [0] is the caller and has no thread */

    /* team_wait: the last worker to arrive increments `meeting`, which releases the others. */
    atomic_uint arrived, meeting;

    /* The lock protects the start of a piece of work and the reports of its end. */
    pthread_mutex_t lock;
    pthread_cond_t begins, ended;
    team_work *work;
    void *context;
    unsigned piece;   /* number of the piece of work */
    unsigned at_work; /* threads that have not finished this piece */
    bool is_ending;
};

/* Cores that this process may use; 1 if unknown. */
static unsigned count_cores(void)
{
    cpu_set_t cores;
    return sched_getaffinity(0, sizeof cores, &cores) == 0 ? (unsigned)CPU_COUNT(&cores) : 1;
}

unsigned team_size_wanted(void)
{
    const char *text = getenv("IFTTY_THREADS");
    char *end;
    const unsigned long asked = text ? strtoul(text, &end, 10) : 0;
    if (text && *text && *end == '\0' && asked >= 1 && asked <= TEAM_MOST)
        return (unsigned)asked;
    const unsigned count = count_cores();
    return count < WORKERS_UNASKED ? count : WORKERS_UNASKED;
}

unsigned team_size(const struct team *team)
{
    return team ? team->size : 1;
}

static void *work_on(void *argument)
{
    const struct worker *worker = argument;
    struct team *team = worker->team;
    unsigned done = 0;
    pthread_mutex_lock(&team->lock);
    for (;;) {
        while (team->piece == done && !team->is_ending)
            pthread_cond_wait(&team->begins, &team->lock);
        if (team->is_ending)
            break;
        done = team->piece;
        pthread_mutex_unlock(&team->lock);
        team->work(team->context, worker->number);
        pthread_mutex_lock(&team->lock);
        if (--team->at_work == 0)
            pthread_cond_signal(&team->ended);
    }
    pthread_mutex_unlock(&team->lock);
    return NULL;
}

bool thread_start(pthread_t *thread, void *(*work)(void *), void *argument)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int number = pthread_create(thread, NULL, work, argument);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    errno = number;
    return number == 0;
}

void thread_condition_init(pthread_cond_t *condition)
{
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(condition, &attributes);
    pthread_condattr_destroy(&attributes);
}

enum err team_new(struct team **out, unsigned workers, struct fault *fault)
{
    struct team *team = mem_new(sizeof *team);
    *out = team;
    if (!team)
        return fault_memory(fault, "threads");
    team->spins = count_cores() < workers ? 0 : SPINS;
    pthread_mutex_init(&team->lock, NULL);
    pthread_cond_init(&team->begins, NULL);
    pthread_cond_init(&team->ended, NULL);
    for (team->size = 1; team->size < workers && team->size < TEAM_MOST; team->size++) {
        struct worker *worker = team->worker + team->size;
        *worker = (struct worker){.team = team, .number = team->size};
        if (!thread_start(&worker->thread, work_on, worker))
            break;
    }
    return OK;
}

void team_free(struct team *team)
{
    if (!team)
        return;
    pthread_mutex_lock(&team->lock);
    team->is_ending = true;
    pthread_cond_broadcast(&team->begins);
    pthread_mutex_unlock(&team->lock);
    for (unsigned i = 1; i < team->size; i++)
        pthread_join(team->worker[i].thread, NULL);
    pthread_cond_destroy(&team->ended);
    pthread_cond_destroy(&team->begins);
    pthread_mutex_destroy(&team->lock);
    free(team);
}

void team_run(struct team *team, team_work *work, void *context)
{
    if (team_size(team) == 1) {
        work(context, 0);
        return;
    }
    pthread_mutex_lock(&team->lock);
    team->work = work;
    team->context = context;
    team->at_work = team->size - 1;
    team->piece++;
    pthread_cond_broadcast(&team->begins);
    pthread_mutex_unlock(&team->lock);
    work(context, 0);
    pthread_mutex_lock(&team->lock);
    while (team->at_work > 0)
        pthread_cond_wait(&team->ended, &team->lock);
    pthread_mutex_unlock(&team->lock);
}

static inline void pause_briefly(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

void team_wait(struct team *team)
{
    if (team_size(team) == 1)
        return;
    const unsigned meeting = atomic_load_explicit(&team->meeting, memory_order_relaxed);
    if (atomic_fetch_add_explicit(&team->arrived, 1, memory_order_acq_rel) + 1 == team->size) {
        atomic_store_explicit(&team->arrived, 0, memory_order_relaxed);
        atomic_store_explicit(&team->meeting, meeting + 1, memory_order_release);
        return;
    }
    for (unsigned spins = 0; atomic_load_explicit(&team->meeting, memory_order_acquire) == meeting;
         spins++)
        if (spins < team->spins)
            pause_briefly();
        else
            sched_yield();
}

struct share team_share(const struct team *team, unsigned worker, size_t count)
{
    const size_t size = team_size(team), each = count / size, left = count % size;
    const size_t first = worker * each + (worker < left ? worker : left);
    return (struct share){first, first + each + (worker < left)};
}
