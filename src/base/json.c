#include "base/json.h"

#include "base/safe.h"

void json_add_text(struct buf *out, const char *text, size_t length)
{
    buf_add_char(out, '"');
    while (length > 0) {
        const size_t n = safe_character(text, length);
        if (n == 0)
            buf_printf(out, "\\u%04x", (unsigned char)*text);
        else if (*text == '"' || *text == '\\')
            buf_printf(out, "\\%c", *text);
        else
            buf_add(out, text, n);
        text += n ? n : 1;
        length -= n ? n : 1;
    }
    buf_add_char(out, '"');
}
