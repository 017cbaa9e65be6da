/* SPDX-License-Identifier: MIT */
#include "tui/probe.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/least.h"
#include "base/mem.h"

#define OUTER_NAME    "\033Ptmux;\033\033[>q\033\\" PROBE_OUTER_BARRIER
#define OUTER_END     "\033Ptmux;\033\033[5n\033\\"
#define CSI_QUESTIONS "\033[>c\033[>q\033[16t\033[14t"
#define MODE_QUESTION "\033[?2026$p\033[?1016$p\033]11;?\033\\"
#define SIDE_QUESTION "\033[?2;4;0S"
#define CLEAR_UP      "\r\033[K"

enum { LEAVE_MS = 2000, LEAVE_MOST_MS = 10000, OWED_MS = 300, OUTER_MS = 300 };
enum { FIRST_OUTER = 2 }; /* round */
enum { SIDE_UNTOLD = 1000, CELL_LEAST = 4, CELL_MOST = 64 };
enum { KIND_SCREEN = 'S', KIND_TMUX = 'T', KIND_VTE = 65, KIND_XTERM = 41 }; /* in DA2 */
enum { VTE_SEXTANTS = 6600 };                                                /* version 0.66 */

/* ---- replies ---- */

static bool starts_with(const char *text, const char *start)
{
    return strncmp(text, start, strlen(start)) == 0;
}

/* Read numbers separated by semicolons; return how many, and set *end to the text after them. */
static unsigned read_numbers(const char *text, uint32_t number[], unsigned most, const char **end)
{
    unsigned count = 0;
    for (;; text++) {
        uint32_t n = 0;
        for (; *text >= '0' && *text <= '9'; text++)
            n = n < 1000000 ? n * 10 + (uint32_t)(*text - '0') : n;
        if (count < most)
            number[count++] = n;
        if (*text != ';')
            break;
    }
    *end = text;
    return count;
}

static bool equals(const char *text, const char *other)
{
    return strcmp(text, other) == 0;
}

/* Return true for "ffff/ffff/ffff", a colour in parts of 1 to 4 digits, if it is light. */
static bool is_light(const char *colour)
{
    static const unsigned weight[] = {299, 587, 114}; /* luma, Rec. 601 */
    unsigned luma = 0;
    for (int i = 0; i < 3; i++) {
        char *end;
        const unsigned long part = strtoul(colour, &end, 16);
        const long digits = end - colour;
        if (digits < 1 || digits > 4 || (i < 2 && *end != '/'))
            return false;
        luma += weight[i] * (unsigned)(part * 255 / ((1UL << 4 * digits) - 1));
        colour = end + 1;
    }
    return luma > 127 * 1000;
}

void probe_reply(struct probe_replies *replies, const char *body)
{
    uint32_t n[32];
    const char *end;
    if (starts_with(body, "[?")) {
        unsigned count = read_numbers(body + 2, n, 32, &end);
        if (equals(end, "c")) {
            replies->da1 |= !replies->is_outer;
            for (unsigned i = 0; i < count; i++)
                if (!replies->is_outer)
                    replies->attributes |= n[i] < 64 ? UINT64_C(1) << n[i] : 0;
                else if (replies->outer_reports) /* tmux answers frames, without a name */
                    replies->outer.has_sixel |= n[i] == 4;
        } else if (equals(end, "S") && count == 4 && n[0] == 2 && n[1] == 0) {
            replies->image_width = n[2];
            replies->image_height = n[3];
        } else if (equals(end, "$y") && count == 2 && (n[0] == 2026 || n[0] == 1016)) {
            bool *has = n[0] == 2026 ? &replies->synchronizes : &replies->points;
            *has = n[1] == 1 || n[1] == 2;
        }
    } else if (starts_with(body, "[>")) {
        const unsigned count = read_numbers(body + 2, n, 32, &end);
        if (equals(end, "c")) {
            replies->kind = n[0];
            replies->version = count > 1 ? n[1] : 0;
        }
    } else if (starts_with(body, "P>|")) {
        replies->outer_reports |= replies->is_outer;
        snprintf(replies->is_outer ? replies->outer.name : replies->name, sizeof replies->name,
                 "%s", body + 3);
    } else if (starts_with(body, "]11;rgb:")) {
        replies->is_light = is_light(body + strlen("]11;rgb:"));
    } else if (body[0] == '_') {
        const size_t used = strlen(replies->answers), room = sizeof replies->answers - used;
        snprintf(replies->answers + used, room, "%s\n", body);
    } else if (body[0] == '[') {
        unsigned count = read_numbers(body + 1, n, 32, &end);
        if (equals(end, "R") && count == 2)
            replies->column = n[1];
        if (equals(end, "n") && replies->is_outer)
            replies->outer_answers = true;
        if (!equals(end, "t") || count != 3)
            return;
        if (n[0] == 6) {
            replies->cell_height = n[1];
            replies->cell_width = n[2];
        } else if (n[0] == 4) {
            replies->text_height = n[1];
            replies->text_width = n[2];
        }
    }
}

