/* SPDX-License-Identifier: MIT */
/* THE table of keys, and what can be read off it: the page of keys, the hints below the picture. */
#include <stdio.h>
#include <string.h>

#include "tui/pilot/chord.h"
#include "tui/pilot/pilot_keys.h"

#define MOVING          PILOT_IN(PILOT_MOVING)
#define PICKING         PILOT_IN(PILOT_PICKING)
#define BOTH            (MOVING | PICKING)
#define CONFIRMING      PILOT_IN(PILOT_CONFIRMING)
#define CONFIRMING_TREE PILOT_IN(PILOT_CONFIRMING_TREE)
#define EXPLAINING      PILOT_IN(PILOT_EXPLAINING)
#define WINDOWING       PILOT_IN(PILOT_WINDOWING)
#define RANGING         PILOT_IN(PILOT_RANGING)
#define OUTLINING       PILOT_IN(PILOT_OUTLINING)
#define SHAPING         PILOT_IN(PILOT_SHAPING)
#define OUTLINES        (OUTLINING | SHAPING)
#define WATCHING        PILOT_IN(PILOT_WATCHING)
#define ALL             (BOTH | WATCHING)
#define LOOKS           (ALL | OUTLINES)
#define ARROWS          (LOOKS | WINDOWING)

/* What every row of a thing to do begins with, on one line. */
#define KEY(NAME, KEYS, ALSO, IN) NAME, KEYS, ALSO, .in = IN
#define DO(FUNCTION, BY)          .act = FUNCTION, .by = BY
#define PAGE(SHOWN, HELP)         .shown = SHOWN, .help = HELP
#define PART(HEADING)                                                                              \
    {                                                                                              \
        .keys = "", .shown = HEADING                                                               \
    }

enum {
    COUNTS = PILOT_COUNTS,
    CHANGES = PILOT_CHANGES,
    STAYS = PILOT_STAYS,
    SILENT = PILOT_IS_SILENT,
    MOVES = PILOT_ONLY_MOVES,
    STEPS = COUNTS | STAYS | MOVES
};

