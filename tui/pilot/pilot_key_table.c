/* SPDX-License-Identifier: MIT */
/* THE table of keys, and texts made from it: the page of keys, the hints below the picture. */
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
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

/* Every row of an action begins with KEY. */
#define KEY(NAME, KEYS, IN, FLAGS) NAME, KEYS, .in = IN, .flags = FLAGS
#define ALSO(KEYS)                 .also = KEYS
#define DO(FUNCTION, BY)           .act = FUNCTION, .by = BY
#define PAGE(SHOWN, WORDS)         .shown = SHOWN, .help = WORDS
#define HELP(WORDS)                .help = WORDS
#define HINT(WORDS)                .hint = WORDS
#define TEXT(WORDS)                .text = WORDS
#define JOINS                      HELP("")
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
    ENCLOSES = PILOT_OUTLINES,
    STEPS = COUNTS | STAYS | MOVES
};

const struct pilot_row pilot_table[] = {
    PART("Position"),
    {KEY("step-on", "Space", WATCHING, COUNTS), DO(pilot_step, 1),
     PAGE("Space Backspace", "next, previous step"), HINT("on"),
     TEXT("Show the next step: first its gesture, then its effect. 5 Space goes 5 steps.")},
    {KEY("step-back", "Backspace", WATCHING, COUNTS), DO(pilot_step, -1), JOINS, HINT("back")},
    {KEY("first-step", "gg", WATCHING, COUNTS), DO(pilot_to_step, -1),
     PAGE("gg G", "first, last, 20G")},
    {KEY("last-step", "G", WATCHING, COUNTS), DO(pilot_to_step, 1), JOINS, HINT("end")},
    {KEY("comments", "c", WATCHING, PILOT_HAS_PAGES), .command = "step comments\n",
     HELP("its comments"), HINT("comments")},
    {KEY("left", "h", ARROWS, STEPS), ALSO("Left"), DO(pilot_move, PILOT_LEFT),
     PAGE("h j k l arrows", "move the cross-hair"),
     TEXT("Move the cross-hair in the active slice; in the window ({window}), width and level.")},
    {KEY("down", "j", ARROWS, STEPS), ALSO("Down"), DO(pilot_move, PILOT_DOWN), JOINS},
    {KEY("up", "k", ARROWS, STEPS), ALSO("Up"), DO(pilot_move, PILOT_UP), JOINS},
    {KEY("right", "l", ARROWS, STEPS), ALSO("Right"), DO(pilot_move, PILOT_RIGHT), JOINS},
    {KEY("far-left", "H", ARROWS, STEPS), ALSO("Ctrl-Left"), DO(pilot_move, PILOT_FAR + PILOT_LEFT),
     PAGE("H L Ctrl-arrows", "by ten voxels")},
    {KEY("far-down", "Ctrl-Down", ARROWS, STEPS), DO(pilot_move, PILOT_FAR + PILOT_DOWN), JOINS},
    {KEY("far-up", "Ctrl-Up", ARROWS, STEPS), DO(pilot_move, PILOT_FAR + PILOT_UP), JOINS},
    {KEY("far-right", "L", ARROWS, STEPS), ALSO("Ctrl-Right"),
     DO(pilot_move, PILOT_FAR + PILOT_RIGHT), JOINS},
    {KEY("slice-back", "J", LOOKS, COUNTS | MOVES), ALSO("Page-down"), DO(pilot_change_slice, -1),
     PAGE("J K Page-keys", "the slice"),
     TEXT("Move by slices: {slice-on} towards the head, the front or the right.")},
    {KEY("slice-on", "K", LOOKS, COUNTS | MOVES), ALSO("Page-up"), DO(pilot_change_slice, 1),
     JOINS},
    {KEY("first-slice", "gg", MOVING, COUNTS | MOVES), DO(pilot_to_slice, -1),
     HELP("first, last, 90G")},
    {KEY("last-slice", "G", MOVING, COUNTS | MOVES), DO(pilot_to_slice, 1), JOINS},
    {.keys = "1-9", HELP("a count: 25l moves 25")},
    {KEY("next-plane", "Tab", MOVING | WATCHING, MOVES), DO(pilot_next_pane, 1),
     HELP("the next plane")},
    {KEY("previous-plane", "Shift-Tab", MOVING | WATCHING, MOVES), DO(pilot_next_pane, -1)},
    {KEY("next-seed", "n", MOVING, COUNTS), DO(pilot_next_seed, 1), HELP("the label's seeds")},
    {KEY("previous-seed", "N", MOVING, COUNTS), DO(pilot_next_seed, -1), JOINS},
    {KEY("centre", "gc", MOVING, 0), DO(pilot_next_seed, 0), HELP("the label's centre")},
    {KEY("go-back", "''", MOVING, 0), DO(pilot_go_back, 0)},
    {KEY("mark", "ma-z", MOVING, 0), DO(pilot_set_mark, 0),
     PAGE("ma-z 'a-z ''", "mark, go there, back"),
     TEXT("Mark this voxel by a letter; ' and the letter go there, {go-back} back from a jump.")},
    {KEY("go-to-mark", "'a-z", MOVING, 0), DO(pilot_go_to_mark, 0), JOINS},
    {KEY("measure", "Da-z", BOTH, 0), DO(pilot_measure, 0), HELP("distance of a mark")},
    {.keys = "mouse", HELP("there; right: S")},
    {KEY("next-hint", ")", BOTH, COUNTS), DO(pilot_go_to_hint, 1),
     PAGE(") ( gh P", "hints, heat; why"),
     TEXT("Go to uncertain places; {heat} colours them; {explain} draws the path to the seed.")},
    {KEY("previous-hint", "(", BOTH, COUNTS), DO(pilot_go_to_hint, -1), JOINS},
    {KEY("heat", "gh", MOVING, 0), DO(pilot_show_heat, 0), JOINS},
    {KEY("explain", "P", BOTH, 0), DO(pilot_explain, 0), JOINS},
    PART("Planting"),
    {KEY("plant", "i Enter", BOTH, CHANGES), DO(pilot_plant, 0), HELP("a seed of the label"),
     HINT("seed"),
     TEXT("Plant a ball of the brush's label here; after {stroke}, a stroke that ends here.")},
    {KEY("plant-picked", "0-9", PICKING, CHANGES), DO(pilot_plant, 1), HINT("a seed there")},
    {KEY("plant-label", "s0-9", BOTH, CHANGES), DO(pilot_plant, 1), HELP("a seed of 0-9"),
     TEXT("Plant a ball of label 0-9, and choose it for the brush. 0 is the background.")},
    {KEY("next-label", "b", LOOKS, COUNTS), DO(pilot_choose_label, 1),
     HELP("label, 12b; here; list"), HINT("label"),
     TEXT("Choose the next label, or {label-here} that here; {labels} lists all.")},
    {KEY("previous-label", "B", LOOKS, COUNTS), DO(pilot_choose_label, -1), JOINS},
    {KEY("label-here", "*", MOVING | OUTLINES, 0), DO(pilot_choose_label, 0), JOINS},
    {KEY("labels", "gl", MOVING, 0), .request = PILOT_SHOW_LABELS, JOINS},
    {KEY("larger", "+", BOTH, COUNTS), ALSO("="), DO(pilot_change_radius, 1),
     HELP("radius; mm; range"),
     TEXT(
         "Change the radius, {millimetres} its unit; {range} or {type-range} limits intensities.")},
    {KEY("smaller", "-", BOTH, COUNTS), ALSO("_"), DO(pilot_change_radius, -1), JOINS},
    {KEY("millimetres", "M", BOTH, 0), DO(pilot_change_unit, 0), JOINS},
    {KEY("range", "t", MOVING, COUNTS), DO(pilot_take_range, 0), JOINS},
    {KEY("type-range", "T", BOTH, 0), DO(pilot_begin_range, 0), .then = PILOT_RANGING, JOINS},
    {KEY("pen", "v", MOVING, 0), DO(pilot_lower_pen, 0), PAGE("v I", "pen; end of a stroke"),
     TEXT("{pen} draws a stroke, and again plants it; {stroke} sets one end, a seed the other.")},
    {KEY("stroke", "I", MOVING, 0), DO(pilot_begin_stroke, 0), JOINS},
    {KEY("exact", "ge", MOVING | OUTLINES, 0), DO(pilot_change_growth, 0),
     HELP("exact, over, keep"),
     TEXT("{exact}: nothing grows; {over}: only over the label here, {keep}: over others.")},
    {KEY("over", "go", MOVING | OUTLINES, COUNTS), DO(pilot_change_limit, BRUSH_OVER), JOINS},
    {KEY("keep", "gO", MOVING | OUTLINES, COUNTS), DO(pilot_change_limit, BRUSH_KEEP), JOINS},
    {KEY("outline", "@", MOVING | OUTLINES, 0), DO(pilot_begin_outline, 0),
     PAGE("@ U } {", "outline; next in doubt"),
     TEXT("Draw an outline; {take-up} edits the one here; {next-doubt} goes to uncertain slices.")},
    {KEY("take-up", "U", MOVING | SHAPING, 0), DO(pilot_load_outline, 0), JOINS},
    {KEY("next-doubt", "}", MOVING | SHAPING, COUNTS), DO(pilot_go_to_doubt, 1), JOINS},
    {KEY("previous-doubt", "{", MOVING | SHAPING, COUNTS), DO(pilot_go_to_doubt, -1), JOINS},
    {KEY("corner", "a", MOVING, 0), DO(pilot_set_corner, 0), HELP("box, area, shell"),
     TEXT("Set a corner; {box} box, {enclose-in-box} its faces, {polygon} area, {enclose} shell.")},
    {KEY("box", "d", MOVING, CHANGES | ENCLOSES), DO(pilot_plant_box, 0), JOINS},
    {KEY("polygon", "A", MOVING, ENCLOSES), DO(pilot_close_outline, 0), JOINS},
    {KEY("enclose", "S", MOVING, CHANGES | ENCLOSES), DO(pilot_plant_shell, 0), JOINS},
    {KEY("enclose-in-box", "O", MOVING, CHANGES | ENCLOSES), DO(pilot_plant_shell, 1), JOINS},
    {KEY("eliminate", "x", BOTH, 0), DO(pilot_show_held, 0), PAGE("x X", "remove marker, tree"),
     HINT("remove"),
     TEXT("Hatch the marker here, {eliminate-tree} its tree; the same key again removes it.")},
    {KEY("eliminate-tree", "X", BOTH, 0), DO(pilot_show_held, 1), JOINS},
    {KEY("cut", "c", BOTH, CHANGES), .command = "plane @\n", HELP("cut here; whole"),
     TEXT("Cut the rendition at a plane through the cross-hair; {whole} removes cuts.")},
    {KEY("whole", "C", BOTH, 0), .command = "plane none\n", JOINS},
    {KEY("hide", "e", BOTH, COUNTS | CHANGES), DO(pilot_hide, 0), HELP("hide, show; show all")},
    {KEY("show-all", "E", BOTH, 0), DO(pilot_show_all, 0), JOINS},
    {KEY("drop", "Escape", MOVING, 0), DO(pilot_drop_stroke, 0), HELP("no pen, no corners")},
    {KEY("undo", "u", BOTH | OUTLINES, COUNTS | PILOT_SAYS_ALL), DO(pilot_undo, -1),
     HELP("undo, redo, again; log"), HINT("undo"),
     TEXT("Undo or redo changes; {repeat} plants again, here; {history} lists changes.")},
    {KEY("redo", "Ctrl-R", BOTH | OUTLINES, COUNTS), DO(pilot_undo, 1), JOINS},
    {KEY("repeat", ".", BOTH, 0), DO(pilot_repeat, 0), JOINS},
    {KEY("history", "gu", BOTH, PILOT_HAS_PAGES), .command = "history\n", JOINS},
    {KEY("run", "Space", BOTH | OUTLINES, 0), .command = "run\n", HELP("run; labels here"),
     TEXT("Run pending edits; {freeze} keeps all labels as they are, so that none grows.")},
    {KEY("freeze", "gL", MOVING, 0), .command = "labels here\n", JOINS},
    PART("Display"),
    {KEY("turn-right", "r", LOOKS, COUNTS), ALSO("Shift-Right"), DO(pilot_turn, PILOT_RIGHT),
     PAGE("r R Shift-arrows", "turn the view"),
     TEXT("Turn the view by 15 degrees, or by a multiple: 3r.")},
    {KEY("turn-left", "R", LOOKS, COUNTS), ALSO("Shift-Left"), DO(pilot_turn, PILOT_LEFT), JOINS},
    {KEY("turn-up", "Shift-Up", LOOKS, COUNTS), DO(pilot_turn, PILOT_UP), JOINS},
    {KEY("turn-down", "Shift-Down", LOOKS, COUNTS), DO(pilot_turn, PILOT_DOWN), JOINS},
    {KEY("roll", ">", BOTH, COUNTS), DO(pilot_roll, 1), PAGE("< >", "roll it")},
    {KEY("roll-back", "<", BOTH, COUNTS), DO(pilot_roll, -1), JOINS},
    {KEY("front", "Va", LOOKS, 0), .command = "view front\n",
     PAGE("Va p l r s i", "view from a side"),
     TEXT("View from the front, back, left, right, top (Vs) or bottom (Vi).")},
    {KEY("back", "Vp", LOOKS, 0), .command = "view back\n", JOINS},
    {KEY("left-side", "Vl", LOOKS, 0), .command = "view left\n", JOINS},
    {KEY("right-side", "Vr", LOOKS, 0), .command = "view right\n", JOINS},
    {KEY("top", "Vs", LOOKS, 0), .command = "view top\n", JOINS},
    {KEY("bottom", "Vi", LOOKS, 0), .command = "view bottom\n", JOINS},
    {KEY("nearer", "z", LOOKS, 0), DO(pilot_change_zoom, 1), HELP("zoom in, out; fit"),
     TEXT("Zoom the rendition; {fit} fits the shown objects, also while they grow.")},
    {KEY("farther", "Z", LOOKS, 0), DO(pilot_change_zoom, -1), JOINS},
    {KEY("fit", "F", LOOKS, SILENT), DO(pilot_fit, 0), JOINS},
    {KEY("correct", "p", MOVING, 0), DO(pilot_begin_picking, 0), HELP("correct in rendition"),
     TEXT("Move a cursor in the rendition, to plant or remove in the voxels that it shows.")},
    {KEY("to-voxel", "p", PICKING, 0), DO(pilot_end_picking, 1), HINT("to its voxel")},
    {KEY("stop-correcting", "Escape", PICKING, 0), DO(pilot_end_picking, 0), HINT("ends")},
    {KEY("magnify", "]", LOOKS, COUNTS), DO(pilot_magnify, 1), PAGE("] [ W", "larger slices; all")},
    {KEY("reduce", "[", LOOKS, COUNTS), DO(pilot_magnify, -1), JOINS},
    {KEY("whole-slices", "W", LOOKS, 0), DO(pilot_magnify, 0), JOINS},
    {KEY("recentre", "gz", MOVING | WATCHING | OUTLINES, 0), DO(pilot_recentre, 0),
     HELP("centre slices here")},
    {KEY("pan-left", "Alt-Left", LOOKS, COUNTS), ALSO("Alt-h"), DO(pilot_pan, PILOT_LEFT),
     PAGE("Alt-arrows", "move them, the view"),
     TEXT("Move magnified slices; if slices are whole, move the rendition.")},
    {KEY("pan-down", "Alt-Down", LOOKS, COUNTS), ALSO("Alt-j"), DO(pilot_pan, PILOT_DOWN), JOINS},
    {KEY("pan-up", "Alt-Up", LOOKS, COUNTS), ALSO("Alt-k"), DO(pilot_pan, PILOT_UP), JOINS},
    {KEY("pan-right", "Alt-Right", LOOKS, COUNTS), ALSO("Alt-l"), DO(pilot_pan, PILOT_RIGHT),
     JOINS},
    {KEY("overlay", "o", LOOKS, 0), DO(pilot_change_overlay, 0),
     PAGE("o y w Y", "labels; greys; channel"),
     TEXT("Tint or outline labels; {finished} finished; {window} greys; {next-channel} channel.")},
    {KEY("finished", "y", LOOKS, 0), DO(pilot_change_labels, 0), JOINS},
    {KEY("window", "w", LOOKS, 0), .then = PILOT_WINDOWING, JOINS},
    {KEY("next-channel", "Y", MOVING | OUTLINES, 0), .command = "show-channel next\n", JOINS},
    {KEY("alone", "f", LOOKS, 0), DO(pilot_show_alone, 0), HELP("one pane, all four")},
    {KEY("command", ":", LOOKS, 0), .request = PILOT_PROMPT, HELP("a command"), HINT("command")},
    {KEY("keys", "?", LOOKS, 0), .request = PILOT_SHOW_KEYS, HELP("these keys"), HINT("keys")},
    {KEY("redraw", "Ctrl-L", LOOKS, 0), .request = PILOT_REDRAW,
     PAGE("Ctrl-L Ctrl-Z", "redraw; suspend")},
    {KEY("suspend", "Ctrl-Z", LOOKS, 0), .request = PILOT_SUSPEND, JOINS},
    {KEY("leave", "q", LOOKS, 0), ALSO("Ctrl-D Ctrl-O"), .request = PILOT_LEAVE,
     HELP("back to the prompt"), HINT("back"), TEXT("Return to the prompt, as do Ctrl-O and :q.")},

    {KEY("eliminate-it", "x Enter", CONFIRMING, CHANGES), .command = "remove @\n",
     HINT("removes the hatched marker")},
    {KEY("eliminate-that-tree", "X Enter", CONFIRMING_TREE, CHANGES),
     .command = "remove @ of=tree\n", HINT("removes the hatched tree")},
    {KEY("keep-it", "Escape", CONFIRMING | CONFIRMING_TREE, 0), HINT("keeps it")},

    {KEY("to-edge", "P Enter", EXPLAINING, 0), DO(pilot_go_to_edge, 0),
     HINT("to its strongest edge")},
    {KEY("plant-there", "i", EXPLAINING, 0), DO(pilot_plant_at_edge, 0),
     HINT("the next label there")},
    {KEY("plant-label-there", "s0-9", EXPLAINING, 0), DO(pilot_plant_at_edge, 1)},
    {KEY("enclose-there", "S", EXPLAINING, 0), DO(pilot_enclose_at_edge, 0), HINT("shell")},
    {KEY("stroke-there", "I", EXPLAINING, 0), DO(pilot_stroke_at_edge, 0), HINT("stroke")},
    {KEY("explained", "Escape", EXPLAINING, 0), HINT("ends")},

    {KEY("close-outline", "Enter", OUTLINES, 0), ALSO("A"), DO(pilot_close_outline, 0),
     HINT("plants it")},
    {KEY("take-hold", "v", SHAPING, 0), DO(pilot_grab, 0), HINT("grabs, lets go")},
    {KEY("drop-outline", "Escape", OUTLINES, 0), DO(pilot_drop_outline, 0), HINT("drops it")},

    {KEY("preset", "1-9", WINDOWING, SILENT), DO(pilot_preset, 0)},
    {KEY("window-auto", "a", WINDOWING, SILENT), .command = "window auto\n", HINT("auto")},
    {KEY("digits", "0-9 . - e :", RANGING, STAYS), DO(pilot_type_range, 0)},
    {KEY("erase", "Backspace", RANGING, STAYS), DO(pilot_erase_typed, 0)},
    {KEY("take-range", "Enter", RANGING, 0), DO(pilot_end_range, 0), HINT("sets it")},
    {KEY("keep-range", "Escape", RANGING, 0), HINT("leaves")},

    {KEY("end-window", "Enter", WINDOWING, 0), ALSO("Escape w"), HINT("done")},
};
const size_t pilot_rows = sizeof pilot_table / sizeof pilot_table[0];
_Static_assert(sizeof pilot_table / sizeof pilot_table[0] <= SETUP_ROWS_MOST, "keys of each row");

