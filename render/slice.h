/*
 * A slice: one plane of the scene in grey, with its labels over it.
 *
 * Pictures lie as radiologists look at them, whatever the order and direction of the scene's axes:
 * axial from the feet (anterior up, the patient's left on the right), coronal from the front
 * (superior up, his left on the right), sagittal from his left (superior up, anterior on the left).
 * Slices are counted from 0 along the patient's axis: towards superior in axial slices, towards
 * anterior in coronal ones, towards his right in sagittal ones.
 *
 * Pixels are square in millimetres: `zoom` pixels to a voxel of the scene's smallest spacing, and
 * more in proportion where spacing is larger, so that every voxel of the plane has a pixel. A pixel
 * shows the voxel that its centre falls in.
 *
 * A slice is a pure function of the scene, the choice and the palette, in integers. Oblique axes
 * count as the world's axis that they run along, as in views.
 */
#ifndef RENDER_SLICE_H
#define RENDER_SLICE_H

#include <stdint.h>

#include "base/err.h"
#include "engine/scene.h"
#include "render/shade.h"

enum { SLICE_ZOOM_MOST = 8 };

enum slice_plane { SLICE_AXIAL, SLICE_CORONAL, SLICE_SAGITTAL };

enum slice_overlay {
    SLICE_PLAIN,   /* grey alone */
    SLICE_TINT,    /* a quarter of the label's colour, three quarters of the grey */
    SLICE_CONTOUR, /* the label's colour where one of the 4 pixels around has another label */
};

struct slice_choice {
    enum slice_plane plane;
    uint32_t index;    /* 0..slice_count - 1 */
    uint32_t zoom;     /* 1..SLICE_ZOOM_MOST */
    int32_t low, high; /* intensities: black up to low, white from high on; low < high */
    enum slice_overlay overlay;
    uint32_t cross; /* the cell of a voxel at whose place lines cross, which they leave free;
                       CELL_NONE for no lines */
};

struct slice {
    uint32_t width, height;
    uint8_t *rgb; /* [height][width][3], sRGB */
};

/* How many slices of a plane the scene has. */
uint32_t slice_count(const struct scene *scene, enum slice_plane plane);

/* Makes a slice, which the caller releases. ERR_USAGE for an index, zoom or window out of range,
 * ERR_LIMIT for a picture of more than VIEW_SIDE_MOST pixels a side; then there is none. */
enum err slice_init(struct slice *slice, const struct scene *scene,
                    const struct slice_choice *choice, const struct palette *palette,
                    struct fault *fault);
void slice_release(struct slice *slice);

#endif
