/* SPDX-License-Identifier: MIT */
#include "command/interpreter.h"

#include <stdlib.h>
#include <string.h>

#include "base/confine.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "command/command.h"
#include "command/trust.h"
#include "image/image_helper.h"
#include "image/picture_writer.h"
#include "journal/journal.h"
#include "journal/record.h"

enum err interpreter_init(struct interpreter *interp, struct fault *fault)
{
    *interp = (struct interpreter){0};
    history_init(&interp->history);
    TRY(session_new(&interp->session, fault));
    return image_helper_new(&interp->helper, NULL, fault);
}

void interpreter_release(struct interpreter *interp)
{
    picture_job_free(interp->job);
    picture_writer_free(interp->writer);
    journal_close(interp->journal);
    buf_release(&interp->comments);
    image_helper_free(interp->helper);
    history_release(&interp->history);
    session_free(interp->session);
    arena_release(&interp->arena);
    buf_release(&interp->home);
    buf_release(&interp->written);
    buf_release(&interp->made);
    buf_release(&interp->placed);
    canvas_release(&interp->shown);
    *interp = (struct interpreter){0};
}

void reply_clear(struct reply *reply)
{
    buf_clear(&reply->text);
    buf_clear(&reply->words);
    buf_clear(&reply->canonical);
    buf_clear(&reply->list);
    buf_clear(&reply->files);
}

void reply_release(struct reply *reply)
{
    buf_release(&reply->text);
    buf_release(&reply->words);
    buf_release(&reply->canonical);
    buf_release(&reply->list);
    buf_release(&reply->files);
}

/* ---- its journal ---- */

enum err interpreter_set_home(struct interpreter *interp, const char *path, struct fault *fault)
{
    buf_clear(&interp->home);
    buf_add_text(&interp->home, path);
    return interp->home.failed ? fault_memory(fault, "a path") : OK;
}

bool interpreter_is_journal(const char *path)
{
    return file_begins_with(path, RECORD_HEADER);
}

bool interpreter_is_comment(const char *line)
{
    return *line == '#' && strncmp(line, RECORD_HEADER, sizeof RECORD_HEADER - 1) != 0 &&
           strncmp(line, RECORD_SIGNATURE, sizeof RECORD_SIGNATURE - 1) != 0;
}

enum err interpreter_comment(struct interpreter *interp, const char *line, struct reply *reply,
                             struct fault *fault)
{
    struct buf *comments = &interp->comments;
    if (interp->mode != MODE_LIVE || !interpreter_is_comment(line) ||
        !(interp->journal || interp->new_journal))
        return OK;
    TRY(record_comment_check(line, fault));
    if (interp->journal)
        TRY(journal_comment(interp->journal, line, fault));
    else if (comments->length + strlen(line) < RECORD_LINE_MAX)
        buf_printf(comments, "%s\n", line);
    else
        return fault_set(fault, ERR_LIMIT,
                         "the comments before the first command are limited to "
                         "%d bytes",
                         RECORD_LINE_MAX);
    if (interp->has_pilot)
        buf_add_text(&reply->text, "stored with the next recorded command\n");
    return comments->failed ? fault_memory(fault, "a comment") : OK;
}

enum err interpreter_create_journal(struct interpreter *interp, const char *path,
                                    struct fault *fault)
{
    TRY(interpreter_set_home(interp, path, fault));
    TRY(journal_create(&interp->journal, path, interp->session->semantics, fault));
    enum err err = journal_set_sync(interp->journal, interp->sync, fault);
    if (!err && (interp->who || interp->times))
        err = journal_sign(interp->journal, interp->who, interp->times, fault);
    for (char *at = interp->comments.data, *end; !err && at && *at; at = end + 1) {
        end = strchr(at, '\n');
        *end = '\0';
        err = journal_comment(interp->journal, at, fault);
        *end = '\n';
    }
    if (!err)
        buf_clear(&interp->comments);
    if (err) { /* undo the creation */
        journal_close(interp->journal);
        interp->journal = NULL;
        file_discard(path);
    }
    return err;
}

