/* SPDX-License-Identifier: MIT */
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
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/team.h"

unsigned file_lines_patience_ms = 3000;

enum { LOCK_PAUSE_US = 1000, REPLACED_MOST = 100 };

/* Give up at `deadline`, since a stopped process may hold the lock for any time. */
static bool lock_until(int fd, const char *path, uint64_t deadline)
{
    while (file_step_fails(FILE_STEP_LOCK, path) || flock(fd, LOCK_EX | LOCK_NB) != 0) {
        if ((errno != EWOULDBLOCK && errno != EINTR) || clock_ns() >= deadline)
            return false;
        usleep(LOCK_PAUSE_US);
    }
    return true;
}

static bool is_at_path(int fd, const char *path)
{
    struct stat here, there;
    return fstat(fd, &here) == 0 && stat(path, &there) == 0 && here.st_ino == there.st_ino &&
           here.st_dev == there.st_dev;
}

/* Open the file that is at the path once the lock is held; after the deadline, without the lock. */
static enum err open_locked(int *fd, bool *is_locked, const char *path, int flags,
                            uint64_t deadline, struct fault *fault)
{
    uint64_t bytes;
    for (;;) {
        TRY(file_open(fd, &bytes, path, flags, fault));
        *is_locked = lock_until(*fd, path, deadline);
        if (is_at_path(*fd, path) || clock_ns() >= deadline)
            return OK;
        file_release(fd);
    }
}

static uint64_t deadline_from_now(void)
{
    return clock_ns() + file_lines_patience_ms * UINT64_C(1000000);
}

static enum err append_to(int fd, const char *path, const char *text, size_t length,
                          struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0};
    char last = '\n';
    const off_t end = lseek(fd, 0, SEEK_END);
    if (end > 0 && pread(fd, &last, 1, end - 1) == 1 && last != '\n')
        buf_add_char(&bytes, '\n');
    buf_add(&bytes, text, length);
    buf_add_char(&bytes, '\n');
    if (bytes.failed)
        return fault_memory(fault, "a line");
    return file_step_write(fd, path, bytes.data, bytes.length) ? OK
                                                               : fault_errno(fault, "write", path);
}

/* Without the lock, a trimming process may have read the file to its end before this write and
 * replaced it (copy_late_lines): then the line is written again. */
enum err file_lines_append(const char *path, const char *line, size_t length, struct fault *fault)
{
    const uint64_t deadline = deadline_from_now();
    for (int i = 0; i < REPLACED_MOST; i++) {
        bool is_locked;
        OWNED(file_release) int fd = -1;
        TRY(open_locked(&fd, &is_locked, path, O_RDWR | O_APPEND | O_CREAT, deadline, fault));
        TRY(append_to(fd, path, line, length, fault));
        if (is_at_path(fd, path))
            return OK;
    }
    return fault_set(fault, ERR_IO, "%s is replaced all the time", path);
}

/* Read at most `most` bytes from offset `from` on. */
static enum err read_from(struct buf *out, int fd, off_t from, size_t most, const char *path,
                          struct fault *fault)
{
    char *room = buf_reserve(out, most + 1);
    if (!room)
        return fault_memory(fault, "lines");
    const ssize_t length = file_read_at(fd, room, most, (uint64_t)from);
    if (length < 0)
        return fault_errno(fault, "read", path);
    out->length += (size_t)length;
    out->data[out->length] = '\0';
    return OK;
}

/* Read the whole lines among the last `bytes_most` bytes before `end`. */
static enum err read_tail(struct buf *out, int fd, off_t end, size_t bytes_most, const char *path,
                          struct fault *fault)
{
    const bool whole = end <= (off_t)bytes_most;
    buf_clear(out);
    if (end < 0)
        return fault_errno(fault, "read", path);
    TRY(read_from(out, fd, whole ? 0 : end - (off_t)bytes_most, whole ? (size_t)end : bytes_most,
                  path, fault));
    if (whole || out->length == 0)
        return OK;
    const char *feed = memchr(out->data, '\n', out->length);
    const size_t skip = feed ? (size_t)(feed - out->data) + 1 : out->length;
    memmove(out->data, out->data + skip, out->length - skip + 1);
    out->length -= skip;
    return OK;
}

