/* SPDX-License-Identifier: MIT */
#include "program/serve.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "base/version.h"
#include "command/command.h"
#include "command/execute.h"
#include "command/near.h"
#include "engine/labels.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "image/png.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "session/session.h"
#include "show/export_map.h"

/* ---- the folder ---- */

enum err exchange_begin(struct exchange *exchange, struct fault *fault)
{
    OWNED(buf_release) struct buf made = {0};
    struct stat status;
    enum err err = OK;
    *exchange = (struct exchange){0};
    TRY(folder_held(&made, NULL, fault));
    OWNED(mem_release) char *real = realpath(buf_text(&made), NULL);
    buf_add_text(&exchange->path, real ? real : "");
    if (!real || lstat(real, &status) != 0)
        err = fault_errno(fault, "look at", buf_text(&made));
    else if (exchange->path.failed)
        err = fault_memory(fault, "a path");
    if (err) {
        folder_remove(buf_text(&made));
        buf_release(&exchange->path);
    } else {
        exchange->device = status.st_dev;
        exchange->number = status.st_ino;
    }
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
                                         "%s is no longer the private folder of this session; "
                                         "nothing was written",
                                         buf_text(&exchange->path));
}

/* ---- commands that must not use the folder ---- */

/* True if a path leads to the folder or below it, once all links are resolved. */
static bool holds_path(const struct exchange *exchange, const char *name)
{
    const size_t length = exchange->path.length;
    OWNED(buf_release) struct buf path = {0}, settled = {0};
    file_from_home(&path, name);
    file_absolute(&settled, buf_text(&path));
    const char *end = buf_text(&settled) + (settled.length < length ? settled.length : length);
    return path.failed || settled.failed ||
           (strncmp(buf_text(&settled), buf_text(&exchange->path), length) == 0 &&
            (*end == '/' || *end == '\0'));
}

/* True if the journal keeps a copy of the file: the command then adds a parameter `copy`. */
static bool keeps_copy(const struct command *command)
{
    for (const struct parameter *p = command->parameter; p->type; p++)
        if (p->added && strcmp(p->name, "copy") == 0)
            return true;
    return false;
}

/* True if the file that a command names, or the one found by its name, is in the folder. */
static bool holds_file(const struct exchange *exchange, const struct interpreter *interp,
                       const struct parameter *p, const char *name)
{
    OWNED(buf_release) struct buf found = {0};
    if (p->is_scene)
        scan_text(&name, "raw:");
    bool is_in = holds_path(exchange, name);
    if (!is_in && !p->is_read && interp->out_folder)
        is_in = holds_path(exchange, interp->out_folder);
    if (!is_in && p->is_read && interpreter_find_file(interp, name, &found, NULL) == OK)
        is_in = holds_path(exchange, buf_text(&found));
    return is_in;
}

/* True if golden images and copies of labels of a journal would be in the folder. */
static bool holds_goldens(const struct exchange *exchange, const char *journal)
{
    OWNED(buf_release) struct buf folder = {0};
    return journal &&
           (golden_folder(&folder, journal, NULL) != OK || holds_path(exchange, buf_text(&folder)));
}

enum err exchange_allows(const struct exchange *exchange, const struct interpreter *interp,
                         const char *line, struct fault *fault)
{
    OWNED(call_release) struct call call = {.command = NULL};
    enum err err = OK;
    if (command_parse(&call, line, interp->session, NULL) || !call.command)
        return OK;
    const struct command *command = call.command;
    const struct parameter *p = command->parameter;
    const char *journal = interp->home.length ? buf_text(&interp->home) : interp->new_journal;
    const bool stays = command->flags & COMMAND_RECORDED,
               moves = !stays && command->group == GROUP_KEPT; /* the command moves the journal
                                                                  itself */
    for (int i = 0; p[i].type && !err && (stays || moves); i++) {
        const char *name = call.value[i].given ? call.value[i].text : NULL;
        if (p[i].type == VALUE_FILE && name && call.value[i].number < 0 &&
            !(p[i].is_read && keeps_copy(command)) &&
            (holds_file(exchange, interp, &p[i], name) || (moves && holds_goldens(exchange, name))))
            err = fault_set(fault, ERR_INPUT,
                            "%s is removed with this session, and %s %s would need it; expected a "
                            "file elsewhere; nothing has changed",
                            name, moves ? "the" : "the record of", command->name);
        else if ((p[i].type == VALUE_GOLDEN || (p[i].is_read && keeps_copy(command))) && name &&
                 holds_goldens(exchange, journal))
            err = fault_set(
                fault, ERR_INPUT,
                "the golden images of %s would be removed with this session: their folder "
                "is a link to its own; use another folder; nothing has changed",
                journal);
    }
    if (err)
        command_point_at(&call, line, fault);
    return err;
}

