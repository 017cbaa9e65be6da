#include "command/interpreter.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "sandbox/limits.h"
#include "sandbox/trust.h"
#include "command/volumes.h"
#include "journal/replay.h"
#include "session/export.h"

static const char default_scenes[] = "/usr/share/mricron/templates";

enum err interpreter_init(struct interpreter *interp, struct fault *fault)
{
    struct buf program = {0};
    *interp = (struct interpreter){0};
    session_init(&interp->session);
    history_init(&interp->history);
    enum err err = image_helper_default_program(&program, fault);
    if (!err)
        err = image_helper_new(&interp->helper, buf_text(&program), fault);
    buf_release(&program);
    return err;
}

enum err interpreter_write_beside(struct interpreter *interp, struct fault *fault)
{
    struct buf program = {0};
    enum err err = image_helper_default_program(&program, fault);
    if (!err)
        err = picture_writer_new(&interp->writer, buf_text(&program), fault);
    buf_release(&program);
    return err;
}

void interpreter_release(struct interpreter *interp)
{
    picture_job_free(interp->job);
    picture_writer_free(interp->writer);
    journal_close(interp->journal);
    image_helper_free(interp->helper);
    history_release(&interp->history);
    session_release(&interp->session);
    buf_release(&interp->home);
    buf_release(&interp->written);
    buf_release(&interp->goldens);
    buf_release(&interp->made);
    canvas_release(&interp->shown);
    *interp = (struct interpreter){0};
}

void reply_release(struct reply *reply)
{
    buf_release(&reply->text);
    buf_release(&reply->words);
    buf_release(&reply->canonical);
}

void interpreter_show(struct interpreter *interp, const struct canvas *picture)
{
    canvas_release(&interp->shown);
    interp->shown = *picture;
    interp->shows_picture = true;
}

/* ---- the door ---- */

/* The digests of the forest, after a command that edits it. */
static void add_digests(struct reply *reply, const struct session *session)
{
    buf_printf(&reply->words, "%sforest=%016llx labels=%016llx seeds=%zu",
               reply->words.length ? " " : "", (unsigned long long)forest_digest(session->forest),
               (unsigned long long)semantics_label_digest(session->semantics, session->forest),
               forest_seeds(session->forest));
    if (session_pendings(session))
        buf_printf(&reply->words, " pending=%zu", session_pendings(session));
}

static enum err act(struct interpreter *interp, const struct call *call, struct reply *reply,
                    struct fault *fault)
{
    const struct command *command = call->command;
    struct session *session = &interp->session;
    uint64_t begin = clock_ns();
    if (command->flags & COMMAND_NEEDS_SCENE && !session->has_scene)
        return fault_set(fault, ERR_USAGE, "%s needs a scene; open one first", command->name);
    const bool tells = command->flags & COMMAND_EDITS && !interp->replays && !session->skims;
    enum err err = tells ? session_count_labels(session, fault) : OK;
    if (!err)
        err = command->act(&(struct act){interp, session, call->value, reply, fault});
    const bool waits =
        !session->now.outlook.runs_by_itself || interp->history.goes_to != POINT_NONE;
    if (!err && command->flags & COMMAND_EDITS && !waits)
        err = session_run(session, fault);
    if (!err && command->flags & COMMAND_EDITS)
        add_digests(reply, session);
    const bool edited = tells && (session->edited || session->regrown);
    if (!err && edited)
        err = session_count_labels(session, fault);
    if (!err && edited)
        volumes_write(&reply->text, session, clock_ns() - begin);
    if (!err && (reply->text.failed || reply->words.failed || reply->canonical.failed))
        err = fault_memory(fault, "an answer");
    return err;
}

/* ---- files that go with a command ---- */

static bool has_made(const struct interpreter *interp, const char *path)
{
    const char *at = buf_text(&interp->made), *end = at + interp->made.length;
    while (at < end && strcmp(at, path) != 0)
        at += strlen(at) + 1;
    return at < end;
}

