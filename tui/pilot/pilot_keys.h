/* SPDX-License-Identifier: MIT */
/*
 * Meaning of keys in the pilot: a state, a key and the facts in, a command out. Pure.
 *
 * All keys are in one table (pilot_key_table.c), a row for each action: its name, its keys, its
 * modes, its command or function, and its words for the page of keys and for the row below the
 * picture. The page, shown by `?`, is also printed in tui/README.md.
 *
 * As in vim, digits are a count for the key after them, a key that accepts no count reports it,
 * some keys wait for a second one, and Escape cancels both. A digit alone plants nothing except in
 * PILOT_PICKING, which corrects the rendition.
 *
 * Functions call only those of files further down:
 *
 *     pilot_key_table.c    the table, the page of keys and the hints
 *     pilot_keys.c         find the row for a key, by the table of the setup
 *     pilot_acts.c         functions of rows that look, move or ask
 *     pilot_plant.c        functions of rows that plant or remove
 *     pilot_outline.c      outlines: draw, edit, drag and close them
 *     pilot_press.c        the user's keys and windows, and shared words and moves
 *     pilot_status.c       the row below the picture
 *     chord.c              keys as words
 */
#ifndef TUI_PILOT_PILOT_KEYS_H
#define TUI_PILOT_PILOT_KEYS_H

#include "base/scan.h"
#include "base/polyline.h"
#include "tui/keys.h"
#include "tui/pilot/host.h"
#include "tui/cells.h"

/* ---- how the pilot is set up ---- */

enum {
    SETUP_WINDOWS_MOST = 9, /* one for each digit */
    SETUP_ROWS_MOST = 160,  /* in the table of keys */
    SETUP_NAME_BYTES = 12,
    SETUP_KEYS_BYTES = 48
};

/* A window of greys, in thousandths of real values. */
struct setup_window {
    char name[SETUP_NAME_BYTES];
    int64_t centre, width;
};

/* Growth of trees from the seeds of the brush. */
enum brush_growth {
    BRUSH_BY_PIECES, /* the brush is exact while there are pieces of a segmentation */
    BRUSH_EXACT,     /* within=0: no tree grows from its seeds */
    BRUSH_GROWS
};

/* Voxels that the brush may change. */
enum brush_limit {
    BRUSH_ALL,
    BRUSH_OVER, /* those of one label, */
    BRUSH_KEEP  /* or of all others */
};

/* Growth and limits of planted seeds and strokes. */
struct pilot_brush {
    uint32_t label;  /* its number */
    unsigned radius; /* voxels, or half millimetres with in_mm; 0 for one voxel */
    bool in_mm;
    bool fits;      /* the radius was not chosen: limit it by the size of the scene */
    bool has_range; /* plant only in voxels whose intensity is within these real values, */
    struct decimal range[2];
    unsigned range_channel; /* of this channel, from 0 */
    enum brush_growth growth;
    enum brush_limit limit;
    uint32_t limit_label; /* the label of BRUSH_OVER or BRUSH_KEEP */
};

struct pilot_row;

struct pilot_setup {
    const struct pilot_row *table; /* [rows], actions of keys */
    size_t rows;
    const struct theme *theme; /* NULL: by the background of the terminal */
    struct pilot_brush brush;  /* at the start */
    struct setup_window window[SETUP_WINDOWS_MOST];
    size_t windows;
    bool sends_none_ahead;                        /* send no slice ahead (tui/pilot/flow.h) */
    char keys[SETUP_ROWS_MOST][SETUP_KEYS_BYTES]; /* by row; "" if the user has set none */
};

/* The setup without a configuration: windows for CT. */
extern const struct pilot_setup pilot_setup_default;

/* Add a window, or replace the one of that name. ERR_USAGE for a name that is too long, ERR_LIMIT
 * for one window too many. */
enum err setup_window(struct pilot_setup *setup, const char *name, int64_t centre, int64_t width,
                      struct fault *fault);

/* ---- state that lasts from one use to the next ---- */

