/* SPDX-License-Identifier: MIT */
#include "verify/verify.h"

#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/version.h"
#include "command/execute.h"
#include "command/golden_files.h"
#include "image/image_helper.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "show/export_picture.h"
#include "verify/verify_inside.h"

enum {
    WHY_MOST = 1000,         /* bytes of a reason */
    WORDS_SHOWN_MOST = 4000, /* bytes of former results that a comment repeats */
};

static const char unchanged[] = "nothing has changed";

/* ---- golden images to accept ---- */

/*
 * Golden images that differ or are missing, and are to be accepted, are drawn into drafts next to
 * their places. Drafts are published only if all of them and the journal can be. Other drafts are
 * removed at the end, together with a folder that was made for them.
 */
struct resealing {
    struct interpreter *interp;
    const char *why;           /* reason, one line; NULL leaves golden images as they are */
    const char *only;          /* names of golden images to accept, "first,second"; NULL: all */
    bool takes_results;        /* results that are no pictures may have changed, and records
                                  may be edited */
    struct buf header, out;    /* the new journal */
    struct record_chain chain; /* chain of the last record */
    size_t count, marked;      /* records; changed records */
    struct buf drafts;         /* pairs of a draft and its place, each ended by NUL */
    struct buf same;           /* places of golden images that are the same, each ended by NUL */
    struct buf met;            /* names of all golden images, each ended by NUL */
    struct buf folder;         /* folder of golden images if it was made for drafts, otherwise "" */
    struct buf note;           /* difference of the golden image of the present command, or "" */
    bool is_left;              /* the picture of the present command is not accepted */
    size_t images;             /* golden images accepted */
    size_t left;               /* pictures that differ and are not accepted */
    size_t missing;            /* golden images that do not exist, and the words for the first */
    struct fault missing_words;
};

/* Find the next pair of a draft and its place; false at the end. */
static bool next_draft(const struct resealing *r, const char **at, const char **draft,
                       const char **place)
{
    *at = *at ? *place + strlen(*place) + 1 : buf_text(&r->drafts);
    if (*at >= buf_text(&r->drafts) + r->drafts.length)
        return false;
    *draft = *at;
    *place = *draft + strlen(*draft) + 1;
    return true;
}

/* Return the file to compare: the draft for that place if it exists, otherwise the file there.
 * */
static const char *compared_path(void *context, const char *path)
{
    const char *at = NULL, *draft, *place;
    while (next_draft(context, &at, &draft, &place))
        if (strcmp(place, path) == 0)
            return draft;
    return path;
}

/* Write one file under a new name. */
static enum err write_draft(struct resealing *r, struct interpreter *interp, const char *path,
                            const struct picture *picture, struct fault *fault)
{
    OWNED(buf_release) struct buf draft = {0};
    TRY(file_draft(&draft, path, FILE_REPLACE, fault));
    enum err err = image_write(interp->helper, buf_text(&draft), FILE_KEEP, picture, fault);
    buf_add(&r->drafts, buf_text(&draft), draft.length + 1);
    buf_add(&r->drafts, path, strlen(path) + 1);
    if (err || !r->drafts.failed)
        return err;
    file_discard(buf_text(&draft));
    return fault_memory(fault, "the names of files");
}

/* Write the image and its PNG. Their folder is removed later if nothing is published. */
static enum err write_drafts(struct resealing *r, struct interpreter *interp,
                             const struct golden_finding *finding, struct fault *fault)
{
    OWNED(golden_files_close) struct golden_files files;
    TRY(golden_files_open(&files, buf_text(&interp->home), false, fault));
    if (files.folder < 0) {
        buf_clear(&r->folder);
        buf_add_text(&r->folder, buf_text(&files.path));
        golden_files_close(&files);
        TRY(golden_files_open(&files, buf_text(&interp->home), true, fault));
    }
    if (!interp->session->is_private)
        TRY(picture_note(finding->actual, "iftty:journal", file_name(buf_text(&interp->home)),
                         fault));
    TRY(picture_note(finding->actual, "iftty:chain", r->chain.hex, fault));
    TRY(write_draft(r, interp, finding->path, finding->actual, fault));
    buf_printf(&files.path, "/%s.png", finding->name);
    if (files.path.failed)
        return fault_memory(fault, "a path");
    return write_draft(r, interp, buf_text(&files.path), finding->actual, fault);
}

/* Return the next of names separated by commas; false after the last. */
static bool next_name(const char **names, const char **name, size_t *length)
{
    if (!*names)
        return false;
    *name = *names;
    *length = strcspn(*names, ",");
    *names = (*names)[*length] ? *names + *length + 1 : NULL;
    return true;
}

