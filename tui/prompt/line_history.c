/* SPDX-License-Identifier: MIT */
#include "tui/prompt/line.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/file_log.h"
#include "base/mem.h"

enum { TRIM_AFTER = 1000 };

void line_history_release(struct line_history *h)
{
    for (size_t i = 0; i < h->count; i++)
        free(h->line[i]);
    free(h->line);
    *h = (struct line_history){0};
}

bool line_history_add(struct line_history *h, const char *text, size_t length)
{
    const char *last = h->count > 0 ? h->line[h->count - 1] : "";
    if (length == 0 || length > LINE_HISTORY_LONGEST || text[0] == ' ')
        return false;
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)text[i] < 32 || text[i] == 127)
            return false;
    if ((strlen(last) == length && memcmp(last, text, length) == 0) ||
        !mem_grow(&h->line, &h->capacity, h->count + 1, sizeof *h->line))
        return false;
    char *copy = strndup(text, length);
    if (!copy)
        return false;
    if (h->count == LINE_HISTORY_MOST) {
        free(h->line[0]);
        memmove(h->line, h->line + 1, --h->count * sizeof *h->line);
    }
    h->line[h->count++] = copy;
    return true;
}

/* ---- the file ---- */

bool line_history_path(struct buf *path)
{
    const char *own = getenv("IFTTY_HISTORY"), *state = getenv("XDG_STATE_HOME");
    const char *home = getenv("HOME");
    buf_clear(path);
    if (own)
        buf_add_text(path, own);
    else if (state && *state == '/')
        buf_printf(path, "%s/iftty/history", state);
    else if (home && *home == '/')
        buf_printf(path, "%s/.local/state/iftty/history", home);
    return path->length > 0 && !path->failed;
}

enum err line_history_load(struct line_history *h, const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf content = {0};
    enum err err = file_lines_read(&content, path, LINE_HISTORY_BYTES_MOST, fault);
    const char *text = buf_text(&content), *end = text + (err ? 0 : content.length);
    const char *at = file_lines_last(text, (size_t)(end - text), LINE_HISTORY_MOST);
    while (at < end) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        const size_t length = (size_t)((stop ? stop : end) - at);
        line_history_add(h, at, length);
        at += length + 1;
    }
    h->appended = TRIM_AFTER; /* its length is unknown */
    return err;
}

enum err line_history_append(struct line_history *h, const char *path, struct fault *fault)
{
    const char *line = h->line[h->count - 1];
    enum err err = OK;
    if (!file_exists(path)) {
        OWNED(buf_release) struct buf folder = {0};
        file_folder(&folder, path);
        err = folder.failed ? fault_memory(fault, "a path")
                            : folder_make_private(buf_text(&folder), fault);
    }
    if (!err)
        err = file_lines_append(path, line, strlen(line), fault);
    if (err || h->appended++ < TRIM_AFTER)
        return err;
    h->appended = 0;
    return file_lines_trim(path, LINE_HISTORY_MOST, LINE_HISTORY_BYTES_MOST, fault);
}
