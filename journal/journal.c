#include "journal/journal.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "journal/walk.h"

enum { COMMENTS_MAX = 1 << 20, TORN_NAMES_MAX = 9999 };

struct journal {
    struct file_log *log;
    struct buf header;   /* line 1, part of the first record's chain */
    struct buf comments; /* whole lines, for the next record */
    uint64_t length;     /* of the valid part; the file is longer only while `is_ragged` */
    size_t count;
    struct record_chain chain;
    bool is_ragged; /* a failed append may have left bytes behind `length` */
};

void journal_close(struct journal *journal)
{
    if (!journal)
        return;
    file_log_close(journal->log);
    buf_release(&journal->header);
    buf_release(&journal->comments);
    free(journal);
}

static enum err journal_new(struct journal **journal, unsigned semantics, struct fault *fault)
{
    *journal = calloc(1, sizeof **journal);
    if (!*journal)
        return fault_memory(fault, "a journal");
    record_header(&(*journal)->header, semantics);
    (*journal)->chain = record_chain_zero;
    if (!(*journal)->header.failed)
        return OK;
    journal_close(*journal);
    *journal = NULL;
    return fault_memory(fault, "a journal");
}

/* The one door by which bytes reach the file: J1, J2, J5. */
static enum err append_bytes(struct journal *journal, const struct buf *bytes, struct fault *fault)
{
    enum err err = OK;
    if (bytes->length > JOURNAL_BYTES_MAX - journal->length)
        return fault_set(fault, ERR_LIMIT, "%s would hold more than %zu bytes; nothing was written",
                         journal_path(journal), JOURNAL_BYTES_MAX);
    if (journal->is_ragged) {
        err = file_log_cut(journal->log, journal->length, fault);
        if (err)
            return fault_prefix(fault, err, "an earlier failure is not mended yet");
        journal->is_ragged = false;
    }
    assert(file_log_length(journal->log) == journal->length); /* J3 */
    err = file_log_append(journal->log, bytes->data, bytes->length, fault);
    if (!err) {
        journal->length += bytes->length;
        return OK;
    }
    /* The file layer has cut the file; that cut is to be on the disk before anything follows, or
     * the refused bytes could be back after a loss of power, or stand behind a shorter record. */
    journal->is_ragged = file_log_cut(journal->log, journal->length, NULL) != OK;
    return err;
}

enum err journal_create(struct journal **out, const char *path, unsigned semantics,
                        struct fault *fault)
{
    struct journal *journal;
    *out = NULL;
    enum err err = journal_new(&journal, semantics, fault);
    if (err)
        return err;
    err = file_log_open(&journal->log, path, true, fault);
    if (!err) {
        err = append_bytes(journal, &journal->header, fault);
        if (err)
            file_discard(path); /* ours, made a moment ago */
    }
    if (err)
        journal_close(journal);
    else
        *out = journal;
    return err;
}

/* ---- opening what is there ------------------------------------------------------------------- */

/* What the first walk found. */
struct finding {
    uint64_t sound; /* bytes of header and sound records; 0 where even the header is missing */
    size_t count;
    struct record_chain chain;
    bool is_torn; /* what follows is torn, or damaged where the caller wants it cut */
    struct fault fault;
};

static enum err judge_semantics(const struct walk *walk, unsigned semantics, struct fault *fault)
{
    if (!walk->is_journal && walk->length > 0)
        return fault_set(fault, ERR_INPUT,
                         "it has no header: this is a script, not a journal; run it instead");
    if (walk->semantics != 0 && walk->semantics != semantics)
        return fault_set(fault, ERR_INPUT,
                         "its commands have the meaning of version %u, here they have that of "
                         "version %u; run it as a script into a new journal",
                         walk->semantics, semantics);
    return OK;
}

/* Walks the bytes and changes nothing: whatever would be refused is refused here. */
static enum err survey(const struct buf *bytes, const struct journal_resume *resume,
                       struct finding *finding, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes->data, bytes->length, WALK_AS_FOUND, fault);
    if (err)
        return err;
    err = judge_semantics(&walk, resume->semantics, fault);
    enum walk_step step = WALK_RECORD;
    while (!err && step == WALK_RECORD)
        step = walk_next_sound(&walk, &record);
    if (!err && step == WALK_DAMAGED && !resume->cuts_damage)
        err = fault_set(fault, ERR_INPUT, "%s; nothing was changed", walk.fault.text);
    *finding = (struct finding){.sound = walk.offset,
                                .count = walk.records,
                                .chain = walk.chain,
                                .is_torn = step != WALK_END,
                                .fault = walk.fault};
    walk_release(&walk);
    return err;
}

/* Hands the sound records to the caller. */
static enum err resume_records(const struct buf *bytes, const struct finding *finding,
                               const struct journal_resume *resume, struct fault *fault)
{
    struct walk walk;
    struct record record;
    if (!resume->on_record || finding->count == 0)
        return OK;
    enum err err = walk_begin(&walk, bytes->data, (size_t)finding->sound, WALK_AS_FOUND, fault);
    if (err)
        return err;
    while (!err && walk_next_sound(&walk, &record) == WALK_RECORD)
        err = resume->on_record(resume->context, &record, fault);
    assert(err || walk.records == finding->count);
    walk_release(&walk);
    return err;
}

/* Saves `length` bytes as PATH.torn-N under the first free N; `name` gets that name. */
static enum err save_torn(struct buf *name, const char *path, const char *bytes, size_t length,
                          struct fault *fault)
{
    for (unsigned n = 1; n <= TORN_NAMES_MAX; n++) {
        buf_clear(name);
        buf_printf(name, "%s.torn-%u", path, n);
        if (name->failed)
            return fault_memory(fault, "a file name");
        if (!file_exists(buf_text(name)))
            return file_write(buf_text(name), bytes, length, FILE_KEEP, fault);
    }
    return fault_set(fault, ERR_IO,
                     "there are %d files %s.torn-N already; the torn record was "
                     "left where it is",
                     TORN_NAMES_MAX, path);
}