static bool is_accepted(const struct resealing *r, const char *golden)
{
    const char *names = r->only, *name;
    size_t length;
    while (next_name(&names, &name, &length))
        if (strlen(golden) == length && memcmp(name, golden, length) == 0)
            return true;
    return !r->only;
}

/* Reject a name in `only` that no `golden` of the journal has. */
static enum err check_names(const struct resealing *r, struct fault *fault)
{
    const char *names = r->only, *name;
    size_t length;
    if (r->met.failed)
        return fault_memory(fault, "the names of golden images");
    while (next_name(&names, &name, &length))
        if (!buf_lists(&r->met, name, length))
            return fault_set(fault, ERR_USAGE,
                             "--only: no `golden` of this journal has the name \"%.*s\"; iftty "
                             "log --script prints its commands; %s",
                             (int)length, name, unchanged);
    return OK;
}

static enum err note_same(void *context, struct interpreter *interp,
                          const struct golden_finding *finding, struct fault *fault)
{
    struct resealing *r = context;
    (void)interp;
    buf_add(&r->same, finding->path, strlen(finding->path) + 1);
    buf_add(&r->met, finding->name, strlen(finding->name) + 1);
    return r->same.failed ? fault_memory(fault, "the names of files") : OK;
}

static enum err note_difference(void *context, struct interpreter *interp,
                                const struct golden_finding *finding, struct fault *fault)
{
    struct resealing *r = context;
    if (compared_path(r, finding->path) != finding->path ||
        buf_lists(&r->same, finding->path, strlen(finding->path)))
        return fault_set(fault, ERR_CHECK,
                         "golden image %s is given twice, and the pictures are not the same",
                         finding->name);
    buf_add(&r->met, finding->name, strlen(finding->name) + 1);
    r->is_left = !is_accepted(r, finding->name);
    r->left += r->is_left;
    if (!r->is_left) {
        r->images++;
        buf_add_text(&r->note, fault->text);
    }
    TRY(r->is_left ? OK : write_drafts(r, interp, finding, fault));
    fault->text[0] = '\0';
    return OK;
}

static void resealing_release(struct resealing *r)
{
    const char *at = NULL, *draft, *place;
    while (next_draft(r, &at, &draft, &place))
        file_discard(draft); /* no longer exists if it was published */
    if (r->folder.length)
        rmdir(buf_text(&r->folder)); /* fails if the folder holds a file */
    buf_release(&r->header);
    buf_release(&r->out);
    buf_release(&r->folder);
    buf_release(&r->same);
    buf_release(&r->drafts);
    buf_release(&r->note);
    buf_release(&r->met);
}

/* ---- one record ---- */

static enum err count_stale(void *context, struct interpreter *interp,
                            const struct golden_finding *finding, struct fault *fault)
{
    struct resealing *r = context;
    (void)interp;
    if (file_exists(finding->path))
        r->left++;
    else if (!r->missing++)
        r->missing_words = *fault;
    fault->text[0] = '\0';
    return OK;
}

/* True if all recorded words are among the present words. */
static bool all_are_given(const char *recorded, const char *words)
{
    const char *at = recorded, *end = recorded + strlen(recorded);
    struct record_word word, now;
    while (record_word_next(&at, end, &word))
        if (!record_word_is_among(words, &word, &now))
            return false;
    return true;
}

/* Find the first recorded word that differs now or is missing, and that is not of a picture. */
static bool has_other_result(const struct record *record, const char *words,
                             struct record_word *word)
{
    struct record_word now;
    const char *at = record->result, *end = at + strlen(at);
    while (record_word_next(&at, end, word))
        if (!record_word_is_among(words, word, &now) && !record_key_is(word, "picture", 7) &&
            !record_key_is(word, "spin", 4))
            return true;
    return false;
}

/* Add the reason for a change, and the former result. */
static void add_mark(const struct resealing *r, struct buf *out, const struct record *record,
                     const char *words)
{
    struct record_word word;
    const bool has_other = !record->has_result || has_other_result(record, words, &word);
    if (r->why && (!has_other || r->note.length)) {
        buf_printf(out, "# accepted: %s", r->why);
        if (r->note.length)
            buf_printf(out, " (%s)", buf_text(&r->note));
        buf_add_char(out, '\n');
    }
    if (!r->why || has_other)
        buf_add_text(out, "# resealed: its results are those of iftty " PROGRAM_VERSION "\n");
    if (record->has_result)
        buf_printf(out, "# it was: chain=%s%s%.*s\n", record->chain.hex, *record->result ? " " : "",
                   WORDS_SHOWN_MOST, record->result);
    else
        buf_add_text(out, "# it had no result\n");
}

