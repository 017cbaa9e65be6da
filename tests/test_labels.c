/* SPDX-License-Identifier: MIT */
/* Markers made from a segmentation: components, their erosion and contours, compared with a plain
 * slow computation; what grows from them and how corrections change it; and objects that are given
 * by a range of intensities within a connected region. */
#include "session/seed_file.h"
#include "session/map.h"
#include "tests/random_commands.h"
#include "tests/scene_main.h"

static uint64_t seed = 1;

/* ---- the slow computation ---- */

enum { SIDE_MOST = 9, VOXELS_MOST = SIDE_MOST * SIDE_MOST * SIDE_MOST };

struct slow {
    uint32_t size[3];
    size_t voxels;
    uint16_t region[VOXELS_MOST];
    int piece[VOXELS_MOST]; /* by voxel */
    int pieces;
    bool left[VOXELS_MOST];
};

static size_t index_of(const struct slow *s, int64_t x, int64_t y, int64_t z)
{
    return (size_t)(x + s->size[0] * (y + (int64_t)s->size[1] * z));
}

/* Whether a neighbour `far` faces away at most is in the scene, and its place. */
static bool neighbour(const struct slow *s, size_t i, const int step[3], size_t *other)
{
    int64_t p[3] = {(int64_t)(i % s->size[0]), (int64_t)(i / s->size[0] % s->size[1]),
                    (int64_t)(i / s->size[0] / s->size[1])};
    for (int a = 0; a < 3; a++) {
        p[a] += step[a];
        if (p[a] < 0 || p[a] >= s->size[a])
            return false;
    }
    *other = index_of(s, p[0], p[1], p[2]);
    return true;
}

static const int face[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

static void fill_piece(struct slow *s, size_t i)
{
    size_t other;
    s->piece[i] = s->pieces;
    for (int f = 0; f < 6; f++)
        if (neighbour(s, i, face[f], &other) && s->region[other] == s->region[i] &&
            s->piece[other] < 0)
            fill_piece(s, other);
}

/* Of a piece: false, and nothing has changed, if no voxel would remain. */
static bool erode_piece(struct slow *s, int piece)
{
    bool goes[VOXELS_MOST] = {false}, is_left = false;
    for (size_t i = 0; i < s->voxels; i++) {
        size_t other;
        for (int f = 0; s->piece[i] == piece && f < 6; f++)
            goes[i] |=
                neighbour(s, i, face[f], &other) && (s->piece[other] != piece || !s->left[other]);
        is_left |= s->piece[i] == piece && s->left[i] && !goes[i];
    }
    for (size_t i = 0; is_left && i < s->voxels; i++)
        s->left[i] &= !goes[i];
    return is_left;
}

static bool on_contour(const struct slow *s, size_t i)
{
    size_t other;
    for (int z = -1; z <= 1; z++)
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++)
                if (neighbour(s, i, (const int[]){x, y, z}, &other) &&
                    (!s->left[other] || s->region[other] != s->region[i]))
                    return true;
    return false;
}

static void solve(struct slow *s, unsigned erode)
{
    s->pieces = 0;
    for (size_t i = 0; i < s->voxels; i++) {
        s->piece[i] = -1;
        s->left[i] = true;
    }
    for (size_t i = 0; i < s->voxels; i++)
        if (s->piece[i] < 0) {
            fill_piece(s, i);
            s->pieces++;
        }
    for (int p = 0; p < s->pieces; p++)
        for (unsigned round = 0; round < erode && erode_piece(s, p); round++)
            ;
}

/* ---- compared with the plain computation ---- */

static void check_pieces(const struct slow *s, const struct piece_seeds *seeds,
                         const struct grid *grid)
{
    size_t piece = 0, begin = 0;
    for (int p = 0; p < s->pieces; p++) {
        size_t first = 0, k = begin;
        while (s->piece[first] != p)
            first++;
        if (s->region[first] == REGION_NONE)
            continue;
        if (!CHECK(piece < seeds->pieces) || !CHECK(seeds->piece[piece].label == s->region[first]))
            return;
        for (size_t i = 0; i < s->voxels; i++)
            if (s->piece[i] == p && s->left[i] && on_contour(s, i) &&
                !CHECK(k < seeds->piece[piece].end && grid_voxel(grid, seeds->cell[k++]) == i))
                return;
        k += k == begin; /* one without a contour has a seed all the same */
        begin = seeds->piece[piece].end;
        CHECK_INT(k, begin);
        piece++;
    }
    CHECK_INT(piece, seeds->pieces);
}

