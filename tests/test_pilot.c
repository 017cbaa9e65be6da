/* SPDX-License-Identifier: MIT */
/* The pilot: what keys mean, as lines of commands; pictures that get finer on a slow line. */
#include "base/file.h"
#include "tests/check_main.h"
#include "tests/interpreting.h"
#include "tui/cells.h"
#include "tui/pilot/flow.h"
#include "tui/pilot/pilot_keys.h"

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

static unsigned has_tree = 1;
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
static void preview_cross(void *context, const uint32_t place[3])
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

static unsigned has_seed = 1;
static bool hidden[256];
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

/* Numbers of labels, or NULL: 0 to 255. */
static const uint32_t *numbers;
static unsigned number_count;

static bool next_label(void *context, uint32_t of, int by, uint32_t *next)
{
    (void)context;
    unsigned at = 0;
    while (numbers && at < number_count && numbers[at] != of)
        at++;
    if (numbers) {
        *next = numbers[at == number_count ? 1 : (at + number_count + (unsigned)by) % number_count];
        return at < number_count;
    }
    *next = of > 255 ? 1 : (of + 256 + (uint32_t)by) % 256;
    return of < 256;
}

static bool is_hidden(void *context, unsigned of)
{
    (void)context;
    return of < 256 && hidden[of];
}

static const char *label_name = "";
static void label(void *context, unsigned number, struct buf *out)
{
    (void)context;
    buf_printf(out, "%u%s%s", number, *label_name ? " " : "", label_name);
}

static unsigned shows = 1;
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

static unsigned goes_on = 1;
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
                                       .preview_cross = preview_cross,
                                       .seed = seed_of,
                                       .centre = centre,
                                       .doubt = doubt,
                                       .outline = outline_there,
                                       .is_hidden = is_hidden,
                                       .next_label = next_label,
                                       .label = label,
                                       .voxel_at = voxel_at,
                                       .voxel_of_frame = voxel_of_frame,
                                       .frame_pixel = frame_pixel};

static struct pilot_state state;
static struct buf line, message;
static enum pilot_request request;

static void begin(void)
{
    facts = (struct pilot_facts){.size = {size[0], size[1], size[2]},
                                 .place = {20, 25, 30},
                                 .plane = {"axial", "coronal", "sagittal"},
                                 .axis = {2, 1, 0},
                                 .window = {0, 100},
                                 .zoom = 1000,
                                 .default_zoom = 1000,
                                 .times = PILOT_TIMES_ONE,
                                 .frame_width = 64,
                                 .frame_height = 48,
                                 .has_label = true};
    has_tree = has_seed = shows = 1;
    memset(hidden, 0, sizeof hidden);
    pilot_state_release(&state);
    pilot_state_init(&state, &pilot_setup_default);
    state.brush.radius = 0;
}
EACH_STORY(begin, NULL)