enum probe_heard probe_hear(struct probe *probe, const char *body)
{
    struct probe_replies *r = &probe->replies;
    const bool is_end = r->is_outer ? equals(body, "[0n") : keys_is_answer(body);
    if (probe->due == 0)
        return PROBE_IGNORES;
    if (probe->due == 1)
        probe_reply(r, body);
    if (is_end)
        probe->due--;
    return is_end && probe->due == 0         ? PROBE_HAS_ALL
           : is_end || !keys_is_answer(body) ? PROBE_HEARS
                                             : PROBE_IGNORES;
}

bool probe_take(struct probe *probe, struct keys *keys, const char *bytes, size_t length,
                struct buf *typed)
{
    struct key_event event;
    bool has_all = false;
    for (size_t i = 0; i < length; i++) {
        buf_add_char(typed, bytes[i]);
        if (!keys_feed(keys, (uint8_t)bytes[i], &event) || event.key != KEY_REPLY)
            continue;
        /* a reply is at the end of the bytes: remove it */
        if (!typed->failed && keys->taken <= typed->length) {
            typed->length -= keys->taken;
            typed->data[typed->length] = '\0';
        }
        has_all |= probe_hear(probe, keys->body) == PROBE_HAS_ALL;
    }
    return has_all;
}

/* ---- deciding ---- */

static bool contains(const char *text, const char *part)
{
    return strcasestr(text, part) != NULL;
}

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), least = strlen(end);
    return length >= least && strcmp(text + length - least, end) == 0;
}

/* Return true if one of the words, a list ended by NULL, fits. */
static bool any(bool fits(const char *, const char *), const char *text, const char *const *word)
{
    for (; text && *word; word++)
        if (fits(text, *word))
            return true;
    return false;
}

bool probe_is_plain(const char *term)
{
    static const char *const plain[] = {"", "dumb", "unknown", "network", "vt52", NULL};
    return any(equals, term, plain);
}

/* Return true for terminals that draw text in colours but print questions, or answer as if the user
 * typed. */
static bool is_console(const struct probe_environment *e)
{
    static const char *const console[] = {"linux", "eterm", "cons25", "sun", NULL};
    return any(starts_with, e->term, console);
}

bool probe_is_tmux(const struct probe_replies *replies)
{
    return starts_with(replies->name, "tmux") || replies->kind == KIND_TMUX ||
           (starts_with(replies->environment.term, "tmux") && replies->kind != KIND_SCREEN);
}

/* With TERM=screen it may be tmux too, depending on its settings. */
bool probe_is_screen(const struct probe_replies *replies)
{
    return replies->kind == KIND_SCREEN ||
           (starts_with(replies->environment.term, "screen") && !probe_is_tmux(replies));
}

