/* SPDX-License-Identifier: MIT */
/*
 * The pilot: what keys mean, as lines of commands; pictures that get finer on a slow line.
 */
#include <stdlib.h>

#include "base/file.h"
#include "tests/check.h"
#include "tui/cells.h"
#include "tui/pilot/ahead.h"
#include "tui/pilot/chord.h"
#include "tui/pilot/pilot_keys.h"
#include "tui/pilot/finer.h"
#include "tui/pilot/pace.h"
#include "tui/pilot/status.h"

/* ---- a host that is a box of voxels ---- */

/* Slices are counted along x for sagittal ones, y for coronal ones, z for axial ones. */
static struct pilot_facts facts;
static const uint32_t size[3] = {40, 50, 60};

static void move(void *context, const int64_t by[3], uint32_t place[3])
{
    static const int axis[3] = {[PILOT_AXIAL] = 2, [PILOT_CORONAL] = 1, [PILOT_SAGITTAL] = 0};
    (void)context;
    memcpy(place, facts.place, sizeof facts.place);
    for (int plane = 0; plane < 3; plane++) {
        const int a = axis[plane];
        const int64_t to = (int64_t)place[a] + by[plane];
        place[a] = to < 0 ? 0 : to >= size[a] ? size[a] - 1 : (uint32_t)to;
    }
}

static bool has_tree = true;
static bool held(void *context, const uint32_t place[3], bool alone, struct buf *out)
{
    (void)context;
    buf_printf(out, "%s of 5 voxels at %u", alone ? "the tree" : "marker 7", place[0]);
    return has_tree;
}

static bool tell_facts(void *context, struct pilot_facts *out)
{
    (void)context;
    *out = facts;
    return true;
}

static unsigned peeks;
static void peek(void *context, const uint32_t place[3])
{
    (void)context;
    memcpy(facts.place, place, sizeof facts.place);
    peeks++;
}

static struct pilot_way shown_way;
static bool why(void *context, const uint32_t place[3], struct pilot_way *way, struct buf *out)
{
    (void)context;
    buf_printf(out, "why %u", place[0]);
    *way = shown_way;
    return has_tree;
}

static unsigned hint_count;
static unsigned hints(void *context)
{
    (void)context;
    return hint_count;
}

static bool has_seed = true, hidden[256];
static bool seed_of(void *context, unsigned of, int64_t by, uint32_t place[3])
{
    (void)context;
    memcpy(place, (uint32_t[]){of, (uint32_t)(10 + by), 5}, 3 * sizeof *place);
    return has_seed;
}

static bool centre(void *context, unsigned of, uint32_t place[3])
{
    (void)context;
    memcpy(place, (uint32_t[]){of, 1, 2}, 3 * sizeof *place);
    return has_seed;
}

/* A square of `outline_side`, of a marker where it has a number, and the slices in doubt. */
static uint32_t outline_side, outline_marker;
static bool outline_there(void *context, unsigned of, enum pilot_pane pane, const uint32_t place[3],
                          struct polyline *there, uint32_t *marker, struct buf *out)
{
    (void)context;
    (void)pane;
    const uint32_t n = outline_side, corner[4][2] = {{0, 0}, {n, 0}, {n, n}, {0, n}};
    for (int i = 0; i < 4 && n > 0; i++)
        CHECK(polyline_add(there, (uint32_t[]){4 + corner[i][0], 4 + corner[i][1], place[2]}));
    *marker = outline_marker;
    buf_printf(out, n ? "a square of label %u" : "label %u is not here", of);
    return n > 0;
}

static unsigned doubts;
static bool doubt(void *context, unsigned of, unsigned rank, enum pilot_pane *pane,
                  uint32_t place[3], struct buf *out)
{
    (void)context;
    buf_printf(out, rank > doubts ? "nothing of label %u is in doubt" : "label %u, rank %u", of,
               rank);
    *pane = PILOT_AXIAL;
    memcpy(place, (uint32_t[]){9, 9, rank}, 3 * sizeof *place);
    return rank <= doubts;
}

static bool is_hidden(void *context, unsigned of)
{
    (void)context;
    return hidden[of];
}

static const char *label_name = "";
static void label(void *context, unsigned number, struct buf *out)
{
    (void)context;
    buf_printf(out, "%u%s%s", number, *label_name ? " " : "", label_name);
}

static bool shows = true;
static enum pilot_pane shown_pane;
static bool voxel_at(void *context, uint32_t column, uint32_t row, uint32_t place[3],
                     enum pilot_pane *pane)
{
    (void)context;
    *pane = shown_pane;
    memcpy(place, (uint32_t[]){column, row, 7}, 3 * sizeof *place);
    return shows;
}

static bool voxel_of_frame(void *context, uint32_t column, uint32_t row, uint32_t place[3])
{
    (void)context;
    memcpy(place, (uint32_t[]){column, row, 9}, 3 * sizeof *place);
    return shows;
}

static void frame_pixel(void *context, uint32_t column, uint32_t row, uint32_t pixel[2])
{
    (void)context;
    pixel[0] = column / 2;
    pixel[1] = row / 2;
}

static bool goes_on = true;
static bool pan(void *context, enum pilot_pane pane, int right, int down, uint32_t middle[3],
                uint32_t place[3])
{
    (void)context;
    memcpy(place, facts.place, sizeof facts.place);
    place[0] += right < 0; /* the cross-hair goes along */
    memcpy(middle, (uint32_t[]){(uint32_t)(10 + right), (uint32_t)(10 + down), (uint32_t)pane},
           3 * sizeof *middle);
    return goes_on;
}

static const struct pilot_host host = {.move = move,
                                       .pan = pan,
                                       .held = held,
                                       .why = why,
                                       .hints = hints,
                                       .facts = tell_facts,
                                       .peek = peek,
                                       .seed = seed_of,
                                       .centre = centre,
                                       .doubt = doubt,
                                       .outline = outline_there,
                                       .is_hidden = is_hidden,
                                       .label = label,
                                       .voxel_at = voxel_at,
                                       .voxel_of_frame = voxel_of_frame,
                                       .frame_pixel = frame_pixel};

static struct pilot_state state;
static struct buf line, message;
static enum pilot_deed deed;

static void begin(void)
{
    facts = (struct pilot_facts){.size = {size[0], size[1], size[2]},
                                 .place = {20, 25, 30},
                                 .index = {30, 25, 20},
                                 .plane = {"axial", "coronal", "sagittal"},
                                 .axis = {2, 1, 0},
                                 .window = {0, 100},
                                 .zoom = 1000,
                                 .times = PILOT_TIMES_ONE,
                                 .frame_width = 64,
                                 .frame_height = 48};
    has_tree = has_seed = shows = true;
    memset(hidden, 0, sizeof hidden);
    pilot_state_release(&state);
    pilot_state_init(&state, &pilot_setup_default);
    state.brush.radius = 0;
}

static void press(enum key key, unsigned modifiers, char c)
{
    const struct key_event event = {
        .key = key, .modifiers = modifiers, .point = (uint8_t)c, .text = {c}, .length = 1};
    buf_clear(&line);
    buf_clear(&message);
    struct press press = {&state, &event, &host, &facts, &line, &message, 0, PILOT_NOTHING};
    deed = pilot_press(&press);
}

static void click_on(const struct key_event *event, uint32_t column, uint32_t row)
{
    struct press press = {&state, event, &host, &facts, &line, &message, 0, PILOT_NOTHING};
    pilot_click(&press, column, row);
}

/* Presses letters one after the other; the line is the last one's. */
static const char *type(const char *letters)
{
    for (; *letters; letters++)
        press(KEY_CHARACTER, 0, *letters);
    return buf_text(&line);
}

static const char *arrow(enum key key, unsigned modifiers)
{
    press(key, modifiers, 0);
    return buf_text(&line);
}

STORY(arrows_and_letters_move_in_the_plane_that_is_marked)
{
    begin();
    CHECK_TEXT(arrow(KEY_RIGHT, 0), "cross 19,25,30\n"); /* towards the patient's left */
    CHECK_TEXT(type("l"), "cross 19,25,30\n");
    CHECK_TEXT(type("h"), "cross 21,25,30\n");
    CHECK_TEXT(type("k"), "cross 20,26,30\n");
    CHECK_TEXT(arrow(KEY_DOWN, 0), "cross 20,24,30\n");
    CHECK_TEXT(type("J"), "cross 20,25,29\n");
    CHECK_TEXT(arrow(KEY_PAGE_UP, 0), "cross 20,25,31\n");
    press(KEY_TAB, 0, 0); /* coronal */
    CHECK_TEXT(type("k"), "cross 20,25,31\n");
    CHECK_TEXT(type("K"), "cross 20,26,30\n");
    press(KEY_TAB, 0, 0); /* sagittal: his front is on the left */
    CHECK_TEXT(type("h"), "cross 20,26,30\n");
    CHECK_TEXT(type("k"), "cross 20,25,31\n");
    CHECK_TEXT(type("K"), "cross 21,25,30\n");
    press(KEY_TAB, 0, 0);
    CHECK_TEXT(type("l"), "cross 19,25,30\n");
}

STORY(counts_are_those_of_vim)
{
    begin();
    CHECK_TEXT(type("H"), "cross 30,25,30\n");
    CHECK_TEXT(arrow(KEY_UP, KEY_CONTROL), "cross 20,35,30\n");
    type("1");
    CHECK_TEXT(buf_text(&message), "1");
    CHECK_TEXT(type("0"), ""); /* a digit alone plants nothing */
    CHECK_TEXT(buf_text(&message), "10");
    CHECK_TEXT(type("l"), "cross 10,25,30\n");
    CHECK_TEXT(type("7h"), "cross 27,25,30\n");
    CHECK_TEXT(type("h"), "cross 21,25,30\n"); /* a count holds once */
    CHECK_TEXT(type("12K"), "cross 20,25,42\n");
    CHECK_TEXT(type("99999h"), "cross 39,25,30\n"); /* as far as the scene goes */
    CHECK_TEXT(buf_text(&message), "19 of 9999: the edge of the scene");
    CHECK_TEXT(type("2H"), "cross 39,25,30\n");
    CHECK_TEXT(buf_text(&message), "19 of 20: the edge of the scene");
    CHECK_TEXT(type("40J"), "cross 20,25,0\n");
    CHECK_TEXT(buf_text(&message), "30 of 40: the edge of the scene");
    type("19h");
    CHECK_TEXT(buf_text(&message), "");
    facts.place[0] = 39;
    CHECK_TEXT(type("h"), ""); /* nowhere to go is no command */
    CHECK_TEXT(buf_text(&message), "the edge of the scene");
    CHECK_TEXT(type("5u"), "undo 5\n");
    CHECK(state.says_all);
    CHECK_TEXT(type("u"), "undo\n");
    press(KEY_CHARACTER, KEY_CONTROL, 'r');
    CHECK_TEXT(buf_text(&line), "redo\n");
    CHECK_TEXT(type("0"), "");
    CHECK_HAS(buf_text(&message), "a count begins with 1-9; s0 plants");
    type("12");
    press(KEY_ESCAPE, 0, 0); /* takes it back, and no more */
    CHECK_INT(state.count, 0);
    CHECK_TEXT(type("l"), "cross 38,25,30\n");
}