const struct pilot_row pilot_table[] = {
    PART("Where one is"),
    {KEY("step-on", "Space", "", WATCHING), DO(pilot_step, 1), .flags = COUNTS,
     PAGE("Space Backspace", "a step on, back"), .hint = "on"},
    {KEY("step-back", "Backspace", "", WATCHING), DO(pilot_step, -1), .flags = COUNTS, .help = "",
     .hint = "back"},
    {KEY("first-step", "gg", "", WATCHING), DO(pilot_to_step, -1), .flags = COUNTS,
     PAGE("gg G", "first, last, 20G")},
    {KEY("last-step", "G", "", WATCHING), DO(pilot_to_step, 1), .flags = COUNTS, .help = "",
     .hint = "end"},
    {KEY("comments", "c", "", WATCHING), .command = "step comments\n", .flags = PILOT_HAS_PAGES,
     .help = "its comments", .hint = "comments"},
    {KEY("left", "h", "Left", ARROWS), DO(pilot_move, PILOT_LEFT), .flags = STEPS,
     PAGE("h j k l arrows", "move the cross-hair")},
    {KEY("down", "j", "Down", ARROWS), DO(pilot_move, PILOT_DOWN), .flags = STEPS, .help = ""},
    {KEY("up", "k", "Up", ARROWS), DO(pilot_move, PILOT_UP), .flags = STEPS, .help = ""},
    {KEY("right", "l", "Right", ARROWS), DO(pilot_move, PILOT_RIGHT), .flags = STEPS, .help = ""},
    {KEY("far-left", "H", "Ctrl-Left", ARROWS), DO(pilot_move, PILOT_FAR + PILOT_LEFT),
     .flags = STEPS, PAGE("H L Ctrl-arrows", "by ten voxels")},
    {KEY("far-down", "Ctrl-Down", "", ARROWS), DO(pilot_move, PILOT_FAR + PILOT_DOWN),
     .flags = STEPS, .help = ""},
    {KEY("far-up", "Ctrl-Up", "", ARROWS), DO(pilot_move, PILOT_FAR + PILOT_UP), .flags = STEPS,
     .help = ""},
    {KEY("far-right", "L", "Ctrl-Right", ARROWS), DO(pilot_move, PILOT_FAR + PILOT_RIGHT),
     .flags = STEPS, .help = ""},
    {KEY("slice-back", "J", "Page-down", LOOKS), DO(pilot_change_slice, -1),
     .flags = COUNTS | MOVES, PAGE("J K Page-keys", "the slice")},
    {KEY("slice-on", "K", "Page-up", LOOKS), DO(pilot_change_slice, 1), .flags = COUNTS | MOVES,
     .help = ""},
    {KEY("first-slice", "gg", "", MOVING), DO(pilot_to_slice, -1), .flags = COUNTS | MOVES,
     .help = "first, last, 90G"},
    {KEY("last-slice", "G", "", MOVING), DO(pilot_to_slice, 1), .flags = COUNTS | MOVES,
     .help = ""},
    {.keys = "1-9", .help = "a count: 25l moves 25"},
    {KEY("next-plane", "Tab", "", MOVING | WATCHING), DO(pilot_next_pane, 1), .flags = MOVES,
     .help = "the next plane"},
    {KEY("previous-plane", "Shift-Tab", "", MOVING | WATCHING), DO(pilot_next_pane, -1),
     .flags = MOVES},
    {KEY("next-seed", "n", "", MOVING), DO(pilot_next_seed, 1), .flags = COUNTS,
     .help = "the label's seeds"},
    {KEY("previous-seed", "N", "", MOVING), DO(pilot_next_seed, -1), .flags = COUNTS, .help = ""},
    {KEY("centre", "gc", "", MOVING), DO(pilot_go_to_centre, 0), .help = "the label's centre"},
    {KEY("go-back", "''", "", MOVING), DO(pilot_go_back, 0)},
    {KEY("mark", "ma-z", "", MOVING), DO(pilot_set_mark, 0),
     PAGE("ma-z 'a-z ''", "mark, go there, back")},
    {KEY("go-to-mark", "'a-z", "", MOVING), DO(pilot_go_to_mark, 0), .help = ""},
    {KEY("measure", "Da-z", "", BOTH), DO(pilot_measure, 0), .help = "distance of a mark"},
    {.keys = "mouse", .help = "there; right: S"},
    {KEY("next-hint", ")", "", BOTH), DO(pilot_go_to_hint, 1), .flags = COUNTS,
     PAGE(") ( gh P", "hints, heat; why")},
    {KEY("previous-hint", "(", "", BOTH), DO(pilot_go_to_hint, -1), .flags = COUNTS, .help = ""},
    {KEY("heat", "gh", "", MOVING), DO(pilot_show_heat, 0), .help = ""},
    {KEY("explain", "P", "", BOTH), DO(pilot_explain, 0), .help = ""},
    PART("What is planted"),
    {KEY("plant", "i Enter", "", BOTH), DO(pilot_plant, 0), .flags = CHANGES,
     .help = "a seed of the label", .hint = "seed"},
    {KEY("plant-picked", "0-9", "", PICKING), DO(pilot_plant_label, 0), .flags = CHANGES,
     .hint = "a seed there"},
    {KEY("plant-label", "s0-9", "", BOTH), DO(pilot_plant_label, 0), .flags = CHANGES,
     .help = "a seed of 0-9"},
    {KEY("next-label", "b", "", LOOKS), DO(pilot_choose_label, 1), .flags = COUNTS,
     .help = "the label: 12b is 12", .hint = "label"},
    {KEY("previous-label", "B", "", LOOKS), DO(pilot_choose_label, -1), .flags = COUNTS,
     .help = ""},
    {KEY("larger", "+", "=", BOTH), DO(pilot_change_radius, 1), .flags = COUNTS,
     .help = "the radius; in mm"},
    {KEY("smaller", "-", "_", BOTH), DO(pilot_change_radius, -1), .flags = COUNTS, .help = ""},
    {KEY("millimetres", "M", "", BOTH), DO(pilot_change_unit, 0), .help = ""},
    {KEY("pen", "v", "", MOVING), DO(pilot_lower_pen, 0), PAGE("v I", "pen draws; stroke's end")},
    {KEY("stroke", "I", "", MOVING), DO(pilot_begin_stroke, 0), .help = ""},
    {KEY("range", "t", "", MOVING), DO(pilot_take_range, 0), .flags = COUNTS,
     .help = "within intensities"},
    {KEY("type-range", "T", "", BOTH), DO(pilot_begin_range, 0), .then = PILOT_RANGING, .help = ""},
    {KEY("outline", "@", "", MOVING | OUTLINES), DO(pilot_begin_outline, 0),
     PAGE("@ U } {", "outline; next in doubt")},
    {KEY("take-up", "U", "", MOVING | SHAPING), DO(pilot_take_up, 0), .help = ""},
    {KEY("next-doubt", "}", "", MOVING | SHAPING), DO(pilot_go_to_doubt, 1), .flags = COUNTS,
     .help = ""},
    {KEY("previous-doubt", "{", "", MOVING | SHAPING), DO(pilot_go_to_doubt, -1), .flags = COUNTS,
     .help = ""},
    {KEY("corner", "a", "", MOVING), DO(pilot_set_corner, 0), .help = "box, area, shell"},
    {KEY("box", "d", "", MOVING), DO(pilot_plant_box, 0), .flags = CHANGES | PILOT_OUTLINES,
     .help = ""},
    {KEY("polygon", "A", "", MOVING), DO(pilot_close_outline, 0), .flags = PILOT_OUTLINES,
     .help = ""},
    {KEY("enclose", "S", "", MOVING), DO(pilot_plant_shell, 0), .flags = CHANGES | PILOT_OUTLINES,
     .help = ""},
    {KEY("enclose-in-box", "O", "", MOVING), DO(pilot_plant_shell, 1),
     .flags = CHANGES | PILOT_OUTLINES, .help = ""},
    {KEY("eliminate", "x", "", BOTH), DO(pilot_show_held, 0), PAGE("x X", "remove marker, tree"),
     .hint = "remove"},
    {KEY("eliminate-tree", "X", "", BOTH), DO(pilot_show_held, 1), .help = ""},
    {KEY("cut", "c", "", BOTH), .command = "plane @\n", .flags = CHANGES,
     .help = "cut here; whole"},
    {KEY("whole", "C", "", BOTH), .command = "plane none\n", .help = ""},
    {KEY("hide", "e", "", BOTH), DO(pilot_hide, 0), .flags = COUNTS | CHANGES,
     .help = "hide, show; show all"},
    {KEY("show-all", "E", "", BOTH), DO(pilot_show_all, 0), .help = ""},
    {KEY("drop", "Escape", "", MOVING), DO(pilot_drop_stroke, 0), .help = "no pen, no corners"},
    {KEY("run", "Space", "", BOTH | OUTLINES), .command = "run\n", .help = "run what waits"},
    {KEY("undo", "u", "", BOTH | OUTLINES), DO(pilot_undo, -1), .flags = COUNTS | PILOT_SAYS_ALL,
     .help = "undo, redo, again", .hint = "undo"},
    {KEY("redo", "Ctrl-R", "", BOTH | OUTLINES), DO(pilot_undo, 1), .flags = COUNTS, .help = ""},
    {KEY("repeat", ".", "", BOTH), DO(pilot_repeat, 0), .help = ""},
    PART("What is shown"),
    {KEY("turn-right", "r", "Shift-Right", LOOKS), DO(pilot_turn, PILOT_RIGHT), .flags = COUNTS,
     PAGE("r R Shift-arrows", "turn the view")},
    {KEY("turn-left", "R", "Shift-Left", LOOKS), DO(pilot_turn, PILOT_LEFT), .flags = COUNTS,
     .help = ""},
    {KEY("turn-up", "Shift-Up", "", LOOKS), DO(pilot_turn, PILOT_UP), .flags = COUNTS, .help = ""},
    {KEY("turn-down", "Shift-Down", "", LOOKS), DO(pilot_turn, PILOT_DOWN), .flags = COUNTS,
     .help = ""},
    {KEY("roll", ">", "", BOTH), DO(pilot_roll, 1), .flags = COUNTS, PAGE("< >", "roll it")},
    {KEY("roll-back", "<", "", BOTH), DO(pilot_roll, -1), .flags = COUNTS, .help = ""},
    {KEY("front", "Va", "", LOOKS), .command = "view front\n",
     PAGE("Va p l r s i", "view from a side")},
    {KEY("back", "Vp", "", LOOKS), .command = "view back\n", .help = ""},
    {KEY("left-side", "Vl", "", LOOKS), .command = "view left\n", .help = ""},
    {KEY("right-side", "Vr", "", LOOKS), .command = "view right\n", .help = ""},
    {KEY("top", "Vs", "", LOOKS), .command = "view top\n", .help = ""},
    {KEY("bottom", "Vi", "", LOOKS), .command = "view bottom\n", .help = ""},
    {KEY("nearer", "z", "", LOOKS), DO(pilot_change_zoom, 1), .help = "zoom in, out; fit"},
    {KEY("farther", "Z", "", LOOKS), DO(pilot_change_zoom, -1), .help = ""},
    {KEY("fit", "F", "", LOOKS), .command = "zoom fit\n", .help = ""},
    {KEY("correct", "p", "", MOVING), DO(pilot_begin_picking, 0), .help = "correct the rendition"},
    {KEY("to-voxel", "p", "", PICKING), DO(pilot_end_picking, 1), .hint = "to its voxel"},
    {KEY("stop-correcting", "Escape", "", PICKING), DO(pilot_end_picking, 0), .hint = "ends"},
    {KEY("magnify", "]", "", LOOKS), DO(pilot_magnify, 1), .flags = COUNTS,
     PAGE("] [ W", "larger slices; all")},
    {KEY("reduce", "[", "", LOOKS), DO(pilot_magnify, -1), .flags = COUNTS, .help = ""},
    {KEY("whole-slices", "W", "", LOOKS), DO(pilot_magnify, 0), .help = ""},
    {KEY("recentre", "gz", "", MOVING | WATCHING | OUTLINES), DO(pilot_recentre, 0),
     .help = "around the cross-hair"},
    {KEY("pan-left", "Alt-Left", "Alt-h", LOOKS), DO(pilot_pan, PILOT_LEFT), .flags = COUNTS,
     PAGE("Alt-arrows", "move them, the view")},
    {KEY("pan-down", "Alt-Down", "Alt-j", LOOKS), DO(pilot_pan, PILOT_DOWN), .flags = COUNTS,
     .help = ""},
    {KEY("pan-up", "Alt-Up", "Alt-k", LOOKS), DO(pilot_pan, PILOT_UP), .flags = COUNTS, .help = ""},
    {KEY("pan-right", "Alt-Right", "Alt-l", LOOKS), DO(pilot_pan, PILOT_RIGHT), .flags = COUNTS,
     .help = ""},
    {KEY("overlay", "o", "", LOOKS), DO(pilot_change_overlay, 0),
     PAGE("o y w", "contour; finish; greys")},
    {KEY("finished", "y", "", LOOKS), DO(pilot_change_labels, 0), .help = ""},
    {KEY("window", "w", "", LOOKS), .then = PILOT_WINDOWING, .help = ""},
    {KEY("alone", "f", "", LOOKS), DO(pilot_show_alone, 0), .help = "one pane, all four"},
    {KEY("command", ":", "", LOOKS), .deed = PILOT_PROMPT, .help = "a command", .hint = "command"},
    {KEY("keys", "?", "", LOOKS), .deed = PILOT_SHOW_KEYS, .help = "these keys", .hint = "keys"},
    {KEY("redraw", "Ctrl-L", "", LOOKS), .deed = PILOT_REDRAW,
     PAGE("Ctrl-L Ctrl-Z", "draw anew; stop")},
    {KEY("suspend", "Ctrl-Z", "", LOOKS), .deed = PILOT_SUSPEND, .help = ""},
    {KEY("leave", "q", "Ctrl-D", LOOKS), .deed = PILOT_LEAVE, .help = "back to the prompt",
     .hint = "back"},

    {KEY("eliminate-it", "x Enter", "", CONFIRMING), .command = "remove @\n", .flags = CHANGES,
     .hint = "removes the hatched marker"},
    {KEY("eliminate-that-tree", "X Enter", "", CONFIRMING_TREE), .command = "remove @ of=tree\n",
     .flags = CHANGES, .hint = "removes the hatched tree"},
    {KEY("keep-it", "Escape", "", CONFIRMING | CONFIRMING_TREE), .hint = "keeps it"},

    {KEY("to-edge", "P Enter", "", EXPLAINING), DO(pilot_go_to_edge, 0),
     .hint = "to its strongest edge"},
    {KEY("plant-there", "i", "", EXPLAINING), DO(pilot_plant_at_edge, 0),
     .hint = "the next label there"},
    {KEY("plant-label-there", "s0-9", "", EXPLAINING), DO(pilot_plant_at_edge, 1)},
    {KEY("enclose-there", "S", "", EXPLAINING), DO(pilot_enclose_at_edge, 0), .hint = "shell"},
    {KEY("stroke-there", "I", "", EXPLAINING), DO(pilot_stroke_at_edge, 0), .hint = "stroke"},
    {KEY("explained", "Escape", "", EXPLAINING), .hint = "ends"},

    {KEY("close-outline", "Enter", "A", OUTLINES), DO(pilot_close_outline, 0), .hint = "plants it"},
    {KEY("take-hold", "v", "", SHAPING), DO(pilot_take_hold, 0), .hint = "takes hold, lets go"},
    {KEY("drop-outline", "Escape", "", OUTLINES), DO(pilot_drop_outline, 0), .hint = "drops it"},

    {KEY("preset", "1-9", "", WINDOWING), DO(pilot_preset, 0), .flags = SILENT},
    {KEY("window-auto", "a", "", WINDOWING), .command = "window auto\n", .flags = SILENT,
     .hint = "auto"},
    {KEY("digits", "0-9 . - e", "", RANGING), DO(pilot_type_range, 0), .flags = STAYS},
    {KEY("erase", "Backspace", "", RANGING), DO(pilot_erase_typed, 0), .flags = STAYS},
    {KEY("take-range", "Enter", "", RANGING), DO(pilot_end_range, 0), .hint = "takes it"},
    {KEY("keep-range", "Escape", "", RANGING), .hint = "leaves"},

    {KEY("end-window", "Enter", "Escape w", WINDOWING), .hint = "done"},
};
const size_t pilot_rows = sizeof pilot_table / sizeof pilot_table[0];

