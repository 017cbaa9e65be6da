/* SPDX-License-Identifier: MIT */
#include "base/file_log.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/file_lock.h"
#include "base/mem.h"
#include "base/team.h"

struct file_log {
    int fd;
    char *path;
    dev_t device; /* with `inode`: the file, whatever it is called */
    ino_t inode;
    enum file_sync sync;
    struct file_lock file_lock;       /* G4 */
    bool is_ragged;                   /* G1 */
    struct timespec written, changed; /* its times after the last write of ours */

    pthread_mutex_t lock; /* of what follows: the thread reads and writes it too */
    pthread_cond_t stirs; /* something waits to be synced, or the thread is to leave */
    uint64_t length, synced;
    bool is_in_doubt; /* G3 */
    bool leaves;
    bool has_thread;
    pthread_t thread;
};

/* ---- syncing ---- */

/* Syncs and notes how far that went. The lock is held at call and return, not while it lasts. */
static bool sync_now(struct file_log *log)
{
    const uint64_t length = log->length;
    pthread_mutex_unlock(&log->lock);
    const bool fine = file_step_sync(log->fd, log->path);
    const int number = errno;
    pthread_mutex_lock(&log->lock);
    if (!fine)
        log->is_in_doubt = true;
    else if (!log->is_in_doubt && length <= log->length)
        log->synced = length > log->synced ? length : log->synced;
    errno = number;
    return fine && !log->is_in_doubt;
}

static bool has_work(const struct file_log *log)
{
    return log->synced < log->length && !log->is_in_doubt;
}

/* The thread: a second after something was appended, it is synced with whatever followed it. */
static void *sync_every_second(void *argument)
{
    struct file_log *log = argument;
    pthread_mutex_lock(&log->lock);
    while (!log->leaves) {
        struct timespec until;
        int waited = 0;
        if (!has_work(log)) {
            pthread_cond_wait(&log->stirs, &log->lock);
            continue;
        }
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_sec += 1;
        while (!log->leaves && waited != ETIMEDOUT)
            waited = pthread_cond_timedwait(&log->stirs, &log->lock, &until);
        if (!log->leaves && has_work(log))
            sync_now(log);
    }
    pthread_mutex_unlock(&log->lock);
    return NULL;
}

static enum err start_thread(struct file_log *log, struct fault *fault)
{
    log->leaves = false;
    log->has_thread = thread_start(&log->thread, sync_every_second, log);
    return log->has_thread ? OK : fault_errno(fault, "start a thread that syncs", log->path);
}

static void stop_thread(struct file_log *log)
{
    if (!log->has_thread)
        return;
    pthread_mutex_lock(&log->lock);
    log->leaves = true;
    pthread_cond_signal(&log->stirs);
    pthread_mutex_unlock(&log->lock);
    pthread_join(log->thread, NULL);
    log->has_thread = false;
}

enum err file_log_sync(struct file_log *log, struct fault *fault)
{
    pthread_mutex_lock(&log->lock);
    if (log->is_in_doubt)
        errno = EIO;
    const bool fine = !log->is_in_doubt && (log->synced == log->length || sync_now(log));
    const int number = errno;
    pthread_mutex_unlock(&log->lock);
    errno = number;
    return fine ? OK : fault_errno(fault, "sync", log->path);
}

bool file_log_is_in_doubt(struct file_log *log)
{
    pthread_mutex_lock(&log->lock);
    const bool doubt = log->is_in_doubt;
    pthread_mutex_unlock(&log->lock);
    return doubt;
}

enum err file_log_set_sync(struct file_log *log, enum file_sync sync, struct fault *fault)
{
    enum err err = OK;
    if (sync == FILE_SYNC_ALWAYS)
        err = file_log_sync(log, fault);
    if (!err && sync == FILE_SYNC_EVERY_SECOND && !log->has_thread)
        err = start_thread(log, fault);
    if (err)
        return err;
    if (sync == FILE_SYNC_OFF)
        stop_thread(log);
    log->sync = sync;
    return OK;
}

