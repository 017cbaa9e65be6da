/*
 * What the terminal can do: asked once, at the start, with queries that no terminal prints.
 *
 *     ESC[>c ESC[>q ESC[16t ESC[14t ESC[?2;4;0S ESC[c          one write, then read until DA1
 *
 *     ESC[?62;4;22c            DA1: parameter 4, as a whole number, means sixel
 *     ESC P >|kitty(0.26.5) ESC \    XTVERSION: the name
 *     ESC[6;18;9t              a cell is 18 px high and 9 wide
 *     ESC[4;450;720t           the text area in px
 *     ESC[?2;0;1000;1000S      the largest picture
 *
 * Every terminal answers DA1, and answers in order, so DA1 ends the replies. Only a terminal that
 * names itself as one of the kitty family is asked for kitty graphics: others print that question.
 * Inside tmux and screen the outer terminal does not matter, the multiplexer's own DA1 does, and
 * screen passes no graphics at all.
 *
 * Whatever is typed meanwhile is kept. The parts that decide are pure: replies and environment in,
 * facts out.
 */
#ifndef TUI_PROBE_H
#define TUI_PROBE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/blocks.h"
#include "tui/keys.h"
#include "tui/term.h"

enum graphics {
    GRAPHICS_AUTO, /* as a wish only: the best the terminal has */
    GRAPHICS_NONE,
    GRAPHICS_BLOCKS,
    GRAPHICS_SIXEL,
    GRAPHICS_KITTY,
    GRAPHICS_ITERM
};

/* "auto", "none", "blocks", "sixel", "kitty", "iterm". */
bool graphics_from_name(const char *name, enum graphics *out);

struct terminal_facts {
    enum graphics graphics; /* never GRAPHICS_AUTO */
    enum colours colours;
    uint32_t cell_width, cell_height; /* px, 4..64 */
    uint32_t image_side_most;         /* px; a larger picture may not be drawn at all */
    enum block_shape shape;           /* the finest that its font is known to have */
    bool answers;                     /* it answered DA1: barriers work */
    bool synchronizes;                /* ESC[?2026h .. l: what is between appears at once */
    bool mouse;                       /* may be asked for SGR mouse reports: ESC[?1000;1006h */
    bool kitty_is_still; /* kitty graphics without a=f (ghostty, Konsole): nothing can be changed
                            in place, so every picture goes whole */
};

/* ---- pure ---- */

struct probe_environment {
    const char *term, *colorterm; /* "" where unset */
    bool no_color;
};

struct probe_replies {
    bool da1, sixel, kitty;
    char name[64]; /* of XTVERSION */
    uint32_t cell_width, cell_height, text_width, text_height, image_width, image_height; /* px */
};

/* Takes the body of one reply (KEY_REPLY in tui/keys.h), "[?62;4c" or "P>|kitty(0.26.5)". What is
 * not understood changes nothing. */
void probe_reply(struct probe_replies *replies, const char *body);

/* Takes bytes as they are read. Replies go into `replies`, all else is added to `typed`. Returns
 * true when a DA1 was among them. */
bool probe_take(struct probe_replies *replies, struct keys *keys, const char *bytes, size_t length,
                struct buf *typed);

/* Whether `wish` in this environment needs no question at all. */
bool probe_is_silent(const struct probe_environment *environment, enum graphics wish);

/* Whether the question for kitty graphics may be asked. */
bool probe_may_ask_kitty(const struct probe_replies *replies,
                         const struct probe_environment *environment);

void probe_decide(const struct probe_replies *replies, const struct probe_environment *environment,
                  const struct term_size *size, enum graphics wish, struct terminal_facts *facts);

/* The cell size anew, after the window changed; what the window does not say stays. */
void probe_resize(struct terminal_facts *facts, const struct term_size *size);

/* ---- at the terminal, which must be open and raw ---- */

struct probe_environment probe_environment_now(void);

/* Asks (at most 2 s without an answer) and decides. What was typed meanwhile is added to `typed`.
 */
enum err probe_terminal(enum graphics wish, struct terminal_facts *facts, struct buf *typed,
                        struct fault *fault);

/* Waits until the terminal has answered `count` DA1 questions, at most `limit_ms`: everything
 * written before is on screen then. What was typed is added to `typed`. Returns those answered. */
unsigned probe_await(unsigned count, int limit_ms, struct buf *typed);

#endif
