/* SPDX-License-Identifier: MIT */
/* Declarations shared by the files of this room: evidence, the result for one journal and its
 * reports, orphan golden images, the first difference of two journals, the picture of a comparison.
 * */
#ifndef VERIFY_VERIFY_INSIDE_H
#define VERIFY_VERIFY_INSIDE_H

#include "base/buf.h"
#include "command/golden_files.h"
#include "command/script.h"
#include "engine/labels.h"
#include "image/picture.h"
#include "session/session.h"

/* ---- evidence (evidence.c) ---- */

/*
 * Evidence for a person who inspects a failure: the expected picture, the drawn one, and their
 * difference; in a folder, and as PNG in memory for a report. Evidence that cannot be made is left
 * out: the words of the failure suffice.
 *
 * A golden image that is the same is evidence as well. People look at its PNG, so the PNG must show
 * the compared picture: each pixel is that of the golden image, its colours blended over their
 * background; each text is a note of the golden image, or says when the PNG was drawn; and the file
 * holds nothing else (image/png.h). Every verification checks that, so the proof of the golden
 * image covers the PNG. A PNG that does not exist is not required.
 */

enum { EVIDENCE_MOST = 3 };

/* Begins as {0}. */
struct evidence {
    const char *folder; /* for JOURNAL.NAME.actual.exr and .difference.png; NULL: none */
    bool has_pictures;  /* collect pictures of a failure as PNG, over black, as seen */
    struct {
        struct buf caption, png;
    } picture[EVIDENCE_MOST];
    size_t pictures;
    uint64_t goldens, pixels; /* golden images that are the same, and their pixels */
};

void evidence_add(struct evidence *evidence, const char *caption, uint32_t width, uint32_t height,
                  const uint8_t *rgba);
void evidence_release(struct evidence *evidence);

/* Return a judge that rejects every golden image that differs and collects evidence of it. It
 * counts equal golden images and judges their PNGs. It borrows the evidence. */
struct golden_judge evidence_judge(struct evidence *evidence);

/* ---- the result for one journal (verify_result.c) ---- */

/*
 * Result of the verification of one journal. A process of its own makes it and sends it through a
 * pipe, with the length of each part:
 *
 *     result ERR EXECUTED COMPARED DIGESTS GOLDENS PIXELS TOOK_MS PICTURES\n
 *     part BYTES\n...     why, lines, chain, orphans, slowest, and for each
 *                         picture its caption and its PNG
 *
 * ERR is the number of an enum err. A process that dies sends less than that, which is rejected.
 */

struct verify_result {
    const char *path; /* path of the journal; borrowed, and not sent */
    bool is_known;    /* its verification is over; not sent */
    bool is_skipped;  /* another journal failed before, and the run ended there; not sent */
    enum err err;     /* OK, ERR_CHECK if something differs, otherwise why it could not be
                         verified */
    uint64_t executed, compared; /* commands; those with an equal recorded result */
    uint64_t digests;            /* words of those results that are digests */
    uint64_t took_ms;
    struct buf why;     /* reason of a failure: one line without line feed, safe to print */
    struct buf lines;   /* details: lines that begin with "# " */
    struct buf chain;   /* 32 digits: of the last record that was carried out; "" for none */
    struct buf orphans; /* names of orphan golden images, each ended by NUL */
    struct buf slowest; /* slowest records if requested: lines of timing_write */
    struct evidence evidence;
};

void verify_result_release(struct verify_result *result);

/* Note a failure, if it is one. Its words become a line as well, unless the lines already say
 * it. */
void verify_result_fail(struct verify_result *result, enum err err, bool is_told,
                        const struct fault *fault);

/* Add the counts of compared items: "10 commands, 10 results with 14 digests, 1 golden image of
 * 1200 pixels". */
void verify_result_describe(struct buf *out, const struct verify_result *result);

void verify_result_write(struct buf *out, const struct verify_result *result);

/* Fill in the received result. Always release it. ERR_INPUT for bytes of another form. */
enum err verify_result_read(struct verify_result *result, const struct buf *bytes,
                            struct fault *fault);

/* Print a text, to standard output or standard error, and release it. ERR_MEMORY if it failed. */
enum err print_text(struct buf *text, void (*to)(void *context, const char *text),
                    const struct printer *printer, struct fault *fault);

/* Sum of several results. */
struct verify_sum {
    size_t count, verified, failed, skipped; /* journals */
    size_t unreadable;                       /* failed by another error than ERR_CHECK */
    uint64_t took_ms;
    enum err worst; /* any other error is worse than ERR_CHECK */
};
struct verify_sum verify_sum(const struct verify_result *result, size_t count);

/*
 * Reports as JUnit's XML, as JSON, and as one HTML page. The page shows the pictures of each
 * failure side by side. It has no script, and its policy lets a browser fetch nothing.
 */

