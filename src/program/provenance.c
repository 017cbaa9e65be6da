#include "program/provenance.h"

#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "command/act.h"
#include "program/anonymise.h"
#include "journal/log.h"
#include "journal/walk.h"
#include "show/export_picture.h"

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

static void add_command(struct provenance *p, const struct record *record, const char *command)
{
    const size_t n = record->number;
    if (begin(p, ACTIVITY, "command", n)) {
        json_text(&p->json, "prov:label", command);
        json_end(&p->json);
    }
    relate(p, ASSOCIATED, (struct end){"activity", "command", n},
           (struct end){"agent", "program", 1});
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
    add_command(p, record, buf_text(&text));
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

static void add_journal(struct provenance *p, const char *name)
{
    if (!begin(p, ENTITY, "journal", 1))
        return;
    json_text(&p->json, "prov:type", "iftty:journal");
    json_text(&p->json, "prov:label", p->is_anonymous ? "a journal" : name);
    json_count(&p->json, "iftty:records", p->condition.records);
    json_text(&p->json, "iftty:chain", p->condition.chain.hex);
    json_text(&p->json, "iftty:condition", p->condition.text);
    json_end(&p->json);
}

static void begin_document(struct json *json, unsigned semantics)
{
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
    add_journal(p, name);
    while (walk_next(&walk, &record) == WALK_RECORD)
        add_record(p, &record);
    json_end(&p->json);
    walk_release(&walk);
    return OK;
}

enum err provenance_write(struct buf *out, const char *name, const char *bytes, size_t length,
                          bool is_anonymous, struct fault *fault)
{
    struct provenance p = {.json = {.out = out, .lines = 2}, .is_anonymous = is_anonymous};
    enum err err = journal_check(&p.condition, bytes, length, fault);
    if (err && err != ERR_CHECK)
        return err;
    if (p.condition.state == JOURNAL_SCRIPT)
        return fault_set(fault, ERR_CHECK, "%s is a script: it has commands, and no results", name);
    begin_document(&p.json, p.condition.semantics);
    for (err = OK; !err && p.member < MEMBERS; p.member++)
        err = add_member(&p, name, bytes, length, fault);
    if (!err)
        json_end(&p.json);
    anonymiser_release(&p.anonymiser);
    return !err && out->failed ? fault_memory(fault, "the provenance of a journal") : err;
}
