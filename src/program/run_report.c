/* SPDX-License-Identifier: MIT */
/*
 * `iftty report`: one HTML page about a journal, which is replayed for it.
 *
 * Its parts: whether the journal verified, its last chain and the versions; a table of labels; a
 * comparison with a map, if one is named; slices through each label, and the rendition; golden
 * images; and the steps with their comments. Equal journals have equal pages.
 */
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/version.h"
#include "command/command.h"
#include "command/execute.h"
#include "command/golden_files.h"
#include "image/png.h"
#include "program/panes.h"
#include "program/programs.h"
#include "show/draw.h"
#include "show/label_report.h"
#include "verify/verify.h"

enum { WIDTH = 640, HEIGHT = 480, CELL_WIDTH = 8, CELL_HEIGHT = 16, LABELS_DRAWN_MOST = 32 };

struct page {
    struct interpreter *interp;
    struct watched watched;
    struct panes panes;
    struct buf goldens; /* figures of golden images */
    struct buf out;
};

static void page_release(struct page *page)
{
    watched_release(&page->watched);
    panes_release(&page->panes);
    buf_release(&page->goldens);
    buf_release(&page->out);
}

static enum err add_pixels(struct buf *out, const char *caption, uint32_t width, uint32_t height,
                           const uint8_t *rgba, struct fault *fault)
{
    OWNED(buf_release) struct buf png = {0};
    TRY(png_encode(&png, width, height, rgba, fault));
    page_add_picture(out, caption, &png);
    return OK;
}

/* ---- golden images, as they are drawn by the replay ---- */

static enum err add_golden(void *context, struct interpreter *interp,
                           const struct golden_finding *finding, struct fault *fault)
{
    struct page *page = context;
    const struct picture *actual = finding->actual;
    (void)interp;
    return add_pixels(&page->goldens, finding->name, actual->width, actual->height,
                      picture_colours(actual), fault);
}

static enum err add_other_golden(void *context, struct interpreter *interp,
                                 const struct golden_finding *finding, struct fault *fault)
{
    add_golden(context, interp, finding, NULL);
    (void)fault; /* says already what differs */
    return ERR_CHECK;
}

/* ---- slices and rendition ---- */

static enum err add_panes(struct page *page, const char *caption, struct fault *fault)
{
    const struct pilot_wish wish = {.width = WIDTH,
                                    .height = HEIGHT,
                                    .cell_width = CELL_WIDTH,
                                    .cell_height = CELL_HEIGHT,
                                    .words = true};
    const struct buf line[PANES_LINES] = {{0}};
    struct session *session = page->interp->session;
    if (session_is_rough(session))
        TRY(session_refine(session, session->watch, fault));
    TRY(panes_draw(&page->panes, session, &wish, line, fault));
    return add_pixels(&page->out, caption, WIDTH, HEIGHT, page->panes.canvas.rgba, fault);
}

/* Find the voxel of a label nearest to its middle. */
static void find_middle(uint32_t place[3], const struct labels *labels, unsigned label,
                        const struct label_sums *sums)
{
    const struct grid *grid = &labels->scene->grid;
    uint64_t nearest = UINT64_MAX;
    for (uint32_t z = sums->first[2]; z <= sums->last[2]; z++)
        for (uint32_t y = sums->first[1]; y <= sums->last[1]; y++)
            for (uint32_t x = sums->first[0]; x <= sums->last[0]; x++) {
                const uint32_t at[3] = {x, y, z};
                uint64_t distance = 0;
                if (labels_at(labels, grid_cell(grid, x, y, z)) != label)
                    continue;
                for (int a = 0; a < 3; a++) {
                    const int64_t off = (int64_t)at[a] - (int64_t)(sums->sum[a] / sums->voxels);
                    distance += (uint64_t)(off * off);
                }
                if (distance < nearest) {
                    nearest = distance;
                    memcpy(place, at, sizeof at);
                }
            }
}

/* The table of labels, and a picture of each. */
static enum err add_labels(struct page *page, struct fault *fault)
{
    struct session *session = page->interp->session;
    struct buf *out = &page->out;
    struct label_stats stats[256];
    struct labels labels;
    uint32_t number[256], place[3];
    uint8_t order[256];
    OWNED(reply_release) struct reply reply = {0};
    unsigned drawn = 0, left = 0;
    numbering_fill(number, &session->now.kept);
    numbering_order(order, number);
    TRY(session_labels(session, session_shows_finished(session), &labels, fault));
    TRY(session_find_stats(session, &labels, stats, fault));
    buf_add_text(out, "<h2>Labels</h2>\n<div class=\"table\"><table>\n<tr><th></th>"
                      "<th class=\"n\">number</th><th>name</th><th class=\"n\">voxels</th>"
                      "<th class=\"n\">volume</th><th>intensities and extent</th></tr>\n");
    for (unsigned i = 0; i < 256; i++) {
        const unsigned label = order[i];
        const struct label_sums *sums = &stats[label].sums;
        const uint8_t *rgb = session->now.kept.palette.rgb[label];
        OWNED(buf_release) struct buf volume = {0}, words = {0};
        if (!label || !sums->voxels)
            continue;
        label_report_write_extent(&volume, session, sums->voxels);
        label_report_write_sums(&words, sums, &session->geometry);
        buf_printf(out,
                   "<tr><td><span class=\"swatch\" style=\"background: #%02x%02x%02x\"></span></td>"
                   "<td class=\"n\">%u</td><td>",
                   rgb[0], rgb[1], rgb[2], number[label]);
        markup_add(out, session->now.kept.label_name[label], "</td><td class=\"n\">");
        buf_printf(out, "%llu</td><td class=\"n\">", (unsigned long long)sums->voxels);
        markup_add(out, buf_text(&volume), "</td><td>");
        markup_add(out, buf_text(&words), "</td></tr>\n");
        out->failed |= volume.failed || words.failed;
    }
    buf_add_text(out, "</table></div>\n<h2>Slices</h2>\n<div class=\"pictures\">\n");
    TRY(interpreter_look(page->interp, "magnify fit", &reply, fault));
    for (unsigned i = 0; i < 256; i++) {
        const unsigned label = order[i];
        OWNED(buf_release) struct buf caption = {0};
        if (!label || !stats[label].sums.voxels || (drawn == LABELS_DRAWN_MOST && ++left))
            continue;
        find_middle(place, &labels, label, &stats[label].sums);
        session_show_cross(session, place);
        label_report_write_name(&caption, session, label);
        buf_printf(&caption, ", at %u,%u,%u", place[0], place[1], place[2]);
        TRY(add_panes(page, buf_text(&caption), fault));
        drawn++;
    }
    buf_add_text(out, "</div>\n");
    if (left)
        buf_printf(out, "<p>%u more labels have no picture.</p>\n", left);
    return OK;
}

