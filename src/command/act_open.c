/* SPDX-License-Identifier: MIT */
/* Commands that open a scene and set its orientation. */
#include "image/levels.h"
#include "image/volume_format.h"
#include "command/act.h"

#include <stdio.h>
#include <string.h>

#include "base/choice.h"
#include "base/scan.h"
#include "journal/record.h"

/* ---- parameters of `open` ---- */

static const char RAW[] = "raw:";
enum { SERIES_MOST = 100000 };

/* Read "X,Y,Z": three numbers of at least one unit, with this number of decimals. */
static bool read_three(uint32_t out[3], const char *text, unsigned places)
{
    int64_t number[3];
    if (!scan_three(&text, places, 1, UINT32_MAX, number) || *text)
        return false;
    for (int a = 0; a < 3; a++)
        out[a] = (uint32_t)number[a];
    return true;
}

/* Read "A-B,C-D,E-F". */
static enum err read_box(struct volume_choice *choice, const char *list, struct fault *fault)
{
    int64_t first, last;
    int axis = 0;
    choice->has_crop = true;
    for (; scan_list_range(&list, 0, UINT32_MAX, &first, &last); axis++)
        if (axis < 3) {
            choice->first[axis] = (uint32_t)first;
            choice->last[axis] = (uint32_t)last;
        }
    return axis == 3 ? OK
                     : fault_set(fault, ERR_USAGE,
                                 "crop: expected A-B,C-D,E-F, the voxels along x, y and z, and not "
                                 "%d range%s; nothing was opened",
                                 axis, plural((uint64_t)axis));
}

static enum err read_layout(struct raw_layout *raw, const struct act *act)
{
    enum voxel_type type = VOXEL_UINT8;
    if (!act_has(act, "size") || !act_has(act, "type"))
        return fault_set(act->fault, ERR_USAGE,
                         "raw: expected its layout: size=X,Y,Z type=" OPEN_TYPES
                         ", and where it differs, endian=big offset=BYTES spacing=X,Y,Z in mm");
    if (!read_three(raw->size, act_text(act, "size"), 0))
        return fault_set(act->fault, ERR_USAGE, "size: expected X,Y,Z in voxels, as 512,512,400");
    voxel_type_named(&type, act_text(act, "type"));
    raw->type = type;
    raw->big_endian = act_number(act, "endian") == 1;
    raw->offset = (uint64_t)act_number(act, "offset");
    return OK;
}

/* Read "3", or a part of a description. */
static enum err read_series(struct volume_choice *choice, const char *text, struct fault *fault)
{
    int64_t number;
    const char *at = text;
    if (scan_integer(&at, 1, SERIES_MOST, &number) && !*at)
        choice->series = (uint32_t)number;
    else if (*text && text[strspn(text, "-0123456789")])
        choice->series_name = text;
    else
        return fault_set(fault, ERR_USAGE,
                         "series: expected 1..%d, or a piece of its description, not %s; nothing "
                         "was opened",
                         SERIES_MOST, *text ? text : "nothing");
    return OK;
}

static enum err read_parameters(struct volume_choice *choice, const char **name,
                                const struct act *act)
{
    struct fault *fault = act->fault;
    *name = act_text(act, "FILE");
    *choice = (struct volume_choice){
        .has_volume = act_has(act, "volume"),
        .command = act->interp->has_options ? NULL : act->call->command->name,
        .volume = (uint32_t)act_number(act, "volume"),
        .reduce = (uint32_t)act_number(act, "reduce"),
        .data = act_text(act, "data"),
        .skip = act_text(act, "skip"),
        .fills_gaps = act_has(act, "missing"),
        .huge = act_is_yes(act, "huge"),
        .straightens = act_is_yes(act, "straighten"),
    };
    const bool is_raw = scan_text(name, RAW);
    if (!is_raw && act_has(act, "size|type|endian|offset"))
        return fault_set(fault, ERR_USAGE,
                         "size, type, endian and offset are only for `open raw:FILE`");
    if (act_has(act, "series"))
        TRY(read_series(choice, act_text(act, "series"), fault));
    if (act_has(act, "crop"))
        TRY(read_box(choice, act_text(act, "crop"), fault));
    if (is_raw)
        TRY(read_layout(&choice->raw, act));
    if (act_has(act, "spacing") && !read_three(choice->spacing_nm, act_text(act, "spacing"), 6))
        return fault_set(fault, ERR_USAGE,
                         "spacing: expected X,Y,Z in millimetres, as 0.5,0.5,1.25");
    /* Old records may have parameters about a file for a synthetic scene. */
    if (strncmp(*name, "synth:", 6) == 0 && act->interp->mode == MODE_LIVE &&
        act_has(act, "series|data|missing|skip|size|type|endian|offset|spacing|huge|private|"
                     "straighten"))
        return fault_set(fault, ERR_USAGE,
                         "series, data, missing, skip, spacing, huge and straighten are for files, "
                         "not for synthetic scenes; nothing was opened");
    return OK;
}

