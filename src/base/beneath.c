/* SPDX-License-Identifier: MIT */
#include "base/beneath.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

bool beneath_without_openat2;

bool beneath_is_inside(const char *name)
{
    if (*name == '/' || *name == '\0')
        return false;
    for (const char *at = name; *at; at += strcspn(at, "/"), at += *at == '/')
        if (strncmp(at, "..", 2) == 0 && (at[2] == '/' || at[2] == '\0'))
            return false;
    return true;
}

/* Without openat2: every step by itself, and no link is followed at all. */
static int open_stepwise(int folder, const char *name)
{
    struct stat status;
    char step[256];
    int at = dup(folder);
    while (at >= 0 && *name) {
        const size_t n = strcspn(name, "/");
        int next = -1;
        if (n >= sizeof step) {
            errno = ENAMETOOLONG;
        } else {
            memcpy(step, name, n);
            step[n] = '\0';
            next = openat(at, n ? step : ".", O_PATH | O_CLOEXEC | O_NOFOLLOW);
            if (name[n] && next >= 0 && fstat(next, &status) == 0 && S_ISLNK(status.st_mode)) {
                close(next);
                next = -1;
                errno = ELOOP;
            }
        }
        const int number = errno;
        close(at);
        errno = number;
        at = next;
        name += n + (name[n] == '/');
    }
    return at;
}

static enum beneath judge(int fd)
{
    struct stat status;
    if (fd < 0)
        return errno == EXDEV || errno == ELOOP ? BENEATH_OUTSIDE : BENEATH_MISSING;
    if (fstat(fd, &status) != 0)
        return BENEATH_MISSING;
    if (S_ISLNK(status.st_mode)) /* only where none is followed */
        return BENEATH_OUTSIDE;
    return S_ISREG(status.st_mode)   ? BENEATH_FINE
           : S_ISDIR(status.st_mode) ? BENEATH_FOLDER
                                     : BENEATH_NO_FILE;
}

enum beneath beneath_look(const char *folder, const char *name)
{
    if (!beneath_is_inside(name))
        return BENEATH_OUTSIDE;
    const int at = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (at < 0)
        return BENEATH_MISSING;
    /* Opened without side effects: O_PATH touches no device and waits for no pipe. */
    const struct open_how how = {.flags = O_PATH | O_CLOEXEC,
                                 .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
    errno = ENOSYS;
    int fd = beneath_without_openat2 ? -1 : (int)syscall(SYS_openat2, at, name, &how, sizeof how);
    if (fd < 0 && (errno == ENOSYS || errno == EPERM || errno == EINVAL))
        fd = open_stepwise(at, name);
    const enum beneath answer = judge(fd);
    if (fd >= 0)
        close(fd);
    close(at);
    return answer;
}
