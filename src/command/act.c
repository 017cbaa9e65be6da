/* SPDX-License-Identifier: MIT */
#include "command/act.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "image/names.h"
#include "session/map.h"
#include "show/label_loss.h"

/* Names, colours and own numbers of labels, from commands and tables; labels for the regions of
 * atlases; helpers shared by all acts. */

/* ---- by hand ---- */

enum err act_label(const struct act *act)
{
    struct kept *kept = &act->next->kept;
    const struct markers *markers = &act->session->markers;
    const struct value *other_number = act_value(act, "number");
    const uint32_t number = act_place(act, "LABEL")[0];
    int label = (int)act_number(act, "LABEL");
    const char *name = act_text(act, "NAME"), *code = act_text(act, "code");
    if (!label_name_fits(name))
        return fault_set(act->fault, ERR_USAGE,
                         "NAME: expected a name of at most %d bytes, with no = or \\ in it, no # "
                         "at its beginning and no blank at its ends, and no number, not %s",
                         LABEL_NAME_BYTES - 1, *name ? name : "nothing");
    for (int other = 0; other < 256; other++)
        if (other != label && strcmp(kept->label_name[other], name) == 0)
            return fault_set(act->fault, ERR_USAGE, "label %u is already called %s",
                             numbering_of(kept, (unsigned)other), name);
    const bool has_code = code && strcmp(code, "none") != 0;
    if (label == 0 ? has_code : has_code && !label_code_fits(code))
        return fault_set(act->fault, ERR_USAGE,
                         "code: expected none, or for a label above 0 SCHEME:VALUE[:MEANING], as "
                         "in SCT:10200004:Liver: 16 letters, digits or ._+/- at most each, and 64 "
                         "bytes without %s; not %s",
                         CODE_EXCLUDES, code);
    if (other_number->given && label == 0)
        return fault_set(act->fault, ERR_USAGE, "number: label 0 is 0 in every file");
    if (label == NUMBER_UNKNOWN)
        label = numbering_add(kept, number, markers);
    if (label == NUMBER_UNKNOWN)
        return fault_set(act->fault, ERR_LIMIT,
                         "LABEL: 255 labels exist, and no more fit into a session; give one of "
                         "them this number by `label LABEL NAME number=%u`; nothing has changed",
                         number);
    if (other_number->given &&
        !numbering_change(kept, label, (uint32_t)other_number->number, markers))
        return fault_set(act->fault, ERR_USAGE,
                         "number: there is a label %lld already; nothing has changed",
                         (long long)other_number->number);
    memset(kept->label_name[label], 0, LABEL_NAME_BYTES);
    memcpy(kept->label_name[label], name, strlen(name));
    if (code)
        memset(kept->label_code[label], 0, LABEL_CODE_BYTES);
    if (has_code)
        memcpy(kept->label_code[label], code, strlen(code));
    else if (!code && *kept->label_code[label])
        buf_printf(&act->reply->text, "its code remains %s; code=none removes it\n",
                   kept->label_code[label]);
    for (int k = 0; act_has(act, "COLOUR") && k < 3; k++)
        kept->palette.rgb[label][k] = (uint8_t)(act_number(act, "COLOUR") >> (16 - 8 * k));
    return act_go(act);
}

/* ---- regions of an atlas, and their names ---- */

enum err act_choose_regions(struct regions *regions, const struct act *act,
                            const struct value *label)
{
    if (label && label->given && act_has(act, "as"))
        return fault_set(act->fault, ERR_USAGE,
                         "as and label are mutually exclusive; expected one of them");
    return regions_read(regions, act_text(act, "regions"), act_text(act, "as"), act->fault);
}

enum { BESIDE_BYTES_MOST = 1 << 20, TABLE_BYTES_MOST = 16 << 20 };

static void name_table(struct buf *out, const char *atlas)
{
    buf_printf(out, "%.*s.txt", (int)strlen(atlas) - (file_is_named(atlas, ".gz") ? 3 : 0), atlas);
}

struct label_table atlas_table(const struct act *act, const char *path)
{
    struct label_table table = {0};
    struct buf *name = act_buf(act), *text = act_buf(act);
    name_table(name, path);
    if (!interpreter_is_wary(act->interp) && file_exists(buf_text(name)) &&
        file_read(text, buf_text(name), BESIDE_BYTES_MOST, NULL) == OK)
        label_table_read(&table, buf_text(text), text->length, false, NULL);
    return table;
}

void atlas_advise_names(const struct act *act, const bool has[256])
{
    struct buf *out = &act->reply->text, *path = act_buf(act), *name = act_buf(act);
    OWNED(label_table_release) struct label_table table = {0};
    bool is_nameless = false;
    for (unsigned label = 1; label < 256; label++)
        is_nameless |= has[label] && !*act->session->now.kept.label_name[label];
    if (is_nameless && interpreter_find_file(act->interp, act_text(act, "FILE"), path, NULL) == OK)
        table = atlas_table(act, buf_text(path));
    if (table.count) {
        name_table(name, act_text(act, "FILE"));
        buf_add_text(out, "their names: `label-file ");
        buf_add_safe_text(out, buf_text(name));
        if (act_has(act, "regions"))
            buf_printf(out, " regions=%s", act_text(act, "regions"));
        if (act_has(act, "as"))
            buf_printf(out, " as=%s", act_text(act, "as"));
        buf_add_text(out, "`\n");
    }
}

/* ---- out of a table ---- */