/* The initial weight. */

/* Read ":1.5" or nothing, for a weight of this row. */
static bool scan_argument(uint32_t *out, const char *text, const struct weight_row *row)
{
    const struct parameter *p = weight_parameter + row->takes;
    int64_t number = row->usual;
    if (*text &&
        (row->takes == WEIGHT_TAKES_NOTHING || !scan_text(&text, ":") ||
         !scan_decimal(&text, p->type == VALUE_DECIMAL ? 3 : 0, p->least, p->most, &number) ||
         *text))
        return false;
    *out = (uint32_t)number;
    return number != 0 || row->takes == WEIGHT_TAKES_NOTHING;
}

static enum err read_weight(struct weight_choice *weight, const char *text, struct fault *fault)
{
    const size_t length = strcspn(text, ":");
    struct choice name;
    unsigned kind = 0;
    for (const char *at = WEIGHT_KINDS; choice_next(&name, &at); kind++)
        if (name.length == length && memcmp(name.word, text, length) == 0) {
            weight->kind = (enum weight_kind)kind;
            if (scan_argument(&weight->argument, text + length, &weight_table[kind]))
                return OK;
        }
    return fault_set(fault, ERR_USAGE,
                     "weight: expected " WEIGHT_KINDS
                     ", with its number after a colon, as in gauss:1.5, not %s; `weight FILE` "
                     "reads a map once the scene is open; nothing "
                     "was opened",
                     text);
}

/* ---- the scene ---- */

/* Report the new scene. */
static void write_scene(const struct act *act)
{
    const struct session *session = act->session;
    struct reply *reply = act->reply;
    const struct scene *scene = session->scene;
    const uint32_t *size = scene->grid.size, *nm = scene->spacing_nm;
    buf_printf(&reply->words, "scene=%016llx size=%u,%u,%u spacing-nm=%u,%u,%u weights=%016llx",
               (unsigned long long)session->scene_digest, size[0], size[1], size[2], nm[0], nm[1],
               nm[2], (unsigned long long)session->weight_digest);
    buf_printf(&reply->text, "%ux%ux%u voxels", size[0], size[1], size[2]);
    act_write_spacing(&reply->text, session);
    buf_printf(&reply->text, ", %.1f MB\n", (double)session_memory(session) / 1e6);
}

/* Report facts missing in the file; the source of the orientation is recorded. */
static void write_orientation(const struct act *act)
{
    const struct session *session = act->session;
    struct reply *reply = act->reply;
    const struct choice who = choice_at(ORIENTATIONS, session->geometry.orientation);
    buf_printf(&reply->words, " orientation=%.*s", (int)who.length, who.word);
    buf_add_text(&reply->text, session->open_notes);
    if (session->geometry.orientation == ORIENTATION_UNKNOWN)
        buf_add_text(&reply->text, "orientation unknown: no picture or answer names a side of the "
                                   "patient\n");
    if (session->geometry.spacing_unknown)
        buf_add_text(&reply->text, "voxel spacing unknown: lengths and volumes are in voxels\n");
}

