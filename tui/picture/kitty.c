/* SPDX-License-Identifier: MIT */
/*
 * The kitty graphics protocol: pictures as PNG in base64, in chunks, and changed in place; in the
 * second part tiles, for terminals that support only the common part of it; in the third tiles
 * inside tmux.
 *
 *     ESC _ G a=T,C=1,f=100,i=7,z=2,q=2,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=0 ; <the rest> ESC \
 *
 *     ESC _ G a=f,i=7,r=1,X=1,x=40,y=8,f=100,s=20,v=10,q=2,m=0 ; <base64> ESC \     a patch
 *     ESC _ G a=d,d=I,i=7,q=2 ESC \                                     deletes it
 *
 *     ESC _ G a=T,C=1,f=100,i=9,p=1000,w=1,h=1,q=2,m=0 ; <base64> ESC \
 *     ESC _ G a=p,i=9,p=4,C=1,X=3,z=1,q=1 ESC \      a strip of a slice: sent, and shown
 *     ESC _ G a=d,d=i,i=9,p=4,q=2 ESC \              hidden; the terminal still has it
 *
 * a=T transmits and shows at the cursor, C=1 leaves the cursor in place, q=2 (on every chunk) asks
 * for no answer, f=100 means PNG, m=1 that more follows. a=f changes a frame, r=1 the first, X=1
 * replaces pixels. Every chunk of a patch carries a=f,i=,r=1: without them kitty 0.26.5 says OK and
 * changes nothing. When its quota is full kitty drops pictures that are not placed, so a strip has
 * one pixel placed below the others; kitty reports a dropped strip under q=1, as
 * ESC _ G i=9,p=4;ENOENT:.. ESC \. ESC[2J drops all. No z is below 0, where pictures are drawn
 * under text: kitty does that in several passes, and Mesa's llvmpipe fails in the pass that clears
 * the area below the text.
 * Source:
 * https://sw.kovidgoyal.net/kitty/graphics-protocol/
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"
#include "base/safe.h"
#include "tui/picture/graphics.h"
#include "tui/picture/painter.h"
#include "tui/tmux.h"

enum { CHUNK = 4096 };

/* Picture numbers from here on, which other programs rarely use; and those of strips. */
enum { KITTY_FIRST = 26982, KITTY_STRIPS = 270000 };

/* Ends a truncated transmission: the first sequence if it was cut within a sequence, the second if
 * between two chunks. If none was cut both are complete: kitty would log a single ESC \ as an
 * error. */
#define RECOVERY "\033_Gm=0,q=2;\033\\\033_Gm=0,q=2;\033\\"

/* Strips are below the picture; a placement of this number, below all strips, keeps a strip from
 * being dropped. */
enum { PICTURE_Z = 2, STRIP_Z = 1, HOLD = 1000 };

/* ---- finding it ---- */

/* "_Gi=31;OK" */
static bool has_answered(const struct probe_replies *replies)
{
    const char *answer = strstr(replies->answers, "_G");
    return answer && strstr(answer, ";OK");
}

static bool fits(const struct probe_replies *replies)
{
    return has_answered(replies) && !probe_is_multiplexed(replies);
}

/* A terminal without a name may be screen, whatever TERM is. */
static bool may_ask(const struct probe_replies *replies)
{
    static const char *const family[] = {"kitty", "ghostty", "wezterm", "konsole", NULL};
    return (replies->name[0] || replies->kind) && !probe_is_multiplexed(replies) &&
           probe_is_named(replies, family);
}

/* ---- drawing ---- */

/* Add pixels as PNG by p->effort, in chunks; `first` are the keys of the first chunk and `next`
 * those of later ones, each with its comma. */
static void add_png(struct painter *p, const struct raster *raster, const char *first,
                    const char *next, struct buf *out)
{
    const size_t piece = CHUNK / 4 * 3;
    OWNED(buf_release) struct buf png = {0};
    png_add(&p->png, raster, p->effort, &png);
    out->failed |= png.failed;
    for (size_t at = 0; !out->failed && at < png.length; at += piece) {
        const size_t length = png.length - at < piece ? png.length - at : piece;
        buf_printf(out, "\033_G%sq=2,m=%d;", at == 0 ? first : next, at + length < png.length);
        buf_add_base64(out, png.data + at, length);
        buf_add_text(out, "\033\\");
    }
}

/* Add the command that frees a picture, wherever it is shown. */
static void free_picture(uint32_t image, struct buf *out)
{
    buf_printf(out, "\033_Ga=d,d=I,i=%u,q=2\033\\", image);
}

