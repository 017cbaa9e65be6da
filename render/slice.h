/* SPDX-License-Identifier: MIT */
/*
 * A slice: one plane of the scene in grey, with what is known about it drawn over.
 *
 * Pixels are square in millimetres. What label, seed or voxel a pixel shows is that of the voxel
 * that its centre falls in; grey is the same voxel's, or, where `smooth`, interpolated between the
 * centres of the four around. Beyond the scene there is black, and no label.
 *
 * Over it lie marks of seeds and eliminators, the cross-hair, letters, bars, a title. Their sizes
 * follow the picture: what is 1 pixel wide in one of 256 is 2 in one of 512. A picture that is too
 * small for a note goes without it.
 *
 * A slice is a pure function of what is passed, in integers.
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
 * Where the pixels of a slice lie among the voxels: which slice it is, how large, what is where.
 *
 * Pictures lie as radiologists look at them, whatever the order and direction of the scene's axes:
 * axial from the feet (anterior up, the patient's left on the right), coronal from the front
 * (superior up, his left on the right), sagittal from his left (superior up, anterior on the left).
 * Slices are counted from 0 along the patient's axis: towards superior in axial slices, towards
 * anterior in coronal ones, towards his right in sagittal ones. Oblique axes count as the world's
 * axis that they run along, as in views.
 */

enum slice_plane { SLICE_AXIAL, SLICE_CORONAL, SLICE_SAGITTAL };

enum { SLICE_TIMES_ONE = 1000, SLICE_TIMES_MOST = 4096 * SLICE_TIMES_ONE };

enum slice_note {
    SLICE_LETTERS = 1, /* R L A P S I at the edges: where the patient's sides are, if known */
    SLICE_SCALE = 2,   /* a bar of a round length */
    SLICE_COLOURS = 4, /* a bar of the greys, with the values at its ends */
};

/* Which slice, and how large: a pixel is `pixel_pm` picometres wide, and 0 stands for the least at
 * which the slice fits. One that does not fit is seen around `middle`, as far as it goes and as
 * `place` stays an eighth of the picture off its edge, or around `place`. */
struct slice_choice {
    enum slice_plane plane;
    uint32_t place[3]; /* a voxel of the slice, where the lines of the cross-hair meet */
    uint64_t pixel_pm;
    bool smooth;
    unsigned notes;    /* enum slice_note */
    const char *title; /* or NULL */
    bool has_middle;
    uint32_t middle[3];
    uint32_t
        size; /* lines and letters are as in a picture of this shorter side; 0: as in its own */
};

/* The scene's axis along which slices of a plane are counted; how many of them the scene has; which
 * one goes through a voxel; the voxel at the same place of slice `index`. */
int slice_axis(const struct scene *scene, enum slice_plane plane);
uint32_t slice_count(const struct scene *scene, enum slice_plane plane);
uint32_t slice_index(const struct scene *scene, enum slice_plane plane, const uint32_t place[3]);
void slice_move(const struct scene *scene, enum slice_plane plane, uint32_t index,
                uint32_t place[3]);

/* What slices of a plane are called, before their number: "axial"; where nobody knows the patient's
 * sides, the scene's axis along which they are counted, "z". */
const char *slice_name(const struct scene *scene, enum slice_plane plane);

/* The pixel_pm at which a slice just fits a picture, and at which the scene's smallest spacing is
 * `zoom` thousandths of a pixel. */
uint64_t slice_fitting_pixel(const struct scene *scene, enum slice_plane plane, uint32_t width,
                             uint32_t height);
uint64_t slice_zoomed_pixel(const struct scene *scene, uint32_t zoom);

/* Has a slice be `times` thousandths as large as at `fitting_pm`, at least that large. Once a voxel
 * has four pixels along the smallest spacing, it is shown as it is, without smoothing. */
void slice_magnify(struct slice_choice *choice, const struct scene *scene, uint64_t fitting_pm,
                   uint32_t times);

/* How many pixels a thin line is wide in a picture of that shorter side. */
uint32_t slice_unit(uint32_t size);

/* The patient's sides at the left, right, top and bottom of a picture: R L A P S I. For scenes
 * whose sides are known. */
void slice_letters(const struct scene *scene, enum slice_plane plane, char letter[4]);

/* The longest of 1, 2, 5, 10, 20, 50... that is at most `most`, which is 1 or more; and "20 mm",
 * "0.05 mm" for as many picometres. */
uint64_t slice_round_length(uint64_t most);
void slice_length_words(char out[32], uint64_t pm);

/* Where the middle and the place come to lie when what a picture of that size shows goes on by so
 * many eighths of it, to the right and down: a voxel at the least. The place goes along as far as
 * it has to. False, with all as it is, where the scene ends. */
