#include "render/slice.h"

#include <stdlib.h>

#include "base/mem.h"

/* The patient's axes of each plane. In the picture, both of them run downwards: columns from the
 * right (or the front) of the patient on, rows from his front (or top) on. */
enum { COLUMN, ROW, ACROSS };
static const int8_t world_axis_of[3][3] = {
    [SLICE_AXIAL] = {0, 1, 2}, [SLICE_CORONAL] = {0, 2, 1}, [SLICE_SAGITTAL] = {1, 2, 0}};

static const uint8_t cross_colour[3] = {255, 220, 0};

/* Where the voxels of a slice lie: pixel (x, y) shows cell first + column[x] + row[y]. */
struct plan {
    uint32_t side[2];  /* pixels */
    ptrdiff_t *offset; /* [side[0] + side[1]]: of columns, then of rows */
    ptrdiff_t *row;
    size_t first;
    uint32_t cross[2], cross_first[2], cross_last[2]; /* the line, and the pixels it leaves free */
};

/* The axis of the scene that runs along an axis of the patient. */
static int scene_axis(const struct scene *scene, int world)
{
    int axis = 0;
    while (axis < 2 && scene->world_axis[axis] != world)
        axis++;
    return axis;
}

/* From patient's index to the scene's, and back. */
static uint32_t turned(const struct scene *scene, int axis, uint32_t index)
{
    return scene->world_sign[axis] < 0 ? scene->grid.size[axis] - 1 - index : index;
}

uint32_t slice_count(const struct scene *scene, enum slice_plane plane)
{
    return scene->grid.size[scene_axis(scene, world_axis_of[plane][ACROSS])];
}

static uint64_t pixels_along(const struct scene *scene, int axis, uint32_t zoom)
{
    uint64_t finest = scene->spacing_nm[0];
    for (int a = 1; a < 3; a++)
        if (scene->spacing_nm[a] < finest)
            finest = scene->spacing_nm[a];
    uint64_t length = (uint64_t)scene->grid.size[axis] * scene->spacing_nm[axis] * zoom;
    return (length + finest / 2) / finest;
}

/* How many voxels from the picture's edge the centre of a pixel lies. */
static uint32_t voxel_under(uint32_t pixel, uint32_t size, uint32_t side)
{
    return (uint32_t)((2 * (uint64_t)pixel + 1) * size / (2 * (uint64_t)side));
}

/* One side of the picture: the voxels under its pixels, and where the cross meets it. */
static void plan_side(struct plan *plan, const struct scene *scene, int which, int axis,
                      uint32_t cross)
{
    ptrdiff_t *offset = which == COLUMN ? plan->offset : plan->row;
    const uint32_t size = scene->grid.size[axis], side = plan->side[which];
    const uint32_t at = size - 1 - turned(scene, axis, cross);
    plan->cross[which] = (uint32_t)((2 * (uint64_t)at + 1) * side / (2 * (uint64_t)size));
    plan->cross_first[which] = side;
    for (uint32_t p = 0; p < side; p++) {
        const uint32_t voxel = voxel_under(p, size, side);
        offset[p] = (ptrdiff_t)turned(scene, axis, size - 1 - voxel) * scene->grid.step[axis];
        if (voxel != at)
            continue;
        if (p < plan->cross_first[which])
            plan->cross_first[which] = p;
        plan->cross_last[which] = p;
    }
}

static enum err plan_init(struct plan *plan, const struct scene *scene,
                          const struct slice_choice *choice, struct fault *fault)
{
    int axis[3];
    uint32_t cross[3] = {0};
    for (int i = 0; i < 3; i++)
        axis[i] = scene_axis(scene, world_axis_of[choice->plane][i]);
    for (int i = 0; i < 2; i++) {
        uint64_t side = pixels_along(scene, axis[i], choice->zoom);
        if (side > VIEW_SIDE_MOST)
            return fault_set(fault, ERR_LIMIT, "a slice of %llu pixels a side: at most %d",
                             (unsigned long long)side, VIEW_SIDE_MOST);
        plan->side[i] = (uint32_t)side;
    }
    plan->offset = mem_array((size_t)plan->side[0] + plan->side[1], sizeof *plan->offset);
    if (!plan->offset)
        return fault_memory(fault, "a slice");
    plan->row = plan->offset + plan->side[0];
    plan->first = grid_cell(&scene->grid, 0, 0, 0) + turned(scene, axis[ACROSS], choice->index) *
                                                         (size_t)scene->grid.step[axis[ACROSS]];
    if (choice->cross != CELL_NONE) {
        struct place place = grid_place(&scene->grid, choice->cross);
        cross[0] = place.x, cross[1] = place.y, cross[2] = place.z;
    }
    for (int i = 0; i < 2; i++)
        plan_side(plan, scene, i, axis[i], cross[axis[i]]);
    return OK;
}