/* ---- opening ---- */

/* The file that is open becomes ours. */
static enum err take(struct file_log *log, struct fault *fault)
{
    struct stat status;
    const char *path = log->path;
    if (fstat(log->fd, &status) != 0)
        return fault_errno(fault, "open", path);
    if (!S_ISREG(status.st_mode))
        return fault_set(fault, ERR_IO, "%s is not a regular file", path);
    const enum err held = file_lock_take(&log->file_lock, log->fd, path, fault);
    if (held)
        return held;
    if (fstat(log->fd, &status) != 0) /* again: it may have grown until it was ours */
        return fault_errno(fault, "open", path);
    log->device = status.st_dev;
    log->inode = status.st_ino;
    log->length = (uint64_t)status.st_size;
    file_log_note_times(log);
    return OK;
}

enum err file_log_open(struct file_log **out, const char *path, bool create, struct fault *fault)
{
    struct file_log *log = mem_new(sizeof *log);
    *out = NULL;
    if (!log || !(log->path = strdup(path))) {
        free(log);
        return fault_memory(fault, path);
    }
    pthread_mutex_init(&log->lock, NULL);
    thread_condition_init(&log->stirs);
    enum err err = OK;
    log->fd = file_step_open(path, create ? O_RDWR | O_CREAT | O_EXCL : O_RDWR | O_NONBLOCK);
    if (log->fd < 0 && create && errno == EEXIST) {
        err = fault_set(fault, ERR_IO, "%s exists already and was left alone", path);
    } else if (log->fd < 0 && !create && (errno == EACCES || errno == EROFS || errno == EPERM)) {
        fault_errno(fault, "write to", path);
        err = fault_prefix(fault, ERR_IO, "--read-only opens it for looking");
    } else if (log->fd < 0) {
        err = fault_errno(fault, create ? "create" : "open", path);
    }
    const bool is_made = !err && create;
    if (!err)
        err = take(log, fault);
    if (is_made && !err)
        err = file_log_sync_folder(log, fault);
    if (!err)
        err = file_log_sync(log, fault);
    if (err && is_made)
        file_discard(path); /* no empty file stays */
    if (err)
        file_log_close(log);
    else
        *out = log;
    return err;
}

enum err file_log_sync_folder(const struct file_log *log, struct fault *fault)
{
    return file_step_sync_folder(log->path) ? OK
                                            : fault_errno(fault, "sync the folder of", log->path);
}

/* ---- writing ---- */

/* G2. Only a name that leads to the file makes it worth writing to. */
static enum err find_in_place(const struct file_log *log, struct fault *fault)
{
    struct stat there;
    if (stat(log->path, &there) != 0)
        return errno == ENOENT || errno == ENOTDIR
                   ? fault_set(fault, ERR_IO, "%s is gone: it was deleted or moved away", log->path)
                   : fault_errno(fault, "look for", log->path);
    if (there.st_dev != log->device || there.st_ino != log->inode)
        return fault_set(fault, ERR_IO, "%s was replaced: another file has its name now",
                         log->path);
    if ((uint64_t)there.st_size != log->length)
        return fault_set(fault, ERR_IO,
                         "%s was changed by somebody else: it holds %lld bytes, %llu were written",
                         log->path, (long long)there.st_size, (unsigned long long)log->length);
    return OK;
}

static bool is_same_time(const struct timespec *a, const struct timespec *b)
{
    return a->tv_sec == b->tv_sec && a->tv_nsec == b->tv_nsec;
}

bool file_log_was_touched(const struct file_log *log)
{
    struct stat status;
    return fstat(log->fd, &status) != 0 || !is_same_time(&status.st_mtim, &log->written) ||
           !is_same_time(&status.st_ctim, &log->changed);
}

void file_log_note_times(struct file_log *log)
{
    struct stat status;
    if (fstat(log->fd, &status) != 0)
        return;
    log->written = status.st_mtim;
    log->changed = status.st_ctim;
}

