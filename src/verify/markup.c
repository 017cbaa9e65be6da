#include "verify/markup.h"

#include <string.h>

static void add_escaped(struct buf *out, char c)
{
    static const char special[] = "&<>\"'";
    static const char *const entity[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    const char *found = strchr(special, c);
    if (found)
        buf_add_text(out, entity[found - special]);
    else
        buf_add_char(out, c);
}

void markup_add(struct buf *out, const char *text)
{
    struct buf safe = {0};
    for (const char *at = text; *at;) {
        const size_t line = strcspn(at, "\n");
        buf_add_safe(&safe, at, line);
        at += line;
        if (*at)
            buf_add_char(&safe, *at++);
    }
    for (const char *at = buf_text(&safe); *at; at++)
        add_escaped(out, *at);
    out->failed = out->failed || safe.failed;
    buf_release(&safe);
}