bool slice_pan(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
               uint32_t height, const int by[2], uint32_t middle[3], uint32_t place[3]);

/* The cell of the voxel that a pixel shows in a picture of that size, or CELL_NONE. */
uint32_t slice_cell_at(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
                       uint32_t height, uint32_t column, uint32_t row);

/* The reverse: the pixel, by column and row, in which the centre of a voxel lies, where cross-hair
 * and marks are too. False for a voxel of another slice, or beside the picture. */
bool slice_pixel_of(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
                    uint32_t height, const uint32_t place[3], uint32_t pixel[2]);

/* ---- the arithmetic ---- */

/* Each side of the picture, columns and rows, runs along one axis of the scene. Lengths are counted
 * in picometres from the edge of the scene where the picture's side begins, and doubled, so that
 * centres of pixels and voxels are whole: voxel n has its centre at (2n + 1) * spacing_pm, pixel p
 * at origin2 + (2p + 1) * pixel_pm. Voxels are counted in the picture's direction here. */
struct slice_side {
    int axis;       /* of the scene */
    bool backwards; /* the axis runs against the picture */
    int64_t voxels, pixels;
    int64_t spacing_pm, pixel_pm;
    int64_t origin2;
    int64_t first, end; /* the pixels that show voxels */
};

struct slice_plan {
    struct slice_side side[2]; /* columns, rows */
    size_t corner;             /* the cell of the voxel that both sides begin with */
    ptrdiff_t step[2];         /* cells from a voxel to the next in the picture's direction */
    int across;                /* the axis that the slice cuts */
    uint32_t size;             /* of the picture that lines and letters follow */
};

void slice_plan_init(struct slice_plan *plan, const struct scene *scene,
                     const struct slice_choice *choice, uint32_t width, uint32_t height);

/* The voxel under the centre of a pixel, and the pixel that holds the centre of a voxel; either may
 * lie outside. */
int64_t slice_side_voxel(const struct slice_side *side, int64_t pixel);
int64_t slice_side_pixel(const struct slice_side *side, int64_t voxel);

/* The last voxel whose centre does not lie beyond that of a pixel, and how far on the pixel's lies
 * towards the next one's, in 256ths. */
int64_t slice_side_between(const struct slice_side *side, int64_t pixel, uint32_t *part);

/* A voxel of the scene as counted in the picture. */
static inline int64_t slice_side_counted(const struct slice_side *side, const uint32_t place[3])
{
    return side->backwards ? side->voxels - 1 - place[side->axis] : place[side->axis];
}

/* Something to mark: a seed by a dot of its label's colour, an eliminator by an x, outlined in
 * white where it waits for a run, else in black. */
struct slice_mark {
    uint32_t cell;
    uint8_t label;
    bool eliminates, waits;
};

#define SLICE_OVERLAYS "none|tint|contour"
enum slice_overlay {
    SLICE_PLAIN,   /* grey alone */
    SLICE_TINT,    /* a third of the label's colour, two thirds of the grey */
    SLICE_CONTOUR, /* the label's colour where another label is beside, above or below, as near as a
                      thin line is wide: one pixel, two where the picture's shorter side has 400.
                      A hairline, a quarter of the grey, is beside it where no label is, and, of two
                      pixels on, within the label too: so it is seen on white and on grey */
};

/* How slices are drawn, whichever they are. */
struct slice_style {
    uint8_t grey[UINT16_MAX + 1]; /* of each intensity */
    enum slice_overlay overlay;
    const struct palette *palette; /* a label of black there is marked in light grey */
    const bool *visible;           /* [256], whether a label is overlaid */
    const uint8_t *finished;       /* labels (engine/labels.h); NULL: those of the forest */
    bool crosses;                  /* the cross-hair */
    bool marks_seeds; /* seeds that are planted, but those that have four neighbours like them, */
    bool thin;        /* runs of those by a line around them, one alone by a dot, */
    struct mark_choice filled;     /* and a run of these, if any, by a tint; */
    struct mark_choice marked;     /* of those; and beside them: */
    const struct slice_mark *mark; /* [marks]; those of other slices are passed over */
    size_t marks;
    const char *least, *most; /* what stands at the ends of the bar of greys; ASCII */
};

/* Grey rises from black at intensity `low` to white at `high`, and stays so beyond; it falls where
 * low is above high. They differ. */
void slice_window(uint8_t grey[UINT16_MAX + 1], int32_t low, int32_t high);

/* Fills the whole canvas, and canvas->cell where it has that. ERR_MEMORY, with the canvas half
 * drawn. */
enum err slice_draw(const struct canvas *canvas, const struct scene *scene,
                    const struct slice_choice *choice, const struct slice_style *style,
                    struct fault *fault);

#endif
