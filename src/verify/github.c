#include "verify/github.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

enum { SUMMARY_MOST = 1 << 20, FAILURES_SHOWN = 50 };

bool github_is_there(void)
{
    const char *actions = getenv("GITHUB_ACTIONS");
    return actions && *actions;
}

/* ---- errors ---- */

/* A value of a workflow command: `also` are further characters that end one. */
static void add_value(struct buf *out, const char *text, const char *also)
{
    struct buf safe = {0};
    buf_add_safe_text(&safe, text);
    for (const char *at = buf_text(&safe); *at; at++) {
        if (*at == '%' || strchr(also, *at))
            buf_printf(out, "%%%02X", (unsigned char)*at);
        else
            buf_add_char(out, *at);
    }
    out->failed = out->failed || safe.failed;
    buf_release(&safe);
}

void github_errors(struct buf *out, const struct verify_result *result, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct verify_result *r = result + i;
        if (!r->err)
            continue;
        buf_add_text(out, "::error file=");
        add_value(out, r->path, ",:");
        if (r->line)
            buf_printf(out, ",line=%" PRIu64, r->line);
        buf_add_text(out, ",title=iftty verify::");
        add_value(out, buf_text(&r->why), "");
        buf_add_char(out, '\n');
    }
}

/* ---- the summary ---- */

static void add_markdown(struct buf *out, const char *text)
{
    struct buf safe = {0};
    buf_add_safe_text(&safe, text);
    for (const char *at = buf_text(&safe); *at; at++) {
        const unsigned char c = (unsigned char)*at;
        if (c < 0x80 && !isalnum(c) && c != ' ')
            buf_printf(out, "&#%u;", c);
        else
            buf_add_char(out, *at);
    }
    out->failed = out->failed || safe.failed;
    buf_release(&safe);
}

static void add_row(struct buf *out, const struct verify_result *r)
{
    buf_add_text(out, r->is_skipped ? "| skipped | "
                      : r->err      ? "| **failed** | "
                                    : "| verified | ");
    add_markdown(out, r->path);
    buf_printf(out, " | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " |\n",
               r->executed, r->digests, r->goldens, r->pixels, r->took_ms);
}

void github_summary(struct buf *out, const struct verify_result *result, size_t count)
{
    const struct verify_sum sum = verify_sum(result, count);
    size_t shown = 0;
    buf_printf(out, "### iftty verify: %zu verified, %zu failed\n\n", sum.verified, sum.failed);
    buf_add_text(out, "| | journal | commands | digests | golden images | pixels | ms |\n"
                      "|---|---|--:|--:|--:|--:|--:|\n");
    for (size_t i = 0; i < count && out->length < SUMMARY_MOST / 2; i++)
        add_row(out, result + i);
    buf_add_char(out, '\n');
    for (size_t i = 0; i < count && shown < FAILURES_SHOWN; i++) {
        if (!result[i].err)
            continue;
        buf_add_text(out, "- ");
        add_markdown(out, result[i].path);
        buf_add_text(out, ": ");
        add_markdown(out, buf_text(&result[i].why));
        buf_add_char(out, '\n');
        shown++;
    }
}

/* ---- both ---- */

/* After what other steps have left there. */
static enum err append(const char *path, const struct buf *text, struct fault *fault)
{
    struct buf whole = {0};
    enum err err = file_exists(path) ? file_read(&whole, path, SUMMARY_MOST, fault) : OK;
    buf_add(&whole, buf_text(text), text->length);
    if (!err && (whole.failed || text->failed))
        err = fault_memory(fault, "a summary");
    if (!err)
        err = file_write(path, buf_text(&whole), whole.length, FILE_REPLACE, fault);
    buf_release(&whole);
    return err;
}

void github_tell(const struct verify_result *result, size_t count, const struct printer *printer)
{
    const char *path = getenv("GITHUB_STEP_SUMMARY");
    struct buf errors = {0}, summary = {0};
    struct fault fault;
    if (!github_is_there())
        return;
    github_errors(&errors, result, count);
    github_summary(&summary, result, count);
    if (path && *path && append(path, &summary, &fault))
        buf_printf(&errors, "# there is no summary: %s\n", fault.text);
    printer->warn(printer->context, buf_text(&errors));
    buf_release(&errors);
    buf_release(&summary);
}