/* ---- what a user has made of it ---- */

const struct pilot_setup pilot_setup_default = {.table = pilot_table,
                                                .rows = sizeof pilot_table / sizeof pilot_table[0],
                                                .theme = &theme_dark,
                                                .brush = {.label = 1, .radius = 6, .fits = true},
                                                .window = {{"bone", 500000, 2000000},
                                                           {"brain", 40000, 80000},
                                                           {"lung", -600000, 1500000},
                                                           {"soft", 50000, 400000}},
                                                .windows = 4};

/* Whether a row has the keys of the table, all of them. */
static bool is_plain_row(const struct pilot_setup *setup, const struct pilot_row *row)
{
    struct buf keys = {0};
    setup_add_keys(&keys, setup, row, SIZE_MAX);
    const bool is_plain = strcmp(buf_text(&keys), row->keys) == 0;
    buf_release(&keys);
    return is_plain;
}

/* ---- what the keys do ---- */

/* The hints of the rows of a mode alone; while one moves, of those for correcting too. */
static void add_hints(struct buf *out, const struct pilot_state *state, const char *gap)
{
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        const unsigned in = !(row->in & MOVING) ? row->in
                            : row->deed         ? row->in & (MOVING | WATCHING)
                                                : MOVING;
        if (!row->hint || !(in & PILOT_IN(state->mode)))
            continue;
        buf_add_text(out, gap);
        setup_add_keys(out, state->setup, row, 1);
        buf_printf(out, " %s", row->hint);
        gap = "  ";
    }
}

