/* SPDX-License-Identifier: MIT */
/*
 * A source: the bytes of a file, plain or gzip (decided by content, not by name), for the readers
 * of volumes.
 *
 * ISA-L inflates gzip, three times as fast as zlib, and as fast as libdeflate, which can only
 * inflate a whole file. It does not describe errors: if it fails, or iftty was built without it,
 * zlib starts over and reaches the same position.
 *
 * Both work in this process, and are fuzzed with the readers (tests/fuzz). A confined process that
 * inflates into shared memory was tried: it costs 9 to 13 ms more for ch2, a tenth of its opening.
 */
#ifndef IMAGE_SOURCE_H
#define IMAGE_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

struct inflater;

/* A decoder, whose bytes replace those of the file. */
struct source_decoder {
    enum err (*take)(struct source_decoder *decoder, void *to, size_t length, struct fault *fault);
    void (*free)(struct source_decoder *decoder);
};

struct volume_source {
    const char *path;               /* not owned */
    struct watch *watch;            /* watches the reading; not owned; or NULL */
    bool is_folder;                 /* a folder has no bytes */
    struct source_decoder *decoder; /* owned; or NULL */
    uint64_t at;                    /* bytes read from the inflater or the decoder */
    struct inflater *inflater;      /* inflates gzip until it fails; owned */
    struct gzFile_s *gz;            /* zlib's file, which passes plain bytes unchanged */
    int fd;                         /* owned by gz */
    uint64_t from;                  /* offset in the file of the first byte */
    uint64_t bytes;                 /* size of the file on disk */
    uint64_t most;                  /* most bytes when inflated; deflate's best is 1032-fold */
    bool packed;                    /* gzip */
};

/* Open a regular file or a folder; refuse everything else. */
enum err source_open(struct volume_source *source, const char *path, struct watch *watch,
                     struct fault *fault);
void source_close(struct volume_source *source);

/* Continue with another file, from its first byte; `path` keeps its value. Refuses everything but a
 * regular file, and is unchanged then. */
enum err source_switch(struct volume_source *source, const char *path, struct fault *fault);

/* Open the rest of the same file from that byte, as if it were a file: a gzip there is inflated.
 * Both share one file position, so the only valid call on `of` is then source_close. */
enum err source_enter(struct volume_source *source, const struct volume_source *of, uint64_t from,
                      struct fault *fault);

/* Copy the first bytes, at most `most`, without advancing; returns their number. */
size_t source_peek(struct volume_source *source, uint8_t *bytes, size_t most);

/* Read the next `length` bytes; and move to a later byte, or without a decoder to an earlier one.
 * `part` is named in an error. */
enum err source_read(struct volume_source *source, void *to, size_t length, const char *part,
                     struct watch *watch, struct fault *fault);
enum err source_go_to(struct volume_source *source, uint64_t offset, const char *part,
                      struct fault *fault);

/* Call after the last byte that is needed. Checks the checksum of a gzip that ends within 64 kB, as
 * it should; a longer rest is ignored. */
enum err source_finish(struct volume_source *source, struct fault *fault);

#endif
