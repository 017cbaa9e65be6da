#include "verify/reseal.h"

#include <stdlib.h>
#include <string.h>

#include "base/file_draft.h"
#include "command/golden_leftover.h"
#include "session/semantics.h"
#include "verify/ci.h"
#include "verify/golden_accept.h"
#include "verify/orphan.h"
#include "journal/journal.h"
#include "journal/log.h"
#include "journal/walk.h"
#include "show/export_picture.h"

enum {
    WHY_MOST = 1000,         /* bytes of a reason */
    WORDS_SHOWN_MOST = 4000, /* bytes of former results that a comment repeats */
};

static const char unchanged[] = "nothing has changed";

struct resealing {
    struct interpreter *interp;
    struct golden_accept *accept; /* NULL where golden images are left alone */
    struct buf header, out;       /* the new journal */
    struct record_chain chain;
    size_t count, marked; /* records; those that have changed */
    bool changes_header;
};

/* ---- one record ---- */

/* Whether every recorded word is given now. */
static bool all_are_given(const char *recorded, const char *words)
{
    const char *at = recorded, *end = recorded + strlen(recorded);
    struct record_word word, now;
    while (record_word_next(&at, end, &word))
        if (!record_word_is_among(words, &word, &now))
            return false;
    return true;
}

static bool is_of_picture(const struct record_word *word)
{
    return record_key_is(word, "picture", 7) || record_key_is(word, "spin", 4);
}

/* Accepting is for pictures: any other result that has changed is refused. */
static enum err refuse_results(const struct record *record, const char *words, struct fault *fault)
{
    struct record_word word, now;
    const char *at = record->result, *end = at + strlen(at);
    while (record_word_next(&at, end, &word))
        if (!record_word_is_among(words, &word, &now) && !is_of_picture(&word))
            return fault_set(fault, ERR_CHECK,
                             "record %zu (line %zu) gives another %.*s: no picture, but a result, "
                             "which is not accepted; iftty log --reseal takes it in; %s",
                             record->number, record->line, (int)word.key_length, word.key,
                             unchanged);
    return OK;
}

/* Why it has changed, and what it was before. */
static void add_mark(const struct resealing *r, struct buf *out, const struct record *record)
{
    if (r->accept)
        buf_printf(out, "# accepted: %s", buf_text(&r->accept->why));
    else
        buf_add_text(out, "# resealed: its results are those of iftty " PROGRAM_VERSION);
    if (r->accept && r->accept->note.length)
        buf_printf(out, " (%s)", buf_text(&r->accept->note));
    buf_add_char(out, '\n');
    if (record->has_result)
        buf_printf(out, "# it was: chain=%s%s%.*s\n", record->chain.hex, *record->result ? " " : "",
                   WORDS_SHOWN_MOST, record->result);
    else
        buf_add_text(out, "# it had no result\n");
}

static enum err write_record(struct resealing *r, const char *bytes, const struct record *record,
                             const struct reply *reply, struct fault *fault)
{
    struct buf comments = {0};
    const bool is_sound = !record_judge(record, NULL);
    const bool is_left = r->accept && r->accept->is_left;
    const bool is_same =
        is_left || (record->has_result && all_are_given(record->result, buf_text(&reply->words)) &&
                    (r->accept || !record_lacks_digest(record->result, buf_text(&reply->words))));
    const bool has_note = r->accept && r->accept->note.length;
    buf_add(&comments, bytes + record->offset, (size_t)(record->command_offset - record->offset));
    if (!is_sound || !is_same || has_note) {
        add_mark(r, &comments, record);
        r->marked++;
    }
    const char *command = is_sound ? record->command : buf_text(&reply->canonical);
    const char *words = is_same ? record->result : buf_text(&reply->words);
    const enum err err =
        comments.failed
            ? fault_memory(fault, "a journal")
            : record_encode(&r->out, &r->chain, &r->chain, r->count ? "" : buf_text(&r->header),
                            r->count + 1, buf_text(&comments), command, words, fault);
    r->count += err == OK;
    buf_release(&comments);
    return err;
}

/* A picture that is no golden image: only its digest is known, and nobody can see what it was. */
static enum err ask_of_digest(struct resealing *r, const struct record *record, const char *words,
                              struct fault *fault)
{
    struct golden_accept *accept = r->accept;
    if (accept->is_left || accept->note.length || all_are_given(record->result, words))
        return OK;
    return golden_accept_ask(accept, NULL, "its picture has another digest than is recorded",
                             fault);
}