/* Find the file of a scene. A journal is rejected: `open` does not resume it. */
static enum err find_scene(const struct act *act, const char *name, bool by_proof, struct buf *path)
{
    const enum err err =
        interpreter_find_scene(act->interp, false, name, by_proof, path, act->fault);
    if (!err && interpreter_is_journal(buf_text(path)))
        return fault_set(act->fault, ERR_INPUT,
                         "%s is a journal, and `open` opens scenes; `iftty %s` in a shell resumes "
                         "it; nothing was opened",
                         name, name);
    if (!err && file_is_named(name, ".iftty") && act->interp->mode == MODE_LIVE)
        return fault_set(act->fault, ERR_INPUT,
                         "%s is named as a journal, and `open` opens scenes; nothing was opened",
                         name);
    if (err && file_is_named(name, ".iftty") && !interpreter_is_wary(act->interp))
        return fault_set(act->fault, err,
                         "there is no journal %s here, and `open` opens scenes; `iftty JOURNAL` in "
                         "a shell resumes a journal; nothing was opened",
                         name);
    return err;
}

/* A new record ends in weight=NAME, so that it means the same under another default; a record
 * without it means `morph`. */
static enum err take_first_weight(const struct act *act, bool *recorded)
{
    struct session *session = act->session;
    struct state next = session->now;
    struct weight_choice *weight = &next.kept.weight;
    const char *given = act_text(act, "weight");
    *recorded = false;
    if (session->has_scene)
        return OK; /* session_open reports the error */
    if (given)
        TRY(read_weight(weight, given, act->fault));
    else
        *recorded = act->interp->mode == MODE_LIVE;
    if (!given && !*recorded)
        *weight = (struct weight_choice){WEIGHT_MORPH, 1};
    return session_go(session, &next, NULL, 0, act->fault);
}

bool act_find_proof(const struct act *act, char proof[SHA256_HEX])
{
    static const char key[] = "sha256";
    const char *words = act->interp->replayed_words;
    struct record_word word;
    if (!words || !record_word_find(words, key, strlen(key), &word) ||
        word.value_length != SHA256_HEX - 1)
        return false;
    snprintf(proof, SHA256_HEX, "%.*s", (int)word.value_length, word.value);
    return true;
}

/* Open a file outside of the allowed folders if it is the scene of the record's proof. Else report
 * nothing and restore `choice`; only a stop is an error. */
static enum err open_outside(const struct act *act, const char *name, struct volume_choice *choice,
                             const char *proof)
{
    struct session *session = act->session;
    struct watch *watch = session->watch;
    struct buf *path = act_buf(act);
    struct fault unsaid = {0};
    choice->proof = proof;
    if (watch)
        watch->is_quiet = true;
    if (!session->has_scene && interpreter_find_outside(act->interp, false, name, path))
        session_open(session, buf_text(path), choice, &unsaid);
    if (watch)
        watch->is_quiet = false;
    choice->proof = NULL;
    return session->has_scene ? OK : watch_fault(watch, act->fault);
}

/* Record a series by its number in place of a part of its description, which may be about the
 * patient. */
static void write_canonical(const struct act *act, bool has_weight)
{
    struct buf *canonical = &act->reply->canonical;
    const struct session *session = act->session;
    struct call call = *act->call;
    buf_clear(canonical);
    if (session->series && call_has(&call, "series"))
        call_set(&call, "series", session->series, NULL);
    command_write(canonical, &call);
    if (has_weight) {
        buf_add_text(canonical, " weight=");
        const struct weight_choice *weight = &session->now.kept.weight;
        const struct weight_row *row = &weight_table[weight->kind];
        buf_add_text(canonical, row->name);
        if (weight->argument != row->usual)
            buf_printf(canonical, ":%g",
                       weight_parameter[row->takes].type == VALUE_DECIMAL
                           ? weight->argument / 1000.0
                           : weight->argument);
    }
}

/* Name the other files of a case whose channels have files of their own, CASE_0000.nii.gz and so
 * on. */