/* A picture of each step, its changed voxels hatched. */
static enum err add_steps(struct page *page, struct fault *fault)
{
    struct watched *w = &page->watched;
    enum err err = OK;
    buf_add_text(&page->out, "<h2>Steps</h2>\n<div class=\"pictures\">\n");
    for (size_t step = 1; !err && step <= w->count; step++) {
        OWNED(buf_release) struct buf caption = {0};
        err = watched_carry_out(w, step, fault);
        watched_title(&caption, w);
        buf_add_char(&caption, '\n');
        watched_describe(&caption, w);
        buf_add_char(&caption, '\n');
        watched_comments(&caption, w);
        page->panes.former = watched_former(w);
        if (!err)
            err = add_panes(page, buf_text(&caption), fault);
    }
    page->panes.former = NULL;
    buf_add_text(&page->out, "</div>\n");
    return err;
}

static enum err add_comparison(struct page *page, const char *map, struct fault *fault)
{
    OWNED(buf_release) struct buf line = {0};
    OWNED(reply_release) struct reply reply = {0};
    buf_add_text(&line, "compare ");
    command_write_word(&line, map);
    if (session_shows_finished(page->interp->session))
        buf_add_text(&line, " finished=yes");
    TRY(interpreter_execute(page->interp, buf_text(&line), &reply, fault));
    buf_add_text(&page->out, "<h2>Comparison with ");
    markup_add(&page->out, map, "</h2>\n<pre>");
    markup_add(&page->out, buf_text(&reply.text), "</pre>\n");
    return OK;
}

static enum err add_all(struct page *page, const struct options *o, struct fault *fault)
{
    struct buf *out = &page->out;
    const struct watched *w = &page->watched;
    OWNED(buf_release) struct buf verdict = {0};
    TRY(watched_begin(&page->watched, page->interp, o->word[0], fault));
    watched_verdict(&verdict, w);
    page_begin(out, file_name(o->word[0]));
    buf_add_text(out, "<h1>");
    markup_add(out, file_name(o->word[0]), "</h1>\n");
    buf_printf(out, "<p class=\"%s\">", w->ended ? "failed" : "verified");
    markup_add(out, buf_text(&verdict), "</p>\n");
    buf_printf(out, "<p>chain %s<br>semantics %u, iftty " PROGRAM_VERSION "</p>\n",
               w->report.chain.hex, page->interp->session->semantics);
    TRY(add_labels(page, fault));
    if (o->compare)
        TRY(add_comparison(page, o->compare, fault));
    if (page->goldens.length) {
        buf_add_text(out, "<h2>Golden images</h2>\n<div class=\"pictures\">\n");
        buf_add(out, page->goldens.data, page->goldens.length);
        buf_add_text(out, "</div>\n");
    }
    if (o->steps)
        TRY(add_steps(page, fault));
    page_end(out);
    if (out->failed || page->goldens.failed || verdict.failed)
        return fault_memory(fault, "a report");
    TRY(file_write(o->page, out->data, out->length, FILE_KEEP, fault));
    return w->ended ? fault_set(fault, w->ended, "%s", w->why.text) : OK;
}

enum err run_report(const struct options *o, struct fault *fault)
{
    OWNED(page_release) struct page page = {0};
    OWNED(buf_release) struct buf folder = {0};
    if (!o->page)
        return fault_set(fault, ERR_USAGE, "name the page, as in -o REPORT.html");
    if (file_exists(o->page))
        return fault_set(fault, ERR_IO, "%s exists; it was not overwritten", o->page);
    file_folder(&folder, o->page);
    console_handle_interrupts();
    TRY(begin_confined(o, o->word[0], buf_text(&folder), fault));
    OWNED(interpreter_release) struct interpreter interp;
    const struct golden_judge judge = {
        .context = &page, .is_same = add_golden, .differs = add_other_golden};
    page.interp = &interp;
    TRY(begin_by_options(&interp, o, fault));
    interp.judge = &judge;
    enum err err = add_all(&page, o, fault);
    console_erase_progress();
    return err;
}
