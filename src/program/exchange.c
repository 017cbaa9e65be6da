/* SPDX-License-Identifier: MIT */
#include "program/exchange.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/scan.h"
#include "command/command.h"
#include "command/execute.h"
#include "command/files.h"
#include "command/near.h"
#include "engine/labels.h"
#include "engine/scene.h"
#include "image/png.h"
#include "journal/golden.h"
#include "show/export_map.h"
#include "session/session.h"

/* ---- the folder ---- */

enum err exchange_begin(struct exchange *exchange, struct fault *fault)
{
    struct buf made = {0};
    struct stat status;
    enum err err = folder_held(&made, NULL, fault);
    *exchange = (struct exchange){0};
    if (err)
        return err;
    char *real = realpath(buf_text(&made), NULL);
    buf_add_text(&exchange->path, real ? real : "");
    if (!real || lstat(real, &status) != 0)
        err = fault_errno(fault, "look at", buf_text(&made));
    else if (exchange->path.failed)
        err = fault_memory(fault, "a path");
    if (err)
        folder_remove(buf_text(&made));
    else {
        exchange->device = status.st_dev;
        exchange->number = status.st_ino;
    }
    free(real);
    buf_release(&made);
    if (err)
        buf_release(&exchange->path);
    return err;
}

/* E1 */
static bool is_ours(const struct exchange *exchange)
{
    struct stat status;
    return lstat(buf_text(&exchange->path), &status) == 0 && S_ISDIR(status.st_mode) &&
           status.st_dev == exchange->device && status.st_ino == exchange->number &&
           status.st_uid == geteuid() && (status.st_mode & 077) == 0;
}

void exchange_end(struct exchange *exchange)
{
    if (exchange->path.length && is_ours(exchange))
        folder_remove(buf_text(&exchange->path));
    buf_release(&exchange->path);
}

static enum err place_file(struct buf *path, const struct exchange *exchange, const char *name,
                           struct fault *fault)
{
    buf_clear(path);
    buf_printf(path, "%s/%s", buf_text(&exchange->path), name);
    if (path->failed)
        return fault_memory(fault, "a path");
    return is_ours(exchange) ? OK
                             : fault_set(fault, ERR_IO,
                                         "%s is not the folder any more that this session has made "
                                         "for its owner alone; nothing was written",
                                         buf_text(&exchange->path));
}

/* ---- what depends on it ---- */

/* Judges where a path leads once all links are resolved: to the folder or to anything below it. */
static bool holds(const struct exchange *exchange, const char *name)
{
    const size_t length = exchange->path.length;
    struct buf path = {0}, settled = {0};
    file_from_home(&path, name);
    file_settle(&settled, buf_text(&path));
    const char *end = buf_text(&settled) + (settled.length < length ? settled.length : length);
    const bool is_in = path.failed || settled.failed ||
                       (strncmp(buf_text(&settled), buf_text(&exchange->path), length) == 0 &&
                        (*end == '/' || *end == '\0'));
    buf_release(&path);
    buf_release(&settled);
    return is_in;
}

/* A command whose journal keeps what it has read says so in a parameter that it adds. */
static bool keeps_copy(const struct command *command)
{
    for (const struct parameter *p = command->parameter; p->type; p++)
        if (p->added && strcmp(p->name, "copy") == 0)
            return true;
    return false;
}

/* Whether the file that a command names, or the one that is found by this name, is in it. */
static bool holds_file(const struct exchange *exchange, const struct interpreter *interp,
                       const struct parameter *p, const char *name)
{
    struct buf found = {0};
    if (p->is_scene)
        scan_text(&name, "raw:");
    bool is_in = holds(exchange, name);
    if (!is_in && !p->is_read && interp->out_folder)
        is_in = holds(exchange, interp->out_folder);
    if (!is_in && p->is_read && interpreter_find_file(interp, name, &found, NULL) == OK)
        is_in = holds(exchange, buf_text(&found));
    buf_release(&found);
    return is_in;
}

/* Whether the golden images and copies of labels of a journal would go into it. */
static bool holds_goldens(const struct exchange *exchange, const char *journal)
{
    struct buf folder = {0};
    const bool is_in = journal && (golden_folder(&folder, journal, NULL) != OK ||
                                   holds(exchange, buf_text(&folder)));
    buf_release(&folder);
    return is_in;
}