static const struct cell *cell_under(const struct plan *plan, const struct scene *scene, uint32_t x,
                                     uint32_t y)
{
    return scene->cell + ((ptrdiff_t)plan->first + plan->offset[x] + plan->row[y]);
}

/* Whether one of the 4 pixels around has another label; the picture's edge is no contour. */
static bool on_contour(const struct plan *plan, const struct scene *scene, uint32_t x, uint32_t y)
{
    const uint8_t label = cell_under(plan, scene, x, y)->label;
    return (x > 0 && cell_under(plan, scene, x - 1, y)->label != label) ||
           (y > 0 && cell_under(plan, scene, x, y - 1)->label != label) ||
           (x + 1 < plan->side[0] && cell_under(plan, scene, x + 1, y)->label != label) ||
           (y + 1 < plan->side[1] && cell_under(plan, scene, x, y + 1)->label != label);
}

static bool on_cross(const struct plan *plan, uint32_t x, uint32_t y)
{
    return (x == plan->cross[0] && (y < plan->cross_first[1] || y > plan->cross_last[1])) ||
           (y == plan->cross[1] && (x < plan->cross_first[0] || x > plan->cross_last[0]));
}

static uint8_t grey_of(uint16_t intensity, int32_t low, int32_t high)
{
    if (intensity <= low)
        return 0;
    if (intensity >= high)
        return 255;
    const int64_t width = (int64_t)high - low;
    return (uint8_t)((((int64_t)intensity - low) * 255 + width / 2) / width);
}

static void colour_pixel(uint8_t rgb[3], const struct plan *plan, const struct scene *scene,
                         const struct slice_choice *choice, const struct palette *palette,
                         uint32_t x, uint32_t y)
{
    const struct cell *cell = cell_under(plan, scene, x, y);
    const uint8_t grey = grey_of(cell->intensity, choice->low, choice->high);
    const uint8_t *colour = palette->rgb[cell->label];
    const bool tints = choice->overlay == SLICE_TINT && cell->label;
    const bool draws =
        choice->overlay == SLICE_CONTOUR && cell->label && on_contour(plan, scene, x, y);
    const bool crosses = choice->cross != CELL_NONE && on_cross(plan, x, y);
    for (int k = 0; k < 3; k++)
        rgb[k] = crosses ? cross_colour[k]
                 : draws ? colour[k]
                 : tints ? (uint8_t)((3 * grey + colour[k] + 2) / 4)
                         : grey;
}

static enum err check_choice(const struct scene *scene, const struct slice_choice *choice,
                             struct fault *fault)
{
    const uint32_t count = slice_count(scene, choice->plane);
    if (choice->index >= count)
        return fault_set(fault, ERR_USAGE, "slice %u: expected 0..%u", choice->index, count - 1);
    if (choice->zoom < 1 || choice->zoom > SLICE_ZOOM_MOST)
        return fault_set(fault, ERR_USAGE, "zoom %u: expected 1..%d", choice->zoom,
                         SLICE_ZOOM_MOST);
    if (choice->low >= choice->high)
        return fault_set(fault, ERR_USAGE, "window %d %d: expected the lower intensity first",
                         choice->low, choice->high);
    return OK;
}

enum err slice_init(struct slice *slice, const struct scene *scene,
                    const struct slice_choice *choice, const struct palette *palette,
                    struct fault *fault)
{
    struct plan plan = {0};
    *slice = (struct slice){0};
    enum err err = check_choice(scene, choice, fault);
    if (!err)
        err = plan_init(&plan, scene, choice, fault);
    if (err)
        return err;
    slice->rgb = mem_array((size_t)plan.side[0] * plan.side[1], 3);
    if (slice->rgb) {
        slice->width = plan.side[0];
        slice->height = plan.side[1];
        uint8_t *rgb = slice->rgb;
        for (uint32_t y = 0; y < slice->height; y++)
            for (uint32_t x = 0; x < slice->width; x++, rgb += 3)
                colour_pixel(rgb, &plan, scene, choice, palette, x, y);
    } else {
        err = fault_memory(fault, "a slice");
    }
    free(plan.offset);
    return err;
}

void slice_release(struct slice *slice)
{
    free(slice->rgb);
    *slice = (struct slice){0};
}
