/* SPDX-License-Identifier: MIT */
#include "verify/orphan.h"

#include <dirent.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "command/golden_files.h"
#include "image/exr.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "sandbox/limits.h"
#include "show/export_picture.h"
#include "verify/evidence.h"

/* What may be taken for a picture of the journal by a person who looks into the folder. */
#define PICTURE_NAMES EXR_NAMES "|.png|.jpg|.jpeg|.tif|.tiff|.gif|.bmp|.webp"

static enum err open_files(struct golden_files *files, const char *journal, struct fault *fault)
{
    struct buf bytes = {0};
    enum err err = golden_files_open(files, journal, fault);
    if (!err && files->folder >= 0)
        err = file_read(&bytes, journal, JOURNAL_BYTES_MAX, fault);
    if (!err && files->folder >= 0)
        err = golden_files_read(files, buf_text(&bytes), bytes.length, fault);
    buf_release(&bytes);
    return err;
}

/* ---- what is passed over ---- */

/* The PNG of a leftover shows what the leftover holds. */
static enum err check_leftover(const struct orphan_search *search, const char *path)
{
    struct session *session = search->interp->session;
    struct picture picture = {0};
    enum err err = exr_read_golden(&picture, path, NULL, session_watch(session), NULL);
    if (!err && session_has_scene(session))
        err = export_background(&picture, session, NULL);
    if (!err)
        err = evidence_check_png(search->interp, path, &picture, &picture, NULL);
    picture_release(&picture);
    return err;
}

static bool is_passed_over(const struct orphan_search *search, const struct golden_files *files,
                           const char *name)
{
    struct buf path = {0};
    buf_printf(&path, "%s/%s", buf_text(&files->path), name);
    bool is_fine = search->lines && !path.failed;
    if (is_fine && file_is_named(name, ".png")) { /* with its image */
        memcpy(path.data + path.length - 3, "exr", 3);
        is_fine = golden_files_judge(files, file_name(buf_text(&path))) == FILE_LEFTOVER;
    } else if (is_fine && (is_fine = check_leftover(search, buf_text(&path)) == OK)) {
        buf_add_text(search->lines, "# ");
        buf_add_safe_text(search->lines, buf_text(&path));
        buf_add_text(search->lines, " was passed over: its command was ended before it was "
                                    "recorded; continuing the journal removes it\n");
    }
    buf_release(&path);
    return is_fine;
}

/* ---- all of them ---- */

static bool is_orphan(const struct orphan_search *search, const struct golden_files *files,
                      const char *name)
{
    switch (golden_files_judge(files, name)) {
    case FILE_NAMED:
    case FILE_HIDDEN:
        return false;
    case FILE_LEFTOVER:
        return !is_passed_over(search, files, name);
    case FILE_STRAY:
        return true;
    case FILE_FOREIGN:
        break;
    }
    return search->is_strict || file_is_named(name, PICTURE_NAMES);
}

static enum err list(struct name_list *orphans, const struct orphan_search *search,
                     const struct golden_files *files, struct fault *fault)
{
    const int again = openat(files->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *folder = again >= 0 ? fdopendir(again) : NULL;
    enum err err = folder ? OK : fault_errno(fault, "read", buf_text(&files->path));
    for (const struct dirent *entry; !err && (entry = readdir(folder));) {
        if (watch_poll(session_watch(search->interp->session), NULL, 0, 0))
            err = fault_set(fault, ERR_CANCELLED, "cancelled");
        else if (is_orphan(search, files, entry->d_name) && !name_list_add(orphans, entry->d_name))
            err = fault_memory(fault, "names of files");
    }
    if (folder)
        closedir(folder);
    return limits_judge(err, &(struct buf){0}, fault);
}

/* ---- a journal that is a link ---- */

/* The golden images next to the link, where there are others than those that are compared, are the
 * same. */
static enum err check_next_to_link(const struct orphan_search *search,
                                   const struct golden_files *files, struct fault *fault)
{
    struct buf next = {0}, one = {0}, other = {0};
    enum err err = golden_folder_next_to_link(&next, search->journal, fault);
    const char *name = buf_text(&files->named), *end = name + files->named.length;
    for (; !err && next.length && name < end; name += strlen(name) + 1) {
        buf_clear(&one);
        buf_clear(&other);
        buf_printf(&one, "%s/%s", buf_text(&next), name);
        buf_printf(&other, "%s/%s", buf_text(&files->path), name);
        if (one.failed || other.failed)
            err = fault_memory(fault, "a path");
        else if (file_exists(buf_text(&one)) && !file_is_same(buf_text(&one), buf_text(&other)) &&
                 !file_holds_same(buf_text(&one), buf_text(&other)))
            err = fault_set(fault, ERR_CHECK,
                            "%s is a link, and %s is another file than %s, which is next to the "
                            "journal itself and was compared; delete one of them",
                            search->journal, buf_text(&one), buf_text(&other));
    }
    buf_release(&next);
    buf_release(&one);
    buf_release(&other);
    return err;
}

/* ---- for the callers ---- */

enum err orphan_find(struct name_list *orphans, const struct orphan_search *search,
                     struct fault *fault)
{
    struct golden_files files;
    *orphans = (struct name_list){0};
    enum err err = open_files(&files, search->journal, fault);
    if (err == ERR_INPUT && search->lines && !search->is_strict) {
        buf_add_text(search->lines, "# ");
        buf_add_safe_text(search->lines, fault->text);
        buf_add_char(search->lines, '\n');
        err = OK;
    } else if (err == ERR_INPUT) {
        err = fault_prefix(fault, ERR_CHECK, "golden images");
        err = fault_set(fault, ERR_CHECK, "%s", fault->text);
    } else if (!err && files.folder >= 0) {
        err = list(orphans, search, &files, fault);
        if (!err)
            err = check_next_to_link(search, &files, fault);
    }
    name_list_sort(orphans);
    golden_files_close(&files);
    return err;
}

enum err orphan_judge(const struct name_list *orphans, const char *journal, struct fault *fault)
{
    struct buf path = {0};
    if (!orphans->count)
        return OK;
    enum err err = golden_folder(&path, journal, fault);
    if (!err)
        err = fault_set(
            fault, ERR_CHECK,
            "orphan golden image: the journal names no %s, which is in %s%s; iftty verify "
            "--remove-orphans deletes it, or make it again by `golden`",
            orphans->name[0], buf_text(&path), orphans->count > 1 ? ", and others" : "");
    buf_release(&path);
    return err;
}

enum err orphan_check(const struct orphan_search *search, struct fault *fault)
{
    struct name_list orphans;
    enum err err = orphan_find(&orphans, search, fault);
    if (!err)
        err = orphan_judge(&orphans, search->journal, fault);
    name_list_release(&orphans);
    return err;
}

enum err orphan_remove(const char *journal, const char *orphan, struct fault *fault)
{
    struct golden_files files;
    struct buf real = {0};
    file_real(&real, journal);
    enum err err = OK;
    if (real.failed)
        err = fault_memory(fault, "a path");
    else if (strcmp(buf_text(&real), journal) != 0)
        err = fault_set(fault, ERR_CHECK,
                        "%s is a link to %s: %s was left alone; name that journal to remove it",
                        journal, buf_text(&real), orphan);
    if (!err) {
        err = open_files(&files, journal, fault);
        if (!err)
            err = golden_files_remove(&files, orphan, fault);
        golden_files_close(&files);
    }
    buf_release(&real);
    return err;
}
