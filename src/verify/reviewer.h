/*
 * Who looks at the pictures of a journal that differ, one by one, and decides about each. The
 * program has one that shows them at the terminal; the verification knows no terminal.
 */
#ifndef VERIFY_REVIEWER_H
#define VERIFY_REVIEWER_H

#include "base/buf.h"
#include "command/golden_judge.h"

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

#endif
