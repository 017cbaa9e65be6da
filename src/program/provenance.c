#include "program/provenance.h"

#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "command/act.h"
#include "program/anonymise.h"
#include "journal/log.h"
#include "journal/walk.h"
#include "session/export.h"

/* The members of the document, which grow side by side as the journal is read. */
enum member { ENTITY, ACTIVITY, USED, GENERATED, DERIVED, ASSOCIATED, MEMBERS };

struct provenance {
    struct buf text[MEMBERS];
    struct json member[MEMBERS];
    struct anonymiser anonymiser;
    bool is_anonymous, has_scene;
};

/* Begins a thing, "iftty:KIND-N": {. */
static struct json *begin(struct provenance *p, enum member member, const char *kind, size_t number)
{
    char key[64];
    snprintf(key, sizeof key, "iftty:%s-%zu", kind, number);
    json_object(&p->member[member], key);
    return &p->member[member];
}

/* A whole relation between two things, "prov:ROLE": "iftty:KIND-N". */
static void relate(struct provenance *p, enum member member, const char *from,
                   const char *from_kind, size_t from_number, const char *to, const char *to_kind,
                   size_t to_number)
{
    struct json *json = &p->member[member];
    char key[96];
    snprintf(key, sizeof key, "_:%c-%s-%zu-%s", "eaugds"[member], from_kind, from_number, to_kind);
    json_object(json, key);
    snprintf(key, sizeof key, "prov:%s", from);
    json_format(json, key, "iftty:%s-%zu", from_kind, from_number);
    snprintf(key, sizeof key, "prov:%s", to);
    json_format(json, key, "iftty:%s-%zu", to_kind, to_number);
    json_end(json);
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

static void add_command(struct provenance *p, const struct record *record, const char *command)
{
    struct json *json = begin(p, ACTIVITY, "command", record->number);
    json_text(json, "prov:label", command);
    json_end(json);
    relate(p, ASSOCIATED, "activity", "command", record->number, "agent", "program", 1);
}

static void add_state(struct provenance *p, const struct record *record)
{
    const size_t n = record->number;
    struct json *json = begin(p, ENTITY, "state", n);
    json_text(json, "prov:type", "iftty:state");
    json_text(json, "iftty:chain", record->chain.hex);
    if (record_judge(record, NULL))
        json_boolean(json, "iftty:is-sound", false);
    add_words(json, record->result);
    json_end(json);
    relate(p, GENERATED, "entity", "state", n, "activity", "command", n);
    if (n > 1) {
        relate(p, USED, "activity", "command", n, "entity", "state", n - 1);
        relate(p, DERIVED, "generatedEntity", "state", n, "usedEntity", "state", n - 1);
    }
}

/* The word after the command's name. */
static void first_argument(struct buf *out, const char *command)
{
    const char *at = command + strcspn(command, " \t");
    at += strspn(at, " \t");
    buf_clear(out);
    if (!command_take_word(&at, out))
        buf_clear(out);
}

static void add_named(struct provenance *p, const char *kind, const struct record *record,
                      const char *command)
{
    struct buf argument = {0};
    first_argument(&argument, command);
    struct json *json = begin(p, ENTITY, kind, record->number);
    json_format(json, "prov:type", "iftty:%s", kind);
    json_text(json, "prov:label", buf_text(&argument));
    add_words(json, record->result);
    json_end(json);
    json->out->failed |= argument.failed;
    buf_release(&argument);
}

/* NULL for one that this version does not know. */
static const struct command *command_of(const char *line)
{
    struct buf name = {0};
    const struct command *command = NULL;
    if (command_take_word(&line, &name))
        command = command_find(buf_text(&name));
    buf_release(&name);
    return command;
}

static void add_record(struct provenance *p, const struct record *record)
{
    struct buf command = {0};
    if (p->is_anonymous)
        anonymise_command(&p->anonymiser, &command, record->command);
    else
        buf_add_text(&command, record->command);
    const char *text = buf_text(&command);
    const struct command *known = command_of(text);
    add_command(p, record, text);
    add_state(p, record);
    if (known && known->act == act_open) {
        add_named(p, "scene", record, text);
        relate(p, USED, "activity", "command", record->number, "entity", "scene", record->number);
    } else if (known && known->act == act_golden) {
        add_named(p, "golden-image", record, text);
        relate(p, GENERATED, "entity", "golden-image", record->number, "activity", "command",
               record->number);
    }
    p->text[ENTITY].failed |= command.failed;
    buf_release(&command);
}

static void add_journal(struct provenance *p, const char *name,
                        const struct journal_condition *condition)
{
    struct json *json = begin(p, ENTITY, "journal", 1);
    json_text(json, "prov:type", "iftty:journal");
    json_text(json, "prov:label", p->is_anonymous ? "a journal" : name);
    json_count(json, "iftty:records", condition->records);
    json_text(json, "iftty:chain", condition->chain.hex);
    json_text(json, "iftty:condition", condition->text);
    json_end(json);
}

static void begin_document(struct provenance *p, struct json *json, unsigned semantics)
{
    static const char *const name[MEMBERS] = {
        "entity", "activity", "used", "wasGeneratedBy", "wasDerivedFrom", "wasAssociatedWith"};
    json_object(json, NULL);
    json_object(json, "prefix");
    json_text(json, "iftty", "urn:iftty:");
    json_end(json);
    json_object(json, "agent");
    json_object(json, "iftty:program-1");
    json_text(json, "prov:type", "prov:SoftwareAgent");
    json_text(json, "prov:label", "iftty " PROGRAM_VERSION);
    json_count(json, "iftty:semantics", semantics);
    json_end(json);
    json_end(json);
    for (unsigned m = 0; m < MEMBERS; m++) {
        p->member[m] = json_beside(json, &p->text[m]);
        json_object(&p->member[m], name[m]);
    }
}

static void end_document(struct provenance *p, struct json *json)
{
    for (unsigned m = 0; m < MEMBERS; m++) {
        json_end(&p->member[m]);
        buf_add(json->out, buf_text(&p->text[m]), p->text[m].length);
        json->out->failed |= p->text[m].failed;
    }
    json_end(json);
}

static void release(struct provenance *p)
{
    for (unsigned m = 0; m < MEMBERS; m++)
        buf_release(&p->text[m]);
    anonymiser_release(&p->anonymiser);
}

enum err provenance_write(struct buf *out, const char *name, const char *bytes, size_t length,
                          bool is_anonymous, struct fault *fault)
{
    struct provenance p = {.is_anonymous = is_anonymous};
    struct json json = {.out = out, .lines = 2};
    struct journal_condition condition;
    struct walk walk;
    struct record record;
    enum err err = journal_check(&condition, bytes, length, fault);
    if (err && err != ERR_CHECK)
        return err;
    if (condition.state == JOURNAL_SCRIPT)
        return fault_set(fault, ERR_CHECK, "%s is a script: it has commands, and no results", name);
    err = walk_begin(&walk, bytes, length, fault);
    if (err)
        return err;
    begin_document(&p, &json, walk.semantics);
    add_journal(&p, name, &condition);
    while (walk_next(&walk, &record) == WALK_RECORD)
        add_record(&p, &record);
    end_document(&p, &json);
    if (out->failed)
        err = fault_memory(fault, "the provenance of a journal");
    walk_release(&walk);
    release(&p);
    return err;
}