enum err interpreter_will_write(struct interpreter *interp, const char *path, enum file_mode mode,
                                struct fault *fault)
{
    struct buf backup = {0};
    enum err err = OK;
    if (interpreter_is_wary(interp))
        limits_will_write();
    if (interp->writer && picture_writer_holds(interp->writer, path))
        picture_writer_wait(interp->writer, NULL, NULL); /* one after the other */
    if (file_exists(path)) {
        if (mode == FILE_KEEP)
            return OK; /* the writer refuses */
        if (interpreter_is_wary(interp) && !has_made(interp, path))
            return fault_set(
                fault, ERR_IO,
                "%s was there before; a replay replaces only what it has written itself; "
                "it was left alone",
                path);
        err = file_backup(&backup, path, fault);
    }
    const size_t made = interpreter_is_wary(interp) ? strlen(path) + 1 : 0;
    if (!err && (!buf_reserve(&interp->written, strlen(path) + backup.length + 2) ||
                 (made && !buf_reserve(&interp->made, made)))) {
        if (backup.length)
            file_discard(buf_text(&backup));
        interp->made.failed =
            false; /* what it holds is whole; interpreter_settle_files clears the other */
        err = fault_memory(fault, "a file name");
    }
    if (!err) { /* there is room for all */
        buf_add(&interp->made, path, made);
        buf_add(&interp->written, path, strlen(path) + 1);
        buf_add(&interp->written, buf_text(&backup), backup.length + 1);
    }
    buf_release(&backup);
    return err;
}

/* Backups go when the command stands; else files are again what they were. */
void interpreter_settle_files(struct interpreter *interp, bool stands)
{
    const char *at = buf_text(&interp->written), *end = at + interp->written.length;
    while (at < end) {
        const char *path = at, *backup = path + strlen(path) + 1;
        at = backup + strlen(backup) + 1;
        if (stands && *backup)
            file_discard(backup);
        else if (!stands && *backup)
            file_restore(backup, path, NULL);
        else if (!stands)
            file_discard(path);
    }
    buf_clear(&interp->written);
}

enum err interpreter_execute(struct interpreter *interp, const char *line, struct reply *reply,
                             struct fault *fault)
{
    struct call call;
    buf_clear(&reply->text);
    buf_clear(&reply->words);
    buf_clear(&reply->canonical);
    interp->shows_picture = false;
    canvas_release(&interp->shown);
    enum err err = command_parse(&call, line, &interp->session, fault);
    if (err || !call.command)
        return err;
    command_write(&reply->canonical, &call);
    session_mark(&interp->session);
    err = watch_fault(interp->session.watch, fault);
    if (!err)
        err = act(interp, &call, reply, fault);
    if (err && fault)
        command_point_at(&call, line, fault);
    if (!err) /* what was cut short, wherever that was, is not recorded */
        err = watch_fault(interp->session.watch, fault);
    if (interpreter_is_wary(interp))
        err = limits_judge(err, &interp->written, fault);
    if (err == ERR_CANCELLED) /* whoever pressed Ctrl-C need not know where it was noticed */
        fault_set(fault, err, "cancelled; nothing has changed");
    const bool recorded = call.command->flags & COMMAND_RECORDED;
    if (!err && recorded)
        err = history_note(&interp->history, &interp->session, buf_text(&reply->canonical), fault);
    if (!err && recorded && interp->new_journal && !interp->replays) {
        err = interpreter_create_journal(interp, interp->new_journal, fault);
        interp->new_journal = err ? interp->new_journal : NULL;
        if (err)
            fault_prefix(fault, err,
                         "no journal can be begun here (--journal FILE begins it elsewhere)");
    }
    if (!err && recorded && interp->journal && !interp->replays) {
        err = journal_append(interp->journal, buf_text(&reply->canonical), buf_text(&reply->words),
                             fault);
        if (err)
            fault_prefix(fault, err,
                         "the command is undone, because it could not be recorded "
                         "(`journal FILE` goes on in another file)");
    }
    interpreter_settle_files(interp, err == OK);
    if (!err && interp->job)
        picture_writer_give(interp->writer, interp->job);
    else
        picture_job_free(interp->job);
    interp->job = NULL;
    history_settle(&interp->history, err == OK);
    if (err) {
        session_rollback(&interp->session);
        interp->shows_picture = interp->finished = false;
    } else {
        session_settle(&interp->session);
        interp->acknowledged++;
        interp->unrecorded += recorded && !interp->journal;
    }
    call_release(&call);
    return err;
}