/* Add a picture without a number, which stays where it is shown. */
static void once(struct painter *p, const struct raster *raster, struct buf *out)
{
    add_png(p, raster, "a=T,C=1,f=100,", "", out);
}

/* A whole picture has another number than the one before, which is deleted when the new one is
 * there, so that nothing flickers. */
static void whole(struct painter *p, const struct raster *raster, struct buf *out)
{
    const uint32_t former = p->image, image = former == KITTY_FIRST ? KITTY_FIRST + 1 : KITTY_FIRST;
    char keys[48];
    snprintf(keys, sizeof keys, "a=T,C=1,f=100,i=%u,z=%d,", image, PICTURE_Z);
    painter_move_to(p, 0, 0, out);
    add_png(p, raster, keys, "", out);
    if (former > 0)
        free_picture(former, out);
    if (!out->failed)
        p->image = image;
}

static void patch(struct painter *p, const struct raster *raster, const struct raster_box *box,
                  struct buf *out)
{
    const struct raster part = raster_part(raster, *box);
    char next[32], first[80];
    snprintf(next, sizeof next, "a=f,i=%u,r=1,", p->image);
    snprintf(first, sizeof first, "%sX=1,x=%u,y=%u,f=100,s=%u,v=%u,", next, box->left, box->top,
             part.width, part.height);
    add_png(p, &part, first, next, out);
}

/* ---- parts of slices ---- */

static void send_strip(struct painter *p, const struct raster *raster, uint32_t number,
                       struct buf *out)
{
    char keys[96];
    snprintf(keys, sizeof keys, "a=T,C=1,f=100,i=%u,p=%d,w=1,h=1,", number, HOLD);
    painter_move_to(p, 0, 0, out);
    add_png(p, raster, keys, "", out);
}

static void place_strip(const struct painter *p, uint32_t number, unsigned place,
                        const struct raster_box *box, struct buf *out)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    painter_move_to(p, box->left / width, box->top / height, out);
    buf_printf(out, "\033_Ga=p,i=%u,p=%u,C=1,", number, place + 1);
    if (box->left % width)
        buf_printf(out, "X=%u,", box->left % width);
    if (box->top % height)
        buf_printf(out, "Y=%u,", box->top % height);
    buf_printf(out, "z=%d,q=1\033\\", STRIP_Z);
}

static void hide_strip(uint32_t number, unsigned place, struct buf *out)
{
    buf_printf(out, "\033_Ga=d,d=i,i=%u,p=%u,q=2\033\\", number, place + 1);
}

static void free_all(struct buf *out)
{
    buf_add_text(out, "\033_Ga=d,d=A,q=2\033\\");
}

/* "_Gi=27123,p=4;ENOENT:.." */
static uint32_t lost(const char *reply)
{
    const char *number = strncmp(reply, "_Gi=", 4) == 0 ? reply + 4 : "";
    const unsigned long image = strtoul(number, NULL, 10);
    const bool is_strip = image > KITTY_STRIPS && image <= UINT32_MAX;
    return is_strip && strstr(reply, ";ENOENT") ? (uint32_t)image : 0;
}

static const struct keeping keeping = {KITTY_STRIPS, send_strip, place_strip, hide_strip,
                                       free_picture, free_all,   lost};

static void remove_picture(struct painter *p, struct buf *out)
{
    if (p->image > 0)
        free_picture(p->image, out);
    p->image = 0;
}

const struct graphics graphics_kitty = {
    .name = "kitty",
    .title = "kitty",
    .kind = GRAPHICS_PIXELS,
    .fits = fits,
    .question = {"\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\\", may_ask, false},
    .recovery = RECOVERY,
    .made_by = "kitty",
    .instead = &graphics_tiles,
    .patch_cost = 250,
    .once = once,
    .whole = whole,
    .patch = patch,
    .remove = remove_picture,
    .keeping = &keeping,
};

/* ---- tiles ---- */

/*
 * Kitty's protocol without frame edits (Ghostty, WezTerm, Konsole): whole cells are covered by
 * pictures of their own.
 *
 *     ESC[row;columnH ESC _ G a=T,C=1,i=27007,z=25,f=100,s=64,v=32,q=2,m=0 ; <base64> ESC \
 *     ESC _ G a=d,d=I,i=26990,q=2 ESC \         a tile that is fully covered
 *
 * Each tile has a new number and a higher z than all earlier ones. For each cell the board stores
 * the visible tile; a tile without visible cells is deleted after the tiles that cover it have been
 * sent, so nothing flickers. A picture is `worn`, and is sent whole as one tile, when tiles are
 * many or their pixels, which the terminal keeps in memory, are several times those of the picture.
 *
 *   B1 tile[seen[c]] covers the cell c, and has the greatest z of all that do;
 *   B2 tile[i].cells is the number of cells c with seen[c] == i; a tile with 0 is free.
 */
