/* SPDX-License-Identifier: MIT */
#include "steps/step_pages.h"

#include <string.h>

#include "base/file.h"
#include "image/png.h"
#include "command/limits.h"
#include "show/panes.h"
#include "steps/step_words.h"
#include "verify/verify_report.h"

enum { WIDTH = 576, HEIGHT = 480, CELL_WIDTH = 8, CELL_HEIGHT = 16 };

struct making {
    const struct step_pages *pages;
    struct walkthrough *walk;
    struct panes panes;
    struct png_writer writer;
    struct buf body;
    size_t step;
};

/* ---- pictures ---- */

static enum err write_file(const char *path, const struct buf *bytes, struct fault *fault)
{
    struct buf written = {0};
    limits_will_write();
    enum err err = bytes->failed ? fault_memory(fault, "a page")
                                 : file_write(path, bytes->data, bytes->length, FILE_KEEP, fault);
    buf_add(&written, path, strlen(path) + 1);
    buf_add(&written, "", 1);
    err = limits_judge(err, &written, fault);
    buf_release(&written);
    return err;
}

static enum err draw(struct making *m, unsigned number, const char *caption, struct fault *fault)
{
    static const char *const line[PANES_LINES] = {"", "", "", ""};
    struct session *session = m->walk->interp->session;
    const struct panes_wish wish = {.width = WIDTH,
                                    .height = HEIGHT,
                                    .cell_width = CELL_WIDTH,
                                    .cell_height = CELL_HEIGHT,
                                    .words = true,
                                    .line = {line[0], line[1], line[2], line[3]},
                                    .former = walkthrough_former(m->walk)};
    struct buf png = {0}, path = {0};
    enum err err = panes_draw(&m->panes, session, &wish, fault);
    if (!err) {
        const struct raster raster = {.width = WIDTH,
                                      .height = HEIGHT,
                                      .stride = (size_t)4 * WIDTH,
                                      .bytes = m->panes.canvas.rgba,
                                      .has_alpha = true};
        png_add(&m->writer, &raster, PNG_SLOW_LINE, &png);
    }
    buf_printf(&path, "%s/step-%zu-%u.png", m->pages->folder, m->step, number);
    if (!err)
        err =
            path.failed ? fault_memory(fault, "a path") : write_file(buf_text(&path), &png, fault);
    buf_printf(&m->body,
               "<figure><img src=\"step-%zu-%u.png\" alt=\"%s: step %zu\" loading=\"lazy\" "
               "width=\"%d\" height=\"%d\"><figcaption>%s</figcaption></figure>\n",
               m->step, number, caption, m->step, WIDTH, HEIGHT, caption);
    buf_release(&png);
    buf_release(&path);
    return err;
}

static enum err show(struct making *m, enum step_phase phase, unsigned number, const char *caption,
                     struct fault *fault)
{
    const enum err err = walkthrough_show(m->walk, m->step, phase, fault);
    return err ? err : draw(m, number, caption, fault);
}

/* ---- the page ---- */

static const char head[] =
    "<!doctype html>\n"
    "<html lang=\"en\">\n"
    "<head>\n"
    "<meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src 'self'; "
    "style-src 'unsafe-inline'\">\n"
    "<meta name=\"viewport\" content=\"width=device-width\">\n"
    "<style>\n"
    "body { font: 15px/1.5 sans-serif; margin: 2em auto; max-width: 140em; padding: 0 1em;\n"
    "       color: #222; background: #fff; overflow-wrap: anywhere }\n"
    "section { border-top: 1px solid #ccc; margin-top: 2em }\n"
    "h2 { font: bold 15px/1.5 monospace } .left h2 { color: #666 }\n"
    ".comments { white-space: pre-line; font-style: italic }\n"
    ".pictures { display: flex; flex-wrap: wrap; gap: 1em } figure { margin: 0; flex: 1 1 20em }\n"
    "img { width: 100%; height: auto; background: #000 }\n"
    ".fine { color: #00613c } .failed { color: #a30000 }\n"
    "</style>\n";

