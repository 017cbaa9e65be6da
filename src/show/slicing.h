/* SPDX-License-Identifier: MIT */
/*
 * Slices and mosaics of a session: what is drawn, under which settings, at the size of the view.
 *
 * They show the forest as it stands; edits that wait for a run are marked. Real values and
 * millimetres become integers and words here, above render/, so that pictures are drawn in integers
 * alone.
 */
#ifndef SHOW_SLICING_H
#define SHOW_SLICING_H

#include "image/picture.h"
#include "render/mosaic.h"
#include "session/session.h"

/* What can be drawn. The first three are the planes of render/slice.h. */
#define SLICE_WORDS "axial|coronal|sagittal"
#define SLICE_KINDS SLICE_WORDS "|mosaic"
enum slice_kind { SLICE_KIND_AXIAL, SLICE_KIND_CORONAL, SLICE_KIND_SAGITTAL, SLICE_KIND_MOSAIC };

/* Draws a slice or a mosaic of labels (session_labels; NULL: those of the forest) as the settings
 * have it; the caller releases the canvas. A mosaic makes the rendition, if that is not up to date.
 * ERR_LIMIT for a mosaic of a view that is too small. */
enum err slicing_draw(struct canvas *canvas, struct session *session, enum slice_kind kind,
                      const struct labels *labels, bool tells_cells, struct fault *fault);

/* ERR_LIMIT for a view that is too small for a mosaic. */
enum err slicing_check_size(const struct view *view, struct fault *fault);

/* The cell of the voxel under a pixel of the picture that slicing_draw would make now, or
 * CELL_NONE; the pixel lies within the view's size. Errors are those of slicing_draw. */
enum err slicing_cell_at(uint32_t *cell, struct session *session, enum slice_kind kind,
                         const struct labels *labels, uint32_t column, uint32_t row,
                         struct fault *fault);

/* A mosaic as panes of a screen (render/mosaic.h): the rendition is fitted in, and so is
 * what it shows (session_fitting_view). */
struct slicing_panel {
    struct mosaic_screen screen;
    bool words;         /* patient letters, titles and scale bars can be read in its pixels */
    uint64_t within_ns; /* the rendition may be what is drawn at once, */
    bool is_hasty;      /* and is (session_draw_fitting) */
    struct mosaic_layout layout;
    struct mosaic_choice choice; /* borrows layout and the session's team; titles are gone */
};

/* Draws it, of the labels that session_draw_fitting shows, and fills in what follows `within_ns`.
 * The canvas, {0} or one that was drawn before, has its cells, and remembers where words are and
 * what lies below; the caller releases it. ERR_LIMIT for a screen without room (mosaic_fits). */
enum err slicing_draw_panel(struct canvas *canvas, struct session *session,
                            struct slicing_panel *panel, struct fault *fault);

/* Draws the greys alone of another slice of a panel that was drawn, through `place`, as that pane
 * would have them below, on a canvas of its size, which remembers them; the caller releases it. */
enum err slicing_draw_below(struct canvas *canvas, struct session *session,
                            const struct slicing_panel *panel, enum slice_plane plane,
                            const uint32_t place[3], struct fault *fault);

/* The canvas, which has its cells, as a picture with labels, voxels and notes. Labels are those
 * of the voxels, be they overlaid or not. The caller releases it. */
enum err slicing_export(struct picture *picture, const struct session *session,
                        enum slice_kind kind, const struct labels *labels,
                        const struct canvas *canvas, struct fault *fault);

#endif
