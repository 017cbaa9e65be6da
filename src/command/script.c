/* SPDX-License-Identifier: MIT */
#include "command/script.h"

#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "command/command.h"
#include "command/execute.h"
#include "command/table.h"
#include "journal/journal.h"

/* ---- lines ---- */

enum { LINE_BYTES_MOST = 65536 };

/* Read one line without its line feed; false at the end. Of a line that is too long for any
 * command, read enough that it remains too long. */
static bool read_line(FILE *input, struct buf *line)
{
    int c;
    buf_clear(line);
    while ((c = getc(input)) != EOF && c != '\n')
        if (line->length < LINE_BYTES_MOST)
            buf_add_char(line, (char)(c ? c : 1)); /* a zero byte would hide the rest of the line */
    if (line->length && line->data[line->length - 1] == '\r')
        line->data[--line->length] = '\0';
    return c != EOF || line->length > 0;
}

/* True if a line is stored in the journal with the next command. */
static bool is_comment(const char *line)
{
    return *line == '\0' || interpreter_is_comment(line);
}

bool script_opens_scene(FILE *input, bool *knows)
{
    OWNED(buf_release) struct buf line = {0}, word = {0};
    const off_t begin = ftello(input);
    bool opens = false;
    *knows = begin >= 0 && fseeko(input, begin, SEEK_SET) == 0;
    while (*knows && !opens && read_line(input, &line)) {
        const char *at = buf_text(&line);
        buf_clear(&word);
        scan_blanks(&at);
        const struct command *command =
            *at && command_take_word(&at, &word) ? command_find(buf_text(&word)) : NULL;
        opens = command && command->act == act_open;
    }
    if (*knows) {
        clearerr(input);
        *knows = fseeko(input, begin, SEEK_SET) == 0;
    }
    return opens;
}

/* ---- lines already recorded ---- */

/* A run of a script, with the part that the journal already has. */
struct run {
    struct interpreter *interp;
    const char *name;
    const struct printer *printer;
    bool goes_on; /* a line was executed that is not in the journal */
    enum recorded_mode {
        RECORDED_UNDECIDED, /* until the first line that would be recorded */
        RECORDED_NOTHING,   /* the script is appended to the journal, if any */
        RECORDED_FOLLOWS,   /* `record` has no line yet */
        RECORDED_ENDS,      /* all records have their lines */
    } mode;
    size_t records;       /* in the journal before the first line */
    struct buf journal;   /* its bytes then */
    struct walk walk;     /* over these bytes */
    struct record record; /* the next one */
    size_t other_comment; /* the first record whose comments differ from the script's, or 0 */
    struct buf comments;  /* in the script since the last record */
    const struct kept_settings *settings; /* before `record`, by the history, */
    struct kept kept;                     /* and the names of labels to read lines with */
};

static void run_release(struct run *run)
{
    walk_release(&run->walk);
    buf_release(&run->journal);
    buf_release(&run->comments);
}

static void next_record(struct run *run)
{
    if (walk_next_sound(&run->walk, &run->record) != WALK_RECORD)
        run->mode = RECORDED_ENDS;
}

/* Initialise before the first line of `input`, which is read ahead if it can be rewound. */
static enum err begin_run(struct run *run, FILE *input, struct fault *fault)
{
    const struct interpreter *interp = run->interp;
    run->mode = RECORDED_NOTHING;
    run->records = interp->journal ? journal_count(interp->journal) : 0;
    if (!run->records)
        return OK;
    struct buf *own = &run->journal;
    const struct buf *bytes = journal_bytes(interp->journal);
    buf_add(own, bytes->data, bytes->length);
    if (own->failed)
        return fault_memory(fault, "a script");
    TRY(walk_begin(&run->walk, own->data, own->length, fault));
    run->mode = RECORDED_UNDECIDED;
    next_record(run);
    bool knows;
    const bool opens = script_opens_scene(input, &knows);
    if (knows && interp->session->has_scene)
        run->mode = opens ? RECORDED_FOLLOWS : RECORDED_NOTHING;
    return OK;
}

