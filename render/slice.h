/* SPDX-License-Identifier: MIT */
/*
 * A slice: one plane of the scene in grey, with labels, marks and notes drawn over it.
 *
 * Pixels are square in millimetres. A pixel shows the label, seed and voxel that contain its
 * centre; its grey is that of the voxel, or, if `smooth`, interpolated between the centres of the
 * four around. Outside the scene pixels are black, without label.
 *
 * Marks of seeds and eliminators, the cross-hair, letters, bars and a title are drawn over it.
 * Their sizes follow the picture: a line 1 pixel wide in a picture of 256 is 2 wide in one of 512.
 * Pictures that are too small for a note omit it.
 *
 * A slice is a pure function of its arguments, in integers.
 */
#ifndef RENDER_SLICE_H
#define RENDER_SLICE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "engine/scene.h"
#include "render/canvas.h"
#include "render/notes.h"
#include "render/palette.h"

/*
 * The geometry of a slice: the relation of its pixels to the voxels.
 *
 * Orientation is radiological, whatever the order and direction of the scene's axes: axial from the
 * feet (anterior up, the patient's left on the right), coronal from the front (superior up, left on
 * the right), sagittal from the left (superior up, anterior on the left). Slices are counted from 0
 * along the patient's axis: towards superior in axial slices, towards anterior in coronal ones,
 * towards right in sagittal ones. Oblique axes count as the nearest axis of the world, as in views.
 */

enum slice_plane { SLICE_AXIAL, SLICE_CORONAL, SLICE_SAGITTAL };

enum { SLICE_TIMES_ONE = 1000, SLICE_TIMES_MOST = 4096 * SLICE_TIMES_ONE };

enum slice_note {
    SLICE_LETTERS = 1, /* R L A P S I at the edges, if the sides are known */
    SLICE_SCALE = 2,   /* a bar of a round length */
    SLICE_COLOURS = 4, /* a bar of the greys, with the values at its ends */
};

/* A slice and its magnification: a pixel is `pixel_pm` picometres wide, or with 0 as small as fits
 * the slice. A slice that does not fit is centred on `middle`, or on `place`, as far as the scene
 * extends and `place` stays an eighth of the picture off its edge. */
struct slice_choice {
    enum slice_plane plane;
    uint32_t place[3]; /* a voxel of the slice, at the centre of the cross-hair */
    uint64_t pixel_pm;
    bool smooth;
    unsigned notes;    /* enum slice_note */
    const char *title; /* or NULL */
    bool has_middle;
    uint32_t middle[3];
    uint32_t
        size; /* shorter side of the picture that defines line width and letter size; 0: its own */
};

/* The scene's axis along which slices of a plane are counted; their number; the index of the slice
 * through a voxel; and move a place to slice `index`. */
int slice_axis(const struct scene *scene, enum slice_plane plane);
uint32_t slice_count(const struct scene *scene, enum slice_plane plane);
uint32_t slice_index(const struct scene *scene, enum slice_plane plane, const uint32_t place[3]);
void slice_move(const struct scene *scene, enum slice_plane plane, uint32_t index,
                uint32_t place[3]);

/* Return the name of a plane before its number: "axial"; or, if the patient's sides are unknown,
 * the scene's axis along which slices are counted, "z". */
const char *slice_name(const struct scene *scene, enum slice_plane plane);

/* Return the pixel_pm at which a slice just fits a picture; and at which the scene's smallest
 * spacing is `zoom` thousandths of a pixel. */
uint64_t slice_fitting_pixel(const struct scene *scene, enum slice_plane plane, uint32_t width,
                             uint32_t height);
uint64_t slice_zoomed_pixel(const struct scene *scene, uint32_t zoom);

/* Magnify a slice to `times` thousandths of its size at `fitting_pm`. Once a voxel has four pixels
 * along the smallest spacing, it is not smoothed. */
void slice_magnify(struct slice_choice *choice, const struct scene *scene, uint64_t fitting_pm,
                   uint32_t times);

/* Return the width of a thin line in a picture of that shorter side. */
uint32_t slice_unit(uint32_t size);

/* Return the patient's sides at the left, right, top and bottom of a picture: R L A P S I. The
 * sides of the scene must be known. */
void slice_letters(const struct scene *scene, enum slice_plane plane, char letter[4]);

/* Return the largest of 1, 2, 5, 10, 20, 50... up to `most`, which is 1 or more; and write a length
 * in picometres as "20 mm", "0.05 mm". */
uint64_t slice_round_length(uint64_t most);
void slice_length_words(char out[32], uint64_t pm);

/* Pan a slice in a picture of that size by eighths of it, to the right and down, at least by a
 * voxel: return the new middle, and the place, moved only as far as necessary. False, with both
 * unchanged, at the end of the scene. */
