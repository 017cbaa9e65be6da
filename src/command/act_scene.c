/* Commands that open a scene and say what a forest in it grows by. */
#include "command/act.h"
#include "command/near.h"
#include "command/opening.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/choice.h"
#include "base/safe.h"
#include "session/map.h"
#include "session/semantics.h"

/* The answer of a command that gave the session its scene. */
static void write_scene(const struct act *act)
{
    const struct session *session = act->session;
    struct reply *reply = act->reply;
    const struct scene *scene = session_scene(session);
    const uint32_t *size = scene->grid.size, *nm = scene->spacing_nm;
    buf_printf(&reply->words, "scene=%016llx size=%u,%u,%u spacing-nm=%u,%u,%u weights=%016llx",
               (unsigned long long)session_scene_digest(session), size[0], size[1], size[2], nm[0],
               nm[1], nm[2], (unsigned long long)session_weight_digest(session));
    buf_printf(&reply->text, "%ux%ux%u voxels", size[0], size[1], size[2]);
    act_write_spacing(&reply->text, session);
    buf_printf(&reply->text, ", %.1f MB\n", (double)session_memory(session) / 1e6);
}

/* Where intensities are not exact: the ends of their scale, how many voxels are beyond each, and a
 * digest of the file's values that a level may stand for. */
static void record_levels(const struct act *act)
{
    const struct levels *levels = session_levels(act->session);
    if (levels)
        buf_printf(&act->reply->words, " scale=%.17g..%.17g beyond=%zu,%zu values=%016llx",
                   levels->ends[0], levels->ends[1], levels->beyond[0], levels->beyond[1],
                   (unsigned long long)levels_digest(levels));
}

/* What the file leaves open, and what it means; who says how the scene lies is recorded. */
static void write_orientation(const struct act *act)
{
    const struct session *session = act->session;
    struct reply *reply = act->reply;
    if (!semantics_has(session_semantics(session), MEANING_ORIENTATION))
        return;
    const struct choice who = choice_at(ORIENTATIONS, session_geometry(session)->orientation);
    buf_printf(&reply->words, " orientation=%.*s", (int)who.length, who.word);
    buf_add_text(&reply->text, session_open_notes(session));
    if (session_geometry(session)->orientation == ORIENTATION_UNKNOWN)
        buf_add_text(&reply->text, "orientation unknown: no picture or answer names a side of the "
                                   "patient\n");
    if (session_geometry(session)->spacing_unknown)
        buf_add_text(&reply->text, "distances of voxels unknown: lengths and volumes are in "
                                   "voxels\n");
}

/* Finds the file of a scene. A journal is none: it is not opened, but gone on with. */
static enum err find_scene(const struct act *act, const char *name, bool by_proof, struct buf *path)
{
    const enum err err = interpreter_find_scene(act->interp, name, by_proof, path, act->fault);
    if (!err && interpreter_is_journal(buf_text(path)))
        return fault_set(act->fault, ERR_INPUT,
                         "%s is a journal, and `open` takes a scene; `iftty %s` in a shell goes on "
                         "with it; nothing was opened",
                         name, name);
    if (!err && file_is_named(name, ".iftty") && act->interp->mode == MODE_LIVE)
        return fault_set(act->fault, ERR_INPUT,
                         "%s is named as a journal, and `open` takes a scene; nothing was opened",
                         name);
    if (err && file_is_named(name, ".iftty") && !interpreter_is_wary(act->interp))
        return fault_set(act->fault, err,
                         "there is no journal %s here, and `open` takes a scene; `iftty JOURNAL` "
                         "in a shell goes on with a journal; nothing was opened",
                         name);
    return err;
}

/* What is said of a file, and would be left out of a scene that is none; as it was in records. */
static enum err check_words(const struct act *act, const char *name)
{
    if (strncmp(name, "synth:", 6) != 0 || act->interp->mode != MODE_LIVE)
        return OK;
    if (act_has(act, "series|data|missing|skip|size|type|endian|offset|spacing|huge|private|"
                     "straighten"))
        return fault_set(act->fault, ERR_USAGE,
                         "series, data, missing, skip, spacing, huge and straighten are about a "
                         "file, and a synthetic scene is made as it is to be; nothing was "
                         "opened");
    return OK;
}

