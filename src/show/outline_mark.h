/* SPDX-License-Identifier: MIT */
/*
 * An outline over a slice, as it is drawn or corrected: the line through its corners, dotted where
 * it is still to be closed, and what it would plant, faintly: of the pixels of those voxels that
 * paint_polygon covers, one of four has the colour of the label, whole, so that it is among the
 * colours of any screen.
 *
 * Only the slice that all corners lie in shows it. The line is white, with black beside it, so that
 * it is seen on any grey; what lies beside the pane is left out.
 */
#ifndef SHOW_OUTLINE_MARK_H
#define SHOW_OUTLINE_MARK_H

#include "render/mosaic.h"

struct outline_mark {
    const uint32_t (*corner)[3];
    size_t corners;
    uint8_t rgb[3]; /* of the label */
};

/* Over the slice in a box of the canvas, which has its cells, words and what lies below. Without
 * memory the line alone. */
void outline_mark_draw(const struct canvas *canvas, const struct scene *scene,
                       const struct slice_choice *slice, const struct mosaic_box *box,
                       const struct outline_mark *mark);

#endif
