/* SPDX-License-Identifier: MIT */
#include "command/execute.h"

#include <stdio.h>

#include "base/choice.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/mem.h"
#include "command/act.h"
#include "command/golden_files.h"
#include "command/trust.h"
#include "engine/forest.h"
#include "engine/labels.h"
#include "image/picture_writer.h"
#include "journal/journal.h"
#include "journal/replay.h"
#include "session/markers.h"
#include "session/session.h"
#include "show/draw.h"

/* ---- resume a journal ---- */

struct resume {
    struct interpreter *interp;
    size_t last;     /* number of the last record with words about the forest; 0 for none */
    bool catches_up; /* the current record is record `last`: compute the forest */
    struct replay_report report;
};

/* The words of a record about the forest. */
#define FOREST_WORDS "forest|labels|seeds|pending"

static void add_forest_words(struct buf *out, const char *words)
{
    struct record_word word;
    struct choice key;
    for (const char *at = FOREST_WORDS; choice_next(&key, &at);)
        if (record_word_find(words, key.word, key.length, &word)) {
            buf_add_blank(out);
            buf_printf(out, "%.*s=%.*s", (int)key.length, key.word, (int)word.value_length,
                       word.value);
        }
}

static void add_digests(struct buf *words, const struct session *session)
{
    const struct forest *forest = session->forest;
    buf_add_blank(words);
    buf_printf(words, "forest=%016llx labels=%016llx seeds=%zu",
               (unsigned long long)forest_digest(forest),
               (unsigned long long)forest_label_digest(forest), forest_seeds(forest));
    if (session_pendings(session))
        buf_printf(words, " pending=%zu", session_pendings(session));
}

static enum err take_semantics(void *context, unsigned semantics, struct fault *fault)
{
    const struct resume *resume = context;
    return session_set_semantics(resume->interp->session, semantics, fault);
}

static void look_for_last(void *context, const struct record *record)
{
    struct resume *resume = context;
    struct record_word word;
    struct choice key;
    for (const char *at = FOREST_WORDS; choice_next(&key, &at);)
        if (record_word_find(record->result, key.word, key.length, &word))
            resume->last = record->number;
}

/* Run a recorded command and return its words. At the last record with words about the forest,
 * compute the forest and return only these words. */
static enum err execute_again(void *context, const char *command, struct buf *words,
                              struct fault *fault)
{
    const struct resume *resume = context;
    struct session *session = resume->interp->session;
    OWNED(reply_release) struct reply reply = {0};
    TRY(interpreter_execute(resume->interp, command, &reply, fault));
    if (resume->catches_up) {
        TRY(session_catch_up(session, fault));
        buf_clear(&reply.words);
        add_digests(&reply.words, session);
    }
    buf_add_text(words, buf_text(&reply.words));
    return OK;
}

static enum err compare_record(struct resume *resume, const struct record *record,
                               struct fault *fault)
{
    const struct replay_host host = {.context = resume, .execute = execute_again};
    return replay_record(record, &host, &resume->report, fault);
}

static enum err compare_forest(struct resume *resume, const struct record *record,
                               struct fault *fault)
{
    struct record judged = *record;
    OWNED(buf_release) struct buf words = {0};
    add_forest_words(&words, record->result);
    judged.result = buf_text(&words);
    resume->catches_up = true;
    enum err err =
        words.failed ? fault_memory(fault, "a record") : compare_record(resume, &judged, fault);
    resume->catches_up = false;
    return err;
}

/* Run a record again. In MODE_SKIM, once there is a scene, compute the forest only at the last
 * record with words about it, and compare only these words; later records are executed in full,
 * without comparison. */
static enum err resume_record(void *context, const struct record *record, struct fault *fault)
{
    struct resume *resume = context;
    struct session *session = resume->interp->session;
    struct record unjudged = *record;
    const bool skims = resume->interp->mode == MODE_SKIM && session->has_scene;
    resume->interp->recorded_words = record->result;
    if (skims && record->number <= resume->last && !session->skims)
        session_skim(session);
    if (skims && record->number != resume->last)
        unjudged.has_result = false;
    const enum err err = skims && record->number == resume->last
                             ? compare_forest(resume, record, fault)
                             : compare_record(resume, &unjudged, fault);
    resume->interp->recorded_words = NULL;
    return err;
}