/* ---- the default setup ---- */

const struct pilot_setup pilot_setup_default = {.table = pilot_table,
                                                .rows = sizeof pilot_table / sizeof pilot_table[0],
                                                .brush = {.label = 1, .radius = 6, .fits = true},
                                                .window = {{"bone", 500000, 2000000},
                                                           {"brain", 40000, 80000},
                                                           {"lung", -600000, 1500000},
                                                           {"soft", 50000, 400000}},
                                                .windows = 4};

/* Return true if a row has exactly the keys of the table. */
static bool is_plain_row(const struct pilot_setup *setup, const struct pilot_row *row)
{
    OWNED(buf_release) struct buf keys = {0};
    setup_add_keys(&keys, setup, row, SIZE_MAX);
    return strcmp(buf_text(&keys), row->keys) == 0;
}

/* ---- hints ---- */

/* Add the hints of rows for this mode only; in PILOT_MOVING also of rows of PILOT_PICKING. */
static void add_hints(struct buf *out, const struct pilot_state *state, const char *bold,
                      const char *gap)
{
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        const unsigned in = !(row->in & MOVING) ? row->in
                            : row->request      ? row->in & (MOVING | WATCHING)
                                                : MOVING;
        if (!row->hint || !(in & PILOT_IN(state->mode)))
            continue;
        buf_printf(out, "%s%s", gap, bold);
        setup_add_keys(out, state->setup, row, 1);
        buf_printf(out, "%s %s", *bold ? "\033[m" : "", row->hint);
        gap = "  ";
    }
}

