#include "image/press.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "base/mem.h"
#include "image/helper.h"

enum { LOOK_MS = 100 };

struct order {
    struct order *next;
    char *path;
    enum file_mode mode;
    struct picture picture;
};

struct press {
    struct image_helper *helper; /* the thread's alone, until it has ended */
    pthread_t thread;
    int descriptor;

    pthread_mutex_t lock; /* of everything below */
    pthread_cond_t given, done;
    struct order *first, **last; /* those that wait */
    struct order *current;
    unsigned waiting;
    bool leaves;
    struct buf news;
};

/* ---- orders ---- */

bool press_takes(const char *path)
{
    return file_is_named(path, ".exr|.png|.tif|.tiff|.jpg|.jpeg|.gif|.bmp|.tga|.ppm");
}

enum err press_order(struct order **out, const char *path, enum file_mode mode,
                     struct picture *picture, struct fault *fault)
{
    struct buf draft = {0};
    *out = NULL;
    enum err err = file_draft(&draft, path, mode, fault);
    buf_release(&draft);
    if (err)
        return err;
    struct order *order = calloc(1, sizeof *order);
    if (order)
        order->path = strdup(path);
    if (!order || !order->path) {
        free(order);
        return fault_memory(fault, "a picture");
    }
    order->mode = mode;
    order->picture = *picture;
    *picture = (struct picture){0};
    *out = order;
    return OK;
}

void order_free(struct order *order)
{
    if (!order)
        return;
    picture_release(&order->picture);
    free(order->path);
    free(order);
}

/* ---- the thread ---- */

/* Under the lock. A press without memory for its news says so with what it has left. */
static void tell(struct press *press, enum err err, const char *path, const struct fault *fault)
{
    const uint64_t one = 1;
    if (err) {
        buf_printf(&press->news, "error: %s\n", fault->text);
    } else {
        buf_add_text(&press->news, "wrote ");
        buf_add_safe(&press->news, path, strlen(path));
        buf_add_char(&press->news, '\n');
    }
    if (write(press->descriptor, &one, sizeof one) < 0)
        return; /* it counts to 2^64: whoever reads it has been told already */
}

/* Takes the next order off the queue; NULL where none waits. Under the lock. */
static struct order *take(struct press *press)
{
    struct order *order = press->first;
    if (!order)
        return NULL;
    press->first = order->next;
    if (!press->first)
        press->last = &press->first;
    press->waiting--;
    return order;
}

static void *work(void *argument)
{
    struct press *press = argument;
    pthread_mutex_lock(&press->lock);
    for (;;) {
        while (!press->first && !press->leaves)
            pthread_cond_wait(&press->given, &press->lock);
        struct order *order = take(press);
        if (!order)
            break;
        press->current = order;
        pthread_cond_broadcast(&press->done); /* there is room */
        pthread_mutex_unlock(&press->lock);
        struct fault fault = {0};
        enum err err =
            image_write(press->helper, order->path, order->mode, &order->picture, &fault);
        pthread_mutex_lock(&press->lock);
        tell(press, err, order->path, &fault);
        press->current = NULL;
        order_free(order);
        pthread_cond_broadcast(&press->done);
    }
    pthread_mutex_unlock(&press->lock);
    return NULL;
}

/* Signals are for the thread that began the press. */
static int begin_thread(struct press *press)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int number = pthread_create(&press->thread, NULL, work, press);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return number;
}

static void discard(struct press *press)
{
    if (press->descriptor >= 0)
        close(press->descriptor);
    image_helper_free(press->helper);
    buf_release(&press->news);
    free(press);
}

enum err press_new(struct press **out, const char *program, struct fault *fault)
{
    pthread_condattr_t monotonic;
    struct press *press = calloc(1, sizeof *press);
    *out = NULL;
    if (!press)
        return fault_memory(fault, "writing beside the session");
    press->last = &press->first;
    press->descriptor = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    enum err err = image_helper_new(&press->helper, program, fault);
    if (err || press->descriptor < 0) {
        discard(press);
        return err ? err : fault_set(fault, ERR_IO, "no descriptor is left for the news");
    }
    pthread_mutex_init(&press->lock, NULL);
    pthread_cond_init(&press->given, NULL);
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&press->done, &monotonic);
    pthread_condattr_destroy(&monotonic);
    if (begin_thread(press) != 0) {
        discard(press);
        return fault_set(fault, ERR_IO, "no thread can be had to write beside the session");
    }
    *out = press;
    return OK;
}

void press_free(struct press *press)
{
    if (!press)
        return;
    pthread_mutex_lock(&press->lock);
    press->leaves = true;
    pthread_cond_signal(&press->given);
    pthread_mutex_unlock(&press->lock);
    pthread_join(press->thread, NULL);
    pthread_cond_destroy(&press->given);
    pthread_cond_destroy(&press->done);
    pthread_mutex_destroy(&press->lock);
    discard(press);
}

/* ---- from outside ---- */

void press_give(struct press *press, struct order *order)
{
    pthread_mutex_lock(&press->lock);
    while (press->waiting >= PRESS_WAITING_MOST)
        pthread_cond_wait(&press->done, &press->lock);
    order->next = NULL;
    *press->last = order;
    press->last = &order->next;
    press->waiting++;
    pthread_cond_signal(&press->given);
    pthread_mutex_unlock(&press->lock);
}

bool press_holds(struct press *press, const char *path)
{
    pthread_mutex_lock(&press->lock);
    bool holds = press->current && strcmp(press->current->path, path) == 0;
    for (const struct order *order = press->first; order && !holds; order = order->next)
        holds = strcmp(order->path, path) == 0;
    pthread_mutex_unlock(&press->lock);
    return holds;
}

/* What waits will not be written. Under the lock. */
static void give_up(struct press *press)
{
    struct fault fault;
    for (struct order *order; (order = take(press)) != NULL; order_free(order)) {
        fault_set(&fault, ERR_CANCELLED, "cancelled: %s was not written", order->path);
        tell(press, ERR_CANCELLED, order->path, &fault);
    }
}

static void wait_a_moment(struct press *press)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += LOOK_MS * 1000000L;
    until.tv_sec += until.tv_nsec / 1000000000L;
    until.tv_nsec %= 1000000000L;
    pthread_cond_timedwait(&press->done, &press->lock, &until);
}

enum err press_wait(struct press *press, struct watch *watch, struct fault *fault)
{
    bool stopped = false;
    pthread_mutex_lock(&press->lock);
    while (press->first || press->current) {
        wait_a_moment(press);
        pthread_mutex_unlock(&press->lock);
        stopped = stopped || watch_look(watch, "writing pictures", 0, 0);
        pthread_mutex_lock(&press->lock);
        if (stopped)
            give_up(press);
    }
    pthread_mutex_unlock(&press->lock);
    return stopped ? watch_fault(watch, fault) : OK;
}

void press_news(struct press *press, struct buf *out)
{
    uint64_t count;
    pthread_mutex_lock(&press->lock);
    if (read(press->descriptor, &count, sizeof count) < 0)
        count = 0; /* nothing new */
    buf_add(out, buf_text(&press->news), press->news.length);
    if (press->news.failed)
        buf_add_text(out, "error: out of memory for what became of a picture\n");
    buf_release(&press->news);
    pthread_mutex_unlock(&press->lock);
}

int press_descriptor(const struct press *press)
{
    return press->descriptor;
}
