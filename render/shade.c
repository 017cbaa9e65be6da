#include "render/shade.h"

#include <string.h>

#include "engine/gradient.h"
#include "render/fixed.h"

enum {
    UNIT_BITS = 15,
    UNIT = 1 << UNIT_BITS, /* 1 of a brightness */
    AMBIENT = UNIT / 5,
    DIFFUSE = UNIT - AMBIENT,
    SPECULAR = 70, /* of 255, where the light is mirrored into the eye */
    SHINE = 5,     /* squarings: the exponent is 2^5 */
    GLOSS_BITS = 10,
    GLOSSES = 1 << GLOSS_BITS, /* different cosines */
    CUE_BITS = 20,
    FIT_STEPS = 3,
    CROSSING_PIXEL_BITS = 26, /* of a depth: 4 * 2^24 to a pixel */
    EDGE = UNIT * 35 / 100,   /* what an edge leaves of a colour */

    NORMAL_BITS = 14, /* 1 of a normal's length */
    POINT_BITS = 8,   /* of a voxel */
};

struct look look_default(void)
{
    return (struct look){.light = {-25000, 30000}, .cue_percent = 30, .samples = 1};
}

void shader_release(struct shader *shader)
{
    field_release(&shader->shown);
    field_release(&shader->scene);
    shader->has_shown = shader->has_scene = false;
}

size_t shader_bytes(const struct shader *shader)
{
    return field_bytes(&shader->shown) + field_bytes(&shader->scene);
}

/* ---- where a pixel's point lies ---- */

/* Along one flipped axis: (depth - crossing of plane 0) / T, as a product. T is taken to 20 bits
 * first, so the point is off by some 2^-20 of its distance: less than its own last bit. */
struct locator {
    int64_t C, A, B;
    unsigned shift;
    int64_t inverse; /* 2^44 / (T >> shift) */
    int32_t most;    /* the far side of the scene */
    bool flip;
};

enum { LOCATOR_BITS = 20, INVERSE_BITS = 44 };

static struct locator locator_of(const struct camera *camera, int a)
{
    struct locator l = {camera->C[a], camera->A[a], camera->B[a], 0, 0, 0, camera->flip[a]};
    while (camera->T[a] >> l.shift >> (LOCATOR_BITS + 1))
        l.shift++;
    l.inverse = (INT64_C(1) << INVERSE_BITS) / (camera->T[a] >> l.shift);
    l.most = (int32_t)(camera->scene->grid.size[a] << POINT_BITS);
    return l;
}

/* In 1/256 voxels from the centre of voxel 0, along the scene's axis. */
static inline int32_t locate(const struct locator *l, int64_t depth, uint32_t x, uint32_t y)
{
    const int64_t beyond = depth - (l->C + x * l->A + y * l->B);
    const int64_t flipped = (beyond >> l->shift) * l->inverse >> (INVERSE_BITS - POINT_BITS);
    const int32_t at = flipped < 0 ? 0 : flipped > l->most ? l->most : (int32_t)flipped;
    return (l->flip ? l->most - at : at) - (1 << (POINT_BITS - 1));
}

/* ---- the light ---- */

/* All that colours depend on besides the pixel. Vectors lie along voxel axes, lengths in the
 * world, 2^NORMAL_BITS is 1. */
struct lamp {
    struct locator locator[3];
    int32_t light[3], half[3], viewer[3];
    int32_t scale[3]; /* unit / spacing times 2^12: gradients per voxel to gradients per length */
    int64_t front, depth_range; /* of the scene, in crossings */
    int64_t cue;                /* how much the far end loses, over (depth_range >> cue_shift) */
    unsigned cue_shift;
    int64_t stride;             /* pixels between the depths that a plane is fitted to: a voxel's */
    int32_t gloss[GLOSSES + 1]; /* by the cosine to `half`, times UNIT */
    const struct camera *camera;
    const struct border *border;
    const struct look *look;
    const struct palette *palette;
    struct field_reader shown, scene;
    bool cuts;         /* something is cut away, */
    int32_t window[2]; /* and where it was, these intensities are black and white */
};

