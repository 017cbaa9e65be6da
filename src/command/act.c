/* SPDX-License-Identifier: MIT */
#include "command/act.h"

#include <ctype.h>
#include <string.h>

#include "base/safe.h"
#include "command/files.h"
#include "show/label_loss.h"
#include "session/map.h"
#include "show/draw.h"

enum err act_naming(const char *file, enum err err, struct fault *fault)
{
    return err ? fault_prefix(fault, err, "%s", file) : OK;
}

enum err act_go(const struct act *act)
{
    return session_go(act->session, act->next, NULL, 0, act->fault);
}

enum err act_check_name(const char *name, size_t room, struct fault *fault)
{
    const unsigned char first = (unsigned char)*name;
    const size_t length = strlen(name);
    const bool is_fit = length < room && (first >= 0x80 || isalpha(first)) &&
                        *safe_end(name) == '\0' && !strpbrk(name, " =\"\\");
    return is_fit ? OK
                  : fault_set(fault, ERR_USAGE,
                              "NAME: expected a word of at most %zu bytes that begins with a "
                              "letter, not %s",
                              room - 1, name);
}

/* ---- files ---- */

enum file_mode act_file_mode(const struct act *act)
{
    return act_is_yes(act, "replace") ? FILE_REPLACE : FILE_KEEP;
}

void act_write_file_line(const char *doing, const char *path, struct reply *reply)
{
    buf_add_text(&reply->text, doing);
    buf_add_safe_text(&reply->text, path);
    buf_add_char(&reply->text, '\n');
    act_note_file(path, reply);
}

void act_note_file(const char *path, struct reply *reply)
{
    buf_add(&reply->files, path, strlen(path) + 1);
}

enum err act_check_report(const struct act *act)
{
    const char *file = act_text(act, "report");
    return !file || file_is_named(file, ".json|.csv")
               ? OK
               : fault_set(act->fault, ERR_USAGE,
                           "report: expected a name that ends in .json or .csv, not %s", file);
}

enum err act_write_report(const struct act *act, const struct buf *text)
{
    const enum file_mode mode = act_file_mode(act);
    struct buf path = {0};
    enum err err = text->failed ? fault_memory(act->fault, "a report")
                                : interpreter_output_path(act->interp, act_text(act, "report"),
                                                          &path, act->fault);
    if (!err && path.length)
        err = interpreter_will_write(act->interp, buf_text(&path), mode, act->fault);
    if (!err && path.length)
        err = file_write(buf_text(&path), buf_text(text), text->length, mode, act->fault);
    if (!err && path.length)
        act_write_file_line("wrote ", buf_text(&path), act->reply);
    buf_release(&path);
    return err;
}

struct map_place act_map_place(const struct act *act)
{
    struct map_place place = session_map_place(act->session, act_is_yes(act, "resample"));
    place.choice = (struct volume_choice){.has_volume = act_has(act, "volume"),
                                          .volume = (uint32_t)act_number(act, "volume"),
                                          .command = act->call->command->name,
                                          .data = act_text(act, "data")};
    return place;
}

enum err act_read_map(const struct act *act, struct volume *map)
{
    const struct session *session = act->session;
    const struct map_place place = act_map_place(act);
    struct buf path = {0};
    enum err err = interpreter_find_file(act->interp, act_text(act, "FILE"), &path, act->fault);
    if (!err)
        err = map_read(map, buf_text(&path), &place, session_watch(session), act->fault);
    buf_release(&path);
    return err;
}

/* ---- labels ---- */

static enum err take(const struct act *act, bool finished, struct labels *labels)
{
    struct session *session = act->session;
    *labels = labels_of_forest(session_scene(session));
    if (session_skims(session) || !finished)
        return OK;
    const enum err err = session_labels(session, true, labels, act->fault);
    if (!err)
        act_add_digest(act, "finished", session_finished_digest(session));
    return err;
}

/* The record says by itself what is handed on, whatever pictures show where it is replayed. */
static void say_finished(const struct act *act, bool finished)
{
    struct call said = *act->call;
    call_set(&said, "finished", !finished, finished ? "yes" : "no");
    buf_clear(&act->reply->canonical);
    command_write(&act->reply->canonical, &said);
}

enum err act_write_losses(struct interpreter *interp, const struct labels *labels, bool only_new,
                          struct watch *watch, struct buf *out, struct fault *fault)
{
    struct label_loss loss;
    struct session *session = interp->session;
    const enum err err = label_loss_find(&loss, labels, session_team(session), watch, fault);
    if (err)
        return err;
    interp->losses_of = session_finish_source(session);
    for (unsigned l = 1; l < 256; l++) {
        const bool was_named = interp->names_loss[l];
        interp->names_loss[l] = loss.is_lost[l];
        loss.is_lost[l] = loss.is_lost[l] && !(only_new && was_named);
        loss.labels -= interp->names_loss[l] && !loss.is_lost[l];
    }
    (only_new ? label_loss_write_line : label_loss_write)(out, session, &loss);
    return OK;
}

enum err act_take_labels(const struct act *act, struct labels *labels)
{
    const bool as_shown = act->interp->has_pilot && !act_has(act, "finished") &&
                          session_kept(act->session)->finish.count > 0;
    const bool finished =
        as_shown ? session_shows_finished(act->session) : act_is_yes(act, "finished");
    if (as_shown)
        say_finished(act, finished);
    const enum err err = take(act, finished, labels);
    if (err || !labels->finished || act->interp->mode != MODE_LIVE)
        return err;
    return act_write_losses(act->interp, labels, false, session_watch(act->session),
                            &act->reply->text, act->fault);
}

enum err act_take_shown(const struct act *act, struct labels *labels)
{
    return take(act,
                act_has(act, "finished") ? act_is_yes(act, "finished")
                                         : session_shows_finished(act->session),
                labels);
}

/* ---- digests ---- */

void act_add_digest(const struct act *act, const char *key, uint64_t digest)
{
    buf_add_blank(&act->reply->words);
    buf_printf(&act->reply->words, "%s=%016llx", key, (unsigned long long)digest);
}

void act_add_weights(const struct act *act)
{
    act_add_digest(act, "weights", session_weight_digest(act->session));
}
