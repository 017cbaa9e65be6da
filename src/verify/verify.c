#include "verify/verify.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "command/act.h"
#include "verify/orphan.h"
#include "verify/replay_file.h"
#include "verify/verify_report.h"
#include "session/export.h"

enum {
    LOOK_MS = 100,                           /* between looks whether to stop */
    PICTURES_MOST = 64 << 20,                /* bytes of pictures that a report holds */
    VERDICT_MOST = PICTURES_MOST + (8 << 20) /* bytes that a process may send */
};

/* ---- one journal ---- */

/* What is seen now, for whoever asks what a command has come to. */
static void show_present(struct interpreter *interp, struct evidence *evidence)
{
    struct picture picture = {0};
    if (!interp->session.has_scene || evidence->pictures ||
        session_draw(&interp->session, RENDER_AS_KEPT, NULL) ||
        export_picture(&picture, &interp->session, NULL))
        return;
    evidence_add(evidence, "actual: the rendition after this command", picture.width,
                 picture.height, picture.rgba);
    picture_release(&picture);
}

/* The voxels of each label now, as comment lines. */
static void tell_voxels(struct interpreter *interp, struct buf *lines)
{
    struct reply reply = {0};
    if (interp->session.has_scene &&
        !act_stats(&(struct act){interp, &interp->session, NULL, &reply, NULL}))
        for (const char *at = buf_text(&reply.text); *at;) {
            const size_t n = strcspn(at, "\n");
            buf_printf(lines, "#   %-9s", "now");
            buf_add(lines, at, n);
            buf_add_char(lines, '\n');
            at += n + (at[n] == '\n');
        }
    reply_release(&reply);
}

