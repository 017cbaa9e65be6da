/* SPDX-License-Identifier: MIT */
/* The pure parts of a comparison of two journals: the first command in which they differ, how far
 * labels differ, and the picture of it. */
#include "render/notes.h"
#include "show/decorating.h"
#include "verify/verify_inside.h"
#include "tests/check_main.h"
#include "tests/interpreting.h"

/* ---- where commands part ---- */

/* The last difference that was looked for; the next one replaces it. */
static struct first_difference first;
static struct fault why;

static void find(const char *a, const char *b, size_t last, enum err err)
{
    struct buf bytes[2] = {{0}, {0}};
    buf_add_text(bytes, a);
    buf_add_text(bytes + 1, b);
    first_difference_release(&first);
    first = (struct first_difference){0};
    CHECK_INT(first_difference_find(&first, FIRST_COMMAND, (const char *const[]){"a", "b"}, bytes,
                                    last, &why),
              err);
    buf_release(bytes);
    buf_release(bytes + 1);
}

static void check_same(const char *a, const char *b, size_t same)
{
    find(a, b, 0, OK);
    CHECK(!first.is_there);
    CHECK_INT(first.same, same);
}

STORY(the_same_commands_do_not_part_whatever_results_and_comments)
{
    check_same("", "", 0);
    check_same("open s.nii\nrun\n", "open s.nii\nrun", 2);
    check_same("# by one\n\nopen s.nii\n", "  open   \"s.nii\"\n# the end\n", 1);
    check_same("open s.nii\ninfo\nrun\nstats\n", "open s.nii\nrun\n", 2); /* questions */
    const char seal[] = " chain=00000000000000000000000000000000\n";
    OWNED(buf_release) struct buf a = {0}, b = {0};
    buf_printf(&a, "# iftty journal 1 semantics 3\nopen s.nii\n= 1 scene=1%srun\n= 2 forest=1%s",
               seal, seal);
    buf_printf(&b, "# iftty journal 1 semantics 2\n# why\nopen s.nii\n= 1 scene=9%srun\n= 2%s",
               seal, seal);
    check_same(buf_text(&a), buf_text(&b), 2);
    check_same(buf_text(&a), "open s.nii\nrun\n", 2);
}

STORY(the_first_other_command_is_named_in_both)
{
    find("open s\n\nseed 1,1,1 1\nrun\n", "open s\nstats\nseed 1,1,2 1\n", 0, OK);
    CHECK(first.is_there && first.side[0].has_command && first.side[1].has_command);
    CHECK_INT(first.same, 1);
    CHECK_INT(first.side[0].number, 2);
    CHECK_INT(first.side[0].line, 3);
    CHECK_TEXT(buf_text(&first.side[0].command), "seed 1,1,1 1");
    CHECK_INT(first.side[1].number, 3);
    CHECK_INT(first.side[1].line, 3);
    CHECK_TEXT(buf_text(&first.side[1].command), "seed 1,1,2 1");
    find("open s\nrun\n", "open s\n", 0, OK);
    CHECK(first.is_there && first.side[0].has_command && !first.side[1].has_command);
    CHECK_TEXT(buf_text(&first.side[0].command), "run");
    find("open s\nrun\n", "open s\nauto on\n", 1, OK);
    CHECK(!first.is_there);
    find("label 1 a\n", "label 1a\n", 0, OK); /* words, not letters */
    CHECK(first.is_there);
    find("open \"s\n", "open \"s \n", 0, OK); /* which do not end */
    CHECK(first.is_there);
}

STORY(what_cannot_be_read_is_named)
{
    find("run\n", "# iftty journal 1 semantics 3\n= 1 x\n", 0, ERR_INPUT);
    CHECK(strncmp(why.text, "b: ", 3) == 0);
    find("run\n", "# iftty journal 77 semantics 3\n", 0, ERR_INPUT);
    CHECK(strncmp(why.text, "b: ", 3) == 0);
}

/* ---- how far labels differ ---- */