static void press(enum key key, unsigned modifiers, char c)
{
    const struct key_event event = {
        .key = key, .modifiers = modifiers, .point = (uint8_t)c, .text = {c}, .length = 1};
    buf_clear(&line);
    buf_clear(&message);
    struct press press = {&state, &event, &host, &facts, &line, &message, 0, PILOT_NOTHING};
    request = pilot_press(&press);
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

static const char *hint_in(const char *bold)
{
    buf_clear(&line);
    pilot_keys_hint(&state, &facts, bold, &line);
    return buf_text(&line);
}

static const char *hint_now(void)
{
    return hint_in("");
}

static const struct {
    const char *name;
    struct mouse mouse;
    unsigned modifiers;
} use[] = {{"press", {MOUSE_PRESSED, MOUSE_LEFT, 0, 0}, 0},
           {"move", {MOUSE_MOVED, MOUSE_LEFT, 0, 0}, 0},
           {"release", {MOUSE_RELEASED, MOUSE_LEFT, 0, 0}, 0},
           {"right-press", {MOUSE_PRESSED, MOUSE_RIGHT, 0, 0}, 0},
           {"right-move", {MOUSE_MOVED, MOUSE_RIGHT, 0, 0}, 0},
           {"right-release", {MOUSE_RELEASED, MOUSE_RIGHT, 0, 0}, 0},
           {"wheel-up", {MOUSE_WHEEL_UP, MOUSE_LEFT, 0, 0}, 0},
           {"wheel-down", {MOUSE_WHEEL_DOWN, MOUSE_LEFT, 0, 0}, 0},
           {"Ctrl-wheel-up", {MOUSE_WHEEL_UP, MOUSE_NO_BUTTON, 0, 0}, KEY_CONTROL}};

static const struct {
    const char *name;
    unsigned *value;
} fact[] = {
    {"times", &facts.times},     {"zoom", &facts.zoom},   {"overlay", &facts.overlay},
    {"hints", &hint_count},      {"doubts", &doubts},     {"side", &outline_side},
    {"marker", &outline_marker}, {"has_seed", &has_seed}, {"has_tree", &has_tree},
    {"shows", &shows},           {"goes_on", &goes_on},   {"x", &facts.place[0]},
    {"y", &facts.place[1]},      {"z", &facts.place[2]},  {"pane", (unsigned *)&shown_pane}};

/* Use the mouse at a pixel, "press 5,6", place the cross-hair, "at 1,2,3", or set a fact,
 * "times=2000"; "y+2" adds to it. */
static void set_stage(const char *words)
{
    const size_t length = strcspn(words, " =+");
    unsigned n[3] = {0};
    const int count = sscanf(words + length + 1, "%u,%u,%u", &n[0], &n[1], &n[2]);
    bool is_known = count == 3;
    buf_clear(&line);
    buf_clear(&message);
    if (count == 3)
        memcpy(facts.place, n, sizeof facts.place);
    for (size_t i = 0; i < sizeof fact / sizeof *fact && count == 1; i++)
        if (strlen(fact[i].name) == length && memcmp(fact[i].name, words, length) == 0) {
            *fact[i].value = n[0] + (words[length] == '+' ? *fact[i].value : 0);
            is_known = true;
        }
    for (size_t i = 0; i < sizeof use / sizeof *use && count == 2; i++)
        if (strlen(use[i].name) == length && memcmp(use[i].name, words, length) == 0) {
            const struct key_event event = {
                .key = KEY_MOUSE, .mouse = use[i].mouse, .modifiers = use[i].modifiers};
            click_on(&event, n[0], n[1]);
            is_known = true;
        }
    CHECK_WITH(is_known, "%s", words);
}

/* Press keys: characters; in angle brackets other keys as the configuration names them, or words of
 * set_stage. With `walks` each moves the cross-hair to the place in its line. */
static void press_all(const char *keys, bool walks)
{
    for (; *keys; keys++) {
        char word[24] = "";
        const char *at = word;
        struct chord chord;
        const size_t length = *keys == '<' ? strcspn(keys, ">") : 0;
        snprintf(word, sizeof word, "%.*s", length ? (int)length - 1 : 1, keys + (length > 0));
        keys += length;
        const bool is_key = length && strcmp(word, "lt") != 0;
        if (is_key && strpbrk(word, "=+,"))
            set_stage(word);
        else if (is_key && CHECK(chord_next(&at, &chord) && chord.key != KEY_OTHER))
            press(chord.key, chord.modifiers, (char)chord.first);
        else
            press(KEY_CHARACTER, 0, length ? '<' : *word);
        if (walks)
            sscanf(buf_text(&line), "cross %u,%u,%u", &facts.place[0], &facts.place[1],
                   &facts.place[2]);
    }
}

/* Check rows of "KEYS|LINE|MESSAGE|MODE": the line and the message after the last key, and the
 * mode. Lines are separated by " / ". Parts may be left out; * is not compared, and a message that
 * begins with it is a part. */
static const char *const mode_name[] = {
    [PILOT_MOVING] = "moving",         [PILOT_PICKING] = "picking",
    [PILOT_CONFIRMING] = "confirming", [PILOT_CONFIRMING_TREE] = "confirming_tree",
    [PILOT_EXPLAINING] = "explaining", [PILOT_WINDOWING] = "windowing",
    [PILOT_RANGING] = "ranging",       [PILOT_OUTLINING] = "outlining",
    [PILOT_SHAPING] = "shaping",       [PILOT_WATCHING] = "watching"};

static void check_pressed(const char *const *row, bool walks, int at)
{
    for (; *row; row++) {
        char text[400], any[] = "*", *part[4], *end = text;
        OWNED(buf_release) struct buf got = {0};
        snprintf(text, sizeof text, "%s", *row);
        for (int i = 0; i < 4; i++) {
            part[i] = end ? end : any;
            end = end ? strchr(end, '|') : NULL;
            if (end)
                *end++ = '\0';
        }
        press_all(part[0], walks);
        for (const char *c = buf_text(&line); *c; c++)
            buf_add_text(&got, *c != '\n' ? (char[]){*c, '\0'} : c[1] ? " / " : "");
        if (line.length && line.data[line.length - 1] != '\n')
            buf_add_text(&got, " without a line feed");
        const char *said = buf_text(&message), *mode = mode_name[state.mode];
        const bool fine =
            (*part[1] == '*' || strcmp(buf_text(&got), part[1]) == 0) &&
            (*part[2] == '*' ? strstr(said, part[2] + 1) != NULL : strcmp(said, part[2]) == 0) &&
            (*part[3] == '*' || strcmp(mode, part[3]) == 0);
        if (!check_report(fine, __FILE__, at, *row))
            printf("#   is %s|%s|%s\n", buf_text(&got), said, mode);
    }
}

#define KEYS(...) check_pressed((const char *const[]){__VA_ARGS__, NULL}, false, __LINE__)
#define WALK(...) check_pressed((const char *const[]){__VA_ARGS__, NULL}, true, __LINE__)

STORY(arrows_and_letters_move_in_the_plane_that_is_marked)
{
    KEYS("<Right>|cross 19,25,30", /* towards the patient's left */
         "l|cross 19,25,30", "h|cross 21,25,30", "k|cross 20,26,30", "<Down>|cross 20,24,30",
         "J|cross 20,25,29", "<Page-up>|cross 20,25,31", "<Tab>", /* coronal */
         "k|cross 20,25,31", "K|cross 20,26,30", "<Tab>", /* sagittal: his front is on the left */
         "h|cross 20,26,30", "k|cross 20,25,31", "K|cross 21,25,30", "<Tab>l|cross 19,25,30");
}

STORY(counts_are_those_of_vim)
{
    KEYS("H|cross 30,25,30", "<Ctrl-Up>|cross 20,35,30", "1|*|1",
         "0||10", /* a digit alone plants nothing */
         "l|cross 10,25,30", "7h|cross 27,25,30", "h|cross 21,25,30", /* a count holds once */
         "12K|cross 20,25,42",
         "99999h|cross 39,25,30|19 of 9999: the edge of the scene", /* as far as the scene goes */
         "2H|cross 39,25,30|19 of 20: the edge of the scene",
         "40J|cross 20,25,0|30 of 40: the edge of the scene", "19h|*|",
         "<x=39>h||the edge of the scene", /* nowhere to go is no command */
         "5u|undo 5");
    CHECK(state.says_all);
    KEYS("u|undo", "<Ctrl-r>|redo", "0||*a count begins with 1-9; s0 plants",
         "12<Escape>" /* cancels the count alone */);
    CHECK_INT(state.count, 0);
    CHECK_TEXT(type("l"), "cross 38,25,30\n");
}

STORY(a_key_that_takes_no_count_does_nothing_with_one)
{
    KEYS("3i||*i accepts no count; nothing was done", "2s1||*accepts no count",
         "i|seed 20,25,30 1", /* and it is forgotten */
         "4q|");
    CHECK(request == PILOT_NOTHING);
}

STORY(some_keys_wait_for_a_second)
{
    KEYS("s|*|s0-9 plant-label  Escape leaves", "<Escape>");
    for (const char *led = "gVm'D"; *led; led++) {
        char key[3] = {*led, *led, '\0'};
        key[1] = '\0';
        type(key);
        CHECK_INT(strncmp(buf_text(&message), key, 1), 0);
        CHECK_HAS(buf_text(&message), "  Escape leaves");
        CHECK(message.length <= (*led == 'g' ? 160 : 80)); /* or both rows below the picture */
        press(KEY_ESCAPE, 0, 0);
    }
    KEYS("s3|seed 20,25,30 3", "sl||*does nothing here", "l|cross 19,25,30", /* it is over */
         "s<Escape>5l|cross 15,25,30");
}

STORY(slices_marks_and_seeds_to_go_to)
{
    KEYS("gg|cross 20,25,0", "G|cross 20,25,59", "12G|cross 20,25,12", "42gg|cross 20,25,42");
    facts.counts_down[0] = true; /* K leads to lower numbers: slice 0 is 30 of them up */
    KEYS("gg|cross 20,25,59", "28G|cross 20,25,32");
    facts.counts_down[0] = false;
    KEYS("ma'b||*there is no mark b; mb sets it", "<at 1,2,3>Da|measure 20,25,30 1,2,3",
         "Db||*there is no mark b; mb sets it", "'a|cross 20,25,30",
         "<at 20,25,30>''|cross 1,2,3", /* the place before the jump */
         "n|cross 1,11,5", "3N|cross 1,7,5", "bgc|cross 2,1,2");
    KEYS("<has_seed=0>n||*label 2 has no seed", "gc||*label 2 has no voxel",
         "vgg|cross 20,25,0" /* a jump draws nothing */);
}

STORY(seeds_brushes_and_strokes)
{
    KEYS("i|seed 20,25,30 1",                                   /* of the current label */
         "s3|seed 20,25,30 3|brush 3; ", "s3|seed 20,25,30 3|", /* once */
         "<Enter>|seed 20,25,30 3|", "bi|seed 20,25,30 4", "++i|seed 20,25,30 4 radius=2",
         "-s0|seed 20,25,30 0 radius=1", "Bi|seed 20,25,30 255 radius=1", /* they go round */
         "12bi|seed 20,25,30 12 radius=1",
         "256b|*|*there is no label 256; `:label 256 NAME` makes it");
    for (int i = 0; i < 50; i++)
        type("+");
    KEYS("s1|seed 20,25,30 1 radius=32", "9999-6+i|seed 20,25,30 1 radius=6",
         "4-+i|seed 20,25,30 1 radius=3", /* a count holds once */
         "99+i|seed 20,25,30 1 radius=32");
    for (int i = 0; i < 50; i++)
        type("-");
    KEYS("I<y=40>s2|seed 20,40,30 2 to=20,25,30", "i|seed 20,40,30 2", /* one stroke an end */
         "v");
    CHECK(state.pen.is_down && message.length == 0);
    CHECK_TEXT(type("l"), "cross 19,40,30\nseed 19,40,30 2 to=20,40,30\n");
    CHECK(state.sketches);
    KEYS("<Escape>l|cross 19,40,30");
    CHECK(!state.sketches);
}

STORY(a_radius_in_millimetres)
{
    KEYS("3+Mi|seed 20,25,30 1 radius=3mm|", "M|*|the brush: label 1, radius 3",
         "M-|*|the brush: label 1, radius 2.5mm", "i|seed 20,25,30 1 radius=2.5mm",
         "99+i|seed 20,25,30 1 radius=32mm", "99-i|seed 20,25,30 1",
         "+Mi|seed 20,25,30 1" /* rounded down to no voxel */);
}

/* Type a range; return it and what is planted then. */
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
    facts.intensity = -12.5;
    KEYS("t|*|the brush: label 1, radius 0, intensities -17.5..-7.5",
         "40ti|seed 20,25,30 1 range=-52.5..27.5", "+i|seed 20,25,30 1 range=-52.5..27.5 radius=1",
         "vl|cross 19,25,30 / seed 19,25,30 1 range=-52.5..27.5 radius=1 to=20,25,30",
         "t|cross 20,25,30 / seed 20,25,30 1 range=-52.5..27.5 radius=1 to=19,25,30",
         /* another brush ends the stroke */
         "v-");
    CHECK_TEXT(typed_range("80..120.5"), "seed 20,25,30 1 range=80..120.5\n");
    KEYS("T1..2<Escape>", /* leaves it as it was */
         "i|seed 20,25,30 1 range=80..120.5", "T7<Backspace><Backspace>");
    CHECK_TEXT(state.typed, "");
    press(KEY_ESCAPE, 0, 0);
    static const char *const wrong[] = {
        "5", "5..", "9..8", "..", "1..2..3", "2:1..2..3", "-", "1e..2", "1..99999999999999999999"};
    CHECK_TEXT(typed_range("1e-6..2.5e-6"), "seed 20,25,30 1 range=0.000001..0.0000025\n");
    CHECK_TEXT(typed_range("80..120.5"), "seed 20,25,30 1 range=80..120.5\n");
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        CHECK_TEXT(typed_range(wrong[i]), "seed 20,25,30 1 range=80..120.5\n");
    KEYS("T5<Enter>|*|expected LOW..HIGH, as in 40..1200.5, not 5; the brush is unchanged");
    for (int i = 0; i < 100; i++)
        type(i ? "1" : "T");
    CHECK_INT(strlen(state.typed), PILOT_RANGE_BYTES - 1);
    CHECK_TEXT(typed_range(""), "seed 20,25,30 1\n"); /* the limits are gone */
    KEYS("pT5..6<Enter>");
    CHECK(state.mode == PILOT_PICKING && state.brush.has_range);
}