STORY(a_key_that_takes_no_count_does_nothing_with_one)
{
    begin();
    CHECK_TEXT(type("3i"), "");
    CHECK_HAS(buf_text(&message), "i takes no count; nothing was done");
    CHECK_TEXT(type("2s1"), "");
    CHECK_HAS(buf_text(&message), "takes no count");
    CHECK_TEXT(type("i"), "seed 20,25,30 1\n"); /* and it is forgotten */
    CHECK_TEXT(type("4q"), "");
    CHECK(deed == PILOT_NOTHING);
}

STORY(some_keys_wait_for_a_second)
{
    begin();
    type("s");
    CHECK_TEXT(buf_text(&message), "s0-9 plant-label  Escape leaves");
    press(KEY_ESCAPE, 0, 0);
    for (const char *led = "gVm'D"; *led; led++) {
        char key[3] = {*led, *led, '\0'};
        key[1] = '\0';
        type(key);
        CHECK_INT(strncmp(buf_text(&message), key, 1), 0);
        CHECK_HAS(buf_text(&message), "  Escape leaves");
        CHECK(message.length <= 80);
        press(KEY_ESCAPE, 0, 0);
    }
    type("s");
    CHECK_TEXT(type("3"), "seed 20,25,30 3\n");
    CHECK_TEXT(type("sl"), "");
    CHECK_HAS(buf_text(&message), "does nothing here");
    CHECK_TEXT(type("l"), "cross 19,25,30\n"); /* it is over */
    type("s");
    press(KEY_ESCAPE, 0, 0);
    CHECK_TEXT(type("5l"), "cross 15,25,30\n");
}

STORY(slices_marks_and_seeds_to_go_to)
{
    begin();
    CHECK_TEXT(type("gg"), "cross 20,25,0\n");
    CHECK_TEXT(type("G"), "cross 20,25,59\n");
    CHECK_TEXT(type("12G"), "cross 20,25,12\n");
    CHECK_TEXT(type("42gg"), "cross 20,25,42\n");
    facts.counts_down[0] = true; /* K leads to lower numbers: slice 0 is 30 of them up */
    CHECK_TEXT(type("gg"), "cross 20,25,59\n");
    CHECK_TEXT(type("28G"), "cross 20,25,32\n");
    facts.counts_down[0] = false;
    type("ma");
    CHECK_TEXT(type("'b"), "");
    CHECK_HAS(buf_text(&message), "there is no mark b; mb sets it");
    memcpy(facts.place, (uint32_t[]){1, 2, 3}, sizeof facts.place);
    CHECK_TEXT(type("Da"), "measure 20,25,30 1,2,3\n");
    CHECK_TEXT(type("Db"), "");
    CHECK_HAS(buf_text(&message), "there is no mark b; mb sets it");
    CHECK_TEXT(type("'a"), "cross 20,25,30\n");
    memcpy(facts.place, (uint32_t[]){20, 25, 30}, sizeof facts.place);
    CHECK_TEXT(type("''"), "cross 1,2,3\n"); /* where the jump came from */
    CHECK_TEXT(type("n"), "cross 1,11,5\n");
    CHECK_TEXT(type("3N"), "cross 1,7,5\n");
    CHECK_TEXT(type("bgc"), "cross 2,1,2\n");
    has_seed = false;
    CHECK_TEXT(type("n"), "");
    CHECK_HAS(buf_text(&message), "label 2 has no seed");
    CHECK_TEXT(type("gc"), "");
    CHECK_HAS(buf_text(&message), "label 2 has no voxel");
    type("v");
    CHECK_TEXT(type("gg"), "cross 20,25,0\n"); /* a jump draws nothing */
}

STORY(seeds_brushes_and_strokes)
{
    begin();
    CHECK_TEXT(type("i"), "seed 20,25,30 1\n"); /* of the label at hand */
    CHECK_TEXT(type("s3"), "seed 20,25,30 3\n");
    press(KEY_ENTER, 0, 0);
    CHECK_TEXT(buf_text(&line), "seed 20,25,30 3\n");
    CHECK_TEXT(type("bi"), "seed 20,25,30 4\n");
    CHECK_TEXT(type("++i"), "seed 20,25,30 4 radius=2\n");
    CHECK_TEXT(type("-s0"), "seed 20,25,30 0 radius=1\n");
    CHECK_TEXT(type("Bi"), "seed 20,25,30 255 radius=1\n"); /* they go round */
    CHECK_TEXT(type("12bi"), "seed 20,25,30 12 radius=1\n");
    type("256b");
    CHECK_HAS(buf_text(&message), "labels are 0 to 255, not 256");
    for (int i = 0; i < 50; i++)
        type("+");
    CHECK_TEXT(type("s1"), "seed 20,25,30 1 radius=32\n");
    type("9999-");
    CHECK_TEXT(type("6+i"), "seed 20,25,30 1 radius=6\n");
    CHECK_TEXT(type("4-+i"), "seed 20,25,30 1 radius=3\n"); /* a count holds once */
    CHECK_TEXT(type("99+i"), "seed 20,25,30 1 radius=32\n");
    for (int i = 0; i < 50; i++)
        type("-");
    type("I");
    facts.place[1] = 40;
    CHECK_TEXT(type("s2"), "seed 20,40,30 2 to=20,25,30\n");
    CHECK_TEXT(type("i"), "seed 20,40,30 2\n"); /* one stroke an end */
    type("v");
    CHECK(state.pen.is_down && message.length == 0);
    CHECK_TEXT(type("l"), "cross 19,40,30\nseed 19,40,30 2 to=20,40,30\n");
    CHECK(state.sketches);
    press(KEY_ESCAPE, 0, 0);
    CHECK_TEXT(type("l"), "cross 19,40,30\n");
    CHECK(!state.sketches);
}

STORY(a_radius_in_millimetres)
{
    begin();
    CHECK_TEXT(type("3+Mi"), "seed 20,25,30 1 radius=3mm\n");
    CHECK_TEXT(buf_text(&message), "");
    type("M");
    CHECK_TEXT(buf_text(&message), "the brush: label 1, radius 3");
    type("M-");
    CHECK_TEXT(buf_text(&message), "the brush: label 1, radius 2.5mm");
    CHECK_TEXT(type("i"), "seed 20,25,30 1 radius=2.5mm\n");
    CHECK_TEXT(type("99+i"), "seed 20,25,30 1 radius=32mm\n");
    CHECK_TEXT(type("99-i"), "seed 20,25,30 1\n");
    CHECK_TEXT(type("+Mi"), "seed 20,25,30 1\n"); /* half a voxel is none */
}

/* What is typed for a range, and what one plants then. */
static const char *typed_range(const char *text)
{
    type("T");
    type(text);
    press(KEY_ENTER, 0, 0);
    CHECK(state.mode == PILOT_MOVING);
    return type("i");
}

STORY(a_brush_within_intensities)
{
    begin();
    facts.intensity = -12.5;
    type("t");
    CHECK_TEXT(buf_text(&message), "the brush: label 1, radius 0, intensities -17.5..-7.5");
    CHECK_TEXT(type("40ti"), "seed 20,25,30 1 range=-52.5..27.5\n");
    CHECK_TEXT(type("+i"), "seed 20,25,30 1 range=-52.5..27.5 radius=1\n");
    type("v");
    CHECK_TEXT(type("l"),
               "cross 19,25,30\nseed 19,25,30 1 range=-52.5..27.5 radius=1 to=20,25,30\n");
    type("t"); /* another brush ends the stroke */
    CHECK_TEXT(buf_text(&line),
               "cross 20,25,30\nseed 20,25,30 1 range=-52.5..27.5 radius=1 to=19,25,30\n");
    type("v-");
    CHECK_TEXT(typed_range("80..120.5"), "seed 20,25,30 1 range=80..120.5\n");
    type("T1..2");
    press(KEY_ESCAPE, 0, 0); /* leaves it as it was */
    CHECK_TEXT(type("i"), "seed 20,25,30 1 range=80..120.5\n");
    type("T7");
    press(KEY_BACKSPACE, 0, 0);
    press(KEY_BACKSPACE, 0, 0);
    CHECK_TEXT(state.typed, "");
    press(KEY_ESCAPE, 0, 0);
    static const char *const wrong[] = {"5",       "5..", "9..8",  "..",
                                        "1..2..3", "-",   "1e..2", "1..99999999999999999999"};
    CHECK_TEXT(typed_range("1e-6..2.5e-6"), "seed 20,25,30 1 range=0.000001..0.0000025\n");
    CHECK_TEXT(typed_range("80..120.5"), "seed 20,25,30 1 range=80..120.5\n");
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        CHECK_TEXT(typed_range(wrong[i]), "seed 20,25,30 1 range=80..120.5\n");
    type("T5");
    press(KEY_ENTER, 0, 0);
    CHECK_TEXT(buf_text(&message),
               "expected LOW..HIGH, as in 40..1200.5, not 5; the brush is as it was");
    for (int i = 0; i < 100; i++)
        type(i ? "1" : "T");
    CHECK_INT(strlen(state.typed), PILOT_RANGE_BYTES - 1);
    CHECK_TEXT(typed_range(""), "seed 20,25,30 1\n"); /* the limits are gone */
    type("pT5..6");
    press(KEY_ENTER, 0, 0);
    CHECK(state.mode == PILOT_PICKING && state.brush.has_range);
}

STORY(messages_name_the_keys_that_the_user_has)
{
    struct pilot_setup own = pilot_setup_default;
    begin();
    state.setup = &own;
    CHECK(setup_keys(&own, setup_row(&own, "keys"), "F", NULL) == OK);
    CHECK(setup_keys(&own, setup_row(&own, "mark"), "Sa-z", NULL) == OK);
    CHECK(setup_keys(&own, setup_row(&own, "plant-label"), ",0-9", NULL) == OK);
    CHECK(setup_keys(&own, setup_row(&own, "eliminate-it"), "y", NULL) == OK);
    type("Q");
    CHECK_TEXT(buf_text(&message), "this key does nothing here; F shows the keys");
    type("0");
    CHECK_TEXT(buf_text(&message), "a count begins with 1-9; ,0 plants a seed of label 0");
    type("'q");
    CHECK_TEXT(buf_text(&message), "there is no mark q; Sq sets it");
    type("Sq");
    CHECK_TEXT(buf_text(&message), "'q leads back here");
    type("x");
    CHECK_TEXT(buf_text(&message), "marker 7 of 5 voxels at 20; y removes it");
    CHECK_TEXT(type("y"), "remove 20,25,30\n");
    buf_clear(&message);
    pilot_keys_hint(&state, &facts, &message);
    CHECK_TEXT(buf_text(&message),
               "nothing to show yet: i plants a seed here, ,0 background; F keys  q back");
}

