/* SPDX-License-Identifier: MIT */
#include "render/view.h"

#include <stdlib.h>
#include <string.h>

#include "base/least.h"

enum {
    CORDIC_STEPS = 32,
    RELATIVE_BITS = 20,     /* fraction bits of a voxel's side in pixels */
    CROSSING_BITS = 24,     /* fraction bits of t */
    COSINE_LEAST = 1 << 18, /* 2^-12: the tiny direction cosine */
};
#define ONE30       (INT64_C(1) << 30)
#define SIDE_LIMIT  (INT64_C(1) << 28) /* side of a voxel: 256 pixels */
#define RANGE_LIMIT (INT64_C(1) << 61) /* limit of a crossing times 4 */
#define MARGIN      (ONE30 >> 6)       /* covers all rounding of T, A, B, C, and of cosines */

/* ---- sines ---- */

/* atan(2^-i) in thousandths of a degree times 2^20. */
static const int64_t cordic_angle[CORDIC_STEPS] = {
    47185920000, 27855475103, 14718068031, 7471121143, 3750058394, 1876857306, 938657668, 469357477,
    234682319,   117341607,   58670860,    29335437,   14667719,   7333860,    3666930,   1833465,
    916732,      458366,      229183,      114592,     57296,      28648,      14324,     7162,
    3581,        1790,        895,         448,        224,        112,        56,        28};

/* The product of cos(atan(2^-i)), times 2^30. */
static const int64_t cordic_gain = 652032874;

/* Compute the sine of an angle in the first quarter turn by rotating (gain, 0) step by step (Volder
 * 1959). 16 guard bits keep the error of the shifts below 30 bits. */
static int32_t sine_first_quarter(int32_t angle)
{
    int64_t x = cordic_gain << 16, y = 0, left = (int64_t)angle << 20;
    for (int i = 0; i < CORDIC_STEPS; i++) {
        int64_t dx = x >> i, dy = y >> i;
        if (left >= 0) {
            x -= dy;
            y += dx;
            left -= cordic_angle[i];
        } else {
            x += dy;
            y -= dx;
            left += cordic_angle[i];
        }
    }
    int64_t sine = (y + (1 << 15)) >> 16;
    return (int32_t)(sine > ONE30 ? ONE30 : sine);
}

int32_t view_sine(int32_t angle)
{
    angle %= VIEW_TURN;
    if (angle < 0)
        angle += VIEW_TURN;
    if (angle >= VIEW_TURN / 2)
        return -view_sine(angle - VIEW_TURN / 2);
    if (angle > VIEW_TURN / 4)
        angle = VIEW_TURN / 2 - angle;
    if (angle == 0)
        return 0;
    return angle == VIEW_TURN / 4 ? (int32_t)ONE30 : sine_first_quarter(angle);
}

static int32_t cosine(int32_t angle)
{
    return view_sine(angle + VIEW_TURN / 4);
}

/* ---- names ---- */

/* The head is up, except from above and below, where the front is up, as in radiological slices. */
static const struct {
    const char *name;
    int32_t angle[3];
} named_view[] = {
    {"front", {0, 0, 0}},      {"left", {90000, 0, 0}},     {"back", {180000, 0, 0}},
    {"right", {270000, 0, 0}}, {"top", {180000, 90000, 0}}, {"bottom", {0, 270000, 0}},
};
enum { NAMED_VIEWS = sizeof named_view / sizeof named_view[0] };

bool view_by_name(const char *name, int32_t angle[3])
{
    for (int i = 0; i < NAMED_VIEWS; i++)
        if (strcmp(name, named_view[i].name) == 0) {
            memcpy(angle, named_view[i].angle, sizeof named_view[i].angle);
            return true;
        }
    return false;
}

const char *view_name(const int32_t angle[3])
{
    for (int i = 0; i < NAMED_VIEWS; i++)
        if (memcmp(angle, named_view[i].angle, sizeof named_view[i].angle) == 0)
            return named_view[i].name;
    return NULL;
}

/* ---- scale ---- */

uint32_t view_unit(const struct scene *scene)
{
    uint32_t least = scene->spacing_nm[0];
    for (int a = 1; a < 3; a++)
        least = scene->spacing_nm[a] < least ? scene->spacing_nm[a] : least;
    return least;
}

