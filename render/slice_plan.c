/* SPDX-License-Identifier: MIT */
#include "render/slice.h"

#include <assert.h>
#include <stdio.h>

#include "base/least.h"
#include "render/view.h"

/* The patient's axes of each plane. In the picture both run downwards: columns from the patient's
 * right (or front), rows from the front (or top). */
enum { COLUMN, ROW, ACROSS };
static const int8_t world_axis_of[3][3] = {
    [SLICE_AXIAL] = {0, 1, 2}, [SLICE_CORONAL] = {0, 2, 1}, [SLICE_SAGITTAL] = {1, 2, 0}};

enum {
    EDGE_PARTS = 8,    /* divisor of the picture: width of the rim on each side that the place
                          avoids */
    UNIT_PIXELS = 400, /* lines are a pixel thicker for each of these on the shorter side */
};

/* Large enough for any scene, and small enough for 64-bit arithmetic below. */
static const uint64_t PIXEL_PM_MOST = INT64_MAX / (INT64_C(8) * VIEW_SIDE_MOST);

/* Return the axis of the scene along an axis of the patient. */
static int scene_axis(const struct scene *scene, int world)
{
    int axis = 0;
    while (axis < 2 && scene->world_axis[axis] != world)
        axis++;
    return axis;
}

/* ---- which slice ---- */

int slice_axis(const struct scene *scene, enum slice_plane plane)
{
    return scene_axis(scene, world_axis_of[plane][ACROSS]);
}

uint32_t slice_count(const struct scene *scene, enum slice_plane plane)
{
    return scene->grid.size[slice_axis(scene, plane)];
}

/* Convert the patient's index to the scene's, or back. */
static uint32_t turned(const struct scene *scene, int axis, uint32_t index)
{
    return scene->world_sign[axis] < 0 ? scene->grid.size[axis] - 1 - index : index;
}

uint32_t slice_index(const struct scene *scene, enum slice_plane plane, const uint32_t place[3])
{
    const int axis = slice_axis(scene, plane);
    return turned(scene, axis, place[axis]);
}

void slice_move(const struct scene *scene, enum slice_plane plane, uint32_t index,
                uint32_t place[3])
{
    const int axis = slice_axis(scene, plane);
    place[axis] = turned(scene, axis, index);
}

const char *slice_name(const struct scene *scene, enum slice_plane plane)
{
    static const char *const name[3] = {
        [SLICE_AXIAL] = "axial", [SLICE_CORONAL] = "coronal", [SLICE_SAGITTAL] = "sagittal"};
    static const char *const axis[3] = {"x", "y", "z"};
    return scene->sides_unknown ? axis[slice_axis(scene, plane)] : name[plane];
}

/* ---- how large ---- */

static uint64_t within_reach(uint64_t pixel_pm)
{
    return pixel_pm < 1 ? 1 : pixel_pm > PIXEL_PM_MOST ? PIXEL_PM_MOST : pixel_pm;
}

uint64_t slice_fitting_pixel(const struct scene *scene, enum slice_plane plane, uint32_t width,
                             uint32_t height)
{
    const uint64_t pixels[2] = {width, height};
    uint64_t most = 0;
    for (int i = 0; i < 2; i++) {
        const int axis = scene_axis(scene, world_axis_of[plane][i]);
        const uint64_t length = (uint64_t)scene->grid.size[axis] * scene->spacing_nm[axis] * 1000;
        const uint64_t side = (length + pixels[i] - 1) / pixels[i];
        most = side > most ? side : most;
    }
    return within_reach(most);
}

uint64_t slice_zoomed_pixel(const struct scene *scene, uint32_t zoom)
{
    return within_reach((UINT64_C(1000000) * view_unit(scene) + zoom / 2) / zoom);
}

void slice_magnify(struct slice_choice *choice, const struct scene *scene, uint64_t fitting_pm,
                   uint32_t times)
{
    choice->pixel_pm = within_reach(fitting_pm * SLICE_TIMES_ONE / times);
    choice->smooth =
        times == SLICE_TIMES_ONE || choice->pixel_pm * 4 > UINT64_C(1000) * view_unit(scene);
}

/* ---- pixels and voxels ---- */

