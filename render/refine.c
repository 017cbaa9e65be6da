#include "render/refine.h"

#include <string.h>

#include "engine/weight_gradient.h"
#include "render/projection.h"

enum {
    RATIO_BITS = 15,
    FINER_BITS = REFINE_POINT_BITS - LOCATOR_POINT_BITS, /* of the last bit of a field's point */
    SHARE_BITS = 16,
    NEARLY = 64 * FIELD_INSIDE_UNIT, /* inside; */
    FAR = 1024 * FIELD_INSIDE_UNIT,  /* outside: the surface is a voxel away */
    BACK = 4,                        /* steps of half a voxel before the first solid one */
    HALVINGS = 6,                    /* of a step, to where it leaves what is solid */
    GAP = 8,                         /* steps: after more, cubes are gone through instead */
    END = 2 * REFINE_END,            /* steps at most to where a ray leaves an object */
};

void refiner_init(struct refiner *refiner, const struct camera *camera, const struct border *border)
{
    /* Half a voxel is half of the length, in voxels along all axes, that the ray goes in one along
     * the axis of which it crosses the most planes. */
    int64_t least = camera->T[0];
    uint64_t squares = 0;
    for (int a = 1; a < 3; a++)
        least = camera->T[a] < least ? camera->T[a] : least;
    for (int a = 0; a < 3; a++) {
        const uint64_t ratio = (uint64_t)((least << RATIO_BITS) / camera->T[a]);
        squares += ratio * ratio;
    }
    const int64_t exact = (least << RATIO_BITS) / (2 * (int64_t)square_root(squares));
    const int64_t half = exact > 0 ? exact : 1;
    *refiner =
        (struct refiner){.camera = camera, .border = border, .cuts = !cut_is_none(&border->cut)};
    for (int a = 0; a < 3; a++)
        refiner->locator[a] = locator_of(camera, a);
    for (int pace = REFINE_QUARTER; pace <= REFINE_WHOLE; pace++) {
        refiner->depth[pace] = (half << pace) / 2;
        for (int a = 0; a < 3; a++) {
            const int64_t step = (half << pace << REFINE_POINT_BITS) / 2 / camera->T[a];
            refiner->step[pace][a] = (int32_t)(camera->flip[a] ? -step : step);
        }
    }
}

/* ---- where objects meet ---- */

enum {
    SIDE = 2 * MEETING_REACH,
    PART_BITS = 7,
    PART = 1 << PART_BITS,
    VOICES = SIDE * SIDE * SIDE,
};

/* Whether the shown ones of the eight voxels around a point are of several objects. Points lie in
 * the scene. */
static bool meeting_is_at(const struct border *border, const int32_t point[3])
{
    const struct grid *grid = &border->scene->grid;
    uint32_t first = grid_cell(grid, 0, 0, 0);
    int label = -1;
    for (int a = 0; a < 3; a++)
        first += (uint32_t)((point[a] >> REFINE_POINT_BITS) * grid->step[a]);
    for (unsigned i = 0; i < 8; i++) {
        const uint32_t voxel = first + (i & 1) + (i & 2 ? (uint32_t)grid->step[1] : 0) +
                               (i & 4 ? (uint32_t)grid->step[2] : 0);
        if (!border_shows(border, voxel))
            continue;
        const uint8_t its = labels_at(&border->labels, voxel);
        if (label >= 0 && its != label)
            return true;
        label = its;
    }
    return false;
}

/* The voxels around a point: SIDE along each axis from `first` on, with their weights by either
 * tent. */
struct around {
    int64_t first[3]; /* of the scene, before its first voxel too */
    uint32_t narrow[3][SIDE], wide[3][SIDE];
};

/* A shown voxel; all weights around a point add up to 2^29 at most. */
struct voice {
    uint32_t voxel, weight;
    uint8_t label;
};