void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     const char *bold, struct buf *out)
{
    const struct pilot_setup *setup = state->setup;
    const bool moves = state->mode == PILOT_MOVING;
    const size_t corners = state->outline.count;
    if (moves && state->pen.is_down) {
        setup_say(out, setup, bold, "moving draws; {pen} ends the stroke, {drop} drops it");
    } else if (moves && corners) {
        setup_say(out, setup, bold,
                  corners == 1   ? "%zu corner  {corner} another  {box} box to here  "
                                   "{enclose-in-box} faces  {enclose} ball's shell  {drop} drops it"
                  : corners == 2 ? "%zu corners  {corner} another  {drop} drops them"
                                 : "%zu corners  {corner} another  {polygon} plants the outline  "
                                   "{drop} drops them",
                  corners);
    } else if (moves && state->stroke.is_set) {
        setup_say(out, setup, bold,
                  "one end of a stroke  {plant} plants it to here  {drop} drops it");
    } else if (moves && !facts->has_object) {
        setup_say(out, setup, bold,
                  "nothing to show yet: {plant} plants a seed here, {plant-label:0} background; "
                  "{keys} keys  {leave} back");
    } else if (moves && facts->has_one_object) {
        setup_say(out, setup, bold,
                  "one label fills all: {corner} here, then beyond its edge {enclose} encloses it; "
                  "{plant-label:0} background");
    } else if (moves && facts->wants_outline) {
        setup_say(out, setup, bold,
                  "{outline} outlines the object where a slice is wrong; {plant} or "
                  "{plant-label:0} corrects by balls; {keys} keys");
    } else if (state->mode == PILOT_WINDOWING) {
        buf_add_text(out, "window ");
        pilot_add_decimal(out, facts->window[0]);
        buf_add_char(out, ' ');
        pilot_add_decimal(out, facts->window[1]);
        buf_add_text(out, "  arrows");
        add_hints(out, state, bold, "  ");
        for (size_t i = 0; i < setup->windows; i++)
            buf_printf(out, "  %s%zu%s %s", bold, i + 1, *bold ? "\033[m" : "",
                       setup->window[i].name);
    } else if (state->mode == PILOT_RANGING) {
        buf_printf(out, "intensities LOW..HIGH, or none: %s_", state->typed);
        add_hints(out, state, bold, "  ");
    } else if (pilot_outlines(state->mode)) {
        buf_add_text(out, state->mode == PILOT_OUTLINING ? "moving, or the mouse, draws an outline"
                          : state->hold.is_set           ? "grabbed: moving drags it"
                                                         : "the mouse drags it");
        add_hints(out, state, bold, "  ");
    } else if (state->mode == PILOT_PICKING) {
        buf_printf(out, "CORRECT at pixel %u,%u", state->pixel[0], state->pixel[1]);
        add_hints(out, state, bold, "  ");
    } else {
        add_hints(out, state, bold, "");
    }
}