/* ---- arrays ---- */

#define ARRAYS MAPS "|intensity"

enum err array_write(struct array_file *out, const struct exchange *exchange,
                     struct interpreter *interp, const char *name, bool finished,
                     struct fault *fault)
{
    struct session *session = interp->session;
    struct volume_reader reader;
    struct labels labels;
    OWNED(buf_release) struct buf file = {0};
    const int map = choice_find(ARRAYS, name);
    enum err err = OK;
    *out = (struct array_file){.name = name};
    if (map < 0) {
        fault_set(fault, ERR_USAGE, "array: expected " ARRAYS ", not %s", name);
        err = near_append_choices(name, ARRAYS, fault);
    }
    if (!err && finished && map != MAP_LABELS)
        err = fault_set(fault, ERR_USAGE, "finished: of labels alone");
    if (!err && !session->has_scene)
        err = fault_set(fault, ERR_USAGE, "no scene is open; open one first");
    if (!err && session_pendings(session)) {
        OWNED(reply_release) struct reply reply = {0};
        err = interpreter_execute(interp, "run", &reply, fault);
    }
    if (!err)
        err = interpreter_drop_sketch(interp, fault);
    session_mark(session);
    if (!err)
        err = session_complete(session, fault);
    if (!err)
        err = session_labels(session, finished, &labels, fault);
    buf_printf(&file, "%s.nii", name);
    if (!err)
        err = place_file(&out->path, exchange, buf_text(&file), fault);
    if (!err)
        err = export_map(session, (enum map)map, &labels, buf_text(&out->path), FILE_REPLACE, NULL,
                         fault);
    if (!err) { /* voxels are all that follows the header of the file */
        err = volume_begin(&reader, buf_text(&out->path), NULL, NULL, fault);
        out->type = reader.header.type;
        out->offset = reader.header.offset;
        volume_close(&reader);
    }
    if (!err || watch_stops(session->watch))
        err = watch_fault(session->watch, fault);
    if (err)
        session_rollback(session);
    else
        session_settle(session);
    return err;
}

/* ---- pictures ---- */

enum err picture_write(struct buf *path, const struct exchange *exchange, uint32_t width,
                       uint32_t height, const uint8_t *rgba, struct fault *fault)
{
    OWNED(buf_release) struct buf png = {0};
    TRY(place_file(path, exchange, "picture.png", fault));
    TRY(png_encode(&png, width, height, rgba, fault));
    return file_write(buf_text(path), png.data, png.length, FILE_REPLACE, fault);
}

/* ---- state ---- */

/* The grid of the scene and of every array: size, spacing, axes, and the affine map from voxel
 * indices to millimetres, four rows as in NIfTI; null if it is not known. */
static void add_grid(struct json *json, const struct session *session)
{
    const struct geometry *geometry = &session->geometry;
    char axes[4];
    json_counts(json, "size", session->scene->grid.size, 3);
    if (geometry->spacing_unknown) {
        json_text(json, "spacing", "unknown");
    } else {
        json_array(json, "spacing");
        for (int a = 0; a < 3; a++)
            json_real(json, NULL, geometry->spacing_nm[a] / 1e6, 9);
        json_end(json);
    }
    geometry_axes(axes, geometry);
    json_text(json, "axes", geometry->orientation == ORIENTATION_UNKNOWN ? "unknown" : axes);
    if (!geometry_has_place(geometry)) {
        json_word(json, "affine", "null");
        return;
    }
    json_array(json, "affine");
    for (int row = 0; row < 4; row++) {
        json_array(json, NULL);
        for (int column = 0; column < 4; column++)
            json_real(json, NULL, row < 3 ? geometry->to_mm[row][column] : column == 3, 17);
        json_end(json);
    }
    json_end(json);
}

/* Add the absolute path, if there is one. */
static void add_path(struct json *json, const char *key, const char *path)
{
    OWNED(mem_release) char *whole = realpath(path, NULL);
    json_text(json, key, whole ? whole : path);
}

static void add_journal(struct json *json, const struct interpreter *interp)
{
    const struct journal *journal = interp->journal;
    if (!journal) {
        json_word(json, "journal", "null");
        return;
    }
    add_path(json, "journal", journal_path(journal));
    json_boolean(json, "read_only", journal_only_looks(journal));
    json_count(json, "records", journal_count(journal));
    json_text(json, "chain", journal_chain(journal));
}

