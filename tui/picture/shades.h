/* SPDX-License-Identifier: MIT */
/*
 * The colours of a picture, known before it is drawn: the hues of labels, shaded (render/shade.c)
 * or laid over a slice (render/slice.c), and greys.
 *
 *     a hue, shaded     from black to the hue, and on towards white, as far as gloss reaches
 *     a tint            from a third of the hue upwards: a third of it and two thirds of a grey
 *     greys             from black to white
 *     accents           the colours of cross-hairs and marks
 *
 * So pictures are not searched for colours, and the palette stays from one picture to the next. A
 * pixel maps to the nearest entry, which is cached for all colours that have the same 6 leading
 * bits a channel: a lookup in a table of 256 kB, filled on demand.
 *
 *   S1 the same colour has the same place in every picture until shades_choose, unless a view has
 *      few greys: then places are joined where that is hardly seen, since bytes count;
 *   S2 place 0 is black, and black has place 0;
 *   S3 a picture of few colours, text for instance, has exactly these ("exact").
 *
 * Many hues share the entries: hues that are darker versions of another use its levels. Tints have
 * levels only if the view says so or a sample of the pixels has some. If no hues are known, or too
 * many for more than a few levels each, the colours are chosen for the picture, and replaced when
 * another picture needs others.
 */
#ifndef TUI_PICTURE_SHADES_H
#define TUI_PICTURE_SHADES_H

#include <stdbool.h>

#include "image/picture.h"
#include "tui/picture/image_view.h"

enum { SHADES_MOST = 250, SHADES_HUES_MOST = 256 }; /* colours that every sixel terminal has */
/* On a slow line, if that saves bytes: greys, and steps of a channel that do not matter. */
enum { SHADES_GREYS_FEW = 24, SHADES_JOINED = 8 };

struct shades {
    uint32_t colour[SHADES_MOST]; /* 0xRRGGBB */
    unsigned count;
    bool is_exact, is_laddered;
    bool is_suited;      /* the colours were chosen for a picture */
    uint16_t slot[1024]; /* exact: index + 1, by a hash of the colour */
    uint8_t *place;      /* otherwise: index + 1, by colour; 0 if not looked up yet */

    /* hues that the palette was made for, and those of them in use */
    uint32_t given[SHADES_HUES_MOST], hue[SHADES_HUES_MOST];
    unsigned givens, hues;
    bool has_greys, has_tints, has_few_greys;
    /* Mean error of the palette for the picture that it was made for, if it has no ladders. */
    uint32_t off;
};

/* `struct shades s = {0}` is ready. */
void shades_release(struct shades *shades);

/* Use the picture's own colours if they are few enough; otherwise return false and keep the
 * palette. Allocates nothing. */
bool shades_take_exact(struct shades *shades, const struct image_view *view);

/* Make the palette for a picture that is sent whole; keep the present one if it suits. Return false
 * without memory. */
bool shades_choose(struct shades *shades, const struct image_view *view);

/* Return true if the palette was made for the hues of a view. */
bool shades_serve(const struct shades *shades, const struct image_view *view);

/* Return true if a view has greys or tints, or colours of other regions, for which the palette,
 * made for its hues, has few or no entries. */
bool shades_lack(struct shades *shades, const struct image_view *view);

/* Return true if a view needs a palette, however many colours it has: always in some protocols; in
 * the others unless it is smooth or has no hues. */
bool shades_needed(const struct image_view *view, bool always);

/* Return the largest difference of two colours in a channel. */
uint32_t shades_apart(uint32_t a, uint32_t b);

/* Write the view to `bytes`, `width` x `height` pixels (black outside the view): as indices of the
 * palette, or as 24-bit colours. Return false if the palette is exact and has no room for another
 * colour: choose again, and send the picture whole. */
bool shades_fill(struct shades *shades, bool has_palette, const struct image_view *view,
                 uint8_t *bytes, uint32_t width, uint32_t height);

#endif