STORY(messages_name_the_keys_that_the_user_has)
{
    struct pilot_setup own = pilot_setup_default;
    state.setup = &own;
    CHECK(setup_keys(&own, setup_row(&own, "keys"), "F", NULL) == OK);
    CHECK(setup_keys(&own, setup_row(&own, "mark"), "Sa-z", NULL) == OK);
    CHECK(setup_keys(&own, setup_row(&own, "plant-label"), ",0-9", NULL) == OK);
    CHECK(setup_keys(&own, setup_row(&own, "eliminate-it"), "y", NULL) == OK);
    KEYS("Q|*|this key does nothing here; F shows the keys",
         "0|*|a count begins with 1-9; ,0 plants a seed of label 0",
         "'q|*|there is no mark q; Sq sets it", "Sq|*|'q leads back here",
         "x|*|marker 7 of 5 voxels at 20; y removes it", "y|remove 20,25,30");
    CHECK_TEXT(hint_now(),
               "nothing to show yet: i plants a seed here, ,0 background; F keys  q back");
}

STORY(boxes_and_polygons_are_set_by_their_corners)
{
    KEYS("d||a box needs one corner, and there are 0; a sets it",
         "a||1 corner; d plants the box to the cross-hair, O its faces, S a ball's shell",
         "<at 5,6,7>d|box 20,25,30 5,6,7 1",
         "S||a ball needs one middle, and there are 0; a sets it",
         "a<x=9>S|seed 5,6,7 0 shell=yes around=1 through=9,6,7");
    CHECK_INT(state.outline.count, 0);
    KEYS("<x=5>a<at 9,10,11>O|box 5,6,7 9,10,11 0 shell=yes around=1",
         "<y=20>.|box 5,16,7 9,20,11 0 shell=yes around=1", "<at 5,6,7>2ba|", "<x=15>a|*|2 corners",
         "A||an outline needs 3 corners or more, and there are 2; a sets one",
         "d||a box needs one corner, and there are 2; Escape drops them",
         "<at 9,16,8>a|*|this is in another slice than the corners so far; Escape drops them",
         "<z=7>a|*|3 corners; A plants the outline");
    facts.intensity = 100;
    KEYS("10tA|outline 5,6,7 2 range=90..110 to=15,6,7 to=9,16,7");
    CHECK_INT(state.outline.count, 0);
    type("a");
    CHECK_TEXT(hint_now(), "1 corner  a another  d box to here  O faces  S ball's shell  "
                           "Escape drops it");
    KEYS("<x+1>a<y+1>a");
    CHECK_TEXT(hint_now(), "3 corners  a another  A plants the outline  Escape drops them");
    KEYS("<Escape>|*|the corners are dropped");
    CHECK_INT(state.outline.count, 0);
    type("I");
    CHECK_TEXT(hint_now(), "one end of a stroke  i plants it to here  Escape drops it");
}

STORY(an_outline_is_drawn_freehand_by_keys)
{
    WALK("@|||outlining");
    CHECK_TEXT(hint_now(), "moving, or the mouse, draws an outline  Enter plants it  "
                           "Escape drops it");
    WALK("5h|cross 25,25,30",       /* with counts, and nothing is planted */
         "4ki||*does nothing here", /* nor by keys of other modes */
         "5lr|turn 15",             /* which one may look around meanwhile */
         "w|", "<Enter>|*|*|outlining");
    CHECK_INT(state.outline.count, 4);
    KEYS("<Enter>|outline 20,25,30 1 to=25,25,30 to=25,29,30 to=20,29,30|*|moving");
    CHECK_INT(state.outline.count, 0);
    WALK("K|cross 20,29,31", ".|outline 20,25,31 1 to=25,25,31 to=25,29,31 to=20,29,31",
         "@ll@||*3 corners or more, and there are 2; Escape drops it",
         "<Escape>|*|the outline is dropped|moving");
    CHECK_INT(state.outline.count, 0);
    WALK("@@||the pen is up", /* down, and up again */
         "@lK|*|*another slice" /* and goes there */);
    CHECK_INT(state.outline.count, 2);
    WALK("Jk0", /* no label plants the rest, without a ring */
         "<Escape>vl@");
    CHECK_HAS(buf_text(&line), " to="); /* the stroke of the other pen ends */
    CHECK(!state.pen.is_down);
}

STORY(the_mouse_draws_an_outline_and_letting_go_closes_it)
{
    WALK("<pane=0>2b@", "<press 5,5>|cross 5,5,7", "<move 15,5><move 15,10><move 15,15><move 5,15>",
         "<release 5,15>|outline 5,5,7 2 to=15,5,7 to=15,15,7 to=5,15,7|*|outlining");
    CHECK_INT(state.outline.count, 0); /* on to the next */
    WALK("u|undo",                     /* corners by clicks, the last by a hand that shakes */
         "<press 8,8>|cross 8,8,7", "<release 9,9>|", "<press 16,8>|cross 16,8,7", "<release 9,9>|",
         "<press 16,16>|cross 16,16,7", "<release 9,9>|", "<press 8,16>|cross 8,16,7",
         "<release 9,9>|");
    CHECK_INT(state.outline.count, 4);
    WALK("<pane=3><press 3,3><release 3,3>|*|*|outlining", /* does not take the corners away */
         "<Enter>|outline 8,8,7 2 to=16,8,7 to=16,16,7 to=8,16,7", "<at 8,16,9>.");
    CHECK_HAS(buf_text(&line), ",9 2 to=");
}

STORY(an_outline_that_is_there_is_dragged_and_planted)
{
    KEYS("<side=20><marker=0><z=7>U||a square of label 1|shaping");
    CHECK_TEXT(hint_now(), "the mouse drags it  Enter plants it  v grabs, lets go  "
                           "Escape drops it");
    WALK("<Enter>|outline 4,4,7 1 to=24,4,7 to=24,24,7 to=4,24,7", /* as it is */
         "<marker=12>U", "<pane=0><press 14,14>|*|the outline is more than 8 voxels from here",
         "<move 14,20>");
    CHECK(!state.is_bent);
    WALK("<release 14,20><press 14,5><move 14,9><move 14,1><release 14,1>|*|*|shaping");
    CHECK(state.is_bent && !state.hold.is_set);
    uint32_t top = 99; /* top of the line: a bulge of 4 at x = 14, none at the corners */
    for (size_t i = 0; i < state.outline.count; i++)
        top = state.outline.corner[i][1] < top ? state.outline.corner[i][1] : top;
    CHECK_INT(top, 0);
    CHECK(memcmp(state.outline.corner[7], (uint32_t[]){24, 24, 7}, 12) == 0);
    KEYS("U||Enter plants the outline first, Escape drops it", /* which is not lost */
         "<Enter>");
    CHECK_HAS(buf_text(&line), "outline 4,3,7 1 to=");
    CHECK_HAS(buf_text(&line), " instead=12\n");
    WALK("U<at 4,14,7>v2h");
    CHECK(state.hold.is_set && state.outline.count > 4);
    KEYS("<Escape>|*|*|shaping"); /* as it was, */
    CHECK_INT(state.outline.count, 4);
    KEYS("<Escape>|*|*|moving"); /* and gone */
    CHECK(state.outline.count == 0 && state.instead == 0);
    KEYS("<side=0>U|*|label 1 is not here; @ draws an outline|moving");
}

STORY(the_slice_that_is_least_certain_comes_with_its_outline)
{
    KEYS("<side=20><marker=0><doubts=2>\t");
    state.pane = PILOT_SAGITTAL;
    KEYS("}|cross 9,9,1|*label 1, rank 1; a square of label 1|shaping");
    CHECK_INT(state.pane, PILOT_AXIAL);
    KEYS("}|cross 9,9,2", "}|cross 9,9,1", /* after the last one the first */
         "2}|cross 9,9,2", "{|cross 9,9,1", "<Enter>");
    CHECK_HAS(buf_text(&line), "outline 4,4,1 1 to=");
    CHECK_INT(state.doubt, 0);
    /* it has no outline there yet */
    KEYS("<side=0>2}|cross 9,9,2|*label 1 is not here; @ draws an outline|moving",
         "<doubts=0>}||nothing of label 1 is in doubt");
}

