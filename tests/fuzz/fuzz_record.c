/* SPDX-License-Identifier: MIT */
/* Lines as commands, and journals. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "command/command.h"
#include "command/interpreter.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "session/session_inside.h"

/* Lines as commands: what parses is written in a form that parses to the same, and is a command
 * that a journal takes. Completion and hints of any line. */

static struct interpreter interp; /* kept from one line to the next */

static void prepare(void)
{
    struct fault fault;
    if (interp.session)
        return;
    HOLDS(session_new(&interp.session, &fault) == OK);
    struct session *session = interp.session;
    history_init(&interp.history);
    HOLDS(session_open(session, "synth:geom:9x8x7", NULL, &fault) == OK);
    strcpy(session->now.kept.label_name[2], "cerebellum");
}

static void parse(const char *line)
{
    struct call call, again;
    OWNED(buf_release) struct buf first = {0}, second = {0};
    struct fault fault;
    if (command_parse(&call, line, interp.session, &fault))
        return;
    if (call.command) {
        command_write(&first, &call);
        HOLDS(record_command_check(buf_text(&first), &fault) == OK);
        HOLDS(command_parse(&again, buf_text(&first), interp.session, &fault) == OK);
        HOLDS(again.command == call.command);
        command_write(&second, &again);
        HOLDS(strcmp(buf_text(&first), buf_text(&second)) == 0);
        call_release(&again);
    }
    call_release(&call);
}

void fuzz_command(const uint8_t *bytes, size_t length)
{
    OWNED(buf_release) struct buf line = {0}, words = {0};
    size_t start = 0;
    prepare();
    buf_add(&line, bytes, length);
    const char *text = buf_text(&line);
    parse(text);
    command_complete(&words, &start, text, strlen(text), &interp);
    HOLDS(start <= strlen(text));
    command_hint(&words, text, strlen(text));
}

/* Bytes as a journal and as a script: walk, check, script; sound records encode to themselves. */

/* A sound record without comments equals its encoding. */
static void encode_again(const struct walk *walk, const struct record *record,
                         const struct record_chain *before)
{
    OWNED(buf_release) struct buf out = {0}, header = {0};
    struct record_chain after = *before;
    const struct record same = {
        .number = (size_t)record->noted, .command = record->command, .result = record->result};
    const char *bytes = walk->bytes + record->offset;
    if (record->number == 1)
        buf_add(&header, walk->bytes, walk->header_length);
    if (!record_judge(record, NULL) && *bytes != '#' && *bytes != '\n' &&
        !record_encode(&out, &after, buf_text(&header), "", &same, NULL)) {
        HOLDS(out.length == record->end - record->offset);
        HOLDS(memcmp(out.data, bytes, out.length) == 0);
        HOLDS(strcmp(after.hex, record->chain.hex) == 0);
    }
}

static void walk_through(const char *bytes, size_t length)
{
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    struct record_chain before = record_chain_zero;
    uint64_t end = 0;
    if (walk_begin(&walk, bytes, length, NULL))
        return;
    while (walk_next(&walk, &record) == WALK_RECORD) {
        HOLDS(record.offset >= end && record.end > record.offset && record.end <= length);
        HOLDS(record.command_offset >= record.offset &&
              record.result_offset > record.command_offset && record.end >= record.result_offset);
        HOLDS(strlen(record.command) <= RECORD_LINE_MAX &&
              strlen(record.result) <= RECORD_LINE_MAX);
        if (walk.is_journal)
            encode_again(&walk, &record, &before);
        if (record.has_result)
            before = record.chain;
        end = record.end;
    }
    HOLDS(walk.over == walk_next(&walk, &record)); /* an end stays one */
}

void fuzz_journal(const uint8_t *data, size_t length)
{
    const char *bytes = (const char *)data;
    struct journal_condition condition;
    OWNED(buf_release) struct buf script = {0};
    struct fault fault;
    walk_through(bytes, length);
    const enum err err = journal_check(&condition, bytes, length, &fault);
    HOLDS(!err == (condition.state == JOURNAL_INTACT || condition.state == JOURNAL_SCRIPT));
    if (!journal_script(&script, bytes, length, NULL) && script.length)
        walk_through(script.data, script.length);
}