enum err exchange_allows(const struct exchange *exchange, const struct interpreter *interp,
                         const char *line, struct fault *fault)
{
    struct call call;
    enum err err = OK;
    if (command_parse(&call, line, interp->session, NULL) || !call.command)
        return OK;
    const struct command *command = call.command;
    const struct parameter *p = command->parameter;
    const char *journal = interp->home.length ? buf_text(&interp->home) : interp->new_journal;
    const bool stays = command->flags & COMMAND_RECORDED,
               moves = !stays && command->group == GROUP_KEPT; /* the journal itself */
    for (int i = 0; p[i].type && !err && (stays || moves); i++) {
        const char *name = call.value[i].given ? call.value[i].text : NULL;
        if (p[i].type == VALUE_FILE && name && call.value[i].number < 0 &&
            !(p[i].is_read && keeps_copy(command)) &&
            (holds_file(exchange, interp, &p[i], name) || (moves && holds_goldens(exchange, name))))
            err = fault_set(fault, ERR_INPUT,
                            "%s goes with this session, and %s %s would need it; expected a file "
                            "that stays; nothing has changed",
                            name, moves ? "the" : "the record of", command->name);
        else if ((p[i].type == VALUE_GOLDEN || (p[i].is_read && keeps_copy(command))) && name &&
                 holds_goldens(exchange, journal))
            err = fault_set(fault, ERR_INPUT,
                            "the golden images of %s would go with this session: their folder is a "
                            "link to its own; make them a folder that stays; nothing has changed",
                            journal);
    }
    if (err)
        command_point_at(&call, line, fault);
    call_release(&call);
    return err;
}

/* ---- arrays ---- */

#define ARRAYS MAPS "|intensity"

static enum err find_map(enum map *map, const char *name, struct fault *fault)
{
    const int found = choice_find(ARRAYS, name);
    struct near near = near_to(name);
    if (found >= 0) {
        *map = (enum map)found;
        return OK;
    }
    fault_set(fault, ERR_USAGE, "array: expected " ARRAYS ", not %s", name);
    near_try_choices(&near, ARRAYS);
    near_append(&near, "", fault);
    return ERR_USAGE;
}

/* Edits that wait are applied. */
static enum err prepare(struct interpreter *interp, struct fault *fault)
{
    struct session *session = interp->session;
    struct reply reply = {0};
    enum err err = OK;
    if (!session_has_scene(session))
        return fault_set(fault, ERR_USAGE, "no scene is open; open one first");
    if (session_pendings(session))
        err = interpreter_execute(interp, "run", &reply, fault);
    reply_release(&reply);
    return err ? err : interpreter_drop_sketch(interp, fault);
}

/* Of the file that was written: voxels are all that follows its header. */
static enum err describe(struct array_file *out, struct fault *fault)
{
    struct volume_reader reader;
    const enum err err = volume_begin(&reader, buf_text(&out->path), NULL, NULL, fault);
    out->type = reader.header.type;
    out->offset = reader.header.offset;
    volume_close(&reader);
    return err;
}

enum err array_write(struct array_file *out, const struct exchange *exchange,
                     struct interpreter *interp, const char *name, bool finished,
                     struct fault *fault)
{
    struct session *session = interp->session;
    struct labels labels;
    struct buf file = {0};
    enum map map;
    *out = (struct array_file){0};
    enum err err = find_map(&map, name, fault);
    if (!err && finished && map != MAP_LABELS)
        err = fault_set(fault, ERR_USAGE, "finished: of labels alone");
    if (!err)
        err = prepare(interp, fault);
    session_mark(session);
    if (!err)
        err = session_complete(session, fault);
    if (!err)
        err = session_labels(session, finished, &labels, fault);
    buf_printf(&file, "%s.nii", name);
    if (!err)
        err = place_file(&out->path, exchange, buf_text(&file), fault);
    if (!err)
        err = export_map(session, map, &labels, buf_text(&out->path), FILE_REPLACE, fault);
    if (!err)
        err = describe(out, fault);
    buf_release(&file);
    if (!err || watch_stops(session_watch(session)))
        err = watch_fault(session_watch(session), fault);
    if (err)
        session_rollback(session);
    else
        session_settle(session);
    out->name = name;
    return err;
}

void array_release(struct array_file *array)
{
    buf_release(&array->path);
}

/* ---- pictures ---- */

enum err picture_write(struct buf *path, const struct exchange *exchange, uint32_t width,
                       uint32_t height, const uint8_t *rgba, struct fault *fault)
{
    struct buf png = {0};
    enum err err = place_file(path, exchange, "picture.png", fault);
    if (!err)
        err = png_encode(&png, width, height, rgba, fault);
    if (!err)
        err = file_write(buf_text(path), png.data, png.length, FILE_REPLACE, fault);
    buf_release(&png);
    return err;
}