STORY(what_the_pen_draws_is_one_command_once_it_is_lifted)
{
    WALK("v2+lllkk|cross 17,27,30 / seed 17,27,30 1 radius=2 to=17,26,30");
    CHECK(state.sketches && state.is_silent);
    WALK("v|cross 17,27,30 / seed 20,25,30 1 radius=2 to=17,25,30 to=17,27,30");
    CHECK(!state.sketches && !state.pen.is_down && !state.is_silent);
    WALK("v|", /* down again, and nothing drawn */
         "v|", "vhr|cross 18,27,30 / seed 17,27,30 1 radius=2 to=18,27,30 / turn 15");
    CHECK(state.pen.is_down); /* and continues from there */
    WALK("hhb|cross 20,27,30 / seed 18,27,30 1 radius=2 to=20,27,30",
         "l:|cross 19,27,30 / seed 20,27,30 2 radius=2 to=19,27,30");
    CHECK(request == PILOT_PROMPT);
    WALK("Ju|cross 19,27,29 / seed 19,27,30 2 radius=2 to=19,27,29 / undo",
         "l?|", /* a key that changes nothing ends nothing */
         "12|", "<Escape>" /* cancels the count */);
    CHECK(!state.drops && state.pen.is_down);
    KEYS("<Escape>||the stroke is dropped, and the pen is up");
    CHECK(state.drops && !state.pen.is_down);
    WALK("vlq|cross 17,27,29 / seed 18,27,29 2 radius=2 to=17,27,29");
    CHECK(request == PILOT_LEAVE);
}

STORY(a_stroke_too_long_for_a_line_is_in_parts_that_are_joined)
{
    unsigned x = 20, y = 25, z = 30, from[3], label, steps = 0, lines = 0;
    press_all("v", true);
    for (int i = 0; i < 12000; i++)
        press_all(i % 2 ? "k" : "l", true); /* stairs, as far as the scene goes */
    for (int i = 0; i < 12000; i++)
        press_all((const char *[]){"k", "l", "j", "h"}[i % 4], true);
    press_all("v", true);
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
    KEYS("x||marker 7 of 5 voxels at 20; x removes it|confirming", "x|remove 20,25,30|*|moving",
         "xX||the tree of 5 voxels at 20; X removes it|confirming_tree",
         /* the marker, and then its tree instead */
         "x||*|confirming", /* and back */
         "XX|remove 20,25,30 of=tree|*|moving",
         "xl|cross 19,25,30", /* another key has its usual effect, and nothing is removed */
         "x10l|cross 10,25,30", "xs2|seed 20,25,30 2", "x<Escape>||*|moving");
    KEYS("<has_tree=0>x|*|*no tree holds this voxel|moving");
}

STORY(a_path_is_shown_and_its_strongest_edge_corrected)
{
    shown_way = (struct pilot_way){
        .label = 1, .next = 3, .root = {5, 6, 7}, .has_edge = true, .edge = {9, 10, 11}};
    KEYS("P||why 20|explaining");
    CHECK_TEXT(hint_now(), "P to its strongest edge  i the next label there  S shell  I stroke  "
                           "Escape ends");
    KEYS("P|cross 9,10,11|*|moving", "''|", /* whence it jumped */
         "2+Pi|cross 9,10,11 / seed 9,10,11 3 radius=2");
    CHECK_INT(state.brush.label, 3);
    KEYS("Ps0|cross 9,10,11 / seed 9,10,11 0 radius=2",
         "PS|cross 9,10,11 / seed 5,6,7 3 shell=yes around=1 through=9,10,11", "PI|cross 9,10,11",
         "<at 9,10,11><y=14>i|seed 9,14,11 3 radius=2 to=9,10,11",
         "Pl|cross 8,14,11", /* another key has its usual effect */
         "P4|",              /* no digit alone plants */
         "l|cross 5,14,11", "P<Escape>|*|*|moving");
    shown_way.has_edge = false;
    KEYS("Pi||*there is no edge to go to", "<has_tree=0>P||*|moving",
         "<has_tree=1>pP|cross 32,24,9|*|explaining"); /* the voxel that the rendition shows */
    CHECK_INT(state.base, PILOT_PICKING);
}

STORY(hints_are_walked_round_and_round)
{
    KEYS("<hints=3>)|hint 1", ")|hint 2", "(|hint 1", "(|hint 3", ")|hint 1",
         "7)|hint 7",                                  /* which the command refuses */
         "(|hint 3", "2(|hint 2", "<hints=0>)|hint 1", /* the command says why */
         "(|hint 1", "<x=3>''|cross 20,25,30");
    CHECK(!state.heat);
    KEYS("gh|");
    CHECK(state.heat && message.length);
    KEYS("gh");
    CHECK(!state.heat);
}

STORY(a_change_is_repeated)
{
    KEYS(".||*there is no change to repeat yet",
         "++s45l<x=15>.|seed 15,25,30 4 radius=2", /* here, whatever was moved meanwhile */
         "xx.|remove 15,25,30", "c|plane 15,25,30", "C|plane none", ".|plane 15,25,30",
         "12e|hide 12");
    hidden[12] = true;
    KEYS(".|show 12");
}

STORY(a_box_or_a_polygon_is_repeated_beside_the_cross_hair)
{
    KEYS("a<at 25,28,30>d|box 20,25,30 25,28,30 1",
         "<at 35,8,31>3b.|box 30,5,31 35,8,31 3" /* by the brush that there is */);
    CHECK_INT(state.outline.count, 0);
    KEYS("d||*there are 0", "<y=2>.||here it would extend beyond the scene");
    CHECK_INT(state.outline.count, 0);
    KEYS("a<x+1>a<y+1>aA|outline 35,2,31 3 to=36,2,31 to=36,3,31",
         "<z+4>.|outline 35,2,35 3 to=36,2,35 to=36,3,35",
         ".|outline 35,2,35 3 to=36,2,35 to=36,3,35");
}

STORY(what_is_shown)
{
    KEYS("e|hide 1");
    hidden[1] = hidden[7] = true;
    KEYS("e|show 1", "<has_seed=0>e|show 1", /* nor a voxel */
         "5e||there is no label 5 to hide: it has no voxel and no seed", "<has_seed=1>E|show all");
    memset(hidden, 0, sizeof hidden);
    KEYS("E|", "s0e||*never shown", /* the background is in no picture */
         "300e|", "o|overlay tint", "<overlay=1>o|overlay contour", "<overlay=2>o|overlay none",
         "y||*`:finish relax` settles them");
    facts.has_finish = true;
    KEYS("y|finished on");
    facts.shows = PILOT_ROUGH;
    KEYS("y|finished off");
    facts.shows = PILOT_FINISHED;
    KEYS("y|finished off");
}

STORY(the_view_and_the_window)
{
    KEYS("r|turn 15", "3R|turn -45", "<Shift-Up>|turn 0 15", "<Shift-Left>|turn -15",
         ">|turn 0 0 15", "2<lt>|turn 0 0 -30", "<Alt-Down>|pan 0 16", "<Alt-l>|pan 16 0",
         "Va|view front", "Vp|view back", "Vl|view left", "Vr|view right", "Vs|view top",
         "Vi|view bottom", "F|focus scene / zoom 1", "z|zoom 1.251", "Z|zoom 0.8",
         "<zoom=64000>z|zoom 64");
    facts.is_fitted = true; /* fitted automatically: continue from there */
    facts.middle[0] = 4, facts.middle[1] = 5, facts.middle[2] = 6;
    KEYS("Z|zoom 51.2 at=4,5,6", "<Alt-Down>|focus 4,5,6 / pan 0 16");
    facts.is_fitted = false;
    KEYS("w<Right>|window -2 102", /* wider */
         "<Up>|window -2 98",      /* brighter */
         "<Ctrl-Left>|window 20 80", "<Enter>|*|*|moving", "wa|window auto",
         "ws2|seed 20,25,30 2", /* another key has its usual effect */
         " |run");
}

/* ---- exact gestures ---- */

