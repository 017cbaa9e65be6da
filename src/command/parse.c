/* SPDX-License-Identifier: MIT */
#include "command/command.h"

#include <assert.h>
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "command/near.h"
#include "image/geometry.h"
#include "journal/record.h"
#include "session/map.h"
#include "session/session.h"

const struct command *command_find(const char *name)
{
    for (unsigned i = 0; i < command_count(); i++)
        if (strcmp(command_at(i)->name, name) == 0)
            return command_at(i);
    return NULL;
}

void command_try_names(struct near *near)
{
    for (unsigned i = 0; i < command_count(); i++) {
        const struct command *command = command_at(i);
        near_try(near, command->name, strlen(command->name));
        if (command->also)
            near_lead(near, command->also, command->name);
    }
}

/* Report an unknown name: "WHAT sede; did you mean seed?", or "WHAT xyz; `help all` lists them". */
static enum err report_unknown(struct fault *fault, const char *what, const char *word)
{
    struct near near = near_to(word);
    command_try_names(&near);
    if (near.count == 0 || near.count > NEAR_MOST)
        return fault_set(fault, ERR_USAGE, "%s %s; `help all` lists them", what, word);
    fault_set(fault, ERR_USAGE, "%s %s", what, word);
    near_append(&near, "", fault);
    return ERR_USAGE;
}

/* ---- words ---- */

/* Return the first byte that is not UTF-8 text or is a control character other than a tab, or the
 * end. */
static const char *end_of_text(const char *line)
{
    for (line = safe_end(line); *line == '\t'; line = safe_end(line + 1))
        ;
    return line;
}

/* Set the position of an error to `place` in `line`. */
static enum err at_place(enum err err, const char *line, const char *place, struct fault *fault)
{
    if (fault)
        fault->at = (size_t)(place - line) + 1;
    return err;
}

/* Return the length of "name=" if a value in double quotes follows and ends the word; else 0. */
static size_t length_of_key(const char *word)
{
    const size_t key = strspn(word, "abcdefghijklmnopqrstuvwxyz-");
    const char *at = word + key;
    if (key == 0 || at[0] != '=' || at[1] != '"')
        return 0;
    for (at += 2; *at && *at != '"'; at++)
        at += at[0] == '\\' && at[1];
    return at[0] && (!at[1] || at[1] == ' ' || at[1] == '\t') ? key + 1 : 0;
}

bool command_take_word(const char **cursor, struct buf *out)
{
    const char *at = *cursor;
    const size_t key = length_of_key(at);
    buf_add(out, at, key);
    at += key;
    const char quote = *at == '"' || *at == '\'' ? *at : '\0';
    const bool quoted = quote != '\0';
    at += quoted;
    while (*at && (quoted ? *at != quote : *at != ' ' && *at != '\t')) {
        if (quote == '"' && *at == '\\' && (at[1] == '"' || at[1] == '\\'))
            at++;
        buf_add_char(out, *at++);
    }
    buf_add_char(out, '\0');
    if (quoted && *at != quote)
        return false;
    *cursor = at + quoted;
    return **cursor == '\0' || **cursor == ' ' || **cursor == '\t';
}

/* Add the words of a line to `out`, each ended by NUL. */
static enum err split_words(struct buf *out, unsigned *count, const char *line, struct fault *fault)
{
    const char *at = line, *text_end;
    *count = 0;
    if (strlen(line) > RECORD_LINE_MAX)
        return fault_set(fault, ERR_USAGE, "the command is longer than %d bytes", RECORD_LINE_MAX);
    text_end = end_of_text(line);
    if (*text_end)
        return at_place(fault_set(fault, ERR_USAGE,
                                  "a command is UTF-8 text without control characters, not %s",
                                  line),
                        line, text_end, fault);
    for (scan_blanks(&at); *at; scan_blanks(&at)) {
        const char *word = at;
        if (!command_take_word(&at, out))
            return at_place(fault_set(fault, ERR_USAGE, "a word in quotes does not end: %s", word),
                            line, word, fault);
        ++*count;
    }
    if (out->length && memchr(out->data, '\t', out->length)) /* it could not be recorded */
        return fault_set(fault, ERR_USAGE, "a tab in a word; tabs may only separate words");
    return out->failed ? fault_memory(fault, "a command") : OK;
}

/* ---- values ---- */

/* Scene and names for positions and labels. */
struct known {
    const struct session *session;
    const struct kept *kept;
};