enum verify_form { VERIFY_JUNIT, VERIFY_HTML, VERIFY_JSON };

/* Write the report on `count` journals as text. */
void verify_report_text(struct buf *out, enum verify_form form, const struct verify_result *result,
                        size_t count);

/* Write the report to `file`, atomically, replacing an existing one. */
enum err verify_report(const char *file, enum verify_form form, const struct verify_result *result,
                       size_t count, struct fault *fault);

/* ---- orphans (orphan.c) ---- */

/*
 * Orphan golden images: pictures in a journal's folder of golden images that no record names
 * (command/golden_files.h). Hidden files, such as drafts, are ignored. So is the image of a
 * `golden` that was killed after the last record, if it and its PNG equal what that command draws
 * now.
 */

struct orphan_search {
    struct interpreter *interp; /* after a replay of the journal */
    const char *journal;
    bool is_strict;    /* every file without a record is an orphan, not only pictures */
    struct buf *lines; /* comments on ignored files; NULL to remove orphans: then no file is
                          ignored, and an orphan is no failure */
};

/* Add the names of all orphans, as "third.exr", each ended by NUL, in order; none if there is no
 * folder. ERR_CHECK, naming the first, if there are any. If the folder is a link, add no name and a
 * comment, or return ERR_CHECK if strict. ERR_CHECK also for a journal that is a link if golden
 * images next to the link differ from those next to the journal. ERR_LIMIT, ERR_IO, ERR_MEMORY: no
 * names are added. */
enum err orphan_find(struct buf *orphans, const struct orphan_search *search, struct fault *fault);

/* Remove an orphan named by orphan_find, and the PNG of an image. ERR_CHECK for a file that this
 * journal cannot have made, and for a journal that is a link: the file is kept. */
enum err orphan_remove(const char *journal, const char *orphan, struct fault *fault);

/* ---- the first difference (first_difference.c) ---- */

/*
 * First record in which two journals differ. Nothing is carried out.
 *
 * FIRST_COMMAND: compare only commands; comments, results and digests may differ. A journal holds
 * commands in canonical form. Commands of a script are compared word by word, whatever their spaces
 * and quotes, and commands that no journal records (questions, for example) are skipped, so that a
 * script and its journal are the same.
 *
 * FIRST_RECORD: compare commands and results; comments and therefore chains may differ. Both must
 * be journals of sound records.
 */

enum first_of { FIRST_COMMAND, FIRST_RECORD };

struct first_difference {
    bool is_there;
    size_t same; /* equal commands before it, or all */
    struct {
        bool has_command;           /* the file has a command there: */
        size_t number, line;        /* in its file, from 1 */
        struct buf command, result; /* as the file holds them: not safe to print */
    } side[2];
};

/* `first` begins as {0}; always release it. Commands after number `last` are not compared; 0 for
 * all. ERR_INPUT, with the name of the file, if it cannot be read or is not sound; ERR_MEMORY. A
 * torn tail is ignored. */
enum err first_difference_find(struct first_difference *first, enum first_of of,
                               const char *const name[2], const struct buf bytes[2], size_t last,
                               struct fault *fault);

/* The same for the files at `path`. */
enum err first_difference_of_files(struct first_difference *first, enum first_of of,
                                   const char *const name[2], const char *const path[2],
                                   size_t last, struct fault *fault);
void first_difference_release(struct first_difference *first);

/* ---- the picture of a comparison (diff.c) ---- */

/*
 * Picture of two sets of labels of one scene: both as the first session shows its own, side by
 * side, and their differences.
 *
 *     +----------+----------+----------+
 *     | A        | B        | A, B     |   strips of words above and below; the lower one lists the
 *     |  (A's    |  (B's    |  (where  |   labels with their Dice, and the colours of the right
 *     pane
 *     |  labels) |  labels) |  not)    |
 *     +----------+----------+----------+
 *
 * View, look, cuts, colours and hidden labels are those of A's session for all panes. The right
 * pane shows all objects of either in grey, and the voxels whose labels differ shine through it:
 * orange if only A has an object there, blue if only B has one, purple if each has another object.
 * People who cannot distinguish red from green can distinguish these. A voxel behind a surface is
 * paler than a visible one.
 */
struct difference_picture {
    const char *name[2];     /* names of A and B; only ASCII is drawn */
    const uint8_t *label[2]; /* [z][y][x] */
    const struct overlap *overlap;
};

/* Draw it into `picture`, colours only; the caller releases it. The session cannot be used
 * afterwards: the labels of its scene are replaced, and its forest no longer fits them. ERR_LIMIT
 * if three views are wider than a picture may be, ERR_MEMORY, ERR_CANCELLED. */
enum err difference_picture_draw(struct picture *picture, struct session *session,
                                 const struct difference_picture *of, struct fault *fault);

#endif