/* Return the side of a voxel along axis a in pixels, times 2^20. */
static int64_t side_in_pixels(const struct scene *scene, int a, uint32_t zoom)
{
    const uint64_t most = (uint64_t)SIDE_LIMIT * VIEW_ZOOM_ONE / VIEW_ZOOM_LEAST;
    uint64_t ratio = ((uint64_t)scene->spacing_nm[a] << RELATIVE_BITS) / view_unit(scene);
    return (int64_t)((ratio < most ? ratio : most) * zoom / VIEW_ZOOM_ONE);
}

/* Limit the zoom so that a very anisotropic voxel is not larger than a picture can hold. */
static uint32_t zoom_within(const struct scene *scene, uint32_t samples, uint64_t zoom)
{
    uint64_t most = zoom < VIEW_ZOOM_MOST ? zoom : VIEW_ZOOM_MOST;
    for (int a = 0; a < 3; a++) {
        uint64_t fits = (uint64_t)(SIDE_LIMIT - 1) * VIEW_ZOOM_ONE /
                        (samples * (uint64_t)side_in_pixels(scene, a, VIEW_ZOOM_ONE));
        most = fits < most ? fits : most;
    }
    return (uint32_t)(most < VIEW_ZOOM_LEAST ? VIEW_ZOOM_LEAST : most);
}

void view_sides(uint64_t side[3], const struct scene *scene)
{
    for (int a = 0; a < 3; a++)
        side[a] = (uint64_t)(side_in_pixels(scene, a, VIEW_ZOOM_ONE) >> 10);
}

uint64_t view_squares(const uint64_t side[3], const uint32_t size[3])
{
    uint64_t squares = 0;
    for (int a = 0; a < 3; a++) {
        const uint64_t length = size[a] * side[a] >> 10;
        squares += length > UINT32_MAX / 2 ? (uint64_t)(UINT32_MAX / 2) * (UINT32_MAX / 2)
                                           : length * length;
    }
    return squares;
}

uint32_t view_zoom_across(const struct scene *scene, uint32_t width, uint32_t height,
                          uint32_t samples, uint64_t squares)
{
    uint64_t diagonal = square_root(squares) + UINT64_C(1);
    uint64_t zoom = UINT64_C(1000) * (width < height ? width : height) / diagonal;
    return zoom_within(scene, samples, zoom);
}

uint32_t view_fitting_zoom(const struct scene *scene, uint32_t width, uint32_t height,
                           uint32_t samples)
{
    uint64_t side[3];
    view_sides(side, scene);
    return view_zoom_across(scene, width, height, samples, view_squares(side, scene->grid.size));
}

struct view view_default(const struct scene *scene)
{
    uint32_t zoom = view_fitting_zoom(scene, 512, 512, 1);
    return (struct view){
        {0, 0, 0}, zoom > VIEW_ZOOM_ONE ? VIEW_ZOOM_ONE : zoom, 512, 512, {0, 0, 0}};
}

/* ---- focus ---- */

enum { FOCUS_ONE = 1 << VIEW_FOCUS_BITS };

void view_focus_on(struct view *view, const struct scene *scene, const uint32_t place[3])
{
    for (int a = 0; a < 3; a++)
        view->focus[a] =
            (2 * (int64_t)place[a] - (int64_t)(scene->grid.size[a] - 1)) * (FOCUS_ONE / 2);
}

void view_pan(struct view *view, const struct camera *camera, int64_t right, int64_t down)
{
    for (int a = 0; a < 3; a++) {
        /* In 2^-16 / 1000 px: at most 2^23 each, times cosines of 16 bits: 2^41. */
        int64_t along = right * (camera->right[a] >> 14) - down * (camera->up[a] >> 14);
        int64_t side = side_in_pixels(camera->scene, a, view->zoom);
        view->focus[a] -= along * (INT64_C(1) << RELATIVE_BITS) / (1000 * side);
    }
}

