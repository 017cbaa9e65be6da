/* SPDX-License-Identifier: MIT */
#include "program/answer.h"

#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/safe.h"
#include "base/scan.h"
#include "base/version.h"
#include "command/near.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "journal/journal.h"
#include "session/session.h"

/* ---- what is open ---- */

static void add_spacing(struct json *json, const struct geometry *geometry)
{
    if (geometry->spacing_unknown) {
        json_text(json, "spacing", "unknown");
        return;
    }
    json_array(json, "spacing");
    for (int a = 0; a < 3; a++)
        json_real(json, NULL, geometry->spacing_nm[a] / 1e6, 9);
    json_end(json);
}

/* From voxel indices to millimetres, four rows as in NIfTI; null where nobody knows. */
static void add_affine(struct json *json, const struct geometry *geometry)
{
    static const double last[4] = {0, 0, 0, 1};
    if (!geometry_has_place(geometry)) {
        json_word(json, "affine", "null");
        return;
    }
    json_array(json, "affine");
    for (int row = 0; row < 4; row++) {
        json_array(json, NULL);
        for (int column = 0; column < 4; column++)
            json_real(json, NULL, row < 3 ? geometry->to_mm[row][column] : last[column], 17);
        json_end(json);
    }
    json_end(json);
}

/* How a grid lies: of the scene, and of every array. */
static void add_grid(struct json *json, const struct session *session)
{
    const struct geometry *geometry = session_geometry(session);
    char axes[4];
    json_array(json, "size");
    for (int a = 0; a < 3; a++)
        json_count(json, NULL, session_scene(session)->grid.size[a]);
    json_end(json);
    add_spacing(json, geometry);
    geometry_axes(axes, geometry);
    json_text(json, "axes", geometry->orientation == ORIENTATION_UNKNOWN ? "unknown" : axes);
    add_affine(json, geometry);
}

/* As it is found from any folder. */
static void add_path(struct json *json, const char *key, const char *path)
{
    char *whole = realpath(path, NULL);
    json_text(json, key, whole ? whole : path);
    free(whole);
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
    struct buf offered = {0};
    json_text(json, "kind", err_name(fault->code));
    json_text(json, "why", fault->text);
    near_offered(&offered, fault->text);
    json_array(json, "hints");
    for (const char *at = buf_text(&offered); at < buf_text(&offered) + offered.length;
         at += strlen(at) + 1)
        json_text(json, NULL, at);
    json_end(json);
    json->out->failed |= offered.failed;
    buf_release(&offered);
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
    if (session_has_scene(interp->session)) {
        json_object(&json, "scene");
        add_grid(&json, interp->session);
        json_end(&json);
    } else {
        json_word(&json, "scene", "null");
    }
    json_end(&json);
}

/* ---- of a command ---- */

/* A word of a record: a count as a number, all else as a text. Digests are longer than any count
 * (record_word_is_digest), and a number with other zeros before it is none. */
static void add_word(struct json *json, const char *key, const struct record_word *word)
{
    const char *at = word->value;
    int64_t number;
    const bool is_count = word->value_length <= 15 && (*at != '0' || word->value_length == 1) &&
                          scan_integer(&at, 0, INT64_MAX, &number) &&
                          at == word->value + word->value_length;
    if (is_count)
        json_count(json, key, (uint64_t)number);
    else
        json_bytes(json, key, word->value, word->value_length);
}

static void add_words(struct json *json, const struct buf *words)
{
    const char *at = buf_text(words), *end = at + words->length;
    struct record_word word;
    json_object(json, "words");
    while (record_word_next(&at, end, &word)) {
        struct buf key = {0};
        buf_add(&key, word.key, word.key_length);
        add_word(json, buf_text(&key), &word);
        json->out->failed |= key.failed;
        buf_release(&key);
    }
    json_end(json);
}

static struct json begin(struct buf *out, const char *id)
{
    struct json json = {.out = out};
    json_object(&json, NULL);
    json_word(&json, "id", id);
    return json;
}

void answer_command(struct buf *out, const char *id, const struct interpreter *interp,
                    const struct reply *reply, const char *picture)
{
    struct json json = begin(out, id);
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
    struct json json = begin(out, id);
    json_boolean(&json, "ok", true);
    json_text(&json, "array", array->name);
    json_text(&json, "file", buf_text(&array->path));
    json_text(&json, "type", voxel_type_name(array->type));
    json_count(&json, "offset", array->offset);
    add_grid(&json, interp->session);
    add_journal(&json, interp);
    json_end(&json);
}

/* ---- of what was not carried out ---- */

/* Which character of the line a byte begins, both from 1. */
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
    struct json json = begin(out, id);
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
    struct json json = begin(out, id);
    json_text(&json, "progress", what);
    json_count(&json, "done", done);
    json_count(&json, "total", total);
    if (stops)
        json_boolean(&json, "stops", true);
    json_end(&json);
}

void answer_notice(struct buf *out, const char *id, const char *line)
{
    struct json json = begin(out, id);
    json_text(&json, "notice", line);
    json_end(&json);
}