static enum err replay_journal(struct interpreter *interp, const char *path, struct buf *told,
                               struct fault *fault)
{
    struct resume resume = {.interp = interp};
    struct journal_resume how = {.semantics = SEMANTICS,
                                 .on_semantics = take_semantics,
                                 .on_sight = look_for_last,
                                 .on_record = resume_record,
                                 .context = &resume,
                                 .only_looks = interp->is_read_only};
    enum err err = journal_open(&interp->journal, path, &how, told, fault);
    replay_report_release(&resume.report);
    return err;
}

/* Remove the temporary files and pictures that killed processes have left next to the journal. */
static void clear_away(struct interpreter *interp, const char *path, struct buf *told)
{
    const struct buf *bytes = journal_bytes(interp->journal);
    OWNED(buf_release) struct buf words = {0}, folder = {0};
    file_folder(&folder, path);
    if (!folder.failed)
        file_sweep(buf_text(&folder));
    golden_files_clear(path, buf_text(bytes), bytes->length, &words);
    if (told)
        buf_add_text(told, buf_text(&words));
}

enum err interpreter_resume_journal(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault)
{
    const char *const *channel_path = interp->channel_path;
    enum err err = interpreter_set_home(interp, path, fault);
    interp->mode = interp->resumes_in_full ? MODE_RESUME : MODE_SKIM;
    if (!err)
        err = replay_journal(interp, path, told, fault);
    if (err == ERR_CHECK && !interp->resumes_in_full) {
        interp->mode = MODE_RESUME; /* start again */
        interp->resumes_in_full = true;
        interp->channel_path = channel_path;
        history_release(&interp->history);
        session_reset(interp->session);
        history_init(&interp->history);
        err = replay_journal(interp, path, told, fault);
    }
    if (!err)
        err = journal_set_sync(interp->journal, interp->sync, fault);
    if (!err && (interp->who || interp->times))
        err = journal_sign(interp->journal, interp->who, interp->times, fault);
    if (told && told->length)
        buf_add_char(told, '\n');
    if (!err && !interp->is_read_only)
        clear_away(interp, path, told);
    if (!err && told)
        interpreter_write_lock(interp, told);
    if (!err && told && interp->is_read_only) {
        buf_add_safe_text(told, path);
        buf_add_text(told, " is open read-only: new commands are not written to it\n");
    }
    interp->mode = MODE_LIVE;
    interp->wish = WISH_NONE;
    interp->shows_picture = false;
    return fault_prefix(fault, err, "cannot resume %s", path);
}

/* ---- run a command ---- */

static enum err apply_edits(const struct interpreter *interp, struct session *session,
                            struct reply *reply, struct fault *fault)
{
    if (interp->applied == 1)
        buf_add_text(&reply->text, "applied the pending edit, as `run` does\n");
    else
        buf_printf(&reply->text, "applied the %zu pending edits, as `run` does\n", interp->applied);
    TRY(session_run(session, fault));
    /* Count labels again: the command reports only its own changes, not those of pending edits. */
    if (interp->mode == MODE_LIVE)
        TRY(session_count_labels(session, fault));
    return OK;
}

static enum err run_act(struct interpreter *interp, const struct call *call, struct reply *reply,
                        struct fault *fault)
{
    const struct command *command = call->command;
    struct session *session = interp->session;
    uint64_t begin = clock_ns();
    if (command->flags & COMMAND_NEEDS_SCENE && !session->has_scene)
        return fault_set(fault, ERR_USAGE, "%s needs a scene; open one first, as in `open FILE`",
                         command->name);
    /* Before a command with COMMAND_ANSWERS, apply the pending edits, so that its answer includes
     * all seeds. In a replay, only recorded commands need this: for a question, the live session
     * has recorded a `run`. */
    const bool applies = command->flags & COMMAND_ANSWERS &&
                         (command->flags & COMMAND_RECORDED || interp->mode == MODE_LIVE);
    interp->applied = applies ? session_pendings(session) : 0;
    const bool edits = command->flags & COMMAND_EDITS || interp->applied,
               reports = edits && interp->mode == MODE_LIVE && !session->skims;
    enum err err = command->flags & COMMAND_NEEDS_SCENE ? session_complete(session, fault) : OK;
    if (!err && reports)
        err = session_count_before(session, fault);
    if (!err && interp->applied)
        err = apply_edits(interp, session, reply, fault);
    struct state next = session->now;
    if (!err)
        err = (command->act ? command->act
                            : act_set)(&(struct act){interp, session, call, &next, reply, fault});
    const bool waits =
        !session->now.outlook.runs_by_itself || interp->history.goes_to != POINT_NONE;
    if (!err && edits && !waits)
        err = session_run(session, fault);
    /* A question has no record of its own; that of its `run` has only the digests added below. */
    if (!(command->flags & COMMAND_RECORDED))
        buf_clear(&reply->words);
    if (!err && edits)
        add_digests(&reply->words, session);
    const bool edited = reports && (session->has_edited || session->has_regrown);
    if (!err && edited)
        err = session_count_labels(session, fault);
    if (!err && edited)
        volumes_write(&reply->text, session, interp->has_pilot && session_shows_finished(session),
                      clock_ns() - begin);
    if (!err && edited && (command->flags & COMMAND_PLANTS || interp->applied))
        surprise_write(&reply->text, session, interp->applied ? NULL : command->name);
    const bool failed = reply->text.failed || reply->words.failed || reply->canonical.failed ||
                        reply->list.failed || reply->files.failed || arena_failed(&interp->arena);
    return failed ? fault_memory(fault, "a command") : err;
}

