#include "render/normal.h"

#include "base/wide.h"

enum {
    BEFORE = 154,       /* 0.6 voxels: where the slope is read before the surface, */
    FURTHER = 384,      /* 1.5 voxels: and further out, */
    FURTHER_WEIGHT = 4, /* which counts so much more */
    BARELY = 64,        /* of a normal's length: what it faces the viewer by at least */
};

/* ---- gradients to normals ---- */

/* Many gradients at once, each to a vector of its direction and of one length: it is a third of the
 * time that a large picture takes, so it is written as loops over arrays, of products that the
 * compiler does several at a time. There are integers only, and of these none that would not come
 * out the same one by one: normalise_one says what the result is, and `test_normalise` that it is
 * that. */

enum { VECTOR_BITS = 15 }; /* of the longest of a gradient's three parts */

bool normalise_one(int16_t direction[3], const int64_t gradient[3])
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
        v[a] = bits > VECTOR_BITS ? gradient[a] >> (bits - VECTOR_BITS)
                                  : gradient[a] * (1 << (VECTOR_BITS - bits));
        squares += (uint64_t)(v[a] * v[a]);
    }
    const int64_t inverse = inverse_root(squares);
    for (int a = 0; a < 3; a++)
        direction[a] = (int16_t)(v[a] * inverse >> (45 - NORMAL_BITS));
    return true;
}

struct parts {
    uint32_t all[NORMALISED]; /* the bits of all three, without their signs */
    int32_t along[3][NORMALISED];
};

/* The one where all bits of `mask` are set, the other where none is. */
static inline uint32_t chosen(uint32_t mask, uint32_t one, uint32_t other)
{
    return (one & mask) | (other & ~mask);
}

/* By so many bits, where none of the first that many of 31 is in use. */
static inline void shift_left(struct parts *parts, int bits)
{
    for (int i = 0; i < NORMALISED; i++) {
        const uint32_t fits = parts->all[i] >> (31 - bits) ? 0 : UINT32_MAX;
        parts->all[i] = chosen(fits, parts->all[i] << bits, parts->all[i]);
        for (int a = 0; a < 3; a++) {
            const uint32_t part = (uint32_t)parts->along[a][i];
            parts->along[a][i] = (int32_t)chosen(fits, part << bits, part);
        }
    }
}

/* The longest of the three parts comes to take 31 bits, of which the first VECTOR_BITS are left. */
static inline void take_bits(struct directions *v, const struct gradients *gradients)
{
    struct parts parts;
    for (int i = 0; i < NORMALISED; i++) {
        parts.all[i] = 0;
        for (int a = 0; a < 3; a++) {
            const int32_t g = parts.along[a][i] = gradients->along[a][i];
            parts.all[i] |= (uint32_t)(g < 0 ? -g : g);
        }
    }
    shift_left(&parts, 16);
    shift_left(&parts, 8);
    shift_left(&parts, 4);
    shift_left(&parts, 2);
    shift_left(&parts, 1);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < NORMALISED; i++)
            v->along[a][i] = (int16_t)(parts.along[a][i] >> (31 - VECTOR_BITS));
}

static inline uint32_t times(uint32_t a, uint32_t b, int shift)
{
    return (uint32_t)((uint64_t)a * b >> shift);
}

/* As inverse_root. */
static inline void find_roots(uint32_t root[NORMALISED], const uint32_t squares[NORMALISED])
{
    const uint32_t one = UINT32_C(1) << 30;
    for (int i = 0; i < NORMALISED; i++) {
        const uint32_t doubled = squares[i] >> 30 ? 0 : UINT32_MAX;
        const uint32_t x = chosen(doubled, squares[i] << 2, squares[i]);
        const uint32_t low = (uint32_t)(((uint64_t)one * 163 - (uint64_t)x * 37) >> 7);
        const uint32_t high = (uint32_t)(((uint64_t)one * 114 - (uint64_t)x * 13) >> 7);
        uint32_t r = chosen(x >> 31 ? UINT32_MAX : 0, high, low);
        r = times(r, 3 * one - times(x, times(r, r, 30), 30), 31);
        r = times(r, 3 * one - times(x, times(r, r, 30), 30), 31);
        root[i] = chosen(doubled, r << 1, r);
    }
}

