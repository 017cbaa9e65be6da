/*
 * The lines entered before, oldest first, and the file that keeps them between sessions.
 *
 * Not kept: empty lines, a line that begins with a blank, a repetition of the line before, and
 * lines longer than LINE_HISTORY_LONGEST. The file is plain text, a line each, mode 0600. It is
 * read again before it is written, so that two sessions at once lose nothing.
 */
#ifndef TUI_LINE_HISTORY_H
#define TUI_LINE_HISTORY_H

#include <stddef.h>

#include "base/err.h"

enum { LINE_HISTORY_MOST = 1000, LINE_HISTORY_LONGEST = 4096 };

struct line_history {
    char **line; /* line[0] is the oldest */
    size_t count, capacity;
    size_t added; /* how many of them, at the end, are of this session */
};

/* `struct line_history h = {0}` is empty and ready. */
void line_history_release(struct line_history *h);

/* Without memory the line is forgotten: a history is not worth an error. */
void line_history_add(struct line_history *h, const char *text, size_t length);

/* Reads `path` into an empty history; a file that is not there is an empty one. */
enum err line_history_load(struct line_history *h, const char *path, struct fault *fault);

/* Writes the last LINE_HISTORY_MOST lines of the file and of this session to `path`. What is there
 * and is not a regular file is left alone. */
enum err line_history_save(const struct line_history *h, const char *path, struct fault *fault);

#endif