enum { TILES = 512, ROOM = 64, LAYERS_MOST = 6 };

struct tile {
    uint32_t image, cells, area; /* `area` in cells, seen or not */
    uint32_t left, top;          /* cells */
};

struct board {
    uint32_t columns, rows;
    uint32_t tiles, z, image; /* the last number */
    uint64_t area;            /* area of all tiles */
    struct tile tile[TILES];
    uint16_t seen[]; /* [rows][columns]; TILES: none */
};

static bool is_in_cells(const struct painter *p)
{
    return (p->holder ? p->holder : p->facts.graphics) == &graphics_placeholders;
}

/* Delete the picture of a tile, which is on the screen in no cell. */
static void release_tile(struct painter *p, struct tile *tile, struct buf *out)
{
    OWNED(buf_release) struct buf command = {0};
    struct board *b = p->held;
    free_picture(tile->image, &command);
    if (is_in_cells(p))
        tmux_wrap(out, &command);
    else
        buf_add_text(out, buf_text(&command));
    b->area -= tile->area;
    b->tiles--;
    *tile = (struct tile){0};
}

static void add_tile(struct painter *p, const struct raster *part, uint32_t image, uint32_t z,
                     struct buf *out)
{
    char first[64];
    snprintf(first, sizeof first, "a=T,C=1,i=%u,z=%u,f=100,", image, z);
    add_png(p, part, first, "", out);
}

/* Return a free place: a picture is worn before none is left. */
static uint16_t free_place(const struct board *b)
{
    uint16_t i = 0;
    while (b->tile[i].image)
        i++;
    return i;
}

/* Put a tile, which was sent, into its place: it is visible in `cells` now. */
static void take_cells(struct painter *p, uint16_t place, uint32_t image,
                       const struct raster_box *cells, unsigned most, struct buf *out)
{
    struct board *b = p->held;
    const uint32_t area = cells->width * cells->height;
    b->tile[place] = (struct tile){image, area, area, cells->left, cells->top};
    b->tiles++;
    b->area += area;
    for (uint32_t y = cells->top; y < cells->top + cells->height; y++)
        for (uint32_t x = cells->left; x < cells->left + cells->width; x++) {
            uint16_t *seen = &b->seen[(size_t)y * b->columns + x];
            if (*seen < TILES && --b->tile[*seen].cells == 0)
                release_tile(p, &b->tile[*seen], out);
            *seen = place;
        }
    p->is_whole_next =
        b->tiles > most - ROOM || b->area > (uint64_t)LAYERS_MOST * b->columns * b->rows;
}

static struct raster_box cells_of(const struct painter *p, const struct raster_box *box)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    return (struct raster_box){box->left / width, box->top / height, box->width / width,
                               box->height / height};
}

static void patch_tiles(struct painter *p, const struct raster *raster,
                        const struct raster_box *box, struct buf *out)
{
    const struct raster_box cells = cells_of(p, box);
    const struct raster part = raster_part(raster, *box);
    struct board *b = p->held;
    painter_move_to(p, cells.left, cells.top, out);
    add_tile(p, &part, ++b->image, ++b->z, out);
    take_cells(p, free_place(b), b->image, &cells, TILES, out);
}

static void remove_tiles(struct painter *p, struct buf *out)
{
    struct board *b = p->held;
    for (unsigned i = 0; b && i < TILES; i++)
        if (b->tile[i].image)
            release_tile(p, &b->tile[i], out);
}

/* Begin a board without tiles; return false without memory. */
static bool begin_board(struct painter *p, const struct raster_box *cells, uint32_t image)
{
    const size_t count = (size_t)cells->width * cells->height;
    if (!mem_grow(&p->held, &p->held_capacity, sizeof(struct board) + 2 * count, 1))
        return false;
    struct board *b = p->held;
    *b = (struct board){cells->width, cells->height, .image = image};
    for (size_t i = 0; i < count; i++)
        b->seen[i] = TILES;
    return true;
}

