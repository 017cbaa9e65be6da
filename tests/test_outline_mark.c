/* SPDX-License-Identifier: MIT */
/* Outlines drawn and outlines found: pixels of panes compared with a plain list of voxels, and the
 * outline that is found for a correction; pixels of the rendition's pane. */
#include "program/programs.h"
#include "session/paint.h"
#include "program/panes.h"
#include "tests/check_main.h"
#include "tests/interpreting.h"

static struct interpreter interp;
static struct pilot_interpreter pilot = {.interp = &interp};
static struct pilot_host host;

static void begin(void)
{
    pilot_host_fill(&host);
    begin_interpreter(&interp);
    must(&interp, "open synth:geom:32x32x32; cross 12,14,9");
}
#define OUTLINE_STORY(told) STORY_WITHIN(told, begin(), interpreter_release(&interp))

static void draw(struct panes *panes, const struct pilot_wish *mark)
{
    static const struct buf no_words[PANES_LINES];
    struct pilot_wish wish = mark ? *mark : (struct pilot_wish){.label = 0};
    wish.width = wish.height = 320;
    wish.cell_width = 8;
    wish.cell_height = 16;
    CHECK(panes_draw(panes, interp.session, &wish, no_words, NULL) == OK);
}

static bool is_of(const struct voxels *voxels, uint32_t cell)
{
    bool found = false;
    for (size_t i = 0; i < voxels->count; i++)
        found |= voxels->cell[i] == cell;
    return found;
}

static bool is_tinted(const uint8_t *with, const uint8_t *without, const uint8_t rgb[3])
{
    bool is = memcmp(with, without, 3) != 0;
    for (int k = 0; k < 3; k++)
        is &= with[k] == (2 * without[k] + rgb[k] + 1) / 3;
    return is;
}

/* Count the pixels with a tint of the label, and other pixels changed by the outline. */
static void compare(const struct panes *with, const struct panes *without, enum pilot_pane pane,
                    const struct voxels *inside, const uint8_t rgb[3], unsigned *tints,
                    unsigned *others)
{
    const struct raster_box box = panes_box(with, pane);
    *tints = *others = 0;
    for (uint32_t y = box.top; y < box.top + box.height; y++)
        for (uint32_t x = box.left; x < box.left + box.width; x++) {
            const uint32_t cell = with->canvas.cell[y * with->canvas.stride + x];
            const uint8_t *now = canvas_pixel(&with->canvas, x, y),
                          *then = canvas_pixel(&without->canvas, x, y);
            const bool is_tint = is_tinted(now, then, rgb);
            *tints += is_tint;
            *others += !is_tint && memcmp(now, then, 3) != 0;
            CHECK(!is_tint || is_of(inside, cell));
        }
}

OUTLINE_STORY(what_an_outline_encloses_is_tinted_in_its_slice_alone)
{
    static const uint32_t corner[][3] = {{4, 5, 9}, {20, 6, 9}, {22, 18, 9}, {9, 24, 9}};
    static const uint8_t colour[3] = {250, 10, 130};
    const struct pilot_wish mark = {
        .corner = corner, .corners = 4, .label = 7, .marks_outline = true};
    struct panes with = {0}, without = {0};
    OWNED(voxels_release) struct voxels inside = {0};
    unsigned tints, others, all = 0;
    must(&interp, "label 7 outline #fa0a82");
    const struct scene *scene = interp.session->scene;
    CHECK(paint_polygon(&inside, &scene->grid, corner, 4, NULL, NULL) == OK);
    draw(&without, NULL);
    draw(&with, &mark);
    compare(&with, &without, PILOT_AXIAL, &inside, colour, &tints, &others);
    const struct raster_box box = panes_box(&with, PILOT_AXIAL);
    for (uint32_t y = box.top; y < box.top + box.height; y++)
        for (uint32_t x = box.left; x < box.left + box.width; x++)
            all += is_of(&inside, with.canvas.cell[y * with.canvas.stride + x]);
    CHECK(tints > all * 4 / 5 && tints < all);
    CHECK(others > 100); /* the line */
    for (enum pilot_pane pane = PILOT_CORONAL; pane <= PILOT_RENDITION; pane++) {
        compare(&with, &without, pane, &inside, colour, &tints, &others);
        CHECK_INT(tints + others, 0);
    }
    panes_release(&with);
    must(&interp, "cross 12,14,10"); /* nothing of it in the next slice */
    draw(&without, NULL);
    draw(&with, &mark);
    compare(&with, &without, PILOT_AXIAL, &inside, colour, &tints, &others);
    CHECK_INT(tints + others, 0);
    must(&interp, "cross 12,14,9");
    must(&interp, "magnify 300 at=12,14,9"); /* its corners are far outside of the pane */
    draw(&with, &mark);
    panes_release(&with);
    panes_release(&without);
}

