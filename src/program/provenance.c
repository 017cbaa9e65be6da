#include "program/provenance.h"

#include <string.h>

#include "base/json.h"
#include "command/act.h"
#include "program/anonymise.h"
#include "journal/log.h"
#include "journal/walk.h"
#include "session/export.h"

/* The members of the document, each the inside of an object, as they grow. */
enum member { ENTITY, ACTIVITY, USED, GENERATED, DERIVED, ASSOCIATED, MEMBERS };

struct provenance {
    struct buf member[MEMBERS];
    struct anonymiser anonymiser;
    bool is_anonymous, has_scene;
};

static void add_text(struct buf *out, const char *text)
{
    json_add_text(out, text, strlen(text));
}

/* Begins a thing: "iftty:kind-N": { */
static struct buf *begin(struct provenance *p, enum member member, const char *kind, size_t number)
{
    struct buf *out = &p->member[member];
    buf_printf(out, "%s\n    \"%s-%zu\": {", out->length ? "," : "", kind, number);
    return out;
}

/* A whole relation between two things, "ROLE": "iftty:KIND-N". */
static void relate(struct provenance *p, enum member member, const char *from,
                   const char *from_kind, size_t from_number, const char *to, const char *to_kind,
                   size_t to_number)
{
    struct buf *out = &p->member[member];
    const char letter = "eaugds"[member];
    buf_printf(out, "%s\n    \"_:%c-%s-%zu-%s\": {", out->length ? "," : "", letter, from_kind,
               from_number, to_kind);
    buf_printf(out, "\"prov:%s\": \"iftty:%s-%zu\", \"prov:%s\": \"iftty:%s-%zu\"}", from,
               from_kind, from_number, to, to_kind, to_number);
}

/* The result words as members of an object, each behind a comma. */
static void add_words(struct buf *out, const char *words)
{
    struct record_word word;
    const char *end = words + strlen(words);
    while (record_word_next(&words, end, &word)) {
        buf_add_text(out, ", \"iftty:");
        buf_add(out, word.key, word.key_length);
        buf_add_text(out, "\": ");
        json_add_text(out, word.value, word.value_length);
    }
}

static void add_command(struct provenance *p, const struct record *record, const char *command)
{
    struct buf *out = begin(p, ACTIVITY, "iftty:command", record->number);
    buf_add_text(out, "\"prov:label\": ");
    add_text(out, command);
    buf_add_char(out, '}');
    relate(p, ASSOCIATED, "activity", "command", record->number, "agent", "program", 1);
}

static void add_state(struct provenance *p, const struct record *record)
{
    const size_t n = record->number;
    struct buf *out = begin(p, ENTITY, "iftty:state", n);
    buf_printf(out, "\"prov:type\": \"iftty:state\", \"iftty:chain\": \"%s\"", record->chain.hex);
    if (record_judge(record, NULL))
        buf_add_text(out, ", \"iftty:is-sound\": false");
    add_words(out, record->result);
    buf_add_char(out, '}');
    relate(p, GENERATED, "entity", "state", n, "activity", "command", n);
    if (n > 1) {
        relate(p, USED, "activity", "command", n, "entity", "state", n - 1);
        relate(p, DERIVED, "generatedEntity", "state", n, "usedEntity", "state", n - 1);
    }
}

/* The word behind the command's name. */
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
    struct buf argument = {0}, id = {0};
    first_argument(&argument, command);
    buf_printf(&id, "iftty:%s", kind);
    struct buf *out = begin(p, ENTITY, buf_text(&id), record->number);
    buf_printf(out, "\"prov:type\": \"iftty:%s\", \"prov:label\": ", kind);
    add_text(out, buf_text(&argument));
    add_words(out, record->result);
    buf_add_char(out, '}');
    out->failed |= argument.failed | id.failed;
    buf_release(&argument);
    buf_release(&id);
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
    p->member[ENTITY].failed |= command.failed;
    buf_release(&command);
}

static void add_journal(struct provenance *p, const char *name,
                        const struct journal_condition *condition)
{
    struct buf *out = begin(p, ENTITY, "iftty:journal", 1);
    buf_add_text(out, "\"prov:type\": \"iftty:journal\", \"prov:label\": ");
    add_text(out, p->is_anonymous ? "a journal" : name);
    buf_printf(out, ", \"iftty:records\": %zu, \"iftty:chain\": \"%s\", \"iftty:condition\": ",
               condition->records, condition->chain.hex);
    add_text(out, condition->text);
    buf_add_char(out, '}');
}

static void put_together(struct buf *out, struct provenance *p, unsigned semantics)
{
    static const char *const name[MEMBERS] = {
        "entity", "activity", "used", "wasGeneratedBy", "wasDerivedFrom", "wasAssociatedWith"};
    buf_add_text(out, "{\n  \"prefix\": {\"iftty\": \"urn:iftty:\"},\n");
    buf_printf(out,
               "  \"agent\": {\"iftty:program-1\": {\"prov:type\": \"prov:SoftwareAgent\", "
               "\"prov:label\": \"iftty " PROGRAM_VERSION "\", \"iftty:semantics\": %u}}",
               semantics);
    for (unsigned m = 0; m < MEMBERS; m++) {
        buf_printf(out, ",\n  \"%s\": {", name[m]);
        buf_add_text(out, buf_text(&p->member[m]));
        buf_add_text(out, "\n  }");
        out->failed |= p->member[m].failed;
    }
    buf_add_text(out, "\n}\n");
}

static void release(struct provenance *p)
{
    for (unsigned m = 0; m < MEMBERS; m++)
        buf_release(&p->member[m]);
    anonymiser_release(&p->anonymiser);
}

enum err provenance_write(struct buf *out, const char *name, const char *bytes, size_t length,
                          bool is_anonymous, struct fault *fault)
{
    struct provenance p = {.is_anonymous = is_anonymous};
    struct journal_condition condition;
    struct walk walk;
    struct record record;
    enum err err = journal_check(&condition, bytes, length, fault);
    if (err && err != ERR_CHECK)
        return err;
    if (condition.state == JOURNAL_SCRIPT)
        return fault_set(fault, ERR_CHECK, "%s is a script: it has commands, and no results", name);
    err = walk_begin(&walk, bytes, length, WALK_AS_FOUND, fault);
    if (err)
        return err;
    add_journal(&p, name, &condition);
    while (walk_next(&walk, &record) == WALK_RECORD)
        add_record(&p, &record);
    put_together(out, &p, walk.semantics);
    if (out->failed)
        err = fault_memory(fault, "the provenance of a journal");
    walk_release(&walk);
    release(&p);
    return err;
}
