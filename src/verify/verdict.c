#include "verify/verdict.h"

#include <inttypes.h>
#include <string.h>

#include "base/scan.h"

void verdict_release(struct verdict *verdict)
{
    buf_release(&verdict->why);
    buf_release(&verdict->lines);
    evidence_release(&verdict->evidence);
}

void verdict_write(struct buf *out, const struct verdict *v)
{
    buf_printf(out, "verdict %d %" PRIu64 " %" PRIu64 " %" PRIu64 " %zu %zu %zu\n", (int)v->err,
               v->executed, v->compared, v->took_ms, v->why.length, v->lines.length,
               v->evidence.pictures);
    buf_add(out, buf_text(&v->why), v->why.length);
    buf_add(out, buf_text(&v->lines), v->lines.length);
    for (size_t i = 0; i < v->evidence.pictures; i++) {
        const struct buf *caption = &v->evidence.picture[i].caption,
                         *png = &v->evidence.picture[i].png;
        buf_printf(out, "picture %zu %zu\n", caption->length, png->length);
        buf_add(out, buf_text(caption), caption->length);
        buf_add(out, buf_text(png), png->length);
    }
}

/* "NAME N N ...\n" */
static bool read_numbers(const char **at, const char *name, int64_t *number, size_t count)
{
    if (!scan_text(at, name))
        return false;
    for (size_t i = 0; i < count; i++)
        if (!scan_text(at, " ") || !scan_integer(at, 0, INT64_MAX, number + i))
            return false;
    return scan_text(at, "\n");
}

static bool read_bytes(const char **at, const char *end, struct buf *out, int64_t length)
{
    if (length > end - *at)
        return false;
    buf_add(out, *at, (size_t)length);
    *at += length;
    return !out->failed;
}

static bool read_picture(const char **at, const char *end, struct evidence *evidence)
{
    int64_t length[2];
    struct buf *caption = &evidence->picture[evidence->pictures].caption,
               *png = &evidence->picture[evidence->pictures].png;
    if (!read_numbers(at, "picture", length, 2) || !read_bytes(at, end, caption, length[0]) ||
        !read_bytes(at, end, png, length[1]))
        return false;
    evidence->pictures++;
    return true;
}

/* `at` is ended by a NUL, behind `end`, so that no number is read beyond it. */
static bool read_all(struct verdict *v, const char *at, const char *end)
{
    int64_t number[7];
    if (!read_numbers(&at, "verdict", number, 7) || number[0] > ERR_CANCELLED ||
        number[6] > EVIDENCE_MOST)
        return false;
    v->err = (enum err)number[0];
    v->executed = (uint64_t)number[1];
    v->compared = (uint64_t)number[2];
    v->took_ms = (uint64_t)number[3];
    if (!read_bytes(&at, end, &v->why, number[4]) || !read_bytes(&at, end, &v->lines, number[5]))
        return false;
    for (int64_t i = 0; i < number[6]; i++)
        if (!read_picture(&at, end, &v->evidence))
            return false;
    return at == end;
}

enum err verdict_read(struct verdict *verdict, const char *bytes, size_t length,
                      struct fault *fault)
{
    struct buf text = {0};
    enum err err = OK;
    buf_add(&text, bytes, length);
    if (text.failed)
        err = fault_memory(fault, "a verdict");
    else if (!read_all(verdict, buf_text(&text), buf_text(&text) + length))
        err = fault_set(fault, ERR_INPUT, "no verdict, or half of one: %zu bytes", length);
    buf_release(&text);
    return err;
}
