/* SPDX-License-Identifier: MIT */
/*
 * Strips: a PNG or OpenEXR file that is written while its picture is drawn.
 *
 * The whole picture is never in memory. A thread acquires rows with strips_lend, fills and releases
 * them with strips_give; the thread that releases the last rows of a strip compresses it, since the
 * file stores each strip separately. Compressed strips wait in a file without a name, because the
 * notes before them in the final file may depend on the pixels. At the end everything is copied in
 * order. So the file depends on the picture alone, byte for byte, not on the number and order of
 * the threads.
 *
 * Any thread may release rows, in any order, each once. The file is published atomically.
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
struct strips_format; /* below; image_strips (image/image_helper.h) finds it by a file's name */

/* Begin a file of a picture like this one, which needs no pixels, with these planes (PICTURE_DEPTH
 * ...) as far as the format stores them. ERR_IO, ERR_MEMORY. */
enum err strips_begin(struct strips **strips, const struct strips_format *format, const char *path,
                      enum file_mode mode, const struct picture *like, unsigned planes,
                      struct fault *fault);

/* Acquire memory for rows from `top`, at most `most`; returns their number. *rows is a picture of
 * these rows, which borrows it. 0 if the file cannot be written any more; strips_end reports it. */
uint32_t strips_lend(struct strips *strips, uint32_t top, uint32_t most, struct picture *rows);

/* Release rows that are filled. */
void strips_give(struct strips *strips, uint32_t top, uint32_t rows);

/* Write the file, after all rows, with the notes of `like`, or report an error. Frees the strips in
 * both cases. */
enum err strips_end(struct strips *strips, const struct picture *like, struct fault *fault);

/* Free the strips without a file; accepts NULL. */
void strips_abandon(struct strips *strips);

/* Write a complete picture, with its notes. The same errors, and those of the format. */
enum err strips_write(const struct strips_format *format, const char *path, enum file_mode mode,
                      const struct picture *picture, struct fault *fault);

/* ---- for the formats ---- */

/* A compressed strip in the file of pieces. */
struct strips_piece {
    uint64_t from;
    size_t bytes;
    uint32_t rows;  /* number of rows */
    uint32_t check; /* checksum of the pixels */
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
    bool holds_planes; /* all of the picture; otherwise its visible colours alone */
    uint32_t (*height)(const struct picture *like); /* rows of a strip; the last one may be lower */
    enum err (*begin)(void **coder, const char *path, const struct picture *like, unsigned planes,
                      struct fault *fault);
    /* Compresses rows from `top`, in any thread. ERR_MEMORY, ERR_INPUT. */
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