static const char *hint_now(void)
{
    buf_clear(&line);
    pilot_keys_hint(&state, &facts, &line);
    return buf_text(&line);
}

STORY(boxes_and_polygons_are_set_by_their_corners)
{
    begin();
    CHECK_TEXT(type("d"), "");
    CHECK_TEXT(buf_text(&message), "a box takes one corner, and there are 0; a sets it");
    CHECK_TEXT(type("a"), "");
    CHECK_TEXT(buf_text(&message),
               "1 corner; d plants the box to the cross-hair, O its faces, S a ball's shell");
    memcpy(facts.place, (uint32_t[]){5, 6, 7}, sizeof facts.place);
    CHECK_TEXT(type("d"), "box 20,25,30 5,6,7 1\n");
    CHECK_TEXT(type("S"), "");
    CHECK_TEXT(buf_text(&message), "a ball takes one middle, and there are 0; a sets it");
    type("a");
    facts.place[0] = 9;
    CHECK_TEXT(type("S"), "seed 5,6,7 0 shell=yes around=1 through=9,6,7\n");
    CHECK_INT(state.outline.count, 0);
    facts.place[0] = 5;
    type("a");
    memcpy(facts.place, (uint32_t[]){9, 10, 11}, sizeof facts.place);
    CHECK_TEXT(type("O"), "box 5,6,7 9,10,11 0 shell=yes around=1\n");
    facts.place[1] = 20; /* the same box beside there */
    CHECK_TEXT(type("."), "box 5,16,7 9,20,11 0 shell=yes around=1\n");
    memcpy(facts.place, (uint32_t[]){5, 6, 7}, sizeof facts.place);
    CHECK_TEXT(type("2ba"), "");
    facts.place[0] = 15;
    type("a");
    CHECK_TEXT(buf_text(&message), "2 corners");
    CHECK_TEXT(type("A"), "");
    CHECK_TEXT(buf_text(&message),
               "an outline takes 3 corners or more, and there are 2; a sets one");
    CHECK_TEXT(type("d"), "");
    CHECK_TEXT(buf_text(&message), "a box takes one corner, and there are 2; Escape drops them");
    memcpy(facts.place, (uint32_t[]){9, 16, 8}, sizeof facts.place);
    type("a");
    CHECK_TEXT(buf_text(&message),
               "this lies in another slice than the corners so far; Escape drops them");
    facts.place[2] = 7;
    type("a");
    CHECK_TEXT(buf_text(&message), "3 corners; A plants the outline");
    facts.intensity = 100;
    type("10t");
    CHECK_TEXT(type("A"), "outline 5,6,7 2 range=90..110 to=15,6,7 to=9,16,7\n");
    CHECK_INT(state.outline.count, 0);
    type("a");
    CHECK_TEXT(hint_now(), "1 corner  a another  d box to here  O faces  S ball's shell  "
                           "Escape drops it");
    facts.place[0]++;
    type("a");
    facts.place[1]++;
    type("a");
    CHECK_TEXT(hint_now(), "3 corners  a another  A plants the outline  Escape drops them");
    press(KEY_ESCAPE, 0, 0);
    CHECK_TEXT(buf_text(&message), "the corners are dropped");
    CHECK_INT(state.outline.count, 0);
    type("I");
    CHECK_TEXT(hint_now(), "one end of a stroke  i plants it to here  Escape drops it");
}

/* Letters, each of which takes the cross-hair where its line says. */
static const char *walk(const char *letters)
{
    for (; *letters; letters++) {
        press(KEY_CHARACTER, 0, *letters);
        sscanf(buf_text(&line), "cross %u,%u,%u", &facts.place[0], &facts.place[1],
               &facts.place[2]);
    }
    return buf_text(&line);
}

STORY(an_outline_is_drawn_freehand_by_keys)
{
    begin();
    CHECK_TEXT(walk("@"), "");
    CHECK(state.mode == PILOT_OUTLINING && message.length == 0);
    pilot_keys_hint(&state, &facts, &message);
    CHECK_TEXT(buf_text(&message),
               "moving, or the mouse, draws an outline  Enter plants it  Escape drops it");
    CHECK_TEXT(walk("5h"), "cross 25,25,30\n"); /* with counts, and nothing is planted */
    walk("4k");
    CHECK_TEXT(walk("i"), ""); /* nor by keys of other modes */
    CHECK_HAS(buf_text(&message), "does nothing here");
    walk("5l");
    CHECK_TEXT(walk("r"), "turn 15\n"); /* which one may look around meanwhile */
    CHECK_TEXT(walk("w"), "");
    press(KEY_ENTER, 0, 0);
    CHECK(state.mode == PILOT_OUTLINING);
    CHECK_INT(state.outline.count, 4);
    press(KEY_ENTER, 0, 0);
    CHECK_TEXT(buf_text(&line), "outline 20,25,30 1 to=25,25,30 to=25,29,30 to=20,29,30\n");
    CHECK(state.mode == PILOT_MOVING && state.outline.count == 0);
    CHECK_TEXT(walk("K"), "cross 20,29,31\n");
    CHECK_TEXT(type("."), "outline 20,25,31 1 to=25,25,31 to=25,29,31 to=20,29,31\n");
    walk("@ll");
    CHECK_TEXT(walk("@"), "");
    CHECK_HAS(buf_text(&message), "3 corners or more, and there are 2; Escape drops it");
    press(KEY_ESCAPE, 0, 0);
    CHECK_TEXT(buf_text(&message), "the outline is dropped");
    CHECK(state.mode == PILOT_MOVING && state.outline.count == 0);
    CHECK_TEXT(walk("@@"), ""); /* down, and up again */
    CHECK_TEXT(buf_text(&message), "the pen is up");
    walk("@lK");
    CHECK_HAS(buf_text(&message), "another slice"); /* and goes there */
    CHECK_INT(state.outline.count, 2);
    walk("J");
    walk("k0"); /* no label plants the rest, without a ring */
    press(KEY_ESCAPE, 0, 0);
    walk("v");
    walk("l");
    CHECK_HAS(walk("@"), " to="); /* the stroke of the other pen ends */
    CHECK(!state.pen.is_down);
}

/* What the left button does at a voxel of the slice that is shown, z = 7. */
static const char *mouse(enum mouse_action action, uint32_t x, uint32_t y)
{
    const struct key_event event = {.key = KEY_MOUSE,
                                    .mouse = {.action = action, .button = MOUSE_LEFT}};
    buf_clear(&line);
    buf_clear(&message);
    click_on(&event, x, y);
    sscanf(buf_text(&line), "cross %u,%u,%u", &facts.place[0], &facts.place[1], &facts.place[2]);
    return buf_text(&line);
}

STORY(the_mouse_draws_an_outline_and_letting_go_closes_it)
{
    begin();
    shown_pane = PILOT_AXIAL;
    walk("2b@");
    CHECK_TEXT(mouse(MOUSE_PRESSED, 5, 5), "cross 5,5,7\n");
    mouse(MOUSE_MOVED, 15, 5);
    mouse(MOUSE_MOVED, 15, 10);
    mouse(MOUSE_MOVED, 15, 15);
    mouse(MOUSE_MOVED, 5, 15);
    CHECK_TEXT(mouse(MOUSE_RELEASED, 5, 15), "outline 5,5,7 2 to=15,5,7 to=15,15,7 to=5,15,7\n");
    CHECK(state.mode == PILOT_OUTLINING && state.outline.count == 0); /* on to the next */
    CHECK_TEXT(type("u"), "undo\n");
    for (uint32_t i = 0; i < 4; i++) { /* corners by clicks, the last by a hand that shakes */
        CHECK_HAS(mouse(MOUSE_PRESSED, 8 + 8 * (i == 1 || i == 2), 8 + 8 * (i / 2)), "cross ");
        CHECK_TEXT(mouse(MOUSE_RELEASED, 9, 9), "");
    }
    CHECK_INT(state.outline.count, 4);
    shown_pane = PILOT_RENDITION; /* does not take the corners away */
    mouse(MOUSE_PRESSED, 3, 3);
    mouse(MOUSE_RELEASED, 3, 3);
    CHECK(state.mode == PILOT_OUTLINING);
    press(KEY_ENTER, 0, 0);
    CHECK_TEXT(buf_text(&line), "outline 8,8,7 2 to=16,8,7 to=16,16,7 to=8,16,7\n");
    facts.place[2] = 9;
    facts.place[0] = 8;
    facts.place[1] = 16;
    CHECK_HAS(type("."), ",9 2 to=");
}

STORY(an_outline_that_is_there_is_dragged_and_planted)
{
    begin();
    outline_side = 20;
    outline_marker = 0;
    facts.place[2] = 7;
    CHECK_TEXT(type("U"), "");
    CHECK_TEXT(buf_text(&message), "a square of label 1");
    CHECK(state.mode == PILOT_SHAPING);
    CHECK_TEXT(hint_now(), "the mouse drags it  Enter plants it  v takes hold, lets go  "
                           "Escape drops it");
    press(KEY_ENTER, 0, 0); /* as it is */
    CHECK_TEXT(buf_text(&line), "outline 4,4,7 1 to=24,4,7 to=24,24,7 to=4,24,7\n");
    outline_marker = 12;
    type("U");
    shown_pane = PILOT_AXIAL;
    mouse(MOUSE_PRESSED, 14, 14); /* far from the line */
    CHECK_TEXT(buf_text(&message), "the outline is more than 8 voxels from here");
    mouse(MOUSE_MOVED, 14, 20);
    CHECK(!state.is_bent);
    mouse(MOUSE_RELEASED, 14, 20);
    mouse(MOUSE_PRESSED, 14, 5);
    mouse(MOUSE_MOVED, 14, 9);
    mouse(MOUSE_MOVED, 14, 1);
    mouse(MOUSE_RELEASED, 14, 1);
    CHECK(state.is_bent && !state.hold.is_set && state.mode == PILOT_SHAPING);
    uint32_t top = 99; /* of the line: a bulge of 4 at x = 14, nothing at the corners */
    for (size_t i = 0; i < state.outline.count; i++)
        top = state.outline.corner[i][1] < top ? state.outline.corner[i][1] : top;
    CHECK_INT(top, 0);
    CHECK(memcmp(state.outline.corner[7], (uint32_t[]){24, 24, 7}, 12) == 0);
    CHECK_TEXT(type("U"), ""); /* which is not lost */
    CHECK_TEXT(buf_text(&message), "Enter plants the outline first, Escape drops it");
    press(KEY_ENTER, 0, 0);
    CHECK_HAS(buf_text(&line), "outline 4,3,7 1 to=");
    CHECK_HAS(buf_text(&line), " instead=12\n");
    type("U");
    memcpy(facts.place, (uint32_t[]){4, 14, 7}, sizeof facts.place);
    type("v");
    walk("2h");
    const size_t bent = state.outline.count;
    CHECK(state.hold.is_set && bent > 4);
    press(KEY_ESCAPE, 0, 0); /* as it was, */
    CHECK(state.mode == PILOT_SHAPING && state.outline.count == 4);
    press(KEY_ESCAPE, 0, 0); /* and gone */
    CHECK(state.mode == PILOT_MOVING && state.outline.count == 0 && state.instead == 0);
    outline_side = 0;
    type("U");
    CHECK_TEXT(buf_text(&message), "label 1 is not here; @ draws an outline");
    CHECK(state.mode == PILOT_MOVING);
}

