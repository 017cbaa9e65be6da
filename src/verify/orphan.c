/* SPDX-License-Identifier: MIT */
#include "verify/verify_inside.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/mem.h"
#include "command/execute.h"
#include "command/golden_files.h"
#include "image/exr.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "command/trust.h"
#include "show/slicing.h"

/* Files that a person may take for a picture of the journal. */
#define PICTURE_NAMES EXR_NAMES "|.png|.jpg|.jpeg|.tif|.tiff|.gif|.bmp|.webp"

static enum err open_files(struct golden_files *files, const char *journal, struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0};
    TRY(golden_files_open(files, journal, false, fault));
    if (files->folder >= 0)
        TRY(file_read(&bytes, journal, JOURNAL_BYTES_MAX, fault));
    if (files->folder >= 0)
        TRY(golden_files_read(files, buf_text(&bytes), bytes.length, fault));
    return OK;
}

/* ---- leftovers of a killed command ---- */

/* OK if the leftover and its PNG are what `golden` draws by that command after the last record.
 * The session is unchanged. */
static enum err redraw(const struct orphan_search *search, const char *command, struct fault *fault)
{
    struct interpreter *interp = search->interp;
    const struct golden_judge *former = interp->judge;
    struct evidence unseen = {.folder = NULL};
    const struct golden_judge judge = evidence_judge(&unseen);
    OWNED(reply_release) struct reply reply = {0};
    interp->judge = &judge;
    const enum err err = interpreter_execute(interp, command, &reply, fault);
    interp->judge = former;
    return err;
}

/* Draw each picture that `golden` can draw until one is equal to the leftover. The leftover
 * itself does not say reliably which it is: it may be forged. */
static enum err check_leftover(const struct orphan_search *search, const char *image,
                               struct fault *fault)
{
    OWNED(buf_release) struct buf command = {0};
    struct choice of, finished;
    enum err err = ERR_CHECK;
    for (const char *at = "rendition|" SLICE_KINDS; err == ERR_CHECK && choice_next(&of, &at);)
        for (const char *in = "no|yes"; err == ERR_CHECK && choice_next(&finished, &in);) {
            buf_clear(&command);
            buf_printf(&command, "golden %.*s of=%.*s finished=%.*s", (int)strlen(image) - 4, image,
                       (int)of.length, of.word, (int)finished.length, finished.word);
            err = command.failed ? fault_memory(fault, "a command")
                                 : redraw(search, buf_text(&command), fault);
            err = err == ERR_USAGE || err == ERR_INPUT ? ERR_CHECK : err;
        }
    return err;
}

/* ERR_CHECK if the file is no leftover. */
static enum err pass_over(const struct orphan_search *search, const struct golden_files *files,
                          const char *name, struct fault *fault)
{
    OWNED(buf_release) struct buf image = {0};
    enum err err = search->lines ? OK : ERR_CHECK;
    buf_add_text(&image, name);
    if (image.failed)
        err = fault_memory(fault, "a path");
    else if (!err && file_is_named(name, ".png")) { /* accepted together with its image */
        memcpy(image.data + image.length - 3, "exr", 3);
        err = golden_files_judge(files, buf_text(&image)) == FILE_LEFTOVER ? OK : ERR_CHECK;
    } else if (!err && !(err = check_leftover(search, name, fault))) {
        buf_add_text(search->lines, "# ");
        buf_add_safe_text(search->lines, buf_text(&files->path));
        buf_printf(search->lines,
                   "/%s was ignored: its command was ended before it was recorded; continuing "
                   "the journal removes it\n",
                   name);
    }
    return err;
}

/* ---- all files of the folder ---- */

/* ERR_CHECK for an orphan. */
static enum err judge_file(const struct orphan_search *search, const struct golden_files *files,
                           const char *name, struct fault *fault)
{
    switch (golden_files_judge(files, name)) {
    case FILE_NAMED:
    case FILE_HIDDEN:
        return OK;
    case FILE_LEFTOVER:
        return pass_over(search, files, name, fault);
    case FILE_STRAY:
        return ERR_CHECK;
    case FILE_FOREIGN:
        break;
    }
    return search->is_strict || file_is_named(name, PICTURE_NAMES) ? ERR_CHECK : OK;
}