/* ---- journals ---- */

bool interpreter_is_journal(const char *path)
{
    return file_begins_with(path, RECORD_HEADER);
}

enum err interpreter_set_home(struct interpreter *interp, const char *path, struct fault *fault)
{
    buf_clear(&interp->home);
    buf_add_text(&interp->home, path);
    return interp->home.failed ? fault_memory(fault, "a path") : OK;
}

enum err interpreter_create_journal(struct interpreter *interp, const char *path,
                                    struct fault *fault)
{
    enum err err = interpreter_set_home(interp, path, fault);
    if (!err)
        err = journal_create(&interp->journal, path, interp->session.semantics, fault);
    if (err)
        return err;
    err = journal_set_sync(interp->journal, interp->sync, fault);
    if (err) { /* no thread can be had: as if it had not been begun */
        journal_close(interp->journal);
        interp->journal = NULL;
        file_discard(path);
    }
    return err;
}

struct resume {
    struct interpreter *interp;
    size_t last; /* number of the last record that tells of the forest; 0 for none */
    struct replay_report report;
};

/* What records tell of the forest. */
static const char *const forest_words[] = {"forest", "labels", "seeds", "pending"};

static bool tells_of_forest(const char *words, struct buf *out)
{
    struct record_word word;
    bool tells = false;
    for (size_t i = 0; i < sizeof forest_words / sizeof *forest_words; i++)
        if (record_word_find(words, forest_words[i], strlen(forest_words[i]), &word)) {
            tells = true;
            if (out)
                buf_printf(out, "%s%s=%.*s", out->length ? " " : "", forest_words[i],
                           (int)word.value_length, word.value);
        }
    return tells;
}

static void take_semantics(void *context, unsigned semantics)
{
    struct resume *resume = context;
    resume->interp->session.semantics = semantics;
}

static void look_for_last(void *context, const struct record *record)
{
    struct resume *resume = context;
    if (tells_of_forest(record->result, NULL))
        resume->last = record->number;
}

static enum err execute_again(void *context, const char *command, struct buf *words,
                              struct fault *fault)
{
    struct reply reply = {0};
    enum err err = interpreter_execute(context, command, &reply, fault);
    buf_add_text(words, buf_text(&reply.words));
    reply_release(&reply);
    return err;
}

static bool is_lost(void *context, const char *key, size_t length)
{
    const struct interpreter *interp = context;
    return semantics_lost(interp->session.semantics, key, length) != NULL;
}

static enum err compare_record(struct resume *resume, const struct record *record,
                               struct fault *fault)
{
    const struct replay_host host = {
        .context = resume->interp, .execute = execute_again, .is_lost = is_lost};
    return replay_record(record, &host, &resume->report, fault);
}

/* The same, and then what it and all before have led to is computed. */
static enum err execute_and_catch_up(void *context, const char *command, struct buf *words,
                                     struct fault *fault)
{
    struct interpreter *interp = context;
    struct reply reply = {0};
    enum err err = interpreter_execute(interp, command, &reply, fault);
    if (!err)
        err = session_catch_up(&interp->session, fault);
    buf_clear(&reply.words);
    if (!err)
        add_digests(&reply, &interp->session);
    buf_add_text(words, buf_text(&reply.words));
    reply_release(&reply);
    return err;
}

