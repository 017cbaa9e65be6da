/*
 * Golden images that are being accepted: each that differs, or is missing, is drawn again into a
 * draft beside its place, and takes that place only when all of them can, and the journal with
 * them.
 *
 * Who owns: struct golden_accept lives as long as the replay that fills it; its drafts are files,
 * which golden_accept_release removes where they were not published, with their folder where it was
 * made for them.
 */
#ifndef VERIFY_GOLDEN_ACCEPT_H
#define VERIFY_GOLDEN_ACCEPT_H

#include "command/interpreter.h"
#include "journal/record.h"

struct golden_accept {
    struct buf drafts;         /* pairs of a draft and its place, each ended by NUL */
    struct buf folder;         /* of the golden images, where it was made for them; or "" */
    struct buf note;           /* what was wrong with that of the command at hand, "" for nothing */
    struct record_chain chain; /* of the record before it, for the notes in the picture */
    size_t images;
};

/* The judge that takes in every golden image that differs, and its PNG. ERR_CHECK only where the
 * journal gives two pictures one name. It borrows `accept`. */
struct golden_judge golden_accept_judge(struct golden_accept *accept);

/* Gives all drafts their places; interpreter_settle_files then lets that stand or takes it back. */
enum err golden_accept_publish(struct golden_accept *accept, struct interpreter *interp,
                               struct fault *fault);
void golden_accept_release(struct golden_accept *accept);

#endif
