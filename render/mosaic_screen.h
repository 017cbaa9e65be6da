/*
 * Where the panes of a mosaic lie on a screen, so that little of it stays empty.
 *
 * Slices lie as in a file's mosaic, with columns and rows as wide and high as what they show, and
 * the rendition beside the axial slice:
 *
 *     coronal | sagittal       or, where the screen is wider or higher than that takes, with the
 *     --------+----------      rendition beside or below the three, or all four in one row or
 *     axial   | rendition      column: whatever has most of the screen in use
 *
 * Panes begin at whole cells of the screen, so that text can be put over their edges, and what
 * changes in one of them is no part of another's cells.
 */
#ifndef RENDER_MOSAIC_SCREEN_H
#define RENDER_MOSAIC_SCREEN_H

#include "render/mosaic.h"

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
