/* SPDX-License-Identifier: MIT */
/*
 * Resealing a journal: the honest way to change one. It is carried out again, every record that
 * gives another result gets that of today and a comment that says why, with what it said before,
 * and the former journal is stored beside it. Nothing else changes.
 *
 *     # accepted: softer light (golden image left: 512 pixels differ, first column 3, row 4: ...)
 *     # it was: chain=<32 digits> picture=0123456789abcdef
 *     golden left
 *     = 12 picture=fedcba9876543210 chain=<32 digits>
 *
 * A journal names its golden images, so accepting one is a change of the journal, even where only
 * the file is drawn again: the reason is part of the chain from then on.
 *
 * Promises
 *     (R1) whole or not at all: golden images and journal are all as they were, or all new;
 *     (R2) what is written verifies, here and now, but for pictures that a reviewer leaves;
 *     (R3) the bytes of the former journal stay, as FILE.before-N;
 *     (R4) nobody else writes the journal meanwhile.
 */
#ifndef VERIFY_RESEAL_H
#define VERIFY_RESEAL_H

#include "command/golden_judge.h"
#include "command/script.h"

/* Who looks at the pictures of a journal that differ, one by one, and decides about each. The
 * program has one that shows them at the terminal; the verification knows no terminal. */
enum review_answer {
    REVIEW_ACCEPT, /* it is right as it is drawn now */
    REVIEW_REJECT, /* it is wrong: what is stored stays, and the journal goes on failing */
    REVIEW_SKIP,   /* not decided: the same */
    REVIEW_ANSWERS
};

struct review_question {
    size_t record; /* of the journal, and its command: not safe to print */
    const char *command;
    const char *wrong;                    /* in words */
    const struct golden_finding *finding; /* NULL for a picture that is no golden image */
};

struct reviewer {
    void *context;
    /* `why` holds the reason that was given last, "" at first, and is to hold one line where the
     * answer is REVIEW_ACCEPT. An error ends the review, and nothing has changed. */
    enum err (*ask)(void *context, const struct review_question *question, struct buf *why,
                    enum review_answer *answer, struct fault *fault);
};

/* `iftty verify --accept WHY`: golden images that differ or are missing are drawn again, and
 * records of pictures get today's digests. Refused where a record gives another result that is no
 * picture's, where the journal was edited, where an orphan lies in its folder (ERR_CHECK), and
 * where the environment variable CI is set (ERR_USAGE): accepting is a person's decision. */
enum err reseal_accept(struct interpreter *interp, const char *path, const char *why,
                       const struct printer *printer, struct fault *fault);

/* `iftty verify --review`: the same, where a person is asked about each picture. Those that are not
 * accepted stay as they were, with their records: ERR_CHECK. Orphans are left alone. */
enum err reseal_review(struct interpreter *interp, const char *path,
                       const struct reviewer *reviewer, const struct printer *printer,
                       struct fault *fault);

/* ERR_USAGE for a reason that cannot be a comment of a record. */
enum err reseal_check_reason(const char *why, struct fault *fault);

/* `iftty log --reseal`: a journal that was edited by hand, or that another version wrote, gets the
 * results that its commands give here. With a reason, `--accept WHY`, its pictures are accepted in
 * the same step. Without one golden images are left alone, and counted where they are others
 * now. */
enum err reseal_edited(struct interpreter *interp, const char *path, const char *why,
                       const struct printer *printer, struct fault *fault);

#endif
