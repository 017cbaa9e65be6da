#include "verify/orphan.h"

#include <dirent.h>
#include <stdbool.h>
#include <string.h>

#include "base/file.h"
#include "image/exr.h"
#include "journal/golden.h"

/* Whether `file` is NAME.exr of a name among those given. */
static bool is_named(const struct buf *named, const char *file)
{
    const char *at = buf_text(named), *end = at + named->length;
    const size_t length = strlen(file) - strlen(".exr");
    for (; at < end; at += strlen(at) + 1)
        if (strlen(at) == length && strncmp(file, at, length) == 0 &&
            strcmp(file + length, ".exr") == 0)
            return true;
    return false;
}

/* The first in order, and how many. */
static size_t find_orphans(DIR *folder, const struct buf *named, struct buf *first)
{
    const struct dirent *entry;
    size_t found = 0;
    while ((entry = readdir(folder))) {
        const char *name = entry->d_name;
        if (*name == '.' || !exr_is_named(name) || is_named(named, name))
            continue;
        if (found++ && strcmp(name, buf_text(first)) > 0)
            continue;
        buf_clear(first);
        buf_add_text(first, name);
    }
    return found;
}

enum err orphan_check(const char *journal_path, const struct buf *named, struct fault *fault)
{
    struct buf path = {0}, first = {0};
    enum err err = golden_folder(&path, journal_path, fault);
    if (!err && file_is_folder(buf_text(&path))) {
        DIR *folder = opendir(buf_text(&path));
        const size_t found = folder ? find_orphans(folder, named, &first) : 0;
        if (!folder)
            err = fault_errno(fault, "read", buf_text(&path));
        else if (first.failed)
            err = fault_memory(fault, "a file name");
        else if (found)
            err = fault_set(
                fault, ERR_CHECK,
                "orphan golden image: the journal names no %s, which is in %s%s; `golden` "
                "that was killed leaves one: delete it, or make it again",
                buf_text(&first), buf_text(&path), found > 1 ? ", and others" : "");
        if (folder)
            closedir(folder);
    }
    buf_release(&first);
    buf_release(&path);
    return err;
}
