/*
 * Slices that live in the terminal: the greys of each go over the wire once, and are placed below
 * the picture as often as they are to be seen again.
 *
 *     picture       labels, cross-hair, marks, words, and the rendition; clear where a slice's own
 *                   greys are seen
 *     strips        parts of slices, a few rows of cells high, each a picture of the terminal's
 *
 * A strip is known by the SHA-256 of its pixels, so nothing has to be said of what became of them:
 * the same slice in the same window at the same size is the same strip, seen before or sent
 * ahead, and after an undo again. Greys are rounded to STRIPS_GREYS levels. Strips have their
 * natural size, so that every version of kitty shows the same pixels.
 *
 *   K1 what the terminal has of a strip is known only by its number: one that it answers not to
 *      have (strips_lost) is sent again;
 *   K2 no number is ever used twice, for a number that is sent again leaks in kitty 0.26;
 *   K3 at most STRIPS_PIXELS_MOST pixels are there: what was not used for longest is freed before
 *      the terminal's own quota, which would take all that is not seen, is reached. Each strip has
 *      a placement of one pixel that nobody sees, or it would count as that.
 *
 * Belongs to the painter (painter_keep); a protocol has it if its row has a `struct keeping`.
 */
#ifndef TUI_PICTURE_STRIPS_H
#define TUI_PICTURE_STRIPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "tui/picture/image_view.h"

enum {
    STRIPS_GREYS = 64,
    STRIPS_KEY = 32,               /* bytes of a SHA-256 */
    STRIPS_MOST = 96,              /* of one picture; a view with more keeps nothing */
    STRIPS_EACH_PIXELS = 12000,    /* about: some 4 kB, which a key waits for at most */
    STRIPS_PIXELS_MOST = 40 << 20, /* half of kitty's 320 MB, at 4 bytes a pixel */
};

struct strips_image {
    uint8_t key[STRIPS_KEY];
    uint32_t number, pixels;
    uint64_t used; /* when: strips.clock */
};

/* Where a strip is shown. */
struct strips_slot {
    uint32_t number; /* 0: nowhere */
    struct raster_box box;
};

struct strips {
    struct strips_image *image;
    size_t images, capacity;
    uint64_t pixels, clock;
    uint32_t last; /* the last number that was given out */
    struct strips_slot slot[STRIPS_MOST];
    /* of the view at hand */
    struct image_strip strip[STRIPS_MOST];
    uint32_t number[STRIPS_MOST]; /* 0 where the terminal has it not */
    unsigned strips;
    uint8_t *greys; /* of the strip at hand, as places */
    size_t greys_capacity;
};

struct painter;

/* Finds the strips of a view, and sends those that the terminal has not, where one looks first, as
 * long as they have no more than `budget` bytes in all, but one at least; none where that is 0. */
void strips_prepare(struct painter *p, const struct image_view *view, size_t budget,
                    struct buf *out);

/* Shows the strips of the view at hand that are there, and no others. */
void strips_show(struct painter *p, struct buf *out);

/* Makes clear what the strips show anyway: `places` has `stride` a row. */
void strips_clear(const struct strips *strips, const struct image_view *view, uint8_t *places,
                  uint32_t stride);

/* Takes all strips off the screen; the terminal still has them. */
void strips_hide(struct painter *p, struct buf *out);

/* The terminal has not this one; false where that says nothing of ours. */
bool strips_lost(struct strips *strips, uint32_t number);

/* It has nothing any more. */
void strips_forget(struct strips *strips);
void strips_release(struct strips *strips);

/* What a grey is shown as. */
static inline uint32_t strips_grey(uint8_t grey)
{
    const uint32_t place = (grey * (STRIPS_GREYS - 1u) + 127) / 255;
    return (place * 255 + (STRIPS_GREYS - 1) / 2) / (STRIPS_GREYS - 1) * UINT32_C(0x010101);
}

#endif
