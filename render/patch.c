#include "render/patch.h"

#include <string.h>

enum {
    CORNERS = 4,
    LEAST = 4,        /* pixels a side; three quarters of fewer would be corners */
    SHARE_BITS = 8,   /* of the way from one corner to the next */
    FLAT_PART = 8,    /* of a voxel: so far from the plane of the others may a pixel lie; */
    FLAT_PIXEL = 2,   /* a sample from that of the others of a pixel; */
    STEEP_PART = 4,   /* and by such a part of what its corners differ by */
    SLACK = 2,        /* voxels by which what is seen may lie deeper in cubes than at corners */
    ALIKE = 15 << 24, /* cosine of normals, where 2^28 is 1: 20 degrees */
    FOLDED = 8 << 24, /* 60 degrees */
    EVEN = (1 << 28) - (1 << 18), /* the same of a normal in the middle of several tiles and that
                                     between the corners: 2.5 degrees */
};

struct patch {
    uint32_t x, y, side;    /* within the block */
    uint32_t last[2];       /* steps from one corner to the next, along x and y */
    size_t corner[CORNERS]; /* pixels: left and right above, then below */
    int64_t depth[CORNERS];
};

/* Where there is one beside it in the block, that begins with the last corners of this one. */
static struct patch patch_at(const struct patches *p, uint32_t x, uint32_t y, uint32_t side)
{
    const bool has_next = p->has_lattice && x + side < p->side && p->left + x + side < p->r->width;
    const bool has_below = p->has_lattice && y + side < p->side && p->top + y + side < p->r->height;
    struct patch patch;
    patch.x = x, patch.y = y, patch.side = side;
    patch.last[0] = has_next ? side : side - 1;
    patch.last[1] = has_below ? side : side - 1;
    return patch;
}

/* Of the steps from one corner to the next, in 2^-SHARE_BITS. */
static inline int32_t share_of(uint32_t step, uint32_t last)
{
    return (int32_t)(((step << (SHARE_BITS + 1)) + last) / (2 * last));
}

static inline tile_mask bit_of(uint32_t x, uint32_t y)
{
    return (tile_mask)1 << (y % TILE * TILE + x % TILE);
}

static inline struct patched *tile_of(struct patches *p, uint32_t x, uint32_t y)
{
    return &p->tile[y / TILE][x / TILE];
}

/* In pixels, at least 1. */
static inline int64_t voxel_of(const struct patches *p)
{
    return p->normals->stride;
}

static inline size_t pixel_of(const struct patches *p, uint32_t x, uint32_t y)
{
    return (size_t)(p->top + y) * p->r->width + p->left + x;
}

/* A pixel of a block. */
struct spot {
    uint32_t x, y;
};

static inline struct spot corner_of(const struct patch *patch, unsigned corner)
{
    return (struct spot){patch->x + (corner & 1) * patch->last[0],
                         patch->y + (corner >> 1) * patch->last[1]};
}

/* ---- pixels by themselves ---- */

static void refine_one(struct patches *p, uint32_t x, uint32_t y)
{
    struct patched *tile = tile_of(p, x, y);
    if (tile->is_refined & bit_of(x, y))
        return;
    tile->is_refined |= bit_of(x, y);
    refine_pixel(p->r, p->refiner, p->left + x, p->top + y);
}

/* ---- whether a patch is one smooth surface ---- */

static inline int64_t between(int64_t from, int64_t to, int64_t share)
{
    return from + ((to - from) * share >> SHARE_BITS);
}

/* Depths of a row of a patch, at both its ends. */
struct ends {
    int64_t left, right;
};

static inline struct ends ends_of(const struct patch *patch, uint32_t y)
{
    const int32_t share = share_of(y, patch->last[1]);
    return (struct ends){between(patch->depth[0], patch->depth[2], share),
                         between(patch->depth[1], patch->depth[3], share)};
}

static inline int64_t depth_between(struct ends ends, int32_t share)
{
    return between(ends.left, ends.right, share) | REFINE_WITHIN;
}

static int64_t depth_at(const struct patch *patch, uint32_t x, uint32_t y)
{
    return depth_between(ends_of(patch, y), share_of(x, patch->last[0]));
}

