/* SPDX-License-Identifier: MIT */
/*
 * Detect the features of the terminal: once, at the start, with questions that no terminal prints.
 *
 *     ESC[>c ESC[>q ESC[16t ESC[14t ESC[c                      one write, then read until DA1
 *
 *     ESC[?62;4;22c            DA1: parameter 4, as a whole number, means sixel
 *     ESC P >|kitty(0.26.5) ESC \    XTVERSION: the name
 *     ESC[6;18;9t              a cell is 18 px high and 9 wide
 *     ESC[4;450;720t           the text area in px
 *
 * Every terminal answers DA1, and answers in order, so DA1 ends the replies. Questions that some
 * terminals print, or log as an error, are in a second write, and only for terminals that have
 * reported a name or, for the last, sixel:
 *
 *     ESC[?2026$p ESC[c        synchronized output; Apple's Terminal prints the p
 *     ESC[?1016$p              reports of the mouse by pixels, in the same write
 *     ESC]11;? ESC\            ESC]11;rgb:ffff/ffff/ffff ESC\: the background, in the same write
 *     ESC[?2;4;0S ESC[c        ESC[?2;0;1000;1000S: the largest picture of sixel; kitty complains
 *     ESC_Gi=31,..,a=q;.. ESC\ ESC[c CR ESC[K      kitty graphics, for its family alone; PuTTY,
 *                                                  urxvt and screen print it all
 *
 *     CR U+1FB00 ESC[6n        ESC[6;2R: it moves the cursor by one cell; only for terminals that
 *                              are known to draw it
 *
 * Inside tmux and screen neither the outer terminal nor the environment counts: the DA1 of the
 * multiplexer does, and screen passes no graphics at all. The secondary DA names either of them
 * whatever TERM is: ESC[>83;.. screen, ESC[>84;.. tmux. tmux itself is asked which terminal it is
 * shown in (tui/tmux.h). Unless it passes nothing, that terminal is asked too, through it:
 *
 *     ESC[>q ESC[c ESC[5n                  its name, and whether it has sixel; ESC[0n is the end,
 *                                          since tmux itself may answer a later DA1 question first
 *     ESC_Gi=31,..,a=q;.. ESC\ ESC[5n      kitty graphics, for terminals that report a name
 *
 * The Linux console and similar terminals get no question. For a shape of text (--graphics halves)
 * or without colours the only question is ESC[c, since the frames of a slow line need its answers;
 * for "none" there is no question.
 *
 * Keys typed meanwhile are kept. The deciding functions are pure: replies and environment in, facts
 * out.
 */
#ifndef TUI_PROBE_H
#define TUI_PROBE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/keys.h"
#include "tui/term.h"
#include "tui/tmux.h"

enum { PROBE_QUESTIONS_MOST = 8 }; /* questions for some terminals only */

enum colours { COLOURS_NONE, COLOURS_16, COLOURS_256, COLOURS_24BIT };

/* Pixels that a cell of text shows in two colours: 1x2, 2x2 (U+2596..259F) or 2x3
 * (U+1FB00..1FB3B). */
enum block_shape { BLOCK_HALF, BLOCK_QUADRANT, BLOCK_SEXTANT };

struct terminal_facts {
    const struct graphics *graphics; /* the protocol for pictures (tui/picture/graphics.h) */
    enum colours colours;
    uint32_t cell_width, cell_height; /* px, 4..64 */
    uint32_t image_side_most;         /* px; a larger picture may not be drawn at all */
    unsigned images_most;   /* pictures that tmux keeps, to draw them again; 0: any number */
    enum block_shape shape; /* pictures of text have this one */
    bool answers;           /* it answered DA1, so barriers work */
    const char *barrier;    /* the question at the end of a frame, whose answer is a DA1 */
    const char *advice;     /* on better pictures, or NULL */
    uint8_t space;          /* for numbers of pictures that rarely occur twice in a terminal */
    bool answer_due;        /* it was asked and has not answered yet */
    bool is_light;          /* the background is light */
    bool synchronizes;      /* ESC[?2026h .. l: output between them appears at once */
    uint64_t round_trip_ns; /* from a question to its answer; 0 without an answer */
    bool reports; /* more may arrive or be drawn: mouse reports were requested, or a picture sent */
    bool mouse;   /* SGR mouse reports may be requested: ESC[?1000;1006h, */
    enum mouse_unit mouse_unit; /* and in pixels by ESC[?1016h, unless this is MOUSE_CELLS */
};

#define PROBE_BARRIER       "\033[c"
#define PROBE_OUTER_BARRIER "\033Ptmux;\033\033[c\033\\" /* for the terminal outside tmux */

/* ---- pure ---- */

struct probe_environment {
    const char *term, *colorterm, *term_program, *lc_terminal; /* "" or NULL where unset */
    bool no_color;
};

struct probe_replies {
    struct probe_environment environment; /* the rest is from the terminal */
    bool da1, synchronizes, points;       /* in pixels, by ESC[?1016h */
    bool is_light;                        /* the background, by ESC]11;? */
    uint64_t attributes; /* parameters of DA1: bit N for parameter N below 64; 4 is sixel */
    char answers
        [64];      /* replies to questions about graphics protocols, APC: "_Gi=31;OK", one a line */
    uint32_t kind; /* the first number of the secondary DA; if it is a letter, its code */
    uint32_t version; /* the second number */
    uint32_t column;  /* column of the cursor, from 1, after U+1FB00 at the edge; 0: unknown */
    char name[64];    /* from XTVERSION */
    struct tmux_client outer; /* the terminal outside, inside tmux; zeroed if unknown */
    bool is_outer; /* the questions are for it; it has reported its name, and answered all */
    bool outer_reports, outer_answers;
    uint32_t cell_width, cell_height, text_width, text_height, image_width, image_height; /* px */
};

