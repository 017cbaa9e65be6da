/* SPDX-License-Identifier: MIT */
#include "verify/verify.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/mem.h"
#include "command/act.h"
#include "journal/journal.h"
#include "show/draw.h"
#include "show/export_picture.h"
#include "verify/verify_inside.h"
#include "verify/replay_file.h"

enum {
    PICTURES_MOST = 64 << 20,               /* bytes of pictures in a report */
    RESULT_MOST = PICTURES_MOST + (8 << 20) /* bytes that a process may return */
};

/*
 * One journal in a process of its own: its replay, checks for completeness, and whether it is the
 * expected one (--expect).
 */

/* ---- the replay of one journal ---- */

/* Add the present rendition, for a person who inspects the difference. */
static void show_present(struct interpreter *interp, struct evidence *evidence)
{
    OWNED(picture_release) struct picture picture = {0};
    if (!interp->session->has_scene || evidence->pictures ||
        session_draw(interp->session, RENDER_AS_KEPT, NULL) ||
        export_picture(&picture, interp->session, PICTURE_BUT_NORMAL, NULL))
        return;
    export_background(&picture, interp->session, NULL);
    evidence_add(evidence, "actual: the rendition after this command", picture.width,
                 picture.height, picture_colours(&picture));
}

/* Add the present voxels of each label as comment lines. */
static void write_voxels(struct interpreter *interp, struct buf *lines)
{
    OWNED(reply_release) struct reply reply = {0};
    if (interp->session->has_scene &&
        !act_write_counts(
            &(struct act){.interp = interp, .session = interp->session, .reply = &reply}))
        for (const char *at = buf_text(&reply.text); *at;) {
            const size_t n = strcspn(at, "\n");
            replay_add_detail(lines, "now", at, n);
            at += n + (at[n] == '\n');
        }
}

static enum err judge_orphans(const struct verify_options *options, struct interpreter *interp,
                              struct verify_result *result, struct fault *fault)
{
    const struct orphan_search search = {.interp = interp,
                                         .journal = result->path,
                                         .is_strict = options->strict || options->expect,
                                         .lines = options->removes_orphans ? NULL : &result->lines};
    const enum err err = orphan_find(&result->orphans, &search, fault);
    const char *at = buf_text(&result->orphans), *end = at + result->orphans.length;
    for (; at < end; at += strlen(at) + 1)
        replay_add_detail(&result->lines, "orphan", at, strlen(at));
    return err;
}

static enum err refuse_torn(uint64_t offset, const char *who, struct fault *fault)
{
    return fault_set(fault, ERR_CHECK,
                     "%s: it ends with an unfinished record, at byte %" PRIu64
                     ", which no chain covers: continue the journal, or use iftty log --repair, to "
                     "cut it off",
                     who, offset);
}

/*
 * Strict verification fails on incomplete evidence.
 *
 * A replay fails if something differs. It also passes if nothing was compared: a person may have
 * removed digests or the last records and computed the chain again, since the chain holds no
 * secret. So these are failures here:
 *
 *     torn tail          an unfinished record at the end was left as it is
 *     no records         there is only a header
 *     bare record        a record lacks the digest of its command
 *     no golden image    no pixel was compared; checked for whole journals only
 *
 * A journal cannot show that its last records were removed: use --expect for that. Any replay fails
 * on a recorded word that this build does not compute (journal/replay.h), and on unknown semantics
 * (session/session.h).
 */
static enum err judge_strictly(const struct replay_report *report, bool lacks_goldens,
                               struct fault *fault)
{
    if (report->is_torn)
        return refuse_torn(report->torn_offset, "strict", fault);
    if (!report->executed)
        return fault_set(fault, ERR_CHECK, "strict: it has a header and no records");
    if (report->bare)
        return fault_set(fault, ERR_CHECK,
                         "strict: %zu record%s without the digest that the command computes, the "
                         "first is record %zu (line %zu): iftty log --reseal records them",
                         report->bare, plural(report->bare), report->bare_number,
                         report->bare_line);
    if (lacks_goldens)
        return fault_set(fault, ERR_CHECK,
                         "strict: no golden image was compared: `golden NAME` in a session makes "
                         "one, --no-strict asks for none");
    return OK;
}

