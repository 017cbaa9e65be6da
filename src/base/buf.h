/* SPDX-License-Identifier: MIT */
/*
 * A growable buffer of bytes, always terminated by a NUL that is not counted.
 *
 * Failure is sticky: after a failed allocation, appending does nothing and `failed` stays set, so a
 * writer appends without checks and checks once at the end. `struct buf b = {0}` is a valid empty
 * buffer; buf_release frees the memory and makes it empty again.
 */
#ifndef BASE_BUF_H
#define BASE_BUF_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct buf {
    char *data; /* NULL until something was added; use buf_text for a string */
    size_t length;
    size_t capacity;
    bool failed;
};

void buf_add(struct buf *b, const void *bytes, size_t length);
void buf_add_text(struct buf *b, const char *text);
void buf_add_char(struct buf *b, char c);
void buf_add_blank(struct buf *b); /* a blank between words: nothing while the buffer is empty */
void buf_printf(struct buf *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
void buf_vprintf(struct buf *b, const char *format, va_list words)
    __attribute__((format(printf, 2, 0)));

/* The plural ending of a noun after a count: buf_printf(b, "%zu voxel%s", n, plural(n)). */
static inline const char *plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}

/* Append the shortest decimal number that reads back as the same double. */
void buf_add_real(struct buf *b, double value);

/* Append `length` bytes of `text`, with everything that a terminal would obey escaped
 * (base/safe.h). */
void buf_add_safe(struct buf *b, const char *text, size_t length);
void buf_add_safe_text(struct buf *b, const char *text); /* the whole text */
/* The same for lists of lines: a text longer than some 160 bytes is cut, with a count of the bytes
 * left out. */
void buf_add_safe_excerpt(struct buf *b, const char *text, size_t length);

/* Append bytes as base64 (RFC 4648): four characters for three bytes, padded with '='. */
void buf_add_base64(struct buf *b, const void *bytes, size_t length);

/* Append a field of a CSV line: in quotes, with quotes inside doubled (RFC 4180). */
void buf_add_csv(struct buf *b, const char *text);

/* Make room for `length` more bytes and return their address; the caller adds to b->length. NULL on
 * failure. */
void *buf_reserve(struct buf *b, size_t length);

/* Make it empty; the memory is kept for the next content. */
void buf_clear(struct buf *b);
void buf_release(struct buf *b);

/* Return the content as a string, never NULL. */
const char *buf_text(const struct buf *b);

/* True if the content, texts each ended by NUL, contains this text. */
bool buf_lists(const struct buf *b, const char *text, size_t length);

/*
 * Buffers that live as long as one command. Their owner releases all of them at its end, and checks
 * once whether one has failed: until then nothing that was made from them is kept. {0} is empty.
 */
struct arena {
    struct arena_item *last;
    struct buf none; /* replaces each buffer without memory: empty and failed, even if cleared */
    bool failed;     /* `none` was handed out */
};

/* An empty buffer; never NULL. The caller does not release it. */
struct buf *arena_buf(struct arena *arena);
bool arena_failed(const struct arena *arena);
void arena_release(struct arena *arena);

#endif
