/* SPDX-License-Identifier: MIT */
#include "verify/replay_file.h"

#include <inttypes.h>
#include <string.h>
#include <sys/stat.h>

#include "base/confine.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"
#include "command/execute.h"
#include "journal/journal.h"
#include "command/trust.h"

/* ---- the slowest records ---- */

static void timing_add(struct timing *timing, size_t number, uint64_t ns, const char *command)
{
    struct timing_row fresh = {.ns = ns, .number = number};
    size_t at = timing->rows;
    while (at && timing->row[at - 1].ns < ns)
        at--;
    if (at == TIMING_MOST)
        return;
    buf_add_safe_excerpt(&fresh.command, command, strlen(command));
    if (timing->rows == TIMING_MOST)
        buf_release(&timing->row[--timing->rows].command);
    memmove(timing->row + at + 1, timing->row + at, (timing->rows - at) * sizeof fresh);
    timing->row[at] = fresh;
    timing->rows++;
}

void timing_write(struct buf *lines, const struct timing *timing)
{
    for (size_t i = 0; i < timing->rows; i++) {
        const struct timing_row *row = timing->row + i;
        buf_printf(lines, "%" PRIu64 ".%03u ms, record %zu: %s\n", row->ns / 1000000,
                   (unsigned)(row->ns / 1000 % 1000), row->number, buf_text(&row->command));
    }
}

void timing_release(struct timing *timing)
{
    for (size_t i = 0; i < timing->rows; i++)
        buf_release(&timing->row[i].command);
    timing->rows = 0;
}

/* ---- the replay ---- */

static enum err execute(void *context, const char *command, struct buf *words, struct fault *fault)
{
    struct replaying *replaying = context;
    OWNED(reply_release) struct reply reply = {0};
    const bool is_judged = ++replaying->number >= replaying->first;
    replaying->interp->judge = is_judged ? replaying->judge : NULL;
    const uint64_t begin = clock_ns();
    enum err err = interpreter_execute(replaying->interp, command, &reply, fault);
    if (replaying->timing)
        timing_add(replaying->timing, replaying->number, clock_ns() - begin, command);
    const struct listener *listener = replaying->interp->listener;
    if (!err && listener)
        listener->hear(listener->context, replaying->interp, &reply);
    if (!err && replaying->printer && reply.canonical.length)
        script_acknowledge(replaying->interp, &reply, replaying->printer);
    buf_add_text(words, buf_text(&reply.words));
    return err;
}

static void note_record(void *context, const struct record *record)
{
    struct replaying *replaying = context;
    replaying->interp->replayed_words = record->result;
}

static enum err begin(void *context, unsigned semantics, struct fault *fault)
{
    const struct replaying *replaying = context;
    return session_set_semantics(replaying->interp->session, semantics, fault);
}

struct replay_host replay_file_host(struct replaying *replaying)
{
    return (struct replay_host){replaying, execute, note_record, begin};
}

/* A link that leads out of its folder must lead to a journal. Other files are reported as
 * missing, so that their content does not appear as unknown commands. */
static enum err read_journal(struct buf *bytes, const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf folder = {0};
    const enum err err = file_exists(path) ? file_read(bytes, path, JOURNAL_BYTES_MAX, fault) : OK;
    file_folder(&folder, path);
    const bool is_elsewhere =
        folder.failed || path_kind_below(buf_text(&folder), file_name(path)) == PATH_IS_OUTSIDE;
    const bool is_shown = !is_elsewhere || (!err && strncmp(buf_text(bytes), RECORD_HEADER,
                                                            strlen(RECORD_HEADER)) == 0);
    struct stat status;
    if (is_shown && file_exists(path))
        return err;
    return lstat(path, &status) == 0 && S_ISLNK(status.st_mode)
               ? fault_set(fault, ERR_IO, "%s is a link, and leads to no journal", path)
               : fault_set(fault, ERR_IO, "there is no journal %s", path);
}

enum err replay_file_begin(struct interpreter *interp, const char *path, struct buf *bytes,
                           struct fault *fault)
{
    const enum err err = read_journal(bytes, path, fault);
    interp->mode = MODE_REPLAY;
    if (!interp->session->watch) /* the watch of a terminal checks the limits as well */
        session_set_watch(interp->session, limits_watch());
    return err ? err : interpreter_set_home(interp, path, fault);
}

enum err replay_file(struct interpreter *interp, const char *path, size_t first, size_t last,
                     const struct printer *printer, struct timing *timing,
                     struct replay_report *report, struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0};
    struct replaying replaying = {.interp = interp,
                                  .printer = printer,
                                  .timing = timing,
                                  .judge = interp->judge,
                                  .first = first};
    const struct replay_host host = replay_file_host(&replaying);
    const struct replay_options options = {first, last};
    enum err err = replay_file_begin(interp, path, &bytes, fault);
    if (!err)
        err = replay_run(buf_text(&bytes), bytes.length, &host, &options, report, fault);
    interp->replayed_words = NULL;
    interp->judge = replaying.judge;
    return err;
}

/* ---- meaning of a difference ---- */

void replay_add_detail(struct buf *lines, const char *what, const char *text, size_t length)
{
    buf_printf(lines, "#   %-9s", what);
    buf_add_safe(lines, text, length);
    buf_add_char(lines, '\n');
}

enum likeness { ABSENT, SAME, OTHER }; /* ABSENT: one of the two lacks the word */