/* Check everything that a successful replay does not compare. */
static enum err judge_whole(const struct verify_options *options, struct interpreter *interp,
                            const struct replay_report *report, struct verify_result *result,
                            struct fault *fault)
{
    const bool is_part = options->first || options->last;
    if (!report->is_journal)
        return fault_set(fault, ERR_CHECK, "this is a script, not a journal: nothing to compare");
    if (options->first > report->executed)
        return fault_set(fault, ERR_CHECK,
                         "it ends with record %zu: nothing to compare from %zu on",
                         report->executed, options->first);
    TRY(options->last ? OK : judge_orphans(options, interp, result, fault));
    return options->strict ? judge_strictly(report, !is_part && !result->evidence.goldens, fault)
                           : OK;
}

/* Name the folder for the evidence of a journal; it is made when evidence exists. Journals of
 * equal names have subfolders, numbered by their positions in the list, so that none replaces the
 * files of another. */
static void place_evidence(struct buf *folder, const struct verify_options *options,
                           const char *path)
{
    size_t number = 0, namesakes = 0;
    for (size_t i = 0; i < options->count; i++) {
        if (options->path[i] == path)
            number = i + 1;
        namesakes += strcmp(file_name(options->path[i]), file_name(path)) == 0;
    }
    buf_add_text(folder, options->evidence_folder);
    if (namesakes > 1)
        buf_printf(folder, "/%zu", number);
}

/* ---- the expected chain ---- */

/* Compare the last chain with the expected one, even if the replay failed. */
static enum err judge_expected(const struct verify_options *options,
                               const struct verify_result *result, struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    if (!options->expect)
        return OK;
    TRY(walk_file(&walk, &bytes, result->path, fault));
    while (walk_next(&walk, &record) == WALK_RECORD)
        continue;
    const char *chain = walk.chain.hex;
    TRY(walk_judge(&walk, fault));
    if (!options->last && !result->err &&
        strncmp(chain, buf_text(&result->chain), result->chain.length) != 0)
        return fault_set(fault, ERR_CHECK, "it was changed while it was verified");
    if (walk.over == WALK_TORN)
        return refuse_torn(walk.offset, "--expect", fault);
    if (strncmp(chain, options->expect, RECORD_CHAIN_DIGITS) != 0)
        return fault_set(fault, ERR_CHECK,
                         "its last chain is %.*s, and %s was expected: it is another journal, or "
                         "has more records or fewer",
                         (int)RECORD_CHAIN_DIGITS, chain, options->expect);
    return OK;
}

/* ---- in the process of a journal ---- */

static void replay_one(const struct verify_options *options, struct verify_result *result)
{
    const char *path = result->path;
    OWNED(interpreter_release) struct interpreter interp;
    OWNED(replay_report_release) struct replay_report report = {0};
    OWNED(timing_release) struct timing timing = {.rows = 0};
    OWNED(buf_release) struct buf folder = {0};
    struct fault fault = {0};
    const struct golden_judge judge = evidence_judge(&result->evidence);
    const uint64_t begin = clock_ns();
    enum err err = interpreter_init(&interp, &fault);
    if (!err && options->begin)
        err = options->begin(options->context, path, &fault);
    interp.scene_path = options->scene_path;
    interp.channel_path = options->channel_path;
    if (options->evidence_folder)
        place_evidence(&folder, options, path);
    result->evidence.folder = folder.length ? buf_text(&folder) : NULL;
    result->evidence.has_pictures = options->html != NULL;
    interp.judge = &judge;
    if (!err)
        err = replay_file(&interp, path, options->first, options->last, NULL,
                          options->timings ? &timing : NULL, &report, &fault);
    replay_describe(&result->lines, &report, &fault);
    const bool is_told = err && result->lines.length;
    if (!err)
        err = judge_whole(options, &interp, &report, result, &fault);
    if (report.outcome == REPLAY_DIVERGED) {
        write_voxels(&interp, &result->lines);
        if (options->html)
            show_present(&interp, &result->evidence);
    }
    verify_result_fail(result, err, is_told, &fault);
    result->executed = report.executed;
    result->compared = report.compared;
    result->digests = report.digests;
    if (report.executed)
        buf_add_text(&result->chain, report.chain.hex);
    result->took_ms = (clock_ns() - begin) / 1000000;
    timing_write(&result->slowest, &timing);
    result->evidence.folder = NULL;
}

