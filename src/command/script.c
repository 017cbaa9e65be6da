#include "command/script.h"

#include <string.h>

#include "command/recorded.h"

enum { LINE_BYTES_MOST = 65536 };

bool script_read_line(FILE *input, struct buf *line)
{
    int c;
    buf_clear(line);
    while ((c = getc(input)) != EOF && c != '\n')
        if (line->length < LINE_BYTES_MOST)
            buf_add_char(line, (char)(c ? c : 1)); /* a zero byte would hide what follows it */
    if (line->length && line->data[line->length - 1] == '\r')
        line->data[--line->length] = '\0';
    return c != EOF || line->length > 0;
}

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
    struct buf text = {0};
    buf_printf(&text, interp->acknowledged ? "ok %zu " : "ok - ", interp->acknowledged);
    buf_add_safe(&text, buf_text(&reply->canonical), reply->canonical.length);
    buf_add_char(&text, '\n');
    add_indented(&text, &reply->text);
    printer->print(printer->context, buf_text(&text));
    buf_release(&text);
}

/* What there is to choose from, before the error that is about it. */
static void print_list(const struct reply *reply, const struct printer *printer)
{
    struct buf text = {0};
    add_indented(&text, &reply->list);
    if (text.length)
        printer->print(printer->context, buf_text(&text));
    buf_release(&text);
}

static void warn(const struct printer *printer, const char *name, size_t line,
                 const struct fault *fault)
{
    struct buf text = {0};
    buf_add_safe_text(&text, name);
    buf_printf(&text, ":%zu: %s\n", line, fault->text);
    printer->warn(printer->context, buf_text(&text));
    buf_release(&text);
}

bool script_is_comment(const char *line)
{
    const bool is_header = strncmp(line, RECORD_HEADER, sizeof RECORD_HEADER - 1) == 0;
    return (*line == '#' || *line == '\0') && !is_header;
}

/* The next line; false at the end, or where the watch stops. */
static bool next_line(const struct interpreter *interp, FILE *input, struct buf *line,
                      const struct printer *printer)
{
    if (printer->waits)
        printer->waits(printer->context, true);
    const bool is_there =
        !watch_stops(session_watch(interp->session)) && script_read_line(input, line);
    if (printer->waits)
        printer->waits(printer->context, false);
    return is_there;
}

/* ---- what is recorded already ---- */

/* A run of a script, with what of it the journal has. */
struct run {
    struct interpreter *interp;
    const char *name;
    const struct printer *printer;
    struct recorded recorded;
    bool goes_on; /* a line was carried out that the journal does not have */
};

/* Which line the run goes on with; 0 for none. */
static void say_what_is_left(const struct run *run, size_t line)
{
    const size_t other = run->recorded.other_comment;
    struct buf text = {0};
    buf_add_safe_text(&text, journal_path(run->interp->journal));
    if (line)
        buf_printf(&text, " has what stands before line %zu of ", line);
    else
        buf_add_text(&text, " has all of ");
    buf_add_safe_text(&text, run->name);
    buf_printf(&text, ", %zu record%s", run->recorded.records, plural(run->recorded.records));
    buf_add_text(&text, line ? ": the run goes on there\n" : ": nothing is left to do\n");
    if (other)
        buf_printf(
            &text,
            "the comments before its record %zu are others than those of the script; they stay\n",
            other);
    run->printer->warn(run->printer->context, buf_text(&text));
    buf_release(&text);
}

/* A question after the last record, whose file the run that was interrupted has written. */
static bool was_answered(const struct run *run, const char *line)
{
    struct interpreter *interp = run->interp;
    struct call call;
    if (run->recorded.mode != RECORDED_ENDS || !interp->keeps ||
        journal_count(interp->journal) > run->recorded.records ||
        command_parse(&call, line, interp->session, NULL) != OK)
        return false;
    const bool is_question = call.command && !(call.command->flags & COMMAND_RECORDED);
    call_release(&call);
    return is_question;
}

/* Carries it out, unless that is recorded already: then *taken. */
static enum err run_line(struct run *run, const char *line, size_t number, bool *taken,
                         struct reply *reply, struct fault *fault)
{
    struct interpreter *interp = run->interp;
    const bool is_comment = script_is_comment(line);
    enum err err = recorded_take(&run->recorded, interp, line, taken, reply, fault);
    if (err || *taken)
        return err;
    if (run->recorded.mode == RECORDED_ENDS && !is_comment && !run->goes_on) {
        run->goes_on = true;
        say_what_is_left(run, number);
    }
    if (interp->journal && is_comment)
        err = journal_comment(interp->journal, line, fault);
    if (!err)
        err = interpreter_execute(interp, line, reply, fault);
    if (err == ERR_IO && was_answered(run, line)) {
        warn(run->printer, run->name, number, fault);
        err = OK;
        reply_clear(reply);
    }
    return err;
}

static enum err end_run(const struct run *run, size_t number, struct fault *fault)
{
    const enum err err = recorded_end(&run->recorded, run->interp, fault);
    if (err)
        warn(run->printer, run->name, number, fault);
    else if (run->recorded.mode == RECORDED_ENDS && !run->goes_on)
        say_what_is_left(run, 0);
    return err;
}

enum err script_run(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                    const struct printer *printer, size_t *stopped, struct fault *fault)
{
    struct run run = {.interp = interp, .name = name, .printer = printer};
    struct buf line = {0};
    struct reply reply = {0};
    enum err first = recorded_begin(&run.recorded, interp, input, fault);
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
            print_list(&reply, printer);
            warn(printer, name, number, fault);
            first = first ? first : err;
            ends = !keep_going || err == ERR_CANCELLED;
            *stopped = ends && !taken ? number : 0;
        } else if (reply.canonical.length) {
            script_acknowledge(interp, &reply, printer);
            if (!taken && interp->shows_picture && printer->show)
                printer->show(printer->context, interp);
        }
    }
    reply_release(&reply);
    buf_release(&line);
    if (!first && interp->wish != WISH_QUIT && watch_fault(session_watch(interp->session), fault)) {
        *stopped = number;
        first = fault_set(fault, ERR_CANCELLED, "cancelled before this line");
        warn(printer, name, number, fault);
    } else if (!ends) {
        const enum err left = end_run(&run, number, fault);
        first = first ? first : left;
    }
    recorded_release(&run.recorded);
    if (!first && ferror(input))
        return fault_set(fault, ERR_IO, "cannot read %s", name);
    return first;
}