/* Return the names that labels had before the record. */
static const struct kept *kept_then(struct run *run)
{
    const struct interpreter *interp = run->interp;
    const struct kept_settings *settings =
        history_settings_after(&interp->history, run->record.number - 1);
    if (settings && settings != run->settings) {
        run->kept = kept_settings_get(settings);
        run->settings = settings;
    }
    return run->settings ? &run->kept : &interp->session->now.kept;
}

/* True if the words of a record are values that it adds to this call. */
static bool are_added(const struct call *call, const char *words)
{
    const struct parameter *p = call->command->parameter;
    OWNED(buf_release) struct buf word = {0};
    bool all = true;
    for (scan_blanks(&words); all && *words; scan_blanks(&words)) {
        buf_clear(&word);
        all = command_take_word(&words, &word);
        const char *value = buf_text(&word);
        const int i = all ? command_parameter_for(call->command, call->value, &value) : -1;
        all = i >= 0 && p[i].added && !call->value[i].given;
    }
    return all;
}

/* True if the record is a result of this call. */
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
    return comes_to && strncmp(command, comes_to, strlen(comes_to)) == 0 &&
           command[strlen(comes_to)] == ' ' &&
           (strcmp(comes_to, call->command->name) != 0 || call->value->text);
}

static void add_quoted(struct buf *words, const char *line)
{
    buf_add_text(words, " `");
    buf_add_safe_excerpt(words, line, strlen(line));
    buf_add_char(words, '`');
}

static enum err report_difference(const struct run *run, const char *line, struct fault *fault)
{
    OWNED(buf_release) struct buf words = {0};
    buf_add_text(&words, line ? "this line is" : "the script ends");
    if (line)
        add_quoted(&words, line);
    buf_printf(&words, ", and record %zu of ", run->record.number);
    buf_add_safe_text(&words, journal_path(run->interp->journal));
    buf_add_text(&words, " is");
    add_quoted(&words, run->record.command);
    return fault_set(fault, ERR_INPUT,
                     "%s: the journal has another run, or was continued; nothing was added to it "
                     "(`--journal FILE` of a new name begins another)",
                     buf_text(&words));
}

/* Store the comments read so far with the next command. */
static enum err store_comments(struct run *run, struct fault *fault)
{
    enum err err = OK;
    for (char *at = run->comments.data; !err && at && *at;) {
        char *end = strchr(at, '\n');
        *end = '\0';
        err = journal_comment(run->interp->journal, at, fault);
        at = end + 1;
    }
    buf_clear(&run->comments);
    return err;
}

/* Compare a line with the next record. The call is written as its record would be, as far as known
 * without executing it: with files relative to the journal, and a series by its number. */
static enum err compare_line(struct run *run, const char *line, struct call *call, bool *taken,
                             struct reply *reply, struct fault *fault)
{
    struct interpreter *interp = run->interp;
    const struct session *session = interp->session;
    const bool is_recorded = call->command->flags & COMMAND_RECORDED,
               opens = call->command->act == act_open;
    TRY(interpreter_settle_name(interp, call, fault));
    if (opens && session->series && call_has(call, "series"))
        call_set(call, "series", session->series, NULL);
    command_write(&reply->canonical, call);
    const bool is_met = leads_to(call, buf_text(&reply->canonical), run->record.command);
    if (run->mode == RECORDED_UNDECIDED &&
        is_recorded) /* decided by the first line to be recorded */
        run->mode = is_met || (opens && session->has_scene) ? RECORDED_FOLLOWS : RECORDED_NOTHING;
    *taken = run->mode == RECORDED_FOLLOWS;
    if (!*taken)
        return run->mode == RECORDED_NOTHING ? store_comments(run, fault) : OK;
    interp->acknowledged = 0;
    if (is_met) {
        const struct record *record = &run->record;
        OWNED(buf_release) struct buf comments = {0};
        record_comments(&comments, NULL, run->walk.bytes, record);
        if (!run->other_comment && strcmp(buf_text(&comments), buf_text(&run->comments)) != 0)
            run->other_comment = record->number;
        buf_clear(&run->comments);
        if (is_recorded) { /* including words added by the record */
            buf_clear(&reply->canonical);
            buf_add_text(&reply->canonical, record->command);
        }
        interp->acknowledged = record->number;
        next_record(run);
    } else if (is_recorded)
        return report_difference(run, line, fault);
    else
        buf_add_text(&reply->text, "skipped: the journal continues after it\n");
    return reply->canonical.failed || reply->text.failed ? fault_memory(fault, "an answer") : OK;
}

