#include "command/script.h"

#include <string.h>

enum { LINE_BYTES_MOST = 65536 };

/* One line without its line feed; false at the end. Of a line that is too long for any command so
 * much is read that it stays too long. */
static bool read_line(FILE *input, struct buf *line)
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

void script_acknowledge(const struct interpreter *interp, const struct reply *reply,
                        const struct printer *printer)
{
    struct buf text = {0};
    buf_printf(&text, interp->acknowledged ? "ok %zu " : "ok - ", interp->acknowledged);
    buf_add_safe(&text, buf_text(&reply->canonical), reply->canonical.length);
    buf_add_char(&text, '\n');
    for (const char *at = buf_text(&reply->text); *at;) {
        size_t n = strcspn(at, "\n");
        buf_add_text(&text, "    ");
        buf_add(&text, at, n);
        buf_add_char(&text, '\n');
        at += n + (at[n] == '\n');
    }
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

/* A script's comments and blank lines go into the journal with the command that follows. */
static enum err store_comment(struct interpreter *interp, const char *line, struct fault *fault)
{
    bool is_comment = *line == '#' || *line == '\0';
    bool is_header = strncmp(line, RECORD_HEADER, sizeof RECORD_HEADER - 1) == 0;
    return interp->journal && is_comment && !is_header
               ? journal_comment(interp->journal, line, fault)
               : OK;
}

/* The next line; false at the end, or where the watch stops. */
static bool next_line(const struct interpreter *interp, FILE *input, struct buf *line,
                      const struct printer *printer)
{
    if (printer->waits)
        printer->waits(printer->context, true);
    const bool is_there = !watch_stops(interp->session.watch) && read_line(input, line);
    if (printer->waits)
        printer->waits(printer->context, false);
    return is_there;
}

enum err script_run(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                    const struct printer *printer, size_t *stopped, struct fault *fault)
{
    struct buf line = {0};
    struct reply reply = {0};
    enum err first = OK;
    size_t number;
    *stopped = 0;
    for (number = 1; interp->wish != WISH_QUIT && next_line(interp, input, &line, printer);
         number++) {
        if (*buf_text(&line) == '=')
            continue;
        enum err err = store_comment(interp, buf_text(&line), fault);
        if (!err)
            err = interpreter_execute(interp, buf_text(&line), &reply, fault);
        if (err) {
            warn(printer, name, number, fault);
            first = first ? first : err;
            if (!keep_going || err == ERR_CANCELLED) {
                *stopped = number;
                break;
            }
        } else if (reply.canonical.length) {
            script_acknowledge(interp, &reply, printer);
            if (interp->shows_picture && printer->show)
                printer->show(printer->context, interp);
        }
    }
    reply_release(&reply);
    buf_release(&line);
    if (!first && interp->wish != WISH_QUIT && watch_fault(interp->session.watch, fault)) {
        *stopped = number;
        first = fault_set(fault, ERR_CANCELLED, "cancelled before this line");
        warn(printer, name, number, fault);
    }
    if (!first && ferror(input))
        return fault_set(fault, ERR_IO, "cannot read %s", name);
    return first;
}
