/* SPDX-License-Identifier: MIT */
/*
 * A picture at a fixed place of the screen, that sends only changes.
 *
 *     struct painter p = {0};
 *     painter_place(&p, &facts, 0, 2, 80, 21);
 *     painter_size(&p, &width, &height);            make a picture of that size
 *     painter_show(&p, &view, &out);                and write `out` in one piece
 *
 * Pure: facts and pixels in, bytes out. The bytes of the painter must reach the terminal whole and
 * in order, and nothing else may be written into its place between its pictures; after that, call
 * painter_forget.
 *
 * The row of the table of graphics (tui/picture/graphics.h) sets the method:
 *   pixels over cells     boxes of whole cells are drawn over, none larger than the terminal draws;
 *                         in kitty's protocol each is a picture that stays above earlier ones
 *   pixels of a picture   boxes of pixels are changed in place
 *   text                  cells that differ are written
 *
 * Changes are found tile by tile, and sent as a few boxes. Where single pixels can be changed,
 * boxes fit tightly; where cells are drawn over, boxes are whole cells. Two boxes are joined if
 * that costs no more: each box has a fixed cost, in pixels. Boxes may overlap.
 *
 * Pictures keep their palette (tui/picture/shades.h) as long as it serves, so patches agree with
 * the pixels around them. When the hues need another palette, pixels that the new one would not
 * show better by more than PAINTER_NEAR are not sent again. A picture is sent whole when it is the
 * first, or of another size, when `smooth` changes, when half of its pixels have changed, on a slow
 * line all of them, and when a protocol holds too many parts.
 *
 * Only one painter shows a picture on a terminal. Cells count from 0. Pictures leave the last row
 * of the screen free: several terminals scroll when a sixel ends there.
 */
#ifndef TUI_PICTURE_PAINTER_H
#define TUI_PICTURE_PAINTER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "image/png.h"
#include "tui/picture/image_view.h"
#include "tui/picture/shades.h"
#include "tui/probe.h"

/*
 * Slices that are stored in the terminal: the greys of each are sent once, and placed below the
 * picture whenever they are visible again.
 *
 *     picture       labels, cross-hair, marks, words, and the rendition; clear where the greys of a
 *                   slice are visible
 *     strips        parts of slices, a few rows of cells high, each a picture of the terminal
 *
 * A strip is identified by the SHA-256 of its pixels, so no invalidation is needed: the same slice
 * in the same window at the same size is the same strip, seen before or sent ahead, and after an
 * undo again. Greys are rounded to STRIPS_GREYS levels. Strips have their natural size, so that
 * every version of kitty shows the same pixels.
 *
 *   K1 a strip that it reports missing (painter_take_reply) is sent again; after STRIPS_MOST of
 *      these no strip is used until `losses` is set to 0: resending is bounded;
 *   K2 no number is used twice, since a number that is sent again leaks in kitty 0.26;
 *   K3 at most STRIPS_PIXELS_MOST pixels are stored: the least recently used strips are freed
 *      before the terminal's own quota is reached, which would drop all hidden strips. Each strip
 *      has a placement of one invisible pixel, or it would count as hidden.
 *
 * A protocol supports this if its row has a `struct keeping`.
 */
enum {
    STRIPS_GREYS = 40,
    STRIPS_KEY = 32,               /* bytes of a SHA-256 */
    STRIPS_MOST = 96,              /* in one picture; a view with more keeps nothing */
    STRIPS_EACH_PIXELS = 12000,    /* about: some 4 kB, the longest that a key waits for */
    STRIPS_PIXELS_MOST = 40 << 20, /* half of kitty's 320 MB, at 4 bytes a pixel */
};

struct strips_image {
    uint8_t key[STRIPS_KEY];
    uint32_t number, pixels;
    uint64_t used; /* time of the last use, by strips.clock */
};

