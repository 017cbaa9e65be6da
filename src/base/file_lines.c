/* SPDX-License-Identifier: MIT */
#include "base/file_lines.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/file_log.h"

unsigned file_lines_patience_ms = 3000;

enum { LOCK_PAUSE_US = 1000, REPLACED_MOST = 100 };

/* A process that was stopped may hold the lock for any time, so this gives up at `deadline`. */
static bool lock(int fd, const char *path, uint64_t deadline)
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

/* The file that is at the path once the lock is held; from the deadline on, without the lock. */
static enum err open_locked(int *fd, bool *is_locked, const char *path, int flags,
                            uint64_t deadline, struct fault *fault)
{
    uint64_t bytes;
    for (;;) {
        enum err err = file_open(fd, &bytes, path, flags, fault);
        if (err)
            return err;
        *is_locked = lock(*fd, path, deadline);
        if (is_at_path(*fd, path) || clock_ns() >= deadline)
            return OK;
        close(*fd);
    }
}

static uint64_t deadline_from_now(void)
{
    return clock_ns() + file_lines_patience_ms * UINT64_C(1000000);
}

static enum err append_to(int fd, const char *path, const char *text, size_t length,
                          struct fault *fault)
{
    struct buf bytes = {0};
    enum err err = OK;
    char last = '\n';
    const off_t end = lseek(fd, 0, SEEK_END);
    if (end > 0 && pread(fd, &last, 1, end - 1) == 1 && last != '\n')
        buf_add_char(&bytes, '\n');
    buf_add(&bytes, text, length);
    buf_add_char(&bytes, '\n');
    if (bytes.failed)
        err = fault_memory(fault, "a line");
    else if (!file_step_write(fd, path, bytes.data, bytes.length))
        err = fault_errno(fault, "write", path);
    buf_release(&bytes);
    return err;
}

/* Without the lock a trimming process may have replaced the file before the write, and may have
 * read it to its end before that (copy_late_lines): then the line is written once more. */
enum err file_lines_append(const char *path, const char *line, size_t length, struct fault *fault)
{
    const uint64_t deadline = deadline_from_now();
    for (int i = 0; i < REPLACED_MOST; i++) {
        bool is_locked, is_there;
        int fd;
        enum err err =
            open_locked(&fd, &is_locked, path, O_RDWR | O_APPEND | O_CREAT, deadline, fault);
        if (err)
            return err;
        err = append_to(fd, path, line, length, fault);
        is_there = is_at_path(fd, path);
        close(fd);
        if (err || is_there)
            return err;
    }
    return fault_set(fault, ERR_IO, "%s is replaced all the time", path);
}

/* Reads from `from` to the end, at most `most` bytes. */
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

/* The lines among the last `bytes_most` bytes before `end`; what is before the first whole line is
 * left out. */
static enum err read_tail(struct buf *out, int fd, off_t end, size_t bytes_most, const char *path,
                          struct fault *fault)
{
    const bool whole = end <= (off_t)bytes_most;
    buf_clear(out);
    if (end < 0)
        return fault_errno(fault, "read", path);
    enum err err = read_from(out, fd, whole ? 0 : end - (off_t)bytes_most,
                             whole ? (size_t)end : bytes_most, path, fault);
    if (err || whole || out->length == 0)
        return err;
    const char *feed = memchr(out->data, '\n', out->length);
    const size_t skip = feed ? (size_t)(feed - out->data) + 1 : out->length;
    memmove(out->data, out->data + skip, out->length - skip + 1);
    out->length -= skip;
    return OK;
}

enum err file_lines_read(struct buf *out, const char *path, size_t bytes_most, struct fault *fault)
{
    uint64_t bytes;
    int fd;
    buf_clear(out);
    if (!file_exists(path))
        return OK;
    enum err err = file_open(&fd, &bytes, path, O_RDONLY, fault);
    if (err)
        return err;
    err = read_tail(out, fd, (off_t)bytes, bytes_most, path, fault);
    close(fd);
    return err;
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
    char *real = realpath(path, NULL); /* a link stays one */
    const mode_t before = umask(0077);
    const enum err err =
        real ? file_write(real, last, tail->length - (size_t)(last - text), FILE_REPLACE, fault)
             : fault_errno(fault, "find", path);
    umask(before);
    free(real);
    return err;
}

/* What was appended to the old file without the lock, after its lines were read. */
static enum err copy_late_lines(int fd, off_t from, const char *path, struct fault *fault)
{
    struct buf late = {0};
    const off_t end = lseek(fd, 0, SEEK_END);
    enum err err = OK;
    if (end > from)
        err = read_from(&late, fd, from, (size_t)(end - from), path, fault);
    while (late.length > 0 && late.data[late.length - 1] == '\n')
        late.length--;
    if (!err && late.length > 0)
        err = file_lines_append(path, late.data, late.length, fault);
    buf_release(&late);
    return err;
}

enum err file_lines_trim(const char *path, size_t lines_most, size_t bytes_most,
                         struct fault *fault)
{
    struct file_lock instead = {0};
    struct buf tail = {0};
    bool is_locked;
    int fd;
    if (!file_exists(path))
        return OK;
    enum err err = open_locked(&fd, &is_locked, path, O_RDWR, deadline_from_now(), fault);
    if (err)
        return err;
    is_locked = is_locked || file_lock_take(&instead, fd, path, NULL) == OK; /* I5 */
    if (is_locked && is_at_path(fd, path)) {
        const off_t end = lseek(fd, 0, SEEK_END);
        err = read_tail(&tail, fd, end, bytes_most, path, fault);
        const char *text = buf_text(&tail);
        if (!err &&
            (end > (off_t)bytes_most || file_lines_last(text, tail.length, lines_most) > text)) {
            err = write_anew(path, &tail, lines_most, fault);
            if (!err)
                err = copy_late_lines(fd, end, path, fault);
        }
        buf_release(&tail);
    }
    close(fd); /* and with it the lock goes */
    file_lock_release(&instead);
    return err;
}
