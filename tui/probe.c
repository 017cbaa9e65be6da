/* SPDX-License-Identifier: MIT */
#include "tui/probe.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"

#define BARRIER       "\033[c"
#define CSI_QUESTIONS "\033[>c\033[>q\033[16t\033[14t"
#define MODE_QUESTION "\033[?2026$p\033[?1016$p"
#define SIDE_QUESTION "\033[?2;4;0S"
#define CLEAR_UP      "\r\033[K"

enum { LIMIT_MS = 2000, OWED_MS = 300 };
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

void probe_reply(struct probe_replies *replies, const char *body)
{
    uint32_t n[32];
    const char *end;
    if (starts_with(body, "[?")) {
        unsigned count = read_numbers(body + 2, n, 32, &end);
        if (equals(end, "c")) {
            replies->da1 = true;
            for (unsigned i = 0; i < count; i++)
                replies->attributes |= n[i] < 64 ? UINT64_C(1) << n[i] : 0;
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
        size_t length = strnlen(body + 3, sizeof replies->name - 1);
        memcpy(replies->name, body + 3, length);
        replies->name[length] = '\0';
    } else if (body[0] == '_') {
        const size_t used = strlen(replies->answers), room = sizeof replies->answers - used;
        snprintf(replies->answers + used, room, "%s\n", body);
    } else if (body[0] == '[') {
        unsigned count = read_numbers(body + 1, n, 32, &end);
        if (equals(end, "R") && count == 2)
            replies->column = n[1];
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

bool probe_take(struct probe_replies *replies, struct keys *keys, const char *bytes, size_t length,
                struct buf *typed)
{
    struct key_event event;
    bool before = replies->da1, seen = false;
    for (size_t i = 0; i < length; i++) {
        buf_add_char(typed, bytes[i]);
        if (!keys_feed(keys, (uint8_t)bytes[i], &event) || event.key != KEY_REPLY)
            continue;
        /* a reply is at the end of the bytes: remove it */
        if (!typed->failed && keys->taken <= typed->length) {
            typed->length -= keys->taken;
            typed->data[typed->length] = '\0';
        }
        replies->da1 = false;
        probe_reply(replies, keys->body);
        seen |= replies->da1;
    }
    replies->da1 = before || seen;
    return seen;
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

static bool in_tmux(const struct probe_replies *replies)
{
    return starts_with(replies->name, "tmux") || replies->kind == KIND_TMUX ||
           (starts_with(replies->environment.term, "tmux") && replies->kind != KIND_SCREEN);
}

/* With TERM=screen it may be tmux too, depending on its settings. */
bool probe_is_screen(const struct probe_replies *replies)
{
    return replies->kind == KIND_SCREEN ||
           (starts_with(replies->environment.term, "screen") && !in_tmux(replies));
}

bool probe_is_multiplexed(const struct probe_replies *replies)
{
    return in_tmux(replies) || probe_is_screen(replies);
}

bool probe_is_silent(const struct probe_environment *e, struct probe_wish wish)
{
    return probe_is_plain(e->term) || is_console(e) || wish.depth == PROBE_NOTHING;
}

bool probe_is_named(const struct probe_replies *replies, const char *const *names)
{
    return any(contains, replies->name[0] ? replies->name : replies->environment.term, names);
}

void probe_questions(unsigned round, const struct probe_replies *replies, struct probe_wish wish,
                     struct buf *out)
{
    static const char *const careful[] = {"alacritty", "foot",    "contour", "kitty",
                                          "ghostty",   "wezterm", NULL};
    const size_t before = out->length;
    const bool first = round == 0, all = wish.depth == PROBE_ALL;
    bool clears_up = false;
    if (probe_is_silent(&replies->environment, wish) || round > 1 ||
        (!first && (!all || !replies->da1)))
        return;
    if (first && all)
        buf_add_text(out, CSI_QUESTIONS);
    if (!first && (replies->name[0] || (any(contains, replies->environment.term, careful) &&
                                        !probe_is_multiplexed(replies))))
        buf_add_text(out, MODE_QUESTION);
    if (!first && replies->attributes >> 4 & 1)
        buf_add_text(out, SIDE_QUESTION);
    for (size_t i = 0; !first && i < wish.questions; i++)
        if (wish.question[i].may_ask(replies)) {
            buf_add_text(out, wish.question[i].text);
            clears_up = true;
        }
    if (first || out->length > before)
        buf_add_text(out, BARRIER);
    if (clears_up)
        buf_add_text(out, CLEAR_UP);
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
           : in_tmux(replies)       ? replies->outer.name
           : replies->name[0]       ? replies->name
                                    : replies->environment.term;
}

bool probe_draws_sextants(const struct probe_replies *replies)
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

/* Half blocks are in every font. */
enum block_shape probe_shape(const struct probe_replies *replies)
{
    static const char *const quadrant[] = {"alacritty", "konsole", "iterm2", "vte", "xterm(", NULL};
    if (probe_draws_sextants(replies))
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

/* Read until `count` DA1 replies arrived. Ctrl-C stops waiting for a silent terminal. */
static unsigned await_replies(struct probe_replies *replies, unsigned count, int limit_ms,
                              struct buf *typed)
{
    struct keys keys = {0};
    OWNED(buf_release) struct buf bytes = {0};
    uint64_t end = clock_ns() + (uint64_t)limit_ms * 1000000;
    unsigned seen = 0;
    while (seen < count && !memchr(buf_text(typed), 3, typed->length)) {
        uint64_t now = clock_ns();
        if (now >= end)
            break;
        enum term_input input = term_read(&bytes, (int)((end - now) / 1000000) + 1, -1);
        if (input == TERM_CLOSED)
            break;
        if (input == TERM_SIGNAL) /* nothing is drawn yet that would have to be redrawn */
            term_was_continued();
        for (size_t i = 0; i < bytes.length; i++)
            seen += probe_take(replies, &keys, bytes.data + i, 1, typed);
        buf_clear(&bytes);
    }
    return seen;
}

unsigned probe_await(unsigned count, int limit_ms, struct buf *typed)
{
    struct probe_replies ignored = {0};
    return await_replies(&ignored, count, limit_ms, typed);
}

void probe_leave(const struct terminal_facts *facts, unsigned due)
{
    OWNED(buf_release) struct buf typed = {0};
    if (term_write_end(NULL) == OK) {
        const bool expects = due > 0 || facts->reports;
        if (expects && facts->answers && term_write(BARRIER, sizeof BARRIER - 1, NULL) == OK)
            probe_await(due + 1, LIMIT_MS, &typed);
        else if (facts->answer_due)
            probe_await(1, OWED_MS, &typed);
    }
}

enum err probe_terminal(struct probe_wish wish, struct probe_replies *replies,
                        struct terminal_facts *facts, struct buf *typed, struct fault *fault)
{
    OWNED(buf_release) struct buf questions = {0};
    uint64_t round_trip_ns = 0;
    bool answer_due = false;
    enum err err = OK;
    for (unsigned round = 0; !err && round < 2; round++) {
        buf_clear(&questions);
        probe_questions(round, replies, wish, &questions);
        if (questions.failed)
            err = fault_memory(fault, "the questions to the terminal");
        else if (questions.length > 0)
            err = term_write(questions.data, questions.length, fault);
        if (err || questions.length == 0)
            break;
        const uint64_t begin = clock_ns();
        answer_due = await_replies(replies, 1, LIMIT_MS, typed) == 0;
        if (!answer_due)
            round_trip_ns = clock_ns() - begin;
        if (round == 0 && wish.depth == PROBE_ALL && in_tmux(replies))
            tmux_ask(&replies->outer);
    }
    const struct term_size size = term_size();
    probe_decide(replies, &size, facts);
    facts->round_trip_ns = round_trip_ns;
    facts->answer_due = answer_due;
    return err;
}
