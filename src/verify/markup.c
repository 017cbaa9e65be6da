#include "verify/markup.h"

#include <string.h>

static void add_escaped(struct buf *out, char c)
{
    switch (c) {
    case '&':
        buf_add_text(out, "&amp;");
        break;
    case '<':
        buf_add_text(out, "&lt;");
        break;
    case '>':
        buf_add_text(out, "&gt;");
        break;
    case '"':
        buf_add_text(out, "&quot;");
        break;
    case '\'':
        buf_add_text(out, "&#39;");
        break;
    default:
        buf_add_char(out, c);
    }
}

void markup_add(struct buf *out, const char *text, size_t length)
{
    struct buf safe = {0};
    for (const char *at = text, *end = text + length; at < end;) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const size_t line = feed ? (size_t)(feed - at) : (size_t)(end - at);
        buf_add_safe(&safe, at, line);
        if (feed)
            buf_add_char(&safe, '\n');
        at += line + (feed != NULL);
    }
    for (const char *at = buf_text(&safe); *at; at++)
        add_escaped(out, *at);
    out->failed = out->failed || safe.failed;
    buf_release(&safe);
}

void markup_add_base64(struct buf *out, const void *bytes, size_t length)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *byte = bytes;
    char four[5] = "";
    buf_add(out, "", 0); /* ended by NUL, also where nothing follows */
    if (!buf_reserve(out, length / 3 * 4 + 4))
        return;
    for (size_t i = 0; i < length; i += 3) {
        const size_t left = length - i;
        const unsigned bits = (unsigned)byte[i] << 16 |
                              (left > 1 ? (unsigned)byte[i + 1] << 8 : 0) |
                              (left > 2 ? byte[i + 2] : 0u);
        four[0] = digit[bits >> 18];
        four[1] = digit[bits >> 12 & 63];
        four[2] = left > 1 ? digit[bits >> 6 & 63] : '=';
        four[3] = left > 2 ? digit[bits & 63] : '=';
        buf_add(out, four, 4);
    }
}