static void offer_channels(const struct act *act, const char *path, const char *name)
{
    const char *found = strrchr(file_name(path), '_');
    struct buf *next = act_buf(act), *out = &act->reply->text;
    const char *before = "other files of this case may be channels: `channel ";
    if (!found || strncmp(found, "_000", 4) != 0 || found[4] < '0' ||
        found[4] > '0' + CHANNELS_MOST || found[5] != '.' || act->interp->has_channels ||
        act->interp->mode != MODE_LIVE)
        return;
    for (char digit = '0'; digit <= '0' + CHANNELS_MOST; digit++) {
        buf_clear(next);
        buf_add(next, path, (size_t)(found - path) + 4);
        buf_printf(next, "%c%s", digit, found + 5);
        if (next->failed || digit == found[4] || !file_exists(buf_text(next)))
            continue;
        buf_clear(next);
        buf_add(next, name, strlen(name) - strlen(found) + 4);
        buf_printf(next, "%c%s", digit, found + 5);
        buf_add_text(out, before);
        command_write_word(out, buf_text(next));
        before = "`, `channel ";
    }
    buf_add_text(out, *before == '`' ? "`\n" : "");
}

void act_add_levels(const struct act *act, const struct levels *levels)
{
    if (levels)
        buf_printf(&act->reply->words, "%sscale=%.17g..%.17g beyond=%zu,%zu values=%016llx",
                   act->reply->words.length ? " " : "", levels->ends[0], levels->ends[1],
                   levels->beyond[0], levels->beyond[1], (unsigned long long)levels_digest(levels));
}

enum err act_open(const struct act *act)
{
    struct buf *path = act_buf(act);
    struct session *session = act->session;
    struct volume_choice choice;
    char proof[SHA256_HEX];
    const char *name;
    const bool had_scene = session->has_scene;
    bool has_weight = false;
    TRY(read_parameters(&choice, &name, act));
    choice.as_recorded = act->interp->mode != MODE_LIVE;
    choice.list = choice.as_recorded ? NULL : &act->reply->list;
    TRY(take_first_weight(act, &has_weight));
    /* only for a whole file with a header */
    const bool by_proof =
        !choice.raw.size[0] && !choice.has_crop && !choice.reduce && act_find_proof(act, proof);
    if (by_proof)
        TRY(open_outside(act, name, &choice, proof));
    if (!session->has_scene || had_scene) {
        TRY(find_scene(act, name, by_proof, path));
        TRY(session_open(session, buf_text(path), &choice, act->fault));
    }
    const bool is_private = act_is_yes(act, "private");
    /* The name of the scene in pictures is the last part of the name in the command. The name of a
     * folder is often a patient's. */
    const bool is_said = !is_private && !file_is_folder(buf_text(path));
    session_name_scene(session, is_said ? file_name(name) : "", is_private);
    write_canonical(act, has_weight);
    write_scene(act);
    write_orientation(act);
    if (!by_proof)
        offer_channels(act, buf_text(path), name);
    act_add_levels(act, session->levels);
    if (*session->proof)
        buf_printf(&act->reply->words, " sha256=%s", session->proof);
    return OK;
}

enum err act_interpolate(const struct act *act)
{
    const unsigned doubled =
        (unsigned)((act_number(act, "X") == 2) | (act_number(act, "Y") == 2) << 1 |
                   (act_number(act, "Z") == 2) << 2);
    TRY(session_interpolate(act->session, doubled, act->fault));
    write_scene(act);
    return OK;
}

/* Letters cannot contradict the file: if it is wrong, it is wrong for every other program and for
 * the maps of the scene, too. */
static enum err check_orient(const struct session *session, const char *how, struct fault *fault)
{
    const struct geometry *said = &session->said;
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
    TRY(by_file ? OK : check_orient(session, how, act->fault));
    memset(orient, 0, sizeof act->next->kept.orient);
    if (!by_file)
        memcpy(orient, how, strlen(how));
    TRY(act_go(act));
    const struct choice who = choice_at(ORIENTATIONS, session->geometry.orientation);
    buf_printf(&act->reply->words, "orientation=%.*s", (int)who.length, who.word);
    act_write_axes(&act->reply->text, &session->geometry);
    buf_add_char(&act->reply->text, '\n');
    return OK;
}