int64_t patch_between(const int64_t corner[4], uint32_t side, uint32_t x, uint32_t y)
{
    const struct patch patch = {.last = {side - 1, side - 1},
                                .depth = {corner[0], corner[1], corner[2], corner[3]}};
    return depth_at(&patch, x, y);
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

/* Whether a patch is a single pixel of the reduced picture: what is within it is only seen as a
 * mean. */
static inline bool is_pixel(const struct patches *p, const struct patch *patch)
{
    return p->has_lattice && patch->side == p->samples;
}

/* How far from the plane of the corners the middle may lie. */
static int64_t most_off(const struct patches *p, const struct patch *patch)
{
    const int64_t voxel = voxel_of(p) << CROSSING_PIXEL_BITS;
    int64_t least = patch->depth[0], most = patch->depth[0];
    if (!is_pixel(p, patch))
        return voxel / FLAT_PART;
    for (int i = 1; i < CORNERS; i++) {
        least = patch->depth[i] < least ? patch->depth[i] : least;
        most = patch->depth[i] > most ? patch->depth[i] : most;
    }
    return voxel / FLAT_PIXEL + (most - least) / STEEP_PART;
}

/* Whether the surface lies there in the middle where it is between the corners. */
static bool is_flat(struct patches *p, const struct patch *patch)
{
    const uint32_t half = patch->side / 2;
    const int64_t depth = depth_at(patch, half, half), most = most_off(p, patch);
    if (p->has_lattice)
        return refine_crosses(p->refiner, depth - most, depth + most, p->left + patch->x + half,
                              p->top + patch->y + half);
    const size_t middle = refine_middle(p, patch);
    const int64_t off = p->r->depth[middle] - depth;
    return is_within(p, middle) && off <= most && off >= -most;
}

/* How long before the surface rays may come to cubes. */
struct lead {
    int64_t least, most;
};

/* Whether pixels of a row do, where the corners' depths are between these ends. */
static inline bool row_is_in_front(const struct patch *patch, const int64_t *first,
                                   struct ends ends, const int32_t *share, struct lead lead)
{
    bool is_off = false;
    for (uint32_t x = 0; x < patch->side; x++) {
        const int64_t depth = depth_between(ends, share[x]);
        is_off |= first[x] > depth - lead.least || first[x] < depth - lead.most;
    }
    return !is_off;
}

static bool row_is_cut_open(const struct patches *p, const struct patch *patch, size_t row)
{
    const struct cube_maps *cube = &p->r->cube;
    for (uint32_t x = 0; x < patch->side && p->refiner->cuts; x++)
        if (refine_is_cut_open(p->refiner, cube->depth[row + x], cube->cell[row + x]))
            return true;
    return false;
}

/* Whether all rays between the corners do, and come to no cube that is cut open. */
static bool is_in_front(const struct patches *p, const struct patch *patch)
{
    /* About as long as those of the corners; where these come to the ground of a pit, some come to
     * cubes after it. */
    const int64_t voxel = voxel_of(p) << CROSSING_PIXEL_BITS;
    struct lead lead = {0, 0};
    for (int i = 0; i < CORNERS; i++) {
        const int64_t before = patch->depth[i] - p->r->cube.depth[patch->corner[i]];
        lead.most = before > lead.most ? before : lead.most;
        lead.least = before < lead.least ? before : lead.least;
    }
    lead.most += SLACK * voxel;
    lead.least = lead.least < 0 && p->has_lattice ? lead.least - voxel / 2 : 0;
    int32_t share[PATCH_SIDE];
    for (uint32_t x = 0; x < patch->side; x++)
        share[x] = share_of(x, patch->last[0]);
    for (uint32_t y = 0; y < patch->side; y++) {
        const size_t row = pixel_of(p, patch->x, patch->y + y);
        if (!row_is_in_front(patch, p->r->cube.depth + row, ends_of(patch, y), share, lead) ||
            row_is_cut_open(p, patch, row))
            return false;
    }
    return true;
}

/* Normals of pixels, where they are not known yet; those of an object depend on its label. */
static void find_normals(struct patches *p, const struct spot *spot, unsigned count)
{
    struct tile_pixels pixels;
    struct directions found;
    pixels.count = 0;
    for (unsigned i = 0; i < count; i++) {
        const struct spot at = spot[i];
        const size_t pixel = pixel_of(p, at.x, at.y);
        struct patched *tile = tile_of(p, at.x, at.y);
        if (tile->has_normal & bit_of(at.x, at.y))
            continue;
        tile->has_normal |= bit_of(at.x, at.y);
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

static bool are_alike(const int16_t *one, const int16_t *other, int32_t least)
{
    int32_t cosine = 0;
    for (int a = 0; a < 3; a++)
        cosine += one[a] * other[a];
    return cosine >= least;
}

/* Whether the normals at the corners differ by no more than this. */
static bool has_one_side(struct patches *p, const struct patch *patch, int32_t least)
{
    const int16_t *normal = p->r->normal;
    const size_t *corner = patch->corner;
    const struct spot spot[CORNERS] = {corner_of(patch, 0), corner_of(patch, 1),
                                       corner_of(patch, 2), corner_of(patch, 3)};
    find_normals(p, spot, CORNERS);
    return are_alike(normal + 4 * corner[0], normal + 4 * corner[3], least) &&
           are_alike(normal + 4 * corner[1], normal + 4 * corner[2], least) &&
           are_alike(normal + 4 * corner[0], normal + 4 * corner[1], least);
}

/* ---- what lies between ---- */

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

/* What is known of a row of a patch at both its ends. */
struct row {
    struct ends ends;
    int16_t left[4], right[4];
};

static inline struct row row_at(const struct patches *p, const struct patch *patch, uint32_t y)
{
    const int16_t *normal = p->r->normal;
    struct row row = {.ends = ends_of(patch, y)};
    const int32_t share = share_of(y, patch->last[1]);
    mix(row.left, normal + 4 * patch->corner[0], normal + 4 * patch->corner[2], share);
    mix(row.right, normal + 4 * patch->corner[1], normal + 4 * patch->corner[3], share);
    return row;
}

static inline void normal_between(int16_t normal[4], const struct row *row, int32_t share)
{
    mix(normal, row->left, row->right, share);
    lengthen(normal);
}

/* Whether the normal in the middle is the one between those of the corners. */
static bool is_even(struct patches *p, const struct patch *patch)
{
    const uint32_t half = patch->side / 2;
    const struct spot middle = {patch->x + half, patch->y + half};
    const struct row row = row_at(p, patch, half);
    int16_t normal[4];
    refine_one(p, middle.x, middle.y);
    if (!is_within(p, pixel_of(p, middle.x, middle.y)))
        return false;
    find_normals(p, &middle, 1);
    normal_between(normal, &row, share_of(half, patch->last[0]));
    return are_alike(normal, p->r->normal + 4 * pixel_of(p, middle.x, middle.y), EVEN);
}

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
    struct patched *tile = tile_of(p, x, y);
    if (tile->has_normal & bit || voxel == CELL_NONE)
        return;
    p->r->depth[pixel] = depth;
    p->r->cell[pixel] = voxel;
    memcpy(p->r->normal + 4 * pixel, normal, 4 * sizeof *normal);
    tile->is_refined |= bit;
    tile->has_normal |= bit;
}

/* Whose voxels a patch shows: that of all, or those of its points. */
struct owners {
    uint32_t voxel; /* or CELL_NONE */
    bool meets;
};

static struct owners owners_of(const struct patches *p, const struct patch *patch)
{
    const uint32_t voxel = common_voxel(p, patch);
    return (struct owners){voxel, voxel == CELL_NONE && meets_at_corner(p, patch)};
}

static inline uint32_t owner_at(const struct patches *p, const struct owners *owners, int64_t depth,
                                uint32_t x, uint32_t y)
{
    const struct refine_owner how = {owners->meets, p->has_lattice};
    return owners->voxel != CELL_NONE
               ? owners->voxel
               : refine_voxel_at(p->refiner, depth, p->left + x, p->top + y, how);
}

static void fill(struct patches *p, const struct patch *patch)
{
    const struct owners owners = owners_of(p, patch);
    /* Corners have their normals, so rows that are filled do not change them. */
    for (uint32_t y = 0; y < patch->side; y++) {
        const struct row row = row_at(p, patch, y);
        for (uint32_t x = 0; x < patch->side; x++) {
            const int32_t share = share_of(x, patch->last[0]);
            const int64_t depth = depth_between(row.ends, share);
            const uint32_t column = patch->x + x, line = patch->y + y;
            int16_t normal[4];
            normal_between(normal, &row, share);
            fill_pixel(p, column, line, depth, owner_at(p, &owners, depth, column, line), normal);
        }
    }
}

/* ---- pixels of which one sample stands for all ---- */

enum { STANDING_MOST = TILE * TILE }; /* of a block: its pixels */

/* The samples that would stand for the pixels of a patch, row by row. */
struct standing {
    unsigned count;
    uint32_t voxel[STANDING_MOST];
    uint8_t label; /* of them all */
};

static bool corners_show(const struct patches *p, const struct patch *patch, uint8_t label)
{
    for (unsigned i = 0; i < CORNERS; i++)
        if (labels_at(&p->refiner->border->labels, p->r->cell[patch->corner[i]]) != label)
            return false;
    return true;
}

/* False where they do not all show one object. */
static bool find_standing(struct standing *standing, const struct patches *p,
                          const struct patch *patch)
{
    const struct labels *labels = &p->refiner->border->labels;
    const struct owners owners = owners_of(p, patch);
    const uint32_t samples = p->samples;
    standing->count = 0;
    standing->label = labels_at(labels, p->r->cell[patch->corner[0]]);
    if (!corners_show(p, patch, standing->label))
        return false;
    for (uint32_t y = samples / 2; y < patch->side; y += samples) {
        const struct ends ends = ends_of(patch, y);
        for (uint32_t x = samples / 2; x < patch->side; x += samples) {
            const int64_t depth = depth_between(ends, share_of(x, patch->last[0]));
            const uint32_t voxel = owner_at(p, &owners, depth, patch->x + x, patch->y + y);
            if (voxel == CELL_NONE || labels_at(labels, voxel) != standing->label)
                return false;
            standing->voxel[standing->count++] = voxel;
        }
    }
    return true;
}

tile_mask patches_covered(tile_mask stands, uint32_t samples)
{
    const uint32_t first = samples / 2 * (TILE + 1);
    tile_mask covered = stands >> first;
    for (uint32_t wide = 1; wide < samples; wide *= 2)
        covered |= covered << wide;
    for (uint32_t high = 1; high < samples; high *= 2)
        covered |= covered << (high * TILE);
    return covered;
}

static void stand(struct patches *p, const struct patch *patch, const struct standing *standing)
{
    const uint32_t samples = p->samples;
    const uint32_t *voxel = standing->voxel;
    for (uint32_t y = samples / 2; y < patch->side; y += samples) {
        const struct row row = row_at(p, patch, y);
        for (uint32_t x = samples / 2; x < patch->side; x += samples) {
            const uint32_t column = patch->x + x, line = patch->y + y;
            const int32_t share = share_of(x, patch->last[0]);
            int16_t normal[4];
            normal_between(normal, &row, share);
            fill_pixel(p, column, line, depth_between(row.ends, share), *voxel++, normal);
            p->r->label[pixel_of(p, column, line)] = standing->label;
            struct patched *tile = tile_of(p, column, line);
            tile->stands |= bit_of(column, line);
            tile->is_refined |= patches_covered(bit_of(column, line), samples);
        }
    }
}

/* True where one sample stands for each pixel of a smooth patch then. */
static bool stand_for_pixels(struct patches *p, const struct patch *patch)
{
    struct standing standing;
    if (p->samples == 1 || !find_standing(&standing, p, patch))
        return false;
    stand(p, patch, &standing);
    return true;
}

/* ---- patches ---- */

static bool is_continuous(struct patches *p, const struct patch *patch)
{
    return is_flat(p, patch) && is_in_front(p, patch);
}

/* True where the patch is filled, but for pixels that are to be refined. */
static bool fill_whole(struct patches *p, struct patch *patch)
{
    if (patch->side > voxel_of(p))
        return false;
    const enum corners corners = find_corners(p, patch);
    if (corners == CORNERS_EMPTY &&
        (2 * patch->side <= voxel_of(p) && p->r->cell[refine_middle(p, patch)] == CELL_NONE)) {
        for (uint32_t y = patch->y; y < patch->y + patch->side; y++)
            for (uint32_t x = patch->x; x < patch->x + patch->side; x++) {
                p->r->depth[pixel_of(p, x, y)] = DEPTH_NONE;
                p->r->cell[pixel_of(p, x, y)] = CELL_NONE;
                tile_of(p, x, y)->is_refined |= bit_of(x, y);
            }
        return true;
    }
    if (corners != CORNERS_SURFACE || !is_continuous(p, patch))
        return false;
    const bool is_smooth = has_one_side(p, patch, ALIKE);
    if (!is_smooth && !(is_pixel(p, patch) && has_one_side(p, patch, FOLDED)))
        return false;
    if (!is_smooth || !stand_for_pixels(p, patch))
        fill(p, patch);
    return true;
}

static void refine_patch(struct patches *p, uint32_t x, uint32_t y, uint32_t side)
{
    struct patch patch = patch_at(p, x, y, side);
    if (!fill_whole(p, &patch) && side > LEAST)
        for (unsigned i = 0; i < 4; i++)
            refine_patch(p, x + (i & 1) * side / 2, y + (i >> 1) * side / 2, side / 2);
    for (uint32_t row = patch.y; row < patch.y + patch.side; row++)
        for (uint32_t column = patch.x; column < patch.x + patch.side; column++)
            refine_one(p, column, row);
}

void patches_refine_tile(struct patches *p, uint32_t x, uint32_t y)
{
    refine_patch(p, x, y, TILE);
}

bool patches_refine_square(struct patches *p, uint32_t x, uint32_t y, uint32_t side)
{
    struct patch patch = patch_at(p, x, y, side);
    return find_corners(p, &patch) == CORNERS_SURFACE && is_continuous(p, &patch) &&
           has_one_side(p, &patch, ALIKE) && is_even(p, &patch) && stand_for_pixels(p, &patch);
}
