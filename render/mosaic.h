/* SPDX-License-Identifier: MIT */
/*
 * A mosaic: the three slices through one voxel, at one scale, and the rendition.
 *
 *     coronal | sagittal        The patient's sides continue from pane to pane: superior is up in
 *     --------+---------        both upper ones, left is on the right in both left ones, and the
 *     axial   | rendition       lines of the cross-hair meet at the seams.
 *
 * Each pane has half of the picture, less a thin seam, or its place in a layout. If the
 * rendition is as large as the mosaic, its pane averages blocks of two by two pixels. A rendition
 * of another size is fitted: in its own shape, centred, averaged if it is larger than the pane, and
 * enlarged by an integer factor if it is smaller. The background fills the pane, black if it is
 * clear.
 */
#ifndef RENDER_MOSAIC_H
#define RENDER_MOSAIC_H

#include "render/slice.h"

struct rendition;
struct team;

enum { MOSAIC_SIDE_LEAST = 16, MOSAIC_PANES = 4 };

/* The first three are the planes of render/slice.h. */
enum mosaic_pane { MOSAIC_AXIAL, MOSAIC_CORONAL, MOSAIC_SAGITTAL, MOSAIC_RENDITION };

struct mosaic_box {
    uint32_t left, top, width, height;
};

/* The places of panes; a hidden pane has no width. */
struct mosaic_layout {
    struct mosaic_box box[MOSAIC_PANES];
};

struct mosaic_choice {
    uint32_t place[3];
    const char *title[3]; /* titles of slices, by enum slice_plane; or NULL */
    bool notes;
    struct team *team; /* draws the panes in parallel; NULL: the caller alone, with the same pixels
                          */
    uint32_t times;    /* slices are magnified, in thousandths; 0 as SLICE_TIMES_ONE */
    bool has_middle;   /* centre slices on `middle`, otherwise on `place` */
    uint32_t middle[3];
    const struct mosaic_layout *layout; /* NULL: halves */
    uint32_t background;                /* the rendition pane's (render/palette.h) */
    uint32_t coarse;                    /* pixels a side that one of the rendition covers; 0 as 1 */
};

/* Return the place of a pane in a picture of halves, of MOSAIC_SIDE_LEAST pixels a side or more. */
struct mosaic_box mosaic_box(uint32_t width, uint32_t height, enum mosaic_pane pane);

/* Return the choice for one of the slices. */
struct slice_choice mosaic_slice(const struct scene *scene, const struct mosaic_choice *choice,
                                 uint32_t width, uint32_t height, enum slice_plane plane);

/* Fill a canvas, and canvas->cell if it is not NULL; a rendition without maps shows only the
 * background. ERR_MEMORY. */
enum err mosaic_draw(const struct canvas *canvas, const struct scene *scene,
                     const struct rendition *rendition, const struct mosaic_choice *choice,
                     const struct slice_style *style, struct fault *fault);

/* Return the pixel of a mosaic of that size that shows a pixel of the rendition. */
struct mosaic_point {
    uint32_t column, row;
};
struct mosaic_point mosaic_point_of(uint32_t width, uint32_t height,
                                    const struct mosaic_choice *choice,
                                    const struct rendition *rendition, uint32_t column,
                                    uint32_t row);

/* Return the cell that a pixel of a picture of that size shows, or CELL_NONE. A pixel of the
 * rendition's pane shows the nearest voxel and the mean colour of its pixels, as if they were
 * samples. */
uint32_t mosaic_cell_at(const struct scene *scene, uint32_t width, uint32_t height,
                        const struct rendition *rendition, const struct mosaic_choice *choice,
                        uint32_t column, uint32_t row);

/* ---- on a screen ---- */

/* The layout of panes on a screen, which they fill. Slices are arranged as in a file's mosaic, with
 * columns and rows in proportion to the scene, and the rendition right of the axial slice. If
 * another layout uses a fifth more of the screen, the rendition is right of or below the three, or
 * all four are in one row or column. Panes begin at whole cells of the screen, so that text can be
 * put over their edges, and cells never belong to two panes. */
enum { MOSAIC_COLUMNS_LEAST = 8, MOSAIC_ROWS_LEAST = 4 }; /* cells for all panes */

struct mosaic_screen {
    uint32_t width, height;           /* pixels, whole cells */
    uint32_t cell_width, cell_height; /* at least MOSAIC_SIDE_LEAST pixels a side */
    bool shows_all;                   /* show all panes, or `alone` */
    enum mosaic_pane alone;
};

/* Return true if the screen has room for its panes: a condition of the next function. */
bool mosaic_fits(const struct mosaic_screen *screen);
void mosaic_lay_out(struct mosaic_layout *layout, const struct scene *scene,
                    const struct mosaic_screen *screen);

#endif
