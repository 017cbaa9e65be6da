#include "verify/verify_report.h"

#include <inttypes.h>
#include <string.h>

#include "base/file.h"
#include "verify/markup.h"

static void add(struct buf *out, const char *text)
{
    markup_add(out, text, strlen(text));
}

struct tally {
    size_t failures, errors; /* checks that failed; journals that could not be verified */
    uint64_t took_ms;
};

static struct tally tally(const struct verdict *verdict, size_t count)
{
    struct tally t = {0};
    for (size_t i = 0; i < count; i++) {
        t.failures += verdict[i].err == ERR_CHECK;
        t.errors += verdict[i].err && verdict[i].err != ERR_CHECK;
        t.took_ms += verdict[i].took_ms;
    }
    return t;
}

/* ---- JUnit ---- */

static void add_seconds(struct buf *out, uint64_t ms)
{
    buf_printf(out, " time=\"%" PRIu64 ".%03u\"", ms / 1000, (unsigned)(ms % 1000));
}

static void add_case(struct buf *out, const char *path, const struct verdict *v)
{
    const char *element = v->err == ERR_CHECK ? "failure" : "error";
    buf_add_text(out, "    <testcase classname=\"iftty\" name=\"");
    add(out, path);
    buf_add_char(out, '"');
    add_seconds(out, v->took_ms);
    if (!v->err) {
        buf_add_text(out, "/>\n");
        return;
    }
    buf_printf(out, ">\n      <%s type=\"%s\" message=\"", element, err_name(v->err));
    markup_add(out, buf_text(&v->why), v->why.length);
    buf_add_text(out, "\">");
    markup_add(out, buf_text(&v->lines), v->lines.length);
    buf_printf(out, "</%s>\n    </testcase>\n", element);
}

static void add_suite(struct buf *out, const struct tally *t, size_t count)
{
    buf_printf(out, " tests=\"%zu\" failures=\"%zu\" errors=\"%zu\"", count, t->failures,
               t->errors);
    add_seconds(out, t->took_ms);
    buf_add_text(out, ">\n");
}

static void add_junit(struct buf *out, char *const *path, const struct verdict *verdict,
                      size_t count)
{
    const struct tally t = tally(verdict, count);
    buf_add_text(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites");
    add_suite(out, &t, count);
    buf_add_text(out, "  <testsuite name=\"iftty verify\"");
    add_suite(out, &t, count);
    for (size_t i = 0; i < count; i++)
        add_case(out, path[i], verdict + i);
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
    "<title>iftty verify</title>\n"
    "<style>\n"
    "body { font: 15px/1.5 sans-serif; margin: 2em auto; max-width: 90em; padding: 0 1em;\n"
    "       color: #222; background: #fff }\n"
    "table { border-collapse: collapse }\n"
    "th, td { border-bottom: 1px solid #ccc; padding: .2em .8em; text-align: left }\n"
    "td.n { text-align: right }\n"
    ".fine { color: #00613c } .failed { color: #a30000 }\n"
    "pre { background: #f4f4f4; padding: .8em; overflow-x: auto }\n"
    ".pictures { display: flex; flex-wrap: wrap; gap: 1em }\n"
    "figure { margin: 0 } img { background: #000; max-width: 100%; image-rendering: pixelated }\n"
    "</style>\n"
    "</head>\n"
    "<body>\n";

static void add_row(struct buf *out, size_t number, const char *path, const struct verdict *v)
{
    buf_printf(out, "<tr><td class=\"n\">%zu</td><td>", number);
    if (v->err)
        buf_printf(out, "<a href=\"#j%zu\">", number);
    add(out, path);
    buf_printf(out, "%s</td><td class=\"%s\">%s</td>", v->err ? "</a>" : "",
               v->err ? "failed" : "fine", v->err ? "failed" : "verified");
    buf_printf(out,
               "<td class=\"n\">%" PRIu64 "</td><td class=\"n\">%" PRIu64
               "</td><td class=\"n\">%" PRIu64 "</td></tr>\n",
               v->executed, v->compared, v->took_ms);
}

static void add_pictures(struct buf *out, const struct evidence *evidence)
{
    if (evidence->pictures)
        buf_add_text(out, "<div class=\"pictures\">\n");
    for (size_t i = 0; i < evidence->pictures; i++) {
        const struct buf *caption = &evidence->picture[i].caption, *png = &evidence->picture[i].png;
        buf_add_text(out, "<figure><img alt=\"");
        markup_add(out, buf_text(caption), caption->length);
        buf_add_text(out, "\" src=\"data:image/png;base64,");
        buf_add_base64(out, buf_text(png), png->length);
        buf_add_text(out, "\"><figcaption>");
        markup_add(out, buf_text(caption), caption->length);
        buf_add_text(out, "</figcaption></figure>\n");
    }
    if (evidence->pictures)
        buf_add_text(out, "</div>\n");
}

static void add_failure(struct buf *out, size_t number, const char *path, const struct verdict *v)
{
    buf_printf(out, "<section id=\"j%zu\">\n<h2>", number);
    add(out, path);
    buf_add_text(out, "</h2>\n<p class=\"failed\">");
    markup_add(out, buf_text(&v->why), v->why.length);
    buf_add_text(out, "</p>\n<pre>");
    markup_add(out, buf_text(&v->lines), v->lines.length);
    buf_add_text(out, "</pre>\n");
    add_pictures(out, &v->evidence);
    buf_add_text(out, "</section>\n");
}

static void add_page(struct buf *out, char *const *path, const struct verdict *verdict,
                     size_t count)
{
    const struct tally t = tally(verdict, count);
    const size_t failed = t.failures + t.errors;
    buf_add_text(out, page_head);
    buf_printf(out, "<h1>%zu verified, <span class=\"%s\">%zu failed</span></h1>\n", count - failed,
               failed ? "failed" : "fine", failed);
    buf_add_text(out, "<table>\n<tr><th></th><th>journal</th><th></th><th>commands</th>"
                      "<th>results the same</th><th>ms</th></tr>\n");
    for (size_t i = 0; i < count; i++)
        add_row(out, i + 1, path[i], verdict + i);
    buf_add_text(out, "</table>\n");
    for (size_t i = 0; i < count; i++)
        if (verdict[i].err)
            add_failure(out, i + 1, path[i], verdict + i);
    buf_add_text(out, "</body>\n</html>\n");
}

void verify_report_text(struct buf *out, enum verify_form form, char *const *path,
                        const struct verdict *verdict, size_t count)
{
    if (form == VERIFY_JUNIT)
        add_junit(out, path, verdict, count);
    else
        add_page(out, path, verdict, count);
}

enum err verify_report(const char *file, enum verify_form form, char *const *path,
                       const struct verdict *verdict, size_t count, struct fault *fault)
{
    struct buf text = {0};
    verify_report_text(&text, form, path, verdict, count);
    const enum err err = text.failed
                             ? fault_memory(fault, "a report")
                             : file_write(file, buf_text(&text), text.length, FILE_REPLACE, fault);
    buf_release(&text);
    return err;
}