static enum err list_orphans(struct buf *orphans, const struct orphan_search *search,
                             const struct golden_files *files, struct fault *fault)
{
    OWNED(mem_release) struct dirent **entry = NULL;
    const int entries = scandirat(files->folder, ".", &entry, NULL, alphasort);
    enum err err = entries < 0 ? fault_errno(fault, "read", buf_text(&files->path)) : OK;
    for (int i = 0; i < entries; i++) {
        const char *name = entry[i]->d_name;
        if (!err && watch_poll(search->interp->session->watch, NULL, 0, 0))
            err = fault_set(fault, ERR_CANCELLED, "cancelled");
        if (!err && (err = judge_file(search, files, name, fault)) == ERR_CHECK) {
            buf_add(orphans, name, strlen(name) + 1);
            err = orphans->failed ? fault_memory(fault, "names of files") : OK;
        }
        free(entry[i]);
    }
    return limits_judge(err, &(struct buf){0}, fault);
}

/* ---- a journal that is a link ---- */

/* Check that files next to the link are equal to the compared files: all files if strict,
 * otherwise pictures. */
static enum err check_next_to_link(const struct orphan_search *search,
                                   const struct golden_files *files, struct fault *fault)
{
    OWNED(buf_release) struct buf next = {0}, one = {0}, other = {0};
    enum err err = golden_folder_next_to_link(&next, search->journal, fault);
    DIR *folder = !err && next.length ? opendir(buf_text(&next)) : NULL;
    if (!err && next.length && !folder)
        err = fault_errno(fault, "read", buf_text(&next));
    for (const struct dirent *entry; !err && folder && (entry = readdir(folder));) {
        const char *name = entry->d_name;
        if (*name == '.' || (!search->is_strict && !file_is_named(name, PICTURE_NAMES)))
            continue;
        buf_clear(&one);
        buf_clear(&other);
        buf_printf(&one, "%s/%s", buf_text(&next), name);
        buf_printf(&other, "%s/%s", buf_text(&files->path), name);
        if (one.failed || other.failed)
            err = fault_memory(fault, "a path");
        else if (watch_poll(search->interp->session->watch, NULL, 0, 0))
            err = fault_set(fault, ERR_CANCELLED, "cancelled");
        else if (!file_is_same(buf_text(&one), buf_text(&other)) &&
                 !file_holds_same(buf_text(&one), buf_text(&other)))
            err = fault_set(fault, ERR_CHECK,
                            "%s is a link, and %s is another file than %s, which is next to the "
                            "journal itself and was compared; delete one of them",
                            search->journal, buf_text(&one), buf_text(&other));
    }
    if (folder)
        closedir(folder);
    return limits_judge(err, &(struct buf){0}, fault);
}

/* ---- public functions ---- */

enum err orphan_find(struct buf *orphans, const struct orphan_search *search, struct fault *fault)
{
    OWNED(golden_files_close) struct golden_files files;
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
        err = list_orphans(orphans, search, &files, fault);
        if (!err)
            err = check_next_to_link(search, &files, fault);
    }
    if (err) {
        buf_clear(orphans);
    } else if (search->lines && orphans->length) {
        const char *first = buf_text(orphans);
        err = fault_set(
            fault, ERR_CHECK,
            "orphan golden image: the journal names no %s, which is in %s%s; iftty verify "
            "--remove-orphans deletes it, or make it again by `golden`",
            first, buf_text(&files.path),
            orphans->length > strlen(first) + 1 ? ", and others" : "");
    }
    return err;
}

enum err orphan_remove(const char *journal, const char *orphan, struct fault *fault)
{
    OWNED(buf_release) struct buf real = {0};
    file_real(&real, journal);
    if (real.failed)
        return fault_memory(fault, "a path");
    if (strcmp(buf_text(&real), journal) != 0)
        return fault_set(fault, ERR_CHECK,
                         "%s is a link to %s: %s was left alone; name that journal to remove it",
                         journal, buf_text(&real), orphan);
    OWNED(golden_files_close) struct golden_files files;
    TRY(open_files(&files, journal, fault));
    return golden_files_remove(&files, orphan, fault);
}