/* A new record ends in weight=NAME, so that it means the same under another default; one without it
 * means `morph`, as all did before. */
static enum err take_first_weight(const struct act *act, bool *recorded)
{
    struct session *session = act->session;
    struct state next = *session_state(session);
    struct weight_choice *weight = &next.kept.weight;
    enum err err = OK;
    const char *given = act_text(act, "weight");
    *recorded = false;
    if (session_has_scene(session))
        return OK; /* session_open refuses */
    if (given)
        err = opening_weight(weight, given, act->fault);
    else
        *recorded = act->interp->mode == MODE_LIVE &&
                    semantics_has(session_semantics(session), MEANING_OPEN_WEIGHT);
    if (!given && !*recorded)
        *weight = (struct weight_choice){WEIGHT_MORPH, 1};
    return err ? err : session_go(session, &next, NULL, 0, act->fault);
}

/* What pictures say that it is called: the last part of the name that the command gives, wherever
 * the file was found. The name of a folder is often a patient's. */
static void name_scene(const struct act *act, const char *name, const char *path)
{
    const bool is_private = act_is_yes(act, "private");
    const bool is_said = !is_private && !file_is_folder(path);
    session_name_scene(act->session, is_said ? file_name(name) : "", is_private);
}

/* The proof of the scene that the record at hand has, of all of a file with a header. */
static bool has_proof(const struct act *act, const struct volume_choice *choice,
                      char proof[SHA256_HEX])
{
    static const char key[] = "sha256";
    const char *words = act->interp->replayed_words;
    struct record_word word;
    if (!words || choice->raw.size[0] || choice->has_crop || choice->reduce ||
        !record_word_find(words, key, strlen(key), &word) || word.value_length != SHA256_HEX - 1)
        return false;
    snprintf(proof, SHA256_HEX, "%.*s", (int)word.value_length, word.value);
    return true;
}

/* Opens a file that a stranger's record leads to, if it is the scene of which that has the proof.
 * Else nothing is shown or said of it, and `choice` is for another: only a stop is an error. */
static enum err open_outside(const struct act *act, const char *name, struct volume_choice *choice,
                             const char *proof)
{
    struct session *session = act->session;
    struct watch *watch = session_watch(session);
    struct buf path = {0};
    struct fault unsaid = {0};
    choice->proof = proof;
    if (watch)
        watch->is_quiet = true;
    if (!session_has_scene(session) && interpreter_find_outside(act->interp, name, &path))
        session_open(session, buf_text(&path), choice, &unsaid);
    if (watch)
        watch->is_quiet = false;
    choice->proof = NULL;
    buf_release(&path);
    return session_has_scene(session) ? OK : watch_fault(watch, act->fault);
}

/* What is recorded. */
static void write_canonical(const struct act *act, bool has_weight)
{
    struct buf *canonical = &act->reply->canonical;
    const struct session *session = act->session;
    buf_clear(canonical);
    opening_write(canonical, act->call, session_series(session));
    if (has_weight) {
        buf_add_text(canonical, " weight=");
        opening_write_weight(canonical, &session_kept(session)->weight);
    }
}

enum err act_open(const struct act *act)
{
    struct buf path = {0};
    struct session *session = act->session;
    struct volume_choice choice;
    char proof[SHA256_HEX];
    const char *name;
    const bool had_scene = session_has_scene(session);
    bool has_weight = false;
    enum err err = opening_choice(&choice, &name, act);
    choice.as_recorded = act->interp->mode != MODE_LIVE;
    choice.list = choice.as_recorded ? NULL : &act->reply->list;
    if (!err)
        err = check_words(act, name);
    if (!err)
        err = take_first_weight(act, &has_weight);
    const bool by_proof = !err && has_proof(act, &choice, proof);
    if (by_proof)
        err = open_outside(act, name, &choice, proof);
    const bool is_open = session_has_scene(session) && !had_scene;
    if (!err && !is_open)
        err = find_scene(act, name, by_proof, &path);
    if (!err && !is_open)
        err = session_open(session, buf_text(&path), &choice, act->fault);
    if (!err)
        name_scene(act, name, buf_text(&path));
    buf_release(&path);
    if (!err)
        write_canonical(act, has_weight);
    if (!err)
        write_scene(act);
    if (!err)
        write_orientation(act);
    if (!err)
        record_levels(act);
    if (!err && *session_proof(session))
        buf_printf(&act->reply->words, " sha256=%s", session_proof(session));
    return err;
}

