/* SPDX-License-Identifier: MIT */
/* Markers through whole sessions: balls, strokes and their parts, boxes, polygons and outlines;
 * overlaps, erasers, undo, redo, visits to earlier states, branches, restarts and replays.
 *
 * The model shares no code with the program. It has a list of all markers ever placed, each with
 * its voxels and label; a state is the list of the active ones, one for each record. The seeds of
 * a state are the result of carrying those out in order. From the program the model takes the
 * record that it went to (at=), and the seed whose tree holds a voxel. */
#include "tests/paint_model.h"
#include "tests/random_commands.h"
#include "tests/scene_main.h"
#include "tests/stopping.h"

enum { CELLS = 14 * 13 * 12, PUT_MOST = 400, RECORDS_MOST = 600, COMMANDS = 10, LINE = 400 };

static struct put {
    int16_t label; /* or EDIT_ERASE */
    bool joined;   /* it continues the previous one */
    bool covers[CELLS];
} put[PUT_MOST];
static size_t put_count;

struct standing {
    bool has[PUT_MOST];
};
static struct standing state_after[RECORDS_MOST];

static struct interpreter interp;
DRAW_FROM(2006)

/* ---- the model ---- */

static void seeds_of(const struct standing *state, int16_t label[CELLS], uint32_t owner[CELLS])
{
    for (size_t c = 0; c < CELLS; c++) {
        label[c] = EDIT_ERASE;
        owner[c] = PUT_MOST;
    }
    for (uint32_t i = 0; i < put_count; i++)
        for (size_t c = 0; state->has[i] && c < CELLS; c++)
            if (put[i].covers[c]) {
                label[c] = put[i].label;
                owner[c] = i;
            }
}

static void planted_as(const struct standing *state, const char *when)
{
    int16_t label[CELLS];
    uint32_t owner[CELLS];
    bool same = true;
    seeds_of(state, label, owner);
    for (uint32_t c = 0; c < CELLS; c++) {
        const struct cell *cell = interp.session->scene->cell + c;
        same &= label[c] == (cell->flags & CELL_SEED ? cell->label : EDIT_ERASE);
    }
    CHECK_WITH(same, "after %s", when);
}

static void put_up(int16_t label, struct standing *state)
{
    put[put_count].label = label;
    put[put_count].joined = false;
    memset(put[put_count].covers, 0, sizeof put[put_count].covers);
    state->has[put_count++] = true;
}

/* Of the last marker, removes voxels whose intensity is not from low to high. False if none
 * remains. */
static bool sift(uint32_t low, uint32_t high)
{
    bool any = false;
    for (size_t c = 0; c < CELLS; c++) {
        const uint32_t value = interp.session->scene->cell[c].intensity;
        put[put_count - 1].covers[c] &= value >= low && value <= high;
        any |= put[put_count - 1].covers[c];
    }
    return any;
}

/* A marker goes, with all that is joined to it. */
static void leave(struct standing *state, uint32_t first)
{
    uint32_t last = first;
    while (put[first].joined)
        first--;
    while (last + 1 < put_count && put[last + 1].joined)
        last++;
    for (uint32_t i = first; i <= last; i++)
        state->has[i] = false;
}

/* Which seed's tree holds a voxel, by the program; the rest by the model. */
static void take_away(struct standing *state, uint32_t cell, bool tree)
{
    int16_t label[CELLS];
    uint32_t owner[CELLS];
    const uint32_t root = key_root(interp.session->scene->cell[cell].key);
    seeds_of(state, label, owner);
    if (tree) {
        put_up(EDIT_ERASE, state);
        put[put_count - 1].covers[root] = true;
    } else {
        leave(state, owner[root]);
    }
}

/* ---- sessions ---- */

static struct standing now;
static bool has_just_planted; /* one marker, by the command before */

/* In addition to a polygon, an outline takes the place of a marker and has a ring that cuts other
 * objects. */