/* *taken: the line comes before the point where the script continues, and is not executed; `reply`
 * and interp->acknowledged are filled from its record. ERR_INPUT, with *taken, if line and record
 * differ. */
static enum err take_recorded(struct run *run, const char *line, bool *taken, struct reply *reply,
                              struct fault *fault)
{
    const struct interpreter *interp = run->interp;
    const bool follows = run->mode == RECORDED_FOLLOWS;
    OWNED(call_release) struct call call = {0};
    *taken = false;
    if (run->mode == RECORDED_UNDECIDED &&
        journal_count(interp->journal) > run->records) /* a question was recorded */
        run->mode = RECORDED_NOTHING;
    if (!follows && run->mode != RECORDED_UNDECIDED)
        return store_comments(run, fault);
    reply_clear(reply);
    *taken = *line == '#' || *line == '\0' || follows;
    if (is_comment(line)) { /* stored with the next command that is executed */
        buf_add_text(&run->comments, line);
        buf_add_char(&run->comments, '\n');
    }
    if (*line == '#' || *line == '\0')
        return run->comments.failed ? fault_memory(fault, "a comment") : OK;
    const struct kept *kept = follows ? kept_then(run) : &interp->session->now.kept;
    if (command_parse_by(&call, line, interp->session, kept,
                         fault)) /* interpreter_execute reports the error */
        return follows ? report_difference(run, line, fault) : OK;
    return call.command ? compare_line(run, line, &call, taken, reply, fault) : OK;
}

/* ---- answers ---- */

static void add_indented(struct buf *out, const struct buf *lines)
{
    for (const char *at = buf_text(lines); *at;) {
        size_t n = strcspn(at, "\n");
        buf_add_text(out, "    ");
        buf_add(out, at, n);
        buf_add_char(out, '\n');
        at += n + (at[n] == '\n');
    }
}

void script_acknowledge(const struct interpreter *interp, const struct reply *reply,
                        const struct printer *printer)
{
    OWNED(buf_release) struct buf text = {0};
    buf_printf(&text, interp->acknowledged ? "ok %zu " : "ok - ", interp->acknowledged);
    buf_add_safe(&text, buf_text(&reply->canonical), reply->canonical.length);
    buf_add_char(&text, '\n');
    add_indented(&text, &reply->text);
    printer->print(printer->context, buf_text(&text));
}

static void print_warning(const struct printer *printer, const char *name, size_t line,
                          const struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0};
    buf_add_safe_text(&text, name);
    buf_printf(&text, ":%zu: %s\n", line, fault->text);
    printer->warn(printer->context, buf_text(&text));
}

/* ---- runs ---- */

/* Report the line at which the run continues; 0 for none. */
static void report_rest(const struct run *run, size_t line)
{
    const size_t other = run->other_comment;
    OWNED(buf_release) struct buf text = {0};
    buf_add_safe_text(&text, journal_path(run->interp->journal));
    if (line)
        buf_printf(&text, " has the lines before line %zu of ", line);
    else
        buf_add_text(&text, " has all of ");
    buf_add_safe_text(&text, run->name);
    buf_printf(&text, ", %zu record%s", run->records, plural(run->records));
    buf_add_text(&text, line ? ": the run continues there\n" : ": nothing is left to do\n");
    if (other)
        buf_printf(
            &text,
            "the comments before its record %zu are others than those of the script; they stay\n",
            other);
    run->printer->warn(run->printer->context, buf_text(&text));
}