enum pilot_mode {
    PILOT_MOVING,     /* keys move the cross-hair, plant, turn .. */
    PILOT_PICKING,    /* keys move a pixel in the rendition, and plant in the voxel that it shows */
    PILOT_CONFIRMING, /* the marker whose trees contain the voxel is shown: x or Enter removes it */
    PILOT_CONFIRMING_TREE, /* the single tree is shown: X or Enter removes it */
    PILOT_EXPLAINING,      /* the path of the voxel is shown: keys correct its strongest edge */
    PILOT_WINDOWING,       /* arrows change the window */
    PILOT_RANGING,         /* LOW..HIGH is typed: the intensities that the brush plants in */
    PILOT_OUTLINING,       /* the pen draws an outline: moving the cross-hair extends it */
    PILOT_SHAPING,         /* an outline exists, to be dragged and planted */
    PILOT_WATCHING,        /* existing steps are shown, and nothing can be changed */
};

static inline bool pilot_outlines(enum pilot_mode mode)
{
    return mode == PILOT_OUTLINING || mode == PILOT_SHAPING;
}

static inline bool pilot_confirms(enum pilot_mode mode)
{
    return mode == PILOT_CONFIRMING || mode == PILOT_CONFIRMING_TREE;
}

/* Action of the loop in addition to the command. */
enum pilot_request {
    PILOT_NOTHING,
    PILOT_PROMPT,
    PILOT_SHOW_KEYS,
    PILOT_SHOW_LABELS,
    PILOT_REDRAW,
    PILOT_SUSPEND,
    PILOT_LEAVE
};

struct pilot_mark {
    bool is_set;
    uint32_t place[3];
};

enum { PILOT_MARKS = 26 }; /* a-z */
enum { PILOT_RANGE_BYTES = 40 };

/* The last change, for `.`: a row of the table, its key and its count. */
struct pilot_change {
    const struct pilot_row *row; /* NULL: none yet */
    struct key_event key;
    uint32_t count;
};

/* The last box or outline, and the cross-hair at that time: `.` plants it relative to the present
 * one. */
struct pilot_shape {
    struct polyline outline;
    uint32_t place[3];
};

/* While the pen is down, its drawing is a sketch: shown, and not recorded. It becomes one command
 * when the pen is lifted, when the mouse button is released, or before another command or brush:
 * then the pen continues with another stroke. Escape discards it. */
struct pilot_pen {
    bool is_down;
    struct polyline line;     /* the stroke; at least two corners if anything is drawn */
    struct pilot_brush brush; /* that draws it */
};

/* A grabbed outline, as it was then, and the place where it was grabbed: that part follows the
 * cross-hair. */
struct pilot_hold {
    bool is_set;
    uint32_t place[3];
    struct polyline line;
};

enum { PILOT_CORNERS_MOST = 1000 }; /* limit of an outline, and of a line of a journal */

struct pilot_state {
    const struct pilot_setup *setup;
    bool watches; /* looking only: the mode to return to is PILOT_WATCHING, not PILOT_MOVING */
    /* the mode, and the one to return to: moving, picking, an outline or watching */
    enum pilot_mode mode, base;
    enum pilot_pane pane; /* one of the three slices, in which arrows move */
    struct pilot_brush brush;
    struct pilot_pen pen;
    struct pilot_mark stroke;                    /* one end of a stroke */
    struct pilot_way way;                        /* the path shown */
    unsigned hint;                               /* the last one shown; 0: none */
    bool heat;                                   /* slices are coloured by uncertainty */
    struct polyline outline;                     /* corners of a box or an outline so far */
    struct pilot_hold hold;                      /* grabbed point of the outline, if any; */
    bool is_bent;                                /* it was dragged, and is not planted yet */
    uint32_t instead;                            /* marker to replace, or 0 */
    unsigned doubt;                              /* the last slice shown; 0: none */
    char typed[PILOT_RANGE_BYTES];               /* LOW..HIGH so far */
    struct pilot_mark mark[PILOT_MARKS], former; /* and the place before the last jump */
    uint32_t count;                              /* typed so far; 0 for none */
    uint32_t leader;                             /* the first key of two, or 0 */
    uint32_t pixel[2];
    bool has_pixel;
    bool had_object;  /* there was an object before the last command */
    bool is_alone;    /* one pane has the whole screen: the slice, or the pane being corrected */
    bool drags;       /* the mouse draws, */
    unsigned dragged; /* voxels of an outline dragged so far, */
    bool encloses;    /* or the mouse draws a ball, whose centre is the only corner */
    bool sketches;    /* the last lines are a sketch */
    bool sends_ahead; /* slices are being sent ahead */
    bool was_open;    /* the pilot was open before: slices around here were sent ahead */
    bool drops;       /* the sketch is to be discarded */
    bool has_exact;   /* a seed of the last lines is exact */
    bool is_silent;   /* the effect of the last line is visible below the picture anyway */
    bool says_all;    /* show all lines of the answer, not only the last, */
    bool has_pages;   /* by pages on the whole screen */
    struct pilot_change change;
    struct pilot_shape shape;
};