/* Read the body of one reply (KEY_REPLY in tui/keys.h), "[?62;4c" or "P>|kitty(0.26.5)". An unknown
 * reply changes nothing. */
void probe_reply(struct probe_replies *replies, const char *body);

/* Return true if a terminal of this name gets no escape sequence at all: TERM=dumb. */
bool probe_is_plain(const char *term);

/* Return true if the terminal is inside tmux or screen. */
bool probe_is_multiplexed(const struct probe_replies *replies);

/* Return true if it is inside screen, which passes no pixels on; or inside tmux. */
bool probe_is_screen(const struct probe_replies *replies);
bool probe_is_tmux(const struct probe_replies *replies);

/* Return true if the terminal's name, or TERM if it has reported none, contains one of `names`, a
 * list ended by NULL. */
bool probe_is_named(const struct probe_replies *replies, const char *const *names);

/* Return true if a name contains one of `names`, in any case. */
bool probe_has_word(const char *name, const char *const *names);

bool probe_is_iterm(const struct probe_replies *replies);

/* Return true if the width of sextants matters: it is known to draw them itself, whatever its font
 * has. Inside tmux that is the terminal outside, which may be unknown. */
bool probe_asks_for_sextants(const struct probe_replies *replies);

/* Return the finest shape that the terminal is known to show. */
enum block_shape probe_shape(const struct probe_replies *replies);

/* ---- the questions ---- */

enum probe_depth {
    PROBE_NOTHING,  /* no questions */
    PROBE_BARRIERS, /* only whether it answers frames */
    PROBE_ALL
};

/* Questions for this terminal, in addition to those for every terminal. */
struct probe_wish {
    enum probe_depth depth;
    struct probe_question {
        const char *text;
        bool (*may_ask)(const struct probe_replies *);
        bool is_outer; /* for the terminal outside tmux */
    } question[PROBE_QUESTIONS_MOST];
    size_t questions;
    bool needs_outer; /* the terminal outside tmux matters */
};

/* Return true if `wish` in this environment allows no question at all. */
bool probe_is_silent(const struct probe_environment *environment, struct probe_wish wish);

/*
 * Rounds of questions, and their answers.
 *
 *     struct probe probe = {.wish = wish, .replies.environment = environment};
 *     while (probe_ask(&probe, &out)) .. write `out`; probe_hear(..) until it has all ..
 *     probe_decide(&probe.replies, ..)
 *
 * Answers that do not come are waited for during the whole session.
 */
struct probe {
    struct probe_wish wish;
    struct probe_replies replies;
    unsigned rounds;   /* asked so far */
    unsigned due;      /* ends of answers that have not arrived, those to other questions first */
    uint64_t asked_ns; /* time of the last questions */
};

/* Add the questions of the next round, which end with one that every terminal answers, and a
 * sequence that removes printed questions. Return false after the last round. */
bool probe_ask(struct probe *probe, struct buf *out);

/* Read the body of a reply (KEY_REPLY in tui/keys.h). */
enum probe_heard {
    PROBE_IGNORES, /* no answer to a question of the probe */
    PROBE_HEARS,
    PROBE_HAS_ALL /* it was the last of this round */
};
enum probe_heard probe_hear(struct probe *probe, const char *body);

/* Feed bytes as they are read. Replies are heard, other bytes are added to `typed`. Return true if
 * all answers of the round have come. */
bool probe_take(struct probe *probe, struct keys *keys, const char *bytes, size_t length,
                struct buf *typed);

/* Derive all facts except `graphics`, which is set to NULL. */
void probe_decide(const struct probe_replies *replies, const struct term_size *size,
                  struct terminal_facts *facts);

/* Update the cell size after the window changed; false, and unchanged, if the window does not
 * report it. */
bool probe_resize(struct terminal_facts *facts, const struct term_size *size);

/* ---- at the terminal, which must be open and raw ---- */

struct probe_environment probe_environment_now(void);

/* Write the questions of the next round. Return false after the last round. */
bool probe_write(struct probe *probe);

/* Ask all rounds, each for at most `limit_ms` without an answer; then answers are due. Set the time
 * of the last one; 0 without. Keys typed meanwhile are added to `typed`. */
void probe_terminal(struct probe *probe, int limit_ms, uint64_t *round_trip_ns, struct buf *typed);

/* Wait until the terminal has answered `count` DA1 questions, at most `limit_ms`: everything
 * written before is then on screen. Keys typed are added to `typed`. Return the number of answers.
 */
unsigned probe_await(unsigned count, int limit_ms, struct buf *typed);

/* Call before term_close: end our modes. If answers are `due` or the mouse was enabled, ask once
 * more and wait (at most 2 s, or two round trips; Ctrl-C ends it) for that answer and those before
 * it. So late answers and reports of the mouse do not reach the shell as input. Everything written
 * before is on screen. Keys typed meanwhile are lost. */
void probe_leave(const struct terminal_facts *facts, unsigned due);

#endif
