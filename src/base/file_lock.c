/* SPDX-License-Identifier: MIT */
#include "base/file_lock.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/owner.h"

enum { LOCK_BYTES_MOST = 4096, POLL_MS = 10 };

/* ---- who holds the system's lock ---- */

/*
 * Who holds the lock is asked of the kernel at the moment it matters, so that a crash leaves
 * nothing stale: a note in a file beside it would outlive its writer.
 */

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

/* Adds "process 4711 (iftty)" where a process of this machine holds an exclusive flock on the file,
 * which is a line "1: FLOCK  ADVISORY  WRITE 4711 08:02:131187 0 EOF" of /proc/locks. False where
 * none can be found: another machine on a shared disk, another container, a system without that. */
static bool find_holder(struct buf *out, const struct stat *status)
{
    char line[256];
    bool found = false;
    FILE *locks = fopen("/proc/locks", "re");
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
    if (locks)
        fclose(locks);
    return found;
}

/* ---- where the system has none ---- */

/* "5b1f0e3c2a79d04-4d2-1a2b3c", a line feed, "process 1234 on the machine porto" */
static enum err write_lock_file(const char *path, struct fault *fault)
{
    struct buf text = {0};
    struct utsname names = {0};
    uname(&names);
    owner_write(&text);
    buf_printf(&text, "\nprocess %ld on the machine ", (long)getpid());
    buf_add_safe_text(&text, names.nodename);
    buf_add_char(&text, '\n');
    const enum err err = text.failed ? fault_memory(fault, "a lock")
                                     : file_write(path, text.data, text.length, FILE_KEEP, fault);
    buf_release(&text);
    return err;
}

/* Whether the text is that of a lock whose process has ended. */
static bool is_stale(const struct buf *text)
{
    const char *at = buf_text(text);
    enum owner_state state;
    return owner_read(&at, &state) && *at == '\n' && state == OWNER_IS_GONE;
}

/* Takes a stale lock away: under a name of its own first, since another process may do the same,
 * and have made its own lock meanwhile, which gets its name back. */
static void take_away(const char *path)
{
    struct buf aside = {0}, text = {0};
    if (file_draft(&aside, path, FILE_REPLACE, NULL) == OK && rename(path, buf_text(&aside)) == 0) {
        if (file_read(&text, buf_text(&aside), LOCK_BYTES_MOST, NULL) == OK && is_stale(&text))
            file_discard(buf_text(&aside));
        else
            file_publish(buf_text(&aside), path, FILE_KEEP, NULL);
    }
    buf_release(&aside);
    buf_release(&text);
}

static enum err take_lock_file(struct file_lock *lock, const char *path, struct fault *fault)
{
    struct buf name = {0}, text = {0}, who = {0};
    enum err err = OK;
    buf_printf(&name, "%s.lock", path);
    const char *at = buf_text(&name);
    if (name.failed)
        err = fault_memory(fault, "a lock");
    else if (file_exists(at) && file_read(&text, at, LOCK_BYTES_MOST, NULL) == OK &&
             is_stale(&text))
        take_away(at);
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
            "%s stands for one; where that session has ended, delete it; --read-only opens "
            "the journal for looking",
            path, who.length ? buf_text(&who) : "an unknown process", at);
    }
    buf_release(&who);
    buf_release(&name);
    buf_release(&text);
    return err;
}

/* ---- either ---- */

static bool lock_now(int fd, const char *path)
{
    return !file_step_fails(FILE_STEP_LOCK, path) && flock(fd, LOCK_EX | LOCK_NB) == 0;
}

enum err file_lock_take(struct file_lock *lock, int fd, const char *path, struct fault *fault)
{
    const struct timespec moment = {.tv_nsec = POLL_MS * 1000000L};
    struct stat status;
    bool is_ours = lock_now(fd, path);
    for (int ms = 0; !is_ours && errno == EWOULDBLOCK && ms < FILE_LOCK_PATIENCE_MS;
         ms += POLL_MS) {
        nanosleep(&moment, NULL);
        is_ours = lock_now(fd, path);
    }
    if (is_ours)
        return OK;
    if (errno == ENOLCK || errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL)
        return take_lock_file(lock, path, fault);
    if (errno != EWOULDBLOCK || fstat(fd, &status) != 0)
        return fault_errno(fault, "lock", path);
    struct buf holder = {0};
    const bool known = find_holder(&holder, &status);
    fault_set(fault, ERR_IO,
              "%s is being written by another session%s%s; it is unchanged, and --read-only opens "
              "it for looking",
              path, known ? ", " : "", known ? buf_text(&holder) : "");
    buf_release(&holder);
    return ERR_IO;
}

void file_lock_release(struct file_lock *lock)
{
    if (lock->path)
        file_discard(lock->path);
    free(lock->path);
    lock->path = NULL;
}
