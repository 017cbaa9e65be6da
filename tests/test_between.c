/* SPDX-License-Identifier: MIT */
/*
 * Slices between outlines, against a model that follows the definitions of session/between.h voxel
 * by voxel and shares no code with the program; which outlines count, the answers of the command,
 * and objects that are restored from every eighth slice.
 */
#include <math.h>

#include "session/between.h"
#include "tests/paint_model.h"
#include "tests/random_commands.h"
#include "tests/scarce_memory.h"
#include "tests/scene_main.h"
#include "tests/stopping.h"

enum { SIDE = 12, CELLS = (SIDE + 2) * (SIDE + 2) * (SIDE + 2) };

static struct grid grid;
static uint8_t map[CELLS], wanted[CELLS];
static uint32_t unit[3]; /* voxels along each axis, in units of the spacing in the plane */
DRAW_FROM(46)

/* ---- the model ---- */

static uint32_t divisor(uint32_t a, uint32_t b)
{
    uint32_t d = a < b ? a : b;
    while (a % d || b % d)
        d--;
    return d;
}

/* A place in slice `slice`, which may be outside the scene. */
struct spot {
    int axis, u, v;
    int64_t slice;
};

static uint32_t cell_of(const struct spot *spot, int64_t u, int64_t v)
{
    uint32_t at[3];
    at[spot->axis] = (uint32_t)spot->slice;
    at[spot->u] = (uint32_t)u;
    at[spot->v] = (uint32_t)v;
    return grid_cell(&grid, at[0], at[1], at[2]);
}

static bool outlined(const struct spot *spot, int64_t u, int64_t v)
{
    return u >= 0 && v >= 0 && u < grid.size[spot->u] && v < grid.size[spot->v] &&
           map[cell_of(spot, u, v)] == BETWEEN_OUTLINED;
}

/* Signed distance at a whole place, by all voxels of the slice. */
static int64_t signed_distance(const struct spot *spot, int64_t u, int64_t v)
{
    const bool is_in = outlined(spot, u, v);
    uint64_t least = UINT64_MAX, root = 0;
    for (int64_t y = 0; y < grid.size[spot->v]; y++)
        for (int64_t x = 0; x < grid.size[spot->u]; x++) {
            const uint64_t way_u = (uint64_t)gap(x, u) * unit[spot->u],
                           way_v = (uint64_t)gap(y, v) * unit[spot->v];
            const uint64_t square = way_u * way_u + way_v * way_v;
            if (outlined(spot, x, y) != is_in && square < least)
                least = square;
        }
    if (least == UINT64_MAX)
        return INT64_C(1) << 36;
    while ((root + 1) * (root + 1) <= 256 * least)
        root++;
    return is_in ? (int64_t)root : -(int64_t)root;
}

/* Four times the signed distance at a place in half voxels. */
static int64_t at_half(const struct spot *spot, int64_t u2, int64_t v2)
{
    int64_t sum = 0;
    for (int64_t du = 0; du < 2; du++)
        for (int64_t dv = 0; dv < 2; dv++) {
            const int64_t u = u2 + du, v = v2 + dv; /* rounded down */
            sum += signed_distance(spot, (u - (u % 2 != 0 && u < 0)) / 2,
                                   (v - (v % 2 != 0 && v < 0)) / 2);
        }
    return sum;
}

static uint64_t count_section(const struct spot *spot, int64_t middle2[2])
{
    uint64_t count = 0, sum[2] = {0, 0};
    for (uint32_t v = 0; v < grid.size[spot->v]; v++)
        for (uint32_t u = 0; u < grid.size[spot->u]; u++)
            if (outlined(spot, u, v)) {
                count++;
                sum[0] += u;
                sum[1] += v;
            }
    for (int k = 0; count && k < 2; k++) /* the half voxel nearest to the mean */
        for (middle2[k] = 0;
             2 * middle2[k] * (int64_t)count + (int64_t)count <= 4 * (int64_t)sum[k];)
            middle2[k]++;
    return count;
}

