/*
 * Golden images that are being accepted: each that differs, or is missing, is drawn up beside the
 * place it is for, and takes that place only when all of them can, and the journal with them.
 *
 * Who owns: struct accepting lives as long as the replay that fills it; its drafts are files, which
 * accepting_release removes where they were not published.
 */
#ifndef COMMAND_ACCEPTING_H
#define COMMAND_ACCEPTING_H

#include "command/desk.h"
#include "journal/record.h"

struct accepting {
    struct buf drafts;         /* pairs of a draft and its place, each ended by NUL */
    struct buf note;           /* what was wrong with that of the command at hand, "" for nothing */
    struct record_chain chain; /* of the record before it, for the notes in the picture */
    size_t images;
};

/* Where a golden image with that place is to be read: its draft, if there is one, or the place. */
const char *accepting_source(const struct accepting *accepting, const char *path);

/* Draws up golden image `name`, whose place is `path`, and its PNG. `fault` says what is wrong with
 * the present one, and is cleared where OK is returned. ERR_CHECK where it was drawn up before:
 * then the journal gives two pictures that name. */
enum err accepting_take(struct accepting *accepting, struct desk *desk, const char *name,
                        const char *path, struct picture *picture, struct fault *fault);

/* Gives all drafts their places; desk_settle_files keeps that or takes it back. */
enum err accepting_publish(struct accepting *accepting, struct desk *desk, struct fault *fault);
void accepting_release(struct accepting *accepting);

#endif