STORY(the_slice_that_is_least_certain_comes_with_its_outline)
{
    begin();
    outline_side = 20;
    outline_marker = 0;
    doubts = 2;
    type("\t");
    state.pane = PILOT_SAGITTAL;
    CHECK_TEXT(type("}"), "cross 9,9,1\n");
    CHECK(state.pane == PILOT_AXIAL && state.mode == PILOT_SHAPING);
    CHECK_HAS(buf_text(&message), "label 1, rank 1; a square of label 1");
    CHECK_TEXT(type("}"), "cross 9,9,2\n");
    CHECK_TEXT(type("}"), "cross 9,9,1\n"); /* after the last one the first */
    CHECK_TEXT(type("2}"), "cross 9,9,2\n");
    CHECK_TEXT(type("{"), "cross 9,9,1\n");
    press(KEY_ENTER, 0, 0);
    CHECK_HAS(buf_text(&line), "outline 4,4,1 1 to=");
    CHECK_INT(state.doubt, 0);
    outline_side = 0; /* nothing of it lies there yet */
    CHECK_TEXT(type("2}"), "cross 9,9,2\n");
    CHECK(state.mode == PILOT_MOVING);
    CHECK_HAS(buf_text(&message), "label 1 is not here; @ draws an outline");
    doubts = 0;
    CHECK_TEXT(type("}"), "");
    CHECK_TEXT(buf_text(&message), "nothing of label 1 is in doubt");
}

STORY(what_the_pen_draws_is_one_command_once_it_is_lifted)
{
    begin();
    CHECK_TEXT(walk("v2+lllkk"), "cross 17,27,30\nseed 17,27,30 1 radius=2 to=17,26,30\n");
    CHECK(state.sketches && state.is_silent);
    CHECK_TEXT(walk("v"), "cross 17,27,30\nseed 20,25,30 1 radius=2 to=17,25,30 to=17,27,30\n");
    CHECK(!state.sketches && !state.pen.is_down && !state.is_silent);
    CHECK_TEXT(walk("v"), ""); /* down again, and nothing drawn */
    CHECK_TEXT(walk("v"), "");
    walk("vh");
    CHECK_TEXT(walk("r"), "cross 18,27,30\nseed 17,27,30 1 radius=2 to=18,27,30\nturn 15\n");
    CHECK(state.pen.is_down); /* and goes on from there */
    walk("hh");
    CHECK_TEXT(walk("b"), "cross 20,27,30\nseed 18,27,30 1 radius=2 to=20,27,30\n");
    walk("l");
    CHECK_TEXT(walk(":"), "cross 19,27,30\nseed 20,27,30 2 radius=2 to=19,27,30\n");
    CHECK(deed == PILOT_PROMPT);
    walk("J");
    CHECK_TEXT(walk("u"), "cross 19,27,29\nseed 19,27,30 2 radius=2 to=19,27,29\nundo\n");
    walk("l");
    CHECK_TEXT(walk("?"), ""); /* what changes nothing ends nothing */
    CHECK_TEXT(walk("12"), "");
    press(KEY_ESCAPE, 0, 0); /* of the count */
    CHECK(!state.drops && state.pen.is_down);
    press(KEY_ESCAPE, 0, 0);
    CHECK(state.drops && !state.pen.is_down);
    CHECK_TEXT(buf_text(&line), "");
    CHECK_TEXT(buf_text(&message), "the stroke is dropped, and the pen is up");
    walk("vl");
    CHECK_TEXT(walk("q"), "cross 17,27,29\nseed 18,27,29 2 radius=2 to=17,27,29\n");
    CHECK(deed == PILOT_LEAVE);
}

STORY(a_stroke_too_long_for_a_line_is_in_parts_that_are_joined)
{
    unsigned x = 20, y = 25, z = 30, from[3], label, steps = 0, lines = 0;
    begin();
    walk("v");
    for (int i = 0; i < 12000; i++)
        walk(i % 2 ? "k" : "l"); /* stairs, as far as the scene goes */
    for (int i = 0; i < 12000; i++)
        walk(i % 4 == 0 ? "k" : i % 4 == 1 ? "l" : i % 4 == 2 ? "j" : "h");
    walk("v");
    const char *at = buf_text(&line);
    CHECK(sscanf(at, "cross %u", &x) == 1);
    at = strchr(at, '\n') + 1;
    for (; *at; at = strchr(at, '\n') + 1, lines++) {
        const char *end = strchr(at, '\n');
        CHECK(end - at < 65535 &&
              sscanf(at, "seed %u,%u,%u %u", &from[0], &from[1], &from[2], &label) == 4);
        CHECK(lines == 0 || (from[0] == x && from[1] == y && from[2] == z));
        CHECK((memcmp(end - 11, " joined=yes", 11) == 0) == (lines > 0));
        for (const char *to = at; (to = strstr(to, " to=")) && to < end; to++, steps++)
            CHECK(sscanf(to, " to=%u,%u,%u", &x, &y, &z) == 3);
    }
    CHECK(lines == 3 && steps > 12000);
    CHECK(x == facts.place[0] && y == facts.place[1] && z == facts.place[2]);
}

STORY(an_eliminator_shows_first_what_it_takes)
{
    begin();
    CHECK_TEXT(type("x"), "");
    CHECK_TEXT(buf_text(&message), "marker 7 of 5 voxels at 20; x removes it");
    CHECK(state.mode == PILOT_CONFIRMING);
    CHECK_TEXT(type("x"), "remove 20,25,30\n");
    CHECK(state.mode == PILOT_MOVING);
    CHECK_TEXT(type("xX"), ""); /* the marker, and then its tree instead */
    CHECK_TEXT(buf_text(&message), "the tree of 5 voxels at 20; X removes it");
    CHECK(state.mode == PILOT_CONFIRMING_TREE);
    CHECK_TEXT(type("x"), ""); /* and back */
    CHECK(state.mode == PILOT_CONFIRMING);
    CHECK_TEXT(type("XX"), "remove 20,25,30 of=tree\n");
    CHECK(state.mode == PILOT_MOVING);
    type("x");
    CHECK_TEXT(type("l"), "cross 19,25,30\n"); /* another key does what it does, and nothing goes */
    type("x");
    CHECK_TEXT(type("10l"), "cross 10,25,30\n");
    type("x");
    CHECK_TEXT(type("s2"), "seed 20,25,30 2\n");
    type("x");
    press(KEY_ESCAPE, 0, 0);
    CHECK_TEXT(buf_text(&line), "");
    CHECK(state.mode == PILOT_MOVING);
    has_tree = false;
    type("x");
    CHECK_HAS(buf_text(&message), "no tree holds this voxel");
    CHECK(state.mode == PILOT_MOVING);
}

STORY(a_path_is_shown_and_its_strongest_edge_corrected)
{
    begin();
    shown_way = (struct pilot_way){
        .label = 1, .next = 3, .root = {5, 6, 7}, .has_edge = true, .edge = {9, 10, 11}};
    CHECK_TEXT(type("P"), "");
    CHECK(state.mode == PILOT_EXPLAINING);
    CHECK_TEXT(buf_text(&message), "why 20");
    buf_clear(&message);
    pilot_keys_hint(&state, &facts, &message);
    CHECK_TEXT(buf_text(&message), "P to its strongest edge  i the next label there  S shell  "
                                   "I stroke  Escape ends");
    CHECK_TEXT(type("P"), "cross 9,10,11\n");
    CHECK(state.mode == PILOT_MOVING);
    CHECK_TEXT(type("''"), ""); /* whence it jumped */
    CHECK_TEXT(type("2+Pi"), "cross 9,10,11\nseed 9,10,11 3 radius=2\n");
    CHECK_INT(state.brush.label, 3);
    CHECK_TEXT(type("Ps0"), "cross 9,10,11\nseed 9,10,11 0 radius=2\n");
    CHECK_TEXT(type("PS"), "cross 9,10,11\nseed 5,6,7 3 shell=yes around=1 through=9,10,11\n");
    CHECK_TEXT(type("PI"), "cross 9,10,11\n");
    memcpy(facts.place, (uint32_t[]){9, 10, 11}, sizeof facts.place);
    facts.place[1] = 14;
    CHECK_TEXT(type("i"), "seed 9,14,11 3 radius=2 to=9,10,11\n");
    CHECK_TEXT(type("Pl"), "cross 8,14,11\n"); /* another key does what it does */
    CHECK_TEXT(type("P4"), "");                /* no digit alone plants */
    CHECK_TEXT(type("l"), "cross 5,14,11\n");
    type("P");
    press(KEY_ESCAPE, 0, 0);
    CHECK(state.mode == PILOT_MOVING);
    shown_way.has_edge = false;
    CHECK_TEXT(type("Pi"), "");
    CHECK_HAS(buf_text(&message), "there is no edge to go to");
    has_tree = false;
    CHECK_TEXT(type("P"), "");
    CHECK(state.mode == PILOT_MOVING);
    has_tree = true;
    CHECK_TEXT(type("pP"), "cross 32,24,9\n"); /* of what the rendition shows */
    CHECK(state.mode == PILOT_EXPLAINING && state.base == PILOT_PICKING);
}

STORY(hints_are_walked_round_and_round)
{
    begin();
    hint_count = 3;
    CHECK_TEXT(type(")"), "hint 1\n");
    CHECK_TEXT(type(")"), "hint 2\n");
    CHECK_TEXT(type("("), "hint 1\n");
    CHECK_TEXT(type("("), "hint 3\n");
    CHECK_TEXT(type(")"), "hint 1\n");
    CHECK_TEXT(type("7)"), "hint 7\n"); /* which the command refuses */
    CHECK_TEXT(type("("), "hint 3\n");
    CHECK_TEXT(type("2("), "hint 2\n");
    hint_count = 0; /* the command says why */
    CHECK_TEXT(type(")"), "hint 1\n");
    CHECK_TEXT(type("("), "hint 1\n");
    facts.place[0] = 3;
    CHECK_TEXT(type("''"), "cross 20,25,30\n");
    CHECK(!state.heat);
    CHECK_TEXT(type("gh"), "");
    CHECK(state.heat && message.length);
    type("gh");
    CHECK(!state.heat);
}