void interpreter_write_lock(const struct interpreter *interp, struct buf *told)
{
    const char *lock = interp->journal ? journal_lock_file(interp->journal) : NULL;
    if (!lock)
        return;
    buf_add_text(told, "the file system has no locks: ");
    buf_add_safe_text(told, lock);
    buf_add_text(told, " keeps other sessions from writing, until this one ends\n");
}

/* ---- files that commands name ---- */

static const char default_scenes[] = "/usr/share/mricron/templates";

const char *interpreter_scenes(void)
{
    const char *list = getenv("IFTTY_SCENES");
    return list ? list : default_scenes;
}

static bool try_folder(struct buf *path, const char *folder, size_t length, const char *name)
{
    buf_clear(path);
    buf_add(path, folder, length);
    buf_printf(path, "/%s", name);
    return file_exists(buf_text(path));
}

/* Find a file below the folders of a wary interpreter, by the last part of a name that leads
 * out. */
static enum err find_below(const struct interpreter *interp, const char *name, struct buf *path,
                           const struct trust_sought *sought, struct fault *fault)
{
    const bool leads_out = trust_leads_out(name);
    const enum err err = trust_find(path, buf_text(&interp->home), interpreter_scenes(),
                                    leads_out ? file_name(name) : name, sought, fault);
    if (!leads_out)
        return err;
    return fault_prefix(fault, err,
                        !sought->by_proof  ? sought->is_scene ? "the journal may not open %s"
                                                              : "the journal may not read %s"
                        : sought->is_scene ? "the scene of this record is not at %s"
                                           : "the channel of this record is not at %s",
                        name);
}

static enum err find_file(const struct interpreter *interp, const char *name, struct buf *path,
                          const struct trust_sought *sought, struct fault *fault)
{
    OWNED(buf_release) struct buf folder = {0};
    bool found = false;
    if (interpreter_is_wary(interp))
        return find_below(interp, name, path, sought, fault);
    buf_clear(path);
    if (interp->home.length && *name != '/') {
        file_folder(&folder, buf_text(&interp->home));
        found = try_folder(path, buf_text(&folder), folder.length, name);
    }
    if (!found && file_exists(name)) {
        buf_clear(path);
        buf_add_text(path, name);
        found = true;
    }
    for (const char *list = interpreter_scenes(); !found && path_is_inside(name) && *list;) {
        size_t length = strcspn(list, ":");
        found = length && try_folder(path, list, length, name);
        list += length + (list[length] == ':');
    }
    if (path->failed)
        return fault_memory(fault, "a path");
    if (!found)
        return fault_set(fault, ERR_IO, "there is no %s %s here%s%s; nothing %s", sought->kind,
                         name, interp->home.length ? " nor next to the journal" : "",
                         interp->mode != MODE_LIVE ? sought->hint : "", sought->undone);
    return OK;
}

/* The file given by --scene, or for a recorded channel by --channel; NULL without one. */
static const char *given_path(const struct interpreter *interp, bool is_channel)
{
    return !is_channel                                         ? interp->scene_path
           : interp->channel_path && interp->mode != MODE_LIVE ? *interp->channel_path
                                                               : NULL;
}

enum err interpreter_find_scene(const struct interpreter *interp, bool is_channel, const char *name,
                                bool by_proof, struct buf *path, struct fault *fault)
{
    const struct trust_sought sought[] = {
        {"scene", "was opened", "; expected --scene FILE", true, by_proof},
        {"file", "has changed", "; expected --channel FILE", false, by_proof}};
    const char *given = given_path(interp, is_channel);
    if (!is_channel && strncmp(name, "synth:", 6) == 0)
        given = name;
    if (!given)
        return find_file(interp, name, path, &sought[is_channel], fault);
    buf_clear(path);
    buf_add_text(path, given);
    return path->failed ? fault_memory(fault, "a path") : OK;
}