/* Find an outline at a place: return its marker, or -1, and the number of corners. */
static int find(unsigned label, enum pilot_pane pane, const uint32_t place[3], size_t *corners)
{
    OWNED(polyline_release) struct polyline line = {0};
    OWNED(buf_release) struct buf words = {0};
    uint32_t marker = 99;
    const bool found = host.outline(&pilot, label, pane, place, &line, &marker, &words);
    *corners = line.count;
    CHECK(words.length > 0);
    return found ? (int)marker : -1;
}

OUTLINE_STORY(the_outline_of_a_marker_comes_before_the_border_of_its_label)
{
    static const uint32_t here[3] = {12, 14, 9}, beside[3] = {25, 14, 9}, below[3] = {12, 14, 8},
                          far[3] = {31, 31, 9};
    size_t corners;
    CHECK_INT(find(1, PILOT_AXIAL, here, &corners), -1); /* no voxel has the label */
    must(&interp, "seed 12,14,9 1 radius=4; seed 2,2,2 0; run");
    CHECK_INT(find(1, PILOT_AXIAL, here, &corners), 0);
    CHECK(corners > 3);
    must(&interp, "outline 6,8,9 1 to=18,8,9 to=18,20,9 to=6,20,9");
    CHECK_INT(find(1, PILOT_AXIAL, here, &corners), 3);
    CHECK_INT(corners, 4);
    CHECK_INT(find(1, PILOT_AXIAL, beside, &corners), 3); /* near it */
    CHECK(find(1, PILOT_AXIAL, far, &corners) <= 0);
    CHECK(find(1, PILOT_AXIAL, below, &corners) <= 0); /* in another slice */
    CHECK(find(1, PILOT_CORONAL, here, &corners) <= 0);
    CHECK(find(2, PILOT_AXIAL, here, &corners) <= 0); /* another label */
    must(&interp, "outline 7,8,9 1 to=18,8,9 to=18,20,9");
    CHECK_INT(find(1, PILOT_AXIAL, here, &corners), 5); /* the latest */
    must(&interp, "undo");
    CHECK_INT(find(1, PILOT_AXIAL, here, &corners), 3);
}

OUTLINE_STORY(the_slice_to_outline_next_has_a_place_in_it_and_is_none_that_has_one)
{
    OWNED(buf_release) struct buf words = {0};
    enum pilot_pane pane;
    uint32_t place[3];
    must(&interp, "finish relax");
    CHECK(!host.doubt(&pilot, 0, 1, &pane, place, &words));
    CHECK(!host.doubt(&pilot, 1, 1, &pane, place, &words));
    CHECK_HAS(buf_text(&words), "no slice has anything in doubt of label 1");
    must(&interp, "seed 12,14,9 1 radius=4; seed 2,2,2 0 radius=2; run");
    buf_clear(&words);
    CHECK(host.doubt(&pilot, 1, 1, &pane, place, &words));
    CHECK_HAS(buf_text(&words), " in doubt");
    const enum pilot_pane first = pane;
    const unsigned axis = PILOT_SAGITTAL - pane; /* perpendicular to the slice */
    const uint32_t at = place[axis];
    OWNED(buf_release) struct buf line = {0}; /* an outline there */
    const unsigned across = (axis + 1) % 3, along = (axis + 2) % 3;
    for (int i = 0; i < 4; i++) {
        uint32_t corner[3];
        corner[axis] = at;
        corner[across] = i == 1 || i == 2 ? 18 : 8;
        corner[along] = i / 2 ? 18 : 8;
        buf_printf(&line, "%s%u,%u,%u%s", i ? " to=" : "outline ", corner[0], corner[1], corner[2],
                   i ? "" : " 1");
    }
    must(&interp, buf_text(&line));
    must(&interp, "run");
    for (unsigned rank = 1; host.doubt(&pilot, 1, rank, &pane, place, &words); rank++)
        CHECK(pane != first || place[axis] != at);
}