static unsigned find_voices(struct voice voice[VOICES], const struct border *border,
                            const struct around *around)
{
    enum { ALIKE = 64, NARROW = 3 * ALIKE }; /* it counts three times as much as the wide one */
    const struct grid *grid = &border->scene->grid;
    unsigned count = 0;
    for (int i = 0; i < VOICES; i++) {
        const int x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const int64_t at[3] = {around->first[0] + x, around->first[1] + y, around->first[2] + z};
        if (!grid_contains(grid, at[0], at[1], at[2]))
            continue;
        const uint32_t voxel = grid_cell(grid, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
        const uint32_t weight =
            NARROW * around->narrow[0][x] * around->narrow[1][y] * around->narrow[2][z] +
            around->wide[0][x] * around->wide[1][y] * around->wide[2][z];
        if (weight && border_shows(border, voxel))
            voice[count++] = (struct voice){voxel, weight, labels_at(&border->labels, voxel)};
    }
    return count;
}

static uint32_t said_for(const struct voice *voice, unsigned count, uint8_t label)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < count; i++)
        sum += voice[i].label == label ? voice[i].weight : 0;
    return sum;
}

uint32_t meeting_voxel(const struct border *border, const int32_t point[3], uint32_t own)
{
    struct voice voice[VOICES];
    struct around around;
    if (!meeting_is_at(border, point))
        return own;
    for (int a = 0; a < 3; a++) {
        const uint32_t part = (uint32_t)point[a] >> (REFINE_POINT_BITS - PART_BITS) & (PART - 1);
        const uint32_t narrow[SIDE] = {0, PART - part, part, 0};
        const uint32_t wide[SIDE] = {PART - part, 2 * PART - part, PART + part, part};
        around.first[a] = (point[a] >> REFINE_POINT_BITS) - 1;
        memcpy(around.narrow[a], narrow, sizeof narrow);
        memcpy(around.wide[a], wide, sizeof wide);
    }
    const uint8_t its = labels_at(&border->labels, own);
    const unsigned count = find_voices(voice, border, &around);
    /* The label that most is said for; of several the least. */
    uint8_t label = its;
    uint32_t most = said_for(voice, count, label);
    for (unsigned i = 0; i < count; i++) {
        if (voice[i].label == label)
            continue;
        const uint32_t sum = said_for(voice, count, voice[i].label);
        if (sum > most || (sum == most && voice[i].label < label)) {
            most = sum;
            label = voice[i].label;
        }
    }
    uint32_t nearest = 0, voxel = own;
    for (unsigned i = 0; i < count && label != its; i++)
        if (voice[i].label == label && voice[i].weight > nearest) {
            nearest = voice[i].weight;
            voxel = voice[i].voxel;
        }
    return voxel;
}

/* ---- along a ray ---- */

/* A point on a ray, in 2^-REFINE_POINT_BITS voxels, the voxel in whose cube it lies, and what is
 * there; the low bits of its depth are those of a crossing, or REFINE_WITHIN. */
struct sample {
    int64_t depth;
    int32_t at[3], inside;
    uint32_t cell; /* CELL_NONE outside the scene */
};

static inline void look(struct sample *sample, struct refiner *refiner)
{
    const int32_t point[3] = {sample->at[0] >> FINER_BITS, sample->at[1] >> FINER_BITS,
                              sample->at[2] >> FINER_BITS};
    sample->inside = field_inside(refiner->shown, point);
}

/* The place along an axis of the cube in which a point lies; before the scene one far beyond it. */
static inline uint32_t along_axis(int32_t at)
{
    return (uint32_t)((at + (1 << (REFINE_POINT_BITS - 1))) >> REFINE_POINT_BITS);
}

/* The voxel in whose cube a point lies; CELL_NONE outside the scene. */
static inline uint32_t cell_at(const struct grid *grid, const int32_t at[3])
{
    const uint32_t x = along_axis(at[0]), y = along_axis(at[1]), z = along_axis(at[2]);
    const bool is_within = (x < grid->size[0]) & (y < grid->size[1]) & (z < grid->size[2]);
    return is_within ? grid_cell(grid, x, y, z) : CELL_NONE;
}

