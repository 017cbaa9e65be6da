/*
 * Notes: what slices and renditions have in common of the words and bars that are drawn over them.
 *
 * Sizes follow the picture by `unit`, how many pixels a thin line is wide (slice_unit). All of it
 * has an outline, so that it shows on any ground.
 */
#ifndef RENDER_NOTES_H
#define RENDER_NOTES_H

#include "render/canvas.h"

enum { NOTES_LARGE_FROM = 192 }; /* pixels of the shorter side from which letters are larger */

/* The colours of words and bars. */
struct ink {
    uint8_t rgb[3], outline[3];
};
extern const struct ink notes_light, notes_dark; /* as slices have it; for what is mostly bright */
extern const uint8_t notes_yellow[3];            /* of the cross-hair */

/* The picture's shorter side. */
uint32_t notes_side(const struct canvas *canvas);

/* How large letters of the patient's sides are (render/text.h). */
uint32_t notes_letter_scale(const struct canvas *canvas, uint32_t unit);

/* Words in the middle of the left, right, upper and lower edges. */
void notes_draw_sides(const struct canvas *canvas, uint32_t unit, const char *const word[4],
                      const struct ink *ink);

/* Bottom left: a bar so many pixels long, and its length in words above it. */
void notes_draw_scale(const struct canvas *canvas, uint32_t unit, int64_t pixels, const char *words,
                      const struct ink *ink);

#endif
