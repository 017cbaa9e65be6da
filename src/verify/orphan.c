/* SPDX-License-Identifier: MIT */
#include "verify/orphan.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "command/files.h"
#include "command/golden_judge.h"
#include "image/exr.h"
#include "journal/golden.h"
#include "journal/journal.h"

struct search {
    const struct interpreter *interp;
    const char *journal;
    struct buf folder, path;
    struct buf bytes;  /* of the journal, once they are asked for */
    struct buf *lines; /* or NULL */
};

/* One that is nothing is named, and counts for nothing. */
static bool is_leftover(struct search *search, const char *name)
{
    struct buf *path = &search->path;
    buf_clear(path);
    buf_printf(path, "%s/%s", buf_text(&search->folder), name);
    if (!search->lines || path->failed ||
        interpreter_may_read(search->interp, buf_text(path), NULL) ||
        (!search->bytes.length &&
         file_read(&search->bytes, search->journal, JOURNAL_BYTES_MAX, NULL)) ||
        !golden_is_leftover(buf_text(path), search->journal, buf_text(&search->bytes),
                            search->bytes.length))
        return false;
    buf_add_text(search->lines, "# ");
    buf_add_safe_text(search->lines, buf_text(path));
    buf_add_text(search->lines, " was passed over: its command was ended before it was recorded; "
                                "continuing the journal removes it\n");
    return true;
}

/* A PNG shows something that nothing was compared with, unless a golden image lies beside it, which
 * is asked for it. */
static bool is_lone_png(struct search *search, const char *name)
{
    struct buf *path = &search->path;
    if (!file_is_named(name, ".png"))
        return false;
    buf_clear(path);
    buf_printf(path, "%s/%s", buf_text(&search->folder), name);
    if (path->failed)
        return true;
    memcpy(path->data + path->length - 3, "exr", 3);
    return !file_exists(buf_text(path));
}

enum err orphan_find(struct name_list *orphans, const struct interpreter *interp,
                     const char *journal_path, struct buf *lines, struct fault *fault)
{
    struct search search = {.interp = interp, .journal = journal_path, .lines = lines};
    *orphans = (struct name_list){0};
    enum err err = golden_folder(&search.folder, journal_path, fault);
    const bool is_there = !err && file_is_folder(buf_text(&search.folder));
    DIR *folder = is_there ? opendir(buf_text(&search.folder)) : NULL;
    if (is_there && !folder)
        err = fault_errno(fault, "read", buf_text(&search.folder));
    for (const struct dirent *entry; folder && !err && (entry = readdir(folder));) {
        const char *name = entry->d_name;
        if (*name == '.')
            continue;
        const bool is_orphan = exr_is_named(name) ? !golden_is_named(&interp->goldens, name) &&
                                                        !is_leftover(&search, name)
                                                  : is_lone_png(&search, name);
        if (is_orphan && !name_list_add(orphans, name))
            err = fault_memory(fault, "names of files");
    }
    if (folder)
        closedir(folder);
    name_list_sort(orphans);
    buf_release(&search.folder);
    buf_release(&search.path);
    buf_release(&search.bytes);
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
            "orphan golden image: the journal names no %s, which is in %s%s; iftty verify "
            "--remove-orphans deletes it, or make it again by `golden`",
            orphans->name[0], buf_text(&path), orphans->count > 1 ? ", and others" : "");
    buf_release(&path);
    return err;
}

enum err orphan_check(const struct interpreter *interp, const char *journal_path, struct buf *lines,
                      struct fault *fault)
{
    struct name_list orphans;
    enum err err = orphan_find(&orphans, interp, journal_path, lines, fault);
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
    const bool is_png = file_is_named(orphan, ".png");
    if (*orphan == '.' || strchr(orphan, '/') || !(is_png || exr_is_named(orphan)))
        return fault_set(fault, ERR_INPUT, "%s is the name of no golden image", orphan);
    enum err err = golden_folder(&path, journal_path, fault);
    buf_printf(&path, "/%s", orphan);
    if (!err)
        err = path.failed ? fault_memory(fault, "a path") : remove_file(buf_text(&path), fault);
    if (!err && !is_png) {
        memcpy(path.data + path.length - 3, "png", 3);
        err = remove_file(buf_text(&path), fault);
    }
    buf_release(&path);
    return err;
}