WIDE void normalise_all(struct directions *directions, const struct gradients *gradients)
{
    struct directions v;
    uint32_t squares[NORMALISED], root[NORMALISED];
    take_bits(&v, gradients);
    for (int i = 0; i < NORMALISED; i++)
        squares[i] = (uint32_t)(v.along[0][i] * v.along[0][i]) +
                     (uint32_t)(v.along[1][i] * v.along[1][i]) +
                     (uint32_t)(v.along[2][i] * v.along[2][i]);
    find_roots(root, squares);
    /* A product of 47 bits, by halves of the root. */
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < NORMALISED; i++) {
            const int32_t part = v.along[a][i];
            const int32_t high = part * (int32_t)(root[i] >> 16);
            const int32_t low = part * (int32_t)(root[i] & 0xffff);
            directions->along[a][i] = (int16_t)((high + (low >> 16)) >> (45 - NORMAL_BITS - 16));
        }
}

/* ---- from fields ---- */

/* The points of a tile's pixels, and what is known of the surface there. */
struct points {
    unsigned count;
    int32_t at[NORMALISED][3];
    uint8_t label[NORMALISED];        /* of which the field is, or 0 for that of all shown voxels */
    struct gradient near[NORMALISED]; /* before the surface */
    struct gradients outward;
    struct directions normal;
};