/* Saves what follows the sound part, cuts it off and says so. The order matters: at every moment
 * the bytes are in one of the two files. */
static enum err mend(struct journal *journal, const struct buf *bytes,
                     const struct finding *finding, struct buf *notice, struct fault *fault)
{
    struct buf name = {0};
    const size_t lost = bytes->length - (size_t)finding->sound;
    enum err err =
        save_torn(&name, journal_path(journal), bytes->data + finding->sound, lost, fault);
    if (!err)
        err = file_log_cut(journal->log, finding->sound, fault);
    if (!err && notice) {
        buf_printf(notice, "%s; %zu bytes were kept in ", finding->fault.text, lost);
        buf_add_safe(notice, buf_text(&name), name.length);
        buf_printf(notice, " and cut off; %zu records remain", finding->count);
    }
    buf_release(&name);
    return err;
}

static enum err open_locked(struct journal *journal, const char *path,
                            const struct journal_resume *resume, struct buf *notice,
                            struct fault *fault)
{
    struct buf bytes = {0};
    struct finding finding;
    enum err err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (err)
        goto done;
    if (bytes.length != file_log_length(journal->log)) {
        err = fault_set(fault, ERR_IO, "%s changed while it was opened", path);
        goto done;
    }
    err = survey(&bytes, resume, &finding, fault);
    if (!err)
        err = resume_records(&bytes, &finding, resume, fault);
    if (err) {
        fault_prefix(fault, err, "cannot continue %s", path);
        goto done;
    }
    if (finding.is_torn)
        err = mend(journal, &bytes, &finding, notice, fault);
    if (err)
        goto done;
    journal->length = finding.sound;
    journal->count = finding.count;
    journal->chain = finding.chain;
    if (finding.sound == 0)
        err = append_bytes(journal, &journal->header, fault);
done:
    buf_release(&bytes);
    return err;
}

enum err journal_open(struct journal **out, const char *path, const struct journal_resume *resume,
                      struct buf *notice, struct fault *fault)
{
    struct journal *journal;
    *out = NULL;
    if (notice)
        buf_clear(notice);
    enum err err = journal_new(&journal, resume->semantics, fault);
    if (err)
        return err;
    err = file_log_open(&journal->log, path, false, fault); /* J6 */
    if (!err)
        err = open_locked(journal, path, resume, notice, fault);
    if (err)
        journal_close(journal);
    else
        *out = journal;
    return err;
}

/* ---- writing --------------------------------------------------------------------------------- */

enum err journal_append(struct journal *journal, const char *command, const char *words,
                        struct fault *fault)
{
    struct buf bytes = {0};
    struct record_chain chain;
    const char *header = journal->count == 0 ? buf_text(&journal->header) : "";
    enum err err = record_encode(&bytes, &chain, &journal->chain, header, journal->count + 1,
                                 buf_text(&journal->comments), command, words, fault);
    if (!err)
        err = append_bytes(journal, &bytes, fault);
    if (err)
        fault_prefix(fault, err, "not recorded");
    if (!err) {
        journal->count++;
        journal->chain = chain;
        buf_clear(&journal->comments);
    }
    buf_release(&bytes);
    return err;
}

enum err journal_comment(struct journal *journal, const char *comment, struct fault *fault)
{
    struct buf *comments = &journal->comments;
    const size_t before = comments->length;
    enum err err = record_comment_check(comment, fault);
    if (err)
        return err;
    if (before + strlen(comment) >= COMMENTS_MAX)
        return fault_set(fault, ERR_LIMIT,
                         "the comments before one command are limited to %d bytes", COMMENTS_MAX);
    if (!buf_reserve(comments, strlen(comment) + 1)) {
        comments->failed = false; /* what was kept before is whole */
        return fault_memory(fault, "a comment");
    }
    buf_printf(comments, "%s\n", comment);
    return OK;
}

const char *journal_path(const struct journal *journal)
{
    return file_log_path(journal->log);
}

size_t journal_count(const struct journal *journal)
{
    return journal->count;
}

const char *journal_chain(const struct journal *journal)
{
    return journal->chain.hex;
}

enum err journal_audit(const struct journal *journal, struct fault *fault)
{
    struct buf bytes = {0};
    struct walk walk;
    struct record record;
    enum err err = file_read(&bytes, journal_path(journal), JOURNAL_BYTES_MAX, fault);
    if (err)
        goto done;
    err = walk_begin(&walk, bytes.data, bytes.length, WALK_AS_FOUND, fault);
    if (err)
        goto done;
    enum walk_step step;
    do
        step = walk_next_sound(&walk, &record);
    while (step == WALK_RECORD);
    const bool tail_is_fine =
        step == WALK_END || (step == WALK_TORN && journal->is_ragged); /* J2 */
    const bool content_is_ours = walk.offset == journal->length && walk.records == journal->count &&
                                 strcmp(walk.chain.hex, journal->chain.hex) == 0; /* J3 */
    if (!tail_is_fine || !content_is_ours)
        err = fault_set(
            fault, ERR_CHECK,
            "%s holds %zu records in %zu bytes where %zu in %" PRIu64 " were acknowledged",
            journal_path(journal), walk.records, walk.offset, journal->count, journal->length);
    walk_release(&walk);
done:
    buf_release(&bytes);
    return err;
}