/* Multiply a focus along one axis by a length per voxel, without overflow. */
static int64_t focus_times(int64_t focus, int64_t length)
{
    return (focus >> VIEW_FOCUS_BITS) * length +
           ((focus & (FOCUS_ONE - 1)) * length >> VIEW_FOCUS_BITS);
}

/* No place of the scene is further from its middle than half the sum of its sides. */
static bool focus_is_near(const struct view *view, const struct scene *scene)
{
    uint64_t pixels = 0;
    for (int a = 0; a < 3; a++)
        pixels += (uint64_t)scene->grid.size[a] * (uint64_t)side_in_pixels(scene, a, view->zoom);
    for (int a = 0; a < 3; a++) {
        const uint64_t voxels = pixels / (uint64_t)side_in_pixels(scene, a, view->zoom) + 1;
        if ((uint64_t)llabs(view->focus[a]) >> VIEW_FOCUS_BITS > voxels)
            return false;
    }
    return true;
}

/* ---- camera ---- */

void view_look(const struct view *view, int32_t right[3], int32_t up[3], int32_t ahead[3])
{
    int64_t sy = view_sine(view->angle[0]), cy = cosine(view->angle[0]);
    int64_t sp = view_sine(view->angle[1]), cp = cosine(view->angle[1]);
    int64_t sr = view_sine(view->angle[2]), cr = cosine(view->angle[2]);
    int64_t r[3] = {-cy, -sy, 0};
    int64_t u[3] = {times30(sy, sp), -times30(cy, sp), cp};
    int64_t d[3] = {times30(sy, cp), -times30(cy, cp), -sp};
    for (int i = 0; i < 3; i++) {
        right[i] = (int32_t)(times30(r[i], cr) - times30(u[i], sr));
        up[i] = (int32_t)(times30(r[i], sr) + times30(u[i], cr));
        ahead[i] = (int32_t)d[i];
    }
}

void view_axes(const struct view *view, const struct scene *scene, int32_t right[3], int32_t up[3],
               int32_t ahead[3])
{
    int32_t world[3][3];
    view_look(view, world[0], world[1], world[2]);
    for (int a = 0; a < 3; a++) {
        const int axis = scene->world_axis[a], sign = scene->world_sign[a];
        right[a] = sign * world[0][axis];
        up[a] = sign * world[1][axis];
        ahead[a] = sign * world[2][axis];
    }
}

static void cross(int64_t out[3], const int64_t a[3], const int64_t b[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = times30(a[j], b[k]) - times30(a[k], b[j]);
    }
}

/* The picture's vectors along flipped axes; zeros of the direction are replaced by tiny values. */
struct basis {
    int64_t right[3], down[3], ahead[3];
    int64_t side[3];  /* side of a voxel, in pixels times 2^20 */
    int64_t focus[3]; /* as view.focus */
};

static enum err set_crossings(struct camera *camera, const struct basis *b, struct fault *fault)
{
    const struct view *view = &camera->view;
    /* The distance of the focus beyond the scene's middle, in units of crossings. */
    int64_t behind = 0;
    for (int a = 0; a < 3; a++) {
        int64_t t = focus_times(b->focus[a], b->side[a]) * (1 << (CROSSING_BITS - RELATIVE_BITS));
        behind += (t >> 30) * b->ahead[a] + times30(t & (ONE30 - 1), b->ahead[a]);
    }
    for (int a = 0; a < 3; a++) {
        int64_t d = b->ahead[a];
        int64_t T = (b->side[a] << (CROSSING_BITS - RELATIVE_BITS + 30)) / d;
        int64_t A = -(b->right[a] * (INT64_C(1) << CROSSING_BITS)) / d;
        int64_t B = -(b->down[a] * (INT64_C(1) << CROSSING_BITS)) / d;
        int64_t n = camera->scene->grid.size[a];
        int64_t x = (int64_t)view->width - 1, y = (int64_t)view->height - 1;
        if (T < 1 || T > RANGE_LIMIT / 16 / (n + 1) ||
            llabs(b->focus[a]) >> VIEW_FOCUS_BITS > RANGE_LIMIT / 8 / T)
            return fault_set(fault, ERR_LIMIT,
                             "zoom %u.%03u is out of reach for a scene of this size and spacing; "
                             "the view is unchanged",
                             view->zoom / 1000, view->zoom % 1000);
        camera->T[a] = 4 * T;
        camera->A[a] = 4 * A;
        camera->B[a] = 4 * B;
        camera->C[a] =
            4 * ((-(n * T + x * A + y * B) >> 1) + behind - focus_times(b->focus[a], T)) + a;
    }
    return OK;
}