/* Boxes over one another. */
static void paint(struct slow *s, bool with_none)
{
    for (size_t i = 0; i < s->voxels; i++)
        s->region[i] = 0;
    for (int n = (int)check_below(&seed, 9); n > 0; n--) {
        uint32_t from[3], to[3];
        const uint32_t label = check_below(&seed, 4);
        for (int a = 0; a < 3; a++) {
            from[a] = check_below(&seed, s->size[a]);
            to[a] = from[a] + check_below(&seed, s->size[a] - from[a]);
        }
        for (uint32_t z = from[2]; z <= to[2]; z++)
            for (uint32_t y = from[1]; y <= to[1]; y++)
                for (uint32_t x = from[0]; x <= to[0]; x++)
                    s->region[index_of(s, x, y, z)] =
                        (uint16_t)(with_none && label == 3 ? REGION_NONE : label);
    }
}

STORY(each_piece_is_a_marker_of_the_contour_of_what_erosion_leaves)
{
    static struct slow slow;
    for (int round = 0; round < 1500; round++) {
        struct grid grid;
        OWNED(piece_seeds_release) struct piece_seeds seeds;
        const unsigned erode = check_below(&seed, 5);
        const struct piece_choice choice = {erode, 0, REGION_NONE};
        slow.voxels = 1;
        for (int a = 0; a < 3; a++) {
            slow.size[a] = 1 + check_below(&seed, SIDE_MOST);
            slow.voxels *= slow.size[a];
        }
        CHECK(grid_init(&grid, slow.size, NULL) == OK);
        paint(&slow, round % 2);
        solve(&slow, erode);
        CHECK(piece_seeds_make(&seeds, slow.region, &grid, &choice, NULL, NULL) == OK);
        check_pieces(&slow, &seeds, &grid);
    }
}

STORY(a_row_is_eroded_from_both_ends_and_not_at_the_edge_of_the_scene)
{
    static const uint16_t row[] = {1, 1, 1, 1, 0, 0, 0, 0, 0, 2, 0};
    const uint32_t sides[3] = {11, 1, 1};
    struct grid grid;
    OWNED(piece_seeds_release) struct piece_seeds seeds;
    CHECK(grid_init(&grid, sides, NULL) == OK);
    CHECK(piece_seeds_make(&seeds, row, &grid, &(const struct piece_choice){2, 0, REGION_NONE},
                           NULL, NULL) == OK);
    CHECK_INT(seeds.pieces, 4);
    CHECK_INT(seeds.small, 2); /* the 2, and the 0 after it */
    static const uint32_t x[] = {1, 6, 9, 10};
    CHECK_INT(seeds.count, 4);
    for (size_t i = 0; i < seeds.count; i++)
        CHECK_INT(grid_voxel(&grid, seeds.cell[i]), x[i]);
    CHECK_INT(seeds.labels[0], 2);
}

STORY(all_labels_beside_regions_that_are_not_chosen_are_refused)
{
    static const struct piece_choice whole = {0, 0, REGION_NONE};
    uint16_t row[257];
    const uint32_t sides[3] = {257, 1, 1};
    struct grid grid;
    struct piece_seeds seeds;
    CHECK(grid_init(&grid, sides, NULL) == OK);
    for (uint32_t i = 0; i < 257; i++)
        row[i] = (uint16_t)(i & 255);
    CHECK(piece_seeds_make(&seeds, row, &grid, &whole, NULL, NULL) == OK);
    CHECK_INT(seeds.pieces, 257);
    piece_seeds_release(&seeds);
    row[256] = REGION_NONE;
    CHECK(piece_seeds_make(&seeds, row, &grid, &whole, NULL, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "choose fewer");
}

/* ---- in a session ---- */

static uint8_t painted[12 * 11 * 10];
static void painted_row(void *context, uint32_t y, uint32_t z, void *values)
{
    (void)context;
    memcpy(values, painted + size[0] * (y + size[1] * z), size[0]);
}

static void write_painted(const char *name)
{
    write_map(name, size, VOXEL_UINT8, painted_row, NULL);
}

static void paint_map(void)
{
    for (size_t i = 0; i < sizeof painted; i++) {
        const size_t x = i % 12, y = i / 12 % 11, z = i / 132;
        painted[i] = (uint8_t)(x > 2 && x < 9 && y > 1 && y < 9 && z > 1 && z < 8
                                   ? (x == 6 && y == 5 && z == 5 ? 3 : 1)
                               : x > 9 && y > 3 ? 2
                                                : 0);
    }
}

static size_t differing(const struct session *session)
{
    size_t count = 0, i = 0;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++, i++)
                count += session->scene->cell[grid_cell(&session->scene->grid, x, y, z)].label !=
                         painted[i];
    return count;
}