/* What can be made of the corners that are set. */
static void add_corners_hint(struct buf *out, const struct pilot_state *state)
{
    const size_t corners = state->outline.count;
    buf_printf(out, "%zu corner%s  ", corners, corners == 1 ? "" : "s");
    setup_say_key(out, state->setup, "corner", " another  ");
    if (corners == 1) {
        setup_say_key(out, state->setup, "box", " box to here  ");
        setup_say_key(out, state->setup, "enclose-in-box", " faces  ");
        setup_say_key(out, state->setup, "enclose", " ball's shell  ");
    } else if (corners > 2) {
        setup_say_key(out, state->setup, "polygon", " plants the outline  ");
    }
    setup_say_key(out, state->setup, "drop", corners == 1 ? " drops it" : " drops them");
}

void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     struct buf *out)
{
    const bool moves = state->mode == PILOT_MOVING;
    if (moves && state->pen.is_down) {
        buf_add_text(out, "moving draws; ");
        setup_say_key(out, state->setup, "pen", " ends the stroke, ");
        setup_say_key(out, state->setup, "drop", " drops it");
    } else if (moves && state->outline.count) {
        add_corners_hint(out, state);
    } else if (moves && state->stroke.is_set) {
        buf_add_text(out, "one end of a stroke  ");
        setup_say_key(out, state->setup, "plant", " plants it to here  ");
        setup_say_key(out, state->setup, "drop", " drops it");
    } else if (moves && !facts->has_object) {
        buf_add_text(out, "nothing to show yet: ");
        setup_say_key(out, state->setup, "plant", " plants a seed here, ");
        setup_say_key_to(out, state->setup, "plant-label", '0', " background; ");
        setup_say_key(out, state->setup, "keys", " keys  ");
        setup_say_key(out, state->setup, "leave", " back");
    } else if (moves && facts->takes_all) {
        buf_add_text(out, "one label takes all: ");
        setup_say_key(out, state->setup, "corner", " here, then beyond its edge ");
        setup_say_key(out, state->setup, "enclose", " encloses it; ");
        setup_say_key_to(out, state->setup, "plant-label", '0', " background");
    } else if (state->mode == PILOT_WINDOWING) {
        const struct pilot_setup *setup = state->setup;
        buf_add_text(out, "window ");
        pilot_add_decimal(out, facts->window[0]);
        buf_add_char(out, ' ');
        pilot_add_decimal(out, facts->window[1]);
        buf_add_text(out, "  arrows");
        add_hints(out, state, "  ");
        for (size_t i = 0; i < setup->windows; i++)
            buf_printf(out, "  %zu %s", i + 1, setup->window[i].name);
    } else if (state->mode == PILOT_RANGING) {
        buf_printf(out, "intensities LOW..HIGH, or none: %s_", state->typed);
        add_hints(out, state, "  ");
    } else if (pilot_outlines(state->mode)) {
        buf_add_text(out, state->mode == PILOT_OUTLINING ? "moving, or the mouse, draws an outline"
                          : state->hold.is_set           ? "held: moving drags it"
                                                         : "the mouse drags it");
        add_hints(out, state, "  ");
    } else if (state->mode == PILOT_PICKING) {
        buf_printf(out, "CORRECT at pixel %u,%u", state->pixel[0], state->pixel[1]);
        add_hints(out, state, "  ");
    } else {
        add_hints(out, state, "");
    }
}

