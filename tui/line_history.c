#include "tui/line_history.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/mem.h"

static const size_t file_most = (size_t)LINE_HISTORY_MOST * (LINE_HISTORY_LONGEST + 1) * 2;

void line_history_release(struct line_history *h)
{
    for (size_t i = 0; i < h->count; i++)
        free(h->line[i]);
    free(h->line);
    *h = (struct line_history){0};
}

static bool is_worth_keeping(const struct line_history *h, const char *text, size_t length)
{
    if (length == 0 || length > LINE_HISTORY_LONGEST || text[0] == ' ' || memchr(text, 0, length))
        return false;
    const char *last = h->count > 0 ? h->line[h->count - 1] : "";
    return strlen(last) != length || memcmp(last, text, length) != 0;
}

void line_history_add(struct line_history *h, const char *text, size_t length)
{
    if (!is_worth_keeping(h, text, length) ||
        !mem_grow(&h->line, &h->capacity, h->count + 1, sizeof *h->line))
        return;
    char *copy = strndup(text, length);
    if (!copy)
        return;
    if (h->count == LINE_HISTORY_MOST) {
        free(h->line[0]);
        memmove(h->line, h->line + 1, --h->count * sizeof *h->line);
    }
    h->line[h->count++] = copy;
    if (h->added < h->count)
        h->added++;
}

enum err line_history_load(struct line_history *h, const char *path, struct fault *fault)
{
    struct buf content = {0};
    if (!file_exists(path))
        return OK;
    enum err err = file_read(&content, path, file_most, fault);
    const char *at = buf_text(&content), *end = at + (err ? 0 : content.length);
    while (at < end) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        size_t length = (size_t)((stop ? stop : end) - at);
        line_history_add(h, at, length);
        at += length + 1;
    }
    h->added = 0;
    buf_release(&content);
    return err;
}

enum err line_history_save(const struct line_history *h, const char *path, struct fault *fault)
{
    struct line_history all = {0};
    struct buf content = {0};
    enum err err = line_history_load(&all, path, fault);
    if (err || h->added == 0)
        goto done;
    for (size_t i = h->count - h->added; i < h->count; i++)
        line_history_add(&all, h->line[i], strlen(h->line[i]));
    for (size_t i = 0; i < all.count; i++) {
        buf_add_text(&content, all.line[i]);
        buf_add_char(&content, '\n');
    }
    if (content.failed) {
        err = fault_memory(fault, "the history");
        goto done;
    }
    mode_t before = umask(0077); /* what was typed is nobody else's business */
    err = file_write(path, content.data, content.length, FILE_REPLACE, fault);
    umask(before);
done:
    line_history_release(&all);
    buf_release(&content);
    return err;
}