void act_write_changed_names(const struct act *act, const struct label_tally *tally)
{
    struct buf *out = &act->reply->text;
    if (!tally->changed)
        return;
    buf_printf(out, "%u name%s had to be changed to fit; the first is of label %u, now ",
               tally->changed, plural(tally->changed),
               numbering_of(&act->next->kept, tally->first_changed));
    buf_add_safe_text(out, act->next->kept.label_name[tally->first_changed]);
    buf_add_char(out, '\n');
}

enum err act_label_file(const struct act *act)
{
    const char *name = act_text(act, "FILE");
    OWNED(label_table_release) struct label_table table = {0};
    OWNED(regions_release) struct regions regions = {0};
    struct label_tally tally;
    struct buf *out = &act->reply->text, *path = act_buf(act), *text = act_buf(act);
    TRY(act_choose_regions(&regions, act, NULL));
    if (act_has(act, "as"))
        TRY(act_prefix_file(act, regions_check(&regions, &act->next->kept, act->fault)));
    TRY(act_prefix_file(act, interpreter_find_file(act->interp, name, path, act->fault)));
    TRY(act_prefix_file(act, file_read(text, buf_text(path), TABLE_BYTES_MOST, act->fault)));
    TRY(act_prefix_file(
        act,
        file_is_named(name, ".lut")
            ? label_table_read_lut(&table, (const uint8_t *)text->data, text->length, act->fault)
            : label_table_read(&table, buf_text(text), text->length, false, act->fault)));
    TRY(act_prefix_file(act,
                        label_table_apply(&act->next->kept, &tally, &table, &regions, act->fault)));
    const struct kept *was = &act->session->now.kept;
    unsigned codes = 0;
    for (int l = 1; l < 256; l++)
        codes += *was->label_code[l] && strcmp(was->label_name[l], act->next->kept.label_name[l]);
    buf_printf(out, "%u name%s and %u colour%s of labels\n", tally.names, plural(tally.names),
               tally.colours, plural(tally.colours));
    if (codes)
        buf_printf(out,
                   "%u label%s with another name than before, whose code remains: `label N "
                   "NAME code=none` removes it\n",
                   codes, plural(codes));
    if (tally.beyond && !act_has(act, "regions"))
        buf_printf(out, "%u more entr%s for no label; choose with regions=A,B as=1,2\n",
                   tally.beyond, tally.beyond == 1 ? "y is" : "ies are");
    act_write_changed_names(act, &tally);
    act_add_digest(act, "names", label_table_digest(&act->next->kept));
    return act_go(act);
}

enum err act_prefix_file(const struct act *act, enum err err)
{
    return fault_prefix(act->fault, err, "%s", act_text(act, "FILE"));
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
    struct buf *path = act_buf(act);
    if (!act_has(act, "report"))
        return OK;
    TRY(interpreter_output_path(act->interp, act_text(act, "report"), path, act->fault));
    if (!path->length)
        return OK;
    TRY(interpreter_will_write(act->interp, buf_text(path), mode, act->fault));
    TRY(file_write(buf_text(path), buf_text(text), text->length, mode, act->fault));
    act_write_file_line("wrote ", buf_text(path), act->reply);
    return OK;
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

enum err act_read_map(const struct act *act, struct volume *map, uint32_t first, uint32_t last)
{
    struct watch *watch = act->session->watch;
    struct map_place place = act_map_place(act);
    struct buf *path = act_buf(act), *range = act_buf(act);
    place.choice.segments = act_text(act, "regions");
    place.choice.threshold = (uint32_t)act_number(act, "threshold");
    if (last < UINT32_MAX) {
        buf_printf(range, "%u-%u", first, last);
        place.choice.segments = buf_text(range);
    }
    TRY(interpreter_find_file(act->interp, act_text(act, "FILE"), path, act->fault));
    TRY(map_read(map, buf_text(path), &place, watch, act->fault));
    buf_add_text(&act->reply->text, map->notes);
    return act_prefix_file(act, map_to_regions(map, first, last, watch, act->fault));
}

/* ---- labels ---- */

static enum err get_labels(const struct act *act, bool finished, struct labels *labels)
{
    struct session *session = act->session;
    *labels = labels_of_forest(session->scene);
    if (session->skims || !finished)
        return OK;
    TRY(session_labels(session, true, labels, act->fault));
    act_add_digest(act, "finished", session_finished_digest(session));
    return OK;
}

enum err act_write_losses(struct interpreter *interp, const struct labels *labels, bool only_new,
                          struct watch *watch, struct buf *out, struct fault *fault)
{
    struct label_loss loss;
    struct session *session = interp->session;
    TRY(label_loss_find(&loss, labels, session->team, watch, fault));
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
                          act->session->now.kept.finish.count > 0;
    const bool finished =
        as_shown ? session_shows_finished(act->session) : act_is_yes(act, "finished");
    if (as_shown) { /* pictures may show other labels in a replay */
        struct call said = *act->call;
        call_set(&said, "finished", !finished, finished ? "yes" : "no");
        buf_clear(&act->reply->canonical);
        command_write(&act->reply->canonical, &said);
    }
    TRY(get_labels(act, finished, labels));
    if (!labels->finished || act->interp->mode != MODE_LIVE)
        return OK;
    return act_write_losses(act->interp, labels, false, act->session->watch, &act->reply->text,
                            act->fault);
}

enum err act_take_shown(const struct act *act, struct labels *labels)
{
    return get_labels(act,
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