static void must_in_folder(struct interpreter *interp, const char *command, const char *name,
                           const char *rest)
{
    char line[PATH_MAX + 64];
    snprintf(line, sizeof line, "%s %s %s", command, place(name), rest);
    must(interp, line);
}

STORY(without_erosion_the_segmentation_comes_out_again)
{
    struct interpreter interp;
    for (int corners = 0; corners < 2; corners++) {
        begin_with_scene(&interp);
        paint_map();
        write_painted("map.nii");
        must(&interp, corners ? "adjacency 26" : "adjacency 6");
        must(&interp, "auto on");
        must_in_folder(&interp, "labels", "map.nii", "erode=0");
        CHECK_HAS(buf_text(&reply.text), "label 2 cerebellum: 1 marker\n");
        CHECK_INT(differing(interp.session), 0);
        CHECK(forest_seeds(interp.session->forest) < interp.session->scene->grid.voxels);
        must_leave_seeds(&interp, "undo", 0); /* as one */
        interpreter_release(&interp);
    }
}

SCENE_STORY(a_piece_is_removed_and_grown_into_as_one)
{
    paint_map();
    write_painted("map.nii");
    must(interp, "auto on");
    must_in_folder(interp, "labels", "map.nii", "erode=2");
    CHECK_HAS(buf_text(&reply.text), "2 pieces too small");
    const struct grid *grid = &interp->session->scene->grid;
    CHECK_INT(interp->session->scene->cell[grid_cell(grid, 6, 5, 5)].label, 3);
    must(interp, "remove 6,5,5");
    CHECK(interp->session->scene->cell[grid_cell(grid, 6, 5, 5)].label != 3);
    must_in_folder(interp, "labels", "map.nii", "regions=1 as=7 erode=1");
    CHECK_INT(interp->session->scene->cell[grid_cell(grid, 5, 4, 4)].label, 7);
    must_in_folder(interp, "labels", "map.nii", "label=9");
    CHECK_INT(interp->session->scene->cell[grid_cell(grid, 5, 4, 4)].label, 9);
    CHECK_INT(interp->session->scene->cell[grid_cell(grid, 0, 0, 0)].label, 0);
}

/* ---- corrections ---- */

/* Label 1 leaks over the scene's edge at x = 6, up to x = 8. Label 2 lies behind it, and label 3 is
 * a block in the leak. */
static void paint_leak(void)
{
    for (size_t i = 0; i < sizeof painted; i++) {
        const size_t x = i % 12, y = i / 12 % 11, z = i / 132;
        painted[i] = (uint8_t)(x > 8 ? 2 : x > 5 && y > 6 && z > 6 ? 3 : 1);
    }
}

static const struct cell *at_voxel(const struct interpreter *interp, uint32_t x, uint32_t y,
                                   uint32_t z)
{
    const struct session *session = interp->session;
    return session->scene->cell + grid_cell(&session->scene->grid, x, y, z);
}

static void begin_leaking(struct interpreter *interp)
{
    begin_interpreter(interp);
    open_scene(interp, "scene.nii");
    paint_leak();
    write_painted("leak.nii");
    must(interp, "auto on");
    must_in_folder(interp, "labels", "leak.nii", "erode=0");
}

BEGUN_STORY(a_correction_moves_the_border_of_a_file, begin_leaking)
{
    uint64_t digest;
    CHECK_INT(differing(interp->session), 0);
    digest = forest_digest(interp->session->forest);
    must(interp, "seed 7,4,3 2");
    CHECK_INT(at_voxel(interp, 8, 4, 3)->label, 2);
    CHECK_INT(at_voxel(interp, 8, 4, 3)->flags & CELL_SEED, 0);
    CHECK_INT(at_voxel(interp, 9, 4, 3)->flags & CELL_SEED, CELL_SEED); /* of its own label */
    CHECK_INT(at_voxel(interp, 8, 8, 3)->label, 1);                     /* four voxels away */
    must(interp, "remove 7,4,3");
    CHECK(forest_digest(interp->session->forest) == digest);
    must(interp, "undo");
    CHECK_INT(at_voxel(interp, 8, 4, 3)->label, 2);
    must(interp, "undo");
    CHECK(forest_digest(interp->session->forest) == digest);
    must(interp, "box 6,1,2 7,3,4 2");
    CHECK_INT(at_voxel(interp, 8, 2, 3)->label, 2);
    must(interp, "undo; fill 7,1,1 2 to=7,4,1 to=7,4,4");
    CHECK_INT(at_voxel(interp, 8, 3, 2)->label, 2);
    must(interp, "undo");
    CHECK(forest_digest(interp->session->forest) == digest);
    must(interp, "seed 7,4,3 2 within=4");
    CHECK_INT(at_voxel(interp, 8, 6, 3)->flags & CELL_SEED, 0);
    must(interp, "undo; seed 7,4,3 1 radius=1"); /* the label that it has */
    CHECK_INT(at_voxel(interp, 8, 4, 3)->label, 1);
    CHECK_INT(at_voxel(interp, 9, 5, 3)->flags & CELL_SEED, CELL_SEED);
}

