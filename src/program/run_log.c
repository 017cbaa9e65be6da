/* SPDX-License-Identifier: MIT */
/* `iftty log`: a journal as text, in several forms, and its repair. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/json.h"
#include "base/version.h"
#include "command/act.h"
#include "image/volume.h"
#include "journal/graph.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "program/console.h"
#include "program/programs.h"
#include "report/label_table.h"
#include "session/semantics.h"
#include "tui/cells.h"
#include "tui/term.h"
#include "verify/signature.h"

/* ---- commands without what names people: comments, and the names of files ---- */

/*
 * A file becomes "scene" (what `open` opens) or "file-N", with its extension and, in a turntable,
 * its %03d; the same file keeps the same name. Every other word with a slash in it is taken for a
 * file too. Labels and golden images are named by the user's own words, and stay.
 */
struct anonymiser {
    struct buf names; /* of files met so far, in order, each ended by NUL */
};

/* One of "a|b|c", or a keyed parameter with its value. */
static bool is_word_of(const struct parameter *p, const char *word)
{
    const size_t name = strlen(p->name);
    if (p->keyed && strncmp(word, p->name, name) == 0 && word[name] == '=')
        return true;
    return p->choices && choice_find(p->choices, word) >= 0;
}

static bool is_file(const struct command *command, const char *word)
{
    if (strchr(word, '/'))
        return true;
    bool takes_file = false;
    for (unsigned i = 0; command && i < PARAMETERS_MOST; i++)
        takes_file |= command->parameter[i].type == VALUE_FILE;
    if (!takes_file || strncmp(word, "synth:", 6) == 0)
        return false;
    const bool is_number = word[strspn(word, "0123456789.-")] == '\0';
    const struct parameter *p = command->parameter;
    if (is_number && (p->type != VALUE_FILE || p->choices))
        return false;
    for (; p->type; p++)
        if (is_word_of(p, word))
            return false;
    return true;
}

/* From 1, in the order in which they were met. */
static unsigned number_of(struct anonymiser *anonymiser, const char *name)
{
    unsigned number = 1;
    const char *at = buf_text(&anonymiser->names), *end = at + anonymiser->names.length;
    for (; at < end; at += strlen(at) + 1, number++)
        if (strcmp(at, name) == 0)
            return number;
    buf_add(&anonymiser->names, name, strlen(name) + 1);
    return number;
}

/* ".nii.gz", ".png", "%03d.png"; "" where the ending might be a word. */
static const char *ending_of(const char *name)
{
    const char *dot = strrchr(name, '.'), *percent = strchr(name, '%');
    enum label_table_format format;
    size_t n = 0;
    if (label_table_ending(name, &format))
        return label_table_ending(name, &format);
    while (dot && isalnum((unsigned char)dot[1 + n]))
        n++;
    if (!dot || n > 4 || dot[1 + n] != '\0')
        return "";
    if (volume_ending(name))
        return volume_ending(name);
    if (percent && strspn(percent + 1, "0123456789") + 2 == (size_t)(dot - percent) &&
        dot[-1] == 'd')
        return percent;
    return dot;
}

static void add_name(struct anonymiser *anonymiser, struct buf *out, const char *name,
                     bool is_scene)
{
    struct buf word = {0};
    const char *ending = ending_of(file_name(name));
    if (is_scene)
        buf_add_text(&word, "scene");
    else
        buf_printf(&word, "file-%u%s", number_of(anonymiser, name), *ending == '%' ? "-" : "");
    buf_add_text(&word, ending);
    command_write_word(out, buf_text(&word));
    out->failed |= word.failed;
    buf_release(&word);
}

static void anonymise_command(struct anonymiser *anonymiser, struct buf *out, const char *command)
{
    struct buf word = {0};
    const struct command *known = NULL;
    bool is_open = false;
    for (unsigned n = 0; *command; n++) {
        const char *rest = command;
        buf_clear(&word);
        if (!command_take_word(&rest, &word, COMMAND_QUOTES)) {
            buf_add_text(out, "..."); /* a quote that does not end: nothing is sure */
            break;
        }
        const char *text = buf_text(&word);
        if (n == 0) {
            known = command_find(text);
            is_open = known && known->act == act_open;
        }
        if (n > 0 && is_file(known, text))
            add_name(anonymiser, out, text, is_open);
        else
            buf_add(out, command, (size_t)(rest - command));
        command = rest;
        for (; *command == ' ' || *command == '\t'; command++)
            buf_add_char(out, ' ');
    }
    out->failed |= word.failed | anonymiser->names.failed;
    buf_release(&word);
}