STORY(the_brush_is_exact_while_there_are_pieces_of_a_segmentation)
{
    shown_way = (struct pilot_way){
        .label = 1, .next = 3, .root = {5, 6, 7}, .has_edge = true, .edge = {9, 10, 11}};
    facts.has_pieces = true; /* `labels FILE` */
    KEYS("i|seed 20,25,30 1 within=0", "++s2|seed 20,25,30 2 within=0 radius=2",
         "I<x=15>i|seed 15,25,30 2 within=0 radius=2 to=20,25,30",
         "a<at 20,28,30>d|box 15,25,30 20,28,30 2 within=0",
         "a<z+5>S|seed 20,28,30 0 shell=yes around=2 through=20,28,35 within=0",
         "a<at 25,20,25>O|box 20,28,35 25,20,25 0 shell=yes around=2 within=0",
         "<z=30>a<x+1>a<y+1>aA|outline 25,20,30 2 within=0 to=26,20,30 to=26,21,30",
         "s0<z=31>.|seed 26,21,31 0 within=0 radius=2",
         "a<x+1>a<y+1>aA|fill 26,21,31 0 within=0 to=27,21,31 to=27,22,31",
         "Pi|cross 9,10,11 / seed 9,10,11 3 within=0 radius=2",
         "PS|cross 9,10,11 / seed 5,6,7 3 shell=yes around=1 through=9,10,11 within=0",
         "p2|cross 32,24,9 / seed 32,24,9 2 within=0 radius=2", "<Escape><at 20,25,30>u|undo");
    facts.has_pieces = false; /* of `labels` */
    KEYS("i|seed 20,25,30 2 radius=2", "ge||the brush: label 2, radius 2, exact",
         "i|seed 20,25,30 2 within=0 radius=2");
    facts.has_pieces = true;
    KEYS("u|undo", "ge||the brush: label 2, radius 2, grows", /* as the user says */
         "i|seed 20,25,30 2 radius=2", "gL|labels here", "i|seed 20,25,30 2 radius=2",
         "3ge||ge accepts no count; nothing was done",
         "@gel<Escape>i|seed 20,25,30 2 within=0 "
         "radius=2");
}

STORY(labels_have_the_numbers_of_their_file)
{
    static const uint32_t of_file[] = {0, 2, 41, 1035, 4294967295};
    numbers = of_file;
    number_count = 5;
    facts.has_pieces = facts.has_object = true;
    facts.label = 41;
    pilot_fit_label(&state, &host, &facts); /* the first object is a segmentation */
    KEYS("i|seed 20,25,30 41 within=0", "bi|seed 20,25,30 1035 within=0",
         "bi|seed 20,25,30 4294967295 within=0", "bi|seed 20,25,30 0 within=0",
         "Bi|seed 20,25,30 4294967295 within=0", "s2|seed 20,25,30 2 within=0",
         "s1||there is no label 1; `:label 1 NAME` makes it", "1035bi|seed 20,25,30 1035 within=0",
         "4294967295goi|seed 20,25,30 1035 within=0 over=4294967295", "77go||*there is no label 77",
         "a<x+1>O|box 20,25,30 21,25,30 0 shell=yes around=1035 within=0 over=4294967295",
         "e|hide 1035", "41e|hide 41", "3e||*there is no label 3");
    pilot_fit_label(&state, &host, &facts); /* it is not new any more */
    CHECK_INT(state.brush.label, 1035);
    facts.label = 0;
    state.had_object = false;
    pilot_fit_label(&state, &host, &facts);
    CHECK_INT(state.brush.label, 2); /* the smallest number */
    state.brush.label = 7;
    KEYS("i||there is no label 7; `:label 7 NAME` makes it");
    pilot_fit_label(&state, &host, &facts);
    CHECK_INT(state.brush.label, 2);
    numbers = NULL;
}

STORY(a_stroke_is_as_exact_as_its_brush)
{
    facts.has_pieces = true;
    WALK("v2+ll|cross 18,25,30 / seed 18,25,30 1 within=0 radius=2 to=19,25,30",
         "ge|cross 18,25,30 / seed 20,25,30 1 within=0 radius=2 to=18,25,30",
         "l|cross 17,25,30 / seed 17,25,30 1 radius=2 to=18,25,30",
         "5go|cross 17,25,30 / seed 18,25,30 1 radius=2 to=17,25,30|*over 5",
         "l|cross 16,25,30|*over needs an exact brush (ge)", /* it moves, and draws nothing */
         "gel|cross 15,25,30 / seed 15,25,30 1 within=0 over=5 radius=2 to=16,25,30",
         "7go|cross 15,25,30 / seed 16,25,30 1 within=0 over=5 radius=2 to=15,25,30",
         "lu|cross 14,25,30 / seed 15,25,30 1 within=0 over=7 radius=2 to=14,25,30 / undo");
    KEYS("v7gogev||"); /* no limit is left */
    CHECK(state.pen.is_down && state.brush.growth == BRUSH_GROWS);
}

STORY(a_brush_changes_one_label_alone_or_all_others)
{
    facts.has_pieces = true;
    facts.label = 0;
    KEYS("go||the brush: label 1, radius 0, exact, over 0", "i|seed 20,25,30 1 within=0 over=0",
         "go||the brush: label 1, radius 0, exact", /* again: off */
         "i|seed 20,25,30 1 within=0", "gO||*exact, keep 0", "i|seed 20,25,30 1 within=0 keep=0",
         "17go||*exact, over 17", "i|seed 20,25,30 1 within=0 over=17", "17gO||*exact, keep 17",
         "17gO||the brush: label 1, radius 0, exact", "300go||*there is no label 300");
    facts.label = 9;
    KEYS("*||the brush: label 9, radius 0, exact", "go||*, over 9", "4go||*, over 4",
         "i|seed 20,25,30 9 within=0 over=4", "go||*, over 9", "5*||* accepts no count",
         "<x+1>@4go||*, over 4|outlining", "go||*, over 9");
    facts.has_label = false;
    KEYS("<Escape>*||this voxel has no label", "gO||this voxel has no label",
         "i|seed 21,25,30 9 within=0 over=9");
    facts.has_label = true;
    facts.label = 0;
    KEYS("*||the brush: label 0, radius 0, exact, over 9", "i|seed 21,25,30 0 within=0 over=9",
         ".|seed 21,25,30 0 within=0 over=9");
}

STORY(a_brush_that_grows_limits_only_balls)
{
    static const char refused[] = "over needs an exact brush (ge), or a single ball of radius 1 or "
                                  "more; nothing was planted";
    static const char *const none[] = {"i", "s2",     "I<x+1>++i", "v", "<x+1>d",
                                       "S", "<z+1>O", "PS",        "A", "@llkkhh<Enter>"};
    shown_way = (struct pilot_way){.next = 3, .root = {5, 6, 7}, .has_edge = true};
    KEYS("a<x+3>d|box 20,25,30 23,25,30 1", "2go");
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        char row[200];
        state.brush.radius = 0;
        state.stroke.is_set = false;
        KEYS("a", i == 8 ? "<x+1>a<y+1>a" : "l");
        snprintf(row, sizeof row, "%s||*%s", none[i], refused);
        KEYS(row, "<Escape>|", "<Escape>|");
    }
    KEYS(".||*over needs an exact brush");
    CHECK_INT(state.outline.count, 0);
    KEYS("b++i|seed 26,26,31 3 over=2 radius=2", "Pi|*", "2gOi|seed 26,26,31 3 keep=2 radius=2",
         "ge.|seed 26,26,31 3 within=0 keep=2 radius=2");
}

STORY(the_first_exact_gesture_among_grown_objects_names_the_key_that_freezes_them)
{
    static const char warning[] = "*objects here were grown, and voxels beyond can change too; U, "
                                  "then gL keeps all labels as they are";
    struct pilot_setup own = pilot_setup_default;
    char row[200];
    state.setup = &own;
    CHECK(setup_keys(&own, setup_row(&own, "undo"), "U", NULL) == OK);
    facts.is_grown = true;
    KEYS("i|seed 20,25,30 1|", "gei|seed 20,25,30 1 within=0");
    snprintf(row, sizeof row, "i|*|%s", warning);
    KEYS(row);
    CHECK(state.is_silent);
    KEYS("vl|*|"); /* a sketch */
    facts.place[0]--;
    snprintf(row, sizeof row, "v|*|%s", warning);
    KEYS(row);
    facts.is_grown = false;
    KEYS("i|*|");
    CHECK(!state.is_silent);
}