static int32_t mirrored(int32_t cosine)
{
    int64_t v = (int64_t)cosine * UNIT / GLOSSES;
    for (int i = 0; i < SHINE; i++)
        v = v * v / UNIT;
    return (int32_t)(SPECULAR * v);
}

static void aim(struct lamp *lamp, const struct camera *camera, const struct look *look)
{
    const int64_t pitch = look->light[1], quarter = VIEW_TURN / 4;
    const int64_t level = view_sine((int32_t)(pitch + quarter));
    const int64_t right = fixed_mul30(view_sine(look->light[0]), level);
    const int64_t behind = fixed_mul30(view_sine((int32_t)(look->light[0] + quarter)), level);
    const int64_t up = view_sine((int32_t)pitch);
    int64_t half[3];
    uint64_t squares = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t light = fixed_mul30(right, camera->right[a]) +
                              fixed_mul30(up, camera->up[a]) -
                              fixed_mul30(behind, camera->ahead[a]);
        lamp->light[a] = (int32_t)(light >> (30 - NORMAL_BITS));
        lamp->viewer[a] = -camera->ahead[a] >> (30 - NORMAL_BITS);
        half[a] = (light - camera->ahead[a]) >> (30 - NORMAL_BITS);
        squares += (uint64_t)(half[a] * half[a]);
    }
    /* Light from straight ahead has no half-way vector, and is mirrored by nothing that is seen. */
    const int64_t length = squares ? square_root(squares) : 1;
    for (int a = 0; a < 3; a++)
        lamp->half[a] = (int32_t)(half[a] * (1 << NORMAL_BITS) / length);
    for (int i = 0; i <= GLOSSES; i++)
        lamp->gloss[i] = mirrored(i);
}

/* Pixels to a voxel, at least 1. */
static int64_t stride_of(const struct camera *camera)
{
    const int64_t pixels = (camera->view.zoom + VIEW_ZOOM_ONE / 2) / VIEW_ZOOM_ONE;
    return pixels < 1 ? 1 : pixels;
}

static void lamp_init(struct lamp *lamp, const struct camera *camera, const struct look *look)
{
    int64_t reach = 0;
    aim(lamp, camera, look);
    for (int a = 0; a < 3; a++) {
        lamp->locator[a] = locator_of(camera, a);
        lamp->scale[a] = (int32_t)((camera->unit_nm << 12) / (int64_t)camera->scene->spacing_nm[a]);
        /* Half the scene's length along this axis, seen along the ray. */
        int64_t pixels = (int64_t)camera->scene->grid.size[a] * camera->view.zoom *
                         (int64_t)(camera->scene->spacing_nm[a] / (uint32_t)camera->unit_nm) / 1000;
        reach += pixels * (camera->ahead[a] < 0 ? -camera->ahead[a] : camera->ahead[a]) >> 31;
    }
    lamp->front = -(reach << 26);
    lamp->depth_range = (reach + 1) << 27;
    while (lamp->depth_range >> lamp->cue_shift >> CUE_BITS)
        lamp->cue_shift++;
    lamp->cue = ((int64_t)UNIT * look->cue_percent / 100 << CUE_BITS) /
                ((lamp->depth_range >> lamp->cue_shift) + 1);
    lamp->stride = stride_of(camera);
}

/* ---- normals ---- */

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

static inline int64_t dot(const int16_t a[3], const int32_t b[3])
{
    return (int64_t)a[0] * b[0] + (int64_t)a[1] * b[1] + (int64_t)a[2] * b[2];
}

static void face_viewer(int16_t normal[3], const struct lamp *lamp)
{
    for (int a = 0; a < 3; a++)
        normal[a] = (int16_t)lamp->viewer[a];
}

/* The scene's gradient takes the surface's side, and outweighs it but where the scene is flat. */
static void add_scene(int64_t outward[3], struct lamp *lamp, const int32_t point[3])
{
    const struct gradient inward = field_at(&lamp->scene, point);
    int64_t gradient[3], along = 0;
    for (int a = 0; a < 3; a++) {
        gradient[a] = (int64_t)inward.along[a] * lamp->scale[a];
        along += gradient[a] * outward[a];
    }
    for (int a = 0; a < 3; a++)
        outward[a] = outward[a] / 16 + (along < 0 ? -gradient[a] : gradient[a]);
}