/* The commands of a journal or script, one a line: journal_script without comments and names. */
static enum err anonymise_script(struct buf *out, const char *bytes, size_t length,
                                 struct fault *fault)
{
    struct anonymiser anonymiser = {0};
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes, length, fault);
    while (!err && walk_next(&walk, &record) == WALK_RECORD) {
        anonymise_command(&anonymiser, out, record.command);
        buf_add_char(out, '\n');
    }
    if (!err)
        err = walk_judge(&walk, fault);
    if (out->failed)
        err = fault_memory(fault, "the commands of a journal");
    walk_release(&walk);
    buf_release(&anonymiser.names);
    return err;
}

/* ---- provenance: a journal as W3C PROV-JSON ---- */

/*
 * For those who record how data came to be (https://www.w3.org/submissions/prov-json/). Entities
 * are the scene (with its SHA-256), the state after each record (with its chain digest and result
 * words), each golden image, and the journal; activities are the commands; the agent is this
 * program. A command used the state before it, and the scene where it opened it; a state was
 * generated by its command and derived from the state before.
 */

/* The members of the document: the journal is read once for each. */
enum member { ENTITY, ACTIVITY, USED, GENERATED, DERIVED, ASSOCIATED, MEMBERS };

struct provenance {
    struct json json;
    enum member member; /* at hand: what belongs to another is passed over */
    struct journal_condition condition;
    struct anonymiser anonymiser;
    bool is_anonymous;
};

/* Begins a thing, "iftty:KIND-N": {. False where it belongs to another member. */
static bool begin(struct provenance *p, enum member member, const char *kind, size_t number)
{
    char key[64];
    if (member != p->member)
        return false;
    snprintf(key, sizeof key, "iftty:%s-%zu", kind, number);
    json_object(&p->json, key);
    return true;
}

/* One end of a relation, "prov:ROLE": "iftty:KIND-N". */
struct end {
    const char *role, *kind;
    size_t number;
};

static void add_end(struct json *json, const struct end *end)
{
    char key[64];
    snprintf(key, sizeof key, "prov:%s", end->role);
    json_format(json, key, "iftty:%s-%zu", end->kind, end->number);
}

static void relate(struct provenance *p, enum member member, struct end from, struct end to)
{
    char key[96];
    if (member != p->member)
        return;
    snprintf(key, sizeof key, "_:%c-%s-%zu-%s", "eaugds"[member], from.kind, from.number, to.kind);
    json_object(&p->json, key);
    add_end(&p->json, &from);
    add_end(&p->json, &to);
    json_end(&p->json);
}

static void add_words(struct json *json, const char *words)
{
    struct record_word word;
    struct buf key = {0};
    const char *end = words + strlen(words);
    while (record_word_next(&words, end, &word)) {
        buf_clear(&key);
        buf_add_text(&key, "iftty:");
        buf_add(&key, word.key, word.key_length);
        json_bytes(json, buf_text(&key), word.value, word.value_length);
    }
    json->out->failed |= key.failed;
    buf_release(&key);
}

static void add_state(struct provenance *p, const struct record *record)
{
    const size_t n = record->number;
    if (begin(p, ENTITY, "state", n)) {
        json_text(&p->json, "prov:type", "iftty:state");
        json_text(&p->json, "iftty:chain", record->chain.hex);
        if (record_judge(record, NULL))
            json_boolean(&p->json, "iftty:is-sound", false);
        add_words(&p->json, record->result);
        json_end(&p->json);
    }
    relate(p, GENERATED, (struct end){"entity", "state", n},
           (struct end){"activity", "command", n});
    if (n > 1) {
        relate(p, USED, (struct end){"activity", "command", n},
               (struct end){"entity", "state", n - 1});
        relate(p, DERIVED, (struct end){"generatedEntity", "state", n},
               (struct end){"usedEntity", "state", n - 1});
    }
}

/* What a command names: the scene, or a golden image. */
static void add_named(struct provenance *p, const char *kind, const struct record *record,
                      const char *argument)
{
    if (!begin(p, ENTITY, kind, record->number))
        return;
    json_format(&p->json, "prov:type", "iftty:%s", kind);
    json_text(&p->json, "prov:label", argument);
    add_words(&p->json, record->result);
    json_end(&p->json);
}

/* The command at the beginning of a line, NULL for one that this version does not know, and the
 * word after it. */