/* Fill the slices between two; return true if the sections were aligned. */
static bool model_gap(struct spot a, struct spot b)
{
    int64_t middle_a[2], middle_b[2], apart[2] = {0, 0};
    const uint64_t count_a = count_section(&a, middle_a), count_b = count_section(&b, middle_b);
    uint64_t both = 0;
    for (uint32_t v = 0; v < grid.size[a.v]; v++)
        for (uint32_t u = 0; u < grid.size[a.u]; u++)
            both += outlined(&a, u, v) && outlined(&b, u, v);
    const bool aligns = 2 * both < (count_a < count_b ? count_a : count_b);
    for (int k = 0; aligns && k < 2; k++)
        apart[k] = middle_b[k] - middle_a[k];
    for (struct spot s = {a.axis, a.u, a.v, a.slice + 1}; s.slice < b.slice; s.slice++) {
        const int64_t part = s.slice - a.slice, parts = b.slice - a.slice,
                      moved[2] = {nearest(0, apart[0], part, parts),
                                  nearest(0, apart[1], part, parts)};
        for (uint32_t v = 0; v < grid.size[a.v]; v++)
            for (uint32_t u = 0; u < grid.size[a.u]; u++) {
                const int64_t u2 = 2 * (int64_t)u - moved[0], v2 = 2 * (int64_t)v - moved[1];
                if ((parts - part) * at_half(&a, u2, v2) +
                        part * at_half(&b, u2 + apart[0], v2 + apart[1]) >=
                    0)
                    wanted[cell_of(&s, u, v)] = BETWEEN_FILLED;
            }
    }
    return aligns;
}

static unsigned model_fill(int axis)
{
    struct spot last = {.slice = -1};
    unsigned aligned = 0;
    int64_t middle[2];
    memcpy(wanted, map, sizeof wanted);
    for (struct spot s = {axis, (axis + 1) % 3, (axis + 2) % 3, 0}; s.slice < grid.size[axis];
         s.slice++) {
        if (!count_section(&s, middle))
            continue;
        if (last.slice >= 0 && s.slice > last.slice + 1)
            aligned += model_gap(last, s);
        last = s;
    }
    return aligned;
}

/* ---- random sections ---- */

/* Two polygons in a slice, or few voxels, or all. */
static void draw_section(int axis, uint32_t slice)
{
    const unsigned kind = below(8);
    for (unsigned n = 0; n < 2; n++) {
        uint32_t corner[4][3];
        bool covers[CELLS] = {false};
        const size_t corners = kind < 4 ? 3 + below(2) : 1;
        for (size_t i = 0; i < corners; i++) {
            for (int a = 0; a < 3; a++)
                corner[i][a] = below(grid.size[a]);
            corner[i][axis] = slice;
        }
        model_polygon(covers, &grid, (corners_of)corner, corners, axis);
        for (size_t c = 0; c < grid.cells; c++)
            map[c] = covers[c] ? BETWEEN_OUTLINED : map[c];
    }
    bool *covers = (bool[CELLS]){false};
    EACH_VOXEL(&grid, kind == 7 && (const uint32_t[]){x, y, z}[axis] == slice);
    for (size_t c = 0; c < grid.cells; c++)
        map[c] = covers[c] ? BETWEEN_OUTLINED : map[c];
}

