#include "journal/log.h"

#include <stdio.h>
#include <string.h>

#include "journal/walk.h"

enum err journal_script(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes, length, fault);
    while (!err && walk_next(&walk, &record) == WALK_RECORD) {
        buf_add(out, walk.bytes + record.offset, (size_t)(record.result_offset - record.offset));
        if (out->length && out->data[out->length - 1] != '\n')
            buf_add_char(out, '\n');
    }
    if (walk.over == WALK_END) /* last comments of a script */
        buf_add(out, walk.bytes + walk.offset, walk.length - walk.offset);
    if (!err)
        err = walk_judge(&walk, fault);
    if (out->failed)
        err = fault_memory(fault, "the commands of a journal");
    walk_release(&walk);
    return err;
}

static enum err condition_set(struct journal_condition *condition, enum journal_state state,
                              const struct record *place, const char *text, struct fault *fault)
{
    condition->state = state;
    condition->number = place->number;
    condition->line = place->line;
    condition->offset = place->offset;
    snprintf(condition->text, sizeof condition->text, "%s", text);
    return fault_set(fault, ERR_CHECK, "%s", text);
}

/* The place of a fault of the header, which belongs to the first record. */
static const struct record line_1 = {.number = 1, .line = 1};

/* Judges one record, of a journal or of a script that has result lines without a header. */
static enum err judge(struct journal_condition *condition, const struct walk *walk,
                      const struct record *record, struct fault *fault)
{
    struct fault words;
    if (walk->is_journal && record_judge(record, &words))
        return condition_set(condition, JOURNAL_EDITED, record, words.text, fault);
    if (!walk->is_journal && record->has_result)
        return condition_set(condition, JOURNAL_EDITED, &line_1,
                             "there are result lines, but line 1 is not a journal's header", fault);
    condition->records++;
    condition->chain = record->chain;
    return OK;
}

enum err journal_check(struct journal_condition *condition, const char *bytes, size_t length,
                       struct fault *fault)
{
    struct walk walk;
    struct record record;
    struct fault words;
    *condition = (struct journal_condition){.chain = record_chain_zero};
    enum err err = walk_begin(&walk, bytes, length, &words);
    if (err == ERR_INPUT)
        return condition_set(condition, JOURNAL_DAMAGED, &line_1, words.text, fault);
    if (err)
        return fault_set(fault, err, "%s", words.text);
    condition->semantics = walk.semantics;
    while (!err && walk_next(&walk, &record) == WALK_RECORD)
        err = judge(condition, &walk, &record, fault);
    if (!err && walk.over == WALK_TORN)
        err = condition_set(condition, JOURNAL_TORN, &record, walk.fault.text, fault);
    else if (!err && walk.over == WALK_DAMAGED)
        err = condition_set(condition, JOURNAL_DAMAGED, &record, walk.fault.text, fault);
    if (!err) {
        condition->state = walk.is_journal ? JOURNAL_INTACT : JOURNAL_SCRIPT;
        snprintf(condition->text, sizeof condition->text, "%s, %zu %s%s",
                 walk.is_journal ? "intact" : "a script", condition->records,
                 walk.is_journal ? "record" : "command", plural(condition->records));
    }
    walk_release(&walk);
    return err;
}