STORY(a_change_is_repeated)
{
    begin();
    CHECK_TEXT(type("."), "");
    CHECK_HAS(buf_text(&message), "nothing has been changed yet");
    type("++s4");
    type("5l");
    facts.place[0] = 15;
    CHECK_TEXT(type("."), "seed 15,25,30 4 radius=2\n"); /* here, whatever was moved meanwhile */
    type("xx");
    CHECK_TEXT(type("."), "remove 15,25,30\n");
    CHECK_TEXT(type("c"), "plane 15,25,30\n");
    CHECK_TEXT(type("C"), "plane none\n");
    CHECK_TEXT(type("."), "plane 15,25,30\n");
    CHECK_TEXT(type("12e"), "hide 12\n");
    hidden[12] = true;
    CHECK_TEXT(type("."), "show 12\n");
}

STORY(a_box_or_a_polygon_is_repeated_beside_the_cross_hair)
{
    begin();
    type("a");
    memcpy(facts.place, (uint32_t[]){25, 28, 30}, sizeof facts.place);
    CHECK_TEXT(type("d"), "box 20,25,30 25,28,30 1\n");
    memcpy(facts.place, (uint32_t[]){35, 8, 31}, sizeof facts.place);
    CHECK_TEXT(type("3b."), "box 30,5,31 35,8,31 3\n"); /* by the brush that there is */
    CHECK_INT(state.outline.count, 0);
    CHECK_TEXT(type("d"), "");
    CHECK_HAS(buf_text(&message), "there are 0");
    facts.place[1] = 2;
    CHECK_TEXT(type("."), "");
    CHECK_TEXT(buf_text(&message), "here it would leave the scene");
    CHECK_INT(state.outline.count, 0);
    type("a");
    facts.place[0]++;
    type("a");
    facts.place[1]++;
    type("a");
    CHECK_TEXT(type("A"), "outline 35,2,31 3 to=36,2,31 to=36,3,31\n");
    facts.place[2] += 4;
    CHECK_TEXT(type("."), "outline 35,2,35 3 to=36,2,35 to=36,3,35\n");
    CHECK_TEXT(type("."), "outline 35,2,35 3 to=36,2,35 to=36,3,35\n");
}

STORY(what_is_shown)
{
    begin();
    CHECK_TEXT(type("e"), "hide 1\n");
    hidden[1] = hidden[7] = true;
    CHECK_TEXT(type("e"), "show 1\n");
    has_seed = false; /* nor a voxel */
    CHECK_TEXT(type("e"), "show 1\n");
    CHECK_TEXT(type("5e"), "");
    CHECK_TEXT(buf_text(&message), "there is no label 5 to hide: it has no voxel and no seed");
    has_seed = true;
    CHECK_TEXT(type("E"), "show all\n");
    memset(hidden, 0, sizeof hidden);
    CHECK_TEXT(type("E"), "");
    CHECK_TEXT(type("s0e"), ""); /* the background is in no picture */
    CHECK_HAS(buf_text(&message), "never shown");
    CHECK_TEXT(type("300e"), "");
    CHECK_TEXT(type("o"), "overlay tint\n");
    facts.overlay = 1;
    CHECK_TEXT(type("o"), "overlay contour\n");
    facts.overlay = 2;
    CHECK_TEXT(type("o"), "overlay none\n");
    CHECK_TEXT(type("y"), "");
    CHECK_HAS(buf_text(&message), "`:finish relax` has them settle");
    facts.has_finish = true;
    CHECK_TEXT(type("y"), "finished on\n");
    facts.shows = PILOT_ROUGH;
    CHECK_TEXT(type("y"), "finished off\n");
    facts.shows = PILOT_FINISHED;
    CHECK_TEXT(type("y"), "finished off\n");
}

STORY(the_view_and_the_window)
{
    begin();
    CHECK_TEXT(type("r"), "turn 15\n");
    CHECK_TEXT(type("3R"), "turn -45\n");
    CHECK_TEXT(arrow(KEY_UP, KEY_SHIFT), "turn 0 15\n");
    CHECK_TEXT(arrow(KEY_LEFT, KEY_SHIFT), "turn -15\n");
    CHECK_TEXT(type(">"), "turn 0 0 15\n");
    CHECK_TEXT(type("2<"), "turn 0 0 -30\n");
    CHECK_TEXT(arrow(KEY_DOWN, KEY_ALT), "pan 0 16\n");
    press(KEY_CHARACTER, KEY_ALT, 'l');
    CHECK_TEXT(buf_text(&line), "pan 16 0\n");
    CHECK_TEXT(type("Va"), "view front\n");
    CHECK_TEXT(type("Vp"), "view back\n");
    CHECK_TEXT(type("Vl"), "view left\n");
    CHECK_TEXT(type("Vr"), "view right\n");
    CHECK_TEXT(type("Vs"), "view top\n");
    CHECK_TEXT(type("Vi"), "view bottom\n");
    CHECK_TEXT(type("F"), "zoom fit\n");
    CHECK_TEXT(type("z"), "zoom 1.251\n");
    CHECK_TEXT(type("Z"), "zoom 0.8\n");
    facts.zoom = 64000;
    CHECK_TEXT(type("z"), "zoom 64\n");
    facts.fits_itself = true; /* around what is shown: from there it goes on */
    facts.middle[0] = 4, facts.middle[1] = 5, facts.middle[2] = 6;
    CHECK_TEXT(type("Z"), "zoom 51.2 at=4,5,6\n");
    CHECK_TEXT(arrow(KEY_DOWN, KEY_ALT), "focus 4,5,6\npan 0 16\n");
    facts.fits_itself = false;
    type("w");
    CHECK_TEXT(arrow(KEY_RIGHT, 0), "window -2 102\n"); /* wider */
    CHECK_TEXT(arrow(KEY_UP, 0), "window -2 98\n");     /* brighter */
    CHECK_TEXT(arrow(KEY_LEFT, KEY_CONTROL), "window 20 80\n");
    press(KEY_ENTER, 0, 0);
    CHECK(state.mode == PILOT_MOVING);
    CHECK_TEXT(type("wa"), "window auto\n");
    type("w");
    CHECK_TEXT(type("s2"), "seed 20,25,30 2\n"); /* another key does what it does */
    CHECK_TEXT(type(" "), "run\n");
}

STORY(corrections_are_made_on_the_rendition)
{
    begin();
    type("p");
    CHECK(state.mode == PILOT_PICKING && state.pixel[0] == 32 && state.pixel[1] == 24);
    CHECK_TEXT(type("llj"), "");
    CHECK_TEXT(type("2"), "cross 34,25,9\nseed 34,25,9 2\n"); /* a digit plants there, */
    CHECK(state.mode == PILOT_PICKING);                       /* and the pixel stays */
    facts.place[0] = 34, facts.place[2] = 9;
    press(KEY_ENTER, 0, 0);
    CHECK_TEXT(buf_text(&line), "seed 34,25,9 2\n");
    CHECK_TEXT(type("K"), "");
    CHECK_INT(state.pixel[1], 9);
    CHECK_TEXT(type("s0"), "cross 34,9,9\nseed 34,9,9 0\n");
    CHECK_TEXT(type("u"), "undo\n");
    CHECK_TEXT(type("r"), "turn 15\n");
    type("x");
    CHECK_HAS(buf_text(&message), "marker 7 of 5 voxels at 34"); /* the one that is seen there */
    CHECK_TEXT(buf_text(&line), "cross 34,9,9\n");
    facts.place[1] = 9;
    CHECK_TEXT(type("x"), "remove 34,9,9\n");
    CHECK(state.mode == PILOT_PICKING);
    CHECK_TEXT(type("G"), ""); /* no key is dropped without a word */
    CHECK_HAS(buf_text(&message), "this key does nothing here");
    CHECK_TEXT(type("hp"), "cross 33,9,9\n"); /* to its voxel */
    CHECK(state.mode == PILOT_MOVING);
    type("p");
    CHECK_INT(state.pixel[0], 33); /* where it was */
    for (int i = 0; i < 20; i++)
        type("L"); /* as far as the picture goes */
    CHECK_INT(state.pixel[0], 63);
    shows = false;
    press(KEY_ENTER, 0, 0);
    CHECK_TEXT(buf_text(&line), "");
    CHECK_HAS(buf_text(&message), "no object is seen at that pixel");
    CHECK_TEXT(type("x"), "");
    CHECK(state.mode == PILOT_PICKING);
    press(KEY_ESCAPE, 0, 0);
    CHECK(state.mode == PILOT_MOVING);
}

STORY(what_is_no_command)
{
    begin();
    CHECK_TEXT(type(":"), "");
    CHECK(deed == PILOT_PROMPT);
    type("q");
    CHECK(deed == PILOT_LEAVE);
    press(KEY_CHARACTER, KEY_CONTROL, 'l');
    CHECK(deed == PILOT_REDRAW);
    press(KEY_CHARACTER, KEY_CONTROL, 'z');
    CHECK(deed == PILOT_SUSPEND);
    type("?");
    CHECK(deed == PILOT_SHOW_KEYS);
    CHECK_TEXT(type("Y"), "");
    CHECK_HAS(buf_text(&message), "? shows the keys");
    press(KEY_OTHER, 0, 0);
    CHECK_TEXT(buf_text(&line), "");
    CHECK_TEXT(buf_text(&message), "");
}

STORY(what_was_chosen_stays_from_one_time_to_the_next)
{
    begin();
    type("7b3+");
    press(KEY_TAB, 0, 0);
    type("mkIv12");
    pilot_state_enter(&state);
    CHECK(state.mode == PILOT_MOVING && !state.pen.is_down && state.count == 0);
    CHECK(state.brush.label == 7 && state.brush.radius == 3 && state.pane == PILOT_CORONAL);
    CHECK_TEXT(type("i"), "seed 20,25,30 7 radius=3\n");
    memset(facts.place, 0, sizeof facts.place);
    CHECK_TEXT(type("'k"), "cross 20,25,30\n");
}

/* ---- the mouse ---- */

static enum mouse_button button = MOUSE_LEFT;
static const char *click(enum mouse_action action, uint32_t column, uint32_t row)
{
    const struct key_event event = {.key = KEY_MOUSE,
                                    .mouse = {.action = action, .button = button}};
    buf_clear(&line);
    buf_clear(&message);
    click_on(&event, column, row);
    return buf_text(&line);
}