/* Send one tile, the lowest; it is under the former tiles until these are deleted. */
static void whole_tile(struct painter *p, const struct raster *raster, struct buf *out)
{
    const struct raster_box all = {0, 0, raster->width, raster->height}, cells = cells_of(p, &all);
    const uint32_t image = p->held ? ((struct board *)p->held)->image + 1 : KITTY_FIRST;
    painter_move_to(p, 0, 0, out);
    add_tile(p, raster, image, 0, out);
    remove_tiles(p, out);
    if (begin_board(p, &cells, image))
        take_cells(p, 0, image, &cells, TILES, out);
    else
        out->failed = true;
}

/* It is never detected: it replaces kitty's row for other terminals, or the user asks for it. */
const struct graphics graphics_tiles = {
    .name = "tiles",
    .title = "kitty tiles",
    .kind = GRAPHICS_PIXELS,
    .recovery = RECOVERY,
    .over_cells = true,
    .patch_cost = 300,
    .once = once,
    .whole = whole_tile,
    .patch = patch_tiles,
    .remove = remove_tiles,
};

/* ---- tiles in cells of text ---- */

/*
 * Tiles inside tmux, in the terminal outside: they are sent to it through tmux (tmux_wrap), without
 * a place, and shown by cells of text that name them. tmux has these cells, so it moves and draws
 * them as any text.
 *
 *     ESC P tmux; ESC ESC _ G a=T,U=1,i=33554450,c=8,r=2,f=100,..;<base64> ESC ESC \ ESC \
 *     ESC[row;columnH ESC[38;5;18m U+10EEEE U+030D U+0305 U+030E  U+10EEEE  U+10EEEE ..
 *
 * The marks of U+10EEEE are the row and the column of the cell in the tile, and the highest byte of
 * the tile's number; its lowest byte is the colour, one of 256, which tmux leaves as it is. A cell
 * without marks continues the cell to its left if the colour is the same. Marks cost tmux 30 bytes
 * a cell, so only the first cell of a tile's row has them, and a cell to the right of another tile.
 * Source: https://sw.kovidgoyal.net/kitty/graphics-protocol/#unicode-placeholders
 */
enum { SIDE_MOST = 64, COLOUR_FIRST = 16, PLACES = 240 };
#define PLACEHOLDER "\xF4\x8E\xBB\xAE"

static void add_mark(unsigned number, struct buf *out)
{
    static const uint16_t mark[SIDE_MOST] = {
        0x0305, 0x030D, 0x030E, 0x0310, 0x0312, 0x033D, 0x033E, 0x033F, 0x0346, 0x034A, 0x034B,
        0x034C, 0x0350, 0x0351, 0x0352, 0x0357, 0x035B, 0x0363, 0x0364, 0x0365, 0x0366, 0x0367,
        0x0368, 0x0369, 0x036A, 0x036B, 0x036C, 0x036D, 0x036E, 0x036F, 0x0483, 0x0484, 0x0485,
        0x0486, 0x0487, 0x0592, 0x0593, 0x0594, 0x0595, 0x0597, 0x0598, 0x0599, 0x059C, 0x059D,
        0x059E, 0x059F, 0x05A0, 0x05A1, 0x05A8, 0x05A9, 0x05AB, 0x05AC, 0x05AF, 0x05C4, 0x0610,
        0x0611, 0x0612, 0x0613, 0x0614, 0x0615, 0x0616, 0x0617, 0x0657, 0x0658};
    char text[UTF8_BYTES_MOST];
    buf_add(out, text, utf8_write(text, mark[number]));
}

/* Add `count` cells of a row of a tile, from a column of the tile on. */
static void add_cells(uint32_t image, uint32_t row, uint32_t column, uint32_t count,
                      struct buf *out)
{
    buf_printf(out, "\033[38;5;%um" PLACEHOLDER, image & 255);
    add_mark(row, out);
    add_mark(column, out);
    add_mark(image >> 24, out);
    while (--count > 0)
        buf_add_text(out, PLACEHOLDER);
}

static void send_in_cells(struct painter *p, const struct raster *part, uint32_t image,
                          uint32_t columns, uint32_t rows, struct buf *out)
{
    OWNED(buf_release) struct buf commands = {0};
    char first[64];
    snprintf(first, sizeof first, "a=T,U=1,i=%u,c=%u,r=%u,f=100,", image, columns, rows);
    add_png(p, part, first, "", &commands);
    tmux_wrap(out, &commands);
}