BEGUN_STORY(what_belongs_to_third_labels_does_not_give_way, begin_leaking)
{
    must(interp, "seed 7,5,7 2 radius=1"); /* in 1, next to 3 */
    CHECK_INT(at_voxel(interp, 8, 6, 8)->flags & CELL_SEED, 0);
    CHECK_INT(at_voxel(interp, 8, 7, 8)->flags & CELL_SEED, CELL_SEED);
    CHECK_INT(at_voxel(interp, 8, 8, 7)->label, 3);
    must(interp, "seed 7,7,7 2"); /* in 3 itself */
    CHECK_INT(at_voxel(interp, 8, 7, 8)->flags & CELL_SEED, 0);
}

BEGUN_STORY(a_file_decides_in_all_of_its_pieces_and_regions_left_out_take_nothing, begin_leaking)
{
    must(interp, "undo; seed 3,4,4 7 radius=1"); /* within what will be label 1 */
    must_in_folder(interp, "labels", "leak.nii", "");
    CHECK_INT(differing(interp->session), 0);
    must(interp, "undo 2");
    must_in_folder(interp, "labels", "leak.nii", "regions=3 as=5");
    CHECK_INT(at_voxel(interp, 7, 8, 8)->label, 5);
    CHECK_INT(at_voxel(interp, 0, 0, 0)->label, 0);
    must_in_folder(interp, "labels", "leak.nii", "regions=2 as=6");
    CHECK_INT(at_voxel(interp, 7, 8, 8)->label, 5);
    CHECK_INT(at_voxel(interp, 8, 8, 8)->label, 5); /* next to label 6 */
    CHECK_INT(at_voxel(interp, 9, 8, 8)->label, 6);
    CHECK_INT(at_voxel(interp, 8, 4, 4)->label, 0);
}

/* Any command of a session that begins with a file. */
static const char any[] =
    "seed X,Y,Z <4> radius=<3>; seed X,Y,Z <4> radius=<3>; seed X,Y,Z <4> radius=<3>; "
    "seed X,Y,Z <4> radius=<3>; seed X,Y,Z <4> to=U,V,W; box X,Y,Z U,V,W <4>; "
    "fill X,Y,Z <4> to=X,V,Z to=X,V,W; outline X,Y,Z <4> to=X,V,Z to=X,V,W; "
    "seed X,Y,Z <4> within=<1-4>; labels leak.nii erode=<2>; remove X,Y,Z; remove X,Y,Z of=tree; "
    "[undo|undo 2|redo|redo 3|goto main]; [undo|undo 2|redo|redo 3|goto main]; "
    "[undo|undo 2|redo|redo 3|goto main]";

/* Compares with a new session that carries out the commands up to the current state. */
static void same_from_scratch(const struct interpreter *interp)
{
    OWNED(interpreter_release) struct interpreter other;
    uint32_t way[64];
    size_t count = 0;
    const struct history *history = &interp->history;
    for (uint32_t p = history->present; p != 0; p = history->point[p].parent)
        way[count++] = p;
    begin_interpreter(&other);
    open_scene(&other, "scene.nii");
    must(&other, "auto on");
    while (count-- > 0)
        must(&other, history->point[way[count]].command);
    CHECK_INT(forest_seeds(other.session->forest), forest_seeds(interp->session->forest));
    CHECK(forest_digest(other.session->forest) == forest_digest(interp->session->forest));
}