/* Further along the ray; what is there is not looked at yet. */
static inline void go_on(struct sample *to, const struct refiner *refiner,
                         const struct sample *from, enum refine_pace pace)
{
    const int32_t *step = refiner->step[pace];
    to->depth = (from->depth + refiner->depth[pace]) | REFINE_WITHIN;
    to->at[0] = from->at[0] + step[0];
    to->at[1] = from->at[1] + step[1];
    to->at[2] = from->at[2] + step[2];
    to->cell = cell_at(&refiner->camera->scene->grid, to->at);
}

/* Whether a surface that is looked for may be that of a voxel. */
static inline bool shows(const struct refiner *refiner, uint32_t cell)
{
    const uint8_t label = refiner->label;
    return border_shows(refiner->border, cell) &&
           (label == 0 || seams_label(refiner->seams, cell) == label);
}

/* ---- what is solid for a label ---- */

static void add_label(struct solid *solid, uint8_t label)
{
    for (int i = 0; i < solid->labels; i++)
        if (solid->label[i] == label)
            return;
    solid->label[solid->labels++] = label;
}

struct solid refine_solid(const struct refiner *refiner, uint32_t cell)
{
    const uint32_t place = (cell * UINT32_C(2654435769) >> 16) % REFINE_SOLIDS;
    struct solid *solid = &refiner->solids->at[place];
    if (solid->cell != cell) {
        const struct border *border = refiner->border;
        *solid = (struct solid){.cell = cell};
        if (border_shows(border, cell))
            add_label(solid, seams_label(refiner->seams, cell));
        for (int i = 0; i < 6 && seams_is_edge(refiner->seams, cell); i++) {
            const ptrdiff_t step = border->scene->grid.step[i / 2];
            const uint32_t beside = cell + (uint32_t)(i % 2 ? step : -step);
            if (border_shows(border, beside))
                add_label(solid, seams_label(refiner->seams, beside));
        }
    }
    return *solid;
}

static bool is_solid_for_label(const struct refiner *refiner, uint32_t cell)
{
    const struct solid solid = refine_solid(refiner, cell);
    bool is_solid = false;
    for (int i = 0; i < solid.labels; i++)
        is_solid |= solid.label[i] == refiner->label;
    return is_solid;
}

static inline bool is_solid(const struct refiner *refiner, uint32_t cell)
{
    return cell != CELL_NONE && border_is_solid(refiner->border, cell) &&
           (refiner->label == 0 || is_solid_for_label(refiner, cell));
}

/* The shown voxel that a point in a solid one at a place belongs to: it, or its shown neighbour
 * whose centre is nearest to the point. Which one is not to be foreseen: so nothing branches. */
static uint32_t owner_beside(const struct refiner *refiner, uint32_t cell, const uint32_t place[3],
                             const int32_t at[3])
{
    const struct grid *grid = &refiner->camera->scene->grid;
    uint32_t owner = cell;
    int32_t nearest = INT32_MIN;
    for (int a = 0; a < 3; a++) {
        const int32_t beyond = at[a] - (int32_t)(place[a] << REFINE_POINT_BITS);
        const uint32_t before = cell - (uint32_t)grid->step[a];
        const uint32_t after = cell + (uint32_t)grid->step[a];
        const bool is_before = (-beyond > nearest) & shows(refiner, before);
        owner = is_before ? before : owner;
        nearest = is_before ? -beyond : nearest;
        const bool is_after = (beyond > nearest) & shows(refiner, after);
        owner = is_after ? after : owner;
        nearest = is_after ? beyond : nearest;
    }
    return owner;
}

/* The same by the voxel alone, whose place takes divisions. */
static uint32_t owner_of(const struct refiner *refiner, uint32_t cell, const int32_t at[3])
{
    if (shows(refiner, cell))
        return cell;
    const struct place p = grid_place(&refiner->camera->scene->grid, cell);
    return owner_beside(refiner, cell, (const uint32_t[]){p.x, p.y, p.z}, at);
}

