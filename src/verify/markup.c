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
