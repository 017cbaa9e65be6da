/* SPDX-License-Identifier: MIT */
/* Shared by the files of this room: evidence, the result for one journal and its reports, orphan
 * golden images, the first difference of two journals, the picture of a comparison. */
#ifndef VERIFY_VERIFY_INSIDE_H
#define VERIFY_VERIFY_INSIDE_H

#include "base/buf.h"
#include "command/golden_files.h"
#include "command/interpreter.h"
#include "engine/labels.h"
#include "image/picture.h"
#include "session/session.h"

/* ---- evidence (evidence.c) ---- */

/*
 * Evidence for a person who looks into a failure: what was expected, what was drawn, and where the
 * two differ; in a folder, and as PNG in memory for a report. Evidence that cannot be had is left
 * out: the words of the failure stand without it.
 *
 * A golden image that is the same is evidence as well, and people look at the PNG beside it: what
 * is shown has to be what was compared. Each pixel is that of the golden image, its colours over
 * their background; each text is a note of the golden image, or says when the PNG was drawn; and
 * nothing else is in it (image/png.h). Every verification asks for that, so what proves the
 * golden image proves the PNG. One that is not there shows nothing, and nothing asks for it.
 */

enum { EVIDENCE_MOST = 3 };

/* Begins as {0}. */
struct evidence {
    const char *folder; /* for JOURNAL.NAME.actual.exr and .difference.png; NULL: none */
    bool has_pictures;  /* pictures of a failure are collected as PNG, over black, as seen */
    struct {
        struct buf caption, png;
    } picture[EVIDENCE_MOST];
    size_t pictures;
    uint64_t goldens, pixels; /* golden images that are the same, and their pixels */
};

void evidence_add(struct evidence *evidence, const char *caption, uint32_t width, uint32_t height,
                  const uint8_t *rgba);
void evidence_release(struct evidence *evidence);

/* The judge that refuses every golden image that differs, collects evidence of it, and counts those
 * that do not, whose PNGs it judges. It borrows the evidence. */
struct golden_judge evidence_judge(struct evidence *evidence);

/* ---- the result for one journal (verify_result.c) ---- */

/*
 * What the verification of one journal found. It is made in a process of its own and comes back
 * through a pipe, in a form where everything is counted:
 *
 *     result ERR EXECUTED COMPARED DIGESTS GOLDENS PIXELS TOOK_MS PICTURES\n
 *     part BYTES\n...     why, lines, chain, orphans, slowest, and for each
 *                         picture its caption and its PNG
 *
 * with ERR the number of an enum err. A process that dies leaves less than that, which is refused.
 */

struct verify_result {
    const char *path; /* of the journal; borrowed, and not sent */
    bool is_known;    /* its verification is over; not sent either */
    bool is_skipped;  /* nor this: another failed before, and that was to be the end */
    enum err err;     /* OK, ERR_CHECK where something differs, else why it could not be verified */
    uint64_t executed, compared; /* commands; those of them whose recorded result is the same */
    uint64_t digests;            /* of those results, the words that are digests */
    uint64_t took_ms;
    struct buf why;     /* of a failure: one line, without line feed, safe to print */
    struct buf lines;   /* more about it: lines that begin with "# " */
    struct buf chain;   /* 32 digits: of the last record that was carried out; "" for none */
    struct buf orphans; /* golden images that it does not name: their files, each ended by NUL */
    struct buf slowest; /* of its records, where that was asked for: lines, as of timing_write */
    struct evidence evidence;
};

void verify_result_release(struct verify_result *result);

/* Notes a failure, if it is one; its words are a line as well, unless the lines say it already. */
void verify_result_fail(struct verify_result *result, enum err err, bool is_told,
                        const struct fault *fault);

/* Adds what was compared: "10 commands, 10 results with 14 digests, 1 golden image of 1200
 * pixels". */
void verify_result_describe(struct buf *out, const struct verify_result *result);

void verify_result_write(struct buf *out, const struct verify_result *result);

/* Fills in what was sent. To be released, whatever is returned. ERR_INPUT for bytes of another
 * form. */
enum err verify_result_read(struct verify_result *result, const struct buf *bytes,
                            struct fault *fault);

/* Of several. */
struct verify_sum {
    size_t count, verified, failed, skipped; /* journals */
    size_t unreadable;                       /* that failed by another error than ERR_CHECK */
    uint64_t took_ms;
    enum err worst; /* any other error is worse than ERR_CHECK */
};
struct verify_sum verify_sum(const struct verify_result *result, size_t count);

/*
 * For programs that read JUnit's XML or JSON, and as one HTML page, with the pictures of each
 * failure side by side, without a script, and with nothing to be fetched from anywhere, which the
 * page itself forbids.
 */

/* Adds text that stands between tags or in an attribute between quotes: the one way by which bytes
 * from outside reach a report. What is not printable UTF-8 becomes \xNN, as on a terminal
 * (base/safe.h), so that XML allows what is left; then & < > " ' become entities. A line feed stays
 * one. */
