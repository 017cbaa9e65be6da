#include "render/patch.h"

#include <string.h>

enum {
    CORNERS = 4,
    LEAST = 4,        /* pixels a side; three quarters of fewer would be corners */
    SHARE_BITS = 8,   /* of the way from one corner to the next */
    PIXEL_BITS = 26,  /* of a depth: 4 * 2^24 to a pixel */
    FLAT_PART = 8,    /* of a voxel: so far from the plane of the others may a pixel lie */
    SLACK = 2,        /* voxels by which what is seen may lie deeper in cubes than at corners */
    ALIKE = 15 << 24, /* cosine of normals, where 2^28 is 1: 20 degrees */
};

struct patches {
    struct rendition *r;
    struct refiner *refiner;
    struct normals *normals;
    int64_t voxel; /* how wide one is at least, in pixels */
    uint32_t left, top;
    tile_mask is_refined, has_normal;
};

struct patch {
    uint32_t x, y, side;    /* within the tile */
    size_t corner[CORNERS]; /* pixels: left and right above, then below */
    int64_t depth[CORNERS];
    int64_t between[TILE][TILE]; /* depths of all its pixels, [y][x], once is_in_front */
};

/* Of SIDE - 1 steps from one corner to the next, in 2^-SHARE_BITS. */
static const int16_t shares[2][TILE] = {{0, 85, 171, 256}, {0, 37, 73, 110, 146, 183, 219, 256}};

static inline tile_mask bit_of(uint32_t x, uint32_t y)
{
    return (tile_mask)1 << (y * TILE + x);
}

static inline size_t pixel_of(const struct patches *p, uint32_t x, uint32_t y)
{
    return (size_t)(p->top + y) * p->r->width + p->left + x;
}

/* A pixel of a tile. */
struct spot {
    uint32_t x, y;
};

static inline struct spot corner_of(const struct patch *patch, unsigned corner)
{
    const uint32_t last = patch->side - 1;
    return (struct spot){patch->x + (corner & 1) * last, patch->y + (corner >> 1) * last};
}

/* ---- pixels by themselves ---- */

static void refine_one(struct patches *p, uint32_t x, uint32_t y)
{
    if (p->is_refined & bit_of(x, y))
        return;
    p->is_refined |= bit_of(x, y);
    refine_pixel(p->r, p->refiner, p->left + x, p->top + y);
}

static void refine_all(struct patches *p, const struct patch *patch)
{
    for (uint32_t y = patch->y; y < patch->y + patch->side; y++)
        for (uint32_t x = patch->x; x < patch->x + patch->side; x++)
            refine_one(p, x, y);
}

/* ---- whether a patch is one smooth surface ---- */

static inline int64_t between(int64_t from, int64_t to, int64_t share)
{
    return from + ((to - from) * share >> SHARE_BITS);
}

static int64_t depth_at(const struct patch *patch, uint32_t x, uint32_t y)
{
    const int16_t *share = shares[patch->side == TILE];
    const int64_t left = between(patch->depth[0], patch->depth[2], share[y]);
    const int64_t right = between(patch->depth[1], patch->depth[3], share[y]);
    return between(left, right, share[x]) | REFINE_WITHIN;
}

static bool is_within(const struct patches *p, size_t pixel)
{
    return p->r->cell[pixel] != CELL_NONE && (p->r->depth[pixel] & 3) == REFINE_WITHIN;
}

enum corners { CORNERS_APART, CORNERS_EMPTY, CORNERS_SURFACE };

/* Refines the corners: whether nothing is seen at any, or a surface at all. */
static enum corners find_corners(struct patches *p, struct patch *patch)
{
    unsigned surfaces = 0, empty = 0;
    for (unsigned i = 0; i < CORNERS; i++) {
        const struct spot at = corner_of(patch, i);
        refine_one(p, at.x, at.y);
        const size_t pixel = patch->corner[i] = pixel_of(p, at.x, at.y);
        patch->depth[i] = p->r->depth[pixel];
        surfaces += is_within(p, pixel);
        empty += p->r->cell[pixel] == CELL_NONE;
    }
    return empty == CORNERS ? CORNERS_EMPTY : surfaces == CORNERS ? CORNERS_SURFACE : CORNERS_APART;
}

static size_t refine_middle(struct patches *p, const struct patch *patch)
{
    const uint32_t x = patch->x + patch->side / 2, y = patch->y + patch->side / 2;
    refine_one(p, x, y);
    return pixel_of(p, x, y);
}

