#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/file_draft.h"

/* ---- steps ---- */

enum { NUMBERED_MOST = 9999 }; /* files PATH.KIND-N */

int (*file_step_hook)(enum file_step step, const char *path);

bool file_step_fails(enum file_step step, const char *path)
{
    int number = file_step_hook ? file_step_hook(step, path) : 0;
    if (number)
        errno = number;
    return number != 0;
}

static int open_step(const char *path, int flags, mode_t mode)
{
    if (file_step_fails(FILE_STEP_OPEN, path))
        return -1;
    int fd;
    do
        fd = open(path, flags | O_CLOEXEC | O_NOCTTY, mode);
    while (fd < 0 && errno == EINTR);
    return fd;
}

int file_step_open(const char *path, int flags)
{
    return open_step(path, flags, 0666);
}

bool file_step_write(int fd, const char *path, const char *bytes, size_t length)
{
    while (length > 0) {
        if (file_step_fails(FILE_STEP_WRITE, path))
            return false;
        ssize_t n = write(fd, bytes, length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return false;
        bytes += n;
        length -= (size_t)n;
    }
    return true;
}

bool file_step_sync(int fd, const char *path)
{
    return !file_step_fails(FILE_STEP_SYNC, path) && fdatasync(fd) == 0;
}

bool file_step_sync_folder(const char *path)
{
    struct buf folder = {0};
    file_folder(&folder, path);
    int fd = -1;
    if (folder.failed)
        errno = ENOMEM;
    else
        fd = file_step_open(buf_text(&folder), O_RDONLY | O_DIRECTORY);
    bool fine = fd >= 0 && !file_step_fails(FILE_STEP_SYNC_FOLDER, path) &&
                (fsync(fd) == 0 || errno == EINVAL);
    if (fd >= 0)
        close(fd);
    buf_release(&folder);
    return fine;
}

bool file_step_cut(int fd, const char *path, uint64_t length)
{
    return !file_step_fails(FILE_STEP_CUT, path) && ftruncate(fd, (off_t)length) == 0;
}

/* ---- whole files ---- */

enum err file_open(int *fd, uint64_t *bytes, const char *path, int flags, struct fault *fault)
{
    struct stat status;
    *fd = open_step(path, flags | O_NONBLOCK, 0600);
    if (*fd < 0)
        return fault_errno(fault, "open", path);
    if (fstat(*fd, &status) == 0 && S_ISREG(status.st_mode)) {
        *bytes = (uint64_t)status.st_size;
        return OK;
    }
    close(*fd);
    *fd = -1;
    return fault_set(fault, ERR_INPUT, "%s is not a regular file", path);
}

ssize_t file_read_at(int fd, void *to, size_t length, uint64_t from)
{
    size_t done = 0;
    while (done < length) {
        const ssize_t n = pread(fd, (char *)to + done, length - done, (off_t)(from + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return -1;
        if (n == 0)
            break;
        done += (size_t)n;
    }
    return (ssize_t)done;
}

enum err file_read(struct buf *out, const char *path, size_t limit, struct fault *fault)
{
    const size_t piece = 65536;
    uint64_t bytes;
    int fd;
    buf_clear(out);
    enum err err = file_open(&fd, &bytes, path, O_RDONLY, fault);
    if (err)
        return err;
    for (ssize_t n = (ssize_t)piece; !err && n == (ssize_t)piece;) {
        char *place = buf_reserve(out, piece);
        n = place ? file_read_at(fd, place, piece, out->length) : 0;
        if (!place)
            err = fault_memory(fault, path);
        else if (n < 0)
            err = fault_errno(fault, "read", path);
        else
            out->length += (size_t)n;
        if (!err && out->length > limit)
            err = fault_set(fault, ERR_LIMIT, "%s holds more than %zu bytes", path, limit);
    }
    if (!err)
        buf_add(out, "", 0);
    close(fd);
    return err;
}

static enum err write_draft(const char *draft, const char *path, const void *bytes, size_t length,
                            struct fault *fault)
{
    const int fd = file_step_open(draft, O_WRONLY | O_CREAT | O_EXCL);
    if (fd < 0)
        return fault_errno(fault, "write", path);
    const bool written = file_step_write(fd, path, bytes, length);
    const int number = errno;
    if (close(fd) == 0 && written)
        return OK;
    errno = written ? errno : number;
    file_discard(draft);
    return fault_errno(fault, "write", path);
}

enum err file_write(const char *path, const void *bytes, size_t length, enum file_mode mode,
                    struct fault *fault)
{
    struct buf draft = {0};
    enum err err = file_draft(&draft, path, mode, fault);
    if (!err)
        err = write_draft(buf_text(&draft), path, bytes, length, fault);
    if (!err)
        err = file_publish(buf_text(&draft), path, mode, fault);
    buf_release(&draft);
    return err;
}

enum err file_write_beside(struct buf *name, const char *path, const char *kind, const void *bytes,
                           size_t length, struct fault *fault)
{
    for (int n = 1; n <= NUMBERED_MOST; n++) {
        buf_clear(name);
        buf_printf(name, "%s.%s-%d", path, kind, n);
        if (name->failed)
            return fault_memory(fault, "a file name");
        if (!file_exists(buf_text(name)))
            return file_write(buf_text(name), bytes, length, FILE_KEEP, fault);
    }
    return fault_set(fault, ERR_IO, "there are %d files %s.%s-N already; %s is as it was",
                     NUMBERED_MOST, path, kind, path);
}

bool file_exists(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0;
}

bool file_begins_with(const char *path, const char *text)
{
    char start[64];
    const size_t length = strlen(text);
    uint64_t bytes;
    int fd;
    if (length > sizeof start || file_open(&fd, &bytes, path, O_RDONLY, NULL) != OK)
        return false;
    const bool begins =
        file_read_at(fd, start, length, 0) == (ssize_t)length && memcmp(start, text, length) == 0;
    close(fd);
    return begins;
}

bool file_is_folder(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

enum err file_make_folder(const char *path, struct fault *fault)
{
    if (mkdir(path, 0777) == 0)
        return file_step_sync_folder(path) ? OK : fault_errno(fault, "sync the folder of", path);
    if (errno == EEXIST && file_is_folder(path))
        return OK;
    return fault_errno(fault, "make the folder", path);
}

const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void file_folder(struct buf *out, const char *path)
{
    const char *slash = strrchr(path, '/');
    buf_clear(out);
    if (!slash)
        buf_add_text(out, ".");
    else
        buf_add(out, path, slash == path ? 1 : (size_t)(slash - path));
}

const char *file_ending(const char *path, const char *endings)
{
    const char *name = file_name(path);
    const size_t length = strlen(name);
    struct choice end;
    while (choice_next(&end, &endings))
        if (length > end.length &&
            strncasecmp(name + length - end.length, end.word, end.length) == 0)
            return name + length - end.length;
    return NULL;
}

bool file_is_named(const char *path, const char *endings)
{
    return file_ending(path, endings) != NULL;
}

bool file_is_from_home(const char *name)
{
    return strncmp(name, "~/", 2) == 0;
}

void file_from_home(struct buf *out, const char *name)
{
    const char *home = file_is_from_home(name) ? getenv("HOME") : NULL;
    buf_clear(out);
    if (home && *home)
        buf_add_text(out, home);
    buf_add_text(out, home && *home ? name + 1 : name);
}

bool file_is_same(const char *a, const char *b)
{
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

void file_real(struct buf *out, const char *path)
{
    struct stat status;
    char *real = lstat(path, &status) == 0 && S_ISLNK(status.st_mode) ? realpath(path, NULL) : NULL;
    buf_clear(out);
    buf_add_text(out, real ? real : path);
    free(real);
}

enum err file_program_folder(struct buf *out, struct fault *fault)
{
    char self[PATH_MAX];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length < 0)
        return fault_errno(fault, "find the folder of this program by", "/proc/self/exe");
    self[length] = '\0';
    file_folder(out, self);
    return out->failed ? fault_memory(fault, "a file name") : OK;
}