static const struct command *take_command(const char *line, struct buf *argument)
{
    struct buf name = {0};
    const struct command *command = NULL;
    if (command_take_word(&line, &name, COMMAND_QUOTES))
        command = command_find(buf_text(&name));
    line += strspn(line, " \t");
    if (!command_take_word(&line, argument, COMMAND_QUOTES))
        buf_clear(argument);
    argument->failed |= name.failed;
    buf_release(&name);
    return command;
}

static void add_record(struct provenance *p, const struct record *record)
{
    const struct end command = {"activity", "command", record->number};
    struct buf text = {0}, argument = {0};
    if (p->is_anonymous)
        anonymise_command(&p->anonymiser, &text, record->command);
    else
        buf_add_text(&text, record->command);
    const struct command *known = take_command(buf_text(&text), &argument);
    if (begin(p, ACTIVITY, "command", record->number)) {
        json_text(&p->json, "prov:label", buf_text(&text));
        json_end(&p->json);
    }
    relate(p, ASSOCIATED, command, (struct end){"agent", "program", 1});
    add_state(p, record);
    if (known && known->act == act_open) {
        add_named(p, "scene", record, buf_text(&argument));
        relate(p, USED, command, (struct end){"entity", "scene", record->number});
    } else if (known && known->act == act_golden) {
        add_named(p, "golden-image", record, buf_text(&argument));
        relate(p, GENERATED, (struct end){"entity", "golden-image", record->number}, command);
    }
    p->json.out->failed |= text.failed | argument.failed;
    buf_release(&text);
    buf_release(&argument);
}

/* The member at hand, from the whole journal. */
static enum err add_member(struct provenance *p, const char *name, const char *bytes, size_t length,
                           struct fault *fault)
{
    static const char *const member[MEMBERS] = {
        "entity", "activity", "used", "wasGeneratedBy", "wasDerivedFrom", "wasAssociatedWith"};
    struct walk walk;
    struct record record;
    const enum err err = walk_begin(&walk, bytes, length, fault);
    if (err)
        return err;
    json_object(&p->json, member[p->member]);
    if (begin(p, ENTITY, "journal", 1)) {
        json_text(&p->json, "prov:type", "iftty:journal");
        json_text(&p->json, "prov:label", p->is_anonymous ? "a journal" : name);
        json_count(&p->json, "iftty:records", p->condition.records);
        json_text(&p->json, "iftty:chain", p->condition.chain.hex);
        json_text(&p->json, "iftty:condition", p->condition.text);
        json_end(&p->json);
    }
    while (walk_next(&walk, &record) == WALK_RECORD)
        add_record(p, &record);
    json_end(&p->json);
    walk_release(&walk);
    return OK;
}

/* `name` is what to call the journal; `is_anonymous` leaves it out. ERR_CHECK for a script, which
 * has no results, ERR_INPUT for what cannot be read. A journal that is torn or edited is described
 * as far as it can be read, with its condition. */
static enum err provenance_write(struct buf *out, const char *name, const char *bytes,
                                 size_t length, bool is_anonymous, struct fault *fault)
{
    struct provenance p = {.json = {.out = out, .lines = 2}, .is_anonymous = is_anonymous};
    struct json *json = &p.json;
    enum err err = journal_check(&p.condition, bytes, length, fault);
    if (err && err != ERR_CHECK)
        return err;
    if (p.condition.state == JOURNAL_SCRIPT)
        return fault_set(fault, ERR_CHECK, "%s is a script: it has commands, and no results", name);
    json_object(json, NULL);
    json_object(json, "prefix");
    json_text(json, "iftty", "urn:iftty:");
    json_end(json);
    json_object(json, "agent");
    json_object(json, "iftty:program-1");
    json_text(json, "prov:type", "prov:SoftwareAgent");
    json_text(json, "prov:label", "iftty " PROGRAM_VERSION);
    json_count(json, "iftty:semantics", p.condition.semantics);
    json_end(json);
    json_end(json);
    for (err = OK; !err && p.member < MEMBERS; p.member++)
        err = add_member(&p, name, bytes, length, fault);
    if (!err)
        json_end(json);
    buf_release(&p.anonymiser.names);
    return !err && out->failed ? fault_memory(fault, "the provenance of a journal") : err;
}

/* ---- the forms ---- */

/* What `write` makes of a journal, printed also where it ends with an error: line by line, without
 * what a terminal would obey. */