STORY(a_click_takes_the_cross_hair_there_and_the_pen_draws)
{
    begin();
    shown_pane = PILOT_CORONAL;
    CHECK_TEXT(click(MOUSE_PRESSED, 3, 4), "cross 3,4,7\n");
    CHECK(state.pane == PILOT_CORONAL);
    memcpy(facts.place, (uint32_t[]){3, 4, 7}, sizeof facts.place);
    CHECK_TEXT(click(MOUSE_MOVED, 5, 4), "cross 5,4,7\n");
    CHECK_TEXT(click(MOUSE_RELEASED, 5, 4), "");
    CHECK_TEXT(click(MOUSE_MOVED, 6, 4), ""); /* not held */
    type("v2bi");
    click(MOUSE_PRESSED, 3, 4);
    CHECK_TEXT(click(MOUSE_MOVED, 5, 4), "cross 5,4,7\nseed 5,4,7 2 to=3,4,7\n");
    CHECK(state.sketches);
    shown_pane = PILOT_AXIAL; /* not from pane to pane */
    CHECK_TEXT(click(MOUSE_MOVED, 9, 4), "");
    facts.place[0] = 5;
    CHECK_TEXT(click(MOUSE_RELEASED, 9, 4), "cross 5,4,7\nseed 3,4,7 2 to=5,4,7\n");
    CHECK_TEXT(click(MOUSE_RELEASED, 9, 4), "");
    facts.place[0] = 3;
    CHECK_TEXT(click(MOUSE_WHEEL_UP, 1, 1), "cross 3,4,8\n");
    shown_pane = PILOT_RENDITION;
    CHECK_TEXT(click(MOUSE_WHEEL_DOWN, 1, 1), "zoom 0.8\n");
    CHECK_TEXT(click(MOUSE_PRESSED, 8, 9), "cross 8,9,7\n");
    shows = false;
    CHECK_TEXT(click(MOUSE_PRESSED, 8, 9), "");
    CHECK_HAS(buf_text(&message), "nothing is seen there");
}

STORY(the_right_button_pulls_a_shell_open)
{
    begin();
    type("2b");
    button = MOUSE_RIGHT;
    shown_pane = PILOT_CORONAL;
    CHECK_TEXT(click(MOUSE_PRESSED, 3, 4), "cross 3,4,7\n");
    memcpy(facts.place, (uint32_t[]){3, 4, 7}, sizeof facts.place);
    CHECK_TEXT(click(MOUSE_MOVED, 5, 4), "cross 5,4,7\n");
    CHECK_TEXT(click(MOUSE_RELEASED, 8, 4), "seed 3,4,7 0 shell=yes around=2 through=8,4,7\n");
    CHECK_TEXT(click(MOUSE_RELEASED, 8, 4), "");
    CHECK_TEXT(click(MOUSE_MOVED, 8, 4), "");
    click(MOUSE_PRESSED, 3, 4); /* and lets go of it in the middle */
    CHECK_TEXT(click(MOUSE_RELEASED, 3, 4), "");
    CHECK_INT(state.outline.count, 0);
    click(MOUSE_PRESSED, 3, 4);
    button = MOUSE_LEFT; /* another button ends it */
    click(MOUSE_PRESSED, 4, 4);
    CHECK_INT(state.outline.count, 0);
    button = MOUSE_RIGHT;
    CHECK_TEXT(click(MOUSE_RELEASED, 9, 4), "");
    click(MOUSE_PRESSED, 3, 4);
    shown_pane = PILOT_RENDITION; /* where no voxel of a slice is */
    CHECK_TEXT(click(MOUSE_MOVED, 8, 4), "");
    CHECK_INT(state.outline.count, 1);
    CHECK_TEXT(click(MOUSE_RELEASED, 8, 4), "");
    CHECK_INT(state.outline.count, 0);
    shown_pane = PILOT_CORONAL;
    CHECK_TEXT(click(MOUSE_RELEASED, 8, 4), "");
    shown_pane = PILOT_RENDITION;
    CHECK_TEXT(click(MOUSE_PRESSED, 3, 4), "");
    button = MOUSE_LEFT;
}

STORY(where_one_corrects_a_click_takes_the_pixel_there)
{
    begin();
    type("p");
    shown_pane = PILOT_RENDITION;
    CHECK_TEXT(click(MOUSE_PRESSED, 20, 30), "");
    CHECK(state.mode == PILOT_PICKING && state.pixel[0] == 10 && state.pixel[1] == 15);
    CHECK_TEXT(type("2"), "cross 10,15,9\nseed 10,15,9 2\n");
    shown_pane = PILOT_AXIAL;
    CHECK_TEXT(click(MOUSE_PRESSED, 20, 31), "cross 20,31,7\n");
    CHECK(state.mode == PILOT_MOVING); /* a slice is somewhere else */
}

/* Presses a key so often, each time with the facts that the last one made. */
static uint32_t magnified(const char *key, unsigned often)
{
    for (unsigned i = 0; i < often; i++) {
        unsigned whole = 1, thousandths = 0;
        char places[4] = "000";
        if (!*type(key))
            break;
        if (sscanf(buf_text(&line), "magnify %u.%3[0-9]", &whole, places) == 2)
            for (int k = 0; k < 3; k++)
                thousandths = thousandths * 10 + (places[k] ? (unsigned)(places[k] - '0') : 0);
        facts.times = 1000 * whole + thousandths * (places[1] ? places[2] ? 1 : 10 : 100);
    }
    return facts.times;
}

STORY(slices_are_magnified_around_the_cross_hair)
{
    begin();
    CHECK_TEXT(type("]"), "magnify 1.25 at=20,25,30\n");
    CHECK(state.is_silent);
    CHECK_TEXT(type("4]"), "magnify 2.5 at=20,25,30\n");
    CHECK_TEXT(type("["), "");
    CHECK_HAS(buf_text(&message), "slices are shown whole");
    CHECK_TEXT(type("W"), "");
    CHECK_TEXT(type("gz"), "");
    CHECK_HAS(buf_text(&message), "] shows them larger");
    facts.times = 1250;
    CHECK_TEXT(type("["), "magnify fit\n");
    facts.times = 2345; /* typed at the prompt */
    CHECK_TEXT(type("]"), "magnify 2.5 at=20,25,30\n");
    CHECK_TEXT(type("["), "magnify 2 at=20,25,30\n");
    CHECK_TEXT(type("gz"), "magnify 2.345 at=20,25,30\n");
    CHECK_TEXT(type("W"), "magnify fit\n");
    facts.times = PILOT_TIMES_ONE;
    CHECK_INT(magnified("]", 100), PILOT_TIMES_MOST);
    CHECK_HAS(buf_text(&message), "slices cannot be larger");
    CHECK_TEXT(type("["), "magnify 3072 at=20,25,30\n");
    shown_pane = PILOT_CORONAL;
    facts.times = 2000;
    const struct key_event wheel = {.key = KEY_MOUSE,
                                    .modifiers = KEY_CONTROL,
                                    .mouse = {MOUSE_WHEEL_UP, MOUSE_NO_BUTTON, 1, 1}};
    buf_clear(&line);
    click_on(&wheel, 8, 8);
    CHECK_TEXT(buf_text(&line), "magnify 2.5 at=20,25,30\n");
}

STORY(what_is_magnified_can_be_moved)
{
    begin();
    CHECK_TEXT(arrow(KEY_LEFT, KEY_ALT), "pan -16 0\n"); /* whole slices: the rendition */
    facts.times = 3000;
    CHECK_TEXT(arrow(KEY_RIGHT, KEY_ALT), "magnify 3 at=11,10,0\n");
    CHECK_TEXT(type("v"), "");
    CHECK_TEXT(arrow(KEY_LEFT, KEY_ALT), "cross 21,25,30\nmagnify 3 at=9,10,0\n"); /* no stroke */
    type("v");
    press(KEY_TAB, 0, 0);
    CHECK_TEXT(type("2"), "");
    CHECK_TEXT(arrow(KEY_DOWN, KEY_ALT), "magnify 3 at=10,12,1\n");
    goes_on = false;
    CHECK_TEXT(arrow(KEY_DOWN, KEY_ALT), "");
    CHECK_HAS(buf_text(&message), "the slice ends there");
    goes_on = true;
    type("p");
    CHECK_TEXT(arrow(KEY_DOWN, KEY_ALT), "pan 0 16\n"); /* where one corrects, the rendition */
}

STORY(one_pane_has_the_whole_screen_or_none)
{
    begin();
    CHECK(!state.is_alone);
    CHECK_TEXT(type("f"), "");
    CHECK(state.is_alone && state.mode == PILOT_MOVING);
    type("pf");
    CHECK(!state.is_alone && state.mode == PILOT_PICKING);
    type("f");
    pilot_state_enter(&state); /* and so the next time */
    CHECK(state.is_alone);
}

STORY(the_wheel_takes_the_question_about_a_tree_away)
{
    begin();
    shown_pane = PILOT_AXIAL;
    type("x");
    CHECK(state.mode == PILOT_CONFIRMING);
    CHECK_TEXT(click(MOUSE_WHEEL_UP, 1, 1), "cross 20,25,31\n"); /* where another tree may be */
    CHECK(state.mode == PILOT_MOVING);
    CHECK_TEXT(type("x"), "");
    CHECK_HAS(buf_text(&message), "x removes it");
    CHECK_TEXT(type("x"), "remove 20,25,30\n");
    facts.place[2] = size[2] - 1;
    CHECK_TEXT(click(MOUSE_WHEEL_UP, 1, 1), ""); /* at the edge there is nothing to record */
}

STORY(what_a_click_says_takes_the_place_of_what_was_said)
{
    const struct key_event event = {.key = KEY_MOUSE,
                                    .mouse = {.action = MOUSE_PRESSED, .button = MOUSE_LEFT}};
    begin();
    shows = false;
    buf_clear(&message);
    for (int i = 0; i < 2; i++)
        click_on(&event, 8, 9);
    CHECK_TEXT(buf_text(&message), "nothing is seen there");
}

/* All keys of a row, one after the other, each read. */
static size_t chords_of(const struct pilot_row *row, struct chord chords[8])
{
    const char *words[2] = {row->keys, row->also ? row->also : ""}, *word;
    size_t count = 0, length;
    for (int i = 0; i < 2; i++)
        while (row->name && chord_next(&words[i], &word, &length))
            CHECK(count < 8 && chord_read(word, length, &chords[count++]));
    return count;
}

static bool clash(const struct pilot_row *one, const struct pilot_row *other)
{
    struct chord a[8], b[8];
    const size_t as = chords_of(one, a), bs = chords_of(other, b);
    for (size_t i = 0; i < as; i++)
        for (size_t j = 0; j < bs; j++)
            if (chord_clashes(&a[i], &b[j]))
                return true;
    return false;
}

/* Two files have it, each after a mark. */
static void is_card_of(const char *path, const struct buf *page)
{
    static const char mark[] = "<!-- keys: the page that `?` shows -->\n\n```\n";
    struct buf readme = {0};
    CHECK(file_read(&readme, path, 1 << 20, NULL) == OK);
    const char *card = strstr(buf_text(&readme), mark);
    CHECK(card != NULL);
    if (card) {
        card += strlen(mark);
        CHECK(strncmp(card, buf_text(page), page->length) == 0);
        CHECK(strncmp(card + page->length, "```\n", 4) == 0);
    }
    buf_release(&readme);
}