/* Report "LABELS: expected none|tint or a number 1..3, not tnit; did you mean tint?". */
static enum err report_expected(struct fault *fault, const struct parameter *p, const char *word,
                                const char *expected)
{
    const char *choices = p->choices ? p->choices : "";
    fault_set(fault, ERR_USAGE, "%s: expected %s%s%s, not %s", p->name, choices,
              *choices && *expected ? " or " : "", expected, *word ? word : "nothing");
    return near_append_choices(word, choices, fault);
}

static enum err read_position(struct value *value, const struct parameter *p, const char *word,
                              const struct known *known, struct fault *fault)
{
    const char *at = word;
    int64_t part[3], place[3];
    if (!known->session->has_scene)
        return fault_set(fault, ERR_USAGE, "no scene is open; open one first");
    const bool reads = scan_three(&at, 6, INT64_C(-1000000000000), INT64_C(1000000000000), part);
    const bool world = reads && scan_text(&at, "mm");
    if (!reads || *at)
        return report_expected(fault, p, word, "X,Y,Z (voxel indices) or X,Y,Zmm (world)");
    for (int a = 0; a < 3; a++) {
        if (!world && part[a] % 1000000)
            return report_expected(fault, p, word, "whole voxel indices, or mm at the end");
        place[a] = part[a] / 1000000;
    }
    if (world && !geometry_has_place(&known->session->geometry))
        return fault_set(fault, ERR_INPUT,
                         "%s: the position of this scene in the world is unknown; expected voxel "
                         "indices, as in 0,0,0; nothing has changed",
                         word);
    const double point[3] = {(double)part[0] / 1e6, (double)part[1] / 1e6, (double)part[2] / 1e6};
    const uint32_t *size = known->session->scene->grid.size;
    if ((world && !geometry_voxel(&known->session->geometry, point, place)) ||
        !grid_contains(&known->session->scene->grid, place[0], place[1], place[2]))
        return fault_set(fault, ERR_INPUT,
                         "%s is outside the scene, whose voxels are 0,0,0 to %u,%u,%u; "
                         "nothing has changed",
                         word, size[0] - 1, size[1] - 1, size[2] - 1);
    for (int a = 0; a < 3; a++)
        value->place[a] = (uint32_t)place[a];
    return OK;
}

/* Report that no label has a number, with the nearest one, and how to make it. */
static enum err report_number(const struct parameter *p, uint32_t number, const struct known *known,
                              struct fault *fault)
{
    const uint32_t nearest = numbering_nearest(known->kept, number, (uint32_t)p->least);
    const char *name = known->kept->label_name[numbering_find(known->kept, nearest)];
    return fault_set(fault, ERR_USAGE,
                     "%s: there is no label %u; the nearest is %u%s%s; `label %u NAME` makes it",
                     p->name, number, nearest, *name ? " " : "", name, number);
}

/* A label by its number, or by its name. With `makes`, a number that no label has yet is accepted,
 * as NUMBER_UNKNOWN. */
static enum err read_label(struct value *value, const struct parameter *p, const char *word,
                           const struct known *known, struct fault *fault)
{
    const bool is_numbered = numbering_is_used(known->kept);
    const char *at = word;
    int64_t number;
    if (scan_integer(&at, p->least, UINT32_MAX, &number) && *at == '\0') {
        value->place[0] = (uint32_t)number;
        value->number = numbering_find(known->kept, (uint32_t)number);
        if (value->number >= 0 || p->makes)
            return OK;
        if (is_numbered)
            return report_number(p, (uint32_t)number, known, fault);
    }
    for (int label = (int)p->least; label < 256; label++)
        if (*word && strcmp(known->kept->label_name[label], word) == 0) {
            value->number = label;
            value->place[0] = numbering_of(known->kept, (unsigned)label);
            return OK;
        }
    const char *choices = p->choices ? p->choices : "";
    struct near near = near_to(word);
    near_try_choices(&near, choices);
    for (int label = (int)p->least; label < 256; label++)
        near_try(&near, known->kept->label_name[label], strlen(known->kept->label_name[label]));
    const char *after = near.count ? "" : "; name one with `label N NAME`";
    if (is_numbered)
        fault_set(fault, ERR_USAGE, "%s: expected %s%sthe number or the name of a label, not %s%s",
                  p->name, choices, *choices ? ", " : "", word, after);
    else
        fault_set(fault, ERR_USAGE, "%s: expected %s%sa label %d..255 or the name of one, not %s%s",
                  p->name, choices, *choices ? ", " : "", (int)p->least, word, after);
    near_append(&near, "", fault);
    return ERR_USAGE;
}

