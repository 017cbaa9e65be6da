/* SPDX-License-Identifier: MIT */
#include "journal/replay.h"

#include <inttypes.h>
#include <string.h>

#include "base/mem.h"
#include "journal/record.h"

enum { SHOWN_MAX = 80 }; /* bytes of untrusted text in a message */

void replay_report_release(struct replay_report *report)
{
    buf_release(&report->command);
    buf_release(&report->word);
    buf_release(&report->expected);
    buf_release(&report->actual);
    buf_release(&report->expected_words);
    buf_release(&report->actual_words);
}

/* Note the record at which the replay stops. */
static void stop_at(struct replay_report *report, enum replay_outcome outcome,
                    const struct record *record)
{
    report->outcome = outcome;
    report->number = record->number;
    report->line = record->line;
    buf_add_text(&report->command, record->command);
}

static enum err diverge(const struct record *record, const char *words,
                        const struct record_word *expected, const struct record_word *actual,
                        struct replay_report *report, struct fault *fault)
{
    stop_at(report, REPLAY_DIVERGED, record);
    buf_add_text(&report->expected_words, record->result);
    buf_add_text(&report->actual_words, words);
    buf_add(&report->word, expected->key, expected->key_length);
    buf_add(&report->expected, expected->value, expected->value_length);
    buf_add(&report->actual, actual->value, actual->value_length);
    if (report->command.failed || report->word.failed || report->expected.failed ||
        report->actual.failed || report->expected_words.failed || report->actual_words.failed)
        return fault_memory(fault, "the report of a replay");
    return fault_set(fault, ERR_CHECK,
                     "record %zu (line %zu) diverges: %.*s is %s%.*s, %.*s was recorded; "
                     "command: %.*s",
                     record->number, record->line, SHOWN_MAX, buf_text(&report->word),
                     actual->value ? "" : "missing", SHOWN_MAX, buf_text(&report->actual),
                     SHOWN_MAX, buf_text(&report->expected), SHOWN_MAX, record->command);
}

static enum err compare(const struct record *record, const char *words,
                        struct replay_report *report, struct fault *fault)
{
    const char *at = record->result, *end = at + strlen(at);
    struct record_word expected, actual;
    while (record_word_next(&at, end, &expected)) {
        if (!record_word_is_among(words, &expected, &actual))
            return diverge(record, words, &expected, &actual, report, fault);
        report->digests += record_word_is_digest(&expected);
    }
    if (record_lacks_digest(record->result, words) && !report->bare++) {
        report->bare_number = record->number;
        report->bare_line = record->line;
    }
    return OK;
}

enum err replay_record(const struct record *record, const struct replay_host *host,
                       struct replay_report *report, struct fault *fault)
{
    OWNED(buf_release) struct buf words = {0};
    struct fault why = {.text = ""};
    if (host->on_record)
        host->on_record(host->context, record);
    enum err err = host->execute(host->context, record->command, &words, &why);
    if (!err && words.failed)
        err = fault_memory(&why, "result words");
    if (err) {
        stop_at(report, REPLAY_FAILED, record);
        buf_add_text(&report->actual, why.text);
        /* the journal shows that the program once understood this command */
        why.code = err == ERR_USAGE ? ERR_CHECK : err;
        err = fault_prefix(&why, why.code, "record %zu (line %zu) fails: %.*s", record->number,
                           record->line, SHOWN_MAX, record->command);
        if (fault)
            *fault = why;
    } else if (record->has_result) {
        err = compare(record, buf_text(&words), report, fault);
        report->compared += err == OK;
    }
    report->executed += err == OK;
    return err;
}

/* Add a possible explanation to the words of a failure. */
static enum err explain(enum err err, const struct replay_report *report, struct fault *fault)
{
    if (report->is_intact)
        return err;
    if (err)
        return fault_prefix(fault, err,
                            "the journal was edited or damaged at record %zu (line %zu)",
                            report->edited_number, report->edited_line);
    return fault_set(fault, ERR_CHECK,
                     "the journal was edited or damaged at record %zu (line %zu, from byte %" PRIu64
                     "), though every command reproduces its result",
                     report->edited_number, report->edited_line, report->edited_offset);
}

enum err replay_begin(struct replay *r, const char *bytes, size_t length,
                      const struct replay_host *host, const struct replay_options *options,
                      struct replay_report *report, struct fault *fault)
{
    *r = (struct replay){.host = host, .options = options, .report = report};
    report->is_intact = true;
    report->chain = record_chain_zero;
    enum err err = walk_begin(&r->walk, bytes, length, fault);
    if (!err)
        report->is_journal = r->walk.is_journal;
    if (!err && host->begin && r->walk.semantics)
        err = host->begin(host->context, r->walk.semantics, fault);
    if (err) {
        report->outcome = REPLAY_UNREADABLE;
        walk_release(&r->walk);
    }
    return err;
}

/* Check that the record is as it was written, and note the first that is not. */
static void judge_record(struct replay *r)
{
    struct record *record = &r->record;
    struct replay_report *report = r->report;
    const bool is_sound = r->walk.is_journal ? !record_judge(record, NULL) : !record->has_result;
    if (record->number < r->options->first) {
        record->has_result = false;
    } else if (!is_sound && report->is_intact) {
        report->is_intact = false;
        report->edited_number = record->number;
        report->edited_line = record->line;
        report->edited_offset = record->offset;
    }
    report->chain = record->chain;
}

enum err replay_next(struct replay *r, struct fault *fault)
{
    r->is_over = r->is_over || walk_next(&r->walk, &r->record) != WALK_RECORD;
    if (r->is_over)
        return OK;
    judge_record(r);
    const enum err err = replay_record(&r->record, r->host, r->report, fault);
    r->is_over = err || r->record.number == r->options->last;
    return err;
}

enum err replay_end(struct replay *r, enum err err, struct fault *fault)
{
    struct replay_report *report = r->report;
    if (!err) {
        report->is_torn = r->walk.over == WALK_TORN;
        report->torn_offset = report->is_torn ? r->walk.offset : 0;
        if (r->walk.over == WALK_DAMAGED)
            stop_at(report, REPLAY_UNREADABLE, &r->walk.place);
        err = walk_judge(&r->walk, fault);
    }
    err = explain(err, report, fault);
    walk_release(&r->walk);
    return err;
}

enum err replay_run(const char *bytes, size_t length, const struct replay_host *host,
                    const struct replay_options *options, struct replay_report *report,
                    struct fault *fault)
{
    struct replay replay;
    enum err err = OK;
    TRY(replay_begin(&replay, bytes, length, host, options, report, fault));
    while (!err && !replay.is_over)
        err = replay_next(&replay, fault);
    return replay_end(&replay, err, fault);
}