static enum err execute_call(struct interpreter *interp, const struct call *call, const char *line,
                             struct reply *reply, struct fault *fault)
{
    struct watch *watch = interp->session->watch;
    enum err err = watch_fault(watch, fault);
    interp->found_existing = false;
    interp->applied = 0;
    if (!err)
        err = run_act(interp, call, reply, fault);
    if (err == ERR_IO && interp->found_existing)
        fault_append(fault, "; replace=yes overwrites it");
    if (err && fault)
        command_point_at(call, line, fault);
    if (!err || (watch && watch->stopped)) /* a stop may have caused another error */
        err = watch_fault(watch, fault);
    if (interpreter_is_wary(interp))
        err = limits_judge(err, &interp->written, fault);
    if (err == ERR_CANCELLED) /* whichever function reported the stop */
        fault_set(fault, err, "cancelled; nothing has changed");
    return err;
}

/* ---- record a command ---- */

/* Add the command to the history and, in a live session, to the journal. For a question that
 * applied pending edits, add a `run`. */
static enum err record_command(struct interpreter *interp, const struct command *command,
                               struct reply *reply, struct fault *fault)
{
    char run[80];
    snprintf(run, sizeof run, RUN_FOR "%s", command->name);
    const bool is_question = !(command->flags & COMMAND_RECORDED);
    const char *line = is_question ? run : buf_text(&reply->canonical);
    const struct session *session = interp->session;
    TRY(history_note(&interp->history, session, line, fault));
    if (interp->mode == MODE_LIVE && interp->new_journal) {
        TRY(fault_prefix(fault, interpreter_create_journal(interp, interp->new_journal, fault),
                         "cannot create a journal here (--journal FILE creates it elsewhere)"));
        interp->new_journal = NULL;
        interpreter_write_lock(interp, &reply->text);
    }
    if (interp->mode != MODE_LIVE || !interp->journal)
        return OK;
    const bool only_looks = /* the command changed only the view (J1) */
        !reply->words.length && !interp->written.length && !history_moves(&interp->history) &&
        kept_equals(&session->now.kept, &session->former.kept);
    const enum err err =
        journal_append(interp->journal, line, only_looks ? NULL : buf_text(&reply->words), fault);
    return fault_prefix(fault, err,
                        "the command was undone because it could not be recorded (`journal FILE` "
                        "continues in another file)");
}

/* ---- commit or roll back a command ---- */

/* Commit or roll back all changes that the command has made. */
static void finish_command(struct interpreter *interp, bool succeeded)
{
    interpreter_settle_files(interp, succeeded);
    arena_release(&interp->arena);
    if (succeeded && interp->job)
        picture_writer_give(interp->writer, interp->job);
    else
        picture_job_free(interp->job);
    interp->job = NULL;
    history_settle(&interp->history, succeeded);
    if (succeeded) {
        session_settle(interp->session);
        return;
    }
    session_rollback(interp->session);
    interp->shows_picture = false;
    canvas_release(&interp->shown);
    interp->wish = WISH_NONE;
}

