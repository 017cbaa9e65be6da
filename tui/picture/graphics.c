/* SPDX-License-Identifier: MIT */
#include "tui/picture/graphics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/least.h"
#include "base/mem.h"
#include "tui/term.h"

enum { LIMIT_MS = 2000, AGAIN_MS = 300 };

const struct graphics graphics_none = {
    .name = "none", .title = "nothing", .kind = GRAPHICS_NOTHING};

static const struct graphics *const table[] = {
    &graphics_kitty,     &graphics_tiles,  &graphics_placeholders,
    &graphics_iterm,     &graphics_sixel,  &graphics_sextants,
    &graphics_quadrants, &graphics_halves, &graphics_none};
enum { PROTOCOLS = sizeof table / sizeof table[0], TEXTS = 3, FIRST_TEXT = PROTOCOLS - TEXTS - 1 };

static const char any[] = "auto", any_text[] = "blocks";
const struct graphics_wish graphics_auto = {table, PROTOCOLS};

bool graphics_from_name(const char *name, struct graphics_wish *wish)
{
    *wish = strcmp(name, any_text) == 0 ? (struct graphics_wish){table + FIRST_TEXT, TEXTS}
                                        : graphics_auto;
    if (strcmp(name, any) == 0 || strcmp(name, any_text) == 0)
        return true;
    wish->count = 1;
    for (; wish->of < table + PROTOCOLS; wish->of++)
        if (strcmp(name, wish->of[0]->name) == 0)
            return true;
    return false;
}

void graphics_add_names(struct buf *out, const char *between, const char *before_last)
{
    buf_add_text(out, any);
    for (size_t i = 0; i < PROTOCOLS; i++) {
        if (i == FIRST_TEXT)
            buf_printf(out, "%s%s", between, any_text);
        buf_printf(out, "%s%s", i + 1 < PROTOCOLS ? between : before_last, table[i]->name);
    }
}

enum err graphics_read(const char *name, const char *where, struct graphics_wish *wish,
                       struct fault *fault)
{
    OWNED(buf_release) struct buf names = {0};
    if (graphics_from_name(name, wish))
        return OK;
    graphics_add_names(&names, ", ", " or ");
    return fault_set(fault, ERR_USAGE, "%s: expected %s, not %s", where, buf_text(&names), name);
}

/* ---- which the terminal has ---- */

/* Text of a given shape needs only to know whether frames are answered. */
struct probe_wish graphics_asks(struct graphics_wish wish, const struct probe_environment *e)
{
    const enum graphics_kind kind = wish.of[0]->kind;
    const bool text = wish.count > 1 ? e->no_color : kind == GRAPHICS_TEXT;
    struct probe_wish asks = {.depth = kind == GRAPHICS_NOTHING ? PROBE_NOTHING
                                       : text                   ? PROBE_BARRIERS
                                                                : PROBE_ALL};
    for (size_t i = 0; i < wish.count; i++) {
        const struct probe_question question = wish.of[i]->question;
        asks.needs_outer |= !text && (wish.count > 1 || question.is_outer);
        if (question.text && wish.count > 1)
            asks.question[asks.questions++] = question;
    }
    return asks;
}

/* Return the row, or its replacement for a terminal that supports only the common part of its
 * protocol. */
static const struct graphics *all_of(const struct graphics *g, const struct probe_replies *replies)
{
    const char *const maker[] = {g->made_by, NULL};
    return !g->made_by || probe_is_named(replies, maker) ? g : g->instead;
}

static const struct graphics *choose(const struct probe_replies *replies, struct graphics_wish wish)
{
    const struct probe_environment *e = &replies->environment;
    for (size_t i = 0; i + 1 < wish.count; i++) {
        const struct graphics *g = wish.of[i];
        const bool refused = probe_is_plain(e->term) || (g->kind == GRAPHICS_PIXELS &&
                                                         (e->no_color || probe_is_screen(replies)));
        if (!refused && (g->fits ? g->fits(replies) : g->kind == GRAPHICS_TEXT))
            return all_of(g, replies);
    }
    return all_of(wish.of[wish.count - 1], replies);
}

/* Advise a user whose pictures are made of text, though the terminal may show others. */
static const char *advice_on(const struct probe_replies *replies, struct graphics_wish wish)
{
    const struct probe_environment *e = &replies->environment;
    if (wish.count == 1 || e->no_color || probe_is_silent(e, graphics_asks(wish, e)))
        return NULL;
    if (!replies->da1)
        return "the terminal has not answered: Ctrl-L asks again";
    const bool may_have =
        !replies->outer.name[0] || graphics_placeholders.question.may_ask(replies);
    return probe_is_tmux(replies) && replies->outer.passing != TMUX_PASSES && may_have
               ? "kitty and ghostty show more with `set -g allow-passthrough on` in ~/.tmux.conf"
               : NULL;
}

void graphics_describe(const struct terminal_facts *facts, struct buf *out)
{
    buf_printf(out, "graphics  %s\n", facts->graphics->title);
    if (facts->advice)
        buf_printf(out, "          %s\n", facts->advice);
}

