/*
 * A picture that stays at one place of the screen, and of which only what has changed goes over the
 * wire.
 *
 *     struct painter p = {0};
 *     painter_place(&p, &facts, 0, 2, 80, 21);
 *     painter_size(&p, &width, &height);            make a picture of that size
 *     painter_show(&p, &view, &out);                and write `out` in one piece
 *
 * Pure: facts and pixels in, bytes out. What the painter adds must reach the terminal whole and in
 * order, and between its pictures nobody else writes into its place; where that happened,
 * painter_forget.
 *
 * By what means:
 *   kitty    boxes of pixels are changed in place; a whole picture has another number than the one
 *            before, which goes when the new one is there, so that nothing flickers
 *   sixel    boxes of whole cells are drawn over, none larger than the terminal draws
 *   iterm    the same with pictures in iTerm2's way
 *   blocks   cells that differ are written
 *
 * Pictures keep their palette (tui/shades.h) until one goes whole, so patches agree with what they
 * are put on. A picture goes whole when it is the first, or of another size, when its hues or
 * smooth change, and when half of its pixels have changed.
 *
 * One painter at a time shows a picture on a terminal. Cells count from 0. The last row of the
 * screen is not for pictures: several terminals scroll when a sixel ends there.
 */
#ifndef TUI_PICTURE_PAINTER_H
#define TUI_PICTURE_PAINTER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "tui/picture/image_view.h"
#include "image/png.h"
#include "tui/probe.h"
#include "tui/picture/shades.h"
#include "tui/picture/sixel.h"

struct painter_picture {
    uint8_t *bytes; /* places in the palette, or colours */
    size_t capacity;
    struct block *cell; /* [rows][columns] */
    size_t cells;
};

struct painter {
    struct terminal_facts facts;
    unsigned column, row, columns, rows;
    bool is_shown;                /* the screen shows of[0] */
    struct painter_picture of[2]; /* the last one, and the next */
    uint32_t width, height; /* of what is shown, grown to whole cells where cells are drawn over */
    bool has_palette;
    struct shades shades;
    struct png_writer png;
    struct sixel_writer sixel;
    uint32_t image; /* kitty: the number of the picture that the terminal has, 0 for none */
};

/* Where the picture goes from now on, at least 1x1 cells, and by what means. Forgets what is on the
 * screen where either changes; whoever moves a picture that is shown removes it first. */
void painter_place(struct painter *p, const struct terminal_facts *facts, unsigned column,
                   unsigned row, unsigned columns, unsigned rows);

/* The pixels that the place has, which are whole cells and square; for blocks pixels that stand for
 * parts of cells. */
void painter_size(const struct painter *p, uint32_t *width, uint32_t *height);

/* Adds what makes the screen show `view` at the top left of the place, of which it is cut where it
 * is larger; nothing where nothing differs from what is there, or graphics are GRAPHICS_NONE. The
 * cursor may be anywhere afterwards. False, with out->failed set, without memory: `out` is to be
 * thrown away, and the next picture goes whole. */
bool painter_show(struct painter *p, const struct image_view *view, struct buf *out);

/* The screen was cleared or overwritten: the next picture goes whole. */
void painter_forget(struct painter *p);

/* Takes the picture off the screen; its place is blank then. */
void painter_remove(struct painter *p, struct buf *out);

/* Gives the memory back; the painter is as new. What is on the screen stays. */
void painter_release(struct painter *p);

#endif
