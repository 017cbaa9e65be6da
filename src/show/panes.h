/* SPDX-License-Identifier: MIT */
/*
 * Panes: slices and rendition of a session as one picture for a screen; what is marked in it, what
 * lies under its pixels, and what lies beyond it.
 *
 *     marks    hatching for what an eliminator would take, crosses for corners and a pixel, an
 *              outline (panes.h), a path back to a seed: white where it lies in a slice,
 *              yellow in front of it or behind, with a cross around its strongest edge
 *     heat     colours slices where labels are uncertain: greys get it, and tints where they are
 *              drawn over; no words, contours or marks
 *     notes    what is written over slices where pixels are too few for letters: the patient's
 *              sides, where the scene's file says how it lies in the patient, and a scale bar, as
 *              characters in cells of the screen
 *
 * Edits that wait for a run are marked, as in show/slicing.h, which draws the slices.
 */
#ifndef SHOW_PANES_H
#define SHOW_PANES_H

#include "image/raster.h"
#include "render/mosaic.h"
#include "show/slicing.h"

enum pane { PANE_AXIAL, PANE_CORONAL, PANE_SAGITTAL, PANE_RENDITION };
enum { PANES_SLICES = 3, PANES_LINES = 4, PANES_NOTES_MOST = 64 };

struct held;
struct outline_mark;
struct way;

/* How the picture is wanted. What is borrowed is of use while it is drawn. */
struct panes_wish {
    uint32_t width, height;           /* pixels, and */
    uint32_t cell_width, cell_height; /* those of a character's cell */
    enum pane pane;                   /* that has a frame, */
    bool is_alone;                    /* or all of the picture */
    bool words;                       /* letters and titles can be read in the pixels */
    const char *line[PANES_LINES];    /* in an empty rendition, where words can be read */
    bool heat;
    uint64_t within_ns;      /* the rendition may be what is drawn at once (slicing_panel) */
    const struct held *held; /* that is hatched, or NULL */
    const struct way *way;   /* that is marked, or NULL */
    const uint8_t *former;   /* [cells] labels: where they are others now it is hatched; or NULL */
    const uint32_t *pixel;   /* [2] of the rendition, by its own column and row, or NULL */
    const uint32_t (*corner)[3]; /* voxels that are marked in the slices */
    size_t corners;
    const struct outline_mark *outline; /* that is drawn, or NULL */
};

/* {0} is none yet. */
struct panes {
    struct canvas canvas;       /* the picture, with cells, words and what lies below */
    struct slicing_panel panel; /* what it is of */
    struct raster_note note[PANES_NOTES_MOST];
    size_t notes;
    struct canvas beyond; /* a slice that may be wanted next */
};
void panes_release(struct panes *panes);

/* Draws, of a session with a scene. Errors are those of slicing_draw_panel and of hints. */
enum err panes_draw(struct panes *panes, struct session *session, const struct panes_wish *wish,
                    struct fault *fault);

/* Where a pane lies in the picture; no width where it is not shown. */
struct raster_box panes_box(const struct panes *panes, enum pane pane);

/* Of slices that may be wanted next, `number` by `number` from 0 on: those on both sides of what is
 * shown, the nearer ones first, and of the pane `first` (a slice's) before the others. Its name is
 * that of its greys: of the slice, the window, and how it is shown; 0 where there is none. */
uint64_t panes_name_beyond(const struct panes *panes, struct session *session, enum pane first,
                           unsigned number);

/* Draws its greys into `beyond`. False where there is none, or no memory. */
bool panes_draw_beyond(struct panes *panes, struct session *session, enum pane first,
                       unsigned number);

/* The voxel in the middle of the slices of a pane, and the place of the cross-hair, once the
 * picture has gone on by so many eighths of it, {right, down}. False where it is shown to its
 * end. */
bool panes_pan(const struct panes *panes, const struct session *session, enum pane pane,
               const int by[2], uint32_t middle[3], uint32_t place[3]);

/* ---- of a session, whatever is drawn ---- */

/* The place that lies so many slices along each plane's count from the cross-hair; as far as the
 * scene goes. */
void panes_move(const struct session *session, const int64_t by[PANES_SLICES], uint32_t place[3]);

/* A seed of an object waits, or a voxel has its label; where nobody has counted yet, so it is. */
bool panes_have_object(const struct session *session);

/* A colour of its own in the picture: that of heat. */
#define PANES_HEAT_HUE 0xff4010u

/*
 * An outline over a slice, as it is drawn or corrected: the line through its corners, dotted where
 * it is still to be closed, and what it would plant, faintly: of the pixels of those voxels that
 * paint_polygon covers, one of four has the colour of the label, whole, so that it is among the
 * colours of any screen.
 *
 * Only the slice that all corners lie in shows it. The line is white, with black beside it, so that
 * it is seen on any grey; what lies beside the pane is left out.
 */

struct outline_mark {
    const uint32_t (*corner)[3];
    size_t corners;
    uint8_t rgb[3]; /* of the label */
};

#endif