static void add_fault(struct json *json, const struct fault *fault)
{
    OWNED(buf_release) struct buf offered = {0};
    json_text(json, "kind", err_name(fault->code));
    json_text(json, "why", fault->text);
    near_offered(&offered, fault->text);
    json_array(json, "hints");
    for (const char *at = buf_text(&offered); at < buf_text(&offered) + offered.length;
         at += strlen(at) + 1)
        json_text(json, NULL, at);
    json_end(json);
    json->out->failed |= offered.failed;
}

void answer_greeting(struct buf *out, const struct interpreter *interp, const char *folder,
                     const char *told, const struct fault *fault)
{
    struct json json = {.out = out};
    json_object(&json, NULL);
    json_count(&json, "protocol", SERVE_PROTOCOL);
    json_boolean(&json, "ok", !fault);
    json_text(&json, "program", "iftty");
    json_text(&json, "version", PROGRAM_VERSION);
    if (fault) {
        add_fault(&json, fault);
        json_end(&json);
        return;
    }
    json_text(&json, "text", told);
    json_text(&json, "folder", folder);
    add_journal(&json, interp);
    if (interp->session->has_scene) {
        json_object(&json, "scene");
        add_grid(&json, interp->session);
        json_end(&json);
    } else {
        json_word(&json, "scene", "null");
    }
    json_end(&json);
}

/* ---- answers to commands ---- */

/* The words of a record: a count as a number, all else as a text. Digests are longer than any count
 * (record_word_is_digest), and a number with leading zeros is not a count. */
static void add_words(struct json *json, const struct buf *words)
{
    const char *at = buf_text(words), *end = at + words->length;
    struct record_word word;
    json_object(json, "words");
    while (record_word_next(&at, end, &word)) {
        const char *digit = word.value;
        OWNED(buf_release) struct buf key = {0};
        int64_t number;
        buf_add(&key, word.key, word.key_length);
        if (word.value_length <= 15 && (*digit != '0' || word.value_length == 1) &&
            scan_integer(&digit, 0, INT64_MAX, &number) && digit == word.value + word.value_length)
            json_count(json, buf_text(&key), (uint64_t)number);
        else
            json_bytes(json, buf_text(&key), word.value, word.value_length);
        json->out->failed |= key.failed;
    }
    json_end(json);
}

static struct json begin_answer(struct buf *out, const char *id)
{
    struct json json = {.out = out};
    json_object(&json, NULL);
    json_word(&json, "id", id);
    return json;
}

void answer_command(struct buf *out, const char *id, const struct interpreter *interp,
                    const struct reply *reply, const char *picture)
{
    struct json json = begin_answer(out, id);
    const bool is_recorded = reply->canonical.length && interp->acknowledged && interp->journal &&
                             !journal_only_looks(interp->journal);
    json_boolean(&json, "ok", true);
    if (is_recorded)
        json_count(&json, "record", interp->acknowledged);
    else
        json_word(&json, "record", "null");
    json_text(&json, "command", buf_text(&reply->canonical));
    json_text(&json, "text", buf_text(&reply->text));
    add_words(&json, &reply->words);
    json_array(&json, "files");
    for (size_t at = 0; at < reply->files.length; at += strlen(reply->files.data + at) + 1)
        add_path(&json, NULL, reply->files.data + at);
    json_end(&json);
    if (picture)
        json_text(&json, "picture", picture);
    add_journal(&json, interp);
    json_end(&json);
}

void answer_array(struct buf *out, const char *id, const struct interpreter *interp,
                  const struct array_file *array)
{
    struct json json = begin_answer(out, id);
    json_boolean(&json, "ok", true);
    json_text(&json, "array", array->name);
    json_text(&json, "file", buf_text(&array->path));
    json_text(&json, "type", voxel_type_name(array->type));
    json_count(&json, "offset", array->offset);
    add_grid(&json, interp->session);
    add_journal(&json, interp);
    json_end(&json);
}

/* ---- errors and progress ---- */

/* Convert a byte of a line to a column in characters, both from 1. */
static size_t column_of(const char *line, size_t byte)
{
    size_t column = 1;
    for (size_t at = 0, left = strlen(line); at + 1 < byte && left > 0; column++) {
        uint32_t point;
        size_t n = utf8_read(line + at, left, &point);
        n = n ? n : 1;
        at += n;
        left -= n;
    }
    return column;
}