/* `setup` must outlive the state. */
void pilot_state_init(struct pilot_state *state, const struct pilot_setup *setup);
void pilot_state_release(struct pilot_state *state);

/* Return the mode to return to at last. */
static inline enum pilot_mode pilot_home(const struct pilot_state *state)
{
    return state->watches ? PILOT_WATCHING : PILOT_MOVING;
}

/* If the first object is a segmentation, choose its label under the cross-hair, or the one of the
 * smallest number. Choose another label than one that does not exist. */
void pilot_fit_label(struct pilot_state *state, const struct pilot_host *host,
                     const struct pilot_facts *facts);

/* If the radius was not chosen, limit it to a tenth of the scene's least side, in voxels. */
void pilot_fit_brush(struct pilot_state *state, uint32_t side);

/* Return true if the mode is left at any key that it does not have. */
static inline bool pilot_is_passing(const struct pilot_state *state)
{
    return state->mode != pilot_home(state) && state->mode != PILOT_PICKING;
}

/* Enter the pilot again: choices are kept, unfinished actions are not. */
void pilot_state_enter(struct pilot_state *state);

/* A key, and its context. */
struct press {
    struct pilot_state *state;
    const struct key_event *event;
    const struct pilot_host *host;
    const struct pilot_facts *facts;
    struct buf *line, *message;
    int by;                     /* `by` of the row, once it is found; 0 and PILOT_NOTHING before, */
    enum pilot_request request; /* and the action of the loop */
};

/* Add the command of the key to `line`, if any; several commands, separated by line feeds, run one
 * after the other until one fails. A message for the user is added to `message`. */
enum pilot_request pilot_press(struct press *press);

/* The same for a mouse report at this pixel of the picture. */
void pilot_click(struct press *press, uint32_t column, uint32_t row);

/* Return true if a key moves the cross-hair, or is a digit of a count: then further keys may be
 * read before it is carried out. */
bool pilot_moves(const struct pilot_state *state, const struct key_event *event);

/* The same if it draws nothing, neither by the pen nor an outline: then it can be shown while a
 * command runs. */
bool pilot_only_moves(const struct pilot_state *state, const struct key_event *event);

/* Add the hints of the present mode, in a line that fits 80 columns; `bold` as in setup_say. */
void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     const char *bold, struct buf *out);

/*
 * Add the row below the picture, without a line feed, for a screen of `columns`: the place of the
 * cross-hair, the brush, pending edits, and facts of the voxel.
 *
 *     axial at 90,108,90  brush 2 ventricle r3  here 1 brain 1.64 l (+1.2 ml)  intensity 93
 *
 * The row consists of parts, each with a rank. A narrow screen shows the parts of the highest ranks
 * that fit, each whole, in the same order: the place, the brush and the label first, then its name,
 * the intensity, millimetres, the volume and its change, the rest. So parts do not move when a part
 * of low rank appears. A `>` at the end marks slices being sent ahead.
 */
