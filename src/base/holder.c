#include "base/holder.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/sysmacros.h>

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

bool holder_find(struct buf *out, const struct stat *status)
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