STORY(slices_between_sections_are_those_of_the_definition)
{
    static const uint32_t spacing[][3] = {
        {1000000, 1000000, 1000000}, {1000000, 1500000, 2200000}, {700, 300, 1000}, {7, 11, 13}};
    struct team *team[4] = {NULL};
    unsigned aligned = 0;
    size_t filled = 0;
    for (unsigned i = 2; i < 4; i++)
        CHECK(team_new(&team[i], i, NULL) == OK);
    const unsigned rounds = check_scaled(2000);
    for (unsigned round = 0; round < rounds && check_failures == 0; round++) {
        const uint32_t *nm = spacing[below(4)];
        const uint32_t sides[3] = {1 + below(SIDE), 1 + below(SIDE), 1 + below(SIDE)};
        const int axis = (int)below(3), u = (axis + 1) % 3, v = (axis + 2) % 3;
        struct between_tally tally;
        size_t count = 0;
        CHECK(grid_init(&grid, sides, NULL) == OK);
        memset(map, 0, sizeof map);
        for (uint32_t k = 0; k < sides[axis]; k++)
            if (below(3) == 0)
                draw_section(axis, k);
        unit[u] = nm[u] / divisor(nm[u], nm[v]);
        unit[v] = nm[v] / divisor(nm[u], nm[v]);
        aligned += model_fill(axis);
        CHECK(between_fill(map, &tally, &grid, nm, axis, team[round % 4], NULL, NULL) == OK);
        CHECK(memcmp(map, wanted, grid.cells) == 0);
        for (size_t c = 0; c < grid.cells; c++)
            count += wanted[c] == BETWEEN_FILLED;
        CHECK_INT(tally.voxels, count);
        filled += count;
    }
    for (unsigned i = 2; i < 4; i++)
        team_free(team[i]);
    printf("# %zu voxels, %u aligned gaps\n", filled, aligned);
    CHECK(filled > 20 * (size_t)rounds && aligned > rounds / 10);
}

/* ---- worked by hand ---- */

/* Outline squares of a side of 3 around places in slices of z, fill, and write a slice. */
static const char *slice_text(const uint32_t middle[2][3], uint32_t z)
{
    static char text[200];
    const uint32_t nm[3] = {1000, 1000, 1000}, sides[3] = {12, 5, 12};
    struct between_tally tally;
    char *out = text;
    CHECK(grid_init(&grid, sides, NULL) == OK);
    memset(map, 0, sizeof map);
    for (int i = 0; i < 2; i++)
        for (uint32_t y = middle[i][1] - 1; y <= middle[i][1] + 1; y++)
            for (uint32_t x = middle[i][0] - 1; x <= middle[i][0] + 1; x++)
                map[grid_cell(&grid, x, y, middle[i][2])] = BETWEEN_OUTLINED;
    CHECK(between_fill(map, &tally, &grid, nm, 2, NULL, NULL, NULL) == OK);
    for (uint32_t y = 0; y < sides[1]; y++) {
        for (uint32_t x = 0; x < sides[0]; x++)
            *out++ = ".o#"[map[grid_cell(&grid, x, y, z)]];
        *out++ = '\n';
    }
    *out = '\0';
    return text;
}

STORY(sections_far_apart_are_moved_towards_each_other)
{
    static const uint32_t apart[2][3] = {{2, 2, 1}, {8, 2, 5}}, near[2][3] = {{2, 2, 1}, {3, 2, 5}};
    CHECK_TEXT(slice_text(apart, 1),
               "............\n.ooo........\n.ooo........\n.ooo........\n............\n");
    CHECK_TEXT(slice_text(apart, 3),
               "............\n....###.....\n....###.....\n....###.....\n............\n");
    CHECK_TEXT(slice_text(apart, 0),
               "............\n............\n............\n............\n............\n");
    CHECK_TEXT(slice_text(near, 2),
               "............\n.###........\n.###........\n.###........\n............\n");
}

/* ---- objects of every eighth slice ---- */