static enum err reseal_record(struct resealing *r, const char *bytes, const struct record *record,
                              struct fault *fault)
{
    struct reply reply = {0};
    enum err err = OK;
    if (r->accept) {
        err = record_judge(record, fault);
        if (err)
            return fault_set(fault, ERR_CHECK,
                             "record %zu (line %zu) was edited: iftty log --reseal comes first; %s",
                             record->number, record->line, unchanged);
        buf_clear(&r->accept->note);
        r->accept->chain = r->chain;
        r->accept->record = record;
        r->accept->is_left = false;
    }
    r->interp->replayed_words = record->result;
    err = interpreter_execute(r->interp, record->command, &reply, fault);
    r->interp->replayed_words = NULL;
    if (err)
        fault_prefix(fault, err, "record %zu (line %zu) fails; %s", record->number, record->line,
                     unchanged);
    if (!err && r->accept)
        err = refuse_results(record, buf_text(&reply.words), fault);
    if (!err && r->accept)
        err = ask_of_digest(r, record, buf_text(&reply.words), fault);
    if (!err)
        err = write_record(r, bytes, record, &reply, fault);
    reply_release(&reply);
    return err;
}

/* ---- the journal ---- */

static enum err judge_header(struct resealing *r, const struct walk *walk, struct fault *fault)
{
    if (!walk->is_journal)
        return fault_set(fault, ERR_CHECK,
                         "this is a script, not a journal: run it into a new one; %s", unchanged);
    r->changes_header = walk->semantics != SEMANTICS;
    if (r->changes_header && r->accept)
        return fault_set(fault, ERR_CHECK,
                         "it was written with semantics %u, here is %u: iftty log --reseal comes "
                         "first; %s",
                         walk->semantics, (unsigned)SEMANTICS, unchanged);
    record_header(&r->header, SEMANTICS);
    buf_add(&r->out, buf_text(&r->header), r->header.length);
    return OK;
}

/* Carries all of it out, into r->out. */
static enum err reseal_bytes(struct resealing *r, const struct buf *bytes, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, buf_text(bytes), bytes->length, fault);
    if (err)
        return err;
    err = judge_header(r, &walk, fault);
    while (!err && walk_next(&walk, &record) == WALK_RECORD)
        err = reseal_record(r, walk.bytes, &record, fault);
    if (!err && walk.over != WALK_END)
        err = fault_set(fault, ERR_CHECK, "%s; going on with the journal repairs it; %s",
                        walk.fault.text, unchanged);
    if (!err && (r->out.failed || r->header.failed))
        err = fault_memory(fault, "a journal");
    walk_release(&walk);
    return err;
}

/* R1, R2: all of it, or nothing. */
static enum err publish(struct resealing *r, const char *path, const struct buf *former,
                        struct buf *name, struct fault *fault)
{
    struct journal_condition condition;
    enum err err = journal_check(&condition, buf_text(&r->out), r->out.length, fault);
    if (!err && r->out.length > JOURNAL_BYTES_MAX)
        err = fault_set(fault, ERR_LIMIT, "%s would hold more than %zu bytes; %s", path,
                        JOURNAL_BYTES_MAX, unchanged);
    if (!err)
        err = file_write_beside(name, path, "before", buf_text(former), former->length,
                                fault); /* R3 */
    if (err)
        return err;
    r->interp->mode = MODE_LIVE; /* it is over: the user asked for what is replaced now */
    if (r->accept)
        err = golden_accept_publish(r->accept, r->interp, fault);
    if (!err)
        err = file_write(path, buf_text(&r->out), r->out.length, FILE_REPLACE, fault);
    interpreter_settle_files(r->interp, err == OK);
    if (err)
        file_discard(buf_text(name));
    return err;
}

static void report(const struct resealing *r, const char *path, const struct buf *former,
                   const struct printer *printer)
{
    struct buf text = {0};
    buf_add_text(&text, "# ");
    if (r->accept)
        buf_printf(&text, "%zu golden image%s accepted, ", r->accept->images,
                   plural(r->accept->images));
    buf_printf(&text, "%zu of %zu record%s of ", r->marked, r->count, plural(r->count));
    buf_add_safe_text(&text, path);
    buf_add_text(&text, " marked");
    if (former->length) {
        buf_add_text(&text, "; the former journal is stored as ");
        buf_add_safe(&text, buf_text(former), former->length);
    } else {
        buf_add_text(&text, "; nothing has changed");
    }
    buf_add_char(&text, '\n');
    printer->print(printer->context, buf_text(&text));
    buf_release(&text);
}