static bool joins(const struct pilot_row *row)
{
    return row < pilot_table + pilot_rows && row->help && !*row->help;
}

/* Add the keys of an entry: of its row and of the rows that join it; "-" for none. */
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

/* Return true if the row is on the page; rows for watching alone have a page of their own. */
static bool is_on_page(const struct pilot_row *row, bool watches)
{
    return watches ? !row->name || row->in & WATCHING : row->in != WATCHING;
}

enum { KEYS_WIDE = 16, HELP_WIDE = 24, NARROW = 2 + KEYS_WIDE + 1 + HELP_WIDE, WIDE = 78 };
enum { NAME_WIDE = 20 };

static void add_coloured(struct buf *out, const char *colour, const char *text)
{
    buf_printf(out, "%s%s%s", colour, text, *colour ? "\033[m" : "");
}

static void add_heading(struct buf *out, const struct pilot_keys_wish *wish, const char *heading)
{
    add_coloured(out, wish->theme ? wish->theme->heading : "", heading);
    buf_add_char(out, '\n');
}

/* Add the keys in a column of this width. */
static void add_column(struct buf *out, const struct pilot_keys_wish *wish, const char *keys,
                       size_t wide)
{
    add_coloured(out, wish->theme ? wish->theme->key : "", keys);
    for (size_t n = strlen(keys); n < wide; n++)
        buf_add_char(out, ' ');
}