static enum err compare_forest(struct resume *resume, const struct record *record,
                               struct fault *fault)
{
    const struct replay_host host = {.context = resume->interp, .execute = execute_and_catch_up};
    struct record judged = *record;
    struct buf words = {0};
    tells_of_forest(record->result, &words);
    judged.result = buf_text(&words);
    enum err err = words.failed ? fault_memory(fault, "a record")
                                : replay_record(&judged, &host, &resume->report, fault);
    buf_release(&words);
    return err;
}

/* Up to the last record that tells of the forest nothing is computed; behind it nothing is left to
 * be. What opens a scene is carried out in full either way. */
static enum err skim_record(struct resume *resume, const struct record *record, struct fault *fault)
{
    struct session *session = &resume->interp->session;
    struct record unjudged = *record;
    if (!session->has_scene)
        return compare_record(resume, record, fault);
    if (record->number <= resume->last && !session->skims)
        session_skim(session);
    if (record->number == resume->last)
        return compare_forest(resume, record, fault);
    unjudged.has_result = false;
    return compare_record(resume, &unjudged, fault);
}

static enum err resume_record(void *context, const struct record *record, struct fault *fault)
{
    struct resume *resume = context;
    resume->interp->recorded_words = record->result;
    enum err err = resume->interp->skims ? skim_record(resume, record, fault)
                                         : compare_record(resume, record, fault);
    resume->interp->recorded_words = NULL;
    return err;
}

static enum err carry_out_again(struct interpreter *interp, const char *path, struct buf *told,
                                struct fault *fault)
{
    struct resume resume = {.interp = interp};
    struct journal_resume how = {.semantics = SEMANTICS,
                                 .on_semantics = take_semantics,
                                 .on_sight = look_for_last,
                                 .on_record = resume_record,
                                 .context = &resume,
                                 .only_looks = interp->looks};
    enum err err = journal_open(&interp->journal, path, &how, told, fault);
    replay_report_release(&resume.report);
    return err;
}

/* As if no command had been carried out. */
static void begin_again(struct interpreter *interp)
{
    struct watch *watch = interp->session.watch;
    history_release(&interp->history);
    session_release(&interp->session);
    session_init(&interp->session);
    history_init(&interp->history);
    interp->session.watch = watch;
    buf_clear(&interp->goldens);
}

enum err interpreter_resume_journal(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault)
{
    enum err err = interpreter_set_home(interp, path, fault);
    interp->replays = interp->resumes = true;
    interp->skims = !interp->resumes_slowly;
    if (!err)
        err = carry_out_again(interp, path, told, fault);
    if (err == ERR_CHECK && interp->skims) {
        interp->skims = false;
        begin_again(interp);
        err = carry_out_again(interp, path, told, fault);
    }
    if (!err)
        err = journal_set_sync(interp->journal, interp->sync, fault);
    if (told && told->length)
        buf_add_char(told, '\n');
    if (!err && told)
        semantics_tell_lost(told, interp->session.semantics);
    if (!err && told && interp->looks) {
        buf_add_safe(told, path, strlen(path));
        buf_add_text(told, " is only looked at: what is done here is not written to it\n");
    }
    interp->replays = interp->resumes = interp->skims = false;
    interp->finished = interp->shows_picture = false;
    interp->acknowledged = err ? 0 : journal_count(interp->journal);
    if (err)
        return fault_prefix(fault, err, "cannot resume %s", path);
    return OK;
}

/* ---- paths ---- */

bool interpreter_is_wary(const struct interpreter *interp)
{
    return interp->replays && !interp->resumes;
}

const char *interpreter_scenes(void)
{
    const char *list = getenv("IFTTY_SCENES");
    return list ? list : default_scenes;
}