static int64_t divided_down(int64_t a, int64_t b)
{
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

static int64_t centre2(const struct slice_side *side, int64_t pixel)
{
    return side->origin2 + (2 * pixel + 1) * side->pixel_pm;
}

int64_t slice_side_voxel(const struct slice_side *side, int64_t pixel)
{
    return divided_down(centre2(side, pixel), 2 * side->spacing_pm);
}

int64_t slice_side_pixel(const struct slice_side *side, int64_t voxel)
{
    return divided_down((2 * voxel + 1) * side->spacing_pm - side->origin2, 2 * side->pixel_pm);
}

int64_t slice_side_between(const struct slice_side *side, int64_t pixel, uint32_t *part)
{
    const int64_t from_first = centre2(side, pixel) - side->spacing_pm;
    const int64_t voxel = divided_down(from_first, 2 * side->spacing_pm);
    const int64_t rest = from_first - voxel * 2 * side->spacing_pm;
    *part = (uint32_t)((rest * 256 + side->spacing_pm) / (2 * side->spacing_pm));
    return voxel;
}

static int64_t within(int64_t value, int64_t least, int64_t most)
{
    return value < least ? least : value > most ? most : value;
}

/* Return the origin of the picture: the slice is centred if it fits; otherwise `middle` is in the
 * centre, as far as the place stays off the edge and nothing is empty. A slice thinner than a pixel
 * is centred on a pixel, so that one shows it. */
static int64_t origin2(const struct slice_side *side, int64_t place, int64_t middle)
{
    const int64_t length2 = 2 * side->voxels * side->spacing_pm;
    const int64_t picture2 = 2 * side->pixels * side->pixel_pm;
    if (length2 < 2 * side->pixel_pm)
        return length2 / 2 - (2 * (side->pixels / 2) + 1) * side->pixel_pm;
    if (length2 <= picture2)
        return (length2 - picture2) / 2;
    const int64_t place2 = (2 * place + 1) * side->spacing_pm, rim2 = picture2 / EDGE_PARTS;
    const int64_t wanted = (2 * middle + 1) * side->spacing_pm - picture2 / 2;
    const int64_t seen = within(wanted, place2 + rim2 - picture2, place2 - rim2);
    return within(seen, 0, length2 - picture2);
}

uint32_t slice_unit(uint32_t size)
{
    return 1 + size / UNIT_PIXELS;
}

void slice_plan_init(struct slice_plan *plan, const struct scene *scene,
                     const struct slice_choice *choice, uint32_t width, uint32_t height)
{
    const int8_t *world = world_axis_of[choice->plane];
    const struct grid *grid = &scene->grid;
    uint32_t corner[3];
    *plan = (struct slice_plan){.across = scene_axis(scene, world[ACROSS]),
                                .size = choice->size ? choice->size : least(width, height)};
    for (int a = 0; a < 3; a++) {
        assert(choice->place[a] < grid->size[a]);
        assert(!choice->has_middle || choice->middle[a] < grid->size[a]);
        corner[a] = choice->place[a];
    }
    for (int i = 0; i < 2; i++) {
        struct slice_side *side = &plan->side[i];
        side->axis = scene_axis(scene, world[i]);
        side->backwards = scene->world_sign[side->axis] > 0;
        side->voxels = grid->size[side->axis];
        side->pixels = i == COLUMN ? width : height;
        side->spacing_pm = (int64_t)scene->spacing_nm[side->axis] * 1000;
        side->pixel_pm =
            (int64_t)(choice->pixel_pm ? choice->pixel_pm
                                       : slice_fitting_pixel(scene, choice->plane, width, height));
        side->origin2 =
            origin2(side, slice_side_counted(side, choice->place),
                    slice_side_counted(side, choice->has_middle ? choice->middle : choice->place));
        side->end = side->pixels;
        while (side->first < side->end && slice_side_voxel(side, side->first) < 0)
            side->first++;
        while (side->first < side->end && slice_side_voxel(side, side->end - 1) >= side->voxels)
            side->end--;
        corner[side->axis] = side->backwards ? (uint32_t)side->voxels - 1 : 0;
        plan->step[i] = side->backwards ? -grid->step[side->axis] : grid->step[side->axis];
    }
    plan->corner = grid_cell(grid, corner[0], corner[1], corner[2]);
}

/* ---- letters and lengths ---- */

void slice_letters(const struct scene *scene, enum slice_plane plane, char letter[4])
{
    const struct slice_choice choice = {.plane = plane};
    struct slice_plan plan;
    slice_plan_init(&plan, scene, &choice, 1, 1);
    for (int i = 0; i < 4; i++) {
        /* Derive the letter from the orientation of the scene's axis, not from the usual layout. */
        const struct slice_side *side = &plan.side[i / 2];
        const bool towards_high_indices = side->backwards == (i % 2 == 0);
        const bool axis_is_worlds = scene->world_sign[side->axis] > 0;
        const bool is_high = towards_high_indices == axis_is_worlds;
        letter[i] = (is_high ? "RAS" : "LPI")[scene->world_axis[side->axis]];
    }
}

uint64_t slice_round_length(uint64_t most)
{
    static const uint64_t first[3] = {5, 2, 1};
    uint64_t power = 1;
    while (power <= most / 10)
        power *= 10;
    for (int i = 0; i < 2; i++)
        if (first[i] <= most / power)
            return first[i] * power;
    return power;
}

void slice_length_words(char out[32], uint64_t pm)
{
    int n = snprintf(out, 32, "%llu.%09llu", (unsigned long long)(pm / 1000000000),
                     (unsigned long long)(pm % 1000000000));
    while (out[n - 1] == '0')
        n--;
    n -= out[n - 1] == '.';
    snprintf(out + n, 32 - (size_t)n, " mm");
}

/* ---- panning ---- */

static uint32_t index_of(const struct slice_side *side, int64_t counted)
{
    return (uint32_t)(side->backwards ? side->voxels - 1 - counted : counted);
}

static int64_t voxel_at2(const struct slice_side *side, int64_t point2)
{
    return within(divided_down(point2, 2 * side->spacing_pm), 0, side->voxels - 1);
}

/* Return the voxel in the centre after panning by eighths. */
static int64_t middle_after(const struct slice_side *side, int by)
{
    const int64_t half2 = side->pixels * side->pixel_pm;
    const int64_t most2 = 2 * (side->voxels * side->spacing_pm - half2);
    const int64_t to2 = within(side->origin2 + by * half2 / 4, 0, most2 < 0 ? 0 : most2);
    const int64_t now = voxel_at2(side, side->origin2 + half2);
    const int64_t next = voxel_at2(side, to2 + half2);
    if (most2 <= 0 || to2 == side->origin2)
        return now;
    return next != now ? next : within(now + (by > 0) - (by < 0), 0, side->voxels - 1);
}

/* Return the voxel nearest to `place` that does not shift the picture. */
static int64_t place_after(const struct slice_side *side, int64_t place, int64_t middle)
{
    const int64_t picture2 = 2 * side->pixels * side->pixel_pm, rim2 = picture2 / EDGE_PARTS;
    const int64_t most2 = 2 * side->voxels * side->spacing_pm - picture2;
    const int64_t begin2 = origin2(side, middle, middle);
    const int64_t first = voxel_at2(side, begin2 + rim2 + side->spacing_pm - 1);
    const int64_t last = voxel_at2(side, begin2 + picture2 - rim2 - side->spacing_pm);
    if (most2 <= 0)
        return place;
    if (first > last)
        return middle;
    return begin2 > 0 && place < first ? first : begin2 < most2 && place > last ? last : place;
}

bool slice_pan(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
               uint32_t height, const int by[2], uint32_t middle[3], uint32_t place[3])
{
    struct slice_plan plan;
    bool goes = false;
    slice_plan_init(&plan, scene, choice, width, height);
    for (int a = 0; a < 3; a++) {
        middle[a] = choice->has_middle ? choice->middle[a] : choice->place[a];
        place[a] = choice->place[a];
    }
    for (int i = 0; i < 2; i++) {
        const struct slice_side *side = &plan.side[i];
        const int64_t now = middle_after(side, 0), next = middle_after(side, by[i]);
        if (next == now)
            continue;
        goes = true;
        middle[side->axis] = index_of(side, next);
        place[side->axis] =
            index_of(side, place_after(side, slice_side_counted(side, choice->place), next));
    }
    return goes;
}

uint32_t slice_cell_at(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
                       uint32_t height, uint32_t column, uint32_t row)
{
    struct slice_plan plan;
    const int64_t pixel[2] = {column, row};
    int64_t cell;
    slice_plan_init(&plan, scene, choice, width, height);
    cell = (int64_t)plan.corner;
    for (int i = 0; i < 2; i++) {
        if (pixel[i] < plan.side[i].first || pixel[i] >= plan.side[i].end)
            return CELL_NONE;
        cell += slice_side_voxel(&plan.side[i], pixel[i]) * plan.step[i];
    }
    return (uint32_t)cell;
}

bool slice_pixel_of(const struct scene *scene, const struct slice_choice *choice, uint32_t width,
                    uint32_t height, const uint32_t place[3], uint32_t pixel[2])
{
    struct slice_plan plan;
    slice_plan_init(&plan, scene, choice, width, height);
    for (int i = 0; i < 2; i++) {
        const struct slice_side *side = &plan.side[i];
        const int64_t at = slice_side_pixel(side, slice_side_counted(side, place));
        if (at < 0 || at >= side->pixels)
            return false;
        pixel[i] = (uint32_t)at;
    }
    return place[plan.across] == choice->place[plan.across];
}