bool probe_is_multiplexed(const struct probe_replies *replies)
{
    return probe_is_tmux(replies) || probe_is_screen(replies);
}

bool probe_is_silent(const struct probe_environment *e, struct probe_wish wish)
{
    return probe_is_plain(e->term) || is_console(e) || wish.depth == PROBE_NOTHING;
}

bool probe_has_word(const char *name, const char *const *names)
{
    return any(contains, name, names);
}

bool probe_is_named(const struct probe_replies *replies, const char *const *names)
{
    return any(contains, replies->name[0] ? replies->name : replies->environment.term, names);
}

/* Add questions for some terminals; return true if there are any. */
static bool add_questions(const struct probe *probe, struct buf *out)
{
    const size_t before = out->length;
    for (size_t i = 0; i < probe->wish.questions; i++) {
        const struct probe_question *q = &probe->wish.question[i];
        if (q->is_outer == probe->replies.is_outer && q->may_ask(&probe->replies))
            buf_add_text(out, q->text);
    }
    return out->length > before;
}

static void add_round(const struct probe *probe, struct buf *out)
{
    static const char *const careful[] = {"alacritty", "foot",    "contour", "kitty",
                                          "ghostty",   "wezterm", NULL};
    const struct probe_replies *r = &probe->replies;
    const size_t before = out->length;
    const bool all = probe->wish.depth == PROBE_ALL;
    switch (probe->rounds) {
    case 0:
        buf_printf(out, "%s%s", all ? CSI_QUESTIONS : "", PROBE_BARRIER);
        return;
    case 1:
        if (r->name[0] || (any(contains, r->environment.term, careful) && !probe_is_multiplexed(r)))
            buf_add_text(out, MODE_QUESTION);
        if (r->attributes >> 4 & 1)
            buf_add_text(out, SIDE_QUESTION);
        const bool clears_up = add_questions(probe, out);
        if (out->length > before)
            buf_printf(out, "%s%s", PROBE_BARRIER, clears_up ? CLEAR_UP : "");
        return;
    case FIRST_OUTER:
        if (probe->wish.needs_outer && probe_is_tmux(r) && r->outer.passing != TMUX_PASSES_NOTHING)
            buf_add_text(out, OUTER_NAME OUTER_END);
        return;
    default:
        if (r->outer_answers && add_questions(probe, out))
            buf_add_text(out, OUTER_END);
    }
}

bool probe_ask(struct probe *probe, struct buf *out)
{
    const size_t before = out->length;
    const bool all = probe->wish.depth == PROBE_ALL;
    if (probe_is_silent(&probe->replies.environment, probe->wish) ||
        (probe->due > 0 && probe->rounds > 0))
        return false;
    while (out->length == before && probe->rounds < (all ? FIRST_OUTER + 2 : 1)) {
        probe->replies.is_outer = probe->rounds >= FIRST_OUTER;
        add_round(probe, out);
        probe->rounds++;
    }
    probe->due += out->length > before;
    return out->length > before;
}

/* iTerm2 has reported its name only since 3.4; it sends LC_TERMINAL through ssh. A terminal with
 * another name was started inside iTerm2, and both variables are stale. */
bool probe_is_iterm(const struct probe_replies *replies)
{
    static const char *const name[] = {"iTerm2", NULL}, *const program[] = {"iTerm.app", NULL};
    if (probe_is_multiplexed(replies))
        return false;
    if (replies->name[0])
        return any(contains, replies->name, name);
    if (!replies->da1 || replies->kind == KIND_XTERM)
        return false;
    return any(equals, replies->environment.term_program, program) ||
           any(equals, replies->environment.lc_terminal, name);
}

/* COLORTERM does not survive ssh and is stale inside screen; tmux supports 24-bit colours itself
 * and converts them for the outer terminal. */