/* Run random keys of the brush in a session: it refuses no command because of the brush. */
STORY(no_state_of_the_brush_makes_a_command_that_is_refused)
{
    static const char *const keys[] = {"ge", "go",      "gO",       "*",   "i",  "s2",    "s0",
                                       "+",  "-",       "v",        "l",   "k",  "J",     "a",
                                       "d",  "S",       "O",        "A",   "I",  "u",     "@",
                                       ".",  "<Enter>", "<Escape>", "3go", "gL", "llkkhh"};
    OWNED(interpreter_release) struct interpreter interp = {0};
    uint64_t seed = 7;
    unsigned exact = 0, over = 0;
    begin_interpreter(&interp);
    state.setup = &pilot_setup_default;
    must(&interp, "open synth:geom:40x50x60; auto on; seed 1,1,1 0; seed 20,25,30 1 radius=5");
    for (int i = 0; i < 1500; i++) {
        const struct session *session = interp.session;
        const struct marker_kinds kinds = markers_kinds(&session->markers, session->markers.count);
        const uint32_t *at = facts.place;
        facts.has_pieces = kinds.has_pieces;
        facts.is_grown = kinds.has_grown && !kinds.has_exact;
        facts.label =
            session->scene->cell[grid_cell(&session->scene->grid, at[0], at[1], at[2])].label;
        press_all(keys[check_below(&seed, sizeof keys / sizeof *keys)], true);
        OWNED(buf_release) struct buf lines = {0};
        buf_add_text(&lines, state.sketches ? "" : buf_text(&line));
        for (char *save = NULL, *next = strtok_r(lines.data, "\n", &save); next;
             next = strtok_r(NULL, "\n", &save)) {
            execute(&interp, next);
            exact += strstr(next, " within=0") != NULL;
            over += strstr(next, " over=") != NULL;
            if (!CHECK(!strstr(fault.text, "over, keep: only") && !strstr(fault.text, "within:")))
                printf("#   %s: %s\n", next, fault.text);
        }
    }
    CHECK(exact > 50 && over > 20);
    reply_release(&reply);
}

STORY(corrections_are_made_on_the_rendition)
{
    KEYS("p|*|*|picking");
    CHECK(state.pixel[0] == 32 && state.pixel[1] == 24);
    KEYS("llj|", "2|cross 34,25,9 / seed 34,25,9 2|*|picking" /* a digit plants there, */
         /* and the pixel stays */);
    KEYS("<x=34><z=9><Enter>|seed 34,25,9 2", "K|");
    CHECK_INT(state.pixel[1], 9);
    KEYS("s0|cross 34,9,9 / seed 34,9,9 0", "u|undo", "r|turn 15",
         "x|cross 34,9,9|*marker 7 of 5 voxels at 34", /* the one that is seen there */
         "<y=9>x|remove 34,9,9|*|picking",
         "G||*this key does nothing here", /* no key is dropped without a word */
         "hp|cross 33,9,9|*|moving",       /* to its voxel */
         "p");
    CHECK_INT(state.pixel[0], 33); /* where it was */
    for (int i = 0; i < 20; i++)
        type("L"); /* as far as the picture goes */
    CHECK_INT(state.pixel[0], 63);
    KEYS("<shows=0><Enter>||*that pixel shows no object", "x||*|picking", "<Escape>|*|*|moving");
}

STORY(what_is_no_command)
{
    static const struct {
        const char *keys;
        enum pilot_request request;
    } rows[] = {
        {":|", PILOT_PROMPT},        {"q", PILOT_LEAVE},        {"<Ctrl-l>", PILOT_REDRAW},
        {"<Ctrl-z>", PILOT_SUSPEND}, {"<Ctrl-o>", PILOT_LEAVE}, {"gl", PILOT_SHOW_LABELS},
        {"<Ctrl-c>||q leaves", 0},   {"?", PILOT_SHOW_KEYS},    {"Q||*? shows the keys", 0}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        KEYS(rows[i].keys);
        CHECK_INT(request, rows[i].request);
    }
    press(KEY_OTHER, 0, 0);
    CHECK_TEXT(buf_text(&line), "");
    CHECK_TEXT(buf_text(&message), "");
}

STORY(what_was_chosen_stays_from_one_time_to_the_next)
{
    KEYS("7b3+<Tab>mkIv12");
    pilot_state_enter(&state);
    CHECK(state.mode == PILOT_MOVING && !state.pen.is_down && state.count == 0);
    CHECK(state.brush.label == 7 && state.brush.radius == 3 && state.pane == PILOT_CORONAL);
    KEYS("i|seed 20,25,30 7 radius=3", "<at 0,0,0>'k|cross 20,25,30");
}

/* ---- the mouse ---- */

STORY(a_click_takes_the_cross_hair_there_and_the_pen_draws)
{
    KEYS("<pane=1><press 3,4>|cross 3,4,7");
    CHECK(state.pane == PILOT_CORONAL);
    KEYS("<at 3,4,7><move 5,4>|cross 5,4,7", "<release 5,4>|", "<move 6,4>|", /* not held */
         "v2bi", "<press 3,4>", "<move 5,4>|cross 5,4,7 / seed 5,4,7 2 to=3,4,7");
    CHECK(state.sketches);
    KEYS("<pane=0><move 9,4>|", /* not from pane to pane */
         "<x=5><release 9,4>|cross 5,4,7 / seed 3,4,7 2 to=5,4,7", "<release 9,4>|",
         "<x=3><wheel-up 1,1>|cross 3,4,8", "<pane=3><wheel-down 1,1>|zoom 0.8",
         "<press 8,9>|cross 8,9,7", "<shows=0><press 8,9>||*that pixel shows nothing");
}

STORY(the_right_button_pulls_a_shell_open)
{
    KEYS("2b", "<pane=1><right-press 3,4>|cross 3,4,7", "<at 3,4,7><right-move 5,4>|cross 5,4,7",
         "<right-release 8,4>|seed 3,4,7 0 shell=yes around=2 through=8,4,7",
         "<right-release 8,4>|", "<right-move 8,4>|",
         "<right-press 3,4><right-release 3,4>|"); /* lets go of it in the middle */
    CHECK_INT(state.outline.count, 0);
    KEYS("<right-press 3,4><press 4,4>"); /* another button ends it */
    CHECK_INT(state.outline.count, 0);
    KEYS("<right-release 9,4>|", "<right-press 3,4>",
         "<pane=3><right-move 8,4>|"); /* no voxel of a slice */
    CHECK_INT(state.outline.count, 1);
    KEYS("<right-release 8,4>|");
    CHECK_INT(state.outline.count, 0);
    KEYS("<pane=1><right-release 8,4>|", "<pane=3><right-press 3,4>|");
}

STORY(where_one_corrects_a_click_takes_the_pixel_there)
{
    KEYS("p<pane=3><press 20,30>||*|picking");
    CHECK(state.pixel[0] == 10 && state.pixel[1] == 15);
    KEYS("2|cross 10,15,9 / seed 10,15,9 2",
         "<pane=0><press 20,31>|cross 20,31,7|*|moving"); /* a slice is somewhere else */
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
    KEYS("]|magnify 1.25 at=20,25,30");
    CHECK(state.is_silent);
    KEYS("4]|magnify 2.5 at=20,25,30", "[||*slices are shown whole", "W|",
         "gz||*] shows them larger", "<times=1250>[|magnify fit",
         "<times=2345>]|magnify 2.5 at=20,25,30", /* typed at the prompt */
         "[|magnify 2 at=20,25,30", "gz|magnify 2.345 at=20,25,30", "W|magnify fit",
         "<times=1000>");
    CHECK_INT(magnified("]", 100), PILOT_TIMES_MOST);
    CHECK_HAS(buf_text(&message), "slices cannot be larger");
    KEYS("[|magnify 3072 at=20,25,30",
         "<pane=1><times=2000><Ctrl-wheel-up 8,8>|magnify 2.5 at=20,25,30");
}

STORY(what_is_magnified_can_be_moved)
{
    KEYS("<Alt-Left>|pan -16 0", /* whole slices: the rendition */
         "<times=3000><Alt-Right>|magnify 3 at=11,10,0", "v|",
         "<Alt-Left>|cross 21,25,30 / magnify 3 at=9,10,0", /* no stroke */
         "v<Tab>2|", "<Alt-Down>|magnify 3 at=10,12,1",
         "<goes_on=0><Alt-Down>||*the slice ends there",
         "<goes_on=1>p<Alt-Down>|pan 0 16"); /* the rendition, while correcting */
}

STORY(one_pane_has_the_whole_screen_or_none)
{
    CHECK(!state.is_alone);
    KEYS("f||*|moving");
    CHECK(state.is_alone);
    KEYS("pf|*|*|picking");
    CHECK(!state.is_alone);
    KEYS("f");
    pilot_state_enter(&state); /* and so the next time */
    CHECK(state.is_alone);
}