enum err file_lines_read(struct buf *out, const char *path, size_t bytes_most, struct fault *fault)
{
    uint64_t bytes;
    OWNED(file_release) int fd = -1;
    buf_clear(out);
    if (!file_exists(path))
        return OK;
    TRY(file_open(&fd, &bytes, path, O_RDONLY, fault));
    return read_tail(out, fd, (off_t)bytes, bytes_most, path, fault);
}

const char *file_lines_last(const char *text, size_t length, size_t lines)
{
    const char *at = text + length;
    for (size_t n = 0; at > text; at--)
        if (at[-1] == '\n' && at < text + length && ++n == lines)
            break;
    return at;
}

static enum err write_anew(const char *path, const struct buf *tail, size_t lines_most,
                           struct fault *fault)
{
    const char *text = buf_text(tail), *last = file_lines_last(text, tail->length, lines_most);
    OWNED(mem_release) char *real = realpath(path, NULL); /* keep a link */
    const mode_t before = umask(0077);
    const enum err err =
        real ? file_write(real, last, tail->length - (size_t)(last - text), FILE_REPLACE, fault)
             : fault_errno(fault, "find", path);
    umask(before);
    return err;
}

/* Copy lines that were appended to the old file without the lock after it was read. */
static enum err copy_late_lines(int fd, off_t from, const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf late = {0};
    const off_t end = lseek(fd, 0, SEEK_END);
    TRY(end > from ? read_from(&late, fd, from, (size_t)(end - from), path, fault) : OK);
    while (late.length > 0 && late.data[late.length - 1] == '\n')
        late.length--;
    return late.length ? file_lines_append(path, late.data, late.length, fault) : OK;
}

enum err file_lines_trim(const char *path, size_t lines_most, size_t bytes_most,
                         struct fault *fault)
{
    OWNED(file_lock_release) struct file_lock instead = {0};
    OWNED(buf_release) struct buf tail = {0};
    OWNED(file_release) int fd = -1; /* also releases the lock */
    bool is_locked;
    if (!file_exists(path))
        return OK;
    TRY(open_locked(&fd, &is_locked, path, O_RDWR, deadline_from_now(), fault));
    is_locked = is_locked || file_lock_take(&instead, fd, path, NULL) == OK; /* I5 */
    if (!is_locked || !is_at_path(fd, path))
        return OK;
    const off_t end = lseek(fd, 0, SEEK_END);
    TRY(read_tail(&tail, fd, end, bytes_most, path, fault));
    const char *text = buf_text(&tail);
    if (end <= (off_t)bytes_most && file_lines_last(text, tail.length, lines_most) == text)
        return OK;
    TRY(write_anew(path, &tail, lines_most, fault));
    return copy_late_lines(fd, end, path, fault);
}

enum { LOCK_BYTES_MOST = 4096 };

/* ---- who holds the system's lock ---- */

/*
 * The kernel is asked for the holder of a lock when it is needed: a note in another file would
 * outlive its writer after a crash.
 */

/* Compare with the descriptors of a process, if they are readable: on layered file systems they
 * match stat, but /proc/locks does not. */
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
        has = stat(path, &found) == 0 && found.st_dev == status->st_dev &&
              found.st_ino == status->st_ino;
    }
    closedir(folder);
    return has;
}

static void add_process(struct buf *out, long process)
{
    char path[64], name[64];
    buf_printf(out, "process %ld", process);
    snprintf(path, sizeof path, "/proc/%ld/comm", process);
    OWNED(stream_release) FILE *file = fopen(path, "re");
    if (file && fgets(name, sizeof name, file)) {
        buf_add_text(out, " (");
        buf_add_safe(out, name, strcspn(name, "\n"));
        buf_add_char(out, ')');
    }
}

/* Append "process 4711 (iftty)" if a process of this machine holds an exclusive flock on the file,
 * according to a line "1: FLOCK ADVISORY WRITE 4711 08:02:131187 0 EOF" of /proc/locks. False if
 * none is found: another machine on a shared disk, another container, a system without /proc. */