static void go_around(char *end, struct standing *state, corners_of corner, size_t corners)
{
    const struct scene *scene = interp.session->scene;
    const int16_t label = put[put_count - 1].label;
    const uint32_t former = below((uint32_t)put_count), width = below(5);
    int16_t seed_label[CELLS];
    uint32_t owner[CELLS];
    bool any = false;
    if (former + 1 < put_count && state->has[former] && put[former].label != EDIT_ERASE) {
        end += sprintf(end, " instead=%u", former + 1);
        leave(state, former);
    }
    if (label)
        end += width == 3 ? 0 : sprintf(end, " ring=%u", width);
    seeds_of(state, seed_label, owner);
    put_up(0, state);
    put[put_count - 1].joined = true;
    bool *covers = put[put_count - 1].covers;
    if (label)
        model_ring(covers, &scene->grid, corner, corners, (int)width);
    for (size_t c = 0; c < CELLS; c++) {
        const int16_t holds = seed_label[c] == EDIT_ERASE ? scene->cell[c].label : seed_label[c];
        covers[c] &= holds == 0 || holds == label;
        any |= covers[c];
    }
    put_count -= !any;
    state->has[put_count] &= any;
}

/* A way to plant, as a line and by the model. False where it would plant nothing. */
static bool plant(char line[LINE], struct standing *state)
{
    static const uint32_t ones[3] = {1, 1, 1}, spacing_nm[3] = {1000000, 1500000, 2000000};
    const struct grid *grid = &interp.session->scene->grid;
    const unsigned way = below(7), label = below(4),
                   corners = way >= 5 ? 3 + below(5) : 1 + below(5);
    const int axis = (int)below(3);
    uint32_t at[8][3];
    char *end = line;
    put_up((int16_t)label, state);
    bool *covers = put[put_count - 1].covers;
    for (unsigned i = 0; i < corners; i++)
        for (int a = 0; a < 3; a++)
            at[i][a] = way >= 5 && a == axis && i > 0 ? at[0][a] : below(size[a]);
    const char *name = way < 4 ? "seed" : way == 4 ? "box" : way == 5 ? "fill" : "outline";
    end += sprintf(end, "%s %u,%u,%u ", name, at[0][0], at[0][1], at[0][2]);
    if (way == 4) {
        model_box(covers, grid, at[0], at[corners - 1]);
        end +=
            sprintf(end, "%u,%u,%u ", at[corners - 1][0], at[corners - 1][1], at[corners - 1][2]);
    }
    end += sprintf(end, "%u", label);
    if (way >= 5) {
        model_polygon(covers, grid, (corners_of)at, corners, axis);
    } else if (way < 4) {
        const unsigned radius = below(3), um = 1 + below(3200);
        if (way == 0)
            end += sprintf(end, " radius=%u.%03umm", um / 1000, um % 1000);
        else
            end += sprintf(end, " radius=%u", radius);
        model_stroke(covers, grid, (corners_of)at, corners, way ? ones : spacing_nm,
                     way ? radius : 1000 * um);
        if (way && corners == 1 && below(3) == 0) {
            sprintf(end, " within=%u", radius + 1 + below(4));
            return true; /* which the model does not know: the seeds are the same */
        }
    }
    for (unsigned i = 1; i < corners && way != 4; i++)
        end += sprintf(end, " to=%u,%u,%u", at[i][0], at[i][1], at[i][2]);
    if (way < 4 && has_just_planted && put_count > 1 && put[put_count - 2].label == (int)label &&
        below(2)) {
        put[put_count - 1].joined = true;
        end += sprintf(end, " joined=yes");
    }
    bool any = true;
    if (below(3) == 0) {
        const uint32_t low = below(150), high = low + below(100);
        end += sprintf(end, " range=%u.0..%u", low, high);
        any = sift(low, high);
    }
    if (way == 6 && any)
        go_around(end, state, (corners_of)at, corners);
    return any;
}

/* What a pen may draw and the next command cannot find. */
static void sketch(void)
{
    char line[LINE];
    for (uint32_t n = below(4) ? 0 : 1 + below(3); n > 0; n--) {
        snprintf(line, sizeof line, "seed %u,%u,%u %u radius=%u", below(size[0]), below(size[1]),
                 below(size[2]), below(4), below(3));
        CHECK(interpreter_sketch(&interp, line, NULL) == OK);
    }
}