STORY(the_wheel_takes_the_question_about_a_tree_away)
{
    KEYS("<pane=0>x|*|*|confirming",
         "<wheel-up 1,1>|cross 20,25,31|*|moving", /* another tree may be there */
         "x||*x removes it", "x|remove 20,25,30",
         "<z=59><wheel-up 1,1>|"); /* at the edge there is nothing to record */
}

STORY(what_a_click_says_takes_the_place_of_what_was_said)
{
    const struct key_event event = {.key = KEY_MOUSE,
                                    .mouse = {.action = MOUSE_PRESSED, .button = MOUSE_LEFT}};
    KEYS("<shows=0>");
    for (int i = 0; i < 2; i++)
        click_on(&event, 8, 9);
    CHECK_TEXT(buf_text(&message), "that pixel shows nothing");
}

/* All keys of a row, one after the other, each read. */
static size_t chords_of(const struct pilot_row *row, struct chord chords[8])
{
    const char *words[2] = {row->keys, row->also ? row->also : ""};
    size_t count = 0;
    for (int i = 0; i < 2; i++)
        while (row->name && chord_next(&words[i], &chords[count]) && CHECK(count + 1 < 8))
            CHECK(chords[count++].key != KEY_OTHER);
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

/* Static storage. */
static const struct buf *page_of(bool watches, unsigned columns, bool has_colours,
                                 const char *wanted)
{
    static struct buf page;
    buf_clear(&page);
    pilot_keys_page(&page,
                    &(struct pilot_keys_wish){&pilot_setup_default, watches, columns,
                                              has_colours ? &theme_dark : NULL, wanted, NULL});
    return &page;
}

static const char *page_with(const char *wanted, bool has_colours)
{
    return buf_text(page_of(false, 80, has_colours, wanted));
}

/* The README has it after a mark. */
STORY(the_page_of_keys_fits_and_is_the_card_in_the_readme)
{
    static const char mark[] = "<!-- keys: the page that `?` shows -->\n\n```\n";
    OWNED(buf_release) struct buf readme = {0}, card = {0};
    for (const char *at = page_with(NULL, false); *at; at += strcspn(at, "\n") + 1)
        CHECK(strcspn(at, "\n") <= 78);
    buf_printf(&card, "%s%s```\n", mark, page_with(NULL, false));
    CHECK(file_read(&readme, "tui/README.md", 1 << 20, NULL) == OK);
    CHECK_HAS(buf_text(&readme), buf_text(&card));
}

STORY(the_page_of_keys_fits_any_window_and_is_filtered)
{
    for (unsigned columns = 20; columns < 100; columns++) {
        OWNED(buf_release) struct buf wrapped = {0};
        cells_wrap(&wrapped, page_of(false, columns, false, NULL), columns);
        for (const char *at = buf_text(&wrapped); *at; at += strcspn(at, "\n") + 1)
            CHECK(cells_width(at, strcspn(at, "\r\n")) <= columns);
    }
    CHECK_TEXT(page_with("GREYS", false),
               "Display\n"
               "  o                overlay               labels; greys; channel\n"
               "  y                finished              labels; greys; channel\n"
               "  w                window                labels; greys; channel\n"
               "  Y                next-channel          labels; greys; channel\n");
    CHECK_HAS(page_with("undo", false), "\n  u                undo  ");
    CHECK(!strstr(page_with("undo", false), "greys"));
    CHECK_TEXT(page_with("xyzzy", false), "no key matches xyzzy\n");
}

/* The description of a key, or of all that begin with it. */
static const char *page_of_key(bool watches, char key)
{
    static struct buf page;
    const struct key_event event = {.key = KEY_CHARACTER, .point = (uint8_t)key};
    buf_clear(&page);
    pilot_keys_page(
        &page, &(struct pilot_keys_wish){&pilot_setup_default, watches, 80, NULL, NULL, &event});
    return buf_text(&page);
}

STORY(a_key_of_the_page_is_described)
{
    CHECK_TEXT(page_of_key(false, 'F'),
               "Display\n"
               "  F                fit                   zoom in, out; fit\n"
               "    Zoom the rendition; F fits the shown objects, also while they grow.\n");
    CHECK_HAS(page_of_key(false, 'g'), "  gl               labels ");
    CHECK_HAS(page_of_key(false, 'g'), " gl lists all.\n");
    CHECK_TEXT(page_of_key(false, '~'), "");
    CHECK_HAS(page_of_key(true, 'c'), " its comments\n"); /* a text that adds nothing is left out */
}

STORY(headings_and_keys_have_colours_where_there_are_any)
{
    CHECK_HAS(page_with("", true), "\033[1;36mPlanting\033[m\n");
    CHECK_HAS(page_with("", true), "  \033[33mi Enter\033[m          a seed of the label ");
    CHECK(!strchr(page_with("", false), '\033'));
}

STORY(keys_of_the_hints_are_bold_and_their_words_are_not)
{
    facts.has_object = true;
    CHECK_HAS(hint_in("\033[1m"), "\033[1mi\033[m seed  \033[1mb\033[m label  ");
    KEYS("a");
    CHECK_HAS(hint_in("\033[1m"), "1 corner  \033[1ma\033[m another  \033[1md\033[m box to here");
    KEYS("<Escape>", "w");
    CHECK_HAS(hint_in("\033[1m"), "  \033[1ma\033[m auto  \033[1mEnter\033[m done  "
                                  "\033[1m1\033[m bone  ");
}

STORY(what_is_dangerous_and_how_to_begin_are_said)
{
    CHECK_HAS(hint_now(), "nothing to show yet: i plants a seed here");
    facts.has_object = true;
    CHECK_HAS(hint_now(), "i seed  b label");
    facts.has_one_object = true;
    CHECK_HAS(hint_now(), "fills all: a here, then beyond its edge S encloses it; s0 back");
    facts.has_one_object = false, facts.wants_outline = true;
    CHECK_HAS(hint_now(), "@ outlines the object where a slice is wrong; i or s0 corrects by b");
    CHECK(strlen(hint_now()) <= 80);
    KEYS("v");
    CHECK_HAS(hint_now(), "moving draws; v ends the stroke, Escape drops it");
}

/* ---- how keys come ---- */

STORY(while_a_key_is_held_a_rendition_may_take_less_time)
{
    const uint64_t ms = 1000000, repeats = 33 * ms, begins = 300 * ms;
    struct pace pace = {.within_ns = PACE_SINGLE_NS};
    uint64_t now = 20 * ms;
    pace_key(&pace, now); /* soon after the clock began */
    CHECK(pace.within_ns == PACE_SINGLE_NS);
    pace_key(&pace, now += begins);
    CHECK(pace.within_ns == PACE_SINGLE_NS);
    for (int i = 0; i < 10; i++) {
        pace_key(&pace, now += repeats);
        CHECK(pace.within_ns == PACE_BETWEEN_NS && pace.key_ns + PACE_REST_NS > now + repeats);
    }
    pace_key(&pace, now += 2 * repeats); /* one was late */
    CHECK(pace.within_ns == PACE_BETWEEN_NS);
    pace_key(&pace, now += begins);
    CHECK(pace.within_ns == PACE_SINGLE_NS);
}

/* ---- slices that are sent ahead ---- */

/* Names begin at 1000, or later by the moves of the cross-hair; 4 and 7 have none. */
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
    CHECK_INT(ahead->number, AHEAD_NUMBERS);
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
    named_from = 1001; /* 1004 and 1007 are new, and the ones after the last */
    ahead_begin(&ahead);
    CHECK_INT(send_all_ahead(&ahead), 3);
    named_from = 1000;
    ahead_begin(&ahead);
    CHECK_INT(send_all_ahead(&ahead), 0);
    ahead_forget(&ahead); /* the terminal may have dropped some */
    CHECK_INT(send_all_ahead(&ahead), AHEAD_NUMBERS - 2);
    for (unsigned i = 0; i < 100; i++) { /* what was sent long ago may be sent again */
        named_from = 5000 + i * 100;
        ahead_begin(&ahead);
        CHECK_INT(send_all_ahead(&ahead), AHEAD_NUMBERS - 2);
    }
}