bool interpreter_find_outside(const struct interpreter *interp, bool is_channel, const char *name,
                              struct buf *path)
{
    return interpreter_is_wary(interp) && !given_path(interp, is_channel) &&
           strncmp(name, "synth:", 6) != 0 &&
           trust_find_outside(path, buf_text(&interp->home), interpreter_scenes(), name);
}

enum err interpreter_find_file(const struct interpreter *interp, const char *name, struct buf *path,
                               struct fault *fault)
{
    static const struct trust_sought sought = {"file", "has changed", "", false, false};
    return find_file(interp, name, path, &sought, fault);
}

/* ---- names as records have them ---- */

/* out = the absolute path of `name` without "." and ".." at its beginning. The current folder is
 * resolved without links. */
static bool absolute_path(struct buf *out, const char *name)
{
    OWNED(mem_release) char *here = *name == '/' ? NULL : realpath(".", NULL);
    buf_clear(out);
    if (here)
        buf_add_text(out, strcmp(here, "/") == 0 ? "" : here);
    for (bool continues = here; continues;) {
        const size_t n = strcspn(name, "/");
        const bool is_up = n == 2 && memcmp(name, "..", 2) == 0;
        continues = is_up || n == 0 || (n == 1 && *name == '.');
        if (is_up)
            while (out->length && out->data[--out->length] != '/')
                ;
        name += continues ? n + (name[n] == '/') : 0;
        continues = continues && *name;
    }
    if (here)
        buf_add_char(out, '/');
    buf_add_text(out, name);
    return (here || *name == '/') && !out->failed;
}

/* out = the absolute path `path` relative to the folder, an absolute path without links; false if
 * they have only "/" in common. */
static bool relative_path(struct buf *out, const char *path, const char *folder)
{
    size_t common = 0, ups = 0;
    for (size_t i = 0; path[i] && (folder[i] == path[i] || (!folder[i] && path[i] == '/')); i++) {
        if (path[i] == '/')
            common = i + 1;
        if (!folder[i])
            break;
    }
    for (const char *at = folder + common - 1; *at; at++)
        ups += at[0] == '/' && at[1];
    buf_clear(out);
    for (size_t i = 0; i < ups; i++)
        buf_add_text(out, "../");
    if (!ups && (path[common] == '~' || strncmp(path + common, "raw:", 4) == 0))
        buf_add_text(out, "./");
    buf_add_text(out, path + common);
    return common > 1 && !out->failed;
}

/* Reject a name that is found both here and next to the journal with different content. */
static enum err check_unique(const char *here, const char *beside, const char *name,
                             struct fault *fault)
{
    if (!file_exists(here) || !file_exists(beside) || file_is_same(here, beside) ||
        file_holds_same(here, beside))
        return OK;
    return fault_set(fault, ERR_INPUT,
                     "there are two files %s, here and next to the journal; expected the "
                     "whole path of one of them; nothing has changed",
                     name);
}

/* out = `name` relative to the folder of the journal, or an absolute path. */
static enum err make_relative(struct buf *out, const char *name, const char *journal,
                              struct fault *fault)
{
    OWNED(arena_release) struct arena arena = {0};
    struct buf *folder = arena_buf(&arena), *beside = arena_buf(&arena);
    struct buf *path = arena_buf(&arena), *whole = arena_buf(&arena);
    file_from_home(path, name);
    file_folder(folder, journal);
    buf_printf(beside, "%s/%s", buf_text(folder), name);
    OWNED(mem_release) char *real = realpath(buf_text(folder), NULL);
    const bool is_whole = *buf_text(path) == '/';
    enum err err = is_whole ? OK : check_unique(name, buf_text(beside), name, fault);
    buf_clear(out);
    buf_add_text(out, buf_text(path));
    if (!err && real && (is_whole || !file_exists(buf_text(beside))) &&
        file_exists(buf_text(path)) && absolute_path(whole, buf_text(path))) {
        const bool is_seen = relative_path(out, buf_text(whole), real);
        buf_clear(beside);
        buf_printf(beside, "%s/%s", real, buf_text(out));
        if (!is_seen || !file_is_same(buf_text(beside), buf_text(path))) {
            buf_clear(out);
            buf_add_text(out, buf_text(whole));
        }
        if (*safe_end(buf_text(out)))
            err = fault_set(fault, ERR_INPUT,
                            "the folder of %s has a name that no journal can hold; nothing has "
                            "changed",
                            name);
    }
    return out->failed || arena_failed(&arena) ? fault_memory(fault, "a path") : err;
}

