/*
 * Kitty's protocol without its frame edits (Ghostty, WezTerm, Konsole): whole cells are drawn over
 * by pictures of their own.
 *
 *     ESC[row;columnH ESC _ G a=T,C=1,i=27007,z=25,f=100,s=64,v=32,q=2,m=0 ; <base64> ESC \
 *     ESC _ G a=d,d=I,i=26990,q=2 ESC \         a tile of which nothing is seen any more
 *
 * Each tile has a number that was never used before and lies above all earlier ones, by z. For each
 * cell the board holds the tile that is seen there; a tile that is seen nowhere is deleted after
 * what covers it has come, so nothing flickers. A picture is `worn`, and goes whole as one tile,
 * when tiles are many or their pixels, which the terminal holds in memory, are several times those
 * of the picture.
 *
 *   B1 tile[seen[c]] has the cell c in its box, and the greatest z of all that have;
 *   B2 tile[i].cells is the number of cells c with seen[c] == i; a tile with none is free.
 */
#include <stdio.h>

#include "base/mem.h"
#include "tui/picture/graphics.h"
#include "tui/picture/kitty.h"

enum { TILES = 512, ROOM = 64, LAYERS_MOST = 6 };

struct tile {
    uint32_t image, cells, area; /* `area` in cells, seen or not */
};

struct board {
    uint32_t columns, rows;
    uint32_t tiles, z, image; /* the last number */
    uint64_t area;            /* of all tiles */
    struct tile tile[TILES];
    uint16_t seen[]; /* [rows][columns] */
};

static void release(struct board *b, struct tile *tile, struct buf *out)
{
    kitty_delete(tile->image, out);
    b->area -= tile->area;
    b->tiles--;
    *tile = (struct tile){0};
}

/* A free place; there is one, as a picture is worn before it has none. */
static uint16_t free_tile(const struct board *b)
{
    uint16_t i = 0;
    while (b->tile[i].image)
        i++;
    return i;
}

/* The tile in `box`, in cells, is seen there now. */
static void cover(struct board *b, uint32_t image, struct raster_box box, struct buf *out)
{
    const uint16_t i = free_tile(b);
    const uint32_t area = box.width * box.height;
    b->tile[i] = (struct tile){image, area, area};
    b->tiles++;
    b->area += area;
    for (uint32_t y = box.top; y < box.top + box.height; y++)
        for (uint32_t x = box.left; x < box.left + box.width; x++) {
            uint16_t *seen = &b->seen[(size_t)y * b->columns + x];
            if (--b->tile[*seen].cells == 0)
                release(b, &b->tile[*seen], out);
            *seen = i;
        }
}

static void send(struct painter *p, const struct raster *part, uint32_t image, uint32_t z,
                 struct buf *out)
{
    char first[64];
    snprintf(first, sizeof first, "a=T,C=1,i=%u,z=%u,", image, z);
    kitty_send(p, part, first, "", out);
}

static void patch(struct painter *p, const struct raster *raster, const struct raster_box *box,
                  struct buf *out)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    const struct raster_box cells = {box->left / width, box->top / height, box->width / width,
                                     box->height / height};
    const struct raster part = raster_part(raster, *box);
    struct board *b = p->held;
    painter_move_to(p, cells.left, cells.top, out);
    send(p, &part, ++b->image, ++b->z, out);
    cover(b, b->image, cells, out);
    p->is_worn = b->tiles > TILES - ROOM || b->area > (uint64_t)LAYERS_MOST * b->columns * b->rows;
}

static void take_away(struct painter *p, struct buf *out)
{
    struct board *b = p->held;
    for (unsigned i = 0; b && i < TILES; i++)
        if (b->tile[i].image)
            release(b, &b->tile[i], out);
}

/* One tile, the lowest, under what is there until that goes. */
static void whole(struct painter *p, const struct raster *raster, struct buf *out)
{
    const uint32_t columns = raster->width / p->facts.cell_width;
    const uint32_t rows = raster->height / p->facts.cell_height;
    const size_t cells = (size_t)columns * rows, bytes = sizeof(struct board) + 2 * cells;
    const uint32_t image = p->held ? ((struct board *)p->held)->image + 1 : KITTY_FIRST;
    painter_move_to(p, 0, 0, out);
    send(p, raster, image, 0, out);
    take_away(p, out);
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

/* It is there for a terminal that kitty's own row is not made for, and for who asks for it. */
static bool never(const struct probe_replies *replies, const struct probe_environment *environment)
{
    (void)replies;
    (void)environment;
    return false;
}

static void once(struct painter *p, const struct raster *raster, struct buf *out)
{
    kitty_show(p, raster, "a=T,C=1,f=100,", out);
}

const struct graphics graphics_tiles = {
    .name = "tiles",
    .title = "kitty tiles",
    .kind = GRAPHICS_PIXELS,
    .fits = never,
    .recovery = "\033_Gm=0,q=2;\033\\", /* as in kitty.c */
    .over_cells = true,
    .patch_cost = 300,
    .once = once,
    .whole = whole,
    .patch = patch,
    .remove = take_away,
};
