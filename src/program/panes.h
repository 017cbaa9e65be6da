/* SPDX-License-Identifier: MIT */
/*
 * Panes: slices and rendition of a session as one picture for the pilot's screen, with its marks,
 * the voxels under its pixels, and the slices next to those shown.
 *
 *     marks    hatching for the voxels that an eliminator would remove, crosses for corners and a
 *              pixel, an outline, a path back to a seed: white in the slice, yellow in front of it
 *              or behind it, with a cross around its strongest edge
 *     heat     colours slices where labels are uncertain: greys get it, and tints where the overlay
 *              is a tint; no words, contours or marks. In a hasty picture only if it is known
 *     notes    written over slices where pixels are too few for letters: the patient's sides, if
 *              the scene's orientation is known, and a scale bar, as characters in cells of
 *              the screen
 *
 * Edits that wait for a run are marked, as in show/slicing.h, which draws the slices.
 *
 * An outline is drawn in the slice that has all its corners: a white line through them with black
 * next to it, visible on any grey, dotted where it is still open. The voxels that it would plant
 * (paint_polygon) have a light tint of the label's colour. Pixels outside the pane are left out.
 */
#ifndef PROGRAM_PANES_H
#define PROGRAM_PANES_H

#include "engine/way.h"
#include "image/picture.h"
#include "render/mosaic.h"
#include "show/slicing.h"
#include "tui/pilot/host.h"

enum { PANES_SLICES = 3, PANES_LINES = 4, PANES_NOTES_MOST = 256 };

/* {0}: nothing is drawn yet. */
struct panes {
    struct canvas canvas;       /* the picture, with cells, words and the greys below */
    struct slicing_panel panel; /* its layout */
    struct raster_note note[PANES_NOTES_MOST];
    size_t notes;
    struct canvas beyond;  /* a slice next to those shown */
    struct held held;      /* found last by the pilot's `held`, until the next command */
    struct way way;        /* found last by its `why` */
    const uint8_t *former; /* labels [cells] before the last step: changed voxels are hatched; or
                              NULL */
};
void panes_release(struct panes *panes);

/* Draw a session with a scene; `line` is shown in an empty rendition, if words can be read. Errors
 * are those of slicing_draw_panel and of hints. */
enum err panes_draw(struct panes *panes, struct session *session, const struct pilot_wish *wish,
                    const struct buf line[PANES_LINES], struct fault *fault);

/* The box of a pane in the picture; its width is 0 for a hidden pane. */
struct raster_box panes_box(const struct panes *panes, enum pilot_pane pane);

/* Name slices that the viewer may want next, by `number` from 0 on: neighbours on both sides of
 * those shown, the nearer ones first, those of the pane `first` (a slice's) before others. The name
 * depends on the slice, the window and the layout, and identifies its greys. Returns 0 if there is
 * no such slice. */
uint64_t panes_name_beyond(const struct panes *panes, struct session *session,
                           enum pilot_pane first, unsigned number);

/* Draw its greys into `beyond`. False if there is no such slice, or no memory. */
bool panes_draw_beyond(struct panes *panes, struct session *session, enum pilot_pane first,
                       unsigned number);

/* Move a magnified pane by eighths of its size, {right, down}: computes the voxel in the middle of
 * its slices and the place of the cross-hair, by the present settings: the picture may not be drawn
 * yet. False at the edge of the scene. */
bool panes_pan(const struct panes *panes, const struct session *session, enum pilot_pane pane,
               const int by[2], uint32_t middle[3], uint32_t place[3]);

/* ---- of a session, whatever is drawn ---- */

/* The place `by` slices from the cross-hair along each plane's count, clamped to the scene. */
void panes_move(const struct session *session, const int64_t by[PANES_SLICES], uint32_t place[3]);

/* True if a seed of an object waits, a voxel has a label above 0, or labels are not counted. */
bool panes_have_object(const struct session *session);

/* A colour of its own in the picture: that of heat. */
#define PANES_HEAT_HUE 0xff4010u

#endif
