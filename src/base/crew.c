#include "base/crew.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/mem.h"

enum {
    SPINS = 4000, /* some microseconds: longer than most levels of a forest */
    WORKERS_UNASKED = 8,
};

struct worker {
    struct crew *crew;
    unsigned number;
    pthread_t thread;
};

struct crew {
    unsigned size;
    struct worker worker[CREW_MOST]; /* [0] is the caller and has no thread */

    /* crew_wait: the last to arrive opens the gate by counting `meeting` up. */
    atomic_uint arrived, meeting;

    /* Work is handed out, and its end told, under the lock. */
    pthread_mutex_t lock;
    pthread_cond_t begins, ended;
    crew_work *work;
    void *context;
    unsigned piece;   /* counts the pieces of work */
    unsigned at_work; /* threads that have not ended this piece */
    bool leaves;
};

unsigned crew_size_wanted(void)
{
    const char *text = getenv("IFTTY_THREADS");
    char *end;
    const unsigned long asked = text ? strtoul(text, &end, 10) : 0;
    if (text && *text && *end == '\0' && asked >= 1 && asked <= CREW_MOST)
        return (unsigned)asked;
    cpu_set_t cores;
    if (sched_getaffinity(0, sizeof cores, &cores) != 0)
        return 1;
    const unsigned count = (unsigned)CPU_COUNT(&cores);
    return count < WORKERS_UNASKED ? count : WORKERS_UNASKED;
}

unsigned crew_size(const struct crew *crew)
{
    return crew ? crew->size : 1;
}

static void *live(void *argument)
{
    const struct worker *worker = argument;
    struct crew *crew = worker->crew;
    unsigned done = 0;
    pthread_mutex_lock(&crew->lock);
    for (;;) {
        while (crew->piece == done && !crew->leaves)
            pthread_cond_wait(&crew->begins, &crew->lock);
        if (crew->leaves)
            break;
        done = crew->piece;
        pthread_mutex_unlock(&crew->lock);
        crew->work(crew->context, worker->number);
        pthread_mutex_lock(&crew->lock);
        if (--crew->at_work == 0)
            pthread_cond_signal(&crew->ended);
    }
    pthread_mutex_unlock(&crew->lock);
    return NULL;
}

enum err crew_new(struct crew **out, unsigned workers, struct fault *fault)
{
    struct crew *crew = mem_new(sizeof *crew);
    *out = crew;
    if (!crew)
        return fault_memory(fault, "threads");
    pthread_mutex_init(&crew->lock, NULL);
    pthread_cond_init(&crew->begins, NULL);
    pthread_cond_init(&crew->ended, NULL);
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    for (crew->size = 1; crew->size < workers && crew->size < CREW_MOST; crew->size++) {
        struct worker *worker = crew->worker + crew->size;
        *worker = (struct worker){.crew = crew, .number = crew->size};
        if (pthread_create(&worker->thread, NULL, live, worker) != 0)
            break;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return OK;
}

void crew_free(struct crew *crew)
{
    if (!crew)
        return;
    pthread_mutex_lock(&crew->lock);
    crew->leaves = true;
    pthread_cond_broadcast(&crew->begins);
    pthread_mutex_unlock(&crew->lock);
    for (unsigned i = 1; i < crew->size; i++)
        pthread_join(crew->worker[i].thread, NULL);
    pthread_cond_destroy(&crew->ended);
    pthread_cond_destroy(&crew->begins);
    pthread_mutex_destroy(&crew->lock);
    free(crew);
}

void crew_run(struct crew *crew, crew_work *work, void *context)
{
    if (crew_size(crew) == 1) {
        work(context, 0);
        return;
    }
    pthread_mutex_lock(&crew->lock);
    crew->work = work;
    crew->context = context;
    crew->at_work = crew->size - 1;
    crew->piece++;
    pthread_cond_broadcast(&crew->begins);
    pthread_mutex_unlock(&crew->lock);
    work(context, 0);
    pthread_mutex_lock(&crew->lock);
    while (crew->at_work > 0)
        pthread_cond_wait(&crew->ended, &crew->lock);
    pthread_mutex_unlock(&crew->lock);
}

static inline void breathe(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

void crew_wait(struct crew *crew)
{
    if (crew_size(crew) == 1)
        return;
    const unsigned meeting = atomic_load_explicit(&crew->meeting, memory_order_relaxed);
    if (atomic_fetch_add_explicit(&crew->arrived, 1, memory_order_acq_rel) + 1 == crew->size) {
        atomic_store_explicit(&crew->arrived, 0, memory_order_relaxed);
        atomic_store_explicit(&crew->meeting, meeting + 1, memory_order_release);
        return;
    }
    for (unsigned spins = 0; atomic_load_explicit(&crew->meeting, memory_order_acquire) == meeting;
         spins++)
        if (spins < SPINS)
            breathe();
        else
            sched_yield();
}

struct share crew_share(const struct crew *crew, unsigned worker, size_t count)
{
    const size_t size = crew_size(crew), each = count / size, left = count % size;
    const size_t first = worker * each + (worker < left ? worker : left);
    return (struct share){first, first + each + (worker < left)};
}