static uint32_t number_of(const struct painter *p, unsigned place)
{
    return (1u + p->facts.space % (SIDE_MOST - 1u)) << 24 | (COLOUR_FIRST + place);
}

static void patch_cells(struct painter *p, const struct raster *raster,
                        const struct raster_box *box, struct buf *out)
{
    struct board *b = p->held;
    const uint32_t across = SIDE_MOST * p->facts.cell_width;
    const uint32_t down = SIDE_MOST * p->facts.cell_height;
    for (struct raster_box piece = {0}; painter_next_piece(box, across, down, &piece);) {
        const struct raster_box cells = cells_of(p, &piece);
        const struct raster part = raster_part(raster, piece);
        const uint16_t place = free_place(b);
        const uint32_t image = number_of(p, place), right = cells.left + cells.width;
        send_in_cells(p, &part, image, cells.width, cells.height, out);
        for (uint32_t row = 0; row < cells.height; row++) {
            const uint32_t y = cells.top + row;
            painter_move_to(p, cells.left, y, out);
            add_cells(image, row, 0, cells.width, out);
            const uint16_t next =
                right < b->columns ? b->seen[(size_t)y * b->columns + right] : TILES;
            if (next < TILES) /* it continued a cell that is no more */
                add_cells(b->tile[next].image, y - b->tile[next].top, right - b->tile[next].left, 1,
                          out);
        }
        take_cells(p, place, image, &cells, PLACES, out);
    }
    buf_add_text(out, "\033[m");
}

/* All cells are written, so that the former tiles are deleted. */
static void whole_cells(struct painter *p, const struct raster *raster, struct buf *out)
{
    const struct raster_box all = {0, 0, raster->width, raster->height}, cells = cells_of(p, &all);
    const struct board *b = p->held;
    const bool is_same = b && b->tiles && b->columns == cells.width && b->rows == cells.height;
    if (!is_same)
        remove_tiles(p, out);
    if (is_same || begin_board(p, &cells, 0))
        patch_cells(p, raster, &all, out);
    else
        out->failed = true;
}

/* Lines that begin at the left edge. */
static void once_cells(struct painter *p, const struct raster *raster, struct buf *out)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    const uint32_t columns = (raster->width + width - 1) / width;
    const uint32_t rows = (raster->height + height - 1) / height;
    const struct raster_box all = {0, 0, raster->width, raster->height};
    unsigned places = 0;
    for (struct raster_box piece = {0};
         painter_next_piece(&all, SIDE_MOST * width, SIDE_MOST * height, &piece);) {
        const struct raster part = raster_part(raster, piece);
        const uint32_t left = piece.left / width, top = piece.top / height;
        send_in_cells(p, &part, number_of(p, places++), least(SIDE_MOST, columns - left),
                      least(SIDE_MOST, rows - top), out);
    }
    const uint32_t across = (columns + SIDE_MOST - 1) / SIDE_MOST;
    for (uint32_t row = 0; row < rows; row++) {
        for (uint32_t i = 0; i < across; i++)
            add_cells(number_of(p, row / SIDE_MOST * across + i), row % SIDE_MOST, 0,
                      least(SIDE_MOST, columns - i * SIDE_MOST), out);
        buf_add_text(out, row + 1 < rows ? "\r\n" : "\033[m");
    }
}

/* Terminals that answer without having placeholders: kitty before 0.28, and a few others. */
static bool may_have_cells(const struct probe_replies *replies)
{
    static const char *const lacking[] = {"wezterm", "konsole", "iterm2", "tmux", NULL};
    const char *name = replies->outer.name;
    unsigned major = 0, minor = 0;
    if (!probe_is_tmux(replies) || !name[0] || probe_has_word(name, lacking))
        return false;
    return sscanf(name, "kitty(%u.%u", &major, &minor) < 2 || major > 0 || minor >= 28;
}

static bool cells_fit(const struct probe_replies *replies)
{
    return has_answered(replies) && may_have_cells(replies);
}

const struct graphics graphics_placeholders = {
    .name = "placeholders",
    .title = "kitty through tmux",
    .kind = GRAPHICS_PIXELS,
    .fits = cells_fit,
    .question = {"\033Ptmux;\033\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\033\\\033\\",
                 may_have_cells, true},
    .recovery = "\033\\\033Ptmux;\033\033_Gm=0,q=2;\033\033\\\033\\",
    .over_cells = true,
    .in_cells = true,
    .patch_cost = 300,
    .once = once_cells,
    .whole = whole_cells,
    .patch = patch_cells,
    .remove = remove_tiles,
};