static void do_one(char line[LINE])
{
    const uint32_t at[3] = {below(size[0]), below(size[1]), below(size[2])};
    const uint32_t cell = grid_cell(&interp.session->scene->grid, at[0], at[1], at[2]);
    struct record_word word;
    const unsigned what = below(10);
    const size_t before = put_count;
    struct standing next = now;
    if (what < 5) {
        if (!plant(line, &next)) {
            CHECK(execute(&interp, line) != OK);
            put_count = before;
            return;
        }
        sketch();
    } else if (what < 8) {
        if (!cell_is_reached(interp.session->scene->cell + cell))
            return;
        const bool tree = what == 7;
        snprintf(line, LINE, "remove %u,%u,%u%s", at[0], at[1], at[2], tree ? " of=tree" : "");
        take_away(&next, cell, tree);
    } else {
        const char *const ways[] = {"undo", "undo 3", "redo", "redo 2", "goto main", "goto"};
        const char *way = ways[below(6)];
        snprintf(line, LINE, "%s", way);
        if (strcmp(way, "goto") == 0)
            snprintf(line, LINE, "goto %u", 5 + below((uint32_t)interp.history.records - 4));
    }
    const enum err err = execute(&interp, line);
    /* Corners that go nowhere but ahead are no polygon. */
    if (err && (what >= 8 ||
                ((*line == 'f' || *line == 'o') && strstr(fault.text, "three corners or more")))) {
        put_count = before;
        return; /* nothing to undo or to do again */
    }
    CHECK_WITH(err == OK, "%s: %s", line, fault.text);
    if (record_word_find(buf_text(&reply.words), "at", 2, &word))
        now = state_after[strtoul(word.value, NULL, 10)];
    else
        now = next;
    has_just_planted = what < 5 && put_count == before + 1;
    state_after[interp.history.records] = now;
}

static void begin(void)
{
    begin_with_journal(&interp, "markers.iftty");
    interp.sync = FILE_SYNC_OFF;
    must(&interp, "auto on; size 16 16; label 1 one; label 2 two");
    put_count = 0;
    now = (struct standing){{0}};
    for (size_t i = 0; i <= interp.history.records; i++)
        state_after[i] = now;
}

/* A session that resumes the journal has the same seeds and goes to the same states. */
static void restart(void)
{
    char line[LINE];
    resume_journal(&interp, "markers.iftty");
    planted_as(&now, "a restart");
    has_just_planted = false;
    for (int i = 0; i < 3; i++)
        do_one(line);
    planted_as(&now, line);
}

STORY(seeds_are_what_the_commands_that_stand_give)
{
    const int rounds = (int)check_scaled(25);
    char line[LINE] = "";
    for (int i = 0; i < rounds && check_failures < 5; i++) { /* each of 40 sessions */
        begin();
        for (int k = 0; k < 40 && check_failures < 5; k++) {
            must(&interp, "goto 5"); /* with no seed */
            has_just_planted = false;
            now = state_after[5];
            state_after[interp.history.records] = now;
            for (int n = 0; n < COMMANDS && put_count < PUT_MOST - 2; n++) {
                do_one(line);
                planted_as(&now, line);
            }
            if (put_count >= PUT_MOST - 2)
                break;
        }
        CHECK(forest_check(interp.session->forest, NULL));
        restart();
        interpreter_release(&interp);
        if (i % 5 == 0)
            verify_journal("markers.iftty");
    }
}

/* ---- label maps, regions of interest and corrections, in any order ---- */

/* A command that may be refused because the region of interest leaves no voxel, or would leave a
 * seed outside. A third of them change the region or plant the voxels of a map. */
