/*
 * What the pilot marks in its picture, over what slices and rendition show: what an eliminator
 * would take, corners, a pixel, a path; and heat, which colours slices where labels are uncertain.
 */
#ifndef PROGRAM_PILOT_MARKS_H
#define PROGRAM_PILOT_MARKS_H

#include "engine/way.h"
#include "session/session.h"
#include "show/slicing.h"
#include "tui/pilot/pilot.h"

/* Hatched, wherever it is seen. */
void pilot_mark_held(const struct canvas *canvas, const struct session *session,
                     const struct held *held);

/* Around where the rendition's pixel is shown. */
void pilot_mark_pixel(const struct canvas *canvas, const struct slicing_panel *panel,
                      const struct rendition *r, const uint32_t pixel[2]);

/* The corners that the slice of a pane shows. */
void pilot_mark_corners(const struct canvas *canvas, const struct scene *scene,
                        const struct slicing_panel *panel, enum slice_plane plane,
                        const struct pilot_wish *wish);

/* A path in the slice of a pane: white where it lies in it, yellow where in front of it or behind;
 * and a cross around its strongest edge. */
void pilot_mark_way(const struct canvas *canvas, const struct scene *scene,
                    const struct slicing_panel *panel, enum slice_plane plane,
                    const struct way *way);

/* Where heat[cells] is not 0 (engine/hints.h). Greys get it, and tints where they are drawn over;
 * no words, contours or marks. The canvas remembers what lies below. */
#define PILOT_HEAT_HUE 0xff4010u
void pilot_draw_heat(const struct canvas *canvas, const struct mosaic_box *box, const uint8_t *heat,
                     bool over_tint);

#endif
