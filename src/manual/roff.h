/* SPDX-License-Identifier: MIT */
/* Text as groff and mandoc set it, in the macros of man(7): characters that would be set as others
 * are escaped, and no line is longer than a linter likes. */
#ifndef MANUAL_ROFF_H
#define MANUAL_ROFF_H

#include "base/buf.h"

/* Plain characters, one after the other. */
void roff_add_escaped(struct buf *out, const char *text, size_t length);

/* Running text word by word. `word` is escaped by now, has at least one byte and no blank; whoever
 * has added the last one ends the line. */
struct roff_lines {
    struct buf *out;
    size_t column;
};
void roff_add_word(struct roff_lines *lines, const struct buf *word);

/* Plain words; each line feed of `text` ends a paragraph, which `between` parts from the next. */
void roff_add_text(struct buf *out, const char *text, const char *between);

/* A line that is shown as it is, without its line feed: more of the width than it takes, and it is
 * written in pieces that are set as one. */
void roff_add_verbatim(struct buf *out, const char *text, size_t length);

void roff_add_capitals(struct buf *out, const char *text, size_t length);

#endif
