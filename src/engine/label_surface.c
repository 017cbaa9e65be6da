#include "engine/label_surface.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/gradient.h"

enum {
    REACH = 2,     /* voxels that a normal depends on lie so far before a face's first voxel, */
    FAR_REACH = 3, /* and after it */
    TERMS_MOST = 150,
    SLOPE_UNIT = 1 << 18, /* gradients are below 2^11 */
    INNER = 4, /* what a voxel counts in the middle of a cube along an axis, and beside it: */
    OUTER = 3, /* between 1, 1, where edges are too small, and 2, 1, where slopes are too large */
};

/* A voxel near a face, and what it adds to the gradient along the face's axis and the other two. */
struct term {
    int8_t step[3];
    int8_t weight[3];
    ptrdiff_t offset;
};

struct kernel {
    struct term term[TERMS_MOST];
    unsigned terms;
};

struct search {
    const struct scene *scene;
    const uint8_t *label;
    struct team *team;
    struct kernel kernel[3]; /* of faces across each axis */
    uint32_t slope[3];       /* SLOPE_UNIT by the spacing, the finest of which counts as 1 */
    uint64_t cosines[TEAM_MOST][256][3];
};

/* ---- normals ---- */

/* Of the two voxels at steps 0 and 1 along the axis, the sum over both: how many voxels there are,
 * as they count, in the cube around one step ahead, less those one step back. */
static void kernel_init(struct kernel *kernel, int axis, const struct grid *grid)
{
    static const int8_t along[] = {-OUTER, -OUTER - INNER, -INNER, INNER, INNER + OUTER, OUTER};
    static const int8_t across[] = {0, OUTER, OUTER + INNER, INNER + OUTER, OUTER, 0};
    static const int8_t aside[] = {0, OUTER, INNER, OUTER, 0};
    static const int8_t ahead[] = {-OUTER, -INNER, 0, INNER, OUTER};
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    kernel->terms = 0;
    for (int k = -REACH; k <= FAR_REACH; k++)
        for (int i = -REACH; i <= REACH; i++)
            for (int j = -REACH; j <= REACH; j++) {
                struct term term = {.offset = k * grid->step[axis] + i * grid->step[b] +
                                              j * grid->step[c]};
                term.step[axis] = (int8_t)k;
                term.step[b] = (int8_t)i;
                term.step[c] = (int8_t)j;
                term.weight[0] = (int8_t)(along[k + REACH] * aside[i + REACH] * aside[j + REACH]);
                term.weight[1] = (int8_t)(across[k + REACH] * ahead[i + REACH] * aside[j + REACH]);
                term.weight[2] = (int8_t)(across[k + REACH] * aside[i + REACH] * ahead[j + REACH]);
                if (term.weight[0] || term.weight[1] || term.weight[2])
                    kernel->term[kernel->terms++] = term;
            }
}

static bool is_inside(const struct grid *grid, const int64_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] < REACH || at[a] + FAR_REACH >= grid->size[a])
            return false;
    return true;
}

static void add_term(int32_t gradient[3], const struct term *term)
{
    for (int i = 0; i < 3; i++)
        gradient[i] += term->weight[i];
}

/* Around a face whose first voxel is `at`, which may lie one step before the scene. */
static void find_gradient(int32_t gradient[3], const struct search *s, const struct kernel *kernel,
                          const int64_t at[3], ptrdiff_t cell, uint8_t label)
{
    const struct grid *grid = &s->scene->grid;
    const bool inside = is_inside(grid, at);
    for (unsigned i = 0; i < kernel->terms; i++) {
        const struct term *term = &kernel->term[i];
        if (!inside && !grid_contains(grid, at[0] + term->step[0], at[1] + term->step[1],
                                      at[2] + term->step[2]))
            continue;
        if (s->label[cell + term->offset] == label)
            add_term(gradient, term);
    }
}

/* A gradient of 0, as of a sheet of one voxel, has no direction: the face counts whole. */
static uint64_t cosine(const struct search *s, int axis, const int64_t at[3], ptrdiff_t cell,
                       uint8_t label)
{
    int32_t gradient[3] = {0};
    uint64_t along[3], squares = 0;
    find_gradient(gradient, s, &s->kernel[axis], at, cell, label);
    for (int i = 0; i < 3; i++) {
        along[i] = (uint64_t)abs(gradient[i]) * s->slope[(axis + i) % 3];
        squares += along[i] * along[i];
    }
    return squares > 0 ? along[0] * SURFACE_UNIT / square_root(squares) : SURFACE_UNIT;
}

/* ---- faces ---- */

/* The face between a voxel, or what lies before the scene, and the next along an axis. */
static uint64_t add_face(const struct search *s, uint64_t (*cosines)[3], int axis,
                         const int64_t at[3], ptrdiff_t cell)
{
    const uint8_t side[2] = {s->label[cell], s->label[cell + s->scene->grid.step[axis]]};
    if (side[0] == side[1])
        return 0;
    for (int i = 0; i < 2; i++)
        if (side[i])
            cosines[side[i]][axis] += cosine(s, axis, at, cell, side[i]);
    return 8;
}

/* Faces that begin at the voxels of a row, or right before it. */
static uint64_t add_row(const struct search *s, uint64_t (*cosines)[3], uint32_t y, uint32_t z)
{
    const struct grid *grid = &s->scene->grid;
    uint64_t looked = grid->size[0];
    ptrdiff_t cell = (ptrdiff_t)grid_cell(grid, 0, y, z) - 1;
    looked += add_face(s, cosines, 0, (const int64_t[3]){-1, y, z}, cell);
    for (uint32_t x = 0; x < grid->size[0]; x++) {
        const int64_t at[3] = {x, y, z};
        cell++;
        for (int a = 0; a < 3; a++)
            looked += add_face(s, cosines, a, at, cell);
        if (y == 0)
            looked += add_face(s, cosines, 1, (const int64_t[3]){x, -1, z}, cell - grid->step[1]);
        if (z == 0)
            looked += add_face(s, cosines, 2, (const int64_t[3]){x, y, -1}, cell - grid->step[2]);
    }
    return looked;
}

static void search_part(void *context, unsigned worker)
{
    struct search *s = context;
    const struct grid *grid = &s->scene->grid;
    const struct slab slab = grid_slab(grid, worker, team_size(s->team));
    struct task task = task_begin_part(s->scene->watch, "surface", 0, worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            if (!task_advance(&task, add_row(s, s->cosines[worker], y, z)))
                return;
}

enum err label_surface_find(struct label_surface *surface, const uint8_t *label,
                            const struct scene *scene, struct team *team, struct fault *fault)
{
    struct search *s = mem_new(sizeof *s);
    if (!s)
        return fault_memory(fault, "a surface");
    s->scene = scene;
    s->label = label;
    s->team = team;
    const uint32_t *nm = scene->spacing_nm;
    uint64_t finest = nm[0] < nm[1] ? nm[0] : nm[1];
    finest = nm[2] < finest ? nm[2] : finest;
    for (int a = 0; a < 3; a++) {
        kernel_init(&s->kernel[a], a, &scene->grid);
        s->slope[a] = (uint32_t)(finest * SLOPE_UNIT / nm[a]);
    }
    team_run(team, search_part, s);
    memset(surface, 0, sizeof *surface);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        for (int l = 0; l < 256; l++)
            for (int a = 0; a < 3; a++)
                surface->cosines[l][a] += s->cosines[worker][l][a];
    free(s);
    return watch_fault(scene->watch, fault);
}