static void draw_command(char line[LINE])
{
    static const char forms[] =
        "labels regions.nii[ regions=1-2|][ erode=0|]; "
        "labels regions.nii[ regions=1-2|][ erode=0|]; range <60> <61-140>; "
        "range <60-159> <160-310>; range <160> <190-340>; range none; mask mask.nii[ regions=1|]; "
        "mask mask.nii[ regions=1|]; mask none; box X,Y,Z U,V,W <3>; "
        "outline X,Y,Z <3> to=U,Y,Z to=X,V,Z; remove X,Y,Z[|| of=tree]; undo <1-4>; redo <1-3>; "
        "[run|auto on|run|auto off]; goto; seed X,Y,Z <3> radius=<4>[||| within=4]; "
        "seed X,Y,Z <3> radius=<4>[||| within=4]; seed X,Y,Z <3> radius=<4>[||| within=4]";
    /* Commands that the model above lacks, and changes of weights or adjacency. */
    static const char more[] =
        "fill X,Y,Z <3> to=X,V,Z to=X,Y,W; seed X,Y,Z <3> radius=<3> to=U,V,W[ joined=yes|]; "
        "seed X,Y,Z <3> radius=1 joined=yes; seed X,Y,Z <3> shell=yes radius=<1-5>[ around=1|]; "
        "box X,Y,Z U,V,W <3> shell=yes; object <3> threshold <80>..<80-159>[| from=3,5,3]; "
        "object <3> threshold <80-160>..<161-240>[| from=3,5,3]; "
        "seed-file regions.nii each=<1-9> generator=<9>[ erode=1| label=2]; adjacency [6|26]; "
        "[weight polarity|weight morph|polarity 1 50]";
    const char *form = below(5) ? random_form(forms, &seed) : random_form(more, &seed);
    if (strcmp(form, "goto") == 0) /* any record, up to the last */
        snprintf(line, LINE, "goto %u", below((uint32_t)interp.history.records + 1));
    else
        random_command(line, LINE, form, size, &seed);
}

STORY(maps_regions_and_corrections_come_in_any_order)
{
    const int rounds = (int)check_scaled(40);
    char line[LINE];
    unsigned refused = 0, carried_out = 0;
    make_regions("regions.nii", size[0], 0);
    make_weights("mask.nii", 0); /* 0 in one voxel of forty: holes in every piece */
    for (int i = 0; i < rounds && check_failures < 5; i++) {
        struct snapshot before, after;
        begin_with_journal(&interp, "order.iftty");
        must(&interp, "auto on");
        for (int n = 0; n < 40 && check_failures < 5; n++) {
            draw_command(line);
            take_snapshot(&before, &interp);
            if (execute(&interp, line) == OK) {
                take_snapshot(&after, &interp);
                carried_out++;
            } else {
                CHECK(is_plain(fault.text));
                is_as_before(&before, &interp, line);
                refused++;
            }
            if (check_failures)
                printf("#   round %d, after %s\n", i, line);
        }
        CHECK(forest_check(interp.session->forest, NULL));
        take_snapshot(&before, &interp);
        resume_journal(&interp, "order.iftty");
        is_segmented_as(&before, &interp);
        interpreter_release(&interp);
        verify_journal("order.iftty");
    }
    CHECK(refused * 10 > carried_out && carried_out > refused);
}

/* 1 everywhere but in the voxel 3,5,3. */
static void hole_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint8_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < size[0]; x++)
        *at++ = !(x == 3 && y == 5 && z == 3);
}

STORY(no_removal_brings_a_seed_back_outside_the_region)
{
    write_map("hole.nii", size, VOXEL_UINT8, hole_row, NULL);
    make_regions("regions.nii", size[0], 0);
    begin_with_scene(&interp);
    must(&interp, "auto on; labels regions.nii erode=0");
    must(&interp, "seed 3,5,5 2 radius=1"); /* 3,5,3 was a seed of label 1, and is free */
    must(&interp, "mask hole.nii");
    is_refused(&interp, "remove 3,5,5",
               "voxel 3,5,3 would get a seed of label 1, and it is outside");
    must(&interp, "mask none; remove 3,5,5");
    interpreter_release(&interp);
}

/* Labels of a file that were undone cover voxels of the grid before. */
STORY(no_seed_frees_pieces_of_the_scene_before_it_was_interpolated)
{
    static const char *const corrections[] = {"seed 3,5,5 2 radius=2", "box 0,0,0 12,4,9 2",
                                              "remove 3,5,5"};
    int looks, stopped = 0;
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
    struct snapshot plain, after;
    make_regions("regions.nii", size[0], 0);
    for (int has_pieces = 0; has_pieces < 2; has_pieces++) {
        begin_with_journal(&interp, "finer.iftty");
        must(&interp, "auto on");
        if (has_pieces) {
            must(&interp, "labels regions.nii; undo");
        }
        interp.session->watch = &watch;
        for (looks = stopped; execute(&interp, "interpolate 2 1 1") != OK; looks = ++stopped)
            CHECK(interp.session->markers.former == 0); /* they are those of the scene still */
        interp.session->watch = interp.session->scene->watch = NULL;
        CHECK(stopped > 20);
        for (size_t i = 0; i < sizeof corrections / sizeof *corrections; i++)
            must(&interp, corrections[i]);
        take_snapshot(has_pieces ? &after : &plain, &interp);
        interpreter_release(&interp);
        verify_journal("finer.iftty");
        stopped = 0;
    }
    CHECK(after.forest == plain.forest && after.labels == plain.labels);
    CHECK(after.seeds == plain.seeds && after.pendings == plain.pendings);
}