static enum likeness compare(const char *expected, const char *actual, const char *key)
{
    struct record_word e, a;
    if (!record_word_find(expected, key, strlen(key), &e))
        return ABSENT;
    const bool is_same = record_word_is_among(actual, &e, &a);
    return is_same ? SAME : a.value ? OTHER : ABSENT;
}

/* Name the meaning of a difference. Inputs of a command are checked before its results. */
static const char *meaning(const char *expected, const char *actual)
{
    const enum likeness labels = compare(expected, actual, "labels"),
                        forest = compare(expected, actual, "forest");
    if (compare(expected, actual, "scene") == OTHER)
        return "the scene is another one: other voxels were read";
    if (compare(expected, actual, "file") == OTHER || compare(expected, actual, "channel") == OTHER)
        return "a file that the command read holds something else";
    if (compare(expected, actual, "weights") == OTHER)
        return "the arc weights differ, and what grows by them may";
    if (labels == OTHER)
        return "labels differ: voxels belong to other objects";
    if (labels == SAME && forest == OTHER)
        return "only keys differ: every voxel has the same label, by another cost, hops or root";
    if (compare(expected, actual, "picture") == OTHER || compare(expected, actual, "spin") == OTHER)
        return forest == SAME ? "only the picture differs: the forest and its labels are the same"
                              : "the picture differs; the command says nothing of the forest";
    return NULL;
}

/* Add the difference of two counts, decimal numbers of up to 12 digits. Digests are longer. */
static void add_difference(struct buf *lines, const struct record_word *e,
                           const struct record_word *a)
{
    const char *expected = e->value, *actual = a->value;
    int64_t before, now;
    if (e->value_length > 12 || a->value_length > 12 ||
        !scan_integer(&expected, 0, INT64_MAX, &before) || expected != e->value + e->value_length ||
        !scan_integer(&actual, 0, INT64_MAX, &now) || actual != a->value + a->value_length)
        return;
    buf_printf(lines, " (%" PRId64 " %s)", now > before ? now - before : before - now,
               now > before ? "more" : "less");
}

static void write_word(struct buf *lines, const struct record_word *e, const struct record_word *a,
                       enum divergence_of of)
{
    const bool is_replay = of == DIVERGENCE_OF_REPLAY;
    buf_printf(lines, "#   %-9s", "word");
    buf_add_safe(lines, e->key, e->key_length);
    buf_add_text(lines, ": ");
    buf_add_safe(lines, e->value, e->value_length);
    buf_add_text(lines, is_replay ? " was recorded, " : " in the first, ");
    if (a->value)
        buf_add_safe(lines, a->value, a->value_length);
    else
        buf_add_text(lines, "nothing");
    buf_add_text(lines, is_replay ? " now" : " in the second");
    if (a->value)
        add_difference(lines, e, a);
    buf_add_char(lines, '\n');
}

void divergence_describe(struct buf *lines, const char *expected, const char *actual,
                         enum divergence_of of)
{
    const char *words = meaning(expected, actual);
    const char *at = expected, *end = expected + strlen(expected);
    struct record_word e, a;
    OWNED(buf_release) struct buf same = {0};
    if (words)
        replay_add_detail(lines, "meaning", words, strlen(words));
    while (record_word_next(&at, end, &e)) {
        if (!record_word_is_among(actual, &e, &a)) {
            write_word(lines, &e, &a, of);
            continue;
        }
        buf_add_text(&same, same.length ? ", " : "");
        buf_add(&same, e.key, e.key_length);
    }
    if (same.length)
        replay_add_detail(lines, "the same", same.data, same.length);
    lines->failed = lines->failed || same.failed;
}

/* ---- the report in words ---- */

void replay_describe(struct buf *text, const struct replay_report *report,
                     const struct fault *fault)
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
    buf_add_text(text, "# ");
    if (report->number) /* the fault may precede the first record */
        buf_printf(text, "record %zu, line %zu: ", report->number, report->line);
    if (report->outcome == REPLAY_DIVERGED)
        buf_add_text(text, "the first command whose result differs\n");
    else
        buf_printf(text, "%s\n", fault->text);
    if (report->command.length)
        replay_add_detail(text, "command", buf_text(&report->command), report->command.length);
    if (report->outcome != REPLAY_DIVERGED)
        return;
    replay_add_detail(text, "differs", buf_text(&report->word), report->word.length);
    replay_add_detail(text, "expected", buf_text(&report->expected), report->expected.length);
    replay_add_detail(text, "actual", buf_text(&report->actual), report->actual.length);
    divergence_describe(text, buf_text(&report->expected_words), buf_text(&report->actual_words),
                        DIVERGENCE_OF_REPLAY);
}

enum err replay_aloud(struct interpreter *interp, const char *path, const struct printer *printer,
                      struct fault *fault)
{
    OWNED(replay_report_release) struct replay_report report = {0};
    OWNED(buf_release) struct buf text = {0};
    const enum err err = replay_file(interp, path, 0, 0, printer, NULL, &report, fault);
    /* otherwise the error says everything */
    if (report.outcome != REPLAY_UNREADABLE || report.number)
        replay_describe(&text, &report, fault);
    if (text.length)
        printer->warn(printer->context, buf_text(&text));
    TRY(err);
    buf_printf(&text, "# %zu command%s replayed, %zu result%s the same\n", report.executed,
               plural(report.executed), report.compared, plural(report.compared));
    printer->print(printer->context, buf_text(&text));
    return OK;
}