/* Add the labels with numbers first..last. At least one exists; if labels are not numbered, all. */
static enum err read_label_range(struct value *value, const struct parameter *p, int64_t first,
                                 int64_t last, const char *word, const struct known *known,
                                 struct fault *fault)
{
    bool found = false;
    if (last > 255 && !numbering_is_used(known->kept))
        return read_label(value, p, word, known, fault);
    for (unsigned label = 0; label < 256; label++) {
        const uint32_t number = numbering_of(known->kept, label);
        if ((label && !number) || number < first || number > last)
            continue;
        label_set_add(&value->set, (uint8_t)label);
        found = true;
    }
    return found ? OK : report_number(p, (uint32_t)first, known, fault);
}

/* Read labels with commas between them, each a number, a range A-B or a name. */
static enum err read_labels(struct value *value, const struct parameter *p, const char *word,
                            const struct known *known, struct fault *fault)
{
    OWNED(buf_release) struct buf item = {0};
    enum err err = *word ? OK : read_label(value, p, word, known, fault);
    for (const char *at = word; !err && *at; at += *at == ',') {
        const size_t length = strcspn(at, ",");
        const char *number;
        int64_t first, last;
        buf_clear(&item);
        buf_add(&item, at, length);
        number = buf_text(&item);
        if (item.failed)
            err = fault_memory(fault, "a command");
        else if (scan_range(&number, 0, UINT32_MAX, &first, &last) && !*number)
            err = read_label_range(value, p, first, last, buf_text(&item), known, fault);
        else if (!(err = read_label(value, p, buf_text(&item), known, fault)))
            label_set_add(&value->set, (uint8_t)value->number);
        at += length;
    }
    value->number = 0;
    value->place[0] = 0;
    return err;
}

static enum err read_number(struct value *value, const struct parameter *p, const char *word,
                            unsigned places, struct fault *fault)
{
    const char *at = word;
    if (scan_decimal(&at, places, p->least, p->most, &value->number) && *at == '\0')
        return OK;
    const double unit = places ? 1000 : 1;
    char expected[96];
    snprintf(expected, sizeof expected, "a number %.15g..%.15g%s", (double)p->least / unit,
             (double)p->most / unit, places ? " with at most three decimals" : "");
    return report_expected(fault, p, word, expected);
}

static enum err report_expected_range(struct fault *fault, const struct parameter *p,
                                      const char *word, const char *more)
{
    return fault_set(fault, ERR_USAGE, "%s: expected A-B, or A, within %lld-%lld, not %s%s",
                     p->name, (long long)p->least, (long long)p->most, *word ? word : "nothing",
                     more);
}

static enum err read_range(struct value *value, const struct parameter *p, const char *word,
                           struct fault *fault)
{
    const char *at = word;
    int64_t first, last;
    if (!scan_range(&at, p->least, p->most, &first, &last) || *at)
        return report_expected_range(fault, p, word, "");
    value->place[0] = (uint32_t)first;
    value->place[1] = (uint32_t)last;
    return OK;
}

/* Read a REAL or an INTERVAL; of an interval that is paired with HIGH, LOW alone is accepted. */
static enum err read_real(struct value *value, const struct parameter *p, const char *word,
                          const struct known *known, struct fault *fault)
{
    const bool is_interval = p->type == VALUE_INTERVAL;
    const char *at = word;
    unsigned channel = 0;
    bool reads = is_interval && interval_scan(&at, &channel, value->real);
    value->number = is_interval && !reads ? -1 : (int64_t)channel;
    if (!reads && (!is_interval || p[1].paired))
        reads = decimal_scan(&at, value->real);
    if (reads && *at == '\0')
        TRY(kept_has_channel(known->kept, channel, fault));
    return reads && *at == '\0'
               ? OK
               : report_expected(
                     fault, p, word,
                     is_interval
                         ? "LOW..HIGH, as in 40..1200.5, or 2:LOW..HIGH of channel 2, of at most "
                           "19 digits each"
                         : "a number, as in 40, -0.5 or 1.5e-3, of at most 19 digits");
}