enum err act_interpolate(const struct act *act)
{
    const unsigned doubled = (act_number(act, "X") == 2) | (act_number(act, "Y") == 2) << 1 |
                             (act_number(act, "Z") == 2) << 2;
    enum err err = session_interpolate(act->session, doubled, act->fault);
    if (!err)
        write_scene(act);
    return err;
}

/* What the file says is not put in doubt by letters: where it is wrong, it is wrong for every other
 * program, too, and for the maps of the scene. */
static enum err check_orient(const struct session *session, const char *how, struct fault *fault)
{
    const struct geometry *said = session_said(session);
    struct geometry oriented = *said;
    char towards[4];
    const bool is_form = strcmp(how, "sform") == 0 || strcmp(how, "qform") == 0;
    const bool is_known = geometry_orient(&oriented, how);
    if (!is_known && is_form)
        return fault_set(fault, ERR_INPUT, "HOW: the file has no %s; nothing has changed", how);
    if (!is_known)
        return fault_set(fault, ERR_INPUT,
                         "HOW: expected file, sform or qform where the file has that, or three "
                         "letters for the sides that the axes run towards, as in RAS, not %s; "
                         "nothing has changed",
                         how);
    geometry_axes(towards, said);
    if (oriented.orientation == ORIENTATION_TOLD && said->orientation != ORIENTATION_UNKNOWN)
        return fault_set(fault, ERR_INPUT,
                         "the file says that its axes run towards %s; where that is wrong, correct "
                         "the file, so that every program knows; nothing has changed",
                         towards);
    return OK;
}

enum err act_orient(const struct act *act)
{
    const struct session *session = act->session;
    const char *how = act_text(act, "HOW");
    char *orient = act->next->kept.orient;
    const bool by_file = strcmp(how, "file") == 0;
    enum err err = by_file ? OK : check_orient(session, how, act->fault);
    if (err)
        return err;
    memset(orient, 0, sizeof act->next->kept.orient);
    if (!by_file)
        memcpy(orient, how, strlen(how));
    err = act_go(act);
    const struct choice who = choice_at(ORIENTATIONS, session_geometry(session)->orientation);
    buf_printf(&act->reply->words, "orientation=%.*s", (int)who.length, who.word);
    act_write_axes(&act->reply->text, session_geometry(session));
    buf_add_char(&act->reply->text, '\n');
    return err;
}

void act_add_weights(const struct act *act)
{
    buf_printf(&act->reply->words, "weights=%016llx",
               (unsigned long long)session_weight_digest(act->session));
}

/* After a command that may have changed weights. */
static enum err add_weights(const struct act *act, enum err err)
{
    if (!err)
        act_add_weights(act);
    return err;
}

static enum err weigh_by_file(const struct act *act, const char *name)
{
    struct session *session = act->session;
    struct fault *fault = act->fault;
    const struct map_place place = session_map_place(session, act_is_yes(act, "resample"));
    struct volume map = {0};
    struct buf path = {0};
    enum err err = interpreter_find_file(act->interp, name, &path, fault);
    if (err) {
        struct near near = near_to(name);
        near_try_choices(&near, WEIGHT_KINDS);
        fault_prefix(fault, err, "expected " WEIGHT_KINDS " or a file");
        near_append(&near, "", fault);
    }
    if (!err)
        err = map_read(&map, buf_text(&path), &place, session_watch(session), fault);
    if (!err)
        err = act_naming(name, map_to_weights(&map, session_watch(session), fault), fault);
    if (!err)
        err = session_set_weight_map(session, name, map.intensity, fault);
    if (!err)
        buf_add_text(&act->reply->text, map.notes);
    volume_release(&map);
    buf_release(&path);
    return err;
}

#define ARGUMENT_NAME(name, type, least, most) name

