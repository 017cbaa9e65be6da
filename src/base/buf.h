/* SPDX-License-Identifier: MIT */
/*
 * A growable buffer of bytes, always ended by a NUL that is not counted.
 *
 * Failure is sticky: after an allocation has failed, adding does nothing and `failed` stays set, so
 * a writer may add as it likes and check once at the end. `struct buf b = {0}` is a valid empty
 * buffer; buf_release gives the memory back and makes it empty again.
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
void buf_add_blank(struct buf *b); /* unless it is empty: before each of several words */
void buf_printf(struct buf *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
void buf_vprintf(struct buf *b, const char *format, va_list words)
    __attribute__((format(printf, 2, 0)));

/* What follows a noun after a count: buf_printf(b, "%zu voxel%s", n, plural(n)). */
static inline const char *plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}

/* The shortest decimal number that reads back as the same double. */
void buf_add_real(struct buf *b, double value);

/* Adds `length` bytes of `text` with everything a terminal would obey escaped (base/safe.h). */
void buf_add_safe(struct buf *b, const char *text, size_t length);
void buf_add_safe_text(struct buf *b, const char *text); /* all of it */
/* The same in a list of lines: what is longer than some 160 bytes ends with how much is left. */
void buf_add_safe_excerpt(struct buf *b, const char *text, size_t length);

/* Adds bytes as base64 (RFC 4648): four characters for three bytes, padded with '='. */
void buf_add_base64(struct buf *b, const void *bytes, size_t length);

/* Adds a field of a line of CSV: between quotes, which are doubled inside (RFC 4180). */
void buf_add_csv(struct buf *b, const char *text);

/* Makes room for `length` more bytes and returns where they go; the caller adds to b->length.
 * NULL on failure. */
void *buf_reserve(struct buf *b, size_t length);

/* Empties it; the memory stays for what is added next. */
void buf_clear(struct buf *b);
void buf_release(struct buf *b);

/* The content as a string; never NULL. */
const char *buf_text(const struct buf *b);

/* True if the content, a list of texts each ended by NUL, has this one. */
bool buf_lists(const struct buf *b, const char *text, size_t length);

/* True if the content, texts each ended by NUL, contains this text. */
bool buf_lists(const struct buf *b, const char *text, size_t length);

/*
 * Buffers that live as long as one command. Their owner releases all of them at its end, and checks
 * once whether one has failed: until then nothing that was made from them is kept. {0} is empty.
 */
struct arena {
    struct arena_item *last;
    struct buf none; /* in place of a buffer for which there is no memory: it has failed */
};

/* An empty buffer; never NULL. The caller does not release it. */
struct buf *arena_buf(struct arena *arena);
bool arena_failed(const struct arena *arena);
void arena_release(struct arena *arena);

#endif
