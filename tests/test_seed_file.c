/* SPDX-License-Identifier: MIT */
/* Seeds out of files, worked by hand: lists line by line, maps of a few voxels. */
#include "session/seed_file.h"

#include <sys/resource.h>

#include "base/buf.h"
#include "tests/check_main.h"
#include "tests/scarce_memory.h"
#include "tests/stopping.h"

static struct fault fault;
static struct seeds seeds;
static struct region_tally tally;
static const struct geometry plain = {.slope = 1, .world_axis = {0, 1, 2}, .world_sign = {1, 1, 1}};

static struct grid grid_of(uint32_t x, uint32_t y, uint32_t z)
{
    struct grid grid;
    CHECK(grid_init(&grid, (const uint32_t[3]){x, y, z}, NULL) == OK);
    return grid;
}

/* "x,y,z:label x,y,z:label" */
static const char *told(const struct grid *grid)
{
    static char text[4096];
    size_t n = 0;
    text[0] = '\0';
    for (size_t i = 0; i < seeds.count && n + 40 < sizeof text; i++) {
        struct place p = grid_place(grid, seeds.edit[i].cell);
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%u,%u,%u:%d", i ? " " : "", p.x, p.y,
                              p.z, seeds.edit[i].label);
    }
    seeds_release(&seeds);
    return text;
}

/* ---- lists ---- */

static const struct kept kept = {.label_name = {[0] = "nothing", [1] = "brain", [9] = "a,b"}};

static enum err list(const char *text, int label)
{
    const struct grid grid = grid_of(10, 9, 8);
    fault = (struct fault){.text = ""};
    return seeds_from_list(&seeds, text, strlen(text), &grid, &kept, label, NULL, &fault);
}

STORY(a_list_gives_its_seeds_in_the_order_of_voxels)
{
    static const char *const row[][2] = {
        {"1,2,3,4\n", "1,2,3:4"},
        {"1,2,3,4", "1,2,3:4"},
        {"1,2,3,4\r\n0,0,0,255\r\n", "0,0,0:255 1,2,3:4"},
        {"x,y,z,label\n9,8,7,1\n", "9,8,7:1"},
        {"\xef\xbb\xbf# made by hand\n\n \"x\" , y,z, label\n9,8,7,brain\n", "9,8,7:1"},
        {"1,2,3,nothing # why\n  # more\n\t4 , 5,6 ,\ta,b\t \n", "1,2,3:0 4,5,6:9"},
        {"1,1,1,2\n1,1,1,2\n0,1,1,2\n", "0,1,1:2 1,1,1:2"},
    };
    const struct grid grid = grid_of(10, 9, 8);
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        CHECK_WITH(list(row[i][0], LABEL_OWN) == OK, "%zu: %s", i, fault.text);
        CHECK_TEXT(told(&grid), row[i][1]);
    }
    CHECK(list("1,1,1,2\n1,1,1,3\n0,0,0,brain\n", 7) == OK);
    CHECK_TEXT(told(&grid), "0,0,0:7 1,1,1:7");
}

