/* SPDX-License-Identifier: MIT */
/*
 * Strips: a PNG or OpenEXR file that is written while its picture is drawn.
 *
 * The picture is never there as a whole. Whoever draws some rows of it is lent the memory of those
 * rows, fills it in, and gives it back; the thread that gives the last rows of a strip packs it,
 * for the file has it packed by itself. Packed strips wait in a file without a name beside the one
 * to be, since what stands before them in it, the notes, may follow from the pixels. At the end
 * all of it is copied in order. So the file is a function of the picture alone, byte for byte: how
 * many threads draw, and what comes first, makes no difference.
 *
 * Rows are given by any thread in any order, each once. The file appears whole or not at all.
 */
#ifndef IMAGE_STRIPS_H
#define IMAGE_STRIPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"
#include "image/picture.h"

struct strips;
struct strips_format; /* below; image_strips (image/image_helper.h) has it by a file's name */

/* Begins a file of a picture like this one, which may be without pixels, with these planes
 * (PICTURE_DEPTH ...), those that the format holds. ERR_IO, ERR_MEMORY. */
enum err strips_begin(struct strips **strips, const struct strips_format *format, const char *path,
                      enum file_mode mode, const struct picture *like, unsigned planes,
                      struct fault *fault);

/* Lends the memory of row `top` of the picture and of those after it, at most `most`: how many.
 * *rows is a picture of these, which borrows it. 0 where the file cannot be written any more, which
 * strips_end says. */
uint32_t strips_lend(struct strips *strips, uint32_t top, uint32_t most, struct picture *rows);

/* They are filled in. */
void strips_give(struct strips *strips, uint32_t top, uint32_t rows);

/* The same of a picture that is there, which has these planes. */
void strips_give_all(struct strips *strips, const struct picture *picture);

/* Writes the file, all rows of which were given, with the notes of `like`; or says why there is
 * none. Either way nothing is left of the strips. */
enum err strips_end(struct strips *strips, const struct picture *like, struct fault *fault);

/* There will be no file. NULL is fine. */
void strips_abandon(struct strips *strips);

/* ---- for the formats ---- */

/* A packed strip: where it waits, and what the format has to say of it. */
struct strips_piece {
    uint64_t from;
    size_t bytes;
    uint32_t rows;  /* of the picture */
    uint32_t check; /* of the pixels */
};

/* All pieces of a picture, for the function that writes the file. */
struct strips_pieces {
    const char *path; /* for messages */
    size_t count;
    struct strips_piece *piece; /* [count], from above */
    int fd;                     /* the file without a name that holds them */
};

/* A format of files, by functions. `coder` is its own state. */
struct strips_format {
    uint32_t (*height)(const struct picture *like); /* of a strip; the last one may be lower */
    enum err (*begin)(void **coder, const char *path, const struct picture *like, unsigned planes,
                      struct fault *fault);
    /* Packs rows from `top` on, by any thread. ERR_MEMORY, ERR_INPUT. */
    enum err (*pack)(void *coder, const struct picture *rows, uint32_t top, struct buf *out,
                     uint32_t *check, struct fault *fault);
    /* Writes the file `draft`, which may exist after an error. */
    enum err (*write)(void *coder, const char *draft, const struct picture *like,
                      const struct strips_pieces *pieces, struct fault *fault);
    void (*end)(void *coder);
};

/* out = the bytes of piece `number`. */
enum err strips_read(const struct strips_pieces *pieces, size_t number, struct buf *out,
                     struct fault *fault);

#endif