enum err camera_init(struct camera *camera, const struct scene *scene, const struct view *view,
                     struct fault *fault)
{
    struct basis b;
    *camera = (struct camera){.scene = scene, .view = *view, .unit_nm = view_unit(scene)};
    view_axes(view, scene, camera->right, camera->up, camera->ahead);
    for (int a = 0; a < 3; a++) {
        camera->flip[a] = camera->ahead[a] < 0;
        int flip = camera->flip[a] ? -1 : 1;
        b.right[a] = flip * camera->right[a];
        b.down[a] = -flip * camera->up[a];
        b.ahead[a] = flip * camera->ahead[a];
        if (b.ahead[a] < COSINE_LEAST)
            b.ahead[a] = COSINE_LEAST;
        b.side[a] = side_in_pixels(scene, a, view->zoom);
        b.focus[a] = flip * view->focus[a];
        if (b.side[a] >= SIDE_LIMIT || b.side[a] < 1)
            return fault_set(fault, ERR_LIMIT,
                             "a voxel would be %s in the picture; the view is unchanged",
                             b.side[a] < 1 ? "too small" : "larger than 256 pixels");
    }
    if (!focus_is_near(view, scene))
        return fault_set(fault, ERR_LIMIT,
                         "the picture would show a place too far from the scene; the view is "
                         "unchanged");
    /* The position of a cube's centre uses the dual of (right, down, ahead), so that it agrees with
     * the rays even if `ahead` was made slightly oblique. */
    int64_t dual[3][3];
    cross(dual[0], b.down, b.ahead);
    cross(dual[1], b.ahead, b.right);
    cross(dual[2], b.right, b.down);
    int64_t volume = 0;
    for (int a = 0; a < 3; a++)
        volume += times30(dual[0][a], b.right[a]);
    const uint32_t extent[3] = {camera->view.width, camera->view.height, 1};
    for (int k = 0; k < 3; k++) {
        camera->centre[k] = ((int64_t)extent[k] - 1) * (ONE30 / 2);
        for (int a = 0; a < 3; a++) {
            int64_t along = volume < 0 ? -dual[k][a] : dual[k][a];
            int64_t column = (along * b.side[a]) >> RELATIVE_BITS;
            camera->column[k][a] = column;
            camera->centre[k] -= (int64_t)(camera->scene->grid.size[a] - 1) * column / 2;
            if (k < 2)
                camera->centre[k] -= focus_times(b.focus[a], column);
        }
    }
    for (int k = 0; k < 2; k++) {
        camera->reach[k] = MARGIN;
        for (int a = 0; a < 3; a++)
            camera->reach[k] += (llabs(camera->column[k][a]) + 1) / 2;
    }
    return set_crossings(camera, &b, fault);
}

struct camera camera_rows(const struct camera *camera, uint32_t top, uint32_t height)
{
    struct camera rows = *camera;
    for (int a = 0; a < 3; a++)
        rows.C[a] += top * camera->B[a];
    rows.centre[1] -= top * ONE30;
    rows.view.height = height;
    return rows;
}

uint32_t view_possible_zoom(const struct scene *scene, const struct view *view,
                            const uint32_t place[3], uint32_t samples, uint64_t wanted)
{
    struct view fine = *view;
    struct camera camera;
    uint32_t zoom = zoom_within(scene, samples, wanted);
    view_focus_on(&fine, scene, place);
    fine.width *= samples;
    fine.height *= samples;
    for (; zoom > VIEW_ZOOM_LEAST; zoom -= zoom / 8 + 1) {
        fine.zoom = zoom * samples;
        if (camera_init(&camera, scene, &fine, NULL) == OK)
            break;
    }
    return zoom < VIEW_ZOOM_LEAST ? VIEW_ZOOM_LEAST : zoom;
}