struct strips {
    struct strips_image *image;
    size_t images, capacity;
    uint64_t pixels, clock;
    uint32_t last;                         /* strips ever sent */
    unsigned losses;                       /* strips reported missing */
    struct image_strip slot[STRIPS_MOST];  /* on the screen; number 0: not shown */
    struct image_strip strip[STRIPS_MOST]; /* in the present view */
    unsigned strips;
    uint8_t *greys; /* palette indices of the present strip */
    size_t greys_capacity;
};

enum { PAINTER_NEAR = 6 }; /* steps of a channel, 255 in all */

struct painter_picture {
    uint8_t *bytes; /* palette indices, colours, or cells */
    size_t capacity;
};

struct painter {
    struct terminal_facts facts;
    unsigned column, row, columns, rows;
    bool is_shown;                /* the screen shows of[0] */
    struct painter_picture of[2]; /* the last one, and the next */
    uint32_t width, height; /* shown picture, extended to whole cells where cells are drawn over */
    bool has_palette, is_mixed; /* some pixels have the colours of a former palette */
    struct shades shades;

    struct strips kept;            /* parts of slices that the terminal has */
    const struct graphics *holder; /* the protocol of the stored picture, or NULL */

    /* for the protocol's own use */
    struct png_writer png;
    enum png_effort effort;  /* for the present patch */
    bool is_whole_next;      /* the next picture must be sent whole */
    unsigned images;         /* sent since the last whole one, with it */
    void *scratch;           /* memory reused from picture to picture, */
    size_t scratch_capacity; /* in bytes */
    void *held;              /* the protocol's data about parts that the terminal stores, */
    size_t held_capacity;    /* in bytes */
    uint32_t image;          /* number of the picture that the terminal stores; 0: none */
};

/* Set the place of the picture, at least 1x1 cells, and the method. Forgets the screen if either
 * changes; to move a picture that is shown, remove it first. Where facts->images_most is set, the
 * last row stays free: tmux counts a sixel picture in bands of six pixels, and drops it when text
 * is written to a row that the last band reaches. */
void painter_place(struct painter *p, const struct terminal_facts *facts, unsigned column,
                   unsigned row, unsigned columns, unsigned rows);

/* Set `width` and `height` to the pixels of the place, which are square; for blocks, pixels are
 * parts of cells. */
void painter_size(const struct painter *p, uint32_t *width, uint32_t *height);

/* Add the bytes that show `view` at the top left of the place, cropped to it; nothing if the screen
 * shows it already, or pictures cannot be shown. The cursor may be anywhere afterwards. Without
 * memory return false and set out->failed: discard `out`; the next picture is sent whole. */
bool painter_show(struct painter *p, const struct image_view *view, struct buf *out);

/* Call before painter_show if the terminal can store strips of slices: add the bytes that send
 * those of the view that it lacks, the focus first, at most `budget` bytes in all, but at least one
 * strip; none if it is 0. Set view->strip to show which are there. This shows nothing yet, so a
 * view may be sent ahead. */
void painter_keep(struct painter *p, struct image_view *view, size_t budget, struct buf *out);

/* Return true if the terminal has room for strips that are not needed yet. */
bool painter_has_room(const struct painter *p);

/* Read a reply of the terminal; true if it reports visible parts missing, and the picture must be
 * shown again. */
bool painter_take_reply(struct painter *p, const char *reply);

/* Forget and free everything stored in the terminal, whose contents may be unknown. */
void painter_drop(struct painter *p, struct buf *out);

/* Call when the screen was cleared or overwritten: the next picture is sent whole. */
void painter_forget(struct painter *p);

/* Remove the picture from the screen; its place is blank afterwards. */
void painter_remove(struct painter *p, struct buf *out);

/* For a protocol: move the cursor to a cell of the place. */
void painter_move_to(const struct painter *p, unsigned column, unsigned row, struct buf *out);

/* For a protocol: find the next of the pieces of a box, row by row, of at most `width` x `height`
 * pixels; the first if *piece is zeroed. Return false after the last. */
bool painter_next_piece(const struct raster_box *box, uint32_t width, uint32_t height,
                        struct raster_box *piece);