enum err interpreter_settle_name(const struct interpreter *interp, struct call *call,
                                 struct fault *fault)
{
    const struct parameter *p = call->command->parameter;
    const char *journal = interp->home.length   ? buf_text(&interp->home)
                          : interp->new_journal ? interp->new_journal
                                                : NULL;
    struct value *value = NULL;
    for (int i = 0; p[i].type; i++) {
        struct value *given = &call->value[i];
        if (p[i].is_read && given->given && given->number < 0)
            value = given;
    }
    if (!value || interp->mode != MODE_LIVE || (p->is_scene && interp->scene_path))
        return OK;
    const char *name = value->text;
    const bool is_raw = p->is_scene && scan_text(&name, "raw:");
    if ((p->is_scene && strncmp(name, "synth:", 6) == 0) || *name == '/' ||
        (!journal && !file_is_from_home(name)))
        return OK;
    OWNED(buf_release) struct buf settled = {0};
    if (journal)
        TRY(make_relative(&settled, name, journal, fault));
    else
        file_from_home(&settled, name);
    buf_add_text(&call->settled, is_raw ? "raw:" : "");
    buf_add_text(&call->settled, buf_text(&settled));
    if (settled.failed || call->settled.failed)
        return fault_memory(fault, "a path");
    value->text = buf_text(&call->settled);
    return OK;
}

/* ---- golden images ---- */

enum err golden_refuse_link(const char *path, struct fault *fault)
{
    return fault_set(fault, ERR_CHECK, "%s, which leads out of its folder, differs from the record",
                     path);
}

enum err interpreter_may_read(const struct interpreter *interp, const char *path, bool *leads_out,
                              struct fault *fault)
{
    *leads_out = false;
    const enum path_kind answer =
        interpreter_is_wary(interp) ? trust_look_at_golden(path, leads_out) : PATH_IS_FILE;
    if (answer == PATH_IS_FILE || answer == PATH_IS_MISSING)
        return OK; /* the reader reports that it is missing */
    return fault_set(fault, ERR_INPUT, "the journal may not read %s, which %s", path,
                     answer == PATH_IS_OUTSIDE ? "leads out of its folder"
                                               : "is not a regular file");
}

/* ---- files that are written ---- */

/* Return the path below the folder for `name`, or NULL; or search by `path`. */
static const char *place_of(const struct buf *placed, const char *name, const char *path)
{
    const char *at = buf_text(placed), *end = at + placed->length;
    while (at < end) {
        const char *of = at, *where = at + strlen(at) + 1;
        if (name ? strcmp(of, name) == 0 : strcmp(where, path) == 0)
            return where;
        at = where + strlen(where) + 1;
    }
    return NULL;
}

/* Use the last part of the name only, so that the file is in the folder whatever a journal says.
 * Different names get different paths, and a name always the same one. */