/* ---- all journals ---- */

struct verification {
    const struct verify_options *options;
    const struct printer *printer;
    struct verify_result *result; /* [options->count] */
    size_t printed;               /* journals */
    bool is_given_up;             /* one journal failed, and the run ends */
    struct watch watch;
    size_t picture_bytes;
};

static void work(void *context, size_t number, struct buf *out)
{
    const struct verification *v = context;
    struct verify_result result = {.path = v->options->path[number]};
    struct fault fault = {0};
    replay_one(v->options, &result);
    const enum err err = judge_expected(v->options, &result, &fault);
    if (err && !result.err) /* in addition to the result of the replay */
        verify_result_fail(&result, err, false, &fault);
    else if (err == ERR_CHECK)
        buf_printf(&result.lines, "# %s\n", fault.text);
    verify_result_write(out, &result);
}

static void print_result(const struct verification *v, size_t number)
{
    const struct verify_result *r = v->result + number;
    OWNED(buf_release) struct buf text = {0};
    buf_printf(&text, "%s %zu - ", r->err ? "not ok" : "ok", number + 1);
    buf_add_safe_text(&text, r->path);
    if (r->is_skipped) {
        buf_add_text(&text, " # SKIP not verified: another failed before");
    } else if (!r->err) {
        buf_add_text(&text, " (");
        verify_result_describe(&text, r);
        buf_add_char(&text, ')');
    }
    buf_add_char(&text, '\n');
    buf_add_text(&text, buf_text(&r->lines));
    for (const char *at = buf_text(&r->slowest); *at; at += strcspn(at, "\n"), at += *at == '\n') {
        buf_add_text(&text, "#   took     ");
        buf_add(&text, at, strcspn(at, "\n"));
        buf_add_char(&text, '\n');
    }
    v->printer->print(v->printer->context, buf_text(&text));
}

/* Remove golden images that the journal does not name. Their names come from the process and are
 * checked. */
static void remove_orphans(struct verify_result *result)
{
    struct fault fault;
    const char *at = buf_text(&result->orphans), *end = at + result->orphans.length;
    for (at = result->err ? end : at; at < end; at += strlen(at) + 1) {
        const enum err err = orphan_remove(result->path, at, &fault);
        if (err && !result->err)
            verify_result_fail(result, err, false, &fault);
        if (!err)
            replay_add_detail(&result->lines, "removed", at, strlen(at));
    }
}

static void print_known(struct verification *v)
{
    for (; v->printed < v->options->count && v->result[v->printed].is_known; v->printed++)
        if (!v->options->json)
            print_result(v, v->printed);
}

/* A process without a result is a failure of its journal. */
static void take_result(void *context, size_t number, const struct process_end *end)
{
    struct verification *v = context;
    struct verify_result *result = v->result + number;
    struct fault fault = {0};
    enum err err = process_judge(end, &fault);
    if (!err)
        err = verify_result_read(result, &end->bytes, &fault);
    if (err) {
        verify_result_release(result);
        *result = (struct verify_result){.path = result->path};
        verify_result_fail(result, ERR_CHECK, false, &fault);
    }
    size_t bytes = 0;
    for (size_t i = 0; i < result->evidence.pictures; i++)
        bytes += result->evidence.picture[i].png.length;
    if (bytes > PICTURES_MOST - v->picture_bytes) {
        evidence_release(&result->evidence);
        buf_add_text(&result->lines, "# its pictures are left out: the report holds 64 MiB\n");
    } else {
        v->picture_bytes += bytes;
    }
    if (v->options->removes_orphans)
        remove_orphans(result);
    result->is_known = true;
    v->is_given_up = v->is_given_up || (v->options->fail_fast && result->err);
    print_known(v);
}