STORY(voxels_are_counted_and_dice_is_exact)
{
    static const uint8_t a[] = {0, 1, 1, 1, 2, 2, 0, 7}, b[] = {0, 1, 1, 2, 2, 1, 2, 255};
    static struct overlap o;
    overlap_add(&o, a, b, sizeof a);
    CHECK_INT(o.voxels, 8);
    CHECK_INT(o.differing, 4);
    CHECK_INT(o.a[1], 3);
    CHECK_INT(o.b[1], 3);
    CHECK_INT(o.both[1], 2);
    CHECK_INT(overlap_dice(&o, 1), 6667); /* 4/6 */
    CHECK_INT(overlap_dice(&o, 2), 4000); /* 2/5 */
    CHECK_INT(overlap_dice(&o, 7), 0);
    CHECK_INT(overlap_dice(&o, 255), 0);
    CHECK_INT(overlap_dice(&o, 9), DICE_ONE);
}

/* Against the fraction, rounded by its definition: d is right where 20000 d - 10000 <= 20000 x
 * 10000 < 20000 d + 10000, all times the sum. */
STORY(dice_is_rounded_to_the_nearest_halves_up)
{
    uint64_t random = 1;
    static struct overlap o;
    for (int i = 0; i < 100000; i++) {
        o.a[1] = 1 + check_random(&random) % (i % 2 ? 50 : UINT32_MAX);
        o.b[1] = 1 + check_random(&random) % (i % 2 ? 50 : UINT32_MAX);
        const uint64_t least = o.a[1] < o.b[1] ? o.a[1] : o.b[1];
        o.both[1] = check_random(&random) % (least + 1);
        const uint64_t sum = o.a[1] + o.b[1], twice = 4 * o.both[1] * DICE_ONE;
        const uint64_t d = overlap_dice(&o, 1);
        if (!CHECK(2 * d * sum <= twice + sum && twice + sum < 2 * (d + 1) * sum))
            return;
    }
}

/* ---- the picture ---- */

static uint8_t *labels_of(const struct session *session)
{
    const struct grid *grid = &session->scene->grid;
    uint8_t *label = malloc(grid->voxels);
    for (uint32_t z = 0, i = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++)
                label[i++] = session->scene->cell[grid_cell(grid, x, y, z)].label;
    return label;
}

static void begin(struct interpreter *interp, const char *seed)
{
    begin_interpreter(interp);
    must(interp, "open synth:geom:40x40x20; label 2 ball #ff0000; seed 0,0,0 0; "
                 "seed 20,20,10 1");
    must(interp, seed);
    must(interp, "run; size 120 100; zoom 2; view 30 20");
}

/* Whether the pane of a picture shows what the session renders, over its background. */
static bool shows(const struct picture *picture, uint32_t left, uint32_t top,
                  const struct session *session)
{
    OWNED(canvas_release) struct canvas frame;
    bool same = CHECK(session_show_frame(&frame, session, NULL) == OK);
    for (size_t y = 0; same && y < frame.height; y++)
        same = memcmp(picture->rgba + 4 * ((y + top) * picture->width + left),
                      canvas_pixel(&frame, 0, y), (size_t)4 * frame.width) == 0;
    return same;
}

/* How many pixels of the right pane have hue enough to be of that colour, by its sides' order. */
static size_t coloured(const struct picture *picture, uint32_t left, uint32_t top, uint32_t bottom,
                       int most, int least)
{
    size_t count = 0;
    for (uint32_t y = top; y < bottom; y++)
        for (uint32_t x = left; x < picture->width; x++) {
            const uint8_t *p = picture->rgba + 4 * ((size_t)y * picture->width + x);
            const int middle = 3 - most - least;
            count += p[most] > p[least] + 15 && p[most] >= p[middle] && p[middle] >= p[least];
        }
    return count;
}

enum { RED, GREEN, BLUE };

static void draw(struct picture *picture, struct interpreter *a, const uint8_t *label_a,
                 const uint8_t *label_b)
{
    struct overlap overlap = {0};
    overlap_add(&overlap, label_a, label_b, a->session->scene->grid.voxels);
    const struct difference_picture difference_picture = {
        .name = {"a.iftty", "b.iftty"}, .label = {label_a, label_b}, .overlap = &overlap};
    CHECK(difference_picture_draw(picture, a->session, &difference_picture, NULL) == OK);
}