bool slice_pan(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
               uint32_t height, const int by[2], uint32_t middle[3], uint32_t place[3]);

/* Return the cell that a pixel shows in a picture of that size, or CELL_NONE. */
uint32_t slice_cell_at(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
                       uint32_t height, uint32_t column, uint32_t row);

/* Return the pixel, by column and row, that contains the centre of a voxel, where cross-hair and
 * marks are drawn too. False for a voxel of another slice, or outside the picture. */
bool slice_pixel_of(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
                    uint32_t height, const uint32_t place[3], uint32_t pixel[2]);

/* ---- the arithmetic ---- */

/* Each side of the picture, columns and rows, is along one axis of the scene. Lengths are in
 * picometres from the edge of the scene where the picture's side begins, doubled, so that centres
 * are integers: voxel n has its centre at (2n + 1) * spacing_pm, pixel p at origin2 + (2p + 1) *
 * pixel_pm. Voxels are counted in the picture's direction here. */
struct slice_side {
    int axis;       /* axis of the scene */
    bool backwards; /* the axis is opposite to the picture's side */
    int64_t voxels, pixels;
    int64_t spacing_pm, pixel_pm;
    int64_t origin2;
    int64_t first, end; /* the pixels that show voxels */
};

struct slice_plan {
    struct slice_side side[2]; /* columns, rows */
    size_t corner;             /* the cell where both sides begin */
    ptrdiff_t step[2];         /* cells from a voxel to the next in the picture's direction */
    int across;                /* axis perpendicular to the slice */
    uint32_t size;             /* shorter side that defines line width and letter size */
};

void slice_plan_init(struct slice_plan *plan, const struct scene *scene,
                     const struct slice_choice *choice, uint32_t width, uint32_t height);

/* Return the voxel under the centre of a pixel; and the pixel that contains the centre of a voxel.
 * Either may be outside. */
int64_t slice_side_voxel(const struct slice_side *side, int64_t pixel);
int64_t slice_side_pixel(const struct slice_side *side, int64_t voxel);

/* Return the last voxel whose centre is not beyond that of a pixel, and the pixel's position
 * between that and the next centre, in 256ths. */
int64_t slice_side_between(const struct slice_side *side, int64_t pixel, uint32_t *part);

/* Return the index of a voxel of the scene in the picture's direction. */
static inline int64_t slice_side_counted(const struct slice_side *side, const uint32_t place[3])
{
    return side->backwards ? side->voxels - 1 - place[side->axis] : place[side->axis];
}

/* A mark: a dot of the label's colour for a seed, an x for an eliminator, outlined in white while
 * it waits for a run, otherwise in black. */
struct slice_mark {
    uint32_t cell;
    uint8_t label;
    bool eliminates, waits;
};

#define SLICE_OVERLAYS "none|tint|contour"
enum slice_overlay {
    SLICE_PLAIN,   /* grey alone */
    SLICE_TINT,    /* a third of the label's colour, two thirds of the grey */
    SLICE_CONTOUR, /* the label's colour where another label is left, right, above or below, within
                      the width of a thin line: one pixel, two if the picture's shorter side has
                      400. A hairline, a quarter of the grey, follows it where no label is, and,
                      from two pixels on, inside the label too: so it shows on white and on grey */
};

/* The style of all slices. */
struct slice_style {
    uint8_t grey[UINT16_MAX + 1]; /* grey of each intensity */
    enum slice_overlay overlay;
    const struct palette *palette; /* a black label is marked in light grey */
    const bool *visible;           /* [256], the label is overlaid */
    const uint8_t *finished;       /* labels (engine/labels.h); NULL: the forest's */
    bool crosses;                  /* draw the cross-hair */
    bool marks_seeds;              /* mark planted seeds, except those with four equal neighbours */
    bool thin; /* for a screen: mark runs of seeds by a line around them, single ones by a dot; a
                  cross-hair in notes_lime */
    struct mark_choice filled;     /* fill runs of these seeds, if any, with a tint */
    struct mark_choice marked;     /* the seeds to mark */
    const struct slice_mark *mark; /* [marks], further marks; those of other slices are ignored */
    size_t marks;
    const char *least, *most; /* values at the ends of the bar of greys; ASCII */
};

/* Grey rises from black at intensity `low` to white at `high`, and is constant beyond; it falls if
 * low is above high. They differ. */
void slice_window(uint8_t grey[UINT16_MAX + 1], int32_t low, int32_t high);

/* Fill the whole canvas, and canvas->cell if it is not NULL. ERR_MEMORY, with the canvas half
 * drawn. */
enum err slice_draw(const struct canvas *canvas, const struct scene *scene,
                    const struct slice_choice *choice, const struct slice_style *style,
                    struct fault *fault);

#endif