/* And by the point alone; CELL_NONE where it lies in no solid voxel. */
static uint32_t owner_at(const struct refiner *refiner, const int32_t at[3])
{
    const uint32_t cell = cell_at(&refiner->camera->scene->grid, at);
    if (!is_solid(refiner, cell))
        return CELL_NONE;
    if (shows(refiner, cell))
        return cell;
    const uint32_t place[3] = {along_axis(at[0]), along_axis(at[1]), along_axis(at[2])};
    return owner_beside(refiner, cell, place, at);
}

/* Where the ray comes inside between two samples of which the latter is. */
static void find_surface(struct sample *surface, const struct refiner *refiner,
                         const struct sample *before, const struct sample *after)
{
    const int64_t lacks = before->inside < 0 ? -before->inside : 0; /* after a gap it may not */
    const int64_t share = lacks ? (lacks << SHARE_BITS) / (after->inside + lacks) : 0;
    const int64_t beyond = (after->depth - before->depth) * share >> SHARE_BITS;
    surface->depth = (before->depth + beyond) | REFINE_WITHIN;
    for (int a = 0; a < 3; a++)
        surface->at[a] =
            before->at[a] + (int32_t)((after->at[a] - before->at[a]) * share >> SHARE_BITS);
    surface->cell = owner_at(refiner, surface->at);
    if (surface->cell == CELL_NONE)
        surface->cell = owner_of(refiner, after->cell, surface->at);
}

/* What is thinner than a step may lie between two samples that are both nearly inside. */
static bool lies_between(struct sample *middle, struct refiner *refiner,
                         const struct sample *before, const struct sample *after)
{
    if (before->inside < -NEARLY || after->inside < -NEARLY)
        return false;
    go_on(middle, refiner, before, REFINE_QUARTER);
    middle->cell = after->cell;
    look(middle, refiner);
    return middle->inside > 0;
}

/* Where something is cut away, a ray may leave it on a step in which it has come inside: at `last`,
 * the last point between two samples that is solid, of which the former is. */
static bool leaves_inside(struct sample *last, struct refiner *refiner, const struct sample *before,
                          const struct sample *after)
{
    struct sample end = *after, middle = *after;
    *last = *before;
    for (int i = 0; i < HALVINGS; i++) {
        middle.depth = (last->depth + end.depth) / 2;
        for (int a = 0; a < 3; a++)
            middle.at[a] = (last->at[a] + end.at[a]) / 2;
        middle.cell = cell_at(&refiner->camera->scene->grid, middle.at);
        *(is_solid(refiner, middle.cell) ? last : &end) = middle;
    }
    look(last, refiner);
    return last->inside > 0;
}

/* Follows a ray from a solid voxel on, through solid ones and small gaps. True where it comes
 * inside, at `out`, or leaves the scene; false where cubes are to be gone through from there. */
static bool follow(struct sample *out, struct refiner *refiner, const struct sample *first)
{
    struct sample room[2] = {*first}, middle;
    struct sample *here = &room[0], *next = &room[1];
    for (int gap = 0; gap <= GAP;) {
        const bool is_far = gap == 0 && here->inside < -FAR;
        go_on(next, refiner, here, is_far ? REFINE_WHOLE : REFINE_HALF);
        if (!is_solid(refiner, next->cell)) {
            if (refiner->cuts && refiner->is_close && leaves_inside(&middle, refiner, here, next)) {
                find_surface(out, refiner, here, &middle);
                return true;
            }
            gap = refiner->cuts ? GAP + 1 : gap + 1;
        } else {
            if (gap > 0)
                look(here, refiner);
            gap = 0;
            look(next, refiner);
            const bool is_between = next->inside <= 0 && lies_between(&middle, refiner, here, next);
            if (next->inside > 0 || is_between) {
                find_surface(out, refiner, here, is_between ? &middle : next);
                return true;
            }
        }
        struct sample *former = here;
        here = next;
        next = former;
        if (here->cell == CELL_NONE)
            break;
    }
    out->depth = here->depth;
    out->cell = here->cell;
    return here->cell == CELL_NONE;
}

