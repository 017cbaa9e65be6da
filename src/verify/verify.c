#include "verify/verify.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "verify/github.h"
#include "verify/orphan.h"
#include "verify/verify_journal.h"
#include "verify/verify_report.h"

enum {
    PICTURES_MOST = 64 << 20,               /* bytes of pictures that a report holds */
    RESULT_MOST = PICTURES_MOST + (8 << 20) /* bytes that a process may hand back */
};

/* ---- all of them ---- */

struct verification {
    const struct verify_options *options;
    const struct printer *printer;
    struct verify_result *result; /* [options->count] */
    size_t printed;               /* journals */
    bool is_given_up;             /* one has failed, and that is the end */
    struct watch watch;
    size_t picture_bytes;
};

static void work(void *context, size_t number, struct buf *out)
{
    const struct verification *v = context;
    struct verify_result result = {.path = NULL};
    verify_journal(v->options, number, &result);
    verify_result_write(out, &result);
}

/* Pictures beyond what a report holds are left out. */
static void limit_pictures(struct verification *v, struct verify_result *result)
{
    size_t bytes = 0;
    for (size_t i = 0; i < result->evidence.pictures; i++)
        bytes += result->evidence.picture[i].png.length;
    if (bytes > PICTURES_MOST - v->picture_bytes) {
        evidence_release(&result->evidence);
        buf_add_text(&result->lines, "# its pictures are left out: the report holds 64 MiB\n");
    } else {
        v->picture_bytes += bytes;
    }
}

/* "#   took     12.345 ms, record 31: run" */
static void add_slowest(struct buf *text, const struct buf *slowest)
{
    for (const char *at = buf_text(slowest); *at; at += *at == '\n') {
        const size_t n = strcspn(at, "\n");
        buf_printf(text, "#   %-9s%.*s\n", "took", (int)n, at);
        at += n;
    }
}

static void print_result(const struct verification *v, size_t number)
{
    const struct verify_result *r = v->result + number;
    struct buf text = {0};
    buf_printf(&text, "%s %zu - ", r->err ? "not ok" : "ok", number + 1);
    buf_add_safe_text(&text, r->path);
    if (r->is_skipped) {
        buf_add_text(&text, " # SKIP not verified: another failed before");
    } else if (!r->err) {
        buf_add_text(&text, " (");
        verify_result_tell(&text, r);
        buf_add_char(&text, ')');
    }
    buf_add_char(&text, '\n');
    buf_add_text(&text, buf_text(&r->lines));
    add_slowest(&text, &r->slowest);
    v->printer->print(v->printer->context, buf_text(&text));
    buf_release(&text);
}

/* Golden images that the journal does not name. What the process says of their names is checked. */
static void remove_orphans(struct verify_result *result)
{
    struct fault fault;
    const char *at = buf_text(&result->orphans), *end = at + result->orphans.length;
    for (; at < end && !result->err; at += strlen(at) + 1) {
        const enum err err = orphan_remove(result->path, at, &fault);
        if (err) {
            verify_result_fail(result, err, false, &fault);
        } else {
            buf_printf(&result->lines, "#   %-9s", "removed");
            buf_add_safe_text(&result->lines, at);
            buf_add_char(&result->lines, '\n');
        }
    }
}

static void print_known(struct verification *v)
{
    for (; v->printed < v->options->count && v->result[v->printed].is_known; v->printed++)
        if (!v->options->json)
            print_result(v, v->printed);
}

/* A process that gave no result is a failure of its journal. */
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
    limit_pictures(v, result);
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

static void skip_the_rest(struct verification *v)
{
    for (size_t i = 0; i < v->options->count; i++)
        if (!v->result[i].is_known)
            v->result[i].is_known = v->result[i].is_skipped = true;
    print_known(v);
}

static enum err run_all(struct verification *v, struct fault *fault)
{
    const struct verify_options *o = v->options;
    const struct processes how = {.count = o->count,
                                  .at_once = o->processes,
                                  .most = RESULT_MOST,
                                  .context = v,
                                  .work = work,
                                  .done = take_result,
                                  .watch = &v->watch};
    v->watch = (struct watch){.context = v, .poll = stops};
    const enum err err = processes_run(&how, fault);
    if (v->is_given_up && (!err || err == ERR_CANCELLED)) {
        skip_the_rest(v);
        return OK;
    }
    return err == ERR_CANCELLED ? fault_set(fault, err, "cancelled; %zu of %zu journal%s verified",
                                            v->printed, o->count, plural(o->count))
                                : err;
}

static void add_sum(struct buf *text, const struct verify_sum *sum)
{
    buf_printf(text, "1..%zu\n# %zu verified, %zu failed", sum->count, sum->verified, sum->failed);
    if (sum->skipped)
        buf_printf(text, ", %zu skipped", sum->skipped);
    buf_add_char(text, '\n');
}

static enum err sum_up(const struct verification *v, struct fault *fault)
{
    const struct verify_sum sum = verify_sum(v->result, v->options->count);
    struct buf text = {0};
    if (v->options->json)
        verify_report_text(&text, VERIFY_JSON, v->result, sum.count);
    else
        add_sum(&text, &sum);
    v->printer->print(v->printer->context, buf_text(&text));
    const enum err err = text.failed ? fault_memory(fault, "a report") : OK;
    buf_release(&text);
    if (err)
        return err;
    return sum.worst ? fault_set(fault, sum.worst, "%zu of %zu journal%s failed", sum.failed,
                                 sum.count, plural(sum.count))
                     : OK;
}

/* Reports are written at the end; what is in the way is said before. */
static enum err check_report(const char *path, struct fault *fault)
{
    if (!path)
        return OK;
    if (interpreter_is_journal(path))
        return fault_set(fault, ERR_USAGE,
                         "%s is a journal and was left alone; nothing was verified", path);
    return file_may_write(path, FILE_REPLACE, fault);
}

/* Once all of them are verified; else it stays as it is. */
static enum err update_lock(const struct verification *v, enum err failed, struct fault *fault)
{
    const struct verify_options *o = v->options;
    struct buf lines = {0};
    if (!o->plan || !o->plan->updates)
        return failed;
    if (failed)
        return fault_prefix(fault, failed, "%s is left alone", o->plan->path);
    const char **facts = calloc(o->count, sizeof *facts);
    enum err err = facts ? OK : fault_memory(fault, "a lock");
    for (size_t i = 0; !err && i < o->count; i++)
        facts[i] = buf_text(&v->result[i].facts);
    if (!err)
        err = lock_plan_write(o->plan, facts, &lines, fault);
    if (!err && !o->json)
        v->printer->print(v->printer->context, buf_text(&lines));
    free(facts);
    buf_release(&lines);
    return err;
}

/* A report that cannot be written is worse than a journal that failed. */
static enum err report(const struct verification *v, struct fault *fault)
{
    const struct verify_options *o = v->options;
    const enum err err = update_lock(v, sum_up(v, fault), fault);
    enum err unwritten = OK;
    github_tell(v->result, o->count, v->printer);
    if (o->junit)
        unwritten = verify_report(o->junit, VERIFY_JUNIT, v->result, o->count, fault);
    if (!unwritten && o->html)
        unwritten = verify_report(o->html, VERIFY_HTML, v->result, o->count, fault);
    return unwritten ? unwritten : err;
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