/* Add an entry, at the left of its line, or to the right of `left`. */
static void add_entry(struct buf *out, const struct pilot_keys_wish *wish,
                      const struct pilot_row *row, const struct pilot_row *left)
{
    OWNED(buf_release) struct buf keys = {0};
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
}

/* Return true for one of the keys, or the first key of one. */
static bool has_key(const char *keys, const struct key_event *event)
{
    struct chord chord;
    while (keys && chord_next(&keys, &chord))
        if (chord_fits(&chord, 0, event) ||
            (chord.leader && chord.leader == event->point && !event->modifiers))
            return true;
    return false;
}

/* Return true if the wanted key is a key of the row outside of modes. */
static bool has_key_now(const struct pilot_row *row, const char *keys,
                        const struct pilot_keys_wish *wish)
{
    return (!row->name || row->in & (wish->watches ? WATCHING : MOVING)) &&
           (has_key(keys, wish->key) || has_key(row->also, wish->key));
}

static bool has_piece(const char *text, const char *piece)
{
    return text && strcasestr(text, piece);
}

/* Add each matching action, below the heading of its part; `help` and `text` are those of its
 * entry. */
static void add_wanted(struct buf *out, const struct pilot_keys_wish *wish)
{
    const char *heading = NULL, *help = NULL, *text = NULL, *shown = NULL;
    const size_t before = out->length;
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        OWNED(buf_release) struct buf keys = {0};
        const bool is_heading = !row->name && !row->help;
        const char *name = row->name ? row->name : "";
        heading = is_heading ? row->shown : heading;
        text = row->help && !*row->help ? text : row->text;
        help = row->help && *row->help ? row->help : row->help ? help : row->hint;
        setup_add_keys(&keys, wish->setup, row, SIZE_MAX);
        if (!is_heading && is_on_page(row, wish->watches) &&
            (wish->key
                 ? has_key_now(row, buf_text(&keys), wish)
                 : has_piece(buf_text(&keys), wish->wanted) || has_piece(name, wish->wanted) ||
                       has_piece(help, wish->wanted) || has_piece(row->hint, wish->wanted))) {
            if (heading)
                add_heading(out, wish, heading);
            heading = NULL;
            buf_add_text(out, "  ");
            add_column(out, wish, buf_text(&keys), KEYS_WIDE);
            buf_printf(out, " %-*s  %s\n", NAME_WIDE, name, help ? help : "");
            if (wish->key && text && text != shown)
                setup_say(out, wish->setup, "", "    %s\n", text);
            shown = text;
        }
        out->failed |= keys.failed;
    }
    if (out->length == before && !wish->key)
        buf_printf(out, "no key matches %s\n", wish->wanted);
}

void pilot_keys_page(struct buf *out, const struct pilot_keys_wish *wish)
{
    const struct pilot_row *left = NULL; /* entries are side by side; a heading begins a line */
    if (wish->key || (wish->wanted && *wish->wanted)) {
        add_wanted(out, wish);
        return;
    }
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        if (!row->name && !row->help) { /* a heading */
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
