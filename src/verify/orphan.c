#include "verify/orphan.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

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

static enum err look_through(struct name_list *orphans, DIR *folder, const struct buf *named,
                             struct fault *fault)
{
    const struct dirent *entry;
    while ((entry = readdir(folder))) {
        const char *name = entry->d_name;
        if (*name != '.' && exr_is_named(name) && !is_named(named, name) &&
            !name_list_add(orphans, name))
            return fault_memory(fault, "names of files");
    }
    name_list_sort(orphans);
    return OK;
}

enum err orphan_find(struct name_list *orphans, const char *journal_path, const struct buf *named,
                     struct fault *fault)
{
    struct buf path = {0};
    *orphans = (struct name_list){0};
    enum err err = golden_folder(&path, journal_path, fault);
    if (!err && file_is_folder(buf_text(&path))) {
        DIR *folder = opendir(buf_text(&path));
        err = folder ? look_through(orphans, folder, named, fault)
                     : fault_errno(fault, "read", buf_text(&path));
        if (folder)
            closedir(folder);
    }
    buf_release(&path);
    return err;
}

enum err orphan_judge(const struct name_list *orphans, const char *journal_path,
                      struct fault *fault)
{
    struct buf path = {0};
    if (!orphans->count)
        return OK;
    enum err err = golden_folder(&path, journal_path, fault);
    if (!err)
        err = fault_set(
            fault, ERR_CHECK,
            "orphan golden image: the journal names no %s, which is in %s%s; `golden` that was "
            "killed leaves one: iftty verify --remove-orphans deletes it, or make it again",
            orphans->name[0], buf_text(&path), orphans->count > 1 ? ", and others" : "");
    buf_release(&path);
    return err;
}

enum err orphan_check(const char *journal_path, const struct buf *named, struct fault *fault)
{
    struct name_list orphans;
    enum err err = orphan_find(&orphans, journal_path, named, fault);
    if (!err)
        err = orphan_judge(&orphans, journal_path, fault);
    name_list_release(&orphans);
    return err;
}

static enum err remove_file(const char *path, struct fault *fault)
{
    return unlink(path) == 0 || errno == ENOENT ? OK : fault_errno(fault, "remove", path);
}

enum err orphan_remove(const char *journal_path, const char *orphan, struct fault *fault)
{
    struct buf path = {0};
    if (*orphan == '.' || strchr(orphan, '/') || !exr_is_named(orphan))
        return fault_set(fault, ERR_INPUT, "%s is the name of no golden image", orphan);
    enum err err = golden_folder(&path, journal_path, fault);
    buf_printf(&path, "/%s", orphan);
    if (!err)
        err = path.failed ? fault_memory(fault, "a path") : remove_file(buf_text(&path), fault);
    if (!err) {
        memcpy(path.data + path.length - 3, "png", 3);
        err = remove_file(buf_text(&path), fault);
    }
    buf_release(&path);
    return err;
}