void pilot_add_status(struct buf *out, const struct pilot_state *state,
                      const struct pilot_host *host, const struct pilot_facts *facts,
                      unsigned columns);

/* Add the radius and the range of a brush, for a user: " r2.5mm 80..120". */
void pilot_add_brush(struct buf *out, const struct pilot_brush *brush);

/* Return true if no tree grows from seeds of the brush. */
bool pilot_is_exact(const struct pilot_brush *brush, const struct pilot_facts *facts);

/* " over" or " keep", by enum brush_limit. */
extern const char *const pilot_limits[];

/* Add a decimal as commands accept it: at most three places, without trailing zeros. */
void pilot_add_decimal(struct buf *line, double value);

/* Options of the page of keys. */
struct pilot_keys_wish {
    const struct pilot_setup *setup;
    bool watches;                /* keys for watching */
    unsigned columns;            /* width of the window */
    const struct theme *theme;   /* its colours; NULL: none */
    const char *wanted;          /* part of a key, a name or its help; "" or NULL for all */
    const struct key_event *key; /* describe this key, or keys that begin with it; or NULL */
};

/* Add the page, part by part with headings: two entries on a line of at most 78 columns, or one, or
 * each on two lines, to be wrapped by cells_wrap. With `wanted`, each matching action is on a line
 * of its own, with its name; with `key` too, with a description, or no line without such a key. */
void pilot_keys_page(struct buf *out, const struct pilot_keys_wish *wish);

/* Return the row of a key in the present mode; NULL if it has no effect. */
const struct pilot_row *pilot_row_of(const struct pilot_state *state,
                                     const struct key_event *event);

/* ---- keys typed ahead ---- */

/*
 * Keys typed while a command is carried out. They are handled in order when it has ended; until
 * then they are shown as far as they only move the cross-hair.
 */
enum { TYPED_AHEAD_MOST = 128 };

/* {0} is empty. */
struct typed_ahead {
    struct key_event event[TYPED_AHEAD_MOST];
    size_t count, taken;
};

/* Return true if there is room for another key; a paste, whose text is stored once, must be the
 * last. */
bool typed_ahead_has_room(const struct typed_ahead *ahead);
void typed_ahead_add(struct typed_ahead *ahead, const struct key_event *event);

/* Remove the first key; false without one. */
bool typed_ahead_take(struct typed_ahead *ahead, struct key_event *event);

/* Insert it as the first one; after an event was taken there is room. */
void typed_ahead_put_back(struct typed_ahead *ahead, const struct key_event *event);

/* Make the host show the cross-hair where the keys lead, and set `state` to the state after them,
 * up to the first key with another effect. */
void typed_ahead_show(const struct typed_ahead *ahead, struct pilot_state *state,
                      const struct pilot_host *host);

/* ---- the table ---- */

#define PILOT_IN(mode) (1u << (mode))

enum pilot_flag {
    PILOT_COUNTS = 1,      /* the row accepts a count */
    PILOT_CHANGES = 2,     /* `.` repeats it */
    PILOT_STAYS = 4,       /* the mode does not change */
    PILOT_IS_SILENT = 8,   /* the effect of the line is visible below the picture anyway */
    PILOT_SAYS_ALL = 16,   /* show each line of its answer */
    PILOT_ONLY_MOVES = 32, /* it reads and changes nothing of the segmentation */
    PILOT_OUTLINES = 64,   /* it plants the area within the corners */
    PILOT_HAS_PAGES = 128  /* its answer is shown on the whole screen */
};

typedef void pilot_act(struct press *p);