STORY(the_page_of_keys_fits_and_is_the_card_in_the_readme)
{
    struct buf page = {0};
    pilot_keys_page(&page, &(struct pilot_keys_wish){&pilot_setup_default, false, 80, false, NULL});
    for (const char *at = buf_text(&page); *at; at += strcspn(at, "\n") + 1)
        CHECK(strcspn(at, "\n") <= 78);
    is_card_of("tui/README.md", &page);
    buf_release(&page);
}

STORY(the_page_of_keys_fits_any_window)
{
    for (unsigned columns = 20; columns < 100; columns++) {
        struct buf page = {0}, wrapped = {0};
        pilot_keys_page(
            &page, &(struct pilot_keys_wish){&pilot_setup_default, false, columns, false, NULL});
        cells_wrap(&wrapped, &page, columns);
        for (const char *at = buf_text(&wrapped); *at; at += strcspn(at, "\n") + 1)
            CHECK(cells_width(at, strcspn(at, "\r\n")) <= columns);
        buf_release(&page);
        buf_release(&wrapped);
    }
}

static const char *page_with(struct buf *page, const char *wanted, bool has_colours)
{
    buf_clear(page);
    pilot_keys_page(
        page, &(struct pilot_keys_wish){&pilot_setup_default, false, 80, has_colours, wanted});
    return buf_text(page);
}

STORY(the_page_of_keys_is_filtered)
{
    struct buf page = {0};
    CHECK_TEXT(page_with(&page, "CONT", false),
               "What is shown\n"
               "  o                overlay               contour; finish; greys\n"
               "  y                finished              contour; finish; greys\n"
               "  w                window                contour; finish; greys\n");
    CHECK_HAS(page_with(&page, "undo", false), "\n  u                undo  ");
    CHECK(!strstr(buf_text(&page), "contour"));
    CHECK_TEXT(page_with(&page, "xyzzy", false), "no key has to do with xyzzy\n");
    buf_release(&page);
}

STORY(headings_and_keys_have_colours_where_there_are_any)
{
    struct buf page = {0};
    CHECK_HAS(page_with(&page, "", true), "\033[1;36mWhat is planted\033[m\n");
    CHECK_HAS(buf_text(&page), "  \033[33mi Enter\033[m          a seed of the label ");
    CHECK(!strchr(page_with(&page, "", false), '\033'));
    buf_release(&page);
}

STORY(what_is_dangerous_and_how_to_begin_are_said)
{
    struct buf hint = {0};
    begin();
    pilot_keys_hint(&state, &facts, &hint);
    CHECK_HAS(buf_text(&hint), "nothing to show yet: i plants a seed here");
    facts.has_object = true;
    buf_clear(&hint);
    pilot_keys_hint(&state, &facts, &hint);
    CHECK_HAS(buf_text(&hint), "i seed  b label");
    facts.takes_all = true;
    buf_clear(&hint);
    pilot_keys_hint(&state, &facts, &hint);
    CHECK_HAS(buf_text(&hint), "takes all: a here, then beyond its edge S encloses it; s0 back");
    type("v");
    buf_clear(&hint);
    pilot_keys_hint(&state, &facts, &hint);
    CHECK_HAS(buf_text(&hint), "moving draws; v ends the stroke, Escape drops it");
    buf_release(&hint);
}

/* Of two rows, in a mode that both are for; and a key that waits for a second one does nothing. */
/* ---- how keys come ---- */

STORY(while_a_key_is_held_a_rendition_may_take_less_time)
{
    const uint64_t ms = 1000000, repeats = 33 * ms, begins = 300 * ms;
    struct pace pace = {.key_ns = 0};
    uint64_t now = 20 * ms;
    pace_key(&pace, now); /* soon after the clock began */
    CHECK(pace_within_ns(&pace) == PACE_SINGLE_NS);
    pace_key(&pace, now += begins);
    CHECK(pace_within_ns(&pace) == PACE_SINGLE_NS);
    for (int i = 0; i < 10; i++) {
        pace_key(&pace, now += repeats);
        CHECK(pace_within_ns(&pace) == PACE_BETWEEN_NS);
        CHECK(pace_rests_ns(&pace) > now + repeats);
    }
    pace_key(&pace, now += 2 * repeats); /* one was late */
    CHECK(pace_within_ns(&pace) == PACE_BETWEEN_NS);
    pace_key(&pace, now += begins);
    CHECK(pace_within_ns(&pace) == PACE_SINGLE_NS);
}

/* ---- slices that are sent ahead ---- */

/* Numbers are named from 1000 on, or what the cross-hair has moved by later; 4 and 7 are not
 * there. */
static unsigned named_from, drawn_ahead;
static uint64_t name_ahead(void *context, const struct pilot_wish *wish, unsigned number)
{
    (void)context, (void)wish;
    return number == 4 || number == 7 ? 0 : named_from + number;
}

static bool draw_ahead(void *context, const struct pilot_wish *wish, unsigned number,
                       struct image_view *view)
{
    (void)context, (void)wish, (void)number;
    *view = (struct image_view){.width = 1};
    drawn_ahead++;
    return true;
}

/* Sends all that is to go, a view in two parts. */
static unsigned send_all_ahead(struct ahead *ahead)
{
    const struct pilot_host from = {.name_ahead = name_ahead, .ahead = draw_ahead};
    const struct pilot_wish wish = {.width = 1};
    struct image_view *view;
    drawn_ahead = 0;
    while ((view = ahead_next(ahead, &from, &wish))) {
        CHECK(ahead_next(ahead, &from, &wish) == view); /* until it has gone */
        ahead_has_gone(ahead);
    }
    CHECK(ahead_is_over(ahead));
    return drawn_ahead;
}

STORY(slices_go_ahead_once_and_then_there_is_rest)
{
    struct ahead ahead = {.number = 0};
    named_from = 1000;
    CHECK_INT(send_all_ahead(&ahead), AHEAD_NUMBERS - 2);
    CHECK_INT(send_all_ahead(&ahead), 0);
    ahead_begin(&ahead); /* a key that changes nothing of them */
    CHECK_INT(send_all_ahead(&ahead), 0);
    named_from = 1001; /* 1004 and 1007 were not there before, and what comes after the last */
    ahead_begin(&ahead);
    CHECK_INT(send_all_ahead(&ahead), 3);
    named_from = 1000;
    ahead_begin(&ahead);
    CHECK_INT(send_all_ahead(&ahead), 0);
    ahead_forget(&ahead); /* the terminal may have dropped some */
    CHECK_INT(send_all_ahead(&ahead), AHEAD_NUMBERS - 2);
    for (unsigned i = 0; i < 100; i++) { /* what went long ago may go again */
        named_from = 5000 + i * 100;
        ahead_begin(&ahead);
        CHECK_INT(send_all_ahead(&ahead), AHEAD_NUMBERS - 2);
    }
}

/* A slice of some 25 kB takes 100 ms at 2 Mbit/s, and 10 at 20. */
STORY(nothing_goes_ahead_where_a_slice_is_there_in_no_time)
{
    CHECK(ahead_pays(&(struct flow){.per_byte_ns = 8e9 / 2e6}));
    CHECK(!ahead_pays(&(struct flow){.per_byte_ns = 8e9 / 20e6}));
    CHECK(!ahead_pays(&(struct flow){.per_byte_ns = 0}));
}

/* ---- the row below the picture ---- */

static const char *status_in(unsigned columns)
{
    buf_clear(&line);
    pilot_add_status(&line, &state, &host, &facts, columns);
    return buf_text(&line);
}

STORY(a_narrow_row_leaves_out_whole_parts_by_rank)
{
    static const char *const known[PILOT_KNOWN] = {
        "here 1",       " brain",           " 1.64 l", " (+1.2 ml)",
        "intensity 93", "0.5,18.0,-2.0 mm", "",        "mean 93, SD 12, 78 x 102 x 94 mm"};
    static const char *const part[] = {"axial",
                                       " at 20,25,30",
                                       "  brush 2",
                                       " ventricle",
                                       " r3",
                                       "  here 1",
                                       " brain",
                                       " 1.64 l",
                                       " (+1.2 ml)",
                                       "  intensity 93",
                                       "  0.5,18.0,-2.0 mm",
                                       "  mean 93, SD 12, 78 x 102 x 94 mm",
                                       "  3 wait for space"};
    begin();
    label_name = "ventricle";
    facts.index[0] = 30;
    facts.axis[0] = 2;
    facts.plane[0] = "axial";
    facts.times = PILOT_TIMES_ONE;
    for (int i = 0; i < PILOT_KNOWN; i++)
        snprintf(facts.known[i], PILOT_KNOWN_BYTES, "%s", known[i]);
    state.brush = (struct pilot_brush){.label = 2, .radius = 3};
    CHECK_TEXT(status_in(300),
               "axial at 20,25,30  brush 2 ventricle r3  here 1 brain 1.64 l "
               "(+1.2 ml)  intensity 93  0.5,18.0,-2.0 mm  mean 93, SD 12, 78 x 102 "
               "x 94 mm");
    CHECK_TEXT(status_in(103),
               "axial at 20,25,30  brush 2 ventricle r3  here 1 brain 1.64 l (+1.2 ml)  "
               "intensity 93  0.5,18.0,-2.0 mm");
    CHECK_TEXT(status_in(80),
               "axial at 20,25,30  brush 2 r3  here 1 brain  intensity 93  0.5,18.0,-2.0 mm");
    CHECK_TEXT(status_in(40), "axial at 20,25,30  brush 2 r3  here 1");
    CHECK_TEXT(status_in(20), "axial at 20,25,30");
    state.pen.is_down = true;
    CHECK_TEXT(status_in(20), "PEN DOWN  axial");
    state.pen.is_down = false;
    state.sends_ahead = true;
    CHECK_TEXT(status_in(80),
               "axial at 20,25,30  brush 2 r3  here 1 brain  intensity 93  0.5,18.0,-2.0 mm  >");
    state.sends_ahead = false;
    facts.waiting = 3; /* what keys do next comes before names */
    CHECK_TEXT(status_in(64), "axial at 20,25,30  brush 2 r3  3 wait for space  here 1 brain");
    for (unsigned columns = 20; columns < 200; columns++) {
        const char *at = status_in(columns);
        CHECK(strlen(at) <= columns);
        for (size_t i = 0; i < sizeof part / sizeof part[0]; i++) {
            const char *found = strstr(at, part[i]);
            while (found) {
                memset(line.data + (found - line.data), '#', strlen(part[i]));
                found = strstr(at, part[i]);
            }
        }
        CHECK_INT(strspn(at, "#"), strlen(at)); /* of whole parts alone */
    }
    facts.times = 1500;
    facts.waiting = 0;
    state.pen.is_down = true;
    CHECK_TEXT(status_in(58), "PEN DOWN  axial x1.5 at 20,25,30  brush 2 r3  here 1 brain");
    facts.shows = PILOT_ROUGH;
    CHECK_TEXT(status_in(63), "PEN DOWN  axial x1.5 at 20,25,30  brush 2 r3  finishing  here 1");
    label_name = "";
}