/* Dice of the slices from the first to the last section, in percent, rounded down. */
static unsigned restore(bool (*holds)(double x, double y, double z), const char *name)
{
    const uint32_t sides[3] = {64, 64, 64}, nm[3] = {1000000, 1000000, 1000000};
    OWNED(mem_release) uint8_t *given = NULL;
    struct between_tally tally = {0};
    uint64_t both = 0, one = 0;
    CHECK(grid_init(&grid, sides, NULL) == OK);
    if (!CHECK((given = calloc(grid.cells, 1)) != NULL))
        return 0;
    OWNED(mem_release) bool *covers = calloc(grid.cells, sizeof *covers);
    EACH_VOXEL(&grid, holds(x, y, z));
    for (uint32_t c = 0; c < grid.cells; c++)
        given[c] = covers[c] && grid_place(&grid, c).z % 8 == 3;
    CHECK(between_fill(given, &tally, &grid, nm, 2, NULL, NULL, NULL) == OK);
    for (uint32_t c = 0; c < grid.cells; c++) {
        const uint32_t z = covers[c] || given[c] ? grid_place(&grid, c).z : 0;
        if (z >= tally.first && z <= tally.last) {
            both += covers[c] && given[c];
            one += (uint64_t)covers[c] + !!given[c];
        }
    }
    printf("# %s: Dice %.3f\n", name, 2.0 * (double)both / (double)one);
    return (unsigned)(200 * both / one);
}

static bool in_ellipsoid(double x, double y, double z)
{
    x -= 31, y -= 33, z -= 31;
    return pow(x + y / 4, 2) / 500 + pow(y - z / 3, 2) / 300 + z * z / 900 < 1;
}

/* A tube of a radius of 6, whose sections every 8 slices hardly overlap. */
static bool in_tube(double x, double y, double z)
{
    x -= 8 + 0.8 * z, y -= 32 + 10 * sin(z / 9);
    return x * x + y * y < 36;
}

STORY(objects_are_restored_from_every_eighth_slice)
{
    CHECK(restore(in_ellipsoid, "ellipsoid") >= 97);
    CHECK(restore(in_tube, "tube") >= 95);
}

/* ---- errors ---- */

static enum err fill_some(struct watch *watch)
{
    const uint32_t nm[3] = {1000, 1000, 1000};
    struct between_tally tally;
    memset(map, 0, sizeof map);
    map[grid_cell(&grid, 3, 3, 2)] = map[grid_cell(&grid, 8, 5, 9)] = BETWEEN_OUTLINED;
    return between_fill(map, &tally, &grid, nm, 2, NULL, watch, NULL);
}

STORY(without_memory_or_time_the_error_is_returned)
{
    const uint32_t sides[3] = {SIDE, SIDE, SIDE};
    size_t most = 0;
    int stopped = 0, looks;
    CHECK(grid_init(&grid, sides, NULL) == OK);
    for (allow_allocations(0); fill_some(NULL) == ERR_MEMORY; allow_allocations(++most))
        ;
    mem_allows = NULL;
    CHECK(most > 3 && fill_some(NULL) == OK);
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
    for (looks = 0; fill_some(&watch) == ERR_CANCELLED; looks = ++stopped)
        watch_begin(&watch);
    CHECK(stopped > 20);
}

/* ---- the command ---- */

SCENE_STORY(outlines_of_one_plane_count_and_others_are_refused_by_name)
{
    must(interp, "auto on; label 3 liver");
    is_refused(interp, "between 2",
               "label 2 cerebellum has no exact outlines; draw them by `outline ... within=0`");
    is_refused(interp, "between 0", "LABEL: expected a label 1..255");
    must(interp, "outline 2,2,1 2 to=6,2,1 to=6,6,1 to=2,6,1");
    is_refused(interp, "between 2", "has no exact outlines"); /* it grows */
    must(interp, "undo; fill 2,2,1 2 to=6,2,1 to=6,6,1 to=2,6,1 within=0");
    is_refused(interp, "between 2", "has exact outlines in one slice alone; outline it in another");
    must(interp, "fill 3,2,2 2 to=6,2,2 to=6,6,2 within=0");
    is_refused(interp, "between 2", "has no voxels between its outlines");
    must(interp, "undo; seed 9,9,5 2 within=0; seed 3,3,5 2 to=8,3,5 within=0"); /* no area */
    must(interp, "seed 8,8,7 2 radius=1 within=0");                              /* no slice */
    is_refused(interp, "between 2", "in one slice alone");
    must(interp, "undo 3; fill 4,2,5 2 to=8,2,5 to=8,6,5 to=4,6,5 within=0");
    must(interp, "box 4,2,5 4,6,5 0 within=0; fill 1,1,1 3 to=1,5,1 to=1,5,5 within=0");
    must(interp, "between 2");
    CHECK_TEXT(buf_text(&reply.canonical), "between 2 over=0");
    CHECK_HAS(buf_text(&reply.words), "spared=0 marker=11");
    CHECK_HAS(
        buf_text(&reply.text),
        "71 voxels planted in 3 slices between 2 outlines, axial 1 to 5\n71 voxels changed, ");
    must(interp, "undo");
    is_refused(interp, "between cerebellum keep=0,3", "no voxel of it has a label that may change");
}

