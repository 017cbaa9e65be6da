#include "render/normal.h"

#include "engine/gradient.h"
#include "render/fixed.h"

enum {
    CROSSING_PIXEL_BITS = 26, /* of a depth: 4 * 2^24 to a pixel */
    BEFORE = 154,             /* 0.6 voxels: where the slope is read before the surface, */
    FURTHER = 384,            /* 1.5 voxels: and further out, */
    FURTHER_WEIGHT = 4,       /* which counts so much more */
    BARELY = 64,              /* of a normal's length: what it faces the viewer by at least */
};

/* ---- from fields ---- */

/* A gradient to a normal of length 2^NORMAL_BITS; false where it has no direction. */
static bool normalise(int16_t normal[3], const int64_t gradient[3])
{
    uint64_t all = 0;
    for (int a = 0; a < 3; a++)
        all |= (uint64_t)(gradient[a] < 0 ? -gradient[a] : gradient[a]);
    if (all == 0)
        return false;
    const int bits = 64 - __builtin_clzll(all);
    int64_t v[3];
    uint64_t squares = 0;
    for (int a = 0; a < 3; a++) {
        v[a] = bits > 15 ? gradient[a] >> (bits - 15) : gradient[a] * (1 << (15 - bits));
        squares += (uint64_t)(v[a] * v[a]);
    }
    const int64_t inverse = fixed_inverse_root(squares);
    for (int a = 0; a < 3; a++)
        normal[a] = (int16_t)(v[a] * inverse >> (45 - NORMAL_BITS));
    return true;
}

static void face_viewer(int16_t normal[3], const struct normals *normals)
{
    for (int a = 0; a < 3; a++)
        normal[a] = (int16_t)normals->viewer[a];
}

/* The scene's gradient takes the surface's side, and outweighs it but where the scene is flat. */
static void add_scene(int64_t outward[3], struct normals *normals, const int32_t point[3])
{
    const struct gradient inward = field_at(&normals->scene, point);
    int64_t gradient[3], along = 0;
    for (int a = 0; a < 3; a++) {
        gradient[a] = (int64_t)inward.along[a] * normals->scale[a];
        along += gradient[a] * outward[a];
    }
    for (int a = 0; a < 3; a++)
        outward[a] = outward[a] / 16 + (along < 0 ? -gradient[a] : gradient[a]);
}

/* The gradient `way` / 2^NORMAL_BITS of `distance` away from a point, or as far that way as the
 * field goes. */
static struct gradient gradient_beside(struct normals *normals, const int32_t point[3],
                                       const int16_t way[3], int32_t distance)
{
    int32_t at[3];
    for (int a = 0; a < 3; a++) {
        const int32_t last =
            (int32_t)(normals->camera->scene->grid.size[a] << LOCATOR_POINT_BITS) - 1;
        const int32_t p = point[a] + (way[a] * distance >> NORMAL_BITS);
        at[a] = p < -(1 << LOCATOR_POINT_BITS) ? -(1 << LOCATOR_POINT_BITS) : p > last ? last : p;
    }
    return field_at(&normals->shown, at);
}

/* Within a sheet of one voxel the field has its crest, where its slope says nothing; outside it is
 * steep, and the slope the same for some voxels. So it is read before the surface, and with more
 * weight further out the way that this points, unless something else is there. */
static void slope_before(int64_t outward[3], struct normals *normals, const int32_t point[3])
{
    const struct gradient near = gradient_beside(normals, point, normals->before, BEFORE);
    int64_t way[3] = {-near.along[0], -near.along[1], -near.along[2]}, along = 0;
    int16_t out[3] = {0, 0, 0};
    normalise(out, way);
    const struct gradient far = gradient_beside(normals, point, out, FURTHER);
    for (int a = 0; a < 3; a++)
        along += near.along[a] * far.along[a];
    for (int a = 0; a < 3; a++) {
        way[a] -= along > 0 ? FURTHER_WEIGHT * far.along[a] : 0;
        outward[a] = way[a] * normals->scale[a] / FURTHER_WEIGHT;
    }
}

/* From a point on the surface. */
static void slope_at(int64_t outward[3], struct normals *normals, const int32_t point[3])
{
    const struct gradient inward = field_at(&normals->shown, point);
    for (int a = 0; a < 3; a++)
        outward[a] = -(int64_t)inward.along[a] * normals->scale[a];
}

/* What a pixel shows faces the viewer, if barely. */
static void turn_to_viewer(int16_t normal[3], const struct normals *normals)
{
    int64_t along = 0, across[3];
    for (int a = 0; a < 3; a++)
        along += normal[a] * normals->viewer[a];
    if (along >= (1 << (2 * NORMAL_BITS)) / BARELY)
        return;
    for (int a = 0; a < 3; a++)
        across[a] = normal[a] - (along * normals->viewer[a] >> (2 * NORMAL_BITS)) +
                    normals->viewer[a] / BARELY;
    if (!normalise(normal, across))
        face_viewer(normal, normals);
}

