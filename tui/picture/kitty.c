/* SPDX-License-Identifier: MIT */
/*
 * The kitty graphics protocol: pictures as PNG in base64, in chunks, and changed in place; in the
 * second part tiles, for terminals that support only the common part of it.
 *
 *     ESC _ G a=T,C=1,f=100,i=7,z=2,q=2,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=1 ; <4096 base64 bytes> ESC \
 *     ESC _ G q=2,m=0 ; <the rest> ESC \
 *
 *     ESC _ G a=f,i=7,r=1,X=1,x=40,y=8,f=100,s=20,v=10,q=2,m=0 ; <base64> ESC \     a patch
 *     ESC _ G a=f,i=7,r=1,X=1,x=40,y=8,f=24,o=z,s=3,v=3,q=2,m=0 ; <base64> ESC \    a small one
 *     ESC _ G a=d,d=I,i=7,q=2 ESC \                                     deletes it
 *
 *     ESC _ G a=T,C=1,f=100,i=9,p=1000,w=1,h=1,q=2,m=0 ; <base64> ESC \
 *     ESC _ G a=p,i=9,p=4,C=1,X=3,z=1,q=1 ESC \      a strip of a slice: sent, and shown
 *     ESC _ G a=d,d=i,i=9,p=4,q=2 ESC \              hidden; the terminal still has it
 *
 * a=T transmits and shows at the cursor, C=1 leaves the cursor in place, q=2 (on every chunk) asks
 * for no answer, f=100 means PNG, f=24,o=z deflated 24-bit pixels, m=1 that more follows. a=f
 * changes a frame, r=1 the first, X=1 replaces pixels. Every chunk of a patch carries a=f,i=,r=1:
 * without them kitty 0.26.5 says OK and changes nothing. When its quota is full kitty drops
 * pictures that are not placed, so a strip has one pixel placed below the others; kitty reports a
 * dropped strip under q=1, as ESC _ G i=9,p=4;ENOENT:.. ESC \. ESC[2J drops all. No z is below 0,
 * where pictures are drawn under text: kitty does that in several passes, and Mesa's llvmpipe fails
 * in the pass that clears the area below the text.
 * Source:
 * https://sw.kovidgoyal.net/kitty/graphics-protocol/
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tui/picture/graphics.h"
#include "tui/picture/painter.h"

enum { CHUNK = 4096, FEW_PIXELS = 1024 };

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
static bool fits(const struct probe_replies *replies)
{
    const char *answer = strstr(replies->answers, "_G");
    return answer && strstr(answer, ";OK");
}

/* A terminal without a name may be screen, whatever TERM is. */
static bool may_ask(const struct probe_replies *replies)
{
    static const char *const family[] = {"kitty", "ghostty", "wezterm", "konsole", NULL};
    return (replies->name[0] || replies->kind) && !probe_is_multiplexed(replies) &&
           probe_is_named(replies, family);
}

/* ---- drawing ---- */

static void add_chunks(const struct buf *png, const char *first, const char *next, struct buf *out)
{
    const size_t piece = CHUNK / 4 * 3;
    out->failed |= png->failed;
    for (size_t at = 0; !out->failed && at < png->length; at += piece) {
        const size_t length = png->length - at < piece ? png->length - at : piece;
        buf_printf(out, "\033_G%sq=2,m=%d;", at == 0 ? first : next, at + length < png->length);
        buf_add_base64(out, png->data + at, length);
        buf_add_text(out, "\033\\");
    }
}

/* Add pixels as PNG by p->effort, in chunks; `keys` are those of the first chunk, each with its
 * comma. */
static void add_png(struct painter *p, const struct raster *raster, const char *keys,
                    struct buf *out)
{
    OWNED(buf_release) struct buf png = {0};
    png_add(&p->png, raster, p->effort, &png);
    add_chunks(&png, keys, "", out);
}

/* Add the same as PNG or as deflated pixels, whichever is smaller; `next` are the keys of later
 * chunks. The keys of the size are added. */
static void add_smaller(struct painter *p, const struct raster *part, const char *first,
                        const char *next, struct buf *out)
{
    OWNED(buf_release) struct buf png = {0}, pixels = {0};
    char keys[128];
    png_add(&p->png, part, p->effort, &png);
    if ((uint64_t)part->width * part->height <= FEW_PIXELS && !part->has_clear)
        png_add_pixels(&p->png, part, p->effort, &pixels);
    const bool is_png = pixels.length == 0 || png.length <= pixels.length;
    snprintf(keys, sizeof keys, "%s%s,s=%u,v=%u,", first, is_png ? "f=100" : "f=24,o=z",
             part->width, part->height);
    out->failed |= png.failed || pixels.failed;
    add_chunks(is_png ? &png : &pixels, keys, next, out);
}