static enum err write_record(struct resealing *r, const char *bytes, const struct record *record,
                             const struct reply *reply, struct fault *fault)
{
    OWNED(buf_release) struct buf comments = {0};
    const bool is_sound = !record_judge(record, NULL);
    const bool is_left = r->why && r->is_left;
    const bool is_same =
        is_left ||
        (record->has_result && all_are_given(record->result, buf_text(&reply->words)) &&
         (!r->takes_results || !record_lacks_digest(record->result, buf_text(&reply->words))));
    const bool has_note = r->why && r->note.length;
    buf_add(&comments, bytes + record->offset, (size_t)(record->command_offset - record->offset));
    if (!is_sound || !is_same || has_note) {
        add_mark(r, &comments, record, buf_text(&reply->words));
        r->marked++;
    }
    const struct record anew = {.number = r->count + 1,
                                .command = is_sound ? record->command : buf_text(&reply->canonical),
                                .result = is_same ? record->result : buf_text(&reply->words)};
    const enum err err =
        comments.failed ? fault_memory(fault, "a journal")
                        : record_encode(&r->out, &r->chain, r->count ? "" : buf_text(&r->header),
                                        buf_text(&comments), &anew, fault);
    r->count += err == OK;
    return err;
}

static enum err reseal_record(struct resealing *r, const char *bytes, const struct record *record,
                              struct fault *fault)
{
    OWNED(reply_release) struct reply reply = {0};
    struct record_word word;
    enum err err = OK;
    if (r->why) {
        err = r->takes_results ? OK : record_judge(record, fault);
        if (err)
            return fault_set(fault, ERR_CHECK,
                             "record %zu (line %zu) was edited: iftty log --reseal comes first; %s",
                             record->number, record->line, unchanged);
        buf_clear(&r->note);
        r->is_left = false;
    }
    r->interp->replayed_words = record->result;
    err = interpreter_execute(r->interp, record->command, &reply, fault);
    r->interp->replayed_words = NULL;
    if (err)
        fault_prefix(fault, err, "record %zu (line %zu) fails; %s", record->number, record->line,
                     unchanged);
    if (!err && !r->takes_results && has_other_result(record, buf_text(&reply.words), &word))
        err = fault_set(fault, ERR_CHECK,
                        "record %zu (line %zu) has another %.*s, which is a result and not a "
                        "picture: only pictures are accepted; iftty log --reseal records "
                        "results; %s",
                        record->number, record->line, (int)word.key_length, word.key, unchanged);
    /* A picture that is not a golden image: its digest is known, but the former picture is not.
     * */
    if (!err && r->why && !r->is_left && !r->note.length &&
        !all_are_given(record->result, buf_text(&reply.words)))
        r->left += r->is_left = r->only != NULL;
    return err ? err : write_record(r, bytes, record, &reply, fault);
}

/* ---- the journal ---- */

/* Carry out the whole journal and write the new one to r->out. */
static enum err reseal_bytes(struct resealing *r, const struct buf *bytes, struct fault *fault)
{
    OWNED(walk_release) struct walk walk;
    struct record record;
    TRY(walk_begin(&walk, buf_text(bytes), bytes->length, fault));
    if (!walk.is_journal)
        return fault_set(fault, ERR_CHECK,
                         "this is a script, not a journal: run it into a new one; %s", unchanged);
    TRY(session_set_semantics(r->interp->session, walk.semantics, fault));
    record_header(&r->header, walk.semantics);
    buf_add(&r->out, buf_text(&r->header), r->header.length);
    while (walk_next(&walk, &record) == WALK_RECORD)
        TRY(reseal_record(r, walk.bytes, &record, fault));
    if (walk.over != WALK_END)
        return fault_set(fault, ERR_CHECK, "%s; continuing the journal repairs it; %s",
                         walk.fault.text, unchanged);
    if (r->missing)
        return fault_set(fault, ERR_CHECK,
                         "%s; iftty log --reseal --accept WHY FILE draws it again; %s",
                         r->missing_words.text, unchanged);
    if (r->why)
        TRY(check_names(r, fault));
    return r->out.failed || r->header.failed ? fault_memory(fault, "a journal") : OK;
}