STORY(the_picture_shows_both_and_where_they_differ)
{
    static struct interpreter a, b;
    OWNED(picture_release) struct picture picture = {0};
    begin(&a, "seed 6,6,4 2");
    begin(&b, "seed 33,33,14 2");
    CHECK(session_render(a.session, RENDER_RAY, NULL) == OK);
    CHECK(session_render(b.session, RENDER_RAY, NULL) == OK);
    OWNED(mem_release) uint8_t *label_a = labels_of(a.session), *label_b = labels_of(b.session);
    /* A keeps its rendition only until it is drawn over. */
    static struct interpreter again;
    begin(&again, "seed 6,6,4 2");
    CHECK(session_render(again.session, RENDER_RAY, NULL) == OK);
    draw(&picture, &a, label_a, label_b);
    CHECK_INT(picture.width, 3 * 120 + 2 * 2);
    const uint32_t line = (uint32_t)text_line(notes_tall(100)), top = line + 8,
                   right = 2 * (120 + 2);
    CHECK_INT(picture.height, top + 100 + 3 * line + 8);
    CHECK(shows(&picture, 0, top, again.session) && shows(&picture, 120 + 2, top, b.session));
    CHECK(!shows(&picture, 120 + 2, top, again.session));
    size_t alone[3] = {0}, voxels = a.session->scene->grid.voxels;
    for (size_t i = 0; i < voxels; i++)
        if (label_a[i] != label_b[i])
            alone[!label_b[i] ? 0 : !label_a[i] ? 1 : 2]++;
    printf("# %zu in A alone, %zu in B alone, %zu in both\n", alone[0], alone[1], alone[2]);
    CHECK(alone[0] || alone[1] || alone[2]);
    CHECK((coloured(&picture, right, top, top + 100, RED, BLUE) > 0) == (alone[0] > 0));
    CHECK((coloured(&picture, right, top, top + 100, BLUE, RED) > 0) == (alone[1] > 0));
    for (size_t i = 0; i < (size_t)picture.width * picture.height; i++)
        if (!CHECK(picture.rgba[4 * i + 3] == 255))
            break;
    interpreter_release(&a);
    interpreter_release(&b);
    interpreter_release(&again);
}

STORY(where_nothing_differs_all_is_grey)
{
    static struct interpreter a;
    OWNED(picture_release) struct picture picture = {0};
    begin(&a, "seed 6,6,4 2");
    OWNED(mem_release) uint8_t *label = labels_of(a.session);
    draw(&picture, &a, label, label);
    CHECK_INT(coloured(&picture, 2 * 122, 19, 119, RED, BLUE), 0);
    CHECK_INT(coloured(&picture, 2 * 122, 19, 119, BLUE, RED), 0);
    interpreter_release(&a);
}

/* Hidden objects, objects of one alone, three views too wide for a picture, a view of one pixel. */
STORY(what_is_hidden_does_not_differ_and_sizes_are_judged)
{
    static struct interpreter a;
    struct picture picture = {0};
    begin(&a, "seed 6,6,4 2");
    OWNED(mem_release) uint8_t *label = labels_of(a.session);
    OWNED(mem_release) uint8_t *other = malloc(a.session->scene->grid.voxels);
    for (size_t i = 0; i < a.session->scene->grid.voxels; i++)
        other[i] = label[i] == 2 ? 0 : label[i];
    must(&a, "hide 2");
    draw(&picture, &a, label, other);
    CHECK_INT(coloured(&picture, 2 * 122, 19, 119, RED, BLUE), 0);
    picture_release(&picture);
    interpreter_release(&a);
    begin(&a, "seed 6,6,4 2");
    draw(&picture, &a, label, other);
    CHECK(coloured(&picture, 2 * 122, 19, 119, RED, BLUE) > 0);
    picture_release(&picture);
    interpreter_release(&a);
    begin(&a, "seed 6,6,4 2");
    must(&a, "size 1 1");
    draw(&picture, &a, label, other);
    CHECK_INT(picture.width, 7);
    picture_release(&picture);
    a.session->now.outlook.view.width = 8192;
    struct overlap overlap = {0};
    overlap_add(&overlap, label, other, a.session->scene->grid.voxels);
    const struct difference_picture difference_picture = {
        .name = {"a", "b"}, .label = {label, other}, .overlap = &overlap};
    CHECK(difference_picture_draw(&picture, a.session, &difference_picture, NULL) == ERR_LIMIT);
    picture_release(&picture);
    interpreter_release(&a);
}
