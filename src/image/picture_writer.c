/* SPDX-License-Identifier: MIT */
#include "image/picture_writer.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/team.h"
#include "image/image_helper.h"

enum { POLL_MS = 100 };

struct picture_job {
    struct picture_job *next;
    char *path;
    enum file_mode mode;
    struct picture picture;
};

struct picture_writer {
    struct image_helper *helper; /* the thread's alone, until it has ended */
    pthread_t thread;
    int descriptor;

    pthread_mutex_t lock; /* protects all following members */
    pthread_cond_t given, done;
    struct picture_job *first, **last; /* the queue */
    struct picture_job *current;
    unsigned waiting;
    bool leaves;
    struct buf news;
};

/* ---- jobs ---- */

bool picture_writer_takes(const char *path)
{
    return file_is_named(path, ".exr|.png|.tif|.tiff|.jpg|.jpeg|.gif|.bmp|.tga|.ppm");
}

enum err picture_job_new(struct picture_job **out, const char *path, enum file_mode mode,
                         struct picture *picture, struct fault *fault)
{
    *out = NULL;
    TRY(file_may_write(path, mode, fault));
    struct picture_job *job = calloc(1, sizeof *job);
    if (job)
        job->path = strdup(path);
    if (!job || !job->path) {
        free(job);
        return fault_memory(fault, "a picture");
    }
    job->mode = mode;
    job->picture = *picture;
    *picture = (struct picture){0};
    *out = job;
    return OK;
}

void picture_job_free(struct picture_job *job)
{
    if (!job)
        return;
    picture_release(&job->picture);
    free(job->path);
    free(job);
}

/* ---- the thread ---- */

/* Under the lock. */
static void report_outcome(struct picture_writer *writer, enum err err, const char *path,
                           const struct fault *fault)
{
    const uint64_t one = 1;
    if (err) {
        buf_printf(&writer->news, "error: %s\n", fault->text);
    } else {
        buf_add_text(&writer->news, "wrote ");
        buf_add_safe_text(&writer->news, path);
        buf_add_char(&writer->news, '\n');
    }
    if (write(writer->descriptor, &one, sizeof one) < 0)
        return; /* the counter is full, so it is readable already */
}

/* Remove the next job from the queue; NULL if it is empty. Under the lock. */
static struct picture_job *next_job(struct picture_writer *writer)
{
    struct picture_job *job = writer->first;
    if (!job)
        return NULL;
    writer->first = job->next;
    if (!writer->first)
        writer->last = &writer->first;
    writer->waiting--;
    return job;
}

static void *run_jobs(void *argument)
{
    struct picture_writer *writer = argument;
    pthread_mutex_lock(&writer->lock);
    for (;;) {
        while (!writer->first && !writer->leaves)
            pthread_cond_wait(&writer->given, &writer->lock);
        struct picture_job *job = next_job(writer);
        if (!job)
            break;
        writer->current = job;
        pthread_cond_broadcast(&writer->done); /* there is room */
        pthread_mutex_unlock(&writer->lock);
        struct fault fault = {0};
        enum err err = image_write(writer->helper, job->path, job->mode, &job->picture, &fault);
        pthread_mutex_lock(&writer->lock);
        report_outcome(writer, err, job->path, &fault);
        writer->current = NULL;
        picture_job_free(job);
        pthread_cond_broadcast(&writer->done);
    }
    pthread_mutex_unlock(&writer->lock);
    return NULL;
}

static void free_writer(struct picture_writer *writer)
{
    if (writer->descriptor >= 0)
        close(writer->descriptor);
    image_helper_free(writer->helper);
    buf_release(&writer->news);
    free(writer);
}

enum err picture_writer_new(struct picture_writer **out, const char *program)
{
    struct picture_writer *writer = calloc(1, sizeof *writer);
    *out = NULL;
    if (!writer)
        return ERR_MEMORY;
    writer->last = &writer->first;
    writer->descriptor = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    const enum err err = image_helper_new(&writer->helper, program, NULL);
    if (err || writer->descriptor < 0) {
        free_writer(writer);
        return err ? err : ERR_IO;
    }
    pthread_mutex_init(&writer->lock, NULL);
    pthread_cond_init(&writer->given, NULL);
    thread_condition_init(&writer->done);
    if (!thread_start(&writer->thread, run_jobs, writer)) {
        free_writer(writer);
        return ERR_IO;
    }
    *out = writer;
    return OK;
}

void picture_writer_free(struct picture_writer *writer)
{
    if (!writer)
        return;
    pthread_mutex_lock(&writer->lock);
    writer->leaves = true;
    pthread_cond_signal(&writer->given);
    pthread_mutex_unlock(&writer->lock);
    pthread_join(writer->thread, NULL);
    pthread_cond_destroy(&writer->given);
    pthread_cond_destroy(&writer->done);
    pthread_mutex_destroy(&writer->lock);
    free_writer(writer);
}

/* ---- from outside ---- */

void picture_writer_give(struct picture_writer *writer, struct picture_job *job)
{
    pthread_mutex_lock(&writer->lock);
    while (writer->waiting >= PICTURE_WRITER_WAITING_MOST)
        pthread_cond_wait(&writer->done, &writer->lock);
    job->next = NULL;
    *writer->last = job;
    writer->last = &job->next;
    writer->waiting++;
    pthread_cond_signal(&writer->given);
    pthread_mutex_unlock(&writer->lock);
}

bool picture_writer_holds(struct picture_writer *writer, const char *path)
{
    pthread_mutex_lock(&writer->lock);
    bool holds = writer->current && strcmp(writer->current->path, path) == 0;
    for (const struct picture_job *job = writer->first; job && !holds; job = job->next)
        holds = strcmp(job->path, path) == 0;
    pthread_mutex_unlock(&writer->lock);
    return holds;
}

enum err picture_writer_wait(struct picture_writer *writer, struct watch *watch)
{
    bool stopped = false;
    pthread_mutex_lock(&writer->lock);
    while (writer->first || writer->current) {
        struct timespec until;
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_nsec += POLL_MS * 1000000L;
        until.tv_sec += until.tv_nsec / 1000000000L;
        until.tv_nsec %= 1000000000L;
        pthread_cond_timedwait(&writer->done, &writer->lock, &until);
        pthread_mutex_unlock(&writer->lock);
        stopped = stopped || watch_poll(watch, "writing pictures", 0, 0);
        pthread_mutex_lock(&writer->lock);
        for (struct picture_job *job; stopped && (job = next_job(writer)); picture_job_free(job)) {
            struct fault cancelled;
            fault_set(&cancelled, ERR_CANCELLED, "cancelled: %s was not written", job->path);
            report_outcome(writer, ERR_CANCELLED, job->path, &cancelled);
        }
    }
    pthread_mutex_unlock(&writer->lock);
    return stopped ? watch_fault(watch, NULL) : OK;
}

void picture_writer_news(struct picture_writer *writer, struct buf *out)
{
    uint64_t count;
    pthread_mutex_lock(&writer->lock);
    if (read(writer->descriptor, &count, sizeof count) < 0)
        count = 0; /* nothing new */
    buf_add(out, buf_text(&writer->news), writer->news.length);
    if (writer->news.failed)
        buf_add_text(out, "error: out of memory for the outcome of a picture\n");
    buf_release(&writer->news);
    pthread_mutex_unlock(&writer->lock);
}

int picture_writer_descriptor(const struct picture_writer *writer)
{
    return writer->descriptor;
}