/* From a point on the surface. */
static void field_normal(int16_t normal[3], struct lamp *lamp, const int32_t point[3])
{
    const struct gradient inward = field_at(&lamp->shown, point);
    int64_t outward[3];
    for (int a = 0; a < 3; a++)
        outward[a] = -(int64_t)inward.along[a] * lamp->scale[a];
    if (lamp->look->mode == SHADE_SCENE)
        add_scene(outward, lamp, point);
    if (!normalise(normal, outward)) /* as thick as thin: it shows no side */
        face_viewer(normal, lamp);
}

/* ---- normals from depths ---- */

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
static struct fit fit_around(const struct rendition *r, const struct lamp *lamp, uint32_t x,
                             uint32_t y)
{
    const int64_t own = r->depth[(size_t)y * r->width + x], stride = lamp->stride;
    struct fit fit = {0};
    for (int64_t j = -FIT_STEPS; j <= FIT_STEPS; j++)
        for (int64_t i = -FIT_STEPS; i <= FIT_STEPS; i++) {
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

static void depth_normal(int16_t normal[3], const struct rendition *r, const struct lamp *lamp,
                         uint32_t x, uint32_t y)
{
    const struct fit f = fit_around(r, lamp, x, y);
    const int64_t xx = f.n * f.xx - f.x * f.x, yy = f.n * f.yy - f.y * f.y;
    const int64_t xy = f.n * f.xy - f.x * f.y;
    const int64_t xd = f.n * f.xd - f.x * f.d, yd = f.n * f.yd - f.y * f.d;
    const int64_t toward = (xx * yy - xy * xy) * lamp->stride * 256;
    const int64_t gradient[3] = {xd * yy - yd * xy, -(yd * xx - xd * xy), -toward};
    int16_t n[3]; /* to the right, up, ahead */
    if (toward == 0 || !normalise(n, gradient)) {
        face_viewer(normal, lamp);
        return;
    }
    const struct camera *camera = lamp->camera;
    for (int a = 0; a < 3; a++)
        normal[a] = (int16_t)((n[0] * (int64_t)camera->right[a] + n[1] * (int64_t)camera->up[a] +
                               n[2] * (int64_t)camera->ahead[a]) >>
                              30);
}

/* ---- colours ---- */

static void colour_pixel(uint8_t rgba[4], const uint8_t base[3], int64_t brightness, int64_t gloss,
                         int64_t cue)
{
    for (int k = 0; k < 3; k++) {
        const int64_t v = (base[k] * brightness + gloss) * cue >> (2 * UNIT_BITS);
        rgba[k] = (uint8_t)(v > 255 ? 255 : v);
    }
    rgba[3] = 255;
}

/* What the depth leaves of a colour. */
static int64_t cue_at(const struct lamp *lamp, int64_t depth)
{
    int64_t behind = depth - lamp->front;
    behind = behind < 0 ? 0 : behind > lamp->depth_range ? lamp->depth_range : behind;
    return UNIT - ((behind >> lamp->cue_shift) * lamp->cue >> CUE_BITS);
}

/* Whether another object lies further back beside a pixel. */
static bool is_edge(const struct rendition *r, uint32_t x, uint32_t y)
{
    const size_t here = (size_t)y * r->width + x;
    const size_t around[4] = {x > 0 ? here - 1 : here, x + 1 < r->width ? here + 1 : here,
                              y > 0 ? here - r->width : here,
                              y + 1 < r->height ? here + r->width : here};
    for (int i = 0; i < 4; i++)
        if (r->label[around[i]] != r->label[here] && r->depth[around[i]] > r->depth[here])
            return true;
    return false;
}

/* Whether a pixel shows a face of its voxel beyond which an object was cut away. */
static bool is_cut_open(const struct lamp *lamp, uint32_t cell, int64_t depth)
{
    return lamp->cuts &&
           border_is_cut(lamp->border, cell + (uint32_t)lamp->camera->toward[depth & 3]);
}

/* The scene there: as bright from every side, so that it reads like a slice. */
static void shade_cut_face(uint8_t rgba[4], const struct lamp *lamp, uint32_t cell,
                           const uint8_t colour[3], int64_t cue)
{
    const int64_t width = (int64_t)lamp->window[1] - lamp->window[0];
    const int64_t above = (int64_t)lamp->camera->scene->cell[cell].intensity - lamp->window[0];
    const int64_t share = width ? above * 255 / width : 0;
    const int64_t grey = share < 0 ? 0 : share > 255 ? 255 : share;
    uint8_t tinted[3];
    for (int k = 0; k < 3; k++)
        tinted[k] = (uint8_t)((3 * grey + colour[k] + 2) / 4);
    colour_pixel(rgba, tinted, UNIT, 0, cue);
}

static void shade_pixel(struct rendition *r, struct lamp *lamp, uint32_t x, uint32_t y)
{
    const size_t pixel = (size_t)y * r->width + x;
    const int64_t depth = r->depth[pixel];
    int16_t *normal = r->normal + 4 * pixel;
    normal[3] = 0;
    if (lamp->look->mode == SHADE_DEPTH) {
        depth_normal(normal, r, lamp, x, y);
    } else {
        const int32_t point[3] = {locate(&lamp->locator[0], depth, x, y),
                                  locate(&lamp->locator[1], depth, x, y),
                                  locate(&lamp->locator[2], depth, x, y)};
        field_normal(normal, lamp, point);
    }
    const int64_t lit = dot(normal, lamp->light), mirror = dot(normal, lamp->half);
    const int64_t cosine = lit < 0 ? 0 : lit >> (2 * NORMAL_BITS - UNIT_BITS);
    const int64_t shine = mirror < 0 ? 0 : mirror >> (2 * NORMAL_BITS - GLOSS_BITS);
    int64_t cue = cue_at(lamp, depth);
    if (lamp->look->edges && is_edge(r, x, y))
        cue = cue * EDGE >> UNIT_BITS;
    const uint8_t *colour = lamp->palette->rgb[r->label[pixel]];
    if (is_cut_open(lamp, r->cell[pixel], depth)) {
        shade_cut_face(r->rgba + 4 * pixel, lamp, r->cell[pixel], colour, cue);
        return;
    }
    colour_pixel(r->rgba + 4 * pixel, colour, AMBIENT + (DIFFUSE * cosine >> UNIT_BITS),
                 lamp->gloss[shine > GLOSSES ? GLOSSES : shine], cue);
}

/* ---- tiles ---- */

struct tile {
    uint32_t left, top, right, bottom; /* right and bottom are beyond it */
};

static struct tile tile_at(const struct rendition *r, uint32_t x, uint32_t y)
{
    const uint32_t right = (x + 1) * TILE, bottom = (y + 1) * TILE;
    return (struct tile){x * TILE, y * TILE, right < r->width ? right : r->width,
                         bottom < r->height ? bottom : r->height};
}

/* Voxels beside each other in a picture lie far apart in memory. */
static void fetch_cells(const struct rendition *r, const struct scene *scene, struct tile tile)
{
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++) {
            const uint32_t cell = r->cell[(size_t)y * r->width + x];
            if (cell != CELL_NONE)
                __builtin_prefetch(scene->cell + cell);
        }
}

/* Labels of a tile. Empty pixels get no colour and no normal; true where all of them are empty. */
static bool label_tile(struct rendition *r, const struct labels *labels, struct tile tile)
{
    bool is_empty = true;
    fetch_cells(r, labels->scene, tile);
    for (uint32_t y = tile.top; y < tile.bottom; y++) {
        const size_t row = (size_t)y * r->width;
        for (size_t pixel = row + tile.left; pixel < row + tile.right; pixel++) {
            const uint32_t cell = r->cell[pixel];
            is_empty = is_empty && cell == CELL_NONE;
            r->label[pixel] = cell == CELL_NONE ? 0 : labels_at(labels, cell);
            if (cell != CELL_NONE)
                continue;
            memset(r->rgba + 4 * pixel, 0, 4);
            memset(r->normal + 4 * pixel, 0, 4 * sizeof *r->normal);
        }
    }
    return is_empty;
}

static void shade_tile(struct rendition *r, struct lamp *lamp, struct tile tile)
{
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++)
            if (r->cell[(size_t)y * r->width + x] != CELL_NONE)
                shade_pixel(r, lamp, x, y);
}

