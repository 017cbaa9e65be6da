#include "journal/journal.h"
#include "verify/verify_journal.h"

#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "command/act_figures.h"
#include "report/export.h"
#include "session/semantics.h"
#include "session/session.h"
#include "show/draw.h"
#include "verify/lock_facts.h"
#include "verify/orphan.h"
#include "verify/replay_file.h"
#include "verify/signature.h"
#include "verify/strict.h"

/* ---- the replay of one journal ---- */

/* What is seen now, for a person who asks what a command has come to. */
static void show_present(struct interpreter *interp, struct evidence *evidence)
{
    struct picture picture = {0};
    if (!session_has_scene(interp->session) || evidence->pictures ||
        session_draw(interp->session, RENDER_AS_KEPT, NULL) ||
        export_picture(&picture, interp->session, NULL))
        return;
    export_background(&picture, interp->session, NULL);
    evidence_add(evidence, "actual: the rendition after this command", picture.width,
                 picture.height, picture_colours(&picture));
    picture_release(&picture);
}

/* The voxels of each label now, as comment lines. */
static void write_voxels(struct interpreter *interp, struct buf *lines)
{
    struct reply reply = {0};
    if (session_has_scene(interp->session) &&
        !act_write_counts(
            &(struct act){.interp = interp, .session = interp->session, .reply = &reply}))
        for (const char *at = buf_text(&reply.text); *at;) {
            const size_t n = strcspn(at, "\n");
            buf_printf(lines, "#   %-9s", "now");
            buf_add(lines, at, n);
            buf_add_char(lines, '\n');
            at += n + (at[n] == '\n');
        }
    reply_release(&reply);
}

/* Those that are to be removed are no failure. */
static enum err judge_orphans(const struct verify_options *options, const char *path,
                              const struct interpreter *interp, struct verify_result *result,
                              struct fault *fault)
{
    struct name_list orphans;
    struct buf *told = options->removes_orphans ? NULL : &result->lines;
    enum err err = orphan_find(&orphans, interp, path, told, fault);
    for (size_t i = 0; !err && i < orphans.count; i++) {
        buf_add(&result->orphans, orphans.name[i], strlen(orphans.name[i]) + 1);
        buf_printf(&result->lines, "#   %-9s", "orphan");
        buf_add_safe_text(&result->lines, orphans.name[i]);
        buf_add_char(&result->lines, '\n');
    }
    if (!err && !options->removes_orphans)
        err = orphan_judge(&orphans, path, fault);
    name_list_release(&orphans);
    return err;
}

/* What a replay that went well leaves to be asked. */
static enum err judge_whole(const struct verify_options *options, const struct interpreter *interp,
                            const char *path, const struct replay_report *report,
                            const struct evidence_collector *collector,
                            struct verify_result *result, struct fault *fault)
{
    const struct strictness strictness = {.report = report,
                                          .goldens = collector->goldens,
                                          .semantics = SEMANTICS,
                                          .is_part = options->first || options->last};
    if (!report->is_journal)
        return fault_set(fault, ERR_CHECK, "this is a script, not a journal: nothing to compare");
    if (options->first > report->executed)
        return fault_set(fault, ERR_CHECK,
                         "it ends with record %zu: nothing to compare from %zu on",
                         report->executed, options->first);
    const enum err err = options->last ? OK : judge_orphans(options, path, interp, result, fault);
    return err || !options->strict ? err : strict_judge(&strictness, fault);
}

/* The folder for a journal's evidence, which is made when there is some. Journals of one name have
 * folders of their own below, by their numbers in the list, so that none replaces another's. */
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

/* ---- what else is known of a journal ---- */

static enum err judge_expected(const struct verify_options *options, const char *chain,
                               struct fault *fault)
{
    if (!options->expect || strncmp(chain, options->expect, RECORD_CHAIN_DIGITS) == 0)
        return OK;
    return fault_set(fault, ERR_CHECK,
                     "its last chain is %.*s, and %s was expected: it is another journal, or has "
                     "more records or fewer",
                     (int)RECORD_CHAIN_DIGITS, chain, options->expect);
}

static enum err judge_pinned(const struct lock_plan *plan, size_t number,
                             struct verify_result *result, struct fault *fault)
{
    const char *pinned = plan && !plan->updates ? lock_plan_pinned(plan, number) : "";
    if (!plan || plan->updates)
        return OK;
    if (!pinned)
        return fault_set(fault, ERR_CHECK, "added: %s does not name it; --update-lock takes it in",
                         plan->path);
    if (plan->lock.version < LOCK_WITH_PNG && strstr(buf_text(&result->facts), "\npng "))
        buf_printf(&result->lines,
                   "# %s is of the form before, and does not pin its PNGs; --update-lock does\n",
                   plan->path);
    return lock_differs(&result->lines, plan->lock.version, pinned, buf_text(&result->facts))
               ? fault_set(fault, ERR_CHECK, "changed: it is not the journal that %s names",
                           plan->path)
               : OK;
}

