#include "base/file_lines.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/file_steps.h"

enum { LOCK_TRIES = 50, LOCK_PAUSE_MS = 10, OPEN_TRIES = 20 };

/* Does not wait for the other end of a pipe, as one may lie there. */
static enum err open_regular(int *fd, const char *path, int flags, struct fault *fault)
{
    struct stat status;
    if (file_step_fails(FILE_STEP_OPEN, path))
        return fault_errno(fault, "open", path);
    *fd = open(path, flags | O_CLOEXEC | O_NOCTTY | O_NONBLOCK, 0600);
    if (*fd < 0)
        return fault_errno(fault, "open", path);
    if (fstat(*fd, &status) == 0 && S_ISREG(status.st_mode))
        return OK;
    close(*fd);
    return fault_set(fault, ERR_INPUT, "%s is no regular file", path);
}

/* Somebody who was stopped may hold the lock for ever. */
static bool lock(int fd)
{
    for (int i = 0; i < LOCK_TRIES; i++) {
        if (flock(fd, LOCK_EX | LOCK_NB) == 0)
            return true;
        if (errno != EWOULDBLOCK && errno != EINTR)
            return false;
        poll(NULL, 0, LOCK_PAUSE_MS);
    }
    return false;
}

static bool is_at_path(int fd, const char *path)
{
    struct stat here, there;
    return fstat(fd, &here) == 0 && stat(path, &there) == 0 && here.st_ino == there.st_ino &&
           here.st_dev == there.st_dev;
}

/* The file that is at the path once the lock is held, or was not to be had. */
static enum err open_locked(int *fd, bool *is_locked, const char *path, int flags,
                            struct fault *fault)
{
    for (int i = 0;; i++) {
        enum err err = open_regular(fd, path, flags, fault);
        if (err)
            return err;
        *is_locked = lock(*fd);
        if (is_at_path(*fd, path) || i == OPEN_TRIES)
            return OK;
        close(*fd);
    }
}

static bool ends_in_a_line(int fd)
{
    char last;
    const off_t end = lseek(fd, 0, SEEK_END);
    return end <= 0 || pread(fd, &last, 1, end - 1) != 1 || last == '\n';
}

enum err file_lines_append(const char *path, const char *line, size_t length, struct fault *fault)
{
    struct buf bytes = {0};
    bool is_locked;
    int fd;
    enum err err = open_locked(&fd, &is_locked, path, O_RDWR | O_APPEND | O_CREAT, fault);
    if (err)
        return err;
    buf_add_text(&bytes, ends_in_a_line(fd) ? "" : "\n");
    buf_add(&bytes, line, length);
    buf_add_char(&bytes, '\n');
    if (bytes.failed)
        err = fault_memory(fault, "a line");
    else if (!file_step_write(fd, path, bytes.data, bytes.length))
        err = fault_errno(fault, "write", path);
    close(fd);
    buf_release(&bytes);
    return err;
}

/* Reads from `from` to the end, at most `most` bytes. */
static enum err read_from(struct buf *out, int fd, off_t from, size_t most, const char *path,
                          struct fault *fault)
{
    char *room = buf_reserve(out, most + 1);
    if (!room)
        return fault_memory(fault, "lines");
    size_t length = 0;
    while (length < most) {
        const ssize_t n = pread(fd, room + length, most - length, from + (off_t)length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return fault_errno(fault, "read", path);
        if (n == 0)
            break;
        length += (size_t)n;
    }
    out->length += length;
    out->data[out->length] = '\0';
    return OK;
}

/* What lies before the first whole line goes. */
static enum err read_tail(struct buf *out, int fd, size_t bytes_most, const char *path,
                          struct fault *fault)
{
    const off_t end = lseek(fd, 0, SEEK_END);
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
    int fd = -1;
    buf_clear(out);
    if (!file_exists(path))
        return OK;
    enum err err = open_regular(&fd, path, O_RDONLY, fault);
    if (err)
        return err;
    err = read_tail(out, fd, bytes_most, path, fault);
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

enum err file_lines_trim(const char *path, size_t lines_most, size_t bytes_most,
                         struct fault *fault)
{
    struct buf tail = {0};
    bool is_locked;
    int fd;
    if (!file_exists(path))
        return OK;
    enum err err = open_locked(&fd, &is_locked, path, O_RDWR, fault);
    if (err)
        return err;
    const bool is_long = lseek(fd, 0, SEEK_END) > (off_t)bytes_most;
    err = read_tail(&tail, fd, bytes_most, path, fault);
    const char *text = buf_text(&tail);
    if (!err && is_locked && (is_long || file_lines_last(text, tail.length, lines_most) > text))
        err = write_anew(path, &tail, lines_most, fault);
    close(fd); /* and with it the lock goes */
    buf_release(&tail);
    return err;
}