STORY(what_gives_way_is_a_function_of_the_commands_that_stand)
{
    struct interpreter interp;
    paint_leak();
    write_painted("leak.nii");
    for (int round = 0; round < 40 && check_failures < 5; round++) {
        char line[PATH_MAX];
        begin_with_journal(&interp, "leak.iftty");
        interp.sync = FILE_SYNC_OFF;
        must(&interp, "auto on");
        must_in_folder(&interp, "labels", "leak.nii", "");
        for (int i = 0; i < 30; i++) {
            for (uint32_t pen = check_below(&seed, 3); pen > 0; pen--) { /* which leaves nothing */
                snprintf(line, sizeof line, "seed %u,4,5 2 radius=1", check_below(&seed, 12));
                CHECK(interpreter_sketch(&interp, line, NULL) == OK);
            }
            random_command(line, sizeof line, random_form(any, &seed), size, &seed);
            if (execute(&interp, line) == OK && i % 3 == 0)
                same_from_scratch(&interp);
        }
        CHECK(forest_check(interp.session->forest, NULL));
        const uint64_t digest = forest_digest(interp.session->forest);
        resume_journal(&interp, "leak.iftty");
        CHECK(forest_digest(interp.session->forest) == digest);
        execute(&interp, "undo");
        same_from_scratch(&interp);
        interpreter_release(&interp);
        verify_journal("leak.iftty");
    }
}

/* ---- objects ---- */

/* A floor of 3x + 2y + z, 60 more for x > 5, 90 more for y > 6 and z > 4. */
static bool is_bright(uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t value = 3 * x + 2 * y + z + (x > 5 ? 60 : 0) + (y > 6 && z > 4 ? 90 : 0);
    return value >= 100 && value <= 255;
}

static size_t seeds_of(const struct session *session, uint8_t label)
{
    size_t count = 0;
    for (uint32_t c = 0; c < session->scene->grid.cells; c++)
        count +=
            session->scene->cell[c].flags & CELL_SEED && session->scene->cell[c].label == label;
    return count;
}

SCENE_STORY(an_object_is_what_hangs_together_with_a_seed_within_the_range)
{
    size_t expected = 0;
    must(interp, "auto on");
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++)
                expected += is_bright(x, y, z);
    MUST_FAIL(interp, "object 2 threshold 100..255", ERR_INPUT,
              "no seed of label 2 is in a voxel of this range");
    MUST_FAIL(interp, "object 2 threshold 100..255 from=0,0,0", ERR_INPUT,
              "voxel 0,0,0 has the intensity 0, beyond the range");
    must(interp, "object 2 threshold 100..255 from=11,10,9");
    char words[64];
    snprintf(words, sizeof words, "%zu voxels of label 2 cerebellum\n", expected);
    CHECK_HAS(buf_text(&reply.text), words);
    CHECK_INT(seeds_of(interp->session, 2), expected);
    CHECK_HAS(buf_text(&reply.words), "marker=1");
    CHECK_HAS(buf_text(&reply.text),
              "nothing holds label 2 cerebellum back, and a run grows it over all of the scene\n");
    MUST_MENTION(interp, "undo; range 100 255; object 2 threshold 100..255 from=11,10,9",
                 "all of the region of interest\n");
    must_leave_seeds(interp, "undo 2", 0);
    must(interp, "seed 11,10,9 2; object 2 threshold 100..255");
    CHECK_INT(seeds_of(interp->session, 2), expected);
}

SCENE_STORY(seeds_of_another_label_stay_and_let_nothing_through)
{
    must(interp, "auto on; box 3,0,0 3,10,9 1");
    must(interp, "seed 0,0,0 2"); /* everything with x < 3 and x > 3 lies in the range */
    must(interp, "object 2 threshold 0..1000");
    CHECK(!strstr(buf_text(&reply.text), "nothing holds"));
    CHECK_INT(seeds_of(interp->session, 2), 3 * 11 * 10);
    CHECK_INT(seeds_of(interp->session, 1), 11 * 10);
    must(interp, "object 1 threshold 0..1000 from=9,9,9"); /* which has a range of its own */
    CHECK_INT(seeds_of(interp->session, 1), 9 * 11 * 10);
}

SCENE_STORY(edits_that_wait_count_as_seeds)
{
    must(interp, "seed 1,1,1 2; object 2 threshold 0..8.5");
    const size_t waits = session_pendings(interp->session);
    must_leave_seeds(interp, "run", waits - 1); /* one of them twice */
    must(interp, "seed 9,9,9 0");               /* a pending marker limits an object, too */
    must(interp, "object 2 threshold 0..8.5");
    CHECK(!strstr(buf_text(&reply.text), "nothing holds"));
}