bool refine_is_cut_open(const struct refiner *refiner, int64_t depth, uint32_t cell)
{
    if (!refiner->cuts || (depth & 3) == REFINE_WITHIN)
        return false;
    const uint32_t beside = cell + (uint32_t)refiner->camera->toward[depth & 3];
    return !border_is_open(refiner->border, beside) &&
           !(refiner->camera->scene->cell[beside].flags & CELL_RIM);
}

static void find_point(int32_t at[3], const struct refiner *refiner, int64_t depth, uint32_t x,
                       uint32_t y)
{
    for (int a = 0; a < 3; a++)
        at[a] = locator_point(&refiner->locator[a], depth, x, y) * (1 << FINER_BITS);
}

/* As owner_at; of the next solid voxel on the ray, where the point lies in none. */
static uint32_t owner_from(const struct refiner *refiner, const int32_t at[3])
{
    struct sample next;
    memcpy(next.at, at, sizeof next.at);
    for (int i = 0; i < BACK; i++) {
        for (int a = 0; a < 3; a++)
            next.at[a] += refiner->step[REFINE_HALF][a];
        next.cell = cell_at(&refiner->camera->scene->grid, next.at);
        if (is_solid(refiner, next.cell))
            return owner_of(refiner, next.cell, at);
    }
    return CELL_NONE;
}

uint32_t refine_voxel_at(const struct refiner *refiner, int64_t depth, uint32_t x, uint32_t y,
                         struct refine_owner how)
{
    int32_t at[3];
    find_point(at, refiner, depth, x, y);
    uint32_t owner = owner_at(refiner, at);
    if (owner == CELL_NONE && how.goes_on)
        owner = owner_from(refiner, at);
    return owner != CELL_NONE && how.meets ? meeting_voxel(refiner->border, at, owner) : owner;
}

bool refine_meets_at(const struct refiner *refiner, int64_t depth, uint32_t x, uint32_t y)
{
    int32_t at[3];
    find_point(at, refiner, depth, x, y);
    return refiner->meets && meeting_is_at(refiner->border, at);
}

bool refine_crosses(struct refiner *refiner, int64_t from, int64_t to, uint32_t x, uint32_t y)
{
    struct sample before, after;
    refiner->shown->label = refiner->label;
    find_point(before.at, refiner, from, x, y);
    look(&before, refiner);
    if (before.inside > 0)
        return false;
    find_point(after.at, refiner, to, x, y);
    look(&after, refiner);
    return after.inside > 0;
}

/* On, or back, by half a voxel. */
static void go(struct sample *to, const struct refiner *refiner, const struct sample *from,
               int sign)
{
    to->depth = from->depth + sign * refiner->depth[REFINE_HALF];
    for (int a = 0; a < 3; a++)
        to->at[a] = from->at[a] + sign * refiner->step[REFINE_HALF][a];
    to->cell = cell_at(&refiner->camera->scene->grid, to->at);
}

/* Where a ray came inside that is inside as it comes to its first solid voxel: the ground of a pit
 * may lie further outside than the skin. Where it was inside for longer, that voxel is seen. */
static void go_back(struct sample *ray, struct refiner *refiner, const struct sample *first)
{
    struct sample after = *first, before = *first;
    for (int i = 0; i < BACK; i++) {
        go(&before, refiner, &after, -1);
        if (before.cell == CELL_NONE || !border_is_open(refiner->border, before.cell))
            return;
        look(&before, refiner);
        if (before.inside <= 0) {
            find_surface(ray, refiner, &before, &after);
            return;
        }
        after = before;
        after.cell = first->cell; /* the surface is that of a solid voxel */
    }
}

