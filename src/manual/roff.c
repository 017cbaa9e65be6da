/* SPDX-License-Identifier: MIT */
#include "manual/roff.h"

#include <ctype.h>
#include <string.h>

enum { LINE_MOST = 78 };

/* Characters that would be set as others, as '-' is as a hyphen; a line may end after '|'. */
void roff_add_escaped(struct buf *out, const char *text, size_t length)
{
    static const char plain[] = "\\-`'~^\"|";
    static const char *const set[] = {"\\e",   "\\-",   "\\(ga", "\\(aq",
                                      "\\(ti", "\\(ha", "\\(dq", "|\\:"};
    for (size_t i = 0; i < length; i++) {
        const char *special = text[i] ? strchr(plain, text[i]) : NULL;
        if (special)
            buf_add_text(out, set[special - plain]);
        else
            buf_add_char(out, text[i]);
    }
}

void roff_add_word(struct roff_lines *lines, const struct buf *word)
{
    if (lines->column && lines->column + 1 + word->length > LINE_MOST) {
        buf_add_char(lines->out, '\n');
        lines->column = 0;
    }
    const char *before = lines->column ? " " : *buf_text(word) == '.' ? "\\&" : "";
    buf_printf(lines->out, "%s%s", before, buf_text(word));
    lines->column += strlen(before) + word->length;
    lines->out->failed |= word->failed;
}

void roff_add_text(struct buf *out, const char *text, const char *between)
{
    struct buf word = {0};
    struct roff_lines lines = {out, 0};
    while (*text) {
        const size_t length = strcspn(text, " \n");
        buf_clear(&word);
        roff_add_escaped(&word, text, length);
        roff_add_word(&lines, &word);
        text += length;
        if (*text == '\n' && text[1]) {
            buf_printf(out, "\n%s\n", between);
            lines.column = 0;
        }
        text += strspn(text, " \n");
    }
    buf_add_char(out, '\n');
    buf_release(&word);
}

void roff_add_verbatim(struct buf *out, const char *text, size_t length)
{
    struct buf piece = {0};
    size_t column = 0;
    if (length && *text == '.')
        buf_add_text(out, "\\&");
    for (size_t i = 0; i < length; i++) {
        buf_clear(&piece);
        roff_add_escaped(&piece, text + i, 1);
        if (column + piece.length > LINE_MOST - 2) {
            buf_add_text(out, "\\\n");
            column = 0;
        }
        buf_add_text(out, buf_text(&piece));
        column += piece.length;
    }
    buf_add_char(out, '\n');
    out->failed |= piece.failed;
    buf_release(&piece);
}

void roff_add_capitals(struct buf *out, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        buf_add_char(out, (char)toupper((unsigned char)text[i]));
}