void answer_fault(struct buf *out, const char *id, const struct fault *fault, const char *line,
                  const char *list)
{
    struct json json = begin_answer(out, id);
    json_boolean(&json, "ok", false);
    add_fault(&json, fault);
    if (line && fault->at)
        json_count(&json, "column", column_of(line, fault->at));
    if (list && *list)
        json_text(&json, "list", list);
    json_end(&json);
}

void answer_progress(struct buf *out, const char *id, const char *what, uint64_t done,
                     uint64_t total, bool stops)
{
    struct json json = begin_answer(out, id);
    json_text(&json, "progress", what);
    json_count(&json, "done", done);
    json_count(&json, "total", total);
    if (stops)
        json_boolean(&json, "stops", true);
    json_end(&json);
}

void answer_notice(struct buf *out, const char *id, const char *line)
{
    struct json json = begin_answer(out, id);
    json_text(&json, "notice", line);
    json_end(&json);
}

enum { ID_BYTES_MOST = 64 };

enum { KEY_ID, KEY_DO, KEY_ARRAY, KEY_FINISHED, KEY_CANCEL, KEYS };
#define KEY_NAMES "id|do|array|finished|cancel"

static enum err take_id(struct buf *id, const struct json_member *m, struct fault *fault)
{
    struct json json = {.out = id};
    buf_clear(id);
    if (m->kind == JSON_NUMBER)
        buf_printf(id, "%" PRId64, m->number);
    else if (m->kind == JSON_TEXT && m->text.length <= ID_BYTES_MOST)
        json_bytes(&json, NULL, buf_text(&m->text), m->text.length);
    else
        return fault_set(fault, ERR_USAGE,
                         "%s: expected a whole number, or a text of at most %d bytes",
                         buf_text(&m->key), ID_BYTES_MOST);
    if (id->length && id->data[id->length - 1] == '\n') /* the JSON writer's */
        id->data[--id->length] = '\0';
    return OK;
}

/* Read a member; `given` are the keys before it. */
static enum err take_member(struct request *request, bool given[KEYS], const struct json_member *m,
                            struct fault *fault)
{
    const char *name = buf_text(&m->key);
    const int key = choice_find(KEY_NAMES, name);
    if (key >= 0 && given[key])
        return fault_set(fault, ERR_USAGE, "%s is given twice", name);
    if (key >= 0)
        given[key] = true;
    switch (key) {
    case -1:
        fault_set(fault, ERR_USAGE, "expected do, array or cancel, with id, not the key %s", name);
        return near_append_choices(name, KEY_NAMES, fault);
    case KEY_CANCEL:
        request->kind = REQUEST_CANCEL;
        return take_id(&request->id, m, fault);
    case KEY_ID:
        return take_id(&request->id, m, fault);
    case KEY_FINISHED:
        request->finished = m->kind == JSON_TRUE;
        return m->kind == JSON_TRUE || m->kind == JSON_FALSE
                   ? OK
                   : fault_set(fault, ERR_USAGE, "finished: expected true or false");
    default:
        if (m->kind != JSON_TEXT)
            return fault_set(fault, ERR_USAGE, "%s: expected a text", name);
        request->kind = key == KEY_ARRAY ? REQUEST_ARRAY : REQUEST_COMMAND;
        buf_add(&request->words, buf_text(&m->text), m->text.length);
        return OK;
    }
}

/* Check the combination of keys. */
static enum err check_keys(const bool given[KEYS], struct fault *fault)
{
    if (given[KEY_DO] + given[KEY_ARRAY] + given[KEY_CANCEL] != 1)
        return fault_set(fault, ERR_USAGE, "expected one of the keys do, array and cancel");
    if (given[KEY_CANCEL] && given[KEY_ID])
        return fault_set(fault, ERR_USAGE, "cancel has no id of its own: it gets no answer");
    if (given[KEY_FINISHED] && !given[KEY_ARRAY])
        return fault_set(fault, ERR_USAGE,
                         "finished belongs to array; commands have their own parameters");
    return OK;
}

/* Read a line; always release the request. An invalid line sets its fault, ERR_USAGE or ERR_MEMORY,
 * and the id if one was read. */
static void request_read(struct request *request, const char *line, size_t length)
{
    struct json_reader reader = {.bytes = line, .length = length};
    OWNED(json_member_release) struct json_member member = {0};
    bool given[KEYS] = {false};
    *request = (struct request){0};
    struct fault *fault = &request->fault;
    enum err err = json_read(&reader, &member, fault);
    while (!err && member.kind != JSON_END) {
        err = take_member(request, given, &member, fault);
        if (!err)
            err = json_read(&reader, &member, fault);
    }
    if (!err)
        err = check_keys(given, fault);
    if (!request->id.length)
        buf_add_text(&request->id, "null");
    if (!err && (request->id.failed || request->words.failed))
        fault_memory(fault, "a request");
}