/* An action. The first row that has the key (struct chord) in the present mode is used. */
struct pilot_row {
    const char *name; /* NULL: a row of the page alone */
    const char *keys; /* shown on the page, */
    const char *also; /* and others with the same effect, not shown */
    /* On the page in place of the keys of this row and of rows joining it; in a row without keys
     * and help the heading of a part. */
    const char *shown;
    unsigned in;         /* modes in which the row applies */
    const char *command; /* its effect: this command, with '@' for the cross-hair's place, */
    pilot_act *act;
    int by; /* an argument of the function: which of several variants */
    enum pilot_request request;
    enum pilot_mode then; /* the mode afterwards; PILOT_MOVING means the state's `base` */
    unsigned flags;
    const char *help; /* on the page; "" joins the row before; NULL: none */
    const char *text; /* its description and that of rows that join it, shown by `?` and the key */
    const char *hint; /* after its key, below the picture, in the modes of the row; or NULL */
};

extern const struct pilot_row pilot_table[];
extern const size_t pilot_rows;

/* Give an action of the table these keys (struct chord). ERR_USAGE for a word that names no key and
 * for a key that another action has. */
enum err setup_keys(struct pilot_setup *setup, const struct pilot_row *row, const char *words,
                    struct fault *fault);

/* Return the row of that name, or NULL. */
const struct pilot_row *setup_row(const struct pilot_setup *setup, const char *name);

/* Return the keys that the user has given a row, or NULL. */
const char *setup_own(const struct pilot_setup *setup, const struct pilot_row *row);

/* Add the keys of a row that the page shows, separated by blanks; at most `most`. */
void setup_add_keys(struct buf *out, const struct pilot_setup *setup, const struct pilot_row *row,
                    size_t most);

/* Add a message with the user's keys: {NAME} is the first key of that row, {NAME:c} the key with
 * this character if the row has a range: s0 for {plant-label:0}. Keys are preceded by `bold`, CSI
 * .. m or "". */
void setup_say(struct buf *out, const struct pilot_setup *setup, const char *bold,
               const char *format, ...) __attribute__((format(printf, 4, 5)));
#define pilot_say(press, ...) setup_say((press)->message, (press)->state->setup, "", __VA_ARGS__)

/* ---- keys as words ---- */

/*
 * Keys as words, in the table of keys and in the configuration:
 *
 *     k                    a character
 *     Tab Page-up          a key with a name: Enter, Escape, Space, Left, Home, Delete ..
 *     Ctrl-r Shift-Up      with modifiers; Shift is part of a character, and not named there
 *     gg 'a                a character after another, its first key
 *     0-9 a-z sa-z         a range of characters, alone or after a first key
 *     any                  any key
 *
 * Words are separated by blanks. Pure.
 */
struct chord {
    uint32_t leader; /* the first key of two; 0: none */
    enum key key;    /* KEY_PENDING: any; KEY_OTHER: the word names no key */
    unsigned modifiers;
    uint32_t first, last; /* for KEY_CHARACTER */
    const char *word;     /* in the text read */
    size_t length;        /* bytes of the word */
};

/* Return true if the event, after that first key, is the chord. */
bool chord_fits(const struct chord *chord, uint32_t leader, const struct key_event *event);

/* Return true if an event matches both, or matches one and begins the other. */
bool chord_clashes(const struct chord *a, const struct chord *b);

/* Iterate over words: read the next one and move *at past it. Return false at the end. */
bool chord_next(const char **at, struct chord *chord);

/* ---- functions of rows ---- */

/* `by` of pilot_move: the direction on the screen, and whether to move far. */
enum { PILOT_LEFT, PILOT_DOWN, PILOT_UP, PILOT_RIGHT, PILOT_WAYS, PILOT_FAR = PILOT_WAYS };

/* Go to a place; with the pen down draw a stroke to it. pilot_cross never draws, and returns true
 * if the cross-hair moves. */
void pilot_go_to(struct press *p, const uint32_t place[3]);
bool pilot_cross(struct press *p, const uint32_t place[3]);
/* Magnify slices around the cross-hair by steps of about a quarter; negative steps reduce. Return
 * false at the largest or smallest size. */
bool pilot_magnify_by(struct press *p, int64_t steps);
/* Set the corners of the last box or polygon again, relative to the cross-hair. Return false, with
 * a message, if they would leave the scene. */
