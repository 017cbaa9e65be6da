/* SPDX-License-Identifier: MIT */
#include "base/buf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"

void *buf_reserve(struct buf *b, size_t length)
{
    if (b->failed || length > SIZE_MAX - b->length - 1 ||
        !mem_grow(&b->data, &b->capacity, b->length + length + 1, 1)) {
        b->failed = true;
        return NULL;
    }
    return b->data + b->length;
}

void buf_add(struct buf *b, const void *bytes, size_t length)
{
    void *place = buf_reserve(b, length);
    if (!place)
        return;
    if (length)
        memcpy(place, bytes, length);
    b->length += length;
    b->data[b->length] = '\0';
}

void buf_add_text(struct buf *b, const char *text)
{
    buf_add(b, text, strlen(text));
}

void buf_add_char(struct buf *b, char c)
{
    buf_add(b, &c, 1);
}

void buf_add_blank(struct buf *b)
{
    if (b->length)
        buf_add_char(b, ' ');
}

void buf_vprintf(struct buf *b, const char *format, va_list words)
{
    va_list again;
    va_copy(again, words);
    const int length = vsnprintf(NULL, 0, format, words);
    char *place = length < 0 ? NULL : buf_reserve(b, (size_t)length);
    if (place) {
        vsnprintf(place, (size_t)length + 1, format, again);
        b->length += (size_t)length;
    }
    va_end(again);
}

void buf_add_real(struct buf *b, double value)
{
    char text[32];
    int digits = 6;
    do
        snprintf(text, sizeof text, "%.*g", digits, value);
    while (digits++ < 17 && !(strtod(text, NULL) >= value && strtod(text, NULL) <= value));
    buf_add_text(b, text);
}

void buf_printf(struct buf *b, const char *format, ...)
{
    va_list words;
    va_start(words, format);
    buf_vprintf(b, format, words);
    va_end(words);
}

void buf_add_safe(struct buf *b, const char *text, size_t length)
{
    if (length > (SIZE_MAX - 4) / 4) {
        b->failed = true;
        return;
    }
    char *place = buf_reserve(b, 4 * length + 4); /* at worst \xNN for each byte, so nothing is cut
                                                     */
    if (place)
        b->length += safe_copy(place, 4 * length + 4, text, length);
}

void buf_add_safe_text(struct buf *b, const char *text)
{
    buf_add_safe(b, text, strlen(text));
}

void buf_add_safe_excerpt(struct buf *b, const char *text, size_t length)
{
    enum { SHOWN = 160 };
    size_t shown = length;
    if (length > SHOWN)
        for (shown = SHOWN; shown > SHOWN / 2 && text[shown] != ' ';)
            shown--;
    buf_add_safe(b, text, shown);
    if (shown < length)
        buf_printf(b, " ... (%zu bytes more)", length - shown);
}

static char *put_base64(char *place, uint32_t bits)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (unsigned i = 0; i < 4; i++)
        *place++ = digit[bits >> (18 - 6 * i) & 63];
    return place;
}

void buf_add_base64(struct buf *b, const void *bytes, size_t length)
{
    const uint8_t *byte = bytes;
    const size_t characters = (length + 2) / 3 * 4;
    char *place = buf_reserve(b, characters);
    if (!place)
        return;
    b->length += characters;
    for (; length >= 3; byte += 3, length -= 3)
        place = put_base64(place, (uint32_t)byte[0] << 16 | (uint32_t)byte[1] << 8 | byte[2]);
    if (length > 0) {
        place = put_base64(place, (uint32_t)byte[0] << 16 | (length > 1 ? byte[1] * 256u : 0));
        place[-1] = '=';
        if (length == 1)
            place[-2] = '=';
    }
    *place = '\0';
}

/* Capacity of a buffer that stays failed. */
#define NEVER SIZE_MAX

void buf_clear(struct buf *b)
{
    b->length = 0;
    b->failed = b->capacity == NEVER;
    if (b->data)
        b->data[0] = '\0';
}

void buf_release(struct buf *b)
{
    free(b->data);
    *b = (struct buf){0};
}

const char *buf_text(const struct buf *b)
{
    return b->data ? b->data : "";
}

bool buf_lists(const struct buf *b, const char *text, size_t length)
{
    const char *at = buf_text(b), *end = at + b->length;
    while (at < end && (strlen(at) != length || memcmp(at, text, length) != 0))
        at += strlen(at) + 1;
    return at < end;
}

/* ---- arenas ---- */

struct arena_item {
    struct arena_item *before;
    struct buf buf;
};

struct buf *arena_buf(struct arena *arena)
{
    struct arena_item *item = mem_new(sizeof *item);
    if (!item) {
        arena->failed = true;
        arena->none = (struct buf){.capacity = NEVER, .failed = true};
        return &arena->none;
    }
    item->before = arena->last;
    arena->last = item;
    return &item->buf;
}

bool arena_failed(const struct arena *arena)
{
    bool failed = arena->failed;
    for (const struct arena_item *item = arena->last; item; item = item->before)
        failed |= item->buf.failed;
    return failed;
}

void arena_release(struct arena *arena)
{
    for (struct arena_item *item = arena->last, *before; item; item = before) {
        before = item->before;
        buf_release(&item->buf);
        free(item);
    }
    *arena = (struct arena){0};
}

void buf_add_csv(struct buf *b, const char *text)
{
    buf_add_char(b, '"');
    for (; *text; text++) {
        if (*text == '"')
            buf_add_char(b, '"');
        buf_add_char(b, *text);
    }
    buf_add_char(b, '"');
}
