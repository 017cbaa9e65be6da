/* SPDX-License-Identifier: MIT */
/* Lines as commands: what parses is written in a form that parses to the same, and is a command
 * that a journal takes. Completion and hints of any line. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "command/command.h"
#include "command/interpreter.h"
#include "journal/record.h"
#include "session/session_inside.h"

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
    struct buf first = {0}, second = {0};
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
    buf_release(&first);
    buf_release(&second);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct buf line = {0}, words = {0};
    size_t start = 0;
    prepare();
    buf_add(&line, bytes, length);
    const char *text = buf_text(&line);
    parse(text);
    command_complete(&words, &start, text, strlen(text), &interp);
    HOLDS(start <= strlen(text));
    command_hint(&words, text, strlen(text));
    buf_release(&words);
    buf_release(&line);
    return 0;
}