static bool find_holder(struct buf *out, const struct stat *status)
{
    char line[256];
    bool found = false;
    OWNED(stream_release) FILE *locks = fopen("/proc/locks", "re");
    while (locks && !found && fgets(line, sizeof line, locks)) {
        unsigned major_number, minor_number;
        unsigned long inode;
        long process;
        if (sscanf(line, "%*d: FLOCK ADVISORY WRITE %ld %x:%x:%lu", &process, &major_number,
                   &minor_number, &inode) != 4 ||
            process <= 0)
            continue;
        found =
            (makedev(major_number, minor_number) == status->st_dev && inode == status->st_ino) ||
            process_has_open(process, status);
        if (found)
            add_process(out, process);
    }
    return found;
}

/* ---- where the system has none ---- */

/* "5b1f0e3c2a79d04-4d2-1a2b3c", a line feed, "process 1234 on the machine porto" */
static enum err write_lock_file(const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0};
    struct utsname names = {0};
    uname(&names);
    owner_write(&text);
    buf_printf(&text, "\nprocess %ld on the machine ", (long)getpid());
    buf_add_safe_text(&text, names.nodename);
    buf_add_char(&text, '\n');
    return text.failed ? fault_memory(fault, "a lock")
                       : file_write(path, text.data, text.length, FILE_KEEP, fault);
}

/* Return true if this is the text of a lock whose process has ended. */
static bool is_stale(const struct buf *text)
{
    const char *at = buf_text(text);
    enum owner_state state;
    return owner_read(&at, &state) && *at == '\n' && state == OWNER_IS_GONE;
}

/* Remove a stale lock. It is renamed first, since another process may do the same and have created
 * its own lock meanwhile, which is then renamed back. */
static void remove_stale_lock(const char *path)
{
    OWNED(buf_release) struct buf aside = {0}, text = {0};
    if (file_draft(&aside, path, FILE_REPLACE, NULL) == OK && rename(path, buf_text(&aside)) == 0) {
        if (file_read(&text, buf_text(&aside), LOCK_BYTES_MOST, NULL) == OK && is_stale(&text))
            file_discard(buf_text(&aside));
        else
            file_publish(buf_text(&aside), path, FILE_KEEP, NULL);
    }
}

static enum err take_lock_file(struct file_lock *lock, const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf name = {0}, text = {0}, who = {0};
    enum err err = OK;
    buf_printf(&name, "%s.lock", path);
    const char *at = buf_text(&name);
    if (name.failed)
        err = fault_memory(fault, "a lock");
    else if (file_exists(at) && file_read(&text, at, LOCK_BYTES_MOST, NULL) == OK &&
             is_stale(&text))
        remove_stale_lock(at);
    if (!err)
        err = write_lock_file(at, fault);
    if (!err) {
        lock->path = strdup(at);
        err = lock->path ? OK : fault_memory(fault, "a lock");
        if (err)
            file_discard(at);
    } else if (file_read(&text, at, LOCK_BYTES_MOST, NULL) == OK) {
        const char *line = strchr(buf_text(&text), '\n');
        if (line)
            buf_add_safe(&who, line + 1, strcspn(line + 1, "\n"));
        err = fault_set(
            fault, ERR_IO,
            "%s is being written by another session, by %s: its file system has no locks, and "
            "%s serves as one; delete it if that session has ended; --read-only opens the "
            "journal for looking",
            path, who.length ? buf_text(&who) : "an unknown process", at);
    }
    return err;
}

/* ---- either ---- */

enum err file_lock_take(struct file_lock *lock, int fd, const char *path, struct fault *fault)
{
    struct stat status;
    if (lock_until(fd, path, clock_ns() + FILE_LOCK_PATIENCE_MS * UINT64_C(1000000)))
        return OK;
    if (errno == ENOLCK || errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL)
        return take_lock_file(lock, path, fault);
    if (errno != EWOULDBLOCK || fstat(fd, &status) != 0)
        return fault_errno(fault, "lock", path);
    OWNED(buf_release) struct buf holder = {0};
    const bool known = find_holder(&holder, &status);
    fault_set(fault, ERR_IO,
              "%s is being written by another session%s%s; it is unchanged, and --read-only opens "
              "it for looking",
              path, known ? ", " : "", known ? buf_text(&holder) : "");
    return ERR_IO;
}

void file_lock_release(struct file_lock *lock)
{
    if (lock->path)
        file_discard(lock->path);
    free(lock->path);
    lock->path = NULL;
}

struct file_log {
    int fd;
    char *path;
    dev_t device; /* with `inode`: identifies the file under any name */
    ino_t inode;
    enum file_sync sync;
    struct file_lock file_lock;       /* G4 */
    bool is_ragged;                   /* G1 */
    struct timespec written, changed; /* times of the file after our last write */

