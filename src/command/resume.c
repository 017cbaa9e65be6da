/* SPDX-License-Identifier: MIT */
#include "command/resume.h"

#include "base/choice.h"
#include "base/file.h"
#include "command/execute.h"
#include "command/golden_files.h"
#include "journal/journal.h"
#include "journal/replay.h"
#include "session/semantics.h"

struct resume {
    struct interpreter *interp;
    size_t last;     /* number of the last record that has words of the forest; 0 for none */
    bool catches_up; /* the record at hand is that one */
    struct replay_report report;
};

/* What records say of the forest. */
#define FOREST_WORDS "forest|labels|seeds|pending"

static bool has_forest_words(const char *words, struct buf *out)
{
    struct record_word word;
    struct choice key;
    bool has = false;
    for (const char *at = FOREST_WORDS; choice_next(&key, &at);)
        if (record_word_find(words, key.word, key.length, &word)) {
            has = true;
            if (!out)
                continue;
            buf_add_blank(out);
            buf_printf(out, "%.*s=%.*s", (int)key.length, key.word, (int)word.value_length,
                       word.value);
        }
    return has;
}

static enum err take_semantics(void *context, unsigned semantics, struct fault *fault)
{
    const struct resume *resume = context;
    return session_take_semantics(resume->interp->session, semantics, fault);
}

static void look_for_last(void *context, const struct record *record)
{
    struct resume *resume = context;
    if (has_forest_words(record->result, NULL))
        resume->last = record->number;
}

/* Where the session catches up, the words are of the forest that all commands so far have made. */
static enum err execute_again(void *context, const char *command, struct buf *words,
                              struct fault *fault)
{
    const struct resume *resume = context;
    struct session *session = resume->interp->session;
    struct reply reply = {0};
    enum err err = interpreter_execute(resume->interp, command, &reply, fault);
    if (!err && resume->catches_up) {
        err = session_catch_up(session, fault);
        buf_clear(&reply.words);
        if (!err)
            execute_add_digests(&reply, session);
    }
    buf_add_text(words, buf_text(&reply.words));
    reply_release(&reply);
    return err;
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
    struct buf words = {0};
    has_forest_words(record->result, &words);
    judged.result = buf_text(&words);
    resume->catches_up = true;
    enum err err =
        words.failed ? fault_memory(fault, "a record") : compare_record(resume, &judged, fault);
    resume->catches_up = false;
    buf_release(&words);
    return err;
}

/* Up to the last record that has words of the forest nothing is computed; after it nothing is left
 * to compute. What opens a scene is carried out in full either way. */
static enum err skim_record(struct resume *resume, const struct record *record, struct fault *fault)
{
    struct session *session = resume->interp->session;
    struct record unjudged = *record;
    if (!session_has_scene(session))
        return compare_record(resume, record, fault);
    if (record->number <= resume->last && !session_skims(session))
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
    enum err err = resume->interp->mode == MODE_SKIM ? skim_record(resume, record, fault)
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
                                 .only_looks = interp->is_read_only};
    enum err err = journal_open(&interp->journal, path, &how, told, fault);
    replay_report_release(&resume.report);
    return err;
}

/* What processes that were killed have left beside the journal. */
static void clear_away(struct interpreter *interp, const char *path, struct buf *told)
{
    const struct buf *bytes = journal_bytes(interp->journal);
    struct buf words = {0}, folder = {0};
    file_folder(&folder, path);
    if (!folder.failed)
        file_sweep(buf_text(&folder));
    golden_files_clear(path, buf_text(bytes), bytes->length, &words);
    if (told)
        buf_add_text(told, buf_text(&words));
    buf_release(&words);
    buf_release(&folder);
}

static enum err resume(struct interpreter *interp, const char *path, enum interpreter_mode mode,
                       struct buf *told, struct fault *fault)
{
    enum err err = interpreter_set_home(interp, path, fault);
    interp->mode = mode;
    if (!err)
        err = carry_out_again(interp, path, told, fault);
    if (err == ERR_CHECK && mode == MODE_SKIM) {
        interp->mode = MODE_RESUME; /* as if no command had been carried out */
        interp->resumed_in_full = true;
        history_release(&interp->history);
        session_begin_again(interp->session);
        history_init(&interp->history);
        err = carry_out_again(interp, path, told, fault);
    }
    if (!err)
        err = journal_set_sync(interp->journal, interp->sync, fault);
    if (told && told->length)
        buf_add_char(told, '\n');
    if (!err && !interp->is_read_only)
        clear_away(interp, path, told);
    if (!err && told)
        interpreter_tell_lock(interp, told);
    if (!err && told && interp->is_read_only) {
        buf_add_safe_text(told, path);
        buf_add_text(told, " is open read-only: what is done here is not written to it\n");
    }
    interp->mode = MODE_LIVE;
    interp->wish = WISH_NONE;
    interp->shows_picture = false;
    return err ? fault_prefix(fault, err, "cannot resume %s", path) : OK;
}

enum err interpreter_resume_journal(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault)
{
    return resume(interp, path, MODE_SKIM, told, fault);
}

enum err interpreter_resume_in_full(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault)
{
    return resume(interp, path, MODE_RESUME, told, fault);
}
