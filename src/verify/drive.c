#include "verify/drive.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "verify/divergence.h"
#include "sandbox/limits.h"
#include "session/export.h"

enum { LINE_BYTES_MOST = 65536 };

static void say(const struct teller *teller, struct buf *text)
{
    teller->say(teller->context, buf_text(text));
    buf_clear(text);
}

/* ---- scripts ---- */

/* One line without its line feed; false at the end. A line too long is cut, and still too long for
 * any command. */
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

static void acknowledge(const struct interpreter *interp, const struct reply *reply,
                        const struct teller *teller)
{
    struct buf text = {0};
    buf_printf(&text, "ok %zu ", interp->acknowledged);
    buf_add_safe(&text, buf_text(&reply->canonical), reply->canonical.length);
    buf_add_char(&text, '\n');
    for (const char *at = buf_text(&reply->text); *at;) {
        size_t n = strcspn(at, "\n");
        buf_add_text(&text, "    ");
        buf_add(&text, at, n);
        buf_add_char(&text, '\n');
        at += n + (at[n] == '\n');
    }
    say(teller, &text);
    buf_release(&text);
}

static void complain(const struct teller *teller, const char *name, size_t line,
                     const struct fault *fault)
{
    struct buf text = {0};
    buf_add_safe(&text, name, strlen(name));
    buf_printf(&text, ":%zu: %s\n", line, fault->text);
    teller->complain(teller->context, buf_text(&text));
    buf_release(&text);
}

/* A script's comments and blank lines go into the journal with the command that follows. */
static enum err keep_comment(struct interpreter *interp, const char *line, struct fault *fault)
{
    bool is_comment = *line == '#' || *line == '\0';
    bool is_header = strncmp(line, RECORD_HEADER, sizeof RECORD_HEADER - 1) == 0;
    return interp->journal && is_comment && !is_header
               ? journal_comment(interp->journal, line, fault)
               : OK;
}

/* The next line, unless the watch stops: then it is complained about, if nothing else was. */
static bool next_line(const struct interpreter *interp, FILE *input, struct buf *line,
                      const struct teller *teller)
{
    if (teller->waits)
        teller->waits(teller->context, true);
    const bool is_there = !watch_stops(interp->session.watch) && read_line(input, line);
    if (teller->waits)
        teller->waits(teller->context, false);
    return is_there;
}

enum err drive_script(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                      const struct teller *teller, struct fault *fault)
{
    struct buf line = {0};
    struct reply reply = {0};
    enum err first = OK;
    size_t number;
    for (number = 1; !interp->finished && next_line(interp, input, &line, teller); number++) {
        if (*buf_text(&line) == '=')
            continue;
        enum err err = keep_comment(interp, buf_text(&line), fault);
        if (!err)
            err = interpreter_execute(interp, buf_text(&line), &reply, fault);
        if (err) {
            complain(teller, name, number, fault);
            first = first ? first : err;
            if (!keep_going || err == ERR_CANCELLED)
                break;
        } else if (reply.canonical.length) {
            acknowledge(interp, &reply, teller);
            if (interp->shows_picture && teller->picture)
                teller->picture(teller->context, interp);
        }
    }
    reply_release(&reply);
    buf_release(&line);
    if (!first && !interp->finished && watch_fault(interp->session.watch, fault)) {
        first = fault_set(fault, ERR_CANCELLED, "cancelled before this line");
        complain(teller, name, number, fault);
    }
    if (!first && ferror(input))
        return fault_set(fault, ERR_IO, "cannot read %s", name);
    return first;
}

/* ---- replay ---- */

struct replaying {
    struct interpreter *interp;
    const struct teller *teller;      /* NULL: quietly */
    const struct golden_judge *judge; /* from record `first` on */
    size_t number, first;
};

static enum err execute(void *context, const char *command, struct buf *words, struct fault *fault)
{
    struct replaying *replaying = context;
    struct reply reply = {0};
    const bool is_judged = ++replaying->number >= replaying->first;
    replaying->interp->judge = is_judged ? replaying->judge : NULL;
    enum err err = interpreter_execute(replaying->interp, command, &reply, fault);
    if (!err && replaying->teller && reply.canonical.length)
        acknowledge(replaying->interp, &reply, replaying->teller);
    buf_add_text(words, buf_text(&reply.words));
    reply_release(&reply);
    return err;
}

enum err drive_file(struct interpreter *interp, const char *path, size_t first, size_t last,
                    const struct teller *teller, struct replay_report *report, struct fault *fault)
{
    struct buf bytes = {0};
    struct replaying replaying = {
        .interp = interp, .teller = teller, .judge = interp->judge, .first = first};
    const struct replay_host host = {&replaying, execute};
    const struct replay_options options = {SEMANTICS, first, last};
    enum err err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    interp->replays = true;
    if (!interp->session.watch) /* one of a program at a terminal looks at the limits as well */
        interp->session.watch = limits_watch();
    if (!err)
        err = interpreter_set_home(interp, path, fault);
    if (!err)
        err = replay_run(buf_text(&bytes), bytes.length, &host, &options, report, fault);
    interp->judge = replaying.judge;
    buf_release(&bytes);
    return err;
}

static void add_detail(struct buf *text, const char *what, const struct buf *value)
{
    buf_printf(text, "#   %-9s", what);
    buf_add_safe(text, buf_text(value), value->length);
    buf_add_char(text, '\n');
}

void drive_tell(struct buf *text, const struct replay_report *report, const struct fault *fault)
{
    if (!report->is_intact && report->edited_number)
        buf_printf(text,
                   "# record %zu, line %zu: its chain digest does not fit: the journal was "
                   "edited from here on\n",
                   report->edited_number, report->edited_line);
    if (report->is_torn)
        buf_printf(text, "# an unfinished record at byte %llu was left alone\n",
                   (unsigned long long)report->torn_offset);
    if (report->outcome == REPLAY_SAME)
        return;
    buf_printf(text, "# record %zu, line %zu: ", report->number, report->line);
    if (report->outcome == REPLAY_DIVERGED)
        buf_add_text(text, "the first command that gives another result\n");
    else
        buf_printf(text, "%s\n", fault->text);
    if (report->command.length)
        add_detail(text, "command", &report->command);
    if (report->outcome != REPLAY_DIVERGED)
        return;
    add_detail(text, "differs", &report->word);
    add_detail(text, "expected", &report->expected);
    add_detail(text, "actual", &report->actual);
    divergence_tell(text, buf_text(&report->expected_words), buf_text(&report->actual_words),
                    DIVERGENCE_OF_REPLAY);
}

enum err drive_replay(struct interpreter *interp, const char *path, const struct teller *teller,
                      struct fault *fault)
{
    struct replay_report report = {0};
    struct buf text = {0};
    enum err err = drive_file(interp, path, 0, 0, teller, &report, fault);
    drive_tell(&text, &report, fault);
    if (text.length)
        teller->complain(teller->context, buf_text(&text));
    if (!err)
        buf_printf(&text, "# %zu commands replayed, %zu results the same\n", report.executed,
                   report.compared);
    if (!err)
        teller->say(teller->context, buf_text(&text));
    replay_report_release(&report);
    buf_release(&text);
    return err;
}