static bool joins(const struct pilot_row *row)
{
    return row < pilot_table + pilot_rows && row->help && !*row->help;
}

/* The keys of an entry: those of its row and of the rows that join it; none is "-". */
static void add_keys(struct buf *out, const struct pilot_row *row, const struct pilot_setup *setup)
{
    const size_t before = out->length;
    bool is_plain = is_plain_row(setup, row);
    for (const struct pilot_row *next = row + 1; joins(next); next++)
        is_plain &= is_plain_row(setup, next);
    if (is_plain && row->shown) {
        buf_add_text(out, row->shown);
        return;
    }
    do {
        if (out->length > before && out->data[out->length - 1] != ' ')
            buf_add_char(out, ' ');
        setup_add_keys(out, setup, row, SIZE_MAX);
    } while (joins(++row));
    if (out->length == before)
        buf_add_char(out, '-');
}

/* ---- the page ---- */

/* Whether the row stands on the page: what is for watching alone on that of its own. */
static bool is_on_page(const struct pilot_row *row, bool watches)
{
    return watches ? !row->name || row->in & WATCHING : row->in != WATCHING;
}

enum { KEYS_WIDE = 16, HELP_WIDE = 24, NARROW = 2 + KEYS_WIDE + 1 + HELP_WIDE, WIDE = 78 };
enum { NAME_WIDE = 20 };

