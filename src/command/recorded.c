#include "command/recorded.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "command/act.h"
#include "command/opening.h"
#include "command/script.h"
#include "session/session_inside.h"
#include "session/session_inside.h"

/* ---- which script it is ---- */

bool recorded_opens_scene(FILE *input, bool *knows)
{
    struct buf line = {0}, word = {0};
    const off_t begin = ftello(input);
    bool opens = false;
    *knows = begin >= 0 && fseeko(input, begin, SEEK_SET) == 0;
    while (*knows && !opens && script_read_line(input, &line)) {
        const char *at = buf_text(&line);
        buf_clear(&word);
        scan_blanks(&at);
        const struct command *command = *at && command_take_word(&at, &word, COMMAND_QUOTES)
                                            ? command_find(buf_text(&word))
                                            : NULL;
        opens = command && command->act == act_open;
    }
    buf_release(&line);
    buf_release(&word);
    if (*knows) {
        clearerr(input);
        *knows = fseeko(input, begin, SEEK_SET) == 0;
    }
    return opens;
}

static void step(struct recorded *recorded)
{
    if (walk_next_sound(&recorded->walk, &recorded->record) != WALK_RECORD)
        recorded->mode = RECORDED_ENDS;
}

enum err recorded_begin(struct recorded *recorded, const struct interpreter *interp, FILE *input,
                        struct fault *fault)
{
    *recorded = (struct recorded){.mode = RECORDED_NOTHING,
                                  .records = interp->journal ? journal_count(interp->journal) : 0};
    if (!recorded->records)
        return OK;
    struct buf *own = &recorded->journal;
    const struct buf *bytes = journal_bytes(interp->journal);
    buf_add(own, bytes->data, bytes->length);
    recorded->then = mem_new(sizeof *recorded->then);
    if (own->failed || !recorded->then)
        return fault_memory(fault, "a script");
    const enum err err = walk_begin(&recorded->walk, own->data, own->length, fault);
    if (err)
        return err;
    recorded->mode = RECORDED_UNDECIDED;
    step(recorded);
    bool knows;
    const bool opens = recorded_opens_scene(input, &knows);
    if (knows && session_has_scene(interp->session))
        recorded->mode = opens ? RECORDED_FOLLOWS : RECORDED_NOTHING;
    return OK;
}

void recorded_release(struct recorded *recorded)
{
    walk_release(&recorded->walk);
    buf_release(&recorded->journal);
    buf_release(&recorded->comments);
    free(recorded->then);
    *recorded = (struct recorded){.mode = RECORDED_NOTHING};
}

/* ---- lines and records ---- */

/* The session that a line is read by: labels have the names that they had before the record. What
 * it borrows stays, since nothing is carried out meanwhile. */
static const struct session *session_then(struct recorded *recorded,
                                          const struct interpreter *interp)
{
    const struct kept_settings *settings =
        history_settings_after(&interp->history, recorded->record.number - 1);
    if (!recorded->settings)
        *recorded->then = *interp->session;
    if (settings && settings != recorded->settings) {
        recorded->then->now.kept = kept_settings_get(settings);
        recorded->settings = settings;
    }
    return recorded->then;
}

/* Whether words of a record are values that the record of this call adds by itself. */
static bool are_added(const struct call *call, const char *words)
{
    const struct parameter *p = call->command->parameter;
    struct buf word = {0};
    bool all = true;
    for (scan_blanks(&words); all && *words; scan_blanks(&words)) {
        buf_clear(&word);
        all = command_take_word(&words, &word, call->quotes);
        const char *value = buf_text(&word);
        const int i = all ? command_parameter_for(call->command, call->value, &value) : -1;
        all = i >= 0 && p[i].added && !call->value[i].given;
    }
    buf_release(&word);
    return all;
}

static bool begins_with_name(const char *command, const char *name)
{
    const size_t length = strlen(name);
    return strncmp(command, name, length) == 0 && command[length] == ' ';
}

/* Whether the record is one that this call leads to. */
static bool leads_to(const struct call *call, const char *canonical, const char *command)
{
    const size_t length = strlen(canonical);
    const char *comes_to = call->command->comes_to;
    if (!(call->command->flags & COMMAND_RECORDED))
        return call->command->flags & COMMAND_ANSWERS &&
               strncmp(command, RUN_FOR, strlen(RUN_FOR)) == 0 &&
               strcmp(command + strlen(RUN_FOR), call->command->name) == 0;
    if (strncmp(command, canonical, length) == 0 && are_added(call, command + length))
        return command[length] == '\0' || command[length] == ' ';
    return comes_to && begins_with_name(command, comes_to) &&
           (strcmp(comes_to, call->command->name) != 0 || call->value->text);
}

/* The record at hand was met. */
static void meet(struct recorded *recorded, struct interpreter *interp, bool is_recorded,
                 struct reply *reply)
{
    const struct record *record = &recorded->record;
    const struct buf *comments = &recorded->comments;
    const size_t length = record->command_offset - record->offset;
    if (!recorded->other_comment &&
        (comments->length != length ||
         memcmp(buf_text(comments), recorded->walk.bytes + record->offset, length) != 0))
        recorded->other_comment = record->number;
    buf_clear(&recorded->comments);
    if (is_recorded) { /* with what its record adds */
        buf_clear(&reply->canonical);
        buf_add_text(&reply->canonical, record->command);
    }
    interp->acknowledged = record->number;
    step(recorded);
}

