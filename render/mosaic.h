/* SPDX-License-Identifier: MIT */
/*
 * A mosaic: the three slices through one voxel, at one scale, and the rendition.
 *
 *     coronal | sagittal        The patient's sides run on from pane to pane: superior is up in
 *     --------+---------        both upper ones, his left is on the right in both left ones, and
 *     axial   | rendition       the lines of the cross-hair meet at the seams.
 *
 * Each pane has half of the picture, less a thin seam, or lies where a layout has it. Where the
 * rendition is as large as the mosaic, its pane has every two by two pixels averaged, the picture
 * at half its size. A rendition of another size is fitted in: in its own shape, in the middle,
 * averaged where it is larger than the pane, and a whole number of times as large where it is
 * smaller. All of the pane has the background behind it, black where that is clear.
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

/* Where panes lie; one that is not shown has no width. */
struct mosaic_layout {
    struct mosaic_box box[MOSAIC_PANES];
};

struct mosaic_choice {
    uint32_t place[3];
    const char *title[3]; /* of the slices, by enum slice_plane; or NULL */
    bool notes;
    struct team *team; /* draws the panes side by side; NULL: the caller alone, the same pixels */
    uint32_t times;    /* slices are magnified, in thousandths; 0 as SLICE_TIMES_ONE */
    bool has_middle;   /* around this voxel, and else around `place` */
    uint32_t middle[3];
    const struct mosaic_layout *layout; /* NULL: halves */
    uint32_t background;                /* of the rendition's pane (render/palette.h) */
    uint32_t coarse; /* a pixel of the rendition stands for so many a side; 0 as 1 */
};

/* Where a pane lies in a picture of halves, of MOSAIC_SIDE_LEAST pixels a side or more. */
struct mosaic_box mosaic_box(uint32_t width, uint32_t height, enum mosaic_pane pane);

/* What one of the slices is. */
struct slice_choice mosaic_slice(const struct scene *scene, const struct mosaic_choice *choice,
                                 uint32_t width, uint32_t height, enum slice_plane plane);

/* Fills a canvas, and canvas->cell where it has that; a rendition without maps leaves its pane to
 * the background. ERR_MEMORY. */
enum err mosaic_draw(const struct canvas *canvas, const struct scene *scene,
                     const struct rendition *rendition, const struct mosaic_choice *choice,
                     const struct slice_style *style, struct fault *fault);

/* Where a pixel of the rendition lies in a mosaic of that size that shows it. */
struct mosaic_point {
    uint32_t column, row;
};
struct mosaic_point mosaic_point_of(uint32_t width, uint32_t height,
                                    const struct mosaic_choice *choice,
                                    const struct rendition *rendition, uint32_t column,
                                    uint32_t row);

/* The cell that a pixel of a picture of that size shows, or CELL_NONE. A pixel of the rendition's
 * pane shows the voxel of the nearest of its pixels, and the mean of their colours, as a pixel of
 * samples does. */
uint32_t mosaic_cell_at(const struct scene *scene, uint32_t width, uint32_t height,
                        const struct rendition *rendition, const struct mosaic_choice *choice,
                        uint32_t column, uint32_t row);

/* ---- on a screen ---- */

/* Where panes lie on a screen, all of which they take. Slices lie as in a file's mosaic, with
 * columns and rows as wide and high as what they show, and the rendition beside the axial slice;
 * or, where the screen is so much wider or higher that this has a fifth more of it in use, with the
 * rendition beside or below the three, or all four in one row or column. Panes begin at whole cells
 * of the screen, so that text can be put over their edges, and what changes in one of them is no
 * part of another's cells. */
enum { MOSAIC_COLUMNS_LEAST = 8, MOSAIC_ROWS_LEAST = 4 }; /* cells, for all panes */

struct mosaic_screen {
    uint32_t width, height;           /* pixels: whole cells, and */
    uint32_t cell_width, cell_height; /* MOSAIC_SIDE_LEAST pixels a side or more */
    bool shows_all;                   /* all panes, or else: */
    enum mosaic_pane alone;
};

/* Whether a screen has room for what it is to show; mosaic_lay_out is for those that have. */
bool mosaic_fits(const struct mosaic_screen *screen);
void mosaic_lay_out(struct mosaic_layout *layout, const struct scene *scene,
                    const struct mosaic_screen *screen);

#endif