static void add_heading(struct buf *out, const struct pilot_keys_wish *wish, const char *heading)
{
    const struct theme *theme = wish->setup->theme;
    buf_printf(out, "%s%s%s\n", wish->has_colours ? theme->heading : "", heading,
               wish->has_colours && *theme->heading ? "\033[m" : "");
}

/* The keys in a column so wide. */
static void add_column(struct buf *out, const struct pilot_keys_wish *wish, const char *keys,
                       size_t wide)
{
    const struct theme *theme = wish->setup->theme;
    buf_printf(out, "%s%s%s", wish->has_colours ? theme->key : "", keys,
               wish->has_colours && *theme->key ? "\033[m" : "");
    for (size_t n = strlen(keys); n < wide; n++)
        buf_add_char(out, ' ');
}

/* An entry, at the left of its line, or beside the one that is there. */
static void add_entry(struct buf *out, const struct pilot_keys_wish *wish,
                      const struct pilot_row *row, const struct pilot_row *left)
{
    struct buf keys = {0};
    add_keys(&keys, row, wish->setup);
    buf_printf(out, "%*s",
               wish->columns < NARROW ? 0
               : left                 ? HELP_WIDE - (int)strlen(left->help)
                                      : 2,
               "");
    add_column(out, wish, buf_text(&keys),
               wish->columns < NARROW ? 0
               : left                 ? KEYS_WIDE - 1
                                      : KEYS_WIDE);
    buf_printf(out, "%s%s", wish->columns < NARROW ? "\n  " : " ", row->help);
    out->failed |= keys.failed;
    buf_release(&keys);
}

