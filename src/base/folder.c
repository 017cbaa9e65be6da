#include "base/folder.h"

#include <dirent.h>
#include <ftw.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file_draft.h"

enum { COPY_BYTES_MOST = 1 << 30 };

static bool is_regular(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0 && S_ISREG(status.st_mode);
}

static void join(struct buf *out, const char *folder, const char *name)
{
    buf_clear(out);
    buf_printf(out, "%s/%s", folder, name);
}

static enum err copy_one(const char *from, const char *to, const char *name, struct fault *fault)
{
    struct buf source = {0}, target = {0}, bytes = {0};
    enum err err = OK;
    join(&source, from, name);
    join(&target, to, name);
    if (source.failed || target.failed)
        err = fault_memory(fault, "a path");
    else if (is_regular(buf_text(&source)))
        err = file_read(&bytes, buf_text(&source), COPY_BYTES_MOST, fault);
    if (!err && bytes.data)
        err = file_write(buf_text(&target), bytes.data, bytes.length, FILE_KEEP, fault);
    buf_release(&source);
    buf_release(&target);
    buf_release(&bytes);
    return err;
}

static enum err copy_all(const char *from, const char *to, struct fault *fault)
{
    enum err err = OK;
    DIR *folder = opendir(from);
    if (!folder)
        return fault_errno(fault, "open", from);
    for (struct dirent *entry; !err && (entry = readdir(folder));)
        if (*entry->d_name != '.')
            err = copy_one(from, to, entry->d_name, fault);
    closedir(folder);
    return err;
}

enum err folder_make_private(const char *path, struct fault *fault)
{
    struct buf part = {0};
    enum err err = OK;
    for (size_t at = 0; !err && path[at];) {
        at += strspn(path + at, "/");
        at += strcspn(path + at, "/");
        buf_clear(&part);
        buf_add(&part, path, at);
        if (part.failed)
            err = fault_memory(fault, "a path");
        else if (mkdir(buf_text(&part), 0700) != 0 && !file_is_folder(buf_text(&part)))
            err = fault_errno(fault, "make the folder", buf_text(&part));
    }
    buf_release(&part);
    return err;
}

enum err folder_copy(const char *from, const char *to, struct fault *fault)
{
    if (mkdir(to, 0777) != 0)
        return fault_errno(fault, "make the folder", to);
    enum err err = copy_all(from, to, fault);
    if (!err && !file_step_sync_folder(to))
        err = fault_errno(fault, "sync the folder of", to);
    if (err)
        folder_discard(to);
    return err;
}

void folder_discard(const char *path)
{
    struct buf name = {0};
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        join(&name, path, entry->d_name);
        if (!name.failed && is_regular(buf_text(&name)))
            unlink(buf_text(&name));
    }
    if (folder)
        closedir(folder);
    buf_release(&name);
    rmdir(path);
}

/* Where a process may only remove empty folders, it may not even try to unlink one. */
static int remove_one(const char *path, const struct stat *status, int type, struct FTW *where)
{
    (void)status, (void)where;
    return type == FTW_DP ? rmdir(path) : unlink(path);
}

void folder_remove(const char *path)
{
    enum { DESCRIPTORS = 8 };
    nftw(path, remove_one, DESCRIPTORS, FTW_DEPTH | FTW_PHYS | FTW_MOUNT);
}

static const char *usual_place(void)
{
    const char *usual = getenv("TMPDIR");
    return usual && *usual ? usual : "/tmp";
}

enum err folder_passing(struct buf *path, const char *below, struct fault *fault)
{
    return file_draft_folder(path, below ? below : usual_place(), fault);
}

enum err folder_held(struct buf *path, struct fault *fault)
{
    return file_hold_folder(path, usual_place(), fault);
}

enum err folder_fresh(struct buf *path, const char *below, struct fault *fault)
{
    below = below ? below : usual_place();
    buf_clear(path);
    buf_printf(path, "%s/iftty-XXXXXX", below);
    if (path->failed)
        return fault_memory(fault, "a path");
    if (mkdtemp(path->data))
        return OK;
    const enum err err = fault_errno(fault, "make a folder below", below);
    buf_clear(path);
    return err;
}