/* Labels of all stale tiles come first: the edges of one look into its neighbours. */
static void label_tiles(struct rendition *r, const struct labels *labels)
{
    for (uint32_t y = 0; y < r->tiles_y; y++)
        for (uint32_t x = 0; x < r->tiles_x; x++) {
            uint8_t *state = r->stale + (size_t)y * r->tiles_x + x;
            if (*state == TILE_STALE && label_tile(r, labels, tile_at(r, x, y)))
                *state = TILE_FRESH;
        }
}

static void shade_tiles(struct rendition *r, struct lamp *lamp)
{
    struct task task =
        task_begin(lamp->camera->scene->watch, "shading", (uint64_t)r->width * r->height);
    for (uint32_t y = 0; y < r->tiles_y && task_advance(&task, TILE * r->width); y++)
        for (uint32_t x = 0; x < r->tiles_x; x++) {
            uint8_t *state = r->stale + (size_t)y * r->tiles_x + x;
            if (*state == TILE_STALE)
                shade_tile(r, lamp, tile_at(r, x, y));
            *state = TILE_FRESH;
        }
}

static enum err prepare(struct field *field, bool *has, const struct border *border,
                        enum field_kind kind, struct fault *fault)
{
    if (*has && field->border == border)
        return OK;
    if (*has)
        field_release(field);
    const enum err err = field_init(field, border, kind, fault);
    *has = err == OK;
    return err;
}

