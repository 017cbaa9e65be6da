#include "base/file_log.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <time.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/team.h"

struct file_log {
    int fd;
    char *path;
    dev_t device; /* with `inode`: the file, whatever it is called */
    ino_t inode;
    enum file_sync sync;
    bool is_ragged; /* G1 */

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

/*
 * Who holds the lock is asked of the kernel at the moment it matters, so that a crash leaves
 * nothing stale: a note in a file beside it would outlive its writer.
 */

/* One line of /proc/locks: "1: FLOCK  ADVISORY  WRITE 4711 08:02:131187 0 EOF". False for a lock of
 * another kind. */
static bool parse_lock(const char *line, long *process, struct stat *file)
{
    unsigned major_number, minor_number;
    unsigned long inode;
    if (sscanf(line, "%*d: FLOCK ADVISORY WRITE %ld %x:%x:%lu", process, &major_number,
               &minor_number, &inode) != 4)
        return false;
    file->st_dev = makedev(major_number, minor_number);
    file->st_ino = (ino_t)inode;
    return *process > 0;
}

static bool is_same_file(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* Layered file systems show other numbers in /proc/locks than stat does; the descriptors of the
 * process, where we may look at them, show the same. */
static bool process_has_open(long process, const struct stat *status)
{
    char path[64 + NAME_MAX];
    bool has = false;
    snprintf(path, sizeof path, "/proc/%ld/fd", process);
    DIR *folder = opendir(path);
    if (!folder)
        return false;
    const size_t length = strlen(path);
    for (struct dirent *entry; !has && (entry = readdir(folder));) {
        struct stat found;
        snprintf(path + length, sizeof path - length, "/%s", entry->d_name);
        has = stat(path, &found) == 0 && is_same_file(&found, status);
    }
    closedir(folder);
    return has;
}

static void add_process(struct buf *out, long process)
{
    char path[64], name[64];
    buf_printf(out, "process %ld", process);
    snprintf(path, sizeof path, "/proc/%ld/comm", process);
    FILE *file = fopen(path, "re");
    if (!file)
        return;
    if (fgets(name, sizeof name, file)) {
        buf_add_text(out, " (");
        buf_add_safe(out, name, strcspn(name, "\n"));
        buf_add_char(out, ')');
    }
    fclose(file);
}

/* Adds "process 4711 (iftty)" where a process of this machine holds an exclusive flock on the file.
 * False where none can be found: another machine on a shared disk, another container, a system
 * without /proc/locks. */
static bool find_holder(struct buf *out, const struct stat *status)
{
    char line[256];
    bool found = false;
    FILE *locks = fopen("/proc/locks", "re");
    while (locks && !found && fgets(line, sizeof line, locks)) {
        struct stat file = {0};
        long process;
        found = parse_lock(line, &process, &file) &&
                (is_same_file(&file, status) || process_has_open(process, status));
        if (found)
            add_process(out, process);
    }
    if (locks)
        fclose(locks);
    return found;
}

static enum err fault_held(const struct stat *status, const char *path, struct fault *fault)
{
    struct buf words = {0};
    const bool known = find_holder(&words, status);
    enum err err = fault_set(fault, ERR_IO,
                             "%s is being written by another session%s%s; it is unchanged, and "
                             "--read-only opens it for looking",
                             path, known ? ", " : "", known ? buf_text(&words) : "");
    buf_release(&words);
    return err;
}

static enum err take(struct file_log *log, bool create, struct fault *fault)
{
    struct stat status;
    const char *path = log->path;
    log->fd = file_step_open(path, create ? O_RDWR | O_CREAT | O_EXCL : O_RDWR | O_NONBLOCK);
    if (log->fd < 0 && create && errno == EEXIST)
        return fault_set(fault, ERR_IO, "%s exists already and was left alone", path);
    if (log->fd < 0 && !create && (errno == EACCES || errno == EROFS || errno == EPERM)) {
        enum err err = fault_errno(fault, "write to", path);
        return fault_prefix(fault, err, "--read-only opens it for looking");
    }
    if (log->fd < 0 || fstat(log->fd, &status) != 0)
        return fault_errno(fault, create ? "create" : "open", path);
    if (!S_ISREG(status.st_mode))
        return fault_set(fault, ERR_IO, "%s is not a regular file", path);
    if (flock(log->fd, LOCK_EX | LOCK_NB) != 0)
        return errno == EWOULDBLOCK ? fault_held(&status, path, fault)
                                    : fault_errno(fault, "lock", path);
    if (fstat(log->fd, &status) != 0) /* again: it may have grown until it was ours */
        return fault_errno(fault, "open", path);
    log->device = status.st_dev;
    log->inode = status.st_ino;
    log->length = (uint64_t)status.st_size;
    if (create && !file_step_sync_folder(path)) {
        enum err err = fault_errno(fault, "sync the folder of", path);
        unlink(path);
        return err;
    }
    return OK;
}

static struct file_log *log_new(const char *path)
{
    struct file_log *log = mem_new(sizeof *log);
    if (!log)
        return NULL;
    log->fd = -1;
    log->path = strdup(path);
    if (!log->path) {
        free(log);
        return NULL;
    }
    pthread_mutex_init(&log->lock, NULL);
    thread_condition_init(&log->stirs);
    return log;
}

enum err file_log_open(struct file_log **out, const char *path, bool create, struct fault *fault)
{
    struct file_log *log = log_new(path);
    *out = NULL;
    if (!log)
        return fault_memory(fault, path);
    enum err err = take(log, create, fault);
    if (!err)
        err = file_log_sync(log, fault);
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

static void set_length(struct file_log *log, uint64_t length)
{
    pthread_mutex_lock(&log->lock);
    log->length = length;
    log->synced = log->synced < length ? log->synced : length;
    pthread_cond_signal(&log->stirs);
    pthread_mutex_unlock(&log->lock);
}

static void note_synced(struct file_log *log)
{
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

/* Bytes that were not there before: a sync that fails takes nothing with it but them and what
 * waits. */
static bool add(struct file_log *log, const void *bytes, size_t length, bool syncs)
{
    return lseek(log->fd, (off_t)log->length, SEEK_SET) >= 0 &&
           file_step_write(log->fd, log->path, bytes, length) &&
           (!syncs || file_step_sync(log->fd, log->path));
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
    if (add(log, bytes, length, syncs)) {
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
    pthread_cond_destroy(&log->stirs);
    pthread_mutex_destroy(&log->lock);
    free(log->path);
    free(log);
}