static void set_length(struct file_log *log, uint64_t length)
{
    file_log_note_times(log);
    pthread_mutex_lock(&log->lock);
    log->length = length;
    log->synced = log->synced < length ? log->synced : length;
    pthread_cond_signal(&log->stirs);
    pthread_mutex_unlock(&log->lock);
}

static void note_synced(struct file_log *log)
{
    file_log_note_times(log);
    pthread_mutex_lock(&log->lock);
    log->is_in_doubt = false;
    log->synced = log->length;
    pthread_mutex_unlock(&log->lock);
}

/* A sync has failed: the system may have forgotten what waited for one. */
static void doubt_what_waits(struct file_log *log)
{
    pthread_mutex_lock(&log->lock);
    log->is_in_doubt = log->is_in_doubt || log->synced < log->length;
    pthread_mutex_unlock(&log->lock);
}

enum err file_log_cut(struct file_log *log, uint64_t length, struct fault *fault)
{
    if (!file_step_cut(log->fd, log->path, length))
        return fault_errno(fault, "cut", log->path);
    if (!file_step_sync(log->fd, log->path)) {
        doubt_what_waits(log);
        return fault_errno(fault, "cut", log->path);
    }
    set_length(log, length);
    log->is_ragged = false;
    return OK;
}

enum err file_log_append(struct file_log *log, const void *bytes, size_t length, bool may_wait,
                         struct fault *fault)
{
    const bool always = log->sync == FILE_SYNC_ALWAYS;
    const bool waits = always && may_wait && (log->has_thread || start_thread(log, NULL) == OK);
    const bool syncs = always && !waits;
    enum err err = find_in_place(log, fault);
    if (!err && (log->is_ragged || file_log_is_in_doubt(log)))
        err = fault_set(fault, ERR_IO, "%s is not mended after a failure", log->path);
    if (err)
        return err;
    /* Bytes that were not there before: a sync that fails takes nothing with it but them and what
     * waits. */
    if (lseek(log->fd, (off_t)log->length, SEEK_SET) >= 0 &&
        file_step_write(log->fd, log->path, bytes, length) &&
        (!syncs || file_step_sync(log->fd, log->path))) {
        set_length(log, log->length + length);
        if (syncs)
            note_synced(log);
        return OK;
    }
    err = fault_errno(fault, "append to", log->path);
    log->is_ragged = true;
    if (syncs)
        doubt_what_waits(log);
    if (file_log_cut(log, log->length, NULL) != OK)
        fault_prefix(fault, err, "what was refused may still stand at its end");
    return err;
}

bool file_log_is_ragged(const struct file_log *log)
{
    return log->is_ragged;
}

enum err file_log_rewrite(struct file_log *log, const char *bytes, struct fault *fault)
{
    enum err err = find_in_place(log, fault);
    pthread_mutex_lock(&log->lock);
    const uint64_t from = log->synced;
    pthread_mutex_unlock(&log->lock);
    if (err)
        return err;
    if (lseek(log->fd, (off_t)from, SEEK_SET) < 0 ||
        !file_step_write(log->fd, log->path, bytes + from, (size_t)(log->length - from)) ||
        !file_step_sync(log->fd, log->path))
        return fault_errno(fault, "write again what could not be synced of", log->path);
    note_synced(log);
    return OK;
}

const char *file_log_lock_file(const struct file_log *log)
{
    return log->file_lock.path;
}

uint64_t file_log_length(const struct file_log *log)
{
    return log->length;
}

void file_log_close(struct file_log *log)
{
    if (!log)
        return;
    stop_thread(log);
    if (log->fd >= 0 && log->synced < log->length)
        file_log_sync(log, NULL);
    if (log->fd >= 0)
        close(log->fd);
    file_lock_release(&log->file_lock);
    pthread_cond_destroy(&log->stirs);
    pthread_mutex_destroy(&log->lock);
    free(log->path);
    free(log);
}