static enum err read_radius(struct value *value, const struct parameter *p, const char *word,
                            struct fault *fault)
{
    static const int64_t nm_most = 1000000000;
    const char *at = word;
    if (scan_integer(&at, p->least, p->most, &value->number) && *at == '\0')
        return OK;
    at = word;
    value->in_mm =
        scan_decimal(&at, 6, 1, nm_most, &value->number) && scan_text(&at, "mm") && *at == '\0';
    if (value->in_mm)
        return OK;
    char expected[160];
    snprintf(expected, sizeof expected,
             "a number %lld..%lld, or millimetres as in 2.5mm, above 0 and up to 1000 with at "
             "most six decimals",
             (long long)p->least, (long long)p->most);
    return report_expected(fault, p, word, expected);
}

static enum err read_colour(struct value *value, const struct parameter *p, const char *word,
                            struct fault *fault)
{
    char lower[8] = "";
    const char *at = lower + 1;
    uint64_t colour;
    for (size_t i = 0; i < 7 && word[i]; i++)
        lower[i] = (char)tolower((unsigned char)word[i]);
    if (*word != '#' || !scan_hex(&at, 6, &colour) || word[7])
        return report_expected(fault, p, word, "#rrggbb (quote a name with blanks)");
    value->number = (int64_t)colour;
    return OK;
}

/* Add one of several parts. */
static enum err read_part(struct value *value, const struct parameter *p, const char *word,
                          int choice, struct fault *fault)
{
    const int none = choice_find(p->choices, strrchr(p->choices, '|') + 1), all = none - 1;
    if (choice < 0)
        return report_expected(fault, p, word, "");
    if (value->given && (choice == none || value->number == 0))
        return fault_set(fault, ERR_USAGE, "expected %s alone; nothing has changed",
                         strrchr(p->choices, '|') + 1);
    value->number |= choice == none ? 0 : choice == all ? (1 << all) - 1 : 1 << choice;
    value->given = true;
    return OK;
}

static enum err read_value(struct value *value, const struct parameter *p, const char *word,
                           const struct known *known, struct fault *fault)
{
    const int choice = p->choices ? choice_find(p->choices, word) : -1;
    if (p->type == VALUE_PARTS)
        return read_part(value, p, word, choice, fault);
    value->given = true;
    if (choice < 0)
        switch (p->type) {
        case VALUE_POSITION:
        case VALUE_LINE:
            return read_position(value, p, word, known, fault);
        case VALUE_LABEL:
            return read_label(value, p, word, known, fault);
        case VALUE_LABELS:
            return read_labels(value, p, word, known, fault);
        case VALUE_NUMBER:
            return read_number(value, p, word, 0, fault);
        case VALUE_RADIUS:
            return read_radius(value, p, word, fault);
        case VALUE_RANGE:
            return read_range(value, p, word, fault);
        case VALUE_LIST:
            if (!scan_is_list(word, p->least, p->most))
                return report_expected_range(fault, p, word, "; several have commas between them");
            break;
        case VALUE_REAL:
        case VALUE_INTERVAL:
            return read_real(value, p, word, known, fault);
        case VALUE_DECIMAL:
            return read_number(value, p, word, 3, fault);
        case VALUE_COLOUR:
            return read_colour(value, p, word, fault);
        case VALUE_CHOICE:
            return report_expected(fault, p, word, "");
        case VALUE_COMMAND:
            if (!command_find(word))
                return report_unknown(fault, "there is no command", word);
            break;
        default:
            if (!*word)
                return report_expected(fault, p, word, "a word");
        }
    value->text = word;
    value->number = choice;
    return OK;
}

/* ---- calls ---- */

/* True if an optional number before an optional file is skipped, since the word has a dot. */
static bool is_passed_over(const struct parameter *p, const char *word)
{
    return p->type == VALUE_NUMBER && p->optional && !p->keyed && p[1].type == VALUE_FILE &&
           strchr(word, '.');
}

int command_parameter_for(const struct command *command, const struct value *value,
                          const char **word)
{
    const struct parameter *p = command->parameter;
    for (int i = 0; p[i].type; i++) {
        size_t n = strlen(p[i].name);
        if (p[i].keyed && strncmp(*word, p[i].name, n) == 0 && (*word)[n] == '=') {
            *word += n + 1;
            return i;
        }
    }
    for (int i = 0; p[i].type; i++)
        if (!p[i].keyed && (!value[i].given || p[i].type == VALUE_PARTS) &&
            !is_passed_over(&p[i], *word))
            return i;
    return -1;
}