void markup_add(struct buf *out, const char *text);

enum verify_form { VERIFY_JUNIT, VERIFY_HTML, VERIFY_JSON };

/* The report on `count` journals as text. */
void verify_report_text(struct buf *out, enum verify_form form, const struct verify_result *result,
                        size_t count);

/* Writes it as `file`, whole or not at all, over what is there. */
enum err verify_report(const char *file, enum verify_form form, const struct verify_result *result,
                       size_t count, struct fault *fault);

/* ---- orphans (orphan.c) ---- */

/*
 * Orphan golden images: pictures in a journal's folder of golden images that none of its records
 * names (command/golden_files.h). Hidden files, drafts among them, are passed over, and so is the
 * image of a `golden` that was killed after the last record, where it and its PNG are what that
 * command draws: it is drawn again.
 */

struct orphan_search {
    struct interpreter *interp; /* after a replay of the journal */
    const char *journal;
    bool is_strict;    /* every file that no record names is one, not pictures alone */
    struct buf *lines; /* comments on what is passed over; NULL where orphans are to be removed:
                          then nothing is passed over, and an orphan is no failure */
};

/* Adds the names of all, as "third.exr", each ended by NUL, in their order; none where there is no
 * folder. ERR_CHECK, with the first in words, where there are any. A journal whose folder is a link
 * has none, and a comment says so: ERR_CHECK where that is strict. A journal that is a link fails
 * with ERR_CHECK where golden images are next to the link as well and are not the same. ERR_LIMIT,
 * ERR_IO, ERR_MEMORY: then no names are added. */
enum err orphan_find(struct buf *orphans, const struct orphan_search *search, struct fault *fault);

/* Removes one that orphan_find has named, and of an image its PNG. ERR_CHECK for one that this
 * journal cannot have made, and for a journal that is a link: it is left alone. */
enum err orphan_remove(const char *journal, const char *orphan, struct fault *fault);

/* ---- the first difference (first_difference.c) ---- */

/*
 * The first record in which two journals differ. Nothing is carried out.
 *
 * FIRST_COMMAND: commands alone are compared; comments, results and digests may differ. A journal
 * holds commands in canonical form. Those of a script are compared word by word, however they are
 * spaced and quoted, and those that no journal records (a question, say) are skipped, so that a
 * script and the journal it made are the same.
 *
 * FIRST_RECORD: commands and results are compared; comments may differ, and so the chains. Both
 * have to be journals, each record of which is as it was written.
 */

enum first_of { FIRST_COMMAND, FIRST_RECORD };

struct first_difference {
    bool is_there;
    size_t same; /* commands before it that are the same, or all */
    struct {
        bool goes_on;               /* it has a command there: */
        size_t number, line;        /* in its file, from 1 */
        struct buf command, result; /* as the file holds them: not safe to print */
    } side[2];
};

/* `first` begins as {0}, and is to be released whatever is returned. Commands after number `last`
 * are not compared; 0 for all. ERR_INPUT for what cannot be read, or is not sound, with the name of
 * its file, ERR_MEMORY. A torn tail is left alone. */
enum err first_difference_find(struct first_difference *first, enum first_of of,
                               const char *const name[2], const struct buf bytes[2], size_t last,
                               struct fault *fault);

/* The same of the files at `path`. */
enum err first_difference_of_files(struct first_difference *first, enum first_of of,
                                   const char *const name[2], const char *const path[2],
                                   size_t last, struct fault *fault);
void first_difference_release(struct first_difference *first);

/* ---- the picture of a comparison (diff.c) ---- */

/*
 * The picture of two sets of labels of one scene: both as the first session shows its own, side by
 * side, and where they differ.
 *
 *     +----------+----------+----------+
 *     | A        | B        | A, B     |   strips of words above and below; below stand the labels
 *     |  (A's    |  (B's    |  (where  |   with their Dice, and what the colours on the right
 *     |  labels) |  labels) |  not)    |   mean
 *     +----------+----------+----------+
 *
 * View, look, cuts, colours and what is hidden are those of A's session for all three. On the right
 * all objects of either are a grey shade, and the voxels whose labels differ shine through it:
 * orange what A alone has for an object, blue what B alone has, purple what is another object in
 * each. People who cannot distinguish red from green can distinguish these. A voxel that lies
 * behind something is paler than one that is visible.
 */
struct difference_picture {
    const char *name[2];     /* of the two: shown as they are, as far as they are ASCII */
    const uint8_t *label[2]; /* [z][y][x] */
    const struct overlap *overlap;
};

/* Draws it into `picture`, which the caller releases; colours alone. The session is of no other use
 * afterwards: its scene has had its labels replaced, and its forest no longer fits them. ERR_LIMIT
 * where three views are wider than a picture may be, ERR_MEMORY, ERR_CANCELLED. */
enum err difference_picture_draw(struct picture *picture, struct session *session,
                                 const struct difference_picture *of, struct fault *fault);

#endif