bool pilot_move_shape(struct press *p);
/* Remember the corners for pilot_move_shape and clear them. */
void pilot_remember_shape(struct press *p);
/* Add a corner. Return false, with a message, if it is in another slice or there are too many. */
bool pilot_add_corner(struct press *p, const uint32_t place[3]);
/* Extend or drag an outline as the cross-hair goes to a place. Return false without an outline. */
bool pilot_outline_to(struct press *p, const uint32_t place[3]);
/* Discard the present outline, and return to the mode without one. */
void pilot_end_outline(struct pilot_state *state);
void pilot_outline_click(struct press *p, const uint32_t place[3], enum pilot_pane pane);
/* Go there without drawing and remember the place before, for pilot_go_back. */
void pilot_remember_place(struct press *p);
void pilot_jump(struct press *p, const uint32_t place[3]);
/* Get the voxel that a key acts on: the one under the cross-hair, or the one that the pixel of the
 * rendition shows, to which the cross-hair then goes. Return false, with a message, if the pixel
 * shows none. */
bool pilot_take_voxel(struct press *p, uint32_t place[3]);
/* Return the count typed before the key, else 1; `at` moved by voxels within 0 .. end - 1. */
int64_t pilot_times(const struct press *p);

/* Return true if a label exists; else say that it does not. */
bool pilot_has_label(const struct press *p, uint32_t label);
uint32_t pilot_shifted(uint32_t at, int64_t by, uint32_t end);
/* Round a value to a thousandth, or to significant digits if it is very small or very large. */
struct decimal pilot_decimal(double value);
/* Return true if the path that is shown has an edge; else false, with a message. */
bool pilot_has_edge(struct press *p);
/* Add " 2 range=80..120 within=0 over=1": the label and the limits of the brush; or the last ones
 * alone. */
void pilot_add_label(struct press *p, const struct pilot_brush *brush);
void pilot_add_exact(struct press *p, const struct pilot_brush *brush);
/* Return true if a command with these limits would be accepted, for a single ball or for another
 * gesture; otherwise say what to do. */
bool pilot_may_plant(struct press *p, bool is_ball);
/* Add "2.5mm". */
void pilot_add_radius(struct buf *out, const struct pilot_brush *brush);
/* A place in a command: buf_printf(line, "cross " PLACE, XYZ(place)). */
#define PLACE      "%u,%u,%u"
#define XYZ(place) (place)[0], (place)[1], (place)[2]
/* Add the commands of the stroke that the pen has drawn. */
void pilot_add_stroke(struct press *p);

/* Functions of rows, by file. `by` of the row is 1 for an action and -1 for its counterpart, unless
 * the definition says otherwise. */
pilot_act pilot_repeat;
pilot_act pilot_move, pilot_change_slice, pilot_to_slice, pilot_next_pane, pilot_set_mark,
    pilot_go_to_mark, pilot_measure, pilot_go_back, pilot_next_seed, pilot_explain,
    pilot_go_to_edge, pilot_go_to_hint, pilot_show_heat, pilot_undo, pilot_hide, pilot_show_all,
    pilot_turn, pilot_roll, pilot_change_zoom, pilot_fit, pilot_change_overlay, pilot_change_labels,
    pilot_preset, pilot_magnify, pilot_recentre, pilot_pan, pilot_show_alone, pilot_begin_picking,
    pilot_end_picking, pilot_step, pilot_to_step;
pilot_act pilot_choose_label, pilot_change_radius, pilot_change_unit, pilot_change_growth,
    pilot_change_limit, pilot_take_range, pilot_begin_range, pilot_type_range, pilot_erase_typed,
    pilot_end_range, pilot_plant, pilot_plant_at_edge, pilot_enclose_at_edge, pilot_stroke_at_edge,
    pilot_show_held, pilot_lower_pen, pilot_begin_stroke, pilot_drop_stroke, pilot_set_corner,
    pilot_plant_box, pilot_plant_shell;
pilot_act pilot_begin_outline, pilot_close_outline, pilot_drop_outline, pilot_grab,
    pilot_load_outline, pilot_go_to_doubt;

#endif