/* What a replay that went well leaves to be asked. */
static enum err judge_whole(const struct verify_options *options, const struct interpreter *interp,
                            const char *path, const struct replay_report *report,
                            struct fault *fault)
{
    if (!report->is_journal)
        return fault_set(fault, ERR_CHECK, "this is a script, not a journal: nothing to compare");
    if (options->first > report->executed)
        return fault_set(fault, ERR_CHECK,
                         "it ends with record %zu: nothing to compare from %zu on",
                         report->executed, options->first);
    return options->last ? OK : orphan_check(path, &interp->goldens, fault);
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

void verify_one(const struct verify_options *options, const char *path, struct verdict *verdict)
{
    struct interpreter interp;
    struct replay_report report = {0};
    struct buf folder = {0};
    struct fault fault = {0};
    struct evidence_collector collector = {.evidence = options->html ? &verdict->evidence : NULL};
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
        err = replay_file(&interp, path, options->first, options->last, NULL, &report, &fault);
    if (!err)
        err = judge_whole(options, &interp, path, &report, &fault);
    replay_describe(&verdict->lines, &report, &fault);
    if (report.outcome == REPLAY_DIVERGED) {
        tell_voxels(&interp, &verdict->lines);
        if (collector.evidence)
            show_present(&interp, collector.evidence);
    }
    if (err && !verdict->lines.length)
        buf_printf(&verdict->lines, "# %s\n", fault.text);
    if (err)
        buf_add_text(&verdict->why, fault.text);
    verdict->err = err;
    verdict->executed = report.executed;
    verdict->compared = report.compared;
    verdict->took_ms = (clock_ns() - begin) / 1000000;
    replay_report_release(&report);
    interpreter_release(&interp);
    buf_release(&folder);
}

/* ---- processes ---- */

struct worker_process {
    pid_t process; /* 0: free */
    int descriptor;
    size_t journal;
    struct buf bytes;
};

struct pool {
    const struct verify_options *options;
    const struct teller *teller;
    struct worker_process worker[VERIFY_PROCESSES_MOST];
    struct verdict *verdict; /* [options->count] */
    bool *is_known;          /* likewise */
    size_t begun, told;      /* journals */
    size_t picture_bytes;
};

static void send(int descriptor, const struct buf *bytes)
{
    for (size_t sent = 0; sent < bytes->length;) {
        const ssize_t n = write(descriptor, bytes->data + sent, bytes->length - sent);
        if (n < 0 && errno != EINTR)
            return; /* the reader sees that something is missing */
        sent += n > 0 ? (size_t)n : 0;
    }
}

/* The process that verifies one journal. It ends with whoever started it, and by Ctrl-C as any
 * program. */
static _Noreturn void work(const struct verify_options *options, const char *path, int descriptor,
                           pid_t parent)
{
    struct verdict verdict = {0};
    struct buf bytes = {0};
    if (signal(SIGINT, SIG_DFL) == SIG_IGN)
        signal(SIGINT, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(1);
    verify_one(options, path, &verdict);
    verdict_write(&bytes, &verdict);
    if (!bytes.failed)
        send(descriptor, &bytes);
    _exit(0);
}

static enum err begin_worker(struct pool *pool, struct worker_process *worker, struct fault *fault)
{
    int end[2];
    const pid_t parent = getpid();
    if (pipe2(end, O_CLOEXEC) != 0)
        return fault_errno(fault, "make", "a pipe");
    const pid_t process = fork();
    if (process == 0)
        work(pool->options, pool->options->path[pool->begun], end[1], parent);
    close(end[1]);
    if (process < 0) {
        close(end[0]);
        return fault_errno(fault, "start", "a process");
    }
    *worker = (struct worker_process){process, end[0], pool->begun++, worker->bytes};
    buf_clear(&worker->bytes);
    return OK;
}

static int wait_for(pid_t process)
{
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR)
        ;
    return status;
}

/* A process that gave no verdict is a failure of its journal. */
static void blame(struct verdict *verdict, int status, const struct fault *fault)
{
    struct buf why = {0};
    if (WIFSIGNALED(status))
        buf_printf(&why, "the process that replayed it was ended by signal %d (%s)",
                   WTERMSIG(status), strsignal(WTERMSIG(status)));
    else
        buf_printf(&why, "the process that replayed it gave no verdict: %s", fault->text);
    verdict_release(verdict);
    *verdict = (struct verdict){.err = ERR_CHECK, .why = why};
    buf_printf(&verdict->lines, "# %s\n", buf_text(&why));
}

/* Pictures beyond what a report holds are let go. */
static void limit_pictures(struct pool *pool, struct verdict *verdict)
{
    size_t bytes = 0;
    for (size_t i = 0; i < verdict->evidence.pictures; i++)
        bytes += verdict->evidence.picture[i].png.length;
    if (bytes > PICTURES_MOST - pool->picture_bytes) {
        evidence_release(&verdict->evidence);
        buf_add_text(&verdict->lines, "# its pictures are left out: the report holds 64 MiB\n");
    } else {
        pool->picture_bytes += bytes;
    }
}

static void end_worker(struct pool *pool, struct worker_process *worker)
{
    struct verdict *verdict = pool->verdict + worker->journal;
    struct fault fault = {0};
    close(worker->descriptor);
    const int status = wait_for(worker->process);
    const enum err err =
        verdict_read(verdict, buf_text(&worker->bytes), worker->bytes.length, &fault);
    if (err || WIFSIGNALED(status))
        blame(verdict, status, &fault);
    limit_pictures(pool, verdict);
    pool->is_known[worker->journal] = true;
    buf_release(&worker->bytes);
    *worker = (struct worker_process){0};
}

/* Reads what has come; at the end of it, or beyond all measure, the process is done with. */
static void read_worker(struct pool *pool, struct worker_process *worker)
{
    char piece[65536];
    const ssize_t n = read(worker->descriptor, piece, sizeof piece);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return;
    if (n > 0)
        buf_add(&worker->bytes, piece, (size_t)n);
    const bool is_too_much = worker->bytes.failed || worker->bytes.length > VERDICT_MOST;
    if (is_too_much)
        kill(worker->process, SIGKILL);
    if (n <= 0 || is_too_much)
        end_worker(pool, worker);
}

static void tell_verdict(struct pool *pool, size_t journal)
{
    const struct verdict *v = pool->verdict + journal;
    const char *path = pool->options->path[journal];
    struct buf text = {0};
    buf_printf(&text, "%s %zu - ", v->err ? "not ok" : "ok", journal + 1);
    buf_add_safe(&text, path, strlen(path));
    if (v->err)
        buf_add_char(&text, '\n');
    else
        buf_printf(&text, " (%llu commands, %llu results)\n", (unsigned long long)v->executed,
                   (unsigned long long)v->compared);
    buf_add_text(&text, buf_text(&v->lines));
    pool->teller->say(pool->teller->context, buf_text(&text));
    buf_release(&text);
}

/* Starts processes as long as there are journals and fewer than may be. */
static enum err fill(struct pool *pool, struct fault *fault)
{
    enum err err = OK;
    for (unsigned i = 0; !err && i < pool->options->processes; i++)
        if (!pool->worker[i].process && pool->begun < pool->options->count)
            err = begin_worker(pool, pool->worker + i, fault);
    return err;
}

/* Waits for any of them, a little while. */
static void listen_to_all(struct pool *pool)
{
    struct pollfd waits[VERIFY_PROCESSES_MOST];
    struct worker_process *whose[VERIFY_PROCESSES_MOST];
    nfds_t count = 0;
    for (unsigned i = 0; i < pool->options->processes; i++)
        if (pool->worker[i].process) {
            whose[count] = pool->worker + i;
            waits[count++] = (struct pollfd){pool->worker[i].descriptor, POLLIN, 0};
        }
    if (poll(waits, count, LOOK_MS) <= 0)
        return;
    for (nfds_t i = 0; i < count; i++)
        if (waits[i].revents)
            read_worker(pool, whose[i]);
}

static void end_all(struct pool *pool)
{
    for (unsigned i = 0; i < VERIFY_PROCESSES_MOST; i++) {
        struct worker_process *worker = pool->worker + i;
        if (!worker->process)
            continue;
        kill(worker->process, SIGKILL);
        close(worker->descriptor);
        wait_for(worker->process);
        buf_release(&worker->bytes);
    }
}

static enum err run_pool(struct pool *pool, struct fault *fault)
{
    enum err err = OK;
    while (!err && pool->told < pool->options->count) {
        err = fill(pool, fault);
        if (!err)
            listen_to_all(pool);
        while (!err && pool->told < pool->options->count && pool->is_known[pool->told])
            tell_verdict(pool, pool->told++);
        if (!err && watch_fault(pool->options->watch, NULL))
            err = fault_set(fault, ERR_CANCELLED, "cancelled; %zu of %zu journals were verified",
                            pool->told, pool->options->count);
    }
    end_all(pool);
    return err;
}

/* ---- all of them ---- */

/* The worst of the verdicts: anything is worse than a check that failed. */
static enum err sum_up(const struct pool *pool, struct fault *fault)
{
    struct buf text = {0};
    const size_t count = pool->options->count;
    size_t passed = 0;
    enum err worst = OK;
    for (size_t i = 0; i < count; i++) {
        const enum err err = pool->verdict[i].err;
        passed += err == OK;
        if (err && (!worst || worst == ERR_CHECK))
            worst = err;
    }
    buf_printf(&text, "1..%zu\n# %zu verified, %zu failed\n", count, passed, count - passed);
    pool->teller->say(pool->teller->context, buf_text(&text));
    buf_release(&text);
    return worst ? fault_set(fault, worst, "%zu of %zu journals failed", count - passed, count)
                 : OK;
}

/* Reports are written when all is over; what is in the way is to be known before. */
static enum err check_report(const char *path, struct fault *fault)
{
    struct buf draft = {0};
    if (!path)
        return OK;
    if (interpreter_is_journal(path))
        return fault_set(fault, ERR_USAGE,
                         "%s is a journal and was left alone; nothing was verified", path);
    const enum err err = file_draft(&draft, path, FILE_REPLACE, fault);
    buf_release(&draft);
    return err;
}

static enum err write_reports(const struct pool *pool, struct fault *fault)
{
    const struct verify_options *o = pool->options;
    enum err err = OK;
    if (o->junit)
        err = verify_report(o->junit, VERIFY_JUNIT, o->path, pool->verdict, o->count, fault);
    if (!err && o->html)
        err = verify_report(o->html, VERIFY_HTML, o->path, pool->verdict, o->count, fault);
    return err;
}

enum err verify_files(const struct verify_options *options, const struct teller *teller,
                      struct fault *fault)
{
    struct pool pool = {.options = options,
                        .teller = teller,
                        .verdict = calloc(options->count, sizeof *pool.verdict),
                        .is_known = calloc(options->count, sizeof *pool.is_known)};
    struct fault words = {0};
    enum err err = check_report(options->junit, fault);
    if (!err)
        err = check_report(options->html, fault);
    if (!err && (!pool.verdict || !pool.is_known))
        err = fault_memory(fault, "the verdicts");
    if (!err)
        err = run_pool(&pool, fault);
    if (!err) {
        err = sum_up(&pool, fault);
        const enum err unwritten = write_reports(&pool, &words);
        if (unwritten)
            err = fault_set(fault, unwritten, "%s", words.text);
    }
    for (size_t i = 0; pool.verdict && i < options->count; i++)
        verdict_release(pool.verdict + i);
    free(pool.verdict);
    free(pool.is_known);
    return err;
}