/* ---- exact gestures ---- */

static uint8_t region_at[CELLS];

/* A map of random boxes in one of the labels 0 to 5: few and large ones have voxels that are no
 * seeds. */
static void write_random_map(void)
{
    memset(region_at, (int)below(6), sizeof region_at);
    for (uint32_t left = below(2) ? 2 : 12; left > 0; left--) {
        const uint32_t a[3] = {below(size[0]), below(size[1]), below(size[2])},
                       b[3] = {below(size[0]), below(size[1]), below(size[2])};
        bool covers[CELLS] = {false};
        const uint8_t label = (uint8_t)below(6);
        struct grid grid;
        CHECK(grid_init(&grid, size, NULL) == OK);
        model_box(covers, &grid, a, b);
        for (size_t c = 0; c < CELLS; c++)
            region_at[c] = covers[c] ? label : region_at[c];
    }
}

static void map_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint8_t *at = values;
    struct grid grid;
    (void)context;
    CHECK(grid_init(&grid, size, NULL) == OK);
    for (uint32_t x = 0; x < size[0]; x++)
        *at++ = region_at[grid_cell(&grid, x, y, z)];
}

static void copy_labels(uint8_t label[CELLS])
{
    for (size_t c = 0; c < CELLS; c++)
        label[c] = interp.session->scene->cell[c].label;
}

/* The gesture of the last line changed the voxels of its markers to their label, and no others. */
static void changes_its_voxels(const char *line, const uint8_t before[CELLS])
{
    const struct session *session = interp.session;
    const struct markers *markers = &session->markers;
    const char *over = strstr(line, "over="), *keep = strstr(line, "keep=");
    uint8_t expected[CELLS];
    bool fits = true;
    if (strncmp(line, "between", 7) == 0 && !over && !keep)
        over = "0";
    memcpy(expected, before, CELLS);
    for (size_t m = session->former_markers; m < markers->count; m++)
        for (size_t i = 0; i < markers->marker[m].voxels; i++) {
            const uint32_t cell = markers->cover[markers->marker[m].first + i].cell;
            expected[cell] = (uint8_t)markers->marker[m].label;
            fits &= !over || strchr(over, '0' + before[cell]);
            fits &= !keep || !strchr(keep, '0' + before[cell]);
        }
    for (size_t c = 0; c < CELLS; c++)
        fits &= session->scene->cell[c].label == expected[c];
    CHECK_WITH(fits, "after %s", line);
}

