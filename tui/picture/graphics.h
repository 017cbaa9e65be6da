/* SPDX-License-Identifier: MIT */
/*
 * The ways to show a picture, as one table; which of them a terminal has; and a picture at the
 * prompt.
 *
 * A protocol is a file with its row (struct graphics in tui/picture/painter.h) and a line in the
 * table of graphics.c, best first. Nothing else names one.
 *
 *     CR  R x LF  ESC[R A  ESC 7  picture  ESC 8  ESC[R B  CR        R = its height in cells
 *
 * is a picture of pixels at the prompt: the line feeds make room by scrolling, before the picture
 * is there; the cursor is saved and put back because every terminal leaves it elsewhere after a
 * picture. Text is lines, and needs none of this. Pure: facts and pixels in, bytes out.
 */
#ifndef TUI_PICTURE_GRAPHICS_H
#define TUI_PICTURE_GRAPHICS_H

#include "base/err.h"
#include "tui/picture/painter.h"

extern const struct graphics graphics_kitty, graphics_tiles, graphics_iterm, graphics_sixel,
    graphics_blocks, graphics_none;

/* Protocols that may be used, best first: the first that fits, else the last. A single one needs no
 * detection. */
struct graphics_wish {
    const struct graphics *const *of;
    size_t count;
};

/* All of them, for the terminal to decide. */
extern const struct graphics_wish graphics_auto;

/* "auto", or the name of one; false for another word. */
bool graphics_from_name(const char *name, struct graphics_wish *wish);

/* Adds "auto, kitty, tiles, iterm, sixel, blocks or none", with these words between them. */
void graphics_add_names(struct buf *out, const char *between, const char *before_last);

/* ---- which the terminal has ---- */

/* The questions to ask. */
struct probe_wish graphics_asks(struct graphics_wish wish,
                                const struct probe_environment *environment);

/* Choose the row that shows pictures, by the replies. */
const struct graphics *graphics_choose(const struct probe_replies *replies,
                                       const struct probe_environment *environment,
                                       struct graphics_wish wish);

/* Ask the terminal, which must be open and raw (probe_terminal), and decide; set the recovery
 * sequence of tui/term.h. Keys typed meanwhile are added to `typed`. */
enum err graphics_probe(struct graphics_wish wish, struct terminal_facts *facts, struct buf *typed,
                        struct fault *fault);

/* The sequence that ends a picture if the line has cut it in two, and is harmless otherwise. */
const char *graphics_recovery(const struct terminal_facts *facts);

/* ---- a picture at the prompt ---- */

/* Adds what shows `view` to `out`. The cursor must be at the start of a line and is at the start
 * of the line below the picture afterwards. A picture larger than the columns x rows of the
 * terminal, less a row for the prompt, or than the largest it draws, is shrunk. Nothing is added
 * for an empty view or where nothing can be shown; without memory out->failed is set. */
void show_inline(const struct terminal_facts *facts, const struct image_view *view,
                 uint32_t columns, uint32_t rows, struct buf *out);

/* Adds the picture itself, at the cursor, by a protocol of pixels: with a palette that suits it, or
 * in 24 bits where it is smooth, or has no hues. */
void graphics_encode(const struct graphics *graphics, const struct image_view *view,
                     struct buf *out);

#endif