static enum colours decide_colours(const struct probe_replies *replies)
{
    const struct probe_environment *e = &replies->environment;
    static const char *const all[] = {"kitty",   "ghostty", "wezterm",   "konsole", "foot",
                                      "xterm(",  "tmux",    "alacritty", "iterm2",  "mintty",
                                      "contour", "vte",     "xterm.js",  "direct",  NULL};
    static const char *const few[] = {"rxvt", "xterm-color", "ansi", "pcansi", "cygwin", NULL};
    static const char *const says_all[] = {"truecolor", "24bit", NULL};
    if (e->no_color || probe_is_plain(e->term) || starts_with(e->term, "vt"))
        return COLOURS_NONE;
    if (probe_is_screen(replies))
        return COLOURS_256;
    if (any(contains, replies->name, all) || any(contains, e->term, all) ||
        replies->kind == KIND_VTE)
        return COLOURS_24BIT;
    if (is_console(e) || any(equals, e->term, few) || ends_with(e->term, "-16color"))
        return COLOURS_16;
    return any(equals, e->colorterm, says_all) || probe_is_iterm(replies) ? COLOURS_24BIT
                                                                          : COLOURS_256;
}

/* Return the name of the terminal that draws: of the one outside tmux, "" if unknown. */
static const char *drawing_name(const struct probe_replies *replies)
{
    return probe_is_screen(replies) ? ""
           : probe_is_tmux(replies) ? replies->outer.name
           : replies->name[0]       ? replies->name
                                    : replies->environment.term;
}

static bool draws_sextants(const struct probe_replies *replies)
{
    static const char *const sextant[] = {"kitty", "foot", "wezterm", "ghostty", "contour", NULL};
    const char *name = drawing_name(replies);
    const uint32_t vte = starts_with(name, "VTE(")   ? (uint32_t)strtoul(name + 4, NULL, 10)
                         : replies->kind == KIND_VTE ? replies->version
                                                     : 0;
    if (!replies->name[0] && !replies->kind) /* TERM may be stale inside screen */
        return false;
    return vte >= VTE_SEXTANTS || any(contains, name, sextant);
}

bool probe_asks_for_sextants(const struct probe_replies *replies)
{
    return draws_sextants(replies) || (probe_is_tmux(replies) && !replies->outer.name[0]);
}

/* Half blocks are in every font. */
enum block_shape probe_shape(const struct probe_replies *replies)
{
    static const char *const quadrant[] = {"alacritty", "konsole", "iterm2", "vte", "xterm(", NULL};
    if (draws_sextants(replies))
        return replies->column == 2 ? BLOCK_SEXTANT : BLOCK_QUADRANT;
    return any(contains, drawing_name(replies), quadrant) || replies->kind == KIND_VTE
               ? BLOCK_QUADRANT
               : BLOCK_HALF;
}

static bool use_cell(struct terminal_facts *facts, uint32_t width, uint32_t height)
{
    if (width < CELL_LEAST || width > CELL_MOST || height < CELL_LEAST || height > CELL_MOST)
        return false;
    facts->cell_width = width;
    facts->cell_height = height;
    return true;
}

bool probe_resize(struct terminal_facts *facts, const struct term_size *size)
{
    return use_cell(facts, size->width_px / size->columns, size->height_px / size->rows);
}

void probe_decide(const struct probe_replies *replies, const struct term_size *size,
                  struct terminal_facts *facts)
{
    *facts = (struct terminal_facts){.colours = decide_colours(replies),
                                     .cell_width = 8,
                                     .cell_height = 16,
                                     .image_side_most = SIDE_UNTOLD,
                                     .shape = probe_shape(replies),
                                     .answers = replies->da1,
                                     .barrier = PROBE_BARRIER,
                                     .is_light = replies->is_light,
                                     .synchronizes = replies->synchronizes,
                                     .mouse = replies->da1};
    bool has_cell =
        use_cell(facts, replies->cell_width, replies->cell_height) ||
        use_cell(facts, replies->text_width / size->columns, replies->text_height / size->rows);
    has_cell |= probe_resize(facts, size);
    /* Use pixels only if the size of a cell is known. kitty and ghostty count pixels from 0. */
    static const char *const from_0[] = {"kitty", "ghostty", NULL};
    facts->mouse_unit = !replies->points || !has_cell     ? MOUSE_CELLS
                        : probe_is_named(replies, from_0) ? MOUSE_PIXELS_FROM_0
                                                          : MOUSE_PIXELS;
    if (replies->image_width > 0 && replies->image_height > 0)
        facts->image_side_most = replies->image_width < replies->image_height
                                     ? replies->image_width
                                     : replies->image_height;
}

