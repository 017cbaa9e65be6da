#include "show/seen_from.h"

#include <math.h>

#include "engine/scene.h"
#include "image/geometry.h"
#include "render/view.h"
#include "session/session_inside.h"

#define ONE30 1073741824.0

double seen_mm_per_pixel(const struct session *session)
{
    return (double)view_unit(session->scene) / 1e6 * VIEW_ZOOM_ONE / session->now.outlook.view.zoom;
}

/* Half of the scene's diagonal, to the next millimetre, and one more. */
static double eye_of(const struct scene *scene)
{
    double squares = 0;
    for (int a = 0; a < 3; a++) {
        const double length = scene->grid.size[a] * (scene->spacing_nm[a] / 1e6);
        squares += length * length;
    }
    return floor(sqrt(squares) / 2) + 2;
}

/* One column of a matrix: where along a direction of the picture a point of the world lies, from
 * voxel `from` on. `axis` is that direction along voxel axes, times 2^30. */
static void set_column(double column[4], const struct session *session, const int32_t axis[3],
                       const double from[3])
{
    const struct geometry *geometry = &session->geometry;
    const double origin[3] = {geometry->to_mm[0][3], geometry->to_mm[1][3], geometry->to_mm[2][3]};
    double steps[3], at_origin[3];
    geometry_solve(geometry, origin, at_origin);
    for (int w = 0; w < 4; w++) {
        const double unit[3] = {w == 0, w == 1, w == 2};
        geometry_solve(geometry, unit, steps);
        column[w] = 0;
        for (int a = 0; a < 3; a++)
            column[w] += axis[a] / ONE30 * (session->scene->spacing_nm[a] / 1e6) *
                         (w < 3 ? steps[a] : -at_origin[a] - from[a]);
    }
}

void seen_from(struct picture_space *space, const struct session *session)
{
    const struct view *view = &session->now.outlook.view;
    const double pixel_mm = seen_mm_per_pixel(session);
    double middle[3], focus[3], column[3][4];
    int32_t axis[3][3];
    *space = (struct picture_space){.eye_mm = eye_of(session->scene),
                                    .has_world = geometry_has_place(&session->geometry)};
    if (!space->has_world)
        return;
    for (int a = 0; a < 3; a++) {
        middle[a] = (session->scene->grid.size[a] - 1) / 2.0;
        focus[a] = middle[a] + (double)view->focus[a] / (1 << VIEW_FOCUS_BITS);
    }
    view_axes(view, session->scene, axis[0], axis[1], axis[2]);
    for (int d = 0; d < 3; d++)
        set_column(column[d], session, axis[d], d < 2 ? focus : middle);
    column[2][3] += space->eye_mm;
    for (int w = 0; w < 4; w++) {
        const double half = w == 3 ? 0.5 : 0;
        for (int d = 0; d < 3; d++)
            space->to_camera[w][d] = (float)column[d][w];
        space->to_ndc[w][0] = (float)(half + column[0][w] / (view->width * pixel_mm));
        space->to_ndc[w][1] = (float)(half - column[1][w] / (view->height * pixel_mm));
        space->to_ndc[w][2] = (float)column[2][w];
    }
    space->to_camera[3][3] = space->to_ndc[3][3] = 1;
}

/* A normal is at right angles to steps along the surface, which go the way of the axes: it is
 * turned by the inverse of their directions, transposed. */
void seen_normals(float *out, const int16_t *normal, size_t pixels, const struct geometry *geometry)
{
    double turn[3][3]; /* [world][voxel axis] */
    for (int w = 0; w < 3; w++) {
        const double unit[3] = {w == 0, w == 1, w == 2};
        geometry_solve(geometry, unit, turn[w]);
        for (int a = 0; a < 3; a++)
            turn[w][a] *= geometry_step_mm(geometry, a);
    }
    for (size_t i = 0; i < pixels; i++, normal += 4, out += 3) {
        double n[3], squares = 0;
        for (int w = 0; w < 3; w++) {
            n[w] = turn[w][0] * normal[0] + turn[w][1] * normal[1] + turn[w][2] * normal[2];
            squares += n[w] * n[w];
        }
        for (int w = 0; w < 3; w++)
            out[w] = squares > 0 ? (float)(n[w] / sqrt(squares)) : 0;
    }
}