static enum err usage_fault(struct fault *fault, const struct command *command, const char *what,
                            const char *word)
{
    OWNED(buf_release) struct buf usage = {0};
    command_usage(&usage, command);
    return fault_set(fault, ERR_USAGE, "%s%s; usage: %s", what, word, buf_text(&usage));
}

/* Report a word "key=value" whose key is near a key of the command. */
static bool is_near_a_key(const struct command *command, const char *word, struct fault *fault)
{
    const struct parameter *p = command->parameter;
    const size_t length = strcspn(word, "=");
    char key[NEAR_BYTES_MOST + 1];
    if (word[length] == '\0' || length >= sizeof key)
        return false;
    memcpy(key, word, length);
    key[length] = '\0';
    struct near near = near_to(key);
    for (int i = 0; p[i].type; i++)
        if (p[i].keyed && strcmp(p[i].name, key) != 0)
            near_try(&near, p[i].name, strlen(p[i].name));
    if (near.count == 0 || near.count > NEAR_MOST)
        return false;
    fault_set(fault, ERR_USAGE, "%s has no %s=", command->name, key);
    near_append(&near, "=", fault);
    return true;
}

static enum err fill_parameter(struct call *call, const char *word, const struct known *known,
                               struct fault *fault)
{
    const char *whole = word;
    int i = command_parameter_for(call->command, call->value, &word);
    const struct parameter *p = &call->command->parameter[i < 0 ? 0 : i];
    struct value *value = &call->value[i < 0 ? 0 : i];
    enum err err = OK;
    if (i < 0)
        err = usage_fault(fault, call->command,
                          call->command->parameter->is_scene
                              ? "one word too many (`channel FILE` adds another file): "
                              : "one word too many: ",
                          whole);
    else if (value->given && p->type != VALUE_LINE && p->type != VALUE_PARTS)
        return usage_fault(fault, call->command, "given twice: ", whole);
    else
        err = read_value(value, p, word, known, fault);
    if (!err && i >= 0 && p->type == VALUE_LINE && !polyline_add(&call->line, value->place))
        err = fault_memory(fault, "a line");
    if (err == ERR_USAGE && word == whole)
        is_near_a_key(call->command, word, fault);
    return err;
}

/* Put the position of the command in front of its line. */
static enum err prepend_start(struct call *call, struct value *value, struct fault *fault)
{
    struct polyline whole = {0};
    bool fits = polyline_add(&whole, call->value->place);
    for (size_t i = 0; fits && i < call->line.count; i++)
        fits = polyline_add(&whole, call->line.corner[i]);
    polyline_release(&call->line);
    call->line = whole;
    value->given = whole.count > 1;
    value->line = value->given ? &call->line : NULL;
    memset(value->place, 0, sizeof value->place);
    return fits ? OK : fault_memory(fault, "a line");
}

/* Read the words of a line after `split`. */
static enum err read_words(struct call *call, unsigned count, const struct known *known,
                           unsigned *wrong, struct fault *fault)
{
    const char *word = call->store.data;
    *wrong = 0;
    call->command = command_find(word);
    if (!call->command)
        return report_unknown(fault, "unknown command", word);
    for (*wrong = 1; *wrong < count; ++*wrong) {
        word += strlen(word) + 1;
        TRY(fill_parameter(call, word, known, fault));
    }
    const struct parameter *p = call->command->parameter;
    struct value *line = NULL;
    for (int i = 0; p[i].type; i++) {
        struct value *value = &call->value[i];
        if (!p[i].optional && !value->given)
            return usage_fault(fault, call->command, "missing: ", p[i].name);
        if (p[i].type == VALUE_INTERVAL && p[i + 1].paired && value->given && !value->text &&
            !value->number && !value[1].given) { /* LOW..HIGH; the canonical form is LOW HIGH */
            value[1] = (struct value){.given = true, .real = {value->real[1]}};
            *value = (struct value){.given = true, .number = -1, .real = {value->real[0]}};
        }
        if (p[i].type == VALUE_LINE && value->given)
            line = value;
    }
    return line ? prepend_start(call, line, fault) : OK;
}