/* Chains will be others, by which nobody can say then what is nothing. */
static enum err judge_goldens(const struct resealing *r, const char *path, const struct buf *bytes,
                              const struct printer *printer, struct fault *fault)
{
    struct buf told = {0};
    golden_remove_leftovers(path, &r->interp->goldens, buf_text(bytes), bytes->length, &told);
    const bool is_asked = r->accept && !r->accept->reviewer;
    const enum err err = is_asked ? orphan_check(r->interp, path, &told, fault) : OK;
    if (told.length)
        printer->warn(printer->context, buf_text(&told));
    buf_release(&told);
    return err;
}

static enum err reseal(struct resealing *r, const char *path, const struct printer *printer,
                       struct fault *fault)
{
    struct file_log *lock = NULL;
    struct buf bytes = {0}, former = {0};
    struct interpreter *interp = r->interp;
    const struct golden_judge judge = golden_accept_judge(r->accept);
    r->chain = record_chain_zero;
    interp->mode = MODE_REPLAY;
    interp->judge = r->accept ? &judge : NULL;
    enum err err = file_log_open(&lock, path, false, fault); /* R4 */
    if (!err)
        err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = interpreter_set_home(interp, path, fault);
    if (!err) {
        err = reseal_bytes(r, &bytes, fault);
        if (err && err != ERR_CANCELLED)
            fault_prefix(fault, err, "%s", path);
    }
    if (!err)
        err = judge_goldens(r, path, &bytes, printer, fault);
    if (!err && (r->marked || r->changes_header))
        err = publish(r, path, &bytes, &former, fault);
    if (!err)
        report(r, path, &former, printer);
    file_log_close(lock);
    buf_release(&former);
    buf_release(&bytes);
    buf_release(&r->header);
    buf_release(&r->out);
    interp->judge = NULL;
    return err;
}

/* ---- accepting and resealing ---- */

enum err reseal_check_reason(const char *why, struct fault *fault)
{
    struct fault words;
    struct buf comment = {0};
    buf_printf(&comment, "# %s", why);
    const bool is_fine = why[strspn(why, " ")] && strlen(why) <= WHY_MOST && !comment.failed &&
                         !record_comment_check(buf_text(&comment), &words);
    buf_release(&comment);
    return is_fine
               ? OK
               : fault_set(fault, ERR_USAGE, "expected a reason, one line of at most %d bytes; %s",
                           WHY_MOST, unchanged);
}

static enum err check_person(const char *option, struct fault *fault)
{
    return ci_is_set() ? fault_set(fault, ERR_USAGE,
                                   "%s is a person's decision, and refused where CI is set; %s",
                                   option, unchanged)
                       : OK;
}

enum err reseal_accept(struct interpreter *interp, const char *path, const char *why,
                       const struct printer *printer, struct fault *fault)
{
    struct golden_accept accept = {0};
    struct resealing r = {.interp = interp, .accept = &accept};
    enum err err = check_person("--accept", fault);
    if (!err) {
        err = reseal_check_reason(why, fault);
        if (err)
            fault_prefix(fault, err, "--accept");
    }
    if (err)
        return err;
    buf_add_text(&accept.why, why);
    err = reseal(&r, path, printer, fault);
    golden_accept_release(&accept);
    return err;
}

enum err reseal_review(struct interpreter *interp, const char *path,
                       const struct reviewer *reviewer, const struct printer *printer,
                       struct fault *fault)
{
    struct golden_accept accept = {.reviewer = reviewer};
    struct resealing r = {.interp = interp, .accept = &accept};
    enum err err = check_person("--review", fault);
    if (err)
        return err;
    err = reseal(&r, path, printer, fault);
    const size_t left = accept.answers[REVIEW_REJECT] + accept.answers[REVIEW_SKIP];
    if (!err && left)
        err = fault_set(fault, ERR_CHECK,
                        "%zu picture%s of %s rejected, %zu skipped: it goes on failing",
                        accept.answers[REVIEW_REJECT], plural(accept.answers[REVIEW_REJECT]), path,
                        accept.answers[REVIEW_SKIP]);
    golden_accept_release(&accept);
    return err;
}

enum err reseal_edited(struct interpreter *interp, const char *path, const struct printer *printer,
                       struct fault *fault)
{
    struct resealing r = {.interp = interp};
    return reseal(&r, path, printer, fault);
}