static void field_normal(int16_t normal[3], struct normals *normals, const int32_t point[3])
{
    int64_t outward[3];
    if (normals->looks_out)
        slope_before(outward, normals, point);
    else
        slope_at(outward, normals, point);
    if (normals->mode == SHADE_SCENE)
        add_scene(outward, normals, point);
    if (!normalise(normal, outward)) /* as thick as thin: it shows no side */
        face_viewer(normal, normals);
    if (normals->looks_out)
        turn_to_viewer(normal, normals);
}

/* ---- from depths ---- */

/* Sums over the pixels around one, for the plane that fits their depths best. Places count in
 * steps of `stride` pixels, depths in 1/256 pixels from the pixel's own. */
struct fit {
    int64_t n, x, y, xx, xy, yy, d, xd, yd;
};

static void add_to_fit(struct fit *fit, int64_t x, int64_t y, int64_t d)
{
    fit->n++;
    fit->x += x, fit->y += y, fit->d += d;
    fit->xx += x * x, fit->xy += x * y, fit->yy += y * y;
    fit->xd += x * d, fit->yd += y * d;
}

/* Pixels of the same surface: what lies steeper than 4 to 1 is another. */
static struct fit fit_around(const struct rendition *r, const struct normals *normals, uint32_t x,
                             uint32_t y)
{
    const int64_t own = r->depth[(size_t)y * r->width + x], stride = normals->stride;
    struct fit fit = {0};
    for (int64_t j = -NORMAL_FIT_STEPS; j <= NORMAL_FIT_STEPS; j++)
        for (int64_t i = -NORMAL_FIT_STEPS; i <= NORMAL_FIT_STEPS; i++) {
            const int64_t column = x + i * stride, row = y + j * stride;
            if (column < 0 || row < 0 || column >= r->width || row >= r->height)
                continue;
            const int64_t depth = r->depth[(size_t)row * r->width + (size_t)column];
            if (depth == DEPTH_NONE)
                continue;
            const int64_t d = (depth - own) >> (CROSSING_PIXEL_BITS - 8);
            const int64_t steep = 4 * 256 * stride * (2 + (i < 0 ? -i : i) + (j < 0 ? -j : j));
            if (d < steep && d > -steep)
                add_to_fit(&fit, i, j, d);
        }
    return fit;
}

static void depth_normal(int16_t normal[3], const struct rendition *r,
                         const struct normals *normals, uint32_t x, uint32_t y)
{
    const struct fit f = fit_around(r, normals, x, y);
    const int64_t xx = f.n * f.xx - f.x * f.x, yy = f.n * f.yy - f.y * f.y;
    const int64_t xy = f.n * f.xy - f.x * f.y;
    const int64_t xd = f.n * f.xd - f.x * f.d, yd = f.n * f.yd - f.y * f.d;
    const int64_t toward = (xx * yy - xy * xy) * normals->stride * 256;
    const int64_t gradient[3] = {xd * yy - yd * xy, -(yd * xx - xd * xy), -toward};
    int16_t n[3]; /* to the right, up, ahead */
    if (toward == 0 || !normalise(n, gradient)) {
        face_viewer(normal, normals);
        return;
    }
    const struct camera *camera = normals->camera;
    for (int a = 0; a < 3; a++)
        normal[a] = (int16_t)((n[0] * (int64_t)camera->right[a] + n[1] * (int64_t)camera->up[a] +
                               n[2] * (int64_t)camera->ahead[a]) >>
                              30);
}

/* ---- of a pixel ---- */

int64_t normal_stride(const struct camera *camera)
{
    const int64_t pixels = (camera->view.zoom + VIEW_ZOOM_ONE / 2) / VIEW_ZOOM_ONE;
    return pixels < 1 ? 1 : pixels;
}

void normals_init(struct normals *normals, const struct camera *camera, enum shade_mode mode,
                  bool looks_out, struct field *shown, struct field *scene)
{
    int64_t before[3];
    *normals = (struct normals){
        .camera = camera, .mode = mode, .looks_out = looks_out, .stride = normal_stride(camera)};
    normals->shown.field = shown;
    normals->scene.field = scene;
    for (int a = 0; a < 3; a++) {
        normals->locator[a] = locator_of(camera, a);
        normals->viewer[a] = -camera->ahead[a] >> (30 - NORMAL_BITS);
        normals->scale[a] =
            (int32_t)((camera->unit_nm << 12) / (int64_t)camera->scene->spacing_nm[a]);
        before[a] = -(int64_t)camera->ahead[a] * normals->scale[a];
    }
    normalise(normals->before, before);
}

void normal_of(int16_t normal[3], struct normals *normals, const struct rendition *r, uint32_t x,
               uint32_t y)
{
    const int64_t depth = r->depth[(size_t)y * r->width + x];
    if (normals->mode == SHADE_DEPTH) {
        depth_normal(normal, r, normals, x, y);
        return;
    }
    normals->shown.label = r->layers ? r->label[(size_t)y * r->width + x] : 0;
    int32_t point[3];
    for (int a = 0; a < 3; a++)
        point[a] = locator_point(&normals->locator[a], depth, x, y);
    field_normal(normal, normals, point);
}