/* Add the command that frees a picture, wherever it is shown. */
static void free_picture(uint32_t image, struct buf *out)
{
    buf_printf(out, "\033_Ga=d,d=I,i=%u,q=2\033\\", image);
}

/* Add a picture without a number, which stays where it is shown. */
static void once(struct painter *p, const struct raster *raster, struct buf *out)
{
    add_png(p, raster, "a=T,C=1,f=100,", out);
}

/* A whole picture has another number than the one before, which is deleted when the new one is
 * there, so that nothing flickers. */
static void whole(struct painter *p, const struct raster *raster, struct buf *out)
{
    const uint32_t former = p->image, image = former == KITTY_FIRST ? KITTY_FIRST + 1 : KITTY_FIRST;
    char keys[48];
    snprintf(keys, sizeof keys, "a=T,C=1,f=100,i=%u,z=%d,", image, PICTURE_Z);
    painter_move_to(p, 0, 0, out);
    add_png(p, raster, keys, out);
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
    snprintf(first, sizeof first, "%sX=1,x=%u,y=%u,", next, box->left, box->top);
    add_smaller(p, &part, first, next, out);
}

/* ---- parts of slices ---- */

static void send_strip(struct painter *p, const struct raster *raster, uint32_t number,
                       struct buf *out)
{
    char keys[96];
    snprintf(keys, sizeof keys, "a=T,C=1,f=100,i=%u,p=%d,w=1,h=1,", number, HOLD);
    painter_move_to(p, 0, 0, out);
    add_png(p, raster, keys, out);
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
    .question = {"\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\\", may_ask},
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
};

struct board {
    uint32_t columns, rows;
    uint32_t tiles, z, image; /* the last number */
    uint64_t area;            /* area of all tiles */
    struct tile tile[TILES];
    uint16_t seen[]; /* [rows][columns] */
};

static void release_tile(struct board *b, struct tile *tile, struct buf *out)
{
    free_picture(tile->image, out);
    b->area -= tile->area;
    b->tiles--;
    *tile = (struct tile){0};
}

static void add_tile(struct painter *p, const struct raster *part, uint32_t image, uint32_t z,
                     struct buf *out)
{
    char first[64];
    snprintf(first, sizeof first, "a=T,C=1,i=%u,z=%u,", image, z);
    add_smaller(p, part, first, "", out);
}

static void patch_tiles(struct painter *p, const struct raster *raster,
                        const struct raster_box *box, struct buf *out)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    const struct raster_box cells = {box->left / width, box->top / height, box->width / width,
                                     box->height / height};
    const struct raster part = raster_part(raster, *box);
    struct board *b = p->held;
    painter_move_to(p, cells.left, cells.top, out);
    add_tile(p, &part, ++b->image, ++b->z, out);
    /* The tile in `box`, in cells, is visible there now. There is a free place for it: a picture is
     * worn before none is left. */
    const uint32_t area = cells.width * cells.height;
    uint16_t i = 0;
    while (b->tile[i].image)
        i++;
    b->tile[i] = (struct tile){b->image, area, area};
    b->tiles++;
    b->area += area;
    for (uint32_t y = cells.top; y < cells.top + cells.height; y++)
        for (uint32_t x = cells.left; x < cells.left + cells.width; x++) {
            uint16_t *seen = &b->seen[(size_t)y * b->columns + x];
            if (--b->tile[*seen].cells == 0)
                release_tile(b, &b->tile[*seen], out);
            *seen = i;
        }
    p->is_whole_next =
        b->tiles > TILES - ROOM || b->area > (uint64_t)LAYERS_MOST * b->columns * b->rows;
}

static void remove_tiles(struct painter *p, struct buf *out)
{
    struct board *b = p->held;
    for (unsigned i = 0; b && i < TILES; i++)
        if (b->tile[i].image)
            release_tile(b, &b->tile[i], out);
}

/* Send one tile, the lowest; it is under the former tiles until these are deleted. */
static void whole_tile(struct painter *p, const struct raster *raster, struct buf *out)
{
    const uint32_t columns = raster->width / p->facts.cell_width;
    const uint32_t rows = raster->height / p->facts.cell_height;
    const size_t cells = (size_t)columns * rows, bytes = sizeof(struct board) + 2 * cells;
    const uint32_t image = p->held ? ((struct board *)p->held)->image + 1 : KITTY_FIRST;
    painter_move_to(p, 0, 0, out);
    add_tile(p, raster, image, 0, out);
    remove_tiles(p, out);
    if (!mem_grow(&p->held, &p->held_capacity, bytes, 1)) {
        out->failed = true;
        return;
    }
    struct board *b = p->held;
    *b = (struct board){columns, rows, .tiles = 1, .image = image, .area = cells};
    b->tile[0] = (struct tile){image, (uint32_t)cells, (uint32_t)cells};
    for (size_t i = 0; i < cells; i++)
        b->seen[i] = 0;
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
