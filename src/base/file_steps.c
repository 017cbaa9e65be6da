#include "base/file_steps.h"

#include <errno.h>
#include <fcntl.h>
#include <unistd.h>

#include "base/file.h"

int (*file_step_hook)(enum file_step step, const char *path);

bool file_step_fails(enum file_step step, const char *path)
{
    int number = file_step_hook ? file_step_hook(step, path) : 0;
    if (number)
        errno = number;
    return number != 0;
}

int file_step_open(const char *path, int flags)
{
    if (file_step_fails(FILE_STEP_OPEN, path))
        return -1;
    int fd;
    do
        fd = open(path, flags | O_CLOEXEC | O_NOCTTY, 0666);
    while (fd < 0 && errno == EINTR);
    return fd;
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