/* A slice of some 25 kB takes 100 ms at 2 Mbit/s, and 10 ms at 20 Mbit/s. */
STORY(nothing_goes_ahead_when_the_pilot_is_opened_again_until_a_key)
{
    struct ahead ahead = {.rests = true};
    ahead_begin(&ahead);
    CHECK_INT(send_all_ahead(&ahead), 0);
    ahead.rests = false;
    ahead_begin(&ahead);
    CHECK_INT(send_all_ahead(&ahead), AHEAD_NUMBERS - 2);
}

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
    label_name = "ventricle";
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
    snprintf(facts.known[PILOT_NAME], PILOT_KNOWN_BYTES, " ctx-lh-caudalanteriorcingulate");
    CHECK_TEXT(status_in(80),
               "axial at 20,25,30  brush 2 r3  here 1 ctx-lh-caudalanteriorcingulate 1.64 l");
    snprintf(facts.known[PILOT_NAME], PILOT_KNOWN_BYTES, " brain");
    CHECK_TEXT(status_in(20), "axial at 20,25,30");
    state.pen.is_down = true;
    CHECK_TEXT(status_in(20), "PEN DOWN  axial");
    state.pen.is_down = false;
    state.sends_ahead = true;
    CHECK_TEXT(status_in(80),
               "axial at 20,25,30  brush 2 r3  here 1 brain  intensity 93  0.5,18.0,-2.0 mm  >");
    state.sends_ahead = false;
    facts.waiting = 3; /* the effect of the next keys has a higher rank than names */
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
        CHECK_INT(strspn(at, "#"), strlen(at)); /* whole parts only */
    }
    facts.times = 1500;
    facts.waiting = 0;
    state.pen.is_down = true;
    CHECK_TEXT(status_in(58), "PEN DOWN  axial x1.5 at 20,25,30  brush 2 r3  here 1 brain");
    facts.shows = PILOT_ROUGH;
    CHECK_TEXT(status_in(63), "PEN DOWN  axial x1.5 at 20,25,30  brush 2 r3  finishing  here 1");
    facts.shows = PILOT_FOREST;
    facts.times = PILOT_TIMES_ONE;
    facts.has_pieces = true;
    label_name = "Hippocampus_L";
    state.pen.is_down = false;
    state.brush.limit = BRUSH_OVER;
    state.brush.limit_label = 17;
    CHECK_TEXT(status_in(80),
               "axial at 20,25,30  brush 2 r3 exact over 17 Hippocampus_L  here 1 brain 1.64 l");
    CHECK_TEXT(status_in(60), "axial at 20,25,30  brush 2 r3 exact over 17  here 1 brain");
    state.brush.limit = BRUSH_KEEP;
    state.brush.growth = BRUSH_GROWS;
    CHECK_TEXT(status_in(60), "axial at 20,25,30  brush 2 r3 grows keep 17  here 1 brain");
    facts.has_pieces = false;
    state.brush.limit = BRUSH_ALL;
    CHECK_TEXT(status_in(60), "axial at 20,25,30  brush 2 r3  here 1 brain  intensity 93");
    state.brush.growth = BRUSH_EXACT;
    CHECK_TEXT(status_in(40), "axial at 20,25,30  brush 2 r3 exact");
    label_name = "";
}

STORY(where_one_watches_keys_lead_from_step_to_step)
{
    state.watches = true;
    pilot_state_enter(&state);
    KEYS(" |step on 1", "12 |step on 12", "<Backspace>|step back 1", "20G|step to 20",
         "G|step to last", "gg|step to 0", "c|step comments");
    CHECK(state.has_pages);
    KEYS("l|cross 19,25,30"); /* and one looks as ever */
    CHECK(!state.has_pages);
    KEYS("w||*|windowing", "<Enter>|*|*|watching");
    for (const char *none = "isuxvdSOPCI.+-M"; *none; none++) {
        char row[60];
        snprintf(row, sizeof row, "%c||*this key does nothing here; ? shows the keys", *none);
        KEYS(row);
    }
    const char *page = buf_text(page_of(true, 80, false, NULL));
    CHECK_HAS(page, "Space Backspace  next, previous step");
    CHECK(strstr(page, "undo, redo") == NULL);
    CHECK(strstr(page_with(NULL, false), "next, previous step") == NULL);
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
    OWNED(refine_release) struct refine r = {0};
    struct image_view shown;
    uint64_t seed = 1;
    paint(&seed, 0, 0, WIDTH, HEIGHT);
    CHECK(refine_begin(&r, &view, true, 1 << 20, &shown));
    CHECK_INT(differing(&shown), 0);
    CHECK(!r.is_coarse);
    refine_sent(&r, 5000);
}

STORY(with_little_room_it_is_coarse_first_and_fine_in_the_end)
{
    for (uint64_t seed = 1; seed < 30; seed++) {
        OWNED(refine_release) struct refine r = {0};
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
    }
}

/* So that neighbours are often equal. */
STORY(the_coarsest_tiles_have_few_levels)
{
    OWNED(refine_release) struct refine r = {0};
    struct image_view shown;
    uint64_t seed = 3;
    bool is_there[256] = {false};
    unsigned levels = 0;
    paint(&seed, 0, 0, WIDTH, HEIGHT);
    CHECK(refine_begin(&r, &view, true, 1, &shown) && r.level == REFINE_LEVELS - 1);
    for (size_t i = 0; i < 4 * WIDTH * HEIGHT; i++)
        is_there[shown.rgba[i]] = true;
    for (unsigned i = 0; i < 256; i++)
        levels += is_there[i];
    CHECK(levels <= 8 && is_there[255]);
}

STORY(what_tiles_cost_is_learnt)
{
    OWNED(refine_release) struct refine r = {0};
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
}

/* The middle of each block is a pixel of a word, whose colour no other pixel of the block gets. */
STORY(words_stay_sharp)
{
    static uint8_t words[WIDTH * HEIGHT];
    struct image_view with_words = view, shown;
    OWNED(refine_release) struct refine r = {0};
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
    CHECK(refine_begin(&r, &with_words, true, 300, &shown) && r.level >= 2);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        if (words[i])
            CHECK(memcmp(shown.rgba + 4 * i, wanted + 4 * i, 4) == 0);
        else
            CHECK(shown.rgba[4 * i] < 128);
}

STORY(where_one_looks_gets_fine_first)
{
    struct image_view focused = view, shown;
    OWNED(refine_release) struct refine r = {0};
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
}

/* ---- typed while a command is carried out ---- */

static struct typed_ahead ahead;

static void type_ahead(const char *letters)
{
    for (; *letters; letters++) {
        const struct key_event event = {.key = *letters == '\t' ? KEY_TAB : KEY_CHARACTER,
                                        .point = (uint8_t)*letters};
        if (typed_ahead_has_room(&ahead))
            typed_ahead_add(&ahead, &event);
    }
}

STORY(keys_typed_ahead_are_taken_in_their_order)
{
    struct key_event event;
    ahead = (struct typed_ahead){.count = 0};
    for (unsigned round = 0; round < 3; round++) {
        type_ahead("abcdefghijklmnopqrstuvwxyz");
        for (char c = 'a'; c <= 'z'; c++)
            CHECK(typed_ahead_take(&ahead, &event) && event.point == (uint8_t)c);
        CHECK(!typed_ahead_take(&ahead, &event));
    }
    for (unsigned i = 0; i < 2 * TYPED_AHEAD_MOST; i++)
        type_ahead("x");
    CHECK_INT(ahead.count, TYPED_AHEAD_MOST); /* the rest stays with the terminal */
    ahead = (struct typed_ahead){.count = 0};
    typed_ahead_add(&ahead, &(struct key_event){.key = KEY_PASTE_END});
    CHECK(!typed_ahead_has_room(&ahead)); /* its text is kept once */
}

STORY(keys_typed_ahead_show_where_the_cross_hair_goes_and_no_more)
{
    ahead = (struct typed_ahead){.count = 0};
    peeks = 0;
    type_ahead("10ll\tK");
    struct pilot_state shown = state;
    typed_ahead_show(&ahead, &shown, &host);
    CHECK(facts.place[0] == 9 && peeks == 3);
    CHECK(shown.pane == PILOT_CORONAL && state.pane == PILOT_AXIAL);
    CHECK_INT(ahead.count, 6); /* they are still to be taken */
    type_ahead("xl");
    begin();
    shown = state;
    typed_ahead_show(&ahead, &shown, &host);
    CHECK(facts.place[0] == 9 && shown.mode == PILOT_MOVING); /* up to what does more */
    begin();
    state.pen.is_down = true;
    shown = state;
    peeks = 0;
    typed_ahead_show(&ahead, &shown, &host);
    CHECK_INT(peeks, 0); /* moving draws, */
    const struct key_event right = {.key = KEY_CHARACTER, .point = 'l'},
                           pen = {.key = KEY_CHARACTER, .point = 'v'};
    CHECK(pilot_moves(&state, &right) && !pilot_only_moves(&state, &right));
    CHECK(!pilot_moves(&state, &pen)); /* and keys after this one wait for it */
}