/* Without pixels for letters they are characters in cells. */
OUTLINE_STORY(an_empty_rendition_says_how_to_begin_also_in_text)
{
    const struct pilot_wish wish = {
        .width = 160, .height = 88, .cell_width = 2, .cell_height = 4}; /* 80x22 cells */
    struct image_view view;
    char text[2][PANES_NOTES_MOST + 1] = {"", ""};
    for (int i = 0; i < 2; i++) {
        CHECK(host.picture(&pilot, &wish, &view, NULL) == OK);
        for (size_t n = 0; n < view.notes; n++)
            text[i][n] = view.note[n].character;
        must(&interp, "seed 12,14,9 1; run");
    }
    CHECK_HAS(text[0], "nothing to show yet");
    CHECK_HAS(text[0], "i plants a seed of the label");
    CHECK(!strstr(text[1], "nothing"));
    panes_release(&pilot.panes);
}

/* The rendition in a large pane has more pixels than the view, also before it is drawn. */
OUTLINE_STORY(a_pixel_of_the_rendition_is_one_of_its_pane)
{
    static const char *const lines[] = {"size 16 16", "size 40 20", "size 512 512",
                                        "size 16 16; render"};
    const struct pilot_wish wish = {
        .width = 320, .height = 320, .cell_width = 8, .cell_height = 16};
    struct pilot_facts facts;
    struct image_view view;
    uint32_t place[3];
    must(&interp, "seed 12,14,9 1; run");
    CHECK(host.picture(&pilot, &wish, &view, NULL) == OK); /* as large as the pane will be */
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        must(&interp, lines[i]);
        CHECK(host.facts(&pilot, &facts));
        const uint32_t middle[] = {facts.frame_width / 2, facts.frame_height / 2};
        CHECK(!host.voxel_of_frame(&pilot, middle[0], middle[1], place)); /* not drawn yet */
        CHECK(host.picture(&pilot, &wish, &view, NULL) == OK);
        CHECK_INT(facts.frame_width, session_frame(interp.session)->width);
        CHECK_INT(facts.frame_height, session_frame(interp.session)->height);
        CHECK(host.voxel_of_frame(&pilot, middle[0], middle[1], place));
    }
    panes_release(&pilot.panes);
}

static bool stops(void *context)
{
    return --*(int *)context < 0;
}

/* A full rendition is stopped by a key, any number of times, and is the same in the end. */
OUTLINE_STORY(a_picture_that_was_stopped_is_drawn_the_next_time)
{
    int looks = 0, stopped = 0;
    const struct pilot_onlooker onlooker = {.context = &looks, .stops = stops};
    const struct pilot_wish plain = {
        .width = 320, .height = 320, .cell_width = 8, .cell_height = 16};
    struct pilot_wish wish = plain;
    struct image_view view;
    OWNED(buf_release) struct buf expected = {0};
    wish.onlooker = &onlooker;
    interpreter_release(&interp);
    begin_interpreter(&interp);
    must(&interp, "open synth:geom:80x80x80; seed 12,14,9 1 radius=3; seed 2,2,2 0; run");
    CHECK(host.picture(&pilot, &plain, &view, NULL) == OK);
    buf_add(&expected, (const char *)view.rgba, 4 * 320 * 320);
    must(&interp, "seed 20,20,20 1 radius=5; run");
    CHECK(host.picture(&pilot, &plain, &view, NULL) == OK);
    must(&interp, "undo");
    for (enum err err = ERR_CANCELLED; err == ERR_CANCELLED && stopped < 1000; stopped++) {
        looks = stopped;
        err = host.picture(&pilot, &wish, &view, &fault);
        CHECK(err == OK || err == ERR_CANCELLED);
    }
    CHECK(stopped > 1 && stopped < 1000);
    CHECK(memcmp(view.rgba, expected.data, expected.length) == 0);
    panes_release(&pilot.panes);
}

OUTLINE_STORY(heat_waits_until_there_is_time_and_comes_with_hints)
{
    struct pilot_wish wish = {.width = 320, .height = 320, .cell_width = 8, .cell_height = 16};
    struct image_view view;
    must(&interp, "seed 12,14,9 1 radius=3; seed 2,2,2 0; run");
    CHECK(host.picture(&pilot, &wish, &view, NULL) == OK);
    wish.heat = true;
    wish.within_ns = UINT64_MAX;
    CHECK(host.picture(&pilot, &wish, &view, NULL) == OK);
    CHECK(view.is_hasty && !session_has_heat(interp.session));
    wish.within_ns = 0;
    CHECK(host.picture(&pilot, &wish, &view, NULL) == OK);
    CHECK(!view.is_hasty && session_has_heat(interp.session));
    wish.within_ns = UINT64_MAX;
    CHECK(host.picture(&pilot, &wish, &view, NULL) == OK && !view.is_hasty);
    must(&interp, "undo");
    CHECK(!session_has_heat(interp.session));
    CHECK(host.hints(&pilot) == 0 && session_has_heat(interp.session));
    panes_release(&pilot.panes);
}