/* R1, R2: publish everything or nothing. */
static enum err publish(struct resealing *r, const char *path, const struct buf *former,
                        struct buf *name, struct fault *fault)
{
    struct journal_condition condition;
    const char *at = NULL, *draft, *place;
    enum err err = OK;
    TRY(journal_check(&condition, buf_text(&r->out), r->out.length, fault));
    if (r->out.length > JOURNAL_BYTES_MAX)
        return fault_set(fault, ERR_LIMIT, "%s would hold more than %zu bytes; %s", path,
                         JOURNAL_BYTES_MAX, unchanged);
    TRY(file_write_beside(name, path, "before", buf_text(former), former->length, fault)); /* R3 */
    r->interp->mode = MODE_LIVE; /* the replay is over: the user asked for the following writes */
    struct golden_files files = {.folder = -1};
    if (r->why && r->drafts.length)
        err = golden_files_open(&files, path, false, fault);
    while (!err && r->why && next_draft(r, &at, &draft, &place)) {
        err = interpreter_will_write(r->interp, place, FILE_REPLACE, fault);
        if (!err)
            err = file_publish_in(files.folder, draft, place, fault);
    }
    golden_files_close(&files);
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
    OWNED(buf_release) struct buf text = {0};
    buf_add_text(&text, "# ");
    if (r->why)
        buf_printf(&text, "%zu golden image%s accepted, ", r->images, plural(r->images));
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
    if (!r->why && r->left)
        buf_printf(&text,
                   "# golden images left unchanged that differ from the drawn ones: %zu; iftty "
                   "verify --accept WHY FILE draws them again\n",
                   r->left);
    printer->print(printer->context, buf_text(&text));
}

/* Reject a link: only the journal itself and its golden images are replaced. */
static enum err refuse_link(const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf real = {0};
    file_real(&real, path);
    return real.failed ? fault_memory(fault, "a path")
           : strcmp(buf_text(&real), path) != 0
               ? fault_set(fault, ERR_INPUT, "%s is a link; name the journal itself, %s; %s", path,
                           buf_text(&real), unchanged)
               : OK;
}

/* The reason must fit one comment of a record, and must come from a person. */
static enum err check_reason(const char *why, struct fault *fault)
{
    struct fault words;
    OWNED(buf_release) struct buf comment = {0};
    if (ci_is_set())
        return fault_set(fault, ERR_USAGE,
                         "--accept is a person's decision, and refused where CI is set; %s",
                         unchanged);
    buf_printf(&comment, "# %s", why);
    if (why[strspn(why, " ")] && strlen(why) <= WHY_MOST && !comment.failed &&
        !record_comment_check(buf_text(&comment), &words))
        return OK;
    return fault_set(fault, ERR_USAGE,
                     "--accept: expected a reason, one line of at most %d bytes; %s", WHY_MOST,
                     unchanged);
}

static enum err reseal(struct resealing *r, const char *path, const struct printer *printer,
                       struct fault *fault)
{
    struct file_log *lock = NULL;
    OWNED(buf_release) struct buf bytes = {0}, former = {0}, lines = {0}, orphans = {0};
    struct interpreter *interp = r->interp;
    const struct golden_judge judge =
        r->why ? (struct golden_judge){.context = r,
                                       .source = compared_path,
                                       .is_same = note_same,
                                       .differs = note_difference}
               : (struct golden_judge){.context = r, .differs = count_stale};
    r->chain = record_chain_zero;
    interp->mode = MODE_REPLAY;
    interp->judge = &judge;
    enum err err = r->why ? check_reason(r->why, fault) : OK;
    if (!err)
        err = refuse_link(path, fault);
    if (!err)
        err = file_log_open(&lock, path, false, fault); /* R4 */
    if (!err)
        err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = interpreter_set_home(interp, path, fault);
    if (!err) {
        err = reseal_bytes(r, &bytes, fault);
        if (err && err != ERR_CANCELLED)
            fault_prefix(fault, err, "%s", path);
    }
    if (!err) { /* before the chains change, by which leftovers are recognized */
        golden_files_clear(path, buf_text(&bytes), bytes.length, &lines);
        if (r->why)
            err =
                orphan_find(&orphans, &(struct orphan_search){interp, path, false, &lines}, fault);
        if (lines.length)
            printer->warn(printer->context, buf_text(&lines));
    }
    if (!err && r->marked)
        err = publish(r, path, &bytes, &former, fault);
    if (!err)
        report(r, path, &former, printer);
    file_log_close(lock);
    resealing_release(r);
    interp->judge = NULL;
    return err;
}

enum err reseal_accept(struct interpreter *interp, const char *path, const char *why,
                       const char *only, const struct printer *printer, struct fault *fault)
{
    struct resealing r = {.interp = interp, .why = why, .only = only};
    TRY(reseal(&r, path, printer, fault));
    if (!r.left)
        return OK;
    return fault_set(fault, ERR_CHECK,
                     "%zu picture%s of %s still differ%s, not named by --only: iftty verify --out "
                     "DIR stores what differs",
                     r.left, plural(r.left), path, r.left == 1 ? "s" : "");
}

enum err reseal_edited(struct interpreter *interp, const char *path, const char *why,
                       const struct printer *printer, struct fault *fault)
{
    struct resealing r = {.interp = interp, .why = why, .takes_results = true};
    return reseal(&r, path, printer, fault);
}