enum err interpreter_execute(struct interpreter *interp, const char *line, struct reply *reply,
                             struct fault *fault)
{
    OWNED(call_release) struct call call = {0};
    reply_clear(reply);
    interp->shows_picture = false;
    canvas_release(&interp->shown);
    TRY(command_parse(&call, line, interp->session, fault));
    if (!call.command)
        return interpreter_comment(interp, line, reply, fault);
    bool recorded = call.command->flags & COMMAND_RECORDED;
    enum err err = interpreter_settle_name(interp, &call, fault);
    command_write(&reply->canonical, &call);
    if (!err)
        err = interpreter_drop_sketch(interp, fault);
    if (!err) {
        session_mark(interp->session);
        err = execute_call(interp, &call, line, reply, fault);
        recorded |= interp->applied > 0;
        if (!err && recorded)
            err = record_command(interp, call.command, reply, fault);
        finish_command(interp, err == OK);
    }
    if (!err)
        interp->acknowledged = recorded ? interp->history.records : 0;
    interp->unrecorded += !err && recorded && !interp->journal;
    mem_trim();
    return err;
}

/* ---- look: only the view may change ---- */

enum err interpreter_look(struct interpreter *interp, const char *line, struct reply *reply,
                          struct fault *fault)
{
    OWNED(call_release) struct call call = {0};
    reply_clear(reply);
    enum err err = command_parse(&call, line, interp->session, fault);
    if (err || !call.command)
        return err;
    const enum command_group group = call.command->group;
    bool changes = group == GROUP_SCENE || group == GROUP_WEIGHT || group == GROUP_SEEDS ||
                   group == GROUP_KEPT;
    if (!changes) {
        const struct session *session = interp->session;
        session_mark(interp->session);
        err = execute_call(interp, &call, line, reply, fault);
        changes = interp->written.length || interp->history.goes_to != POINT_NONE ||
                  session->has_edited || session->has_regrown ||
                  !kept_equals(&session->now.kept, &session->former.kept) ||
                  !edit_lists_are_copies(&session->now.lists, &session->former.lists);
        finish_command(interp, !err && !changes);
    }
    if (!err && changes)
        err = fault_set(fault, ERR_USAGE,
                        "%s: only questions and commands that change the view are allowed here; "
                        "nothing has changed",
                        call.command->name);
    return err;
}

/* ---- sketch: run without a record ---- */

enum err interpreter_sketch(struct interpreter *interp, const char *line, struct fault *fault)
{
    struct session *session = interp->session;
    OWNED(reply_release) struct reply reply = {0};
    OWNED(call_release) struct call call = {0};
    TRY(command_parse(&call, line, session, fault));
    if (!call.command)
        return OK;
    if (!session->has_scene || !(call.command->flags & COMMAND_SKETCHED))
        return fault_set(fault, ERR_USAGE, "%s cannot be sketched", call.command->name);
    if (!interp->sketch.is_begun)
        interp->sketch = (struct sketch){.is_begun = true,
                                         .place = history_place(&interp->history),
                                         .outlook = session->now.outlook,
                                         .markers = session->markers.count};
    command_write(&reply.canonical, &call);
    session_mark(session);
    enum err err = execute_call(interp, &call, line, &reply, fault);
    if (!err)
        err = history_note(&interp->history, session, buf_text(&reply.canonical), fault);
    finish_command(interp, err == OK);
    return err;
}

enum err interpreter_drop_sketch(struct interpreter *interp, struct fault *fault)
{
    struct session *session = interp->session;
    struct history *history = &interp->history;
    const struct sketch *was = &interp->sketch;
    if (!was->is_begun)
        return OK;
    session_mark(session);
    watch_ignore_stop(session->watch);
    /* Restore the seeds through the history, in one edit. */
    enum err err = history_go(history, session, was->place.present, history->on, false, fault);
    struct state before = session->now;
    before.outlook = was->outlook;
    if (!err)
        err = session_go(session, &before, NULL, 0, fault);
    history_settle(history, false);
    if (err) {
        session_rollback(session);
        return err;
    }
    history_forget(history, &was->place);
    session_truncate_markers(session, interp->sketch.markers);
    session_settle(session);
    watch_begin(session->watch);
    interp->sketch.is_begun = false;
    return OK;
}

enum err interpreter_write_losses(struct interpreter *interp, struct watch *watch, struct buf *out,
                                  struct fault *fault)
{
    struct session *session = interp->session;
    const struct labels labels = {session->scene, session_finished(session)};
    if (!labels.finished || !session_shows_finished(session) ||
        interp->losses_of == session_finish_source(session))
        return OK;
    return act_write_losses(interp, &labels, true, watch, out, fault);
}