/* Return the position of the word of this number; after the last word, one byte behind. */
static const char *place_of_word(const char *line, unsigned number)
{
    OWNED(buf_release) struct buf word = {0};
    const char *end = line;
    for (scan_blanks(&line); *line && number > 0; scan_blanks(&line), number--) {
        command_take_word(&line, &word);
        end = line;
    }
    return *line ? line : end + 1;
}

enum err command_parse(struct call *call, const char *line, const struct session *session,
                       struct fault *fault)
{
    return command_parse_by(call, line, session, &session->now.kept, fault);
}

enum err command_parse_by(struct call *call, const char *line, const struct session *session,
                          const struct kept *kept, struct fault *fault)
{
    const struct known known = {session, kept};
    unsigned count, wrong;
    const char *at = line;
    *call = (struct call){.kept = kept};
    scan_blanks(&at);
    if (*at == '#')
        return OK;
    enum err err = split_words(&call->store, &count, line, fault);
    if (!err && count > 0) {
        err = read_words(call, count, &known, &wrong, fault);
        if (err)
            at_place(err, line, place_of_word(line, wrong), fault);
    }
    if (err)
        call_release(call);
    return err;
}

/* True if the words of an error contain this word, not as a part of another. */
static bool contains_word(const char *text, const char *word)
{
    static const char after[] = " ,;:?";
    const size_t length = strlen(word);
    for (const char *at = text; length > 1 && (at = strstr(at, word)); at++)
        if ((at == text || at[-1] == ' ') && (!at[length] || strchr(after, at[length])))
            return true;
    return false;
}

void command_point_at(const struct call *call, const char *line, struct fault *fault)
{
    const struct parameter *p = call->command->parameter;
    const char *wrong = NULL, *at = line;
    OWNED(buf_release) struct buf word = {0};
    for (int i = 0; p[i].type && !wrong; i++) {
        const char *text = call->value[i].text;
        if (text && contains_word(fault->text, text))
            wrong = text;
    }
    for (scan_blanks(&at); wrong && *at; scan_blanks(&at)) {
        const char *start = at;
        buf_clear(&word);
        command_take_word(&at, &word);
        if (start != line && strcmp(buf_text(&word), wrong) == 0) {
            at_place(fault->code, line, start, fault);
            return;
        }
    }
}

void call_release(struct call *call)
{
    buf_release(&call->store);
    buf_release(&call->settled);
    polyline_release(&call->line);
    *call = (struct call){0};
}

/* ---- by name ---- */

/* Return the number of a parameter in the table. */
static size_t number_of(const struct command *command, const char *name, size_t length)
{
    const struct parameter *p = command->parameter;
    size_t at = 0;
    while (p[at].type && (strncmp(p[at].name, name, length) != 0 || p[at].name[length]))
        at++;
    assert(p[at].type);
    return at;
}

const struct value *call_value(const struct call *call, const char *name)
{
    return call->value + number_of(call->command, name, strlen(name));
}

void call_set(struct call *call, const char *name, int64_t number, const char *word)
{
    struct value *value = call->value + number_of(call->command, name, strlen(name));
    *value = (struct value){.given = true, .number = number, .text = word};
}

const char *call_given(const struct call *call, const char *names)
{
    struct choice name;
    const char *given = NULL;
    while (choice_next(&name, &names)) {
        const size_t at = number_of(call->command, name.word, name.length);
        given = !given && call->value[at].given ? call->command->parameter[at].name : given;
    }
    return given;
}

struct label_set call_takes(const struct call *call)
{
    const struct value *over = call_value(call, "over"), *keep = call_value(call, "keep");
    struct label_set takes;
    for (int i = 0; i < 4; i++)
        takes.word[i] = (over->given ? over->set.word[i] : UINT64_MAX) & ~keep->set.word[i];
    return takes;
}

/* ---- comparing lines ---- */

bool command_opens(struct buf *name, bool *is_scene, bool *is_part, const char *line)
{
    static const char *const parts[] = {"data|resample", "crop|reduce|size"};
    struct call call;
    const char *at = line;
    buf_clear(name);
    scan_blanks(&at);
    const bool is_split = command_take_word(&at, name);
    const struct command *command = is_split ? command_find(buf_text(name)) : NULL;
    const struct parameter *file = command ? command->parameter : NULL;
    if (!file || !(file->is_scene || file->is_channel) ||
        command_parse_by(&call, line, NULL, NULL, NULL) != OK) /* no places or labels in these */
        return false;
    buf_clear(name);
    buf_add_text(name, call.value->text);
    *is_scene = file->is_scene;
    *is_part = call_has(&call, parts[*is_scene]);
    const bool is_number = call.value->number >= 0;
    call_release(&call);
    return !is_number;
}