static bool stops(void *context, const char *what, uint64_t done, uint64_t total)
{
    const struct verification *v = context;
    return v->is_given_up || watch_poll(v->options->watch, what, done, total);
}

static enum err run_all(struct verification *v, struct fault *fault)
{
    const struct verify_options *o = v->options;
    const struct processes how = {.count = o->count,
                                  .at_once = o->processes ? (unsigned)o->processes : 1,
                                  .most = RESULT_MOST,
                                  .context = v,
                                  .work = work,
                                  .done = take_result,
                                  .watch = &v->watch,
                                  .what = "verifying"};
    v->watch = (struct watch){.context = v, .poll = stops};
    const enum err err = processes_run(&how, fault);
    if (v->is_given_up && (!err || err == ERR_CANCELLED)) {
        for (size_t i = 0; i < o->count; i++)
            if (!v->result[i].is_known)
                v->result[i].is_known = v->result[i].is_skipped = true;
        print_known(v);
        return OK;
    }
    return err == ERR_CANCELLED ? fault_set(fault, err, "cancelled; %zu of %zu journal%s verified",
                                            v->printed, o->count, plural(o->count))
                                : err;
}

static enum err sum_up(const struct verification *v, struct fault *fault)
{
    const struct verify_sum sum = verify_sum(v->result, v->options->count);
    struct buf text = {0};
    if (v->options->json) {
        verify_report_text(&text, VERIFY_JSON, v->result, sum.count);
    } else {
        buf_printf(&text, "1..%zu\n# %zu verified, %zu failed", sum.count, sum.verified,
                   sum.failed);
        if (sum.skipped)
            buf_printf(&text, ", %zu skipped", sum.skipped);
        buf_add_char(&text, '\n');
    }
    TRY(print_text(&text, v->printer->print, v->printer, fault));
    return sum.worst ? fault_set(fault, sum.worst, "%zu of %zu journal%s failed", sum.failed,
                                 sum.count, plural(sum.count))
                     : OK;
}

/* Check that a report can be written, before the verification begins. */
static enum err check_report(const char *path, struct fault *fault)
{
    if (!path)
        return OK;
    if (interpreter_is_journal(path))
        return fault_set(fault, ERR_USAGE,
                         "%s is a journal and was left alone; nothing was verified", path);
    return file_may_write(path, FILE_REPLACE, fault);
}

/* A report that cannot be written has precedence over a journal that failed. */
static enum err report(const struct verification *v, struct fault *fault)
{
    const struct verify_options *o = v->options;
    const enum err err = sum_up(v, fault);
    enum err unwritten = OK;
    if (o->junit)
        unwritten = verify_report(o->junit, VERIFY_JUNIT, v->result, o->count, fault);
    if (!unwritten && o->html)
        unwritten = verify_report(o->html, VERIFY_HTML, v->result, o->count, fault);
    return unwritten ? unwritten : err;
}

bool ci_is_set(void)
{
    const char *ci = getenv("CI");
    return ci && *ci;
}

enum err verify_files(const struct verify_options *options, const struct printer *printer,
                      struct fault *fault)
{
    struct verification v = {.options = options,
                             .printer = printer,
                             .result = calloc(options->count + 1, sizeof *v.result)};
    enum err err = v.result ? OK : fault_memory(fault, "the results");
    for (size_t i = 0; !err && i < options->count; i++)
        v.result[i].path = options->path[i];
    if (!err)
        err = check_report(options->junit, fault);
    if (!err)
        err = check_report(options->html, fault);
    if (!err)
        err = run_all(&v, fault);
    if (!err)
        err = report(&v, fault);
    for (size_t i = 0; v.result && i < options->count; i++)
        verify_result_release(v.result + i);
    free(v.result);
    return err;
}