void graphics_decide(const struct probe_replies *replies, const struct term_size *size,
                     struct graphics_wish wish, struct terminal_facts *facts)
{
    probe_decide(replies, size, facts);
    facts->graphics = choose(replies, wish);
    if (facts->graphics->kind == GRAPHICS_TEXT)
        facts->shape = facts->graphics->shape;
    facts->advice = facts->graphics->kind == GRAPHICS_TEXT ? advice_on(replies, wish) : NULL;
    facts->images_most = probe_is_tmux(replies) ? facts->graphics->tmux_keeps : 0;
    if (facts->graphics->kind == GRAPHICS_PIXELS && replies->outer_answers)
        facts->barrier = PROBE_OUTER_BARRIER;
}

const char *graphics_recovery(const struct terminal_facts *facts)
{
    return facts->graphics->recovery ? facts->graphics->recovery : "\033\\";
}

static void decide(const struct graphics_probe *g, struct terminal_facts *facts)
{
    const struct term_size size = term_size();
    const struct terminal_facts former = *facts;
    char words[TERM_WORDS];
    graphics_decide(&g->probe.replies, &size, g->wish, facts);
    facts->round_trip_ns = former.round_trip_ns;
    facts->reports = former.reports;
    facts->space = former.space;
    facts->answer_due = g->probe.due > 0 && !g->probe.replies.is_outer;
    snprintf(words, sizeof words, "%s%s", graphics_recovery(facts),
             facts->synchronizes ? "\033[?2026l" : "");
    term_set_recovery(words, facts->answers ? facts->barrier : NULL);
}

void graphics_probe(struct graphics_probe *g, unsigned due, struct terminal_facts *facts,
                    struct buf *typed)
{
    const struct probe_environment environment = probe_environment_now();
    const bool is_first = g->probe.rounds == 0;
    if (g->wish.count == 0)
        g->wish = graphics_auto;
    if (is_first)
        *facts = (struct terminal_facts){.space = (uint8_t)getpid()};
    g->probe = (struct probe){.wish = graphics_asks(g->wish, &environment),
                              .replies.environment = environment,
                              .due = due};
    probe_terminal(&g->probe, is_first || facts->answers ? LIMIT_MS : AGAIN_MS,
                   &facts->round_trip_ns, typed);
    decide(g, facts);
}

unsigned graphics_due(const struct graphics_probe *g)
{
    return g->probe.replies.is_outer ? 0 : g->probe.due;
}

enum probe_heard graphics_hear(struct graphics_probe *g, const char *body,
                               struct terminal_facts *facts)
{
    const enum probe_heard heard = probe_hear(&g->probe, body);
    if (heard == PROBE_HAS_ALL) {
        facts->round_trip_ns = clock_ns() - g->probe.asked_ns;
        probe_write(&g->probe);
        decide(g, facts);
    }
    return heard;
}

/* ---- a picture at the prompt ---- */

void graphics_encode(const struct terminal_facts *facts, const struct image_view *view,
                     struct buf *out)
{
    const struct graphics *graphics = facts->graphics;
    OWNED(painter_release) struct painter p = {.facts = *facts};
    const bool needs_palette = shades_needed(view, graphics->palette_always);
    bool fine = !needs_palette || shades_choose(&p.shades, view);
    p.has_palette = needs_palette || shades_take_exact(&p.shades, view);
    struct raster raster = {.width = view->width,
                            .height = view->height,
                            .stride = (size_t)view->width * (p.has_palette ? 1 : 3),
                            .colour = p.has_palette ? p.shades.colour : NULL,
                            .colours = p.shades.count};
    size_t bytes;
    fine = fine && size_multiply(raster.stride, view->height, &bytes) &&
           mem_grow(&p.of[0].bytes, &p.of[0].capacity, bytes, 1) &&
           shades_fill(&p.shades, p.has_palette, view, p.of[0].bytes, view->width, view->height);
    raster.bytes = p.of[0].bytes;
    if (fine)
        graphics->once(&p, &raster, out);
    out->failed |= !fine;
}

static void add_framed(const struct terminal_facts *facts, const struct image_view *view,
                       struct buf *out)
{
    const uint32_t rows = (view->height + facts->cell_height - 1) / facts->cell_height +
                          (facts->images_most > 0); /* as in painter_place */
    buf_add_char(out, '\r');
    for (uint32_t i = 0; i < rows; i++)
        buf_add_char(out, '\n');
    buf_printf(out, "\033[%uA\0337", rows);
    graphics_encode(facts, view, out);
    buf_printf(out, "\0338\033[%uB\r", rows);
}

void show_inline(const struct terminal_facts *facts, const struct image_view *view,
                 uint32_t columns, uint32_t rows, struct buf *out)
{
    const uint32_t spare = 1 + (facts->images_most > 0), side = facts->image_side_most;
    const uint32_t picture_rows = rows > spare ? rows - spare : 1;
    struct image_view fitting = *view;
    if (view->width == 0 || view->height == 0)
        return;
    if (facts->graphics->kind == GRAPHICS_TEXT)
        facts->graphics->lines(facts, view, columns, picture_rows, out);
    if (facts->graphics->kind != GRAPHICS_PIXELS)
        return;
    image_view_fit(view, (uint32_t)least_64((uint64_t)columns * facts->cell_width, side),
                   (uint32_t)least_64((uint64_t)picture_rows * facts->cell_height, side),
                   &fitting.width, &fitting.height);
    if (fitting.width == view->width && fitting.height == view->height) {
        add_framed(facts, view, out);
        return;
    }
    OWNED(mem_release) uint8_t *rgba = image_view_shrink(view, fitting.width, fitting.height);
    fitting.rgba = rgba;
    if (rgba)
        add_framed(facts, &fitting, out);
    else
        out->failed = true;
}
