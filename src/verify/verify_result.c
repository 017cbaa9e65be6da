/* SPDX-License-Identifier: MIT */
#include "verify/verify.h"
#include "verify/verify_inside.h"

#include <inttypes.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/scan.h"

void verify_result_release(struct verify_result *result)
{
    buf_release(&result->why);
    buf_release(&result->lines);
    buf_release(&result->chain);
    buf_release(&result->orphans);
    buf_release(&result->slowest);
    evidence_release(&result->evidence);
}

void verify_result_fail(struct verify_result *result, enum err err, bool is_told,
                        const struct fault *fault)
{
    result->err = err;
    if (!err)
        return;
    buf_add_text(&result->why, fault->text);
    if (!is_told)
        buf_printf(&result->lines, "# %s\n", fault->text);
}

void verify_result_describe(struct buf *out, const struct verify_result *r)
{
    buf_printf(out,
               "%" PRIu64 " command%s, %" PRIu64 " result%s with %" PRIu64 " digest%s, %" PRIu64
               " golden image%s of %" PRIu64 " pixel%s",
               r->executed, plural(r->executed), r->compared, plural(r->compared), r->digests,
               plural(r->digests), r->evidence.goldens, plural(r->evidence.goldens),
               r->evidence.pixels, plural(r->evidence.pixels));
}

/* ---- through a pipe ---- */

enum { NUMBERS = 8 };

/* Return the parts of variable length in the order of sending; NULL after the last. */
static struct buf *part_of(const struct verify_result *result, size_t number)
{
    struct verify_result *r = (struct verify_result *)(uintptr_t)result;
    struct buf *const part[] = {&r->why, &r->lines, &r->chain, &r->orphans, &r->slowest};
    enum { PARTS = sizeof part / sizeof *part };
    if (number < PARTS)
        return part[number];
    const size_t picture = (number - PARTS) / 2, half = (number - PARTS) % 2;
    if (picture >= r->evidence.pictures)
        return NULL;
    return half ? &r->evidence.picture[picture].png : &r->evidence.picture[picture].caption;
}

void verify_result_write(struct buf *out, const struct verify_result *r)
{
    const struct buf *part;
    const uint64_t number[NUMBERS] = {(uint64_t)r->err, r->executed,         r->compared,
                                      r->digests,       r->evidence.goldens, r->evidence.pixels,
                                      r->took_ms,       r->evidence.pictures};
    buf_add_text(out, "result");
    for (size_t i = 0; i < NUMBERS; i++)
        buf_printf(out, " %" PRIu64, number[i]);
    buf_add_char(out, '\n');
    for (size_t i = 0; (part = part_of(r, i)); i++) {
        buf_printf(out, "part %zu\n", part->length);
        buf_add(out, buf_text(part), part->length);
    }
}

/* Read "NAME N N ...\n". A NUL ends the bytes, so that no number is read beyond them. */
static bool read_numbers(const char **at, const char *name, int64_t *number, size_t count)
{
    if (!scan_text(at, name))
        return false;
    for (size_t i = 0; i < count; i++)
        if (!scan_text(at, " ") || !scan_integer(at, 0, INT64_MAX, number + i))
            return false;
    return scan_text(at, "\n");
}

static bool read_all(struct verify_result *r, const char *at, const char *end)
{
    struct buf *part;
    int64_t number[NUMBERS], length;
    if (!read_numbers(&at, "result", number, NUMBERS) || number[0] > ERR_CANCELLED ||
        number[NUMBERS - 1] > EVIDENCE_MOST)
        return false;
    r->err = (enum err)number[0];
    r->evidence.pictures = (size_t)number[NUMBERS - 1];
    uint64_t *const count[] = {&r->executed,         &r->compared,        &r->digests,
                               &r->evidence.goldens, &r->evidence.pixels, &r->took_ms};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++)
        *count[i] = (uint64_t)number[i + 1];
    for (size_t i = 0; (part = part_of(r, i)); i++, at += length) {
        if (!read_numbers(&at, "part", &length, 1) || length > end - at)
            return false;
        buf_add(part, at, (size_t)length);
        if (part->failed)
            return false;
    }
    return at == end;
}

