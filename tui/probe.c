#include "tui/probe.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

#define CSI_QUESTIONS  "\033[>c\033[>q\033[16t\033[14t\033[?2;4;0S\033[c"
#define KITTY_QUESTION "\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\\\033[c"

enum { LIMIT_MS = 2000, SIDE_UNTOLD = 1000, CELL_LEAST = 4, CELL_MOST = 64 };

bool graphics_from_name(const char *name, enum graphics *out)
{
    static const char *const names[] = {"auto", "none", "blocks", "sixel", "kitty", "iterm"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(name, names[i]) == 0) {
            *out = (enum graphics)i;
            return true;
        }
    }
    return false;
}

/* ---- replies ---- */

static bool starts_with(const char *text, const char *start)
{
    return strncmp(text, start, strlen(start)) == 0;
}

/* Numbers parted by semicolons; returns how many, and sets *end to what follows. */
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

static bool is_end(const char *text, const char *final)
{
    return strcmp(text, final) == 0;
}

void probe_reply(struct probe_replies *replies, const char *body)
{
    uint32_t n[32];
    const char *end;
    if (starts_with(body, "[?")) {
        unsigned count = read_numbers(body + 2, n, 32, &end);
        if (is_end(end, "c")) {
            replies->da1 = true;
            for (unsigned i = 0; i < count; i++)
                replies->sixel |= n[i] == 4;
        } else if (is_end(end, "S") && count == 4 && n[0] == 2 && n[1] == 0) {
            replies->image_width = n[2];
            replies->image_height = n[3];
        }
    } else if (starts_with(body, "P>|")) {
        size_t length = strnlen(body + 3, sizeof replies->name - 1);
        memcpy(replies->name, body + 3, length);
        replies->name[length] = '\0';
    } else if (starts_with(body, "_G")) {
        replies->kitty |= strstr(body, ";OK") != NULL;
    } else if (body[0] == '[') {
        unsigned count = read_numbers(body + 1, n, 32, &end);
        if (!is_end(end, "t") || count != 3)
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
        /* a reply stands at the end of what came: take it out again */
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

static bool is_plain(const struct probe_environment *e)
{
    return *e->term == '\0' || strcmp(e->term, "dumb") == 0;
}

static bool is_multiplexed(const struct probe_environment *e)
{
    return starts_with(e->term, "screen") || starts_with(e->term, "tmux");
}

bool probe_is_silent(const struct probe_environment *e, enum graphics wish)
{
    return is_plain(e) || starts_with(e->term, "linux") || wish == GRAPHICS_NONE ||
           wish == GRAPHICS_BLOCKS || (wish == GRAPHICS_AUTO && e->no_color);
}

static bool names_any(const char *text, const char *const *name)
{
    for (; *name; name++)
        if (strcasestr(text, *name))
            return true;
    return false;
}

bool probe_may_ask_kitty(const struct probe_replies *replies, const struct probe_environment *e)
{
    static const char *const family[] = {"kitty", "ghostty", "wezterm", "konsole", NULL};
    if (is_multiplexed(e) || starts_with(replies->name, "tmux"))
        return false;
    return names_any(replies->name[0] ? replies->name : e->term, family);
}

static enum graphics decide_graphics(const struct probe_replies *replies,
                                     const struct probe_environment *e, enum graphics wish)
{
    bool in_screen = starts_with(e->term, "screen") && !starts_with(replies->name, "tmux");
    if (wish != GRAPHICS_AUTO)
        return wish;
    if (is_plain(e))
        return GRAPHICS_NONE;
    if (e->no_color || in_screen)
        return GRAPHICS_BLOCKS;
    if (replies->kitty)
        return GRAPHICS_KITTY;
    return replies->sixel ? GRAPHICS_SIXEL : GRAPHICS_BLOCKS;
}

/* COLORTERM does not survive ssh and is stale inside screen; tmux knows 24-bit colours itself and
 * converts them to what is outside. */
static enum colours decide_colours(const struct probe_replies *replies,
                                   const struct probe_environment *e)
{
    static const char *const all_colours[] = {"kitty",     "ghostty", "wezterm", "konsole", "foot",
                                              "alacritty", "xterm(",  "tmux",    "direct",  NULL};
    if (e->no_color || is_plain(e) || starts_with(e->term, "vt"))
        return COLOURS_NONE;
    if (names_any(replies->name, all_colours) || names_any(e->term, all_colours))
        return COLOURS_24BIT;
    if (starts_with(e->term, "screen"))
        return COLOURS_256;
    bool told = strcmp(e->colorterm, "truecolor") == 0 || strcmp(e->colorterm, "24bit") == 0;
    return told ? COLOURS_24BIT : COLOURS_256;
}

static bool use_cell(struct terminal_facts *facts, uint32_t width, uint32_t height)
{
    if (width < CELL_LEAST || width > CELL_MOST || height < CELL_LEAST || height > CELL_MOST)
        return false;
    facts->cell_width = width;
    facts->cell_height = height;
    return true;
}

void probe_resize(struct terminal_facts *facts, const struct term_size *size)
{
    use_cell(facts, size->width_px / size->columns, size->height_px / size->rows);
}

void probe_decide(const struct probe_replies *replies, const struct probe_environment *e,
                  const struct term_size *size, enum graphics wish, struct terminal_facts *facts)
{
    *facts = (struct terminal_facts){.graphics = decide_graphics(replies, e, wish),
                                     .colours = decide_colours(replies, e),
                                     .cell_width = 8,
                                     .cell_height = 16,
                                     .image_side_most = SIDE_UNTOLD,
                                     .answers = replies->da1};
    if (!use_cell(facts, replies->cell_width, replies->cell_height))
        use_cell(facts, replies->text_width / size->columns, replies->text_height / size->rows);
    probe_resize(facts, size);
    if (replies->image_width > 0 && replies->image_height > 0)
        facts->image_side_most = replies->image_width < replies->image_height
                                     ? replies->image_width
                                     : replies->image_height;
}

/* ---- asking ---- */

struct probe_environment probe_environment_now(void)
{
    const char *term = getenv("TERM"), *colorterm = getenv("COLORTERM");
    const char *no_color = getenv("NO_COLOR");
    return (struct probe_environment){.term = term ? term : "",
                                      .colorterm = colorterm ? colorterm : "",
                                      .no_color = no_color && *no_color};
}

/* Reads until `count` DA1 replies came. Ctrl-C gives up on a silent terminal. */
static unsigned await_replies(struct probe_replies *replies, unsigned count, int limit_ms,
                              struct buf *typed)
{
    struct keys keys = {0};
    struct buf bytes = {0};
    uint64_t end = clock_ns() + (uint64_t)limit_ms * 1000000;
    unsigned seen = 0;
    while (seen < count && !memchr(buf_text(typed), 3, typed->length)) {
        uint64_t now = clock_ns();
        if (now >= end)
            break;
        enum term_input input = term_read(&bytes, (int)((end - now) / 1000000) + 1);
        if (input == TERM_CLOSED)
            break;
        if (input == TERM_SIGNAL) { /* nothing is drawn yet that could need drawing again */
            term_was_resized();
            term_was_continued();
        }
        for (size_t i = 0; i < bytes.length; i++)
            seen += probe_take(replies, &keys, bytes.data + i, 1, typed);
        buf_clear(&bytes);
    }
    buf_release(&bytes);
    return seen;
}

unsigned probe_await(unsigned count, int limit_ms, struct buf *typed)
{
    struct probe_replies ignored = {0};
    return await_replies(&ignored, count, limit_ms, typed);
}

enum err probe_terminal(enum graphics wish, struct terminal_facts *facts, struct buf *typed,
                        struct fault *fault)
{
    const struct probe_environment e = probe_environment_now();
    struct probe_replies replies = {0};
    enum err err = OK;
    if (!probe_is_silent(&e, wish)) {
        err = term_write(CSI_QUESTIONS, sizeof CSI_QUESTIONS - 1, fault);
        if (!err)
            await_replies(&replies, 1, LIMIT_MS, typed);
    }
    if (!err && replies.da1 && wish == GRAPHICS_AUTO && probe_may_ask_kitty(&replies, &e)) {
        err = term_write(KITTY_QUESTION, sizeof KITTY_QUESTION - 1, fault);
        if (!err)
            await_replies(&replies, 1, LIMIT_MS, typed);
        if (!err)
            err = term_write("\r\033[K", 4, fault);
    }
    const struct term_size size = term_size();
    probe_decide(&replies, &e, &size, wish, facts);
    return err;
}