static bool try_folder(struct buf *path, const char *folder, size_t length, const char *name)
{
    buf_clear(path);
    buf_add(path, folder, length);
    buf_printf(path, "/%s", name);
    return file_exists(buf_text(path));
}

/* `kind` and `undone` are for the words: "scene", "was opened". */
static enum err find(const struct interpreter *interp, const char *name, struct buf *path,
                     const char *kind, const char *undone, struct fault *fault)
{
    struct buf folder = {0};
    bool found = false;
    if (interpreter_is_wary(interp))
        return trust_find(path, buf_text(&interp->home), interpreter_scenes(), name, kind, undone,
                          fault);
    buf_clear(path);
    if (interp->home.length && *name != '/') {
        file_folder(&folder, buf_text(&interp->home));
        found = try_folder(path, buf_text(&folder), folder.length, name);
    }
    if (!found && file_exists(name)) {
        buf_clear(path);
        buf_add_text(path, name);
        found = true;
    }
    for (const char *list = interpreter_scenes(); !found && trust_is_inside(name) && *list;) {
        size_t length = strcspn(list, ":");
        found = length && try_folder(path, list, length, name);
        list += length + (list[length] == ':');
    }
    buf_release(&folder);
    if (path->failed)
        return fault_memory(fault, "a path");
    if (!found)
        return fault_set(fault, ERR_IO, "there is no %s %s here%s; nothing %s", kind, name,
                         interp->home.length ? " nor beside the journal" : "", undone);
    return OK;
}

enum err interpreter_find_scene(const struct interpreter *interp, const char *name,
                                struct buf *path, struct fault *fault)
{
    const bool synthetic = strncmp(name, "synth:", 6) == 0;
    if (!synthetic && !interp->scene_path) {
        const bool is_elsewhere = interpreter_is_wary(interp) && !trust_is_inside(name);
        const enum err err =
            find(interp, is_elsewhere ? file_name(name) : name, path, "scene", "was opened", fault);
        if (err && is_elsewhere)
            fault_prefix(fault, err, "the journal may not open %s; expected --scene FILE", name);
        return err;
    }
    buf_clear(path);
    buf_add_text(path, synthetic ? name : interp->scene_path);
    return path->failed ? fault_memory(fault, "a path") : OK;
}

enum err interpreter_find_file(const struct interpreter *interp, const char *name, struct buf *path,
                               struct fault *fault)
{
    return find(interp, name, path, "file", "has changed", fault);
}

enum err interpreter_may_read(const struct interpreter *interp, const char *path,
                              struct fault *fault)
{
    struct buf folder = {0};
    if (!interpreter_is_wary(interp))
        return OK;
    const char *home = buf_text(&interp->home);
    const char *name = path + (file_name(home) - home); /* both lie in one folder */
    file_folder(&folder, home);
    const enum trust_answer answer = trust_look(buf_text(&folder), name);
    buf_release(&folder);
    if (answer == TRUST_FINE || answer == TRUST_MISSING)
        return OK; /* whoever reads it says that it is missing */
    return fault_set(fault, ERR_INPUT, "the journal may not read %s, which %s", path,
                     answer == TRUST_OUTSIDE ? "leads out of its folder" : "is not a regular file");
}

enum err interpreter_output_path(const struct interpreter *interp, const char *name,
                                 struct buf *path, struct fault *fault)
{
    buf_clear(path);
    if (interp->resumes)
        return OK; /* it was written when the command was new */
    if (interpreter_is_wary(interp) && !trust_is_inside(name))
        return fault_set(
            fault, ERR_INPUT,
            "a journal may not write to %s, but to names in its own folder; nothing was "
            "written",
            name);
    if (interp->out_folder)
        buf_printf(path, "%s/%s", interp->out_folder, file_name(name));
    else if (!interp->replays)
        buf_add_text(path, name);
    if (path->failed)
        return fault_memory(fault, "a path");
    return OK;
}
