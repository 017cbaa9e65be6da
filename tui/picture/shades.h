/* SPDX-License-Identifier: MIT */
/*
 * The colours of a picture, known before it is made: what the labels' hues become when they are
 * shaded (render/shade.c) or laid over a slice (render/slice.c), and greys.
 *
 *     a hue, shaded     from black to the hue, and on towards white, as far as gloss goes
 *     a tint            from a third of the hue upwards, a third of it and two thirds of a grey
 *     greys             from black to white
 *     accents           the colours of cross-hairs and marks
 *
 * So no colours are sought in pictures, and the palette stays from one picture to the next. A pixel
 * goes to the entry nearest to it, which is remembered for all colours that have the same 6 leading
 * bits a channel: a look into a table of 256 kB, filled as needed.
 *
 *   S1 the same colour has the same place in every picture until shades_choose says otherwise;
 *   S2 place 0 is black, and black has place 0;
 *   S3 a picture of few colours, text for instance, has exactly these ("exact").
 *
 * Many hues share what entries there are: those that are but darker versions of another have its
 * levels. Tints get levels only where a look at every so manieth pixel finds some. Where no hues
 * are known, or so many that each would have but a few levels, the colours are those that suit the
 * picture best, until another picture has others.
 */
#ifndef TUI_PICTURE_SHADES_H
#define TUI_PICTURE_SHADES_H

#include <stdbool.h>

#include "image/picture.h"
#include "tui/picture/image_view.h"

enum { SHADES_MOST = 250, SHADES_HUES_MOST = 256 }; /* colours that every sixel terminal has */

struct shades {
    uint32_t colour[SHADES_MOST]; /* 0xRRGGBB */
    unsigned count;
    bool is_exact, is_laddered;
    bool is_suited;      /* the colours are those that suited a picture */
    uint16_t slot[1024]; /* exact: a place + 1, by a hash of the colour */
    uint8_t *place;      /* otherwise: a place + 1, by colour; 0 where it was not sought yet */

    /* what the palette was made for, and the hues that are left of those given */
    uint32_t given[SHADES_HUES_MOST], hue[SHADES_HUES_MOST];
    unsigned givens, hues;
    bool has_greys, has_tints;
    uint32_t off; /* by how much colours of the picture that it was made for are off, where it has
                     no ladders: the mean of looks */
};

/* `struct shades s = {0}` is ready. */
void shades_release(struct shades *shades);

/* Takes the picture's own colours, where they are few enough; else false, with the colours of the
 * palette that was there. Needs no memory. */
bool shades_take_exact(struct shades *shades, const struct image_view *view);

/* Makes the palette for a picture that is sent whole; the one there is stays where it serves. False
 * without memory. */
bool shades_choose(struct shades *shades, const struct image_view *view);

/* Whether the palette is for the hues of a view. */
bool shades_serve(const struct shades *shades, const struct image_view *view);

/* Whether a view has greys or tints, or colours of other regions, and the palette, which serves it,
 * few or none. */
bool shades_lack(struct shades *shades, const struct image_view *view);

/* Whether a view has a palette, however many colours it has: always in some protocols; in the
 * others not where it is smooth, or has no hues. */
bool shades_needed(const struct image_view *view, bool always);

/* Puts the view into `bytes`, `width` x `height` pixels, which may be more than it has and are
 * black then: as places in the palette, or as 24-bit colours. False where the palette is exact and
 * has no room for another colour: choose again, and send the picture whole. */
bool shades_fill(struct shades *shades, bool has_palette, const struct image_view *view,
                 uint8_t *bytes, uint32_t width, uint32_t height);

#endif
