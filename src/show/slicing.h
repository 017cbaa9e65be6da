/* SPDX-License-Identifier: MIT */
/*
 * Slices and mosaics of a session by its settings, at the size of the view.
 *
 * They show the forest's present labels; edits that wait for a run are marked. Real values and
 * millimetres become integers and text here, so that render/ draws with integers alone.
 */
#ifndef SHOW_SLICING_H
#define SHOW_SLICING_H

#include "image/picture.h"
#include "render/mosaic.h"
#include "session/session.h"

/* Kinds of pictures. The first three are the planes of render/slice.h. */
#define SLICE_WORDS "axial|coronal|sagittal"
#define SLICE_KINDS SLICE_WORDS "|mosaic"
enum slice_kind { SLICE_KIND_AXIAL, SLICE_KIND_CORONAL, SLICE_KIND_SAGITTAL, SLICE_KIND_MOSAIC };

/* Draw a slice or a mosaic of labels (session_labels; NULL: the forest's) by the settings; the
 * caller releases the canvas. A mosaic updates the rendition. ERR_LIMIT for a mosaic if the view is
 * too small. */
enum err slicing_draw(struct canvas *canvas, struct session *session, enum slice_kind kind,
                      const struct labels *labels, bool tells_cells, struct fault *fault);

/* ERR_LIMIT for a view too small for a mosaic. */
enum err slicing_check_size(const struct view *view, struct fault *fault);

/* Find the cell under a pixel of the picture that slicing_draw would draw now, or CELL_NONE. The
 * pixel must be inside the view. Errors are those of slicing_draw. */
enum err slicing_cell_at(uint32_t *cell, struct session *session, enum slice_kind kind,
                         const struct labels *labels, uint32_t column, uint32_t row,
                         struct fault *fault);

/* A mosaic as panes of a screen (render/mosaic.h). The rendition is fitted to its pane
 * (session_fitting_view). */
struct slicing_panel {
    struct mosaic_screen screen;
    bool words;         /* letters, titles and scale bars are readable in its pixels */
    uint64_t within_ns; /* the rendition may be a coarse one, */
    bool is_hasty;      /* and is one (session_draw_fitting) */
    struct mosaic_layout layout;
    struct mosaic_choice choice; /* borrows layout and the session's team; without titles */
};

/* The choice of a panel by the present settings, which may not be drawn yet. The caller sets its
 * layout. Borrows the session's team. */
struct mosaic_choice slicing_choice(const struct session *session);

/* Draw a panel with the labels of session_draw_fitting, and set the members after `within_ns`. The
 * canvas is {0} or was drawn before; it gets its cells, words and the greys below; the caller
 * releases it. ERR_LIMIT for a screen that is too small (mosaic_fits). */
enum err slicing_draw_panel(struct canvas *canvas, struct session *session,
                            struct slicing_panel *panel, struct fault *fault);

/* Draw the greys of another slice of a drawn panel, through `place`, on a canvas of the pane's
 * size, which keeps them as `below`; the caller releases it. */
enum err slicing_draw_below(struct canvas *canvas, struct session *session,
                            const struct slicing_panel *panel, enum slice_plane plane,
                            const uint32_t place[3], struct fault *fault);

/* Convert a canvas with cells to a picture with labels, voxels and notes. The labels are those of
 * the voxels, also without an overlay. The caller releases it, also on error. */
enum err slicing_export(struct picture *picture, const struct session *session,
                        enum slice_kind kind, const struct labels *labels,
                        const struct canvas *canvas, struct fault *fault);

#endif
