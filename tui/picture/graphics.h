/* SPDX-License-Identifier: MIT */
/*
 * The ways to show a picture, as one table; the choice of one for a terminal; and a picture at the
 * prompt.
 *
 * A protocol is a file with its row (struct graphics in tui/picture/painter.h) and a line in the
 * table of graphics.c, best first. No other file names a protocol.
 *
 *     CR  R x LF  ESC[R A  ESC 7  picture  ESC 8  ESC[R B  CR        R = its height in cells
 *
 * shows a picture of pixels at the prompt: the line feeds make room by scrolling, before the
 * picture is there; the cursor is saved and restored because terminals leave it at different places
 * after a picture. Pictures of text are lines, and need none of this. Pure: facts and pixels in,
 * bytes out.
 */
#ifndef TUI_PICTURE_GRAPHICS_H
#define TUI_PICTURE_GRAPHICS_H

#include "base/err.h"
#include "tui/picture/painter.h"

extern const struct graphics graphics_kitty, graphics_tiles, graphics_iterm, graphics_placeholders,
    graphics_sixel, graphics_sextants, graphics_quadrants, graphics_halves, graphics_none;

/* Protocols that may be used, best first: the first that fits, else the last. A single one needs no
 * detection. */
struct graphics_wish {
    const struct graphics *const *of;
    size_t count;
};

/* All of them: chosen by the terminal. */
extern const struct graphics_wish graphics_auto;

/* Read "auto", "blocks", which means pictures made of text, or the name of a protocol; return false
 * for another word. */
bool graphics_from_name(const char *name, struct graphics_wish *wish);

/* The same; ERR_USAGE for another word: "WHERE: expected auto, kitty .. or none, not loud". */
enum err graphics_read(const char *name, const char *where, struct graphics_wish *wish,
                       struct fault *fault);

/* Add "auto, kitty, .., blocks, sextants, .. or none", with these words between the names. */
void graphics_add_names(struct buf *out, const char *between, const char *before_last);

/* ---- which the terminal has ---- */

/* Return the questions to ask. */
struct probe_wish graphics_asks(struct graphics_wish wish,
                                const struct probe_environment *environment);

/* Derive all facts from the replies (probe_decide), with the row that shows pictures. */
void graphics_decide(const struct probe_replies *replies, const struct term_size *size,
                     struct graphics_wish wish, struct terminal_facts *facts);

/* Add a line that names the row, and one of advice. */
void graphics_describe(const struct terminal_facts *facts, struct buf *out);

/* The detection in a session. Begins as {.wish = wish}; {0} is graphics_auto. */
struct graphics_probe {
    struct graphics_wish wish;
    struct probe probe;
};

/* Ask the terminal, which must be open and raw (probe_terminal), and decide; set the recovery
 * sequence of tui/term.h. Keys typed meanwhile are added to `typed`. May be called again: `due`
 * answers to frames are then due, which are skipped, and *facts are those so far. */
void graphics_probe(struct graphics_probe *g, unsigned due, struct terminal_facts *facts,
                    struct buf *typed);

/* Number of answers to its questions that may still arrive. */
unsigned graphics_due(const struct graphics_probe *g);

/* Pass each reply of the session here: it may be an answer that comes late. PROBE_HAS_ALL: *facts
 * may have changed, or a question was written, and the screen must be drawn again. */
enum probe_heard graphics_hear(struct graphics_probe *g, const char *body,
                               struct terminal_facts *facts);

/* Return the sequence that ends a picture cut in two by the line; otherwise it is harmless. */
const char *graphics_recovery(const struct terminal_facts *facts);

/* ---- a picture at the prompt ---- */

/* Add the bytes that show `view` to `out`. The cursor must be at the start of a line, and is at the
 * start of the line below the picture afterwards. A picture that is larger than the columns x rows
 * of the terminal, minus a row for the prompt, or than the largest that it draws, is shrunk.
 * Nothing is added for an empty view or if nothing can be shown; without memory out->failed is set.
 */
void show_inline(const struct terminal_facts *facts, const struct image_view *view,
                 uint32_t columns, uint32_t rows, struct buf *out);

/* Add the picture itself, at the cursor, by a protocol of pixels: with a palette that suits it, or
 * in 24 bits if it is smooth or has no hues. */
void graphics_encode(const struct terminal_facts *facts, const struct image_view *view,
                     struct buf *out);

#endif