static void face_viewer(struct directions *normal, unsigned i, const struct normals *normals)
{
    for (int a = 0; a < 3; a++)
        normal->along[a][i] = (int16_t)normals->viewer[a];
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

/* Few take less one by one. */
static void normalise_points(struct points *points)
{
    enum { FEW = 12 };
    const struct gradients *outward = &points->outward;
    if (points->count > FEW) {
        normalise_all(&points->normal, outward);
        return;
    }
    for (unsigned i = 0; i < points->count; i++) {
        const int64_t gradient[3] = {outward->along[0][i], outward->along[1][i],
                                     outward->along[2][i]};
        int16_t normal[3] = {0};
        normalise_one(normal, gradient);
        for (int a = 0; a < 3; a++)
            points->normal.along[a][i] = normal[a];
    }
}

static void slopes_before(struct points *points, struct normals *normals)
{
    for (unsigned i = 0; i < points->count; i++) {
        normals->shown.label = points->label[i];
        points->near[i] = gradient_beside(normals, points->at[i], normals->before, BEFORE);
        for (int a = 0; a < 3; a++)
            points->outward.along[a][i] = -points->near[i].along[a];
    }
    normalise_points(points);
    for (unsigned i = 0; i < points->count; i++) {
        normals->shown.label = points->label[i];
        /* Within a sheet of one voxel the field has its crest, where its slope says nothing;
         * outside it is steep, and the slope the same for some voxels. So it is read before the
         * surface, and with more weight further out the way that this points, unless something else
         * is there. */
        const int16_t out[3] = {points->normal.along[0][i], points->normal.along[1][i],
                                points->normal.along[2][i]};
        const struct gradient *near = &points->near[i];
        const struct gradient far = gradient_beside(normals, points->at[i], out, FURTHER);
        int64_t along = 0;
        for (int a = 0; a < 3; a++)
            along += near->along[a] * far.along[a];
        for (int a = 0; a < 3; a++) {
            const int32_t way = -near->along[a] - (along > 0 ? FURTHER_WEIGHT * far.along[a] : 0);
            points->outward.along[a][i] =
                (int32_t)((int64_t)way * normals->scale[a] / FURTHER_WEIGHT);
        }
    }
}

/* What a pixel shows faces the viewer, if barely. */
static void turn_to_viewer(struct directions *normal, unsigned i, const struct normals *normals)
{
    int64_t along = 0, across[3];
    int16_t turned[3];
    for (int a = 0; a < 3; a++)
        along += normal->along[a][i] * normals->viewer[a];
    if (along >= (1 << (2 * NORMAL_BITS)) / BARELY)
        return;
    for (int a = 0; a < 3; a++)
        across[a] = normal->along[a][i] - (along * normals->viewer[a] >> (2 * NORMAL_BITS)) +
                    normals->viewer[a] / BARELY;
    if (!normalise_one(turned, across)) {
        face_viewer(normal, i, normals);
        return;
    }
    for (int a = 0; a < 3; a++)
        normal->along[a][i] = turned[a];
}

static void field_normals(struct points *points, struct normals *normals)
{
    struct gradients *outward = &points->outward;
    if (normals->looks_out)
        slopes_before(points, normals);
    for (unsigned i = 0; i < points->count && !normals->looks_out; i++) { /* on the surface */
        normals->shown.label = points->label[i];
        const struct gradient inward = field_at(&normals->shown, points->at[i]);
        for (int a = 0; a < 3; a++)
            outward->along[a][i] = -inward.along[a] * normals->scale[a];
    }
    for (unsigned i = 0; i < points->count && normals->mode == SHADE_SCENE; i++) {
        /* The scene's gradient takes the surface's side, and outweighs it but where the scene is
         * flat. */
        const struct gradient inward = field_at(&normals->scene, points->at[i]);
        int32_t gradient[3];
        int64_t along = 0;
        for (int a = 0; a < 3; a++) {
            gradient[a] = inward.along[a] * normals->scale[a];
            along += (int64_t)gradient[a] * outward->along[a][i];
        }
        for (int a = 0; a < 3; a++)
            outward->along[a][i] =
                outward->along[a][i] / 16 + (along < 0 ? -gradient[a] : gradient[a]);
    }
    normalise_points(points);
    for (unsigned i = 0; i < points->count; i++) {
        if (!(outward->along[0][i] | outward->along[1][i] | outward->along[2][i]))
            face_viewer(&points->normal, i, normals); /* as thick as thin: it shows no side */
        if (normals->looks_out)
            turn_to_viewer(&points->normal, i, normals);
    }
}

/* ---- from depths ---- */

/* Sums over the pixels around one, for the plane that fits their depths best. Places count in
 * steps of `stride` pixels, depths in 1/256 pixels from the pixel's own. */
struct fit {
    int64_t n, x, y, xx, xy, yy, d, xd, yd;
};

static void depth_normal(struct directions *normal, unsigned i, const struct rendition *r,
                         const struct normals *normals, uint32_t x, uint32_t y)
{
    /* Pixels of the same surface: what lies steeper than 4 to 1 is another. */
    const int64_t own = r->depth[(size_t)y * r->width + x], stride = normals->stride;
    struct fit f = {0};
    for (int64_t j = -NORMAL_FIT_STEPS; j <= NORMAL_FIT_STEPS; j++)
        for (int64_t k = -NORMAL_FIT_STEPS; k <= NORMAL_FIT_STEPS; k++) {
            const int64_t column = x + k * stride, row = y + j * stride;
            if (column < 0 || row < 0 || column >= r->width || row >= r->height)
                continue;
            const int64_t depth = r->depth[(size_t)row * r->width + (size_t)column];
            if (depth == DEPTH_NONE)
                continue;
            const int64_t d = (depth - own) >> (CROSSING_PIXEL_BITS - 8);
            const int64_t steep = 4 * 256 * stride * (2 + (k < 0 ? -k : k) + (j < 0 ? -j : j));
            if (d >= steep || d <= -steep)
                continue;
            f.n++;
            f.x += k, f.y += j, f.d += d;
            f.xx += k * k, f.xy += k * j, f.yy += j * j;
            f.xd += k * d, f.yd += j * d;
        }
    const int64_t xx = f.n * f.xx - f.x * f.x, yy = f.n * f.yy - f.y * f.y;
    const int64_t xy = f.n * f.xy - f.x * f.y;
    const int64_t xd = f.n * f.xd - f.x * f.d, yd = f.n * f.yd - f.y * f.d;
    const int64_t toward = (xx * yy - xy * xy) * normals->stride * 256;
    const int64_t gradient[3] = {xd * yy - yd * xy, -(yd * xx - xd * xy), -toward};
    int16_t n[3]; /* to the right, up, ahead */
    if (toward == 0 || !normalise_one(n, gradient)) {
        face_viewer(normal, i, normals);
        return;
    }
    const struct camera *camera = normals->camera;
    for (int a = 0; a < 3; a++)
        normal->along[a][i] =
            (int16_t)((n[0] * (int64_t)camera->right[a] + n[1] * (int64_t)camera->up[a] +
                       n[2] * (int64_t)camera->ahead[a]) >>
                      30);
}

/* ---- of pixels ---- */

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
    normalise_one(normals->before, before);
}

void normals_of(struct directions *out, struct normals *normals, const struct rendition *r,
                const struct tile_pixels *pixels)
{
    struct points points = {.count = pixels->count};
    for (unsigned i = 0; i < pixels->count; i++) {
        const uint32_t x = pixels->x[i], y = pixels->y[i];
        const int64_t depth = r->depth[(size_t)y * r->width + x];
        if (normals->mode == SHADE_DEPTH)
            depth_normal(&points.normal, i, r, normals, x, y);
        points.label[i] = r->layers || normals->creases ? r->label[(size_t)y * r->width + x] : 0;
        for (int a = 0; a < 3; a++)
            points.at[i][a] = locator_point(&normals->locator[a], depth, x, y);
    }
    if (normals->mode != SHADE_DEPTH)
        field_normals(&points, normals);
    *out = points.normal;
}