enum err shade(struct rendition *r, const struct camera *camera, const struct border *border,
               const struct palette *palette, const struct look *look, struct shader *shader,
               struct fault *fault)
{
    struct lamp lamp = {.camera = camera,
                        .border = border,
                        .look = look,
                        .palette = palette,
                        .cuts = !cut_is_none(&border->cut),
                        .window = {shader->window[0], shader->window[1]}};
    enum err err = OK;
    if (look->mode != SHADE_DEPTH)
        err = prepare(&shader->shown, &shader->has_shown, border, FIELD_SHOWN, fault);
    if (!err && look->mode == SHADE_SCENE)
        err = prepare(&shader->scene, &shader->has_scene, border, FIELD_SCENE, fault);
    if (err)
        return err;
    lamp.shown.field = &shader->shown;
    lamp.scene.field = &shader->scene;
    lamp_init(&lamp, camera, look);
    label_tiles(r, &border->labels);
    shade_tiles(r, &lamp);
    return OK;
}

struct shade_reach shade_reach(const struct look *look, const struct camera *camera)
{
    /* One step in any case: a face may be cut open, or no more so. */
    struct shade_reach reach = {look->mode == SHADE_DEPTH ? 1 : FIELD_REACH, look->edges ? 1 : 0};
    if (look->mode == SHADE_DEPTH)
        reach.pixels = FIT_STEPS * (int)stride_of(camera);
    return reach;
}

void palette_default(struct palette *palette)
{
    /* Sky, amber, green, rose, violet, sand, teal, brick: of different lightness too. */
    static const uint8_t hue[8][3] = {{214, 178, 150}, {86, 180, 233},  {240, 200, 66},
                                      {0, 158, 115},   {204, 121, 167}, {230, 130, 40},
                                      {130, 130, 220}, {190, 190, 190}};
    memset(palette, 0, sizeof *palette);
    for (int label = 1; label < 256; label++) {
        const uint8_t *base = hue[(label - 1) % 8];
        int dim = (label - 1) / 8 % 4; /* further rounds are darker */
        for (int k = 0; k < 3; k++)
            palette->rgb[label][k] = (uint8_t)(base[k] * (8 - dim) / 8);
    }
}