/* What is given beside the name: what the row takes, and nothing else. */
static enum err take_argument(struct weight_choice *choice, const struct act *act)
{
    static const char *const name[] = {WEIGHT_ARGUMENTS(ARGUMENT_NAME, ARGUMENT_NAME)};
    const struct weight_row *row = &weight_table[choice->kind];
    for (unsigned i = 0; i < WEIGHT_ARGUMENT_COUNT; i++)
        if (act_has(act, name[i]) && row->takes != i)
            return fault_set(act->fault, ERR_USAGE, "%s: `weight %s` has none", name[i], row->name);
    if (act_has(act, "resample") && choice->kind != WEIGHT_FILE)
        return fault_set(act->fault, ERR_USAGE, "resample: `weight %s` has none", row->name);
    if (row->takes == WEIGHT_TAKES_NOTHING)
        return OK;
    if (!act_has(act, name[row->takes]) && !row->usual)
        return fault_set(act->fault, ERR_USAGE, "%s: `weight %s` needs one", name[row->takes],
                         row->name);
    choice->argument = (uint32_t)act_number_or(act, name[row->takes], row->usual);
    return OK;
}

enum err act_weight(const struct act *act)
{
    const bool is_file = act_number(act, "FILE") < 0;
    struct kept *kept = &act->next->kept;
    kept->weight = (struct weight_choice){
        is_file ? WEIGHT_FILE : (enum weight_kind)act_number(act, "FILE"), 0};
    const enum err err = take_argument(&kept->weight, act);
    if (err)
        return err;
    if (is_file)
        return add_weights(act, weigh_by_file(act, act_text(act, "FILE")));
    kept->weight_map = NULL;
    memset(kept->weight_file, 0, sizeof kept->weight_file);
    return add_weights(act, act_go(act));
}

enum err act_polarity(const struct act *act)
{
    act->next->kept.polarity[act_number(act, "LABEL")] = (int8_t)act_number(act, "PERCENT");
    if (act->next->kept.weight.kind != WEIGHT_POLARITY)
        buf_add_text(&act->reply->text, "used only under `weight polarity`\n");
    return add_weights(act, act_go(act));
}

/* Of several words where `blanks` are allowed, but for one at the end, which nobody would see. */
static bool is_fit(const char *name, size_t room, bool blanks)
{
    const unsigned char first = (unsigned char)*name;
    const size_t length = strlen(name);
    return length < room && (first >= 0x80 || isalpha(first)) && *safe_end(name) == '\0' &&
           !strpbrk(name, blanks ? "=\"\\" : " =\"\\") && name[length - 1] != ' ';
}

enum err act_check_name(const char *name, size_t room, bool blanks, struct fault *fault)
{
    return is_fit(name, room, blanks)
               ? OK
               : fault_set(fault, ERR_USAGE,
                           "NAME: expected %s of at most %zu bytes that begins "
                           "with a letter, not %s",
                           blanks ? "a name" : "a word", room - 1, name);
}

/* What `number` says, where it is given. */
static enum err take_number(const struct act *act, size_t label)
{
    struct kept *kept = &act->next->kept;
    const struct value *number = act_value(act, "number");
    if (!number->given)
        return OK;
    if (label == 0)
        return fault_set(act->fault, ERR_USAGE, "number: label 0 is 0 in every file");
    for (unsigned other = 1; other < 256; other++)
        if (other != label && kept->label_number[other] == number->number)
            return fault_set(act->fault, ERR_USAGE, "number: %lld is that of label %u already",
                             (long long)number->number, other);
    kept->label_number[label] = (uint16_t)number->number;
    return OK;
}

enum err act_label(const struct act *act)
{
    struct kept *kept = &act->next->kept;
    const size_t label = (size_t)act_number(act, "LABEL");
    const char *name = act_text(act, "NAME");
    const enum err err = act_check_name(name, LABEL_NAME_BYTES, true, act->fault);
    if (err)
        return err;
    for (size_t other = 0; other < 256; other++)
        if (other != label && strcmp(kept->label_name[other], name) == 0)
            return fault_set(act->fault, ERR_USAGE, "label %zu is already called %s", other, name);
    const enum err numbered = take_number(act, label);
    if (numbered)
        return numbered;
    memset(kept->label_name[label], 0, LABEL_NAME_BYTES);
    memcpy(kept->label_name[label], name, strlen(name));
    for (int k = 0; act_has(act, "COLOUR") && k < 3; k++)
        kept->palette.rgb[label][k] = (uint8_t)(act_number(act, "COLOUR") >> (16 - 8 * k));
    return act_go(act);
}