static void add_words(struct making *m, const char *tag, const char *class,
                      void (*words)(struct buf *, const struct walkthrough *, size_t))
{
    struct buf text = {0};
    words(&text, m->walk, m->step);
    if (text.length) {
        buf_printf(&m->body, "<%s class=\"%s\">", tag, class);
        markup_add(&m->body, buf_text(&text));
        buf_printf(&m->body, "</%s>\n", tag);
    }
    m->body.failed |= text.failed;
    buf_release(&text);
}

static enum err add_step(struct making *m, struct fault *fault)
{
    const bool stands = walkthrough_step(m->walk, m->step)->fate == STEP_STANDS;
    const size_t before = m->body.length;
    enum err err = walkthrough_show(m->walk, m->step, STEP_BEFORE, fault);
    if (err)
        return err;
    const struct step_seen *seen = walkthrough_seen(m->walk, m->step);
    buf_printf(&m->body, "<section id=\"step-%zu\"%s>\n", m->step, stands ? "" : " class=\"left\"");
    add_words(m, "h2", "title", step_words_title);
    add_words(m, "p", "comments", step_words_comments);
    add_words(m, "p", "change", step_words_change);
    buf_add_text(&m->body, "<div class=\"pictures\">\n");
    if (seen->has_place || seen->changed)
        err = draw(m, 1, "before", fault);
    if (!err && seen->has_place)
        err = show(m, STEP_DRAWN, 2, "the gesture", fault);
    if (!err && seen->changed)
        err = show(m, STEP_AFTER, 3, "after", fault);
    buf_add_text(&m->body, "</div>\n</section>\n");
    if (err)
        m->body.length = before;
    return err;
}

static enum err write_page(struct making *m, struct fault *fault)
{
    struct buf page = {0}, path = {0}, verdict = {0};
    const char *title =
        session_is_private(m->walk->interp->session) ? "A journal" : m->pages->title;
    buf_add_text(&page, head);
    buf_add_text(&page, "<title>");
    markup_add(&page, title);
    buf_add_text(&page, "</title>\n</head>\n<body>\n<h1>");
    markup_add(&page, title);
    step_words_verdict(&verdict, m->walk);
    buf_printf(&page, "</h1>\n<p class=\"%s\">", m->walk->ended ? "failed" : "fine");
    markup_add(&page, buf_text(&verdict));
    buf_add_text(&page, "</p>\n");
    buf_add(&page, buf_text(&m->body), m->body.length);
    buf_add_text(&page, "</body>\n</html>\n");
    buf_printf(&path, "%s/index.html", m->pages->folder);
    page.failed |= m->body.failed || path.failed || verdict.failed;
    const enum err err = write_file(buf_text(&path), &page, fault);
    buf_release(&page);
    buf_release(&path);
    buf_release(&verdict);
    return err;
}

enum err step_pages_write(struct walkthrough *w, const struct step_pages *pages, enum err *verdict,
                          struct fault *fault)
{
    struct making m = {.pages = pages, .walk = w, .step = pages->first ? pages->first : 1};
    const size_t count = w->list.count;
    const size_t last = pages->last && pages->last < count ? pages->last : count;
    enum err err = OK;
    *verdict = OK;
    if (m.step > count)
        return fault_set(fault, ERR_USAGE, "--from %zu: the journal has %zu step%s", m.step, count,
                         plural(count));
    for (; !err && m.step <= last; m.step++) {
        watch_poll(pages->watch, "pages", m.step, last);
        err = add_step(&m, fault);
    }
    if (!err)
        err = walkthrough_finish(w, fault);
    if (w->has_ended && w->ended && err == w->ended) { /* the pages say so */
        *verdict = err;
        err = OK;
    }
    if (!err)
        err = write_page(&m, fault);
    if (!err && *verdict && fault)
        *fault = w->why;
    png_release(&m.writer);
    panes_release(&m.panes);
    buf_release(&m.body);
    return err;
}
