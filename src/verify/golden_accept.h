/*
 * Golden images that are being accepted: each that differs, or is missing, is drawn up beside the
 * place it is for, and takes that place only when all of them can, and the journal with them.
 *
 * Who owns: struct accepting lives as long as the replay that fills it; its drafts are files, which
 * golden_accept_release removes where they were not published.
 */
#ifndef VERIFY_GOLDEN_ACCEPT_H
#define VERIFY_GOLDEN_ACCEPT_H

#include "command/interpreter.h"
#include "journal/record.h"

struct golden_accept {
    struct buf drafts;         /* pairs of a draft and its place, each ended by NUL */
    struct buf note;           /* what was wrong with that of the command at hand, "" for nothing */
    struct record_chain chain; /* of the record before it, for the notes in the picture */
    size_t images;
};

/* Where a golden image with that place is to be read: its draft, if there is one, or the place. */
const char *golden_accept_source(const struct golden_accept *golden_accept, const char *path);

/* Draws up golden image `name`, whose place is `path`, and its PNG. `fault` says what is wrong with
 * the present one, and is cleared where OK is returned. ERR_CHECK where it was drawn up before:
 * then the journal gives two pictures that name. */
enum err golden_accept_take(struct golden_accept *golden_accept, struct interpreter *interp,
                            const char *name, const char *path, struct picture *picture,
                            struct fault *fault);

/* Gives all drafts their places; interpreter_settle_files keeps that or takes it back. */
enum err golden_accept_publish(struct golden_accept *golden_accept, struct interpreter *interp,
                               struct fault *fault);
void golden_accept_release(struct golden_accept *golden_accept);

#endif