/* What a ray that comes into a cube shows of it or of what is beyond. True where that is all. */
static bool refine(struct sample *ray, struct refiner *refiner, uint32_t x, uint32_t y)
{
    struct sample first = {.depth = ray->depth, .cell = ray->cell};
    refiner->shown->label = refiner->label;
    find_point(first.at, refiner, ray->depth, x, y);
    look(&first, refiner);
    if (first.inside <= 0)
        return follow(ray, refiner, &first);
    const bool is_open = refine_is_cut_open(refiner, ray->depth, ray->cell);
    if (!is_open)
        ray->depth |= REFINE_WITHIN;
    ray->cell = owner_of(refiner, ray->cell, first.at);
    memcpy(ray->at, first.at, sizeof ray->at);
    if (!is_open && refiner->is_close)
        go_back(ray, refiner, &first);
    return true;
}

bool refine_label(struct refiner *refiner, uint8_t label, uint32_t x, uint32_t y, int64_t *depth,
                  uint32_t *cell)
{
    struct sample ray = {.depth = *depth, .cell = *cell};
    refiner->label = label;
    const bool is_found = refine(&ray, refiner, x, y) && ray.cell != CELL_NONE;
    refiner->label = 0;
    *depth = ray.depth;
    *cell = ray.cell;
    return is_found;
}

uint32_t refine_label_voxel(struct refiner *refiner, uint8_t label, int64_t depth, uint32_t x,
                            uint32_t y)
{
    refiner->label = label;
    const uint32_t voxel =
        refine_voxel_at(refiner, depth, x, y, (struct refine_owner){false, false});
    refiner->label = 0;
    return voxel;
}

int64_t refine_end(struct refiner *refiner, uint8_t label, uint32_t x, uint32_t y, int64_t depth)
{
    struct sample here = {.depth = depth}, next;
    find_point(here.at, refiner, depth, x, y);
    refiner->shown->label = label;
    look(&here, refiner);
    const bool is_inside = here.inside > 0;
    for (int i = 0; i < END; i++) {
        go(&next, refiner, &here, is_inside ? 1 : -1);
        if (next.cell == CELL_NONE)
            break;
        look(&next, refiner);
        if ((next.inside > 0) != is_inside) {
            const int64_t apart = (int64_t)here.inside - next.inside;
            return here.depth + (next.depth - here.depth) * here.inside / apart;
        }
        here = next;
    }
    return here.depth;
}

/* Every other pixel of a row will do. */
void refine_fetch(const struct refiner *refiner, const struct rendition *r, struct footprint pixels)
{
    for (int32_t y = pixels.top; y <= pixels.bottom; y++)
        for (int32_t x = pixels.left; x <= pixels.right; x += 2) {
            const size_t pixel = (size_t)y * r->width + (size_t)x;
            int32_t at[3];
            if (r->cube.cell[pixel] == CELL_NONE)
                continue;
            __builtin_prefetch(refiner->border->solid + (r->cube.cell[pixel] >> 6));
            for (int a = 0; a < 3; a++)
                at[a] = locator_point(&refiner->locator[a], r->cube.depth[pixel], (uint32_t)x,
                                      (uint32_t)y);
            field_fetch(refiner->shown, at);
        }
}

void refine_pixel(struct rendition *r, struct refiner *refiner, uint32_t x, uint32_t y)
{
    const size_t pixel = (size_t)y * r->width + x;
    struct sample ray = {.depth = r->cube.depth[pixel], .cell = r->cube.cell[pixel]};
    while (ray.cell != CELL_NONE && !refine(&ray, refiner, x, y))
        if (!raycast_pixel(refiner->camera, refiner->border, x, y, ray.depth, &ray.depth,
                           &ray.cell))
            ray.cell = CELL_NONE;
    if (refiner->meets && ray.cell != CELL_NONE && (ray.depth & 3) == REFINE_WITHIN)
        ray.cell = meeting_voxel(refiner->border, ray.at, ray.cell);
    r->depth[pixel] = ray.cell == CELL_NONE ? DEPTH_NONE : ray.depth;
    r->cell[pixel] = ray.cell;
}