bool command_is_same(const char *a, const char *b)
{
    const char *line[2] = {a, b};
    struct buf word[2] = {{0}, {0}};
    const struct command *command = NULL;
    bool same = strcmp(a, b) == 0, goes_on = !same;
    for (int n = 0; goes_on; n++) {
        for (int i = 0; i < 2; i++) {
            scan_blanks(&line[i]);
            buf_clear(&word[i]);
            goes_on = goes_on && *line[i] && command_take_word(&line[i], &word[i]);
        }
        const char *one = buf_text(&word[0]), *other = buf_text(&word[1]);
        if (n == 0)
            command = command_find(one);
        if (n == 1 && command && command->parameter[0].is_read) {
            one = file_name(one);
            other = file_name(other);
        }
        same = !word[0].failed && !word[1].failed && strcmp(one, other) == 0;
        goes_on = goes_on && same;
    }
    same = same && !*line[0] && !*line[1];
    buf_release(&word[0]);
    buf_release(&word[1]);
    return same || strcmp(a, b) == 0;
}

/* ---- canonical form ---- */

bool command_needs_quotes(const char *word)
{
    return !*word || strpbrk(word, " \t\"\\") || *word == '#' || *word == '\'';
}

void command_write_word(struct buf *out, const char *word)
{
    if (!command_needs_quotes(word)) {
        buf_add_text(out, word);
        return;
    }
    buf_add_char(out, '"');
    for (; *word; word++) {
        if (*word == '"' || *word == '\\')
            buf_add_char(out, '\\');
        buf_add_char(out, *word);
    }
    buf_add_char(out, '"');
}

static void write_value(struct buf *out, const struct call *call, const struct parameter *p,
                        const struct value *value)
{
    uint32_t number[256];
    const struct decimal part = decimal_of(value->number, value->in_mm ? 6 : 3);
    if (value->text)
        command_write_word(out, value->text);
    else if (p->type == VALUE_PARTS)
        setting_write_parts(out, p->choices, value->number);
    else if (p->type == VALUE_LABEL)
        buf_printf(out, "%u", value->place[0]);
    else if (p->type == VALUE_LABELS) {
        numbering_fill(number, call->kept);
        numbering_write_set(out, number, &value->set);
    } else if (p->type == VALUE_POSITION)
        buf_printf(out, "%u,%u,%u", value->place[0], value->place[1], value->place[2]);
    else if (p->type == VALUE_RANGE && value->place[0] == value->place[1])
        buf_printf(out, "%u", value->place[0]);
    else if (p->type == VALUE_RANGE)
        buf_printf(out, "%u-%u", value->place[0], value->place[1]);
    else if (p->type == VALUE_COLOUR)
        buf_printf(out, "#%06llx", (unsigned long long)value->number);
    else if (p->type == VALUE_INTERVAL && value->number >= 0)
        interval_write(out, (unsigned)value->number, value->real);
    else if (p->type == VALUE_REAL || p->type == VALUE_INTERVAL)
        decimal_write(out, &value->real[0]);
    else if (value->in_mm || p->type == VALUE_DECIMAL)
        decimal_write(out, &part);
    else
        buf_printf(out, "%lld", (long long)value->number);
    if (value->in_mm)
        buf_add_text(out, "mm");
}

static void write_corner(struct buf *out, const char *key, const uint32_t at[3])
{
    buf_printf(out, " %s=%u,%u,%u", key, at[0], at[1], at[2]);
}

void command_write(struct buf *out, const struct call *call)
{
    const struct parameter *p = call->command->parameter;
    buf_add_text(out, call->command->name);
    for (int i = 0; p[i].type; i++) {
        const struct value *value = &call->value[i];
        if (!value->given && p[i].type == VALUE_LINE && !p[i].optional)
            write_corner(out, p[i].name, call->value->place); /* the line is a single place */
        if (!value->given)
            continue;
        if (p[i].type == VALUE_LINE) {
            for (size_t k = 1; k < value->line->count; k++)
                write_corner(out, p[i].name, value->line->corner[k]);
            continue;
        }
        buf_add_char(out, ' ');
        if (p[i].keyed)
            buf_printf(out, "%s=", p[i].name);
        write_value(out, call, &p[i], value);
    }
}