STORY(where_one_watches_keys_lead_from_step_to_step)
{
    struct buf page = {0};
    begin();
    state.watches = true;
    pilot_state_enter(&state);
    CHECK_TEXT(type(" "), "step on 1\n");
    CHECK_TEXT(type("12 "), "step on 12\n");
    CHECK_TEXT(arrow(KEY_BACKSPACE, 0), "step back 1\n");
    CHECK_TEXT(type("20G"), "step to 20\n");
    CHECK_TEXT(type("G"), "step to last\n");
    CHECK_TEXT(type("gg"), "step to 0\n");
    CHECK_TEXT(type("c"), "step comments\n");
    CHECK(state.has_pages);
    CHECK_TEXT(type("l"), "cross 19,25,30\n"); /* and one looks as ever */
    CHECK(!state.has_pages);
    CHECK_TEXT(type("w"), "");
    CHECK_INT(state.mode, PILOT_WINDOWING);
    press(KEY_ENTER, 0, 0);
    CHECK_INT(state.mode, PILOT_WATCHING);
    for (const char *none = "isuxvdSOPCI.+-M"; *none; none++) {
        press(KEY_CHARACTER, 0, *none);
        CHECK_TEXT(buf_text(&line), "");
        CHECK_HAS(buf_text(&message), "this key does nothing here; ? shows the keys");
    }
    pilot_keys_page(&page, &(struct pilot_keys_wish){&pilot_setup_default, true, 80, false, NULL});
    CHECK_HAS(buf_text(&page), "Space Backspace  a step on, back");
    CHECK(strstr(buf_text(&page), "undo, redo") == NULL);
    buf_clear(&page);
    pilot_keys_page(&page, &(struct pilot_keys_wish){&pilot_setup_default, false, 80, false, NULL});
    CHECK(strstr(buf_text(&page), "a step on, back") == NULL);
    buf_release(&page);
}

STORY(no_key_has_two_meanings)
{
    for (size_t i = 0; i < pilot_rows; i++)
        for (size_t j = 0; j < i; j++)
            if (pilot_table[i].in & pilot_table[j].in && clash(pilot_table + i, pilot_table + j))
                CHECK_TEXT(pilot_table[i].name, pilot_table[j].name);
}

STORY(any_keys_make_lines_that_are_whole)
{
    uint64_t seed = 4;
    begin();
    for (int i = 0; i < 20000; i++) {
        static const enum key keys[] = {KEY_CHARACTER, KEY_CHARACTER, KEY_CHARACTER, KEY_UP,
                                        KEY_LEFT,      KEY_ENTER,     KEY_ESCAPE,    KEY_TAB};
        const enum key key = keys[check_below(&seed, 8)];
        press(key, check_below(&seed, 6) ? 0 : check_below(&seed, 8),
              (char)(' ' + check_below(&seed, 95)));
        CHECK(line.length == 0 || line.data[line.length - 1] == '\n');
        CHECK(!line.failed && !message.failed);
        CHECK(state.brush.label < 256 && state.brush.radius <= (state.brush.in_mm ? 64 : 32) &&
              state.pane < PILOT_RENDITION);
        CHECK(state.pixel[0] < 64 && state.pixel[1] < 48);
    }
    buf_release(&line);
    buf_release(&message);
}

/* ---- finer and finer ---- */

enum { WIDTH = 70, HEIGHT = 45 };
static uint8_t wanted[4 * WIDTH * HEIGHT];
static const struct image_view view = {.width = WIDTH, .height = HEIGHT, .rgba = wanted};

static void paint(uint64_t *seed, uint32_t left, uint32_t top, uint32_t right, uint32_t bottom)
{
    for (uint32_t y = top; y < bottom; y++)
        for (uint32_t x = left; x < right; x++)
            for (int k = 0; k < 4; k++)
                wanted[4 * (y * WIDTH + x) + (unsigned)k] =
                    (uint8_t)(k == 3 ? 255 : check_below(seed, 256));
}

static size_t differing(const struct image_view *shown)
{
    size_t count = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        count += memcmp(shown->rgba + 4 * i, wanted + 4 * i, 4) != 0;
    return count;
}

STORY(with_room_enough_all_is_fine_at_once)
{
    struct refine r = {0};
    struct image_view shown;
    uint64_t seed = 1;
    paint(&seed, 0, 0, WIDTH, HEIGHT);
    CHECK(refine_begin(&r, &view, true, 1 << 20, &shown));
    CHECK_INT(differing(&shown), 0);
    CHECK(!r.is_coarse);
    refine_sent(&r, 5000);
    refine_release(&r);
}

STORY(with_little_room_it_is_coarse_first_and_fine_in_the_end)
{
    for (uint64_t seed = 1; seed < 30; seed++) {
        struct refine r = {0};
        struct image_view shown;
        unsigned frames = 0;
        paint(&seed, 0, 0, WIDTH, HEIGHT);
        CHECK(refine_begin(&r, &view, true, 300, &shown));
        CHECK(r.is_coarse && differing(&shown) > WIDTH * HEIGHT / 2);
        refine_sent(&r, 250);
        for (; r.is_coarse && frames < 100; frames++) {
            const size_t before = differing(&shown);
            CHECK(refine_begin(&r, &view, false, 300, &shown));
            CHECK(differing(&shown) < before || before == 0);
            refine_sent(&r, 300);
        }
        CHECK_INT(differing(&shown), 0);
        CHECK(frames > 2 && frames < 20);
        paint(&seed, 20, 20, 30, 25); /* a small change fits, and leaves the rest alone */
        CHECK(refine_begin(&r, &view, true, 300, &shown));
        CHECK_INT(differing(&shown), 0);
        refine_release(&r);
    }
}

STORY(what_tiles_cost_is_learnt)
{
    struct refine r = {0};
    struct image_view shown;
    uint64_t seed = 1;
    for (int i = 0; i < 12; i++) {
        paint(&seed, 0, 0, WIDTH, HEIGHT);
        CHECK(refine_begin(&r, &view, true, 4000, &shown));
        refine_sent(&r, r.tiles * 1000 >> 2 * r.level); /* ten times as dear as at first thought */
    }
    CHECK(r.level > 0);
    refine_forget(&r);
    CHECK(!r.is_coarse);
    refine_release(&r);
}

/* The middle of each block is a word's pixel, which no other pixel of the block takes. */
STORY(words_stay_sharp)
{
    static uint8_t words[WIDTH * HEIGHT];
    struct image_view with_words = view, shown;
    struct refine r = {0};
    uint64_t seed = 7;
    memset(words, 0, sizeof words);
    paint(&seed, 0, 0, WIDTH, HEIGHT);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        words[i] = i % WIDTH % 4 == 2 || i / WIDTH % 4 == 2;
        for (unsigned k = 0; k < 3 && !words[i]; k++)
            wanted[4 * i + k] &= 127;
        for (unsigned k = 0; k < 3 && words[i]; k++)
            wanted[4 * i + k] |= 128;
    }
    with_words.words = words;
    CHECK(refine_begin(&r, &with_words, true, 300, &shown));
    CHECK(r.level >= 2);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        if (words[i])
            CHECK(memcmp(shown.rgba + 4 * i, wanted + 4 * i, 4) == 0);
        else
            CHECK(shown.rgba[4 * i] < 128);
    refine_release(&r);
}

STORY(where_one_looks_gets_fine_first)
{
    struct image_view focused = view, shown;
    struct refine r = {0};
    uint64_t seed = 8;
    size_t left = 1;
    focused.focus = (struct raster_box){40, 20, 20, 20};
    paint(&seed, 0, 0, WIDTH, HEIGHT);
    CHECK(refine_begin(&r, &focused, true, 300, &shown));
    refine_sent(&r, 300);
    for (unsigned frame = 0; left > 0 && frame < 20; frame++) {
        CHECK(refine_begin(&r, &focused, false, 600, &shown));
        refine_sent(&r, 600);
        left = 0;
        for (uint32_t y = 20; y < 40; y++)
            left += memcmp(shown.rgba + 4 * (y * WIDTH + 40), wanted + 4 * (y * WIDTH + 40),
                           (size_t)4 * 20) != 0;
    }
    CHECK_INT(left, 0);
    CHECK(r.is_coarse && differing(&shown) > WIDTH * HEIGHT / 3);
    refine_release(&r);
}

/* ---- typed while a command is carried out ---- */

static struct typed_ahead ahead;

static void type_ahead(enum key key, char character)
{
    const struct key_event event = {.key = key, .point = (uint8_t)character};
    if (typed_ahead_has_room(&ahead))
        typed_ahead_add(&ahead, &event);
}

STORY(keys_typed_ahead_are_taken_in_their_order)
{
    struct key_event event;
    ahead = (struct typed_ahead){.count = 0};
    for (unsigned round = 0; round < 3; round++) {
        for (char c = 'a'; c <= 'z'; c++)
            type_ahead(KEY_CHARACTER, c);
        for (char c = 'a'; c <= 'z'; c++)
            CHECK(typed_ahead_take(&ahead, &event) && event.point == (uint8_t)c);
        CHECK(!typed_ahead_take(&ahead, &event));
    }
    for (unsigned i = 0; i < 2 * TYPED_AHEAD_MOST; i++)
        type_ahead(KEY_CHARACTER, 'x');
    CHECK_INT(ahead.count, TYPED_AHEAD_MOST); /* the rest stays with the terminal */
    ahead = (struct typed_ahead){.count = 0};
    type_ahead(KEY_PASTE_END, 0);
    CHECK(!typed_ahead_has_room(&ahead)); /* its text is kept once */
}

STORY(keys_typed_ahead_show_where_the_cross_hair_goes_and_no_more)
{
    begin();
    ahead = (struct typed_ahead){.count = 0};
    peeks = 0;
    type_ahead(KEY_CHARACTER, '1');
    type_ahead(KEY_CHARACTER, '0');
    type_ahead(KEY_CHARACTER, 'l');
    type_ahead(KEY_CHARACTER, 'l');
    type_ahead(KEY_TAB, 0);
    type_ahead(KEY_CHARACTER, 'K');
    struct pilot_state shown = state;
    typed_ahead_show(&ahead, &shown, &host);
    CHECK(facts.place[0] == 9 && peeks == 3);
    CHECK(shown.pane == PILOT_CORONAL && state.pane == PILOT_AXIAL);
    CHECK_INT(ahead.count, 6); /* they are still to be taken */
    type_ahead(KEY_CHARACTER, 'x');
    type_ahead(KEY_CHARACTER, 'l');
    begin();
    shown = state;
    typed_ahead_show(&ahead, &shown, &host);
    CHECK(facts.place[0] == 9 && shown.mode == PILOT_MOVING); /* up to what does more */
    state.pen.is_down = true;
    begin();
    state.pen.is_down = true;
    shown = state;
    peeks = 0;
    typed_ahead_show(&ahead, &shown, &host);
    CHECK_INT(peeks, 0); /* moving draws */
}

int main(void)
{
    return check_run();
}