/* Asked of a journal whatever its replay gave, unless its bytes cannot be read. */
static enum err judge_facts(const struct verify_options *options, size_t number,
                            struct verify_result *result, struct fault *fault)
{
    const char *path = options->path[number];
    if (!options->expect && !options->plan)
        return OK;
    uint64_t torn = 0;
    enum err err = lock_facts(&result->facts, &torn, path, fault);
    const char *chain = lock_facts_chain(buf_text(&result->facts));
    if (err || !chain)
        return err;
    if (!options->last && !result->err &&
        strncmp(chain, buf_text(&result->chain), result->chain.length) != 0)
        return fault_set(fault, ERR_CHECK, "it was changed while it was verified");
    if (torn)
        return strict_refuse_torn(torn, options->expect ? "--expect" : "--lock", fault);
    err = judge_expected(options, chain, fault);
    return err ? err : judge_pinned(options->plan, number, result, fault);
}

/* Before the walls are there: ssh-keygen, not this program, reads what others wrote. `sha256` is of
 * the bytes that are signed. */
static enum err judge_signature(const struct verify_options *options, const char *path,
                                struct verify_result *result, char sha256[SHA256_HEX],
                                struct fault *fault)
{
    const struct signature_rules rules = {options->allowed_signers, options->revoked,
                                          options->signed_at};
    struct buf bytes = {0};
    if (!rules.allowed)
        return OK;
    enum err err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    sha256_bytes_hex(sha256, buf_text(&bytes), bytes.length);
    if (!err)
        err = signature_check(&result->signer, path, &bytes, &rules, options->watch, fault);
    if (!err)
        buf_printf(&result->lines,
                   "# signed by %s\n# when, no signature says: the key was judged as of %s\n",
                   buf_text(&result->signer), rules.signed_at ? rules.signed_at : "now");
    buf_release(&bytes);
    return err;
}

/* Beside what the replay found. */
static void add_failure(struct verify_result *result, enum err err, const struct fault *fault)
{
    if (err && !result->err)
        verify_result_fail(result, err, false, fault);
    else if (err == ERR_CHECK)
        buf_printf(&result->lines, "# %s\n", fault->text);
}

static bool is_missing(const struct verify_options *options, size_t number, struct fault *fault)
{
    if (!options->plan || options->plan->updates || file_exists(options->path[number]))
        return false;
    fault_set(fault, ERR_CHECK, "missing: %s names it, and there is no such file",
              options->plan->path);
    return true;
}

/* ---- in the process of a journal ---- */

static void replay_one(const struct verify_options *options, const char *path,
                       struct verify_result *result, char sha256[SHA256_HEX])
{
    struct interpreter interp;
    struct replay_report report = {0};
    struct timing timing = {.rows = 0};
    struct buf folder = {0};
    struct fault fault = {0};
    struct evidence_collector collector = {.evidence = options->html ? &result->evidence : NULL};
    const struct golden_judge judge = evidence_judge(&collector);
    const uint64_t begin = clock_ns();
    enum err err = interpreter_init(&interp, &fault);
    if (!err && options->begin)
        err = options->begin(options->context, path, &fault);
    interp.scene_path = options->scene_path;
    if (options->evidence_folder)
        place_evidence(&folder, options, path);
    collector.folder = folder.length ? buf_text(&folder) : NULL;
    interp.judge = &judge;
    if (!err)
        err = replay_file(&interp, path, options->first, options->last, NULL,
                          options->timings ? &timing : NULL, &report, &fault);
    replay_describe(&result->lines, &report, &fault);
    const bool is_told = err && result->lines.length;
    if (!err)
        err = judge_whole(options, &interp, path, &report, &collector, result, &fault);
    if (report.outcome == REPLAY_DIVERGED) {
        write_voxels(&interp, &result->lines);
        if (collector.evidence)
            show_present(&interp, collector.evidence);
    }
    verify_result_fail(result, err, is_told, &fault);
    result->executed = report.executed;
    result->compared = report.compared;
    result->digests = report.digests;
    result->goldens = collector.goldens;
    result->pixels = collector.pixels;
    if (report.executed)
        buf_add_text(&result->chain, report.chain.hex);
    result->took_ms = (clock_ns() - begin) / 1000000;
    result->line = report.line;
    timing_tell(&result->slowest, &timing);
    timing_release(&timing);
    memcpy(sha256, report.sha256, SHA256_HEX);
    replay_report_release(&report);
    interpreter_release(&interp);
    buf_release(&folder);
}

void verify_journal(const struct verify_options *options, size_t number,
                    struct verify_result *result)
{
    const char *path = options->path[number];
    char replayed[SHA256_HEX] = "", signed_bytes[SHA256_HEX] = "";
    struct fault fault = {0}, unsigned_words = {0};
    if (is_missing(options, number, &fault)) {
        verify_result_fail(result, ERR_CHECK, false, &fault);
        return;
    }
    enum err unsigned_err = judge_signature(options, path, result, signed_bytes, &unsigned_words);
    replay_one(options, path, result, replayed);
    if (!unsigned_err && *signed_bytes && *replayed && strcmp(signed_bytes, replayed) != 0)
        unsigned_err =
            fault_set(&unsigned_words, ERR_CHECK, "it was changed while it was verified");
    add_failure(result, unsigned_err, &unsigned_words);
    add_failure(result, judge_facts(options, number, result, &fault), &fault);
}