/* Release the memory; the painter is as at the start. The screen does not change. */
void painter_release(struct painter *p);

/* Return the level of a grey in a strip, below STRIPS_GREYS, and the colour that shows a level. */
static inline uint8_t strips_level(uint8_t grey)
{
    return (uint8_t)((grey * (STRIPS_GREYS - 1u) + 127) / 255);
}
static inline uint32_t strips_colour(unsigned level)
{
    return (level * 255 + (STRIPS_GREYS - 1) / 2) / (STRIPS_GREYS - 1) * UINT32_C(0x010101);
}

/*
 * A way to show pictures: a row of the table in tui/picture/graphics.c, which alone knows it. Its
 * detection is used in graphics.c, its drawing in painter.c.
 */

struct painter;
struct raster;

enum graphics_kind { GRAPHICS_NOTHING, GRAPHICS_TEXT, GRAPHICS_PIXELS };

/* Functions for strips stored in the terminal: send one without showing it; show it at a place, one
 * of several numbered ones; hide it; free it, or all of them. */
struct keeping {
    uint32_t first; /* numbers are larger */
    void (*send)(struct painter *, const struct raster *, uint32_t number, struct buf *);
    void (*place)(const struct painter *, uint32_t number, unsigned place,
                  const struct raster_box *, struct buf *);
    void (*hide)(uint32_t number, unsigned place, struct buf *);
    void (*free)(uint32_t number, struct buf *);
    void (*free_all)(struct buf *);
    uint32_t (*lost)(const char *reply); /* number of the strip that is missing, or 0 */
};

struct graphics {
    const char *name;  /* a word of --graphics */
    const char *title; /* its name for users */
    enum graphics_kind kind;

    /* -- detection: NULL is no question; without `fits`, text always fits and pixels never -- */
    bool (*fits)(const struct probe_replies *);
    struct probe_question question; /* in the second round */
    const char *recovery;           /* ends a transmission cut in two; NULL: ESC \ */
    const char *made_by; /* the terminal that supports all of the protocol; NULL: all that fit, */
    const struct graphics *instead; /* and the row for the others */

    /* -- pixels -- */
    bool over_cells;     /* drawn over cells, so patches are whole cells; else pixels are changed */
    bool in_cells;       /* shown by text, which is erased with it */
    unsigned tmux_keeps; /* facts.images_most inside tmux */
    bool palette_always; /* else 24 bits are possible too */
    uint32_t patch_cost; /* fixed cost of a patch, in pixels: escape, headers, palette */
    void (*once)(struct painter *, const struct raster *, struct buf *);  /* at the cursor */
    void (*whole)(struct painter *, const struct raster *, struct buf *); /* NULL: as a patch */
    void (*patch)(struct painter *, const struct raster *, const struct raster_box *, struct buf *);
    void (*remove)(struct painter *, struct buf *); /* NULL: cells are erased */
    const struct keeping *keeping;                  /* NULL: the terminal stores nothing */

    /* -- text -- */
    enum block_shape shape;
    void (*cell_pixels)(const struct terminal_facts *, uint32_t *width, uint32_t *height);
    bool (*show)(struct painter *, const struct image_view *, struct buf *);
    void (*lines)(const struct terminal_facts *, const struct image_view *, uint32_t columns,
                  uint32_t rows, struct buf *);
};

/* ---- cells of text that show pixels (blocks.c) ---- */

struct block {
    int32_t ink, paper; /* 0xRRGGBB, or a number of the palette, or BLOCK_DEFAULT, the terminal's */
    /* Parts in the ink's colour, a bit each from the top left, which is always 0; without colours
     * the character. */
    uint8_t parts;
    char note; /* a character in place of the parts, or 0 */
};

enum { BLOCK_DEFAULT = -1 };

/* Fill cell[row * stride + column] with the cells that a view covers. Parts outside the view are
 * black. */
void blocks_fill(struct block *cell, size_t stride, const struct image_view *view,
                 const struct terminal_facts *facts);

#endif