STORY(exact_gestures_change_only_voxels_that_they_name)
{
    static uint8_t after[RECORDS_MOST][CELLS];
    static const char forms[] =
        "seed X,Y,Z <6> radius=<4> within=0[| over=0,1,2| keep=3,4]; "
        "seed X,Y,Z <6> radius=<2> to=U,V,W within=0[| keep=2]; box X,Y,Z U,V,W <6> within=0; "
        "box X,Y,Z U,V,W <6> within=0[ over=1,5| keep=0]; "
        "seed X,Y,Z <6> shell=yes radius=<1-4> within=0[| around=<6>]; "
        "box X,Y,Z U,V,W <6> shell=yes around=<6> within=0; "
        "outline X,Y,Z <6> to=U,Y,Z to=X,V,Z within=0[| over=0,2| ring=1]; "
        "fill X,Y,Z <6> to=X,V,Z to=X,Y,W within=0; "
        "object <6> threshold <80>..<80-240> from=X,Y,Z within=0[| over=0,1,4]; "
        "seed-file regions.nii[ within=0 over=0,3| within=0 each=5]; "
        "seed X,Y,Z <6> radius=<1-3> over=[0,1|2,3,4|5]; seed X,Y,Z <6> over=[0|1,2] within=<6>; "
        "seed X,Y,Z <6> radius=<1-3> keep=[0|1,2,3]; undo <1-4>; redo <1-3>; goto; run; "
        "finish [relax|none]; adjacency [6|26]";
    /* Outlines of two planes, and the slices between them. */
    static const char outlines[] =
        "outline X,Y,Z 1 to=U,Y,Z to=X,V,Z within=0; fill X,Y,Z 1 to=U,Y,Z to=U,V,Z within=0; "
        "fill X,Y,Z 2 to=X,Y,W to=X,V,W within=0; fill X,Y,Z <1-2> to=U,Y,Z to=U,Y,W within=0; "
        "outline X,Y,Z 1 to=U,Y,Z to=X,V,Z within=0; fill X,Y,Z 2 to=X,V,Z to=X,Y,W within=0; "
        "between <1-2>; between 1 plane=axial[| over=0,3,4,5| keep=3]; between 1 plane=axial "
        "keep=1; "
        "between 2 plane=sagittal keep=[2|0]; between <1-2> plane=coronal over=[1,2|0,3,4,5]; "
        "seed X,Y,Z <6> radius=<3> within=0; undo <1-2>; redo; goto; finish [relax|none]; "
        "seed X,Y,Z <6> radius=2 over=[0|1,2]";
    const int rounds = (int)check_scaled(60);
    unsigned gestures = 0, fillings = 0;
    struct record_word word;
    char line[LINE], threads[2] = "1";
    make_regions("regions.nii", size[0], 0);
    CHECK(chdir(folder) == 0);
    for (int i = 0; i < rounds && check_failures < 5; i++) {
        struct snapshot whole, resumed;
        threads[0] = (char)('1' + i / 3 % 3);
        setenv("IFTTY_THREADS", threads, 1);
        write_random_map();
        write_map("map.nii", size, VOXEL_UINT8, map_row, NULL);
        begin_with_journal(&interp, "exact.iftty");
        must(&interp, "auto on");
        if (i % 4 == 3) { /* objects that were grown, and then frozen */
            uint8_t grown[CELLS];
            for (int n = 0; n < 6; n++) {
                random_command(line, LINE, "seed X,Y,Z <6> radius=<3>", size, &seed);
                must(&interp, line);
            }
            copy_labels(grown);
            must(&interp, "labels here");
            copy_labels(after[0]);
            CHECK(memcmp(grown, after[0], CELLS) == 0);
        } else {
            must(&interp, i % 4 ? "labels map.nii erode=0" : "labels map.nii");
        }
        const size_t first = interp.history.records;
        copy_labels(after[first]);
        for (int n = 0; n < 60 && check_failures < 5; n++) {
            uint8_t before[CELLS];
            const char *form = random_form(i % 3 == 2 ? outlines : forms, &seed);
            if (strcmp(form, "goto") == 0)
                snprintf(line, LINE, "goto %zu",
                         first + below((uint32_t)(interp.history.records - first)));
            else
                random_command(line, LINE, form, size, &seed);
            copy_labels(before);
            if (execute(&interp, line) != OK)
                continue;
            if (record_word_find(buf_text(&reply.words), "at", 2, &word)) {
                const size_t at = strtoul(word.value, NULL, 10);
                copy_labels(after[interp.history.records]);
                CHECK(at < first || memcmp(after[interp.history.records], after[at], CELLS) == 0);
                snprintf(line, LINE, "goto %zu", first);
                if (at < first)
                    must(&interp, line);
            } else {
                changes_its_voxels(line, before);
                gestures++;
                fillings += strncmp(line, "between", 7) == 0;
            }
            copy_labels(after[interp.history.records]);
            if (check_failures)
                printf("#   round %d, after %s\n", i, line);
        }
        CHECK(forest_check(interp.session->forest, NULL));
        take_snapshot(&whole, &interp);
        resume_journal(&interp, "exact.iftty");
        take_snapshot(&resumed, &interp);
        is_same_segmentation(&whole, &resumed);
        interpreter_release(&interp);
        verify_journal("exact.iftty");
    }
    unsetenv("IFTTY_THREADS");
    printf("# %u exact gestures, %u between outlines\n", gestures, fillings);
    CHECK(gestures > 20 * (unsigned)rounds && fillings > (unsigned)rounds);
}