static bool is_flat(struct patches *p, const struct patch *patch)
{
    const int64_t most = (p->voxel << PIXEL_BITS) / FLAT_PART;
    const uint32_t half = patch->side / 2;
    const size_t middle = refine_middle(p, patch);
    if (!is_within(p, middle))
        return false;
    const int64_t off = p->r->depth[middle] - depth_at(patch, half, half);
    return off <= most && off >= -most;
}

/* Whether the rays between the corners come to cubes about as long before the surface as those do,
 * and to none that is cut open. */
static bool is_in_front(const struct patches *p, struct patch *patch)
{
    const struct cube_maps *cube = &p->r->cube;
    int64_t most = 0;
    for (int i = 0; i < CORNERS; i++) {
        const int64_t behind = patch->depth[i] - cube->depth[patch->corner[i]];
        most = behind > most ? behind : most;
    }
    most += p->voxel * SLACK << PIXEL_BITS;
    for (uint32_t y = 0; y < patch->side; y++) {
        const size_t row = pixel_of(p, patch->x, patch->y + y);
        for (uint32_t x = 0; x < patch->side; x++) {
            if (cube->cell[row + x] == CELL_NONE ||
                refine_is_cut_open(p->refiner, cube->depth[row + x], cube->cell[row + x]))
                return false;
            patch->between[y][x] = depth_at(patch, x, y);
            const int64_t behind = patch->between[y][x] - cube->depth[row + x];
            if (behind < 0 || behind > most)
                return false;
        }
    }
    return true;
}

/* Normals of the corners, where they are not known yet; those of an object depend on its label. */
static void find_normals(struct patches *p, const struct patch *patch)
{
    struct tile_pixels pixels;
    struct directions found;
    pixels.count = 0;
    for (unsigned i = 0; i < CORNERS; i++) {
        const struct spot at = corner_of(patch, i);
        if (p->has_normal & bit_of(at.x, at.y))
            continue;
        p->has_normal |= bit_of(at.x, at.y);
        const size_t pixel = patch->corner[i];
        p->r->label[pixel] = labels_at(&p->refiner->border->labels, p->r->cell[pixel]);
        pixels.x[pixels.count] = p->left + at.x;
        pixels.y[pixels.count++] = p->top + at.y;
    }
    normals_of(&found, p->normals, p->r, &pixels);
    for (unsigned i = 0; i < pixels.count; i++) {
        int16_t *normal = p->r->normal + 4 * ((size_t)pixels.y[i] * p->r->width + pixels.x[i]);
        for (int a = 0; a < 3; a++)
            normal[a] = found.along[a][i];
        normal[3] = 0;
    }
}

static bool are_alike(const int16_t *one, const int16_t *other)
{
    int32_t cosine = 0;
    for (int a = 0; a < 3; a++)
        cosine += one[a] * other[a];
    return cosine >= ALIKE;
}

static bool has_one_side(struct patches *p, const struct patch *patch)
{
    const int16_t *normal = p->r->normal;
    const size_t *corner = patch->corner;
    find_normals(p, patch);
    return are_alike(normal + 4 * corner[0], normal + 4 * corner[3]) &&
           are_alike(normal + 4 * corner[1], normal + 4 * corner[2]) &&
           are_alike(normal + 4 * corner[0], normal + 4 * corner[1]);
}

/* ---- what lies between ---- */

/* The voxel that all corners show, or CELL_NONE where they show several. */
static uint32_t common_voxel(const struct patches *p, const struct patch *patch)
{
    const uint32_t cell = p->r->cell[patch->corner[0]];
    for (int i = 1; i < CORNERS; i++)
        if (p->r->cell[patch->corner[i]] != cell)
            return CELL_NONE;
    return cell;
}

static bool meets_at_corner(const struct patches *p, const struct patch *patch)
{
    for (unsigned i = 0; i < CORNERS; i++) {
        const struct spot at = corner_of(patch, i);
        if (refine_meets_at(p->refiner, patch->depth[i], p->left + at.x, p->top + at.y))
            return true;
    }
    return false;
}

/* Of the middle too, or it would be a dot among the others. */
static void fill_pixel(struct patches *p, uint32_t x, uint32_t y, int64_t depth, uint32_t voxel,
                       const int16_t normal[4])
{
    const size_t pixel = pixel_of(p, x, y);
    const tile_mask bit = bit_of(x, y);
    if (p->has_normal & bit || voxel == CELL_NONE)
        return;
    p->r->depth[pixel] = depth;
    p->r->cell[pixel] = voxel;
    memcpy(p->r->normal + 4 * pixel, normal, 4 * sizeof *normal);
    p->is_refined |= bit;
    p->has_normal |= bit;
}