SCENE_STORY(planes_are_chosen_and_labels_that_stay_are_left_out)
{
    must(interp, "auto on; seed 0,0,0 0; fill 2,1,2 2 to=6,1,2 to=6,1,6 to=2,1,6 within=0");
    must(interp, "fill 2,9,2 2 to=6,9,2 to=6,9,6 to=2,9,6 within=0");
    must(interp, "fill 9,1,2 2 to=9,4,2 to=9,4,6 within=0; box 2,5,2 4,5,6 1 within=0");
    is_refused(interp, "between 2",
               "has outlines in several planes; expected plane=coronal|sagittal");
    is_refused(interp, "between 2 plane=axial", "has no exact outlines in slices of this plane");
    is_refused(interp, "between 2 plane=sagittal", "in one slice alone");
    MUST_MENTION(interp, "between 2 plane=coronal",
                 "left out, of labels that stay: 15 voxels\n160 voxels planted in 7 slices between "
                 "2 outlines, coronal 1 to 9\n");
    CHECK_HAS(buf_text(&reply.words), "spared=");
    is_refused(interp, "between 2 plane=coronal", "no voxel of it has a label that may change");
    MUST_MENTION(interp, "between 2 plane=coronal over=1", "15 voxels planted in 7 slices");
}

/* Slices of a map: one marker with voxels in several slices. */
static void sparse_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint8_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < size[0]; x++)
        *at++ = z % 4 == 1 && x > 2 && x < 8 && y > 3 && y < 8 ? 2 : 0;
}

SCENE_STORY(slices_of_a_map_are_outlines)
{
    write_map("sparse.nii", size, VOXEL_UINT8, sparse_row, NULL);
    CHECK(chdir(folder) == 0);
    must(interp, "auto on; seed-file sparse.nii within=0");
    MUST_MENTION(interp, "between 2",
                 "120 voxels planted in 6 slices between 3 outlines, axial 1 to 9\n");
    must(interp, "remove 4,4,2; fill 3,4,3 2 to=4,4,3 to=4,7,3 to=3,7,3 within=0");
    MUST_MENTION(interp, "between 2", "in 5 slices between 4 outlines, axial 1 to 9\n");
}

STORY(a_session_that_resumes_needs_no_forest)
{
    struct interpreter interp;
    struct snapshot before, after;
    begin_with_journal(&interp, "between.iftty");
    must(&interp, "auto on; seed 1,1,1 1; seed 9,9,9 0");
    must(&interp, "fill 2,2,1 2 to=6,2,1 to=6,6,1 to=2,6,1 within=0");
    must(&interp, "fill 3,3,7 2 to=9,3,7 to=9,8,7 within=0; between 2 over=0-1; seed 5,5,8 1");
    take_snapshot(&before, &interp);
    resume_journal(&interp, "between.iftty");
    take_snapshot(&after, &interp);
    is_same_segmentation(&before, &after);
    interpreter_release(&interp);
    verify_journal("between.iftty");
}