    pthread_mutex_t lock; /* protects the members below, which the thread uses too */
    pthread_cond_t wake;  /* bytes wait to be synced, or the thread has to end */
    uint64_t length, synced;
    bool is_in_doubt; /* G3 */
    bool is_ending;
    bool has_thread;
    pthread_t thread;
};

/* ---- syncing ---- */

/* Sync, and note the synced length. The lock is held on entry and return, but not during the sync.
 * */
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

/* The thread: one second after an append, sync all bytes written so far. */
static void *sync_every_second(void *argument)
{
    struct file_log *log = argument;
    pthread_mutex_lock(&log->lock);
    while (!log->is_ending) {
        struct timespec until;
        int waited = 0;
        if (!has_work(log)) {
            pthread_cond_wait(&log->wake, &log->lock);
            continue;
        }
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_sec += 1;
        while (!log->is_ending && waited != ETIMEDOUT)
            waited = pthread_cond_timedwait(&log->wake, &log->lock, &until);
        if (!log->is_ending && has_work(log))
            sync_now(log);
    }
    pthread_mutex_unlock(&log->lock);
    return NULL;
}

static enum err start_thread(struct file_log *log, struct fault *fault)
{
    log->is_ending = false;
    log->has_thread = thread_start(&log->thread, sync_every_second, log);
    return log->has_thread ? OK : fault_errno(fault, "start a thread that syncs", log->path);
}

static void stop_thread(struct file_log *log)
{
    if (!log->has_thread)
        return;
    pthread_mutex_lock(&log->lock);
    log->is_ending = true;
    pthread_cond_signal(&log->wake);
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
    if (sync == FILE_SYNC_ALWAYS)
        TRY(file_log_sync(log, fault));
    if (sync == FILE_SYNC_EVERY_SECOND && !log->has_thread)
        TRY(start_thread(log, fault));
    if (sync == FILE_SYNC_OFF)
        stop_thread(log);
    log->sync = sync;
    return OK;
}

/* ---- opening ---- */

/* Lock the open file and record its identity and length. */
static enum err adopt_file(struct file_log *log, struct fault *fault)
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
    if (fstat(log->fd, &status) != 0) /* again: it may have grown before it was locked */
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
    thread_condition_init(&log->wake);
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
        err = adopt_file(log, fault);
    if (is_made && !err)
        err = file_sync_folder(path, fault);
    if (!err)
        err = file_log_sync(log, fault);
    if (err && is_made)
        file_discard(path); /* leave no empty file behind */
    if (err)
        file_log_close(log);
    else
        *out = log;
    return err;
}

/* ---- writing ---- */

/* G2. Refuse to write to a file that its name no longer leads to. */
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
        return fault_set(
            fault, ERR_IO,
            "%s was changed by another process: it holds %lld bytes, %llu were written", log->path,
            (long long)there.st_size, (unsigned long long)log->length);
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
    pthread_cond_signal(&log->wake);
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

/* A sync has failed: the system may have forgotten bytes that waited for one. */
static void doubt_unsynced_bytes(struct file_log *log)
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
        doubt_unsynced_bytes(log);
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
    TRY(find_in_place(log, fault));
    if (log->is_ragged || file_log_is_in_doubt(log))
        return fault_set(fault, ERR_IO, "%s has not been repaired after a failure", log->path);
    /* The bytes are new to the file: a failed sync loses only them and earlier unsynced bytes. */
    if (lseek(log->fd, (off_t)log->length, SEEK_SET) >= 0 &&
        file_step_write(log->fd, log->path, bytes, length) &&
        (!syncs || file_step_sync(log->fd, log->path))) {
        set_length(log, log->length + length);
        if (syncs)
            note_synced(log);
        return OK;
    }
    enum err err = fault_errno(fault, "append to", log->path);
    log->is_ragged = true;
    if (syncs)
        doubt_unsynced_bytes(log);
    if (file_log_cut(log, log->length, NULL) != OK)
        fault_prefix(fault, err, "refused bytes may remain at its end");
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
    pthread_cond_destroy(&log->wake);
    pthread_mutex_destroy(&log->lock);
    free(log->path);
    free(log);
}