static void add_quoted(struct buf *words, const char *line)
{
    buf_add_text(words, " `");
    buf_add_safe_excerpt(words, line, strlen(line));
    buf_add_char(words, '`');
}

static enum err differs(const struct recorded *recorded, const struct interpreter *interp,
                        const char *line, struct fault *fault)
{
    struct buf words = {0};
    buf_add_text(&words, line ? "this line is" : "the script ends");
    if (line)
        add_quoted(&words, line);
    buf_printf(&words, ", and record %zu of ", recorded->record.number);
    buf_add_safe_text(&words, journal_path(interp->journal));
    buf_add_text(&words, " is");
    add_quoted(&words, recorded->record.command);
    fault_set(fault, ERR_INPUT,
              "%s: the journal has another run, or was gone on with; nothing was added to it "
              "(`--journal FILE` of a new name begins another)",
              buf_text(&words));
    buf_release(&words);
    return ERR_INPUT;
}

/* The comments that were held back go with the command that follows. */
static enum err give_comments(struct recorded *recorded, const struct interpreter *interp,
                              struct fault *fault)
{
    enum err err = OK;
    for (char *at = recorded->comments.data; !err && at && *at;) {
        char *end = strchr(at, '\n');
        *end = '\0';
        err = journal_comment(interp->journal, at, fault);
        at = end + 1;
    }
    buf_clear(&recorded->comments);
    return err;
}

/* The line as its record has it, as far as that is known without carrying it out: with files as
 * seen from the journal, and a series by its number. */
static enum err write_line(struct buf *out, const struct interpreter *interp, struct call *call,
                           struct fault *fault)
{
    const enum err err = interpreter_settle_name(interp, call, fault);
    if (call->command->act == act_open)
        opening_write(out, call, session_series(interp->session));
    else
        command_write(out, call);
    return err;
}

/* By the first line that would be recorded. */
static void decide(struct recorded *recorded, const struct interpreter *interp,
                   const struct call *call, const char *canonical)
{
    const bool opens = call->command->act == act_open && session_has_scene(interp->session);
    recorded->mode = opens || leads_to(call, canonical, recorded->record.command)
                         ? RECORDED_FOLLOWS
                         : RECORDED_NOTHING;
}

/* `call` is of the line. */
static enum err take(struct recorded *recorded, struct interpreter *interp, const char *line,
                     struct call *call, bool *taken, struct reply *reply, struct fault *fault)
{
    const bool is_recorded = call->command->flags & COMMAND_RECORDED;
    const enum err err = write_line(&reply->canonical, interp, call, fault);
    if (err)
        return err;
    if (recorded->mode == RECORDED_UNDECIDED && is_recorded)
        decide(recorded, interp, call, buf_text(&reply->canonical));
    *taken = recorded->mode == RECORDED_FOLLOWS;
    if (!*taken)
        return recorded->mode == RECORDED_NOTHING ? give_comments(recorded, interp, fault) : OK;
    interp->acknowledged = 0;
    if (leads_to(call, buf_text(&reply->canonical), recorded->record.command))
        meet(recorded, interp, is_recorded, reply);
    else if (is_recorded)
        return differs(recorded, interp, line, fault);
    else
        buf_add_text(&reply->text, "passed over: the journal goes on after it\n");
    return reply->canonical.failed || reply->text.failed ? fault_memory(fault, "an answer") : OK;
}

/* False for a line that is a command. */
static bool holds_back(struct recorded *recorded, const char *line)
{
    if (*line != '#' && *line != '\0')
        return false;
    if (script_is_comment(line)) {
        buf_add_text(&recorded->comments, line);
        buf_add_char(&recorded->comments, '\n');
    }
    return true;
}

enum err recorded_take(struct recorded *recorded, struct interpreter *interp, const char *line,
                       bool *taken, struct reply *reply, struct fault *fault)
{
    const bool follows = recorded->mode == RECORDED_FOLLOWS;
    struct call call;
    *taken = false;
    if (recorded->mode == RECORDED_UNDECIDED &&
        journal_count(interp->journal) > recorded->records) /* by a question */
        recorded->mode = RECORDED_NOTHING;
    if (!follows && recorded->mode != RECORDED_UNDECIDED)
        return give_comments(recorded, interp, fault);
    reply_clear(reply);
    *taken = holds_back(recorded, line);
    if (*taken)
        return recorded->comments.failed ? fault_memory(fault, "a comment") : OK;
    const struct session *session = follows ? session_then(recorded, interp) : interp->session;
    *taken = follows;
    if (command_parse(&call, line, session, fault) != OK) /* the door says it, where it has to */
        return follows ? differs(recorded, interp, line, fault) : OK;
    const enum err err =
        call.command ? take(recorded, interp, line, &call, taken, reply, fault) : OK;
    call_release(&call);
    return err;
}

enum err recorded_end(const struct recorded *recorded, const struct interpreter *interp,
                      struct fault *fault)
{
    return recorded->mode == RECORDED_FOLLOWS ? differs(recorded, interp, NULL, fault) : OK;
}