static void request_release(struct request *request)
{
    buf_release(&request->id);
    buf_release(&request->words);
    *request = (struct request){0};
}

static bool is_of(const struct request *request, const struct request *cancel)
{
    return strcmp(buf_text(&request->id), buf_text(&cancel->id)) == 0;
}

static void cancel_request(struct inbox *inbox, const struct request *cancel)
{
    if (is_of(&inbox->at_hand, cancel)) {
        inbox->stops = true;
        return;
    }
    for (size_t i = 0; i < inbox->count; i++)
        inbox->waiting[inbox->first + i].is_cancelled |=
            is_of(&inbox->waiting[inbox->first + i], cancel);
}

/* Finish the current line. */
static enum err end_line(struct inbox *inbox, struct fault *fault)
{
    OWNED(request_release) struct request request = {0};
    const bool is_blank = strspn(buf_text(&inbox->line), " \t\r") == inbox->line.length;
    if (!inbox->is_too_long && is_blank)
        return OK;
    if (inbox->is_too_long) {
        fault_set(&request.fault, ERR_USAGE, "the line is longer than %d bytes; it is skipped",
                  REQUEST_BYTES_MOST);
        buf_add_text(&request.id, "null");
    } else {
        request_read(&request, buf_text(&inbox->line), inbox->line.length);
    }
    buf_clear(&inbox->line);
    inbox->is_too_long = false;
    if (request.kind == REQUEST_CANCEL && !request.fault.code) {
        cancel_request(inbox, &request);
        return OK;
    }
    const size_t end = inbox->first + inbox->count;
    if (!mem_grow(&inbox->waiting, &inbox->capacity, end + 1, sizeof *inbox->waiting))
        return fault_memory(fault, "a request");
    inbox->bytes += request.words.length;
    inbox->waiting[end] = request;
    inbox->count++;
    request = (struct request){0}; /* the inbox owns it */
    return OK;
}

enum err inbox_take(struct inbox *inbox, const char *bytes, size_t length, struct fault *fault)
{
    enum err err = OK;
    while (!err && length > 0) {
        const char *end = memchr(bytes, '\n', length);
        const size_t n = end ? (size_t)(end - bytes) : length;
        inbox->is_too_long |= inbox->line.length + n > REQUEST_BYTES_MOST;
        if (!inbox->is_too_long)
            buf_add(&inbox->line, bytes, n);
        if (inbox->line.failed)
            err = fault_memory(fault, "a request");
        else if (end)
            err = end_line(inbox, fault);
        bytes += n + (end != NULL);
        length -= n + (end != NULL);
    }
    return err;
}

bool inbox_has_room(const struct inbox *inbox)
{
    return inbox->count < INBOX_WAITING_MOST && inbox->bytes <= INBOX_BYTES_MOST;
}

enum err inbox_read(struct inbox *inbox, int fd, struct fault *fault)
{
    static char bytes[1 << 16];
    struct pollfd now = {.fd = fd, .events = POLLIN};
    if (inbox->is_over || !inbox_has_room(inbox) || poll(&now, 1, 0) <= 0)
        return OK;
    const ssize_t n = read(fd, bytes, sizeof bytes);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return OK;
    if (n > 0)
        return inbox_take(inbox, bytes, (size_t)n, fault);
    inbox->is_over = true;
    if (n < 0)
        return fault_errno(fault, "read", "standard input");
    return inbox->line.length || inbox->is_too_long ? end_line(inbox, fault) : OK;
}

const struct request *inbox_next(struct inbox *inbox)
{
    request_release(&inbox->at_hand);
    inbox->stops = false;
    if (inbox->count == 0)
        return NULL;
    inbox->at_hand = inbox->waiting[inbox->first++];
    inbox->stops = inbox->at_hand.is_cancelled;
    inbox->bytes -= inbox->at_hand.words.length;
    if (--inbox->count == 0)
        inbox->first = 0;
    if (inbox->first >= INBOX_WAITING_MOST) {
        memmove(inbox->waiting, inbox->waiting + inbox->first,
                inbox->count * sizeof *inbox->waiting);
        inbox->first = 0;
    }
    return &inbox->at_hand;
}

void inbox_release(struct inbox *inbox)
{
    for (size_t i = 0; i < inbox->count; i++)
        request_release(&inbox->waiting[inbox->first + i]);
    free(inbox->waiting);
    request_release(&inbox->at_hand);
    buf_release(&inbox->line);
    *inbox = (struct inbox){0};
}
