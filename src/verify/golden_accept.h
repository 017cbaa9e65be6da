/*
 * Golden images that are being accepted: each that differs, or is missing, and that a reviewer, if
 * there is one, finds right, is drawn again into a draft beside its place, and takes that place
 * only when all of them can, and the journal with them.
 *
 * Who owns: struct golden_accept lives as long as the replay that fills it; its drafts are files,
 * which golden_accept_release removes where they were not published, with their folder where it was
 * made for them.
 */
#ifndef VERIFY_GOLDEN_ACCEPT_H
#define VERIFY_GOLDEN_ACCEPT_H

#include "command/interpreter.h"
#include "journal/record.h"
#include "verify/reviewer.h"

struct golden_accept {
    struct buf drafts;         /* pairs of a draft and its place, each ended by NUL */
    struct buf folder;         /* of the golden images, where it was made for them; or "" */
    struct buf note;           /* what was wrong with that of the command at hand, "" for nothing */
    struct record_chain chain; /* of the record before it, for the notes in the picture */
    struct buf why;            /* the reason, one line */
    const struct reviewer *reviewer; /* who is asked about each picture; NULL: all are accepted */
    const struct record *record;     /* the one at hand */
    bool is_left;                    /* its picture is not accepted: it stays as it was */
    size_t images;                   /* golden images accepted */
    size_t answers[REVIEW_ANSWERS];  /* pictures that were asked about */
};

/* Asks the reviewer about the picture of the record at hand; `wrong` is what is wrong with it. Sets
 * is_left where it is not accepted. */
enum err golden_accept_ask(struct golden_accept *accept, const struct golden_finding *finding,
                           const char *wrong, struct fault *fault);

/* The judge that takes in golden images that differ, and their PNGs. ERR_CHECK only where the
 * journal gives two pictures one name. It borrows `accept`. */
struct golden_judge golden_accept_judge(struct golden_accept *accept);

/* Gives all drafts their places; interpreter_settle_files then lets that stand or takes it back. */
enum err golden_accept_publish(struct golden_accept *accept, struct interpreter *interp,
                               struct fault *fault);
void golden_accept_release(struct golden_accept *accept);

#endif
