/* SPDX-License-Identifier: MIT */
/*
 * A source: the bytes of a file, plain or gzip (decided by content, not by name), for the readers
 * of volumes.
 *
 * A gzip is inflated by ISA-L as long as that is right, three times as fast as by zlib, and as fast
 * as by libdeflate, which can only inflate a file as a whole. It has no words for what is wrong:
 * where it fails, or iftty was built without it, zlib begins again, and gets as far.
 *
 * Both work in this process, and are fuzzed with what reads the bytes (tests/fuzz). Inflating in a
 * confined process, into memory that is shared, was tried and costs 9 to 13 ms more for ch2, a
 * tenth of its opening.
 */
#ifndef IMAGE_SOURCE_H
#define IMAGE_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

struct inflater;

/* What decodes a file: its bytes take the place of the file's. */
struct source_decoder {
    enum err (*take)(struct source_decoder *decoder, void *to, size_t length, struct fault *fault);
    void (*free)(struct source_decoder *decoder);
};

struct volume_source {
    const char *path;               /* what was opened; not owned */
    struct watch *watch;            /* of the reading, or NULL; not owned */
    bool is_folder;                 /* nothing of it can be read here */
    struct source_decoder *decoder; /* or NULL; owned */
    uint64_t at;                    /* bytes that were read of the inflater or the decoder */
    struct inflater *inflater;      /* of a gzip, until it fails; owned */
    struct gzFile_s *gz;            /* zlib's, which passes plain bytes on as they are */
    int fd;                         /* owned by gz */
    uint64_t from;                  /* the byte of the file that is the first one here */
    uint64_t bytes;                 /* of the file on disk */
    uint64_t most; /* bytes that it can hold when inflated; deflate's best is 1032-fold */
    bool packed;   /* gzip */
};

/* Refuses what is neither a regular file nor a folder. */
enum err source_open(struct volume_source *source, const char *path, struct watch *watch,
                     struct fault *fault);
void source_close(struct volume_source *source);

/* Goes on with another file, from its first byte; `path` stays. Refuses what is no regular file;
 * then it is as before. */
enum err source_switch(struct volume_source *source, const char *path, struct fault *fault);

/* What is in the same file from that byte on, as if it were all of it: a gzip there is inflated.
 * Where in the file they read is one place for both, so `of` is only to be closed after this. */
enum err source_enter(struct volume_source *source, const struct volume_source *of, uint64_t from,
                      struct fault *fault);

/* The first bytes, at most `most`, without going on; returns how many there are. */
size_t source_peek(struct volume_source *source, uint8_t *bytes, size_t most);

/* The next `length` bytes; and going on at a later one, or at an earlier one, but not of a decoder.
 * `part` is for the words of an error. */
enum err source_read(struct volume_source *source, void *to, size_t length, const char *part,
                     struct watch *watch, struct fault *fault);
enum err source_go_to(struct volume_source *source, uint64_t offset, const char *part,
                      struct fault *fault);

/* After the last byte that is wanted. Where the stream ends soon after it, as it should, the
 * checksum of a gzip is compared; a stream that goes on for longer is left alone. */
enum err source_finish(struct volume_source *source, struct fault *fault);

#endif
