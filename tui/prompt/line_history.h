/* SPDX-License-Identifier: MIT */
/*
 * The lines entered before, oldest first, and the file that stores them between sessions.
 *
 * Not stored: empty lines, a line that begins with a blank, a repetition of the line before, and
 * lines longer than LINE_HISTORY_LONGEST. The file is plain text, a line each, mode 0600. Each line
 * is appended to it when it is entered, so that a session that is killed has lost none, and many
 * sessions at once store the lines of all (base/file_log.h). It is trimmed to the last
 * LINE_HISTORY_MOST lines now and then.
 *
 * Lines of the file that hold control characters are passed over.
 */
#ifndef TUI_PROMPT_LINE_HISTORY_H
#define TUI_PROMPT_LINE_HISTORY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

enum {
    LINE_HISTORY_MOST = 10000,
    LINE_HISTORY_LONGEST = 4096,
    LINE_HISTORY_BYTES_MOST = 4 << 20 /* of the file: no more of it is read, or stored */
};

struct line_history {
    char **line; /* line[0] is the oldest */
    size_t count, capacity;
    size_t appended; /* to the file, since it was trimmed */
};

/* `struct line_history h = {0}` is empty and ready. */
void line_history_release(struct line_history *h);

/* Whether it was stored. Without memory the line is forgotten: a history is not worth an error. */
bool line_history_add(struct line_history *h, const char *text, size_t length);

/* Where the file lies: $IFTTY_HISTORY, else below $XDG_STATE_HOME, else ~/.local/state/iftty. False
 * where there is to be none: the first is empty, or nothing says where. */
bool line_history_path(struct buf *path);

/* Reads the file into an empty history; one that is not there is empty. */
enum err line_history_load(struct line_history *h, const char *path, struct fault *fault);

/* Appends the latest line, which line_history_add has stored. Folders that are not there are
 * made. */
enum err line_history_append(struct line_history *h, const char *path, struct fault *fault);

#endif