/* Entries side by side; a heading begins a line. */
static void add_all(struct buf *out, const struct pilot_keys_wish *wish)
{
    const struct pilot_row *left = NULL;
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        const bool is_heading = !row->name && !row->help;
        if (is_heading) {
            buf_add_text(out, left ? "\n" : "");
            add_heading(out, wish, row->shown);
            left = NULL;
        } else if (row->help && *row->help && is_on_page(row, wish->watches)) {
            add_entry(out, wish, row, left);
            left = left || wish->columns < WIDE ? NULL : row;
            buf_add_text(out, left ? "" : "\n");
        }
    }
    buf_add_text(out, left ? "\n" : "");
}

static bool has_piece(const char *text, const char *piece)
{
    return text && strcasestr(text, piece);
}

/* Each action that has the piece, below the heading of its part; `help` is that of its entry. */
static void add_wanted(struct buf *out, const struct pilot_keys_wish *wish)
{
    const char *heading = NULL, *help = NULL;
    const size_t before = out->length;
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        struct buf keys = {0};
        const bool is_heading = !row->name && !row->help;
        const char *name = row->name ? row->name : "";
        heading = is_heading ? row->shown : heading;
        help = row->help && *row->help ? row->help : row->help ? help : row->hint;
        setup_add_keys(&keys, wish->setup, row, SIZE_MAX);
        if (!is_heading && is_on_page(row, wish->watches) &&
            (has_piece(buf_text(&keys), wish->wanted) || has_piece(name, wish->wanted) ||
             has_piece(help, wish->wanted) || has_piece(row->hint, wish->wanted))) {
            if (heading)
                add_heading(out, wish, heading);
            heading = NULL;
            buf_add_text(out, "  ");
            add_column(out, wish, buf_text(&keys), KEYS_WIDE);
            buf_printf(out, " %-*s  %s\n", NAME_WIDE, name, help ? help : "");
        }
        out->failed |= keys.failed;
        buf_release(&keys);
    }
    if (out->length == before)
        buf_printf(out, "no key has to do with %s\n", wish->wanted);
}

void pilot_keys_page(struct buf *out, const struct pilot_keys_wish *wish)
{
    if (wish->wanted && *wish->wanted)
        add_wanted(out, wish);
    else
        add_all(out, wish);
}