static enum err place_below(struct interpreter *interp, const char *name, struct buf *path,
                            struct fault *fault)
{
    struct buf *placed = &interp->placed;
    const char *last = file_name(name), *before = place_of(placed, name, NULL);
    if (!*last || strcmp(last, ".") == 0 || strcmp(last, "..") == 0)
        return fault_set(fault, ERR_INPUT, "%s names no file; nothing was written", name);
    if (before) {
        buf_add_text(path, before);
        return path->failed ? fault_memory(fault, "a path") : OK;
    }
    const int stem = 1 + (int)strcspn(last + 1, ".");
    unsigned number = 0;
    do { /* "out/lab.nii.gz", then "out/lab-2.nii.gz" */
        buf_clear(path);
        buf_printf(path, "%s/%.*s", interp->out_folder, stem, last);
        if (++number > 1)
            buf_printf(path, "-%u", number);
        buf_add_text(path, last + stem);
    } while (!path->failed && place_of(placed, NULL, buf_text(path)));
    if (path->failed || !buf_reserve(placed, strlen(name) + path->length + 2)) {
        placed->failed = false; /* its content is still valid */
        return fault_memory(fault, "a path");
    }
    buf_add(placed, name, strlen(name) + 1);
    buf_add(placed, buf_text(path), path->length + 1);
    return OK;
}

enum err interpreter_output_path(struct interpreter *interp, const char *name, struct buf *path,
                                 struct fault *fault)
{
    buf_clear(path);
    if (interp->mode == MODE_RESUME || interp->mode == MODE_SKIM)
        return OK; /* it was written when the command was new */
    if (interp->out_folder)
        return place_below(interp, name, path, fault);
    if (interp->mode == MODE_LIVE)
        file_from_home(path, name);
    return path->failed ? fault_memory(fault, "a path") : OK;
}

/* ---- files that go with a command ---- */

void interpreter_note_existing(struct interpreter *interp, const char *path, enum file_mode mode)
{
    interp->found_existing = mode == FILE_KEEP && interp->mode == MODE_LIVE && file_exists(path) &&
                             !file_is_folder(path);
}

enum err interpreter_will_write(struct interpreter *interp, const char *path, enum file_mode mode,
                                struct fault *fault)
{
    OWNED(buf_release) struct buf backup = {0};
    if (interpreter_is_wary(interp))
        limits_will_write();
    if (interp->writer && picture_writer_holds(interp->writer, path))
        picture_writer_wait(interp->writer, NULL);    /* one write at a time */
    if (interp->journal && interp->mode == MODE_LIVE) /* records before it are on the disk */
        TRY(journal_catch_up(interp->journal, fault));
    interpreter_note_existing(interp, path, mode);
    if (file_exists(path)) {
        if (mode == FILE_KEEP)
            return OK; /* the writer rejects it */
        if (interpreter_is_wary(interp) && !buf_lists(&interp->made, path, strlen(path)))
            return fault_set(fault, ERR_IO,
                             "%s existed before; a replay replaces only its own files; "
                             "it was left alone",
                             path);
        TRY(file_backup(&backup, path, fault));
    }
    const size_t made = interpreter_is_wary(interp) ? strlen(path) + 1 : 0;
    if (!buf_reserve(&interp->written, strlen(path) + backup.length + 2) ||
        (made && !buf_reserve(&interp->made, made))) {
        if (backup.length)
            file_discard(buf_text(&backup));
        interp->made.failed =
            false; /* its content is still valid; interpreter_settle_files clears the other */
        return fault_memory(fault, "a file name");
    }
    buf_add(&interp->made, path, made); /* cannot fail: the memory is reserved */
    buf_add(&interp->written, path, strlen(path) + 1);
    buf_add(&interp->written, buf_text(&backup), backup.length + 1);
    return OK;
}

/* Remove the backups of a successful command; else restore the files. */
void interpreter_settle_files(struct interpreter *interp, bool succeeded)
{
    const char *at = buf_text(&interp->written), *end = at + interp->written.length;
    while (at < end) {
        const char *path = at, *backup = path + strlen(path) + 1;
        at = backup + strlen(backup) + 1;
        if (succeeded && *backup)
            file_discard(backup);
        else if (!succeeded && *backup)
            file_restore(backup, path, NULL);
        else if (!succeeded)
            file_discard(path);
    }
    buf_clear(&interp->written);
}