enum err verify_result_read(struct verify_result *result, const struct buf *bytes,
                            struct fault *fault)
{
    return read_all(result, buf_text(bytes), buf_text(bytes) + bytes->length)
               ? OK
               : fault_set(fault, ERR_INPUT, "no result, or half of one: %zu bytes", bytes->length);
}

enum err print_text(struct buf *text, void (*to)(void *context, const char *text),
                    const struct printer *printer, struct fault *fault)
{
    const enum err err = text->failed ? fault_memory(fault, "a report") : OK;
    if (!err && text->length)
        to(printer->context, buf_text(text));
    buf_release(text);
    return err;
}

struct verify_sum verify_sum(const struct verify_result *result, size_t count)
{
    struct verify_sum sum = {.count = count};
    for (size_t i = 0; i < count; i++) {
        const enum err err = result[i].err;
        sum.verified += !err && !result[i].is_skipped;
        sum.skipped += result[i].is_skipped;
        sum.unreadable += err && err != ERR_CHECK;
        sum.took_ms += result[i].took_ms;
        if (err && (!sum.worst || sum.worst == ERR_CHECK))
            sum.worst = err;
    }
    sum.failed = count - sum.verified - sum.skipped;
    return sum;
}

/* ---- text in markup ---- */

void markup_add(struct buf *out, const char *text, const char *after)
{
    static const char special[] = "&<>\"'";
    static const char *const entity[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    OWNED(buf_release) struct buf safe = {0};
    for (const char *at = text; *at;) {
        const size_t line = strcspn(at, "\n");
        buf_add_safe(&safe, at, line);
        at += line;
        if (*at)
            buf_add_char(&safe, *at++);
    }
    for (const char *at = buf_text(&safe); *at; at++) {
        const char *found = strchr(special, *at);
        if (found)
            buf_add_text(out, entity[found - special]);
        else
            buf_add_char(out, *at);
    }
    buf_add_text(out, after);
    out->failed = out->failed || safe.failed;
}

/* ---- JUnit ---- */

static void add_seconds(struct buf *out, uint64_t ms)
{
    buf_printf(out, " time=\"%" PRIu64 ".%03u\"", ms / 1000, (unsigned)(ms % 1000));
}

static void add_case(struct buf *out, const struct verify_result *r)
{
    const char *element = r->err == ERR_CHECK ? "failure" : "error";
    buf_add_text(out, "    <testcase classname=\"iftty\" name=\"");
    markup_add(out, r->path, "\"");
    add_seconds(out, r->took_ms);
    if (!r->err) {
        buf_add_text(out, r->is_skipped ? "><skipped/></testcase>\n" : "/>\n");
        return;
    }
    buf_printf(out, ">\n      <%s type=\"%s\" message=\"", element, err_name(r->err));
    markup_add(out, buf_text(&r->why), "\">");
    markup_add(out, buf_text(&r->lines), "");
    buf_printf(out, "</%s>\n    </testcase>\n", element);
}

static void add_suite(struct buf *out, const struct verify_sum *sum)
{
    buf_printf(out, " tests=\"%zu\" failures=\"%zu\" errors=\"%zu\" skipped=\"%zu\"", sum->count,
               sum->failed - sum->unreadable, sum->unreadable, sum->skipped);
    add_seconds(out, sum->took_ms);
    buf_add_text(out, ">\n");
}

static void add_junit(struct buf *out, const struct verify_result *result, size_t count)
{
    const struct verify_sum sum = verify_sum(result, count);
    buf_add_text(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites");
    add_suite(out, &sum);
    buf_add_text(out, "  <testsuite name=\"iftty verify\"");
    add_suite(out, &sum);
    for (size_t i = 0; i < count; i++)
        add_case(out, result + i);
    buf_add_text(out, "  </testsuite>\n</testsuites>\n");
}

/* ---- HTML ---- */

static const char page_head[] =
    "<!doctype html>\n"
    "<html lang=\"en\">\n"
    "<head>\n"
    "<meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
    "img-src data:; style-src 'unsafe-inline'\">\n"
    "<meta name=\"viewport\" content=\"width=device-width\">\n"
    "<style>\n"
    ":root { color-scheme: light dark; --ink: #222; --paper: #fff; --rule: #ccc; --box: #f4f4f4;\n"
    "        --good: #00613c; --bad: #a30000; --dim: #666 }\n"
    "@media (prefers-color-scheme: dark) { :root { --ink: #ddd; --paper: #181818; --rule: #444;\n"
    "        --box: #252525; --good: #4ecb8d; --bad: #ff8a80; --dim: #999 } }\n"
    "body { font: 15px/1.5 sans-serif; margin: 2em auto; max-width: 90em; padding: 0 1em;\n"
    "       color: var(--ink); background: var(--paper); overflow-wrap: anywhere }\n"
    ".table { overflow-x: auto } table { border-collapse: collapse; overflow-wrap: normal }\n"
    "th, td { border-bottom: 1px solid var(--rule); padding: .2em .8em; text-align: left;\n"
    "         vertical-align: baseline; white-space: nowrap }\n"
    ".n { text-align: right; font-variant-numeric: tabular-nums }\n"
    ".fine, .verified { color: var(--good) } .failed { color: var(--bad) }\n"
    ".skipped { color: var(--dim) } .swatch { display: inline-block; width: 1em; height: 1em }\n"
    "pre { background: var(--box); padding: .8em; white-space: pre-wrap }\n"
    ".pictures { display: flex; flex-wrap: wrap; gap: 1em }\n"
    "figure { margin: 0 } img { background: #000; max-width: 100%; image-rendering: pixelated }\n"
    "@media (max-width: 60em) { img { image-rendering: auto } }\n"
    "figure, tr { break-inside: avoid } figcaption { white-space: pre-line; max-width: 42em }\n"
    "</style>\n"
    "<title>";

void page_begin(struct buf *out, const char *title)
{
    buf_add_text(out, page_head);
    markup_add(out, title, "</title>\n</head>\n<body>\n");
}

void page_end(struct buf *out)
{
    buf_add_text(out, "</body>\n</html>\n");
}

void page_add_picture(struct buf *out, const char *caption, const struct buf *png)
{
    buf_add_text(out, "<figure><img alt=\"");
    markup_add(out, caption, "\" src=\"data:image/png;base64,");
    buf_add_base64(out, buf_text(png), png->length);
    buf_add_text(out, "\"><figcaption>");
    markup_add(out, caption, "</figcaption></figure>\n");
}

static void add_row(struct buf *out, size_t number, const struct verify_result *r)
{
    const char *outcome = r->is_skipped ? "skipped" : r->err ? "failed" : "verified";
    buf_printf(out, "<tr><td class=\"n\">%zu</td><td class=\"%s\">%s</td><td>", number, outcome,
               outcome);
    if (r->err)
        buf_printf(out, "<a href=\"#j%zu\">", number);
    markup_add(out, r->path, r->err ? "</a></td>" : "</td>");
    const uint64_t count[] = {r->executed,         r->compared,        r->digests,
                              r->evidence.goldens, r->evidence.pixels, r->took_ms};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++)
        buf_printf(out, "<td class=\"n\">%" PRIu64 "</td>", count[i]);
    buf_add_text(out, "</tr>\n");
}

static void add_pictures(struct buf *out, const struct evidence *evidence)
{
    if (evidence->pictures)
        buf_add_text(out, "<div class=\"pictures\">\n");
    for (size_t i = 0; i < evidence->pictures; i++)
        page_add_picture(out, buf_text(&evidence->picture[i].caption), &evidence->picture[i].png);
    if (evidence->pictures)
        buf_add_text(out, "</div>\n");
}

static void add_failure(struct buf *out, size_t number, const struct verify_result *r)
{
    buf_printf(out, "<section id=\"j%zu\">\n<h2>", number);
    markup_add(out, r->path, "</h2>\n<p class=\"failed\">");
    markup_add(out, buf_text(&r->why), "</p>\n<pre>");
    markup_add(out, buf_text(&r->lines), "</pre>\n");
    add_pictures(out, &r->evidence);
    buf_add_text(out, "</section>\n");
}

static void add_page(struct buf *out, const struct verify_result *result, size_t count)
{
    const struct verify_sum sum = verify_sum(result, count);
    page_begin(out, "iftty verify");
    buf_printf(out, "<h1>%zu verified, <span class=\"%s\">%zu failed</span>", sum.verified,
               sum.failed ? "failed" : "fine", sum.failed);
    if (sum.skipped)
        buf_printf(out, ", <span class=\"skipped\">%zu skipped</span>", sum.skipped);
    buf_add_text(out, "</h1>\n<div class=\"table\"><table>\n"
                      "<tr><th></th><th></th><th>journal</th><th class=\"n\">commands</th>"
                      "<th class=\"n\">results the same</th><th class=\"n\">digests</th>"
                      "<th class=\"n\">golden images</th><th class=\"n\">pixels</th>"
                      "<th class=\"n\">ms</th></tr>\n");
    for (size_t i = 0; i < count; i++)
        add_row(out, i + 1, result + i);
    buf_add_text(out, "</table></div>\n");
    for (size_t i = 0; i < count; i++)
        if (result[i].err)
            add_failure(out, i + 1, result + i);
    for (size_t i = 0; i < count; i++) {
        if (!result[i].slowest.length)
            continue;
        buf_add_text(out, "<h2>The slowest records of ");
        markup_add(out, result[i].path, "</h2>\n<pre>");
        markup_add(out, buf_text(&result[i].slowest), "</pre>\n");
    }
    page_end(out);
}

/* ---- JSON ---- */

static void add_lines(struct json *json, const char *key, const struct buf *lines)
{
    json_array(json, key);
    for (const char *at = buf_text(lines); *at; at += strcspn(at, "\n"), at += *at == '\n')
        json_bytes(json, NULL, at, strcspn(at, "\n"));
    json_end(json);
}

static void add_object(struct json *json, const struct verify_result *r)
{
    json_object(json, NULL);
    json_text(json, "journal", r->path);
    json_boolean(json, "verified", !r->err && !r->is_skipped);
    if (r->is_skipped)
        json_boolean(json, "skipped", true);
    json_count(json, "commands", r->executed);
    json_count(json, "results_the_same", r->compared);
    json_count(json, "digests", r->digests);
    json_count(json, "golden_images", r->evidence.goldens);
    json_count(json, "pixels", r->evidence.pixels);
    if (r->chain.length)
        json_bytes(json, "chain", buf_text(&r->chain), r->chain.length);
    json_count(json, "ms", r->took_ms);
    if (r->slowest.length)
        add_lines(json, "slowest", &r->slowest);
    if (r->err) {
        json_text(json, "kind", err_name(r->err));
        json_bytes(json, "why", buf_text(&r->why), r->why.length);
        add_lines(json, "lines", &r->lines);
    }
    json_end(json);
}

static void add_json(struct buf *out, const struct verify_result *result, size_t count)
{
    const struct verify_sum sum = verify_sum(result, count);
    struct json json = {.out = out, .lines = 2};
    json_object(&json, NULL);
    json_count(&json, "verified", sum.verified);
    json_count(&json, "failed", sum.failed);
    json_count(&json, "ms", sum.took_ms);
    json_array(&json, "journals");
    for (size_t i = 0; i < count; i++)
        add_object(&json, result + i);
    json_end(&json);
    json_end(&json);
}

/* ---- all forms ---- */

void verify_report_text(struct buf *out, enum verify_form form, const struct verify_result *result,
                        size_t count)
{
    static void (*const add_form[])(struct buf * out, const struct verify_result *result,
                                    size_t count) = {
        [VERIFY_JUNIT] = add_junit, [VERIFY_HTML] = add_page, [VERIFY_JSON] = add_json};
    add_form[form](out, result, count);
}

enum err verify_report(const char *file, enum verify_form form, const struct verify_result *result,
                       size_t count, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0};
    verify_report_text(&text, form, result, count);
    return text.failed ? fault_memory(fault, "a report")
                       : file_write(file, buf_text(&text), text.length, FILE_REPLACE, fault);
}