/* ---- asking ---- */

static const char *variable(const char *name)
{
    const char *value = getenv(name);
    return value ? value : "";
}

struct probe_environment probe_environment_now(void)
{
    return (struct probe_environment){.term = variable("TERM"),
                                      .colorterm = variable("COLORTERM"),
                                      .term_program = variable("TERM_PROGRAM"),
                                      .lc_terminal = variable("LC_TERMINAL"),
                                      .no_color = *variable("NO_COLOR")};
}

/* Read until all answers that are due have arrived. Ctrl-C stops waiting for a silent terminal. */
static void await_replies(struct probe *probe, int limit_ms, struct buf *typed)
{
    struct keys keys = {0};
    OWNED(buf_release) struct buf bytes = {0};
    const uint64_t end = clock_ns() + (uint64_t)limit_ms * 1000000;
    while (probe->due > 0 && !memchr(buf_text(typed), 3, typed->length)) {
        const uint64_t now = clock_ns();
        if (now >= end)
            break;
        enum term_input input = term_read(&bytes, (int)((end - now) / 1000000) + 1, -1);
        if (input == TERM_CLOSED)
            break;
        if (input == TERM_SIGNAL) /* nothing is drawn yet that would have to be redrawn */
            term_was_continued();
        probe_take(probe, &keys, buf_text(&bytes), bytes.length, typed);
        buf_clear(&bytes);
    }
}

unsigned probe_await(unsigned count, int limit_ms, struct buf *typed)
{
    struct probe ignored = {.due = count};
    await_replies(&ignored, limit_ms, typed);
    return count - ignored.due;
}

void probe_leave(const struct terminal_facts *facts, unsigned due)
{
    OWNED(buf_release) struct buf typed = {0};
    if (term_write_end(NULL) == OK) {
        const bool expects = due > 0 || facts->reports;
        const uint64_t slow_ms = 2 * facts->round_trip_ns / 1000000;
        if (expects && facts->answers &&
            term_write(facts->barrier, strlen(facts->barrier), NULL) == OK)
            probe_await(due + 1,
                        (int)least_64(slow_ms > LEAVE_MS ? slow_ms : LEAVE_MS, LEAVE_MOST_MS),
                        &typed);
        else if (facts->answer_due)
            probe_await(1, OWED_MS, &typed);
    }
}

bool probe_write(struct probe *probe)
{
    OWNED(buf_release) struct buf questions = {0};
    if (!probe_ask(probe, &questions))
        return false;
    probe->asked_ns = clock_ns();
    return !questions.failed && term_write(buf_text(&questions), questions.length, NULL) == OK;
}

void probe_terminal(struct probe *probe, int limit_ms, uint64_t *round_trip_ns, struct buf *typed)
{
    const struct probe_replies *r = &probe->replies;
    *round_trip_ns = 0;
    while (probe_write(probe)) {
        /* If tmux passes nothing there is no answer, and usually tmux does not tell. */
        const bool is_sure = !r->is_outer || r->outer.passing == TMUX_PASSES;
        await_replies(probe, is_sure ? limit_ms : OUTER_MS, typed);
        if (probe->due == 0)
            *round_trip_ns = clock_ns() - probe->asked_ns;
        if (probe->rounds == 1 && probe->due == 0 && probe->wish.needs_outer && probe_is_tmux(r))
            tmux_ask(&probe->replies.outer);
    }
}
