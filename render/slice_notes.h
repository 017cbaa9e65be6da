/*
 * What lies over the grey of a slice: marks of seeds and eliminators, the cross-hair, letters,
 * bars, a title; the inside of render/slice.h.
 *
 * Sizes follow the picture: what is 1 pixel wide in one of 256 is 2 in one of 512. A picture that
 * is too small for a note goes without it.
 */
#ifndef RENDER_SLICE_NOTES_H
#define RENDER_SLICE_NOTES_H

#include "render/slice_plan.h"

/* False when out of memory. */
bool slice_notes_draw(const struct canvas *canvas, const struct scene *scene,
                      const struct slice_plan *plan, const struct slice_choice *choice,
                      const struct slice_style *style);
#endif