static enum err print_written(enum err (*write)(struct buf *out, const char *bytes, size_t length,
                                                struct fault *fault),
                              const struct options *o, struct fault *fault)
{
    struct buf bytes = {0}, text = {0}, line = {0};
    enum err err = file_read(&bytes, o->word[0], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = write(&text, buf_text(&bytes), bytes.length, fault);
    if (err && bytes.length)
        fault_prefix(fault, err, "%s", o->word[0]);
    if (!err && text.failed)
        err = fault_memory(fault, "what a journal says");
    for (const char *at = buf_text(&text), *end = at + text.length; at < end;) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const size_t n = feed ? (size_t)(feed - at) : (size_t)(end - at);
        buf_clear(&line);
        buf_add_safe(&line, at, n);
        puts(buf_text(&line));
        at += n + 1;
    }
    buf_release(&line);
    buf_release(&text);
    buf_release(&bytes);
    return err;
}

/* As it is, intact or not; a scene that was meant to be opened is no text. */
static enum err copy(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    struct walk walk;
    const enum err err = walk_begin(&walk, bytes, length, fault);
    walk_release(&walk);
    if (err && !walk.is_journal)
        return err;
    buf_add(out, bytes, length);
    return OK;
}

enum err run_log(const struct options *o, struct fault *fault)
{
    return print_written(copy, o, fault);
}

enum err run_log_script(const struct options *o, struct fault *fault)
{
    return print_written(journal_script, o, fault);
}

enum err run_log_anonymise(const struct options *o, struct fault *fault)
{
    return print_written(anonymise_script, o, fault);
}

static enum err check(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    struct journal_condition condition;
    const enum err err = journal_check(&condition, bytes, length, fault);
    if (!err)
        buf_printf(out, "%s\n", condition.text);
    return err;
}

enum err run_log_check(const struct options *o, struct fault *fault)
{
    return print_written(check, o, fault);
}

/* At a terminal no wider than it is, with lines where the locale has them. */
static enum err draw_graph(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    const bool is_terminal = isatty(STDOUT_FILENO);
    struct buf drawn = {0};
    const enum err err = graph_draw(&drawn, bytes, length, is_terminal && locale_is_utf8(), fault);
    if (!err)
        cells_crop(out, buf_text(&drawn), is_terminal ? term_columns(STDOUT_FILENO) : 0);
    buf_release(&drawn);
    return err;
}

enum err run_log_graph(const struct options *o, struct fault *fault)
{
    return print_written(draw_graph, o, fault);
}

enum err run_log_export(const struct options *o, struct fault *fault)
{
    struct buf bytes = {0}, text = {0};
    enum err err = file_read(&bytes, o->word[0], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = provenance_write(&text, file_name(o->word[0]), buf_text(&bytes), bytes.length,
                               o->anonymise, fault);
    if (!err && strcmp(o->export, "-") == 0)
        fputs(buf_text(&text), stdout);
    else if (!err)
        err = file_write(o->export, text.data, text.length, FILE_KEEP, fault);
    buf_release(&text);
    buf_release(&bytes);
    return err;
}

enum err run_log_repair(const struct options *o, struct fault *fault)
{
    struct buf lines = {0};
    const enum err err = journal_repair(o->word[0], SEMANTICS, &lines, fault);
    if (!err)
        puts(buf_text(&lines));
    buf_release(&lines);
    return err;
}

/* ---- signing ---- */

/* Only what is intact is worth a signature. */
enum err run_log_sign(const struct options *o, struct fault *fault)
{
    struct buf bytes = {0}, line = {0};
    struct journal_condition condition;
    enum err err = file_read(&bytes, o->word[0], JOURNAL_BYTES_MAX, fault);
    console_handle_interrupts();
    if (!err) {
        err = journal_check(&condition, buf_text(&bytes), bytes.length, fault);
        if (err)
            fault_prefix(fault, err, "only an intact journal is signed");
        else if (condition.state != JOURNAL_INTACT)
            err =
                fault_set(fault, ERR_CHECK, "this is a script, not a journal, and was not signed");
    }
    if (!err)
        err = signature_make(o->word[0], &bytes, o->sign, console_watch(), fault);
    if (!err) {
        buf_add_safe_text(&line, o->word[0]);
        printf("# %s.sig signs %zu record%s, chain %s\n", buf_text(&line), condition.records,
               plural(condition.records), condition.chain.hex);
    }
    buf_release(&line);
    buf_release(&bytes);
    return err;
}