/* True for a question after the last record whose file was written by the interrupted run. */
static bool was_answered(const struct run *run, const char *line)
{
    struct interpreter *interp = run->interp;
    OWNED(call_release) struct call call = {0};
    return run->mode == RECORDED_ENDS && interp->found_existing &&
           journal_count(interp->journal) <= run->records &&
           command_parse(&call, line, interp->session, NULL) == OK && call.command &&
           !(call.command->flags & COMMAND_RECORDED);
}

/* Execute a line, unless it is already recorded: then *taken. */
static enum err run_line(struct run *run, const char *line, size_t number, bool *taken,
                         struct reply *reply, struct fault *fault)
{
    struct interpreter *interp = run->interp;
    const bool stays = is_comment(line);
    enum err err = take_recorded(run, line, taken, reply, fault);
    if (err || *taken)
        return err;
    if (run->mode == RECORDED_ENDS && !stays && !run->goes_on) {
        run->goes_on = true;
        report_rest(run, number);
    }
    if (interp->journal && !*line)
        err = journal_comment(interp->journal, line, fault);
    if (!err)
        err = interpreter_execute(interp, line, reply, fault);
    if (err == ERR_IO && was_answered(run, line)) {
        print_warning(run->printer, run->name, number, fault);
        err = OK;
        reply_clear(reply);
    }
    return err;
}

/* Read the next line; false at the end, or if the watch stops. */
static bool next_line(const struct interpreter *interp, FILE *input, struct buf *line,
                      const struct printer *printer)
{
    if (printer->waits)
        printer->waits(printer->context, true);
    const bool is_there = !watch_stops(interp->session->watch) && read_line(input, line);
    if (printer->waits)
        printer->waits(printer->context, false);
    return is_there;
}

enum err script_run(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                    const struct printer *printer, size_t *stopped, struct fault *fault)
{
    OWNED(run_release) struct run run = {.interp = interp, .name = name, .printer = printer};
    OWNED(buf_release) struct buf line = {0};
    OWNED(reply_release) struct reply reply = {0};
    enum err first = begin_run(&run, input, fault);
    bool ends = first != OK;
    size_t number;
    *stopped = 0;
    for (number = 1; !ends && interp->wish != WISH_QUIT && next_line(interp, input, &line, printer);
         number++) {
        bool taken;
        if (*buf_text(&line) == '=')
            continue;
        const enum err err = run_line(&run, buf_text(&line), number, &taken, &reply, fault);
        if (err) {
            /* Print the list to choose from before the error. */
            OWNED(buf_release) struct buf text = {0};
            add_indented(&text, &reply.list);
            if (text.length)
                printer->print(printer->context, buf_text(&text));
            print_warning(printer, name, number, fault);
            first = first ? first : err;
            ends = !keep_going || err == ERR_CANCELLED;
            *stopped = ends && !taken ? number : 0;
        } else if (reply.canonical.length) {
            script_acknowledge(interp, &reply, printer);
            if (!taken && interp->shows_picture && printer->show)
                printer->show(printer->context, interp);
        }
    }
    if (!first && interp->wish != WISH_QUIT && watch_fault(interp->session->watch, fault)) {
        *stopped = number;
        first = fault_set(fault, ERR_CANCELLED, "cancelled before this line");
        print_warning(printer, name, number, fault);
    } else if (!ends && run.mode == RECORDED_FOLLOWS) {
        const enum err left = report_difference(&run, NULL, fault);
        print_warning(printer, name, number, fault);
        first = first ? first : left;
    } else if (!ends && run.mode == RECORDED_ENDS && !run.goes_on) {
        report_rest(&run, 0);
    }
    return !first && ferror(input) ? fault_set(fault, ERR_IO, "cannot read %s", name) : first;
}