STORY(a_bad_line_is_named_and_nothing_is_taken)
{
    static const char *const row[][2] = {
        {"1,1,1,1\n\n# x\n1,2,3\n",
         "line 4: expected x,y,z,label with whole voxel indices, not 1,2"},
        {"1,1,1,1\nx,y,z,label\n", "line 2: expected x,y,z,label"},
        {"x,y,z\n", "line 1: expected x,y,z,label"},
        {"x,1,2,3\n", "line 1: expected x,y,z,label"},
        {"1.5,1,1,1\n", "line 1: expected x,y,z,label"},
        {"1,1,1,1,1\n", "line 1: expected a label 0..255 or the name of one, not 1,1"},
        {"1,1,1,1 1\n", "line 1: expected x,y,z,label"},
        {"1 1 1 1\n", "line 1: expected x,y,z,label"},
        {"1,1,1,\n1", "line 1: expected a label"},
        {"1,1,1", "line 1: expected x,y,z,label"},
        {"1,1,1,256\n", "line 1: expected a label 0..255 or the name of one, not 256"},
        {"1,1,1,-1\n", "line 1: expected a label"},
        {"1,1,1,brai\n", "line 1: expected a label"},
        {"1,1,1,liver\n", "not liver; nothing was planted"},
        {"1,1,\x1b[31m1,2", "\\x1b[31m"},
        {"9,8,7,1\n10,0,0,1\n",
         "line 2: 10,0,0 is outside the scene, whose voxels are 0,0,0 to 9,8"},
        {"0,0,-1,1\n", "line 1: 0,0,-1 is outside"},
        {"99999999999999999999,0,0,1\n", "line 1: expected x,y,z,label"},
        {"1,1,1,2\n2,2,2,2\n1,1,1,3\n", "line 3: the voxel of line 1 again, with label 3 instead"},
        {"", "there is no seed in it"},
        {"# nothing\nx,y,z,label\n", "there is no seed in it"},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        CHECK_WITH(list(row[i][0], LABEL_OWN) == ERR_INPUT, "%s", row[i][0]);
        CHECK_HAS(fault.text, row[i][1]);
        CHECK(seeds.count == 0 && !seeds.edit);
        seeds_release(&seeds);
    }
    const struct grid grid = grid_of(10, 9, 8); /* a NUL is no end of a line */
    CHECK(seeds_from_list(&seeds, "1,1,1,1\0\n2,2,2,2\n", 17, &grid, &kept, LABEL_OWN, NULL,
                          &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "line 1");
}

STORY(a_seed_of_a_list_may_end_within_a_distance)
{
    const struct grid grid = grid_of(10, 9, 8);
    CHECK(list("x,y,z,label,within,of x,of y,of z\n1,1,1,2,4,1,2,3\n3,3,3,2\n2,1,1,2,4,1,2,3 # a\n"
               "4,1,1,2,2.5mm,1,2,3\n5,1,1,9,4,1,2,3\n6,1,1,2,0,0,0,0\n",
               LABEL_OWN) == OK);
    CHECK_INT(seeds.groups, 4);
    const uint16_t *region = seeds.region; /* in the order of voxels */
    CHECK(region[0] >= SEED_GROUPS_FROM && region[0] == region[1] && region[2] != region[3]);
    CHECK_INT(seeds.group[region[4] - SEED_GROUPS_FROM].reach.radius, REACH_EXACT);
    CHECK_INT(region[5], 2);
    const struct seed_group *first = &seeds.group[region[0] - SEED_GROUPS_FROM];
    const struct seed_group *in_mm = &seeds.group[region[2] - SEED_GROUPS_FROM];
    CHECK(first->label == 2 && first->reach.radius == 4 && first->reach.unit[1] == 1);
    CHECK(first->reach.centre[0] == 1 && first->reach.centre[2] == 3);
    CHECK(in_mm->reach.radius == 2500000 && in_mm->reach.unit[1] == 0);
    CHECK_INT(seeds.group[region[3] - SEED_GROUPS_FROM].label, 9);
    const uint64_t digest = seeds_digest(&seeds);
    CHECK_TEXT(told(&grid), "1,1,1:2 2,1,1:2 4,1,1:2 5,1,1:9 6,1,1:2 3,3,3:2");
    CHECK(list("1,1,1,2,5,1,2,3\n3,3,3,2\n2,1,1,2,4,1,2,3\n4,1,1,2,2.5mm,1,2,3\n"
               "5,1,1,9,4,1,2,3\n",
               LABEL_OWN) == OK);
    CHECK(seeds_digest(&seeds) != digest);
    seeds_release(&seeds);
    static const char *const wrong[] = {
        "1,1,1,2,4\n",         "1,1,1,2,4,1,2\n",     "1,1,1,2,0,1,2,3\n",
        "1,1,1,2,513,1,2,3\n", "1,1,1,2,4,1,2,3,4\n", "1,1,1,2,-4,1,2,3\n",
        "1,1,1,2,4cm,1,2,3\n", "1,1,1,2,4,1,-2,3\n",  "1,1,1,2,1001mm,1,2,3\n",
        "1,1,1,2,4,1,2,3x\n"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        CHECK_WITH(list(wrong[i], LABEL_OWN) == ERR_INPUT, "%s", wrong[i]);
    CHECK(list("1,1,1,2,4,1,2,3\n1,1,1,2\n", LABEL_OWN) == ERR_INPUT);
    CHECK_HAS(fault.text, "the voxel of line 1 again, within another distance");
    CHECK(!seeds.group && !seeds.edit);
}

STORY(any_text_gives_seeds_of_the_scene_or_one_line)
{
    static const char piece[] = "0123456789,,,,,,\n\n\n##--.. brainxyz\"\r\t";
    const struct grid grid = grid_of(10, 9, 8);
    uint64_t state = 1;
    unsigned fine = 0;
    for (int i = 0; i < 100000; i++) {
        char text[40];
        size_t n = check_below(&state, sizeof text);
        for (size_t k = 0; k < n; k++)
            text[k] = check_below(&state, 2) ? (k % 2 ? ',' : '1')
                                             : piece[check_below(&state, sizeof piece)];
        char *exact = malloc(n + 1); /* so that a sanitizer sees one byte too many */
        memcpy(exact, text, n);
        exact[n] = '\0';
        fault = (struct fault){.text = ""};
        enum err err = seeds_from_list(&seeds, exact, n, &grid, &kept, LABEL_OWN, NULL, &fault);
        free(exact);
        fine += err == OK;
        CHECK(err == OK ? seeds.count > 0 : seeds.count == 0 && fault.text[0]);
        for (size_t k = 1; k < seeds.count; k++)
            CHECK(seeds.edit[k - 1].cell < seeds.edit[k].cell);
        seeds_release(&seeds);
    }
    CHECK(fine > 100);
}

/* ---- maps ---- */

/* A map of digits, x fastest; what is no digit is skipped. */
static enum err map_of(const char *digits, const struct grid *grid, struct geometry geometry,
                       const struct region_choice *choice)
{
    OWNED(volume_release) struct volume map = {.geometry = geometry};
    memcpy(map.size, grid->size, sizeof map.size);
    map.intensity = mem_array(grid->voxels, sizeof *map.intensity);
    size_t n = 0;
    for (; *digits; digits++)
        if (*digits >= '0' && *digits <= '9')
            map.intensity[n++] = (uint16_t)(*digits - '0');
    CHECK_INT(n, grid->voxels);
    fault = (struct fault){.text = ""};
    enum err err = seeds_from_map(&seeds, &tally, &map, grid, choice, NULL, &fault);
    CHECK(err == OK || (seeds.count == 0 && !seeds.edit && strstr(fault.text, "; nothing ")));
    return err;
}

static const struct region_choice everything = {
    .first = 1, .last = REGION_MOST, .label = LABEL_OWN};

static void gives(const char *digits, const struct grid *grid, struct geometry geometry,
                  const struct region_choice *choice, const char *expected)
{
    CHECK(map_of(digits, grid, geometry, choice) == OK);
    CHECK_TEXT(told(grid), expected);
}

static void gives_count(const char *digits, const struct grid *grid,
                        const struct region_choice *choice, size_t count)
{
    CHECK(map_of(digits, grid, plain, choice) == OK);
    CHECK_INT(seeds.count, count);
    seeds_release(&seeds);
}

static void refuses(const char *digits, const struct grid *grid, struct geometry geometry,
                    const struct region_choice *choice, const char *words)
{
    CHECK(map_of(digits, grid, geometry, choice) == ERR_INPUT);
    CHECK_HAS(fault.text, words);
}

STORY(every_voxel_of_a_region_is_a_seed_of_its_number)
{
    const struct grid grid = grid_of(3, 2, 1);
    struct region_choice choice = everything;
    CHECK(map_of("012 300", &grid, plain, &choice) == OK);
    CHECK_INT(tally.regions, 3);
    CHECK_INT(tally.eroded_away, 0);
    CHECK_TEXT(told(&grid), "1,0,0:1 2,0,0:2 0,1,0:3");
    choice.label = 9;
    gives("012 300", &grid, plain, &choice, "1,0,0:9 2,0,0:9 0,1,0:9");
    choice.label = 0;
    choice.first = choice.last = 2;
    gives("012 300", &grid, plain, &choice, "2,0,0:0");
    choice = everything;
    choice.first = 0, choice.last = 1; /* the background, where it is asked for */
    gives("012 300", &grid, plain, &choice, "0,0,0:0 1,0,0:1 1,1,0:0 2,1,0:0");
    choice.first = 4, choice.last = 7;
    refuses("012 300", &grid, plain, &choice, "the map has no voxel of regions 4-7");
}

STORY(values_are_what_the_header_makes_of_them)
{
    const struct grid grid = grid_of(4, 1, 1);
    struct geometry geometry = plain;
    struct region_choice choice = everything;
    geometry.intercept = -1; /* int16 with -1 outside */
    gives("0123", &grid, geometry, &choice, "2,0,0:1 3,0,0:2");
    geometry.intercept = 254;
    refuses("0123", &grid, geometry, &choice,
            "region 256 of the map is no label; `label 256 NAME` makes it one");
    choice.last = 255;
    gives("0123", &grid, geometry, &choice, "0,0,0:254 1,0,0:255");
    choice.last = REGION_MOST, choice.label = 1;
    CHECK(map_of("0123", &grid, geometry, &choice) == OK);
    CHECK_INT(seeds.count, 4);
    seeds_release(&seeds);
    geometry.intercept = 0, geometry.slope = 0.5;
    gives("0022", &grid, geometry, &choice, "2,0,0:1 3,0,0:1");
    refuses("0023", &grid, geometry, &choice,
            "voxel 3,0,0 of the map holds 1.5; regions are whole numbers");
    geometry.slope = 116.0 / 65535; /* float32 of 0..116, as 16 bits */
    CHECK(map_of("0000", &grid, geometry, &choice) == ERR_INPUT);
    refuses("0009", &grid, geometry, &choice, "holds 0.0159304");
    for (uint32_t value = 1; value <= 116; value++) {
        struct volume map = {.size = {1, 1, 1}, .intensity = &(uint16_t){0}, .geometry = geometry};
        const struct grid one = grid_of(1, 1, 1);
        map.intensity[0] = (uint16_t)(value * 65535.0 / 116 + 0.5);
        choice.label = LABEL_OWN;
        if (CHECK(seeds_from_map(&seeds, &tally, &map, &one, &choice, NULL, &fault) == OK))
            CHECK_INT(seeds.edit[0].label, value);
        seeds_release(&seeds);
    }
}

STORY(erosion_takes_what_touches_another_region_or_the_outside)
{
    static const char two[] = "11111 11111 11111 11111 11111" /* z = 0 */
                              "11111 11122 11122 11122 11111"
                              "11111 11111 11111 11111 11111";
    const struct grid grid = grid_of(5, 5, 3), cube = grid_of(5, 5, 5);
    struct region_choice choice = everything;
    choice.erode = 1; /* of the middle plane's 3x3, x = 3 is region 2 and x = 2 beside it */
    gives(two, &grid, plain, &choice, "1,1,1:1 1,2,1:1 1,3,1:1");
    CHECK_INT(tally.regions, 1);
    CHECK_INT(tally.eroded_away, 1);
    CHECK_INT(tally.first_eroded_away, 2);
    choice.erode = 2;
    refuses(two, &grid, plain, &choice, "erode=2 leaves no voxel of regions 1-65533");
    char full[126];
    memset(full, '1', 125);
    full[125] = '\0';
    static const size_t left[] = {125, 27, 1};
    for (choice.erode = 0; choice.erode < 3; choice.erode++) {
        gives_count(full, &cube, &choice, left[choice.erode]);
    }
    full[62] = '2'; /* the middle: its six neighbours go with the shell, corners and edges stay */
    choice.erode = 1;
    gives_count(full, &cube, &choice, 20);
    full[62] = '1'; /* erosion is within a region, though the other is not planted */
    for (int i = 0; i < 125; i++)
        full[i] = i % 5 < 2 ? '3' : '1';
    choice.first = choice.last = 1;
    CHECK(map_of(full, &cube, plain, &choice) == OK);
    CHECK_INT(seeds.count, 9); /* x = 3 */
    seeds_release(&seeds);
}

STORY(drawing_gives_each_region_what_is_asked_and_always_the_same)
{
    const struct grid grid = grid_of(40, 30, 20);
    char *digits = calloc(grid.voxels + 1, 1), former[4096];
    struct region_choice choice = everything;
    uint64_t state = 5, digest;
    for (size_t i = 0; i < grid.voxels; i++)
        digits[i] = (char)('0' + check_below(&state, 4));
    digits[100] = '9', digits[20000] = '9';
    choice.each = 7, choice.generator = 1;
    CHECK(map_of(digits, &grid, plain, &choice) == OK);
    unsigned count[10] = {0};
    for (size_t i = 0; i < seeds.count; i++) {
        struct place p = grid_place(&grid, seeds.edit[i].cell);
        CHECK_INT(digits[p.x + 40 * (p.y + 30 * p.z)] - '0', seeds.edit[i].label);
        CHECK(i == 0 || seeds.edit[i - 1].cell < seeds.edit[i].cell);
        count[seeds.edit[i].label]++;
    }
    CHECK(count[0] == 0 && count[1] == 7 && count[2] == 7 && count[3] == 7 && count[9] == 2);
    digest = seeds_digest(&seeds);
    strcpy(former, told(&grid));
    CHECK(map_of(digits, &grid, plain, &choice) == OK && seeds_digest(&seeds) == digest);
    CHECK_TEXT(told(&grid), former);
    choice.generator = 2;
    CHECK(map_of(digits, &grid, plain, &choice) == OK && seeds_digest(&seeds) != digest);
    CHECK(strcmp(told(&grid), former) != 0);
    choice.generator = 1; /* what is drawn of a region does not depend on the others */
    choice.first = choice.last = 2;
    CHECK(map_of(digits, &grid, plain, &choice) == OK);
    CHECK_INT(seeds.count, 7);
    for (size_t i = 0; i < seeds.count; i++) {
        char one[40];
        struct place p = grid_place(&grid, seeds.edit[i].cell);
        snprintf(one, sizeof one, "%u,%u,%u:2", p.x, p.y, p.z);
        CHECK_HAS(former, one);
    }
    seeds_release(&seeds);
    free(digits);
}

STORY(equal_regions_give_different_places)
{
    const struct grid grid = grid_of(20, 2, 1);
    struct region_choice choice = everything;
    unsigned same = 0;
    choice.each = 10;
    CHECK(map_of("11111111111111111111 22222222222222222222", &grid, plain, &choice) == OK);
    CHECK_INT(seeds.count, 20);
    for (size_t i = 0; i < 10 && seeds.count == 20; i++)
        same +=
            grid_place(&grid, seeds.edit[i].cell).x == grid_place(&grid, seeds.edit[i + 10].cell).x;
    CHECK(same < 10);
    seeds_release(&seeds);
}

STORY(every_voxel_of_a_region_is_drawn_as_often)
{
    enum { VOXELS = 10, DRAWN = 3, TIMES = 2000 };
    const struct grid grid = grid_of(VOXELS, 1, 1);
    struct region_choice choice = everything;
    unsigned count[VOXELS] = {0};
    choice.each = DRAWN;
    for (choice.generator = 0; choice.generator < TIMES; choice.generator++) {
        CHECK(map_of("1111111111", &grid, plain, &choice) == OK);
        CHECK_INT(seeds.count, DRAWN);
        for (size_t i = 0; i < seeds.count; i++)
            count[grid_place(&grid, seeds.edit[i].cell).x]++;
        seeds_release(&seeds);
    }
    for (int i = 0; i < VOXELS; i++) /* 600, give or take four times 20 */
        CHECK(count[i] > 518 && count[i] < 682);
}

STORY(a_map_of_another_grid_is_refused)
{
    const struct grid grid = grid_of(3, 2, 2);
    uint16_t value[12] = {1, 2};
    struct volume map = {.size = {3, 2, 1}, .intensity = value, .geometry = plain};
    CHECK_INT(map_check_size(map.size, &grid, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "the map has 3x2x1 voxels and the scene 3x2x2");
    struct geometry place = plain;
    map.size[2] = 2;
    map.geometry.orientation = place.orientation = ORIENTATION_SFORM;
    map.geometry.world_sign[0] = -1;
    CHECK_INT(map_check_axes(&map, &place, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "along other axes of the world");
    map.geometry.orientation =
        ORIENTATION_UNKNOWN; /* a map that says nothing of the world is taken as it is */
    CHECK_INT(map_check_axes(&map, &place, &fault), OK);
    CHECK(seeds_from_map(&seeds, &tally, &map, &grid, &everything, NULL, &fault) == OK);
    CHECK_TEXT(told(&grid), "0,0,0:1 1,0,0:2");
}

/* ---- digest, memory ---- */

STORY(the_digest_sees_every_voxel_and_label)
{
    uint64_t one, other;
    CHECK(list("1,1,1,2\n3,3,3,4\n", LABEL_OWN) == OK);
    one = seeds_digest(&seeds);
    seeds_release(&seeds);
    static const char *const text[] = {"1,1,1,4\n3,3,3,2\n", "1,1,1,2\n3,3,2,4\n", "1,1,1,2\n",
                                       "1,1,1,2\n3,3,3,4\n5,5,5,0\n"};
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) {
        CHECK(list(text[i], LABEL_OWN) == OK);
        other = seeds_digest(&seeds);
        CHECK(other != one);
        seeds_release(&seeds);
    }
    CHECK(list("3,3,3,4\n1,1,1,2\n1,1,1,2\n", LABEL_OWN) == OK && seeds_digest(&seeds) == one);
    seeds_release(&seeds);
}

STORY(out_of_memory_gives_no_seeds)
{
    const struct grid grid = grid_of(3, 3, 3);
    struct region_choice choice = everything;
    uint16_t value[27];
    choice.erode = 1;
    for (size_t n = 0; n < 6; n++) {
        for (int i = 0; i < 27; i++)
            value[i] = 1;
        struct volume map = {.size = {3, 3, 3}, .intensity = value, .geometry = plain};
        allow_allocations(n);
        enum err err = seeds_from_map(&seeds, &tally, &map, &grid, &choice, NULL, &fault);
        mem_allows = NULL;
        CHECK_INT(err, n < 5 ? ERR_MEMORY : OK);
        CHECK_INT(seeds.count, n < 5 ? 0 : 1);
        seeds_release(&seeds);
        allow_allocations(n);
        err = list("1,1,1,1\n", LABEL_OWN);
        mem_allows = NULL;
        CHECK_INT(err, n < 4 ? ERR_MEMORY : OK);
        seeds_release(&seeds);
    }
}

/* Physical memory that this process has held at most, in bytes. */
static size_t most_held(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (size_t)usage.ru_maxrss * 1024;
}

/* A list whose table of seeds is many times as large as the file. */
STORY(a_table_of_seeds_counts_against_the_limit_of_memory)
{
    enum { LINES = 1 << 20, LINE = 8, ROOM = 24 << 20, MORE = 8 << 20 };
    static const char line[] = "1,1,1,1\n";
    const struct grid grid = grid_of(10, 9, 8);
    if (!MEM_MAY_BE_LIMITED) {
        SKIP("a sanitiser takes more memory than a limit leaves");
        return;
    }
    OWNED(mem_release) char *text = malloc(LINES * LINE + 1);
    for (size_t i = 0; i < LINES; i++)
        memcpy(text + LINE * i, line, LINE);
    text[LINES * LINE] = '\0';
    for (int is_limited = 1; is_limited >= 0; is_limited--) {
        const size_t held = mem_held();
        mem_limit(is_limited ? held + ROOM : SIZE_MAX);
        const enum err err =
            seeds_from_list(&seeds, text, LINES * LINE, &grid, &kept, LABEL_OWN, NULL, &fault);
        mem_limit(SIZE_MAX);
        CHECK_INT(err, is_limited ? ERR_MEMORY : OK);
        CHECK((most_held() < held + ROOM + MORE) == is_limited);
        seeds_release(&seeds);
    }
}

STORY(a_list_can_be_stopped_anywhere)
{
    const struct grid grid = grid_of(40, 40, 40);
    OWNED(buf_release) struct buf text = {0};
    for (int z = 0; z < 40; z++)
        for (int y = 0; y < 40; y++)
            buf_printf(&text, "1,%d,%d,1\n2,%d,%d,1\n", y, z, y, z);
    enum err err = ERR_CANCELLED;
    int most = 0;
    for (; err == ERR_CANCELLED; most++) {
        int looks = most;
        struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1000};
        err = seeds_from_list(&seeds, buf_text(&text), text.length, &grid, &kept, LABEL_OWN, &watch,
                              &fault);
        CHECK(err ? !seeds.edit : seeds.count == 3200);
        seeds_release(&seeds);
    }
    CHECK_INT(err, OK);
    CHECK(most > 30); /* while lines are read, and while they are put in order */
}