static inline void mix(int16_t out[4], const int16_t from[4], const int16_t to[4], int32_t share)
{
    for (int a = 0; a < 4; a++)
        out[a] = (int16_t)(from[a] + ((to[a] - from[a]) * share >> SHARE_BITS));
}

/* Between two vectors of a length there are shorter ones: as long again, by a step of Newton's. */
static inline void lengthen(int16_t normal[4])
{
    int32_t square = 0;
    for (int a = 0; a < 3; a++)
        square += normal[a] * normal[a] >> NORMAL_BITS;
    const int32_t longer = ((3 << NORMAL_BITS) - square) / 2;
    for (int a = 0; a < 3; a++)
        normal[a] = (int16_t)(normal[a] * longer >> NORMAL_BITS);
}

static void fill(struct patches *p, const struct patch *patch)
{
    const int16_t *share = shares[patch->side == TILE];
    const uint32_t voxel = common_voxel(p, patch);
    const bool meets = voxel == CELL_NONE && meets_at_corner(p, patch);
    int16_t corner[CORNERS][4];
    for (int i = 0; i < CORNERS; i++)
        memcpy(corner[i], p->r->normal + 4 * patch->corner[i], sizeof corner[i]);
    for (uint32_t y = 0; y < patch->side; y++) {
        int16_t left[4], right[4], normal[4];
        mix(left, corner[0], corner[2], share[y]);
        mix(right, corner[1], corner[3], share[y]);
        for (uint32_t x = 0; x < patch->side; x++) {
            mix(normal, left, right, share[x]);
            lengthen(normal);
            const int64_t depth = patch->between[y][x];
            const uint32_t column = patch->x + x, row = patch->y + y;
            const uint32_t own =
                voxel != CELL_NONE
                    ? voxel
                    : refine_voxel_at(p->refiner, depth, p->left + column, p->top + row, meets);
            fill_pixel(p, column, row, depth, own, normal);
        }
    }
}

/* ---- patches ---- */

/* Nothing that is seen is narrower than half a voxel. */
static bool is_empty(struct patches *p, const struct patch *patch)
{
    return 2 * patch->side <= p->voxel && p->r->cell[refine_middle(p, patch)] == CELL_NONE;
}

static void fill_empty(struct patches *p, const struct patch *patch)
{
    for (uint32_t y = patch->y; y < patch->y + patch->side; y++)
        for (uint32_t x = patch->x; x < patch->x + patch->side; x++) {
            p->r->depth[pixel_of(p, x, y)] = DEPTH_NONE;
            p->r->cell[pixel_of(p, x, y)] = CELL_NONE;
            p->is_refined |= bit_of(x, y);
        }
}

static bool is_smooth(struct patches *p, struct patch *patch)
{
    return is_flat(p, patch) && is_in_front(p, patch) && has_one_side(p, patch);
}

/* True where the patch is filled, but for pixels that are to be refined. */
static bool fill_whole(struct patches *p, struct patch *patch)
{
    if (patch->side > p->voxel)
        return false;
    const enum corners corners = find_corners(p, patch);
    if (corners == CORNERS_EMPTY && is_empty(p, patch))
        fill_empty(p, patch);
    else if (corners == CORNERS_SURFACE && is_smooth(p, patch))
        fill(p, patch);
    else
        return false;
    return true;
}

static void refine_patch(struct patches *p, uint32_t x, uint32_t y, uint32_t side)
{
    struct patch patch;
    patch.x = x, patch.y = y, patch.side = side;
    if (!fill_whole(p, &patch) && side > LEAST)
        for (unsigned i = 0; i < 4; i++)
            refine_patch(p, x + (i & 1) * side / 2, y + (i >> 1) * side / 2, side / 2);
    refine_all(p, &patch);
}

tile_mask patches_refine(struct rendition *rendition, struct refiner *refiner,
                         struct normals *normals, uint32_t left, uint32_t top)
{
    struct patches p = {.r = rendition,
                        .refiner = refiner,
                        .normals = normals,
                        .voxel = normals->stride,
                        .left = left,
                        .top = top};
    refine_patch(&p, 0, 0, TILE);
    return p.has_normal;
}
