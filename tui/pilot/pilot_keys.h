/* SPDX-License-Identifier: MIT */
/*
 * What keys mean to the pilot: a state, a key and the facts in, the line of a command out. Pure.
 *
 * All keys stand in one table (pilot_key_table.c), a row for each thing that they do: its name, its
 * keys, in which modes it is done, by what line or function, and the words for it on the page of
 * keys and below the picture. The page, which `?` shows, is also the card in tui/README.md.
 *
 * As in vim, digits are a count for the key after them, a key that takes none says so, some keys
 * wait for a second one, and Escape takes back what was begun. No digit alone plants anything but
 * in PILOT_PICKING, where one corrects what the rendition shows.
 *
 * Files call downward alone:
 *
 *     pilot_key_table.c    the table, the page of keys and the hints
 *     pilot_keys.c         finds the row for a key, by the table of the setup
 *     pilot_acts.c         what rows do that look, go somewhere or ask
 *     pilot_plant.c        what rows do that plant or remove
 *     pilot_outline.c      outlines: drawn, taken up, dragged and closed
 *     pilot_press.c        keys and windows of a user, and words and moves that all of them need
 */
#ifndef TUI_PILOT_PILOT_KEYS_H
#define TUI_PILOT_PILOT_KEYS_H

#include "base/scan.h"
#include "base/polyline.h"
#include "tui/keys.h"
#include "tui/pilot/host.h"
#include "tui/theme.h"

/* ---- how the pilot is set up ---- */

enum {
    SETUP_WINDOWS_MOST = 9, /* a digit each */
    SETUP_ROWS_MOST = 128,  /* of the table of keys */
    SETUP_NAME_BYTES = 12,
    SETUP_KEYS_BYTES = 48
};

/* A window of greys, in thousandths of real values. */
struct setup_window {
    char name[SETUP_NAME_BYTES];
    int64_t centre, width;
};

/* With what one plants. */
struct pilot_brush {
    unsigned label;
    unsigned radius; /* voxels, or halves of a millimetre where it is in_mm; 0 for one voxel */
    bool in_mm;
    bool fits;      /* nobody has chosen the radius: it is made to fit the scene */
    bool has_range; /* only voxels whose intensity is within: real values */
    struct decimal range[2];
};

struct pilot_row;

struct pilot_setup {
    const struct pilot_row *table; /* [rows], of what keys do */
    size_t rows;
    const struct theme *theme;
    struct pilot_brush brush; /* to begin with */
    struct setup_window window[SETUP_WINDOWS_MOST];
    size_t windows;
    bool keeps_back;                              /* no slice is sent ahead (tui/pilot/ahead.h) */
    char keys[SETUP_ROWS_MOST][SETUP_KEYS_BYTES]; /* by row; "" where the user has said none */
};

/* Without a word of the user: windows for CT. */
extern const struct pilot_setup pilot_setup_default;

/* A window under that name, in place of the one that has it. ERR_USAGE for a name that is too long,
 * ERR_LIMIT for one window too many. */
enum err setup_window(struct pilot_setup *setup, const char *name, int64_t centre, int64_t width,
                      struct fault *fault);

/* ---- what is chosen, from one time to the next ---- */

enum pilot_mode {
    PILOT_MOVING,     /* keys move the cross-hair, plant, turn .. */
    PILOT_PICKING,    /* they move a pixel in the rendition, and plant in the voxel that it shows */
    PILOT_CONFIRMING, /* the marker whose trees hold the voxel is shown: x or Enter removes it */
    PILOT_CONFIRMING_TREE, /* the single tree is: X or Enter removes it */
    PILOT_EXPLAINING,      /* the path of the voxel is shown: keys correct its strongest edge */
    PILOT_WINDOWING,       /* arrows change the window */
    PILOT_RANGING,         /* LOW..HIGH is typed: the intensities in which the brush plants */
    PILOT_OUTLINING,       /* a pen draws an outline: what moves the cross-hair adds to it */
    PILOT_SHAPING,         /* an outline is there, to be dragged and planted */
    PILOT_WATCHING,        /* steps that are there are shown, and one looks */
};

static inline bool pilot_outlines(enum pilot_mode mode)
{
    return mode == PILOT_OUTLINING || mode == PILOT_SHAPING;
}

static inline bool pilot_confirms(enum pilot_mode mode)
{
    return mode == PILOT_CONFIRMING || mode == PILOT_CONFIRMING_TREE;
}

/* What the loop is to do beside carrying out the line. */
enum pilot_deed {
    PILOT_NOTHING,
    PILOT_PROMPT,
    PILOT_SHOW_KEYS,
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

/* What was changed last, for `.`: a row of the table, its key and its count. */
struct pilot_change {
    const struct pilot_row *row; /* NULL for nothing yet */
    struct key_event key;
    uint32_t count;
};

/* The last box or outline, and where the cross-hair was: `.` plants it beside where that is now. */
struct pilot_shape {
    struct polyline outline;
    uint32_t place[3];
};

/* While the pen is down, what it has drawn is a sketch: shown, and not recorded. It becomes one
 * command when the pen is lifted, when the mouse's button is, or when another command or brush
 * comes: then the pen goes on with another stroke. Escape drops it. */
struct pilot_pen {
    bool is_down;
    struct polyline line;     /* of the stroke; two corners or more where anything is drawn */
    struct pilot_brush brush; /* that it is drawn with */
};

/* An outline is taken hold of at a place, as it was then: there it follows the cross-hair. */
struct pilot_hold {
    bool is_set;
    uint32_t place[3];
    struct polyline line;
};

enum { PILOT_CORNERS_MOST = 1000 }; /* of an outline, in a line of a journal */

struct pilot_state {
    const struct pilot_setup *setup;
    bool watches;               /* nothing but looking: its home is PILOT_WATCHING, not MOVING */
    enum pilot_mode mode, base; /* where others lead back to: moving, picking, an
                                   outline's or watching */
    enum pilot_pane pane;       /* of the three slices: arrows move in it */
    struct pilot_brush brush;
    struct pilot_pen pen;
    struct pilot_mark stroke;                    /* one end of a stroke */
    struct pilot_way way;                        /* that is shown */
    unsigned hint;                               /* the one that was shown last; 0 for none */
    bool heat;                                   /* slices are coloured by uncertainty */
    struct polyline outline;                     /* corners of a box or an outline, so far */
    struct pilot_hold hold;                      /* that of the outline, if any; */
    bool is_bent;                                /* it was dragged, and is not planted yet */
    uint32_t instead;                            /* of which marker it is, or 0 */
    unsigned doubt;                              /* the slice that was shown last; 0 for none */
    char typed[PILOT_RANGE_BYTES];               /* LOW..HIGH, so far */
    struct pilot_mark mark[PILOT_MARKS], former; /* and the place before the last jump */
    uint32_t count;                              /* typed so far; 0 for none */
    uint32_t leader;                             /* the key whose second is awaited, or 0 */
    uint32_t pixel[2];
    bool has_pixel;
    bool is_alone; /* one pane has the whole screen: that of the slices, or that one corrects in */
    bool drags;    /* the mouse draws, */
    unsigned dragged; /* so many places of an outline, */
    bool encloses;    /* or pulls a ball open, whose middle is the one corner */
    bool sketches;    /* the last lines are a sketch */
    bool sends_ahead; /* slices are on their way that nobody has asked for */
    bool drops;       /* the sketch is to be dropped */
    bool is_silent;   /* what the last line does is seen below the picture anyway */
    bool says_all;    /* all lines of what it says are of use, not the last alone, */
    bool has_pages;   /* and need the screen */
    struct pilot_change change;
    struct pilot_shape shape;
};

/* The setup is borrowed. */
void pilot_state_init(struct pilot_state *state, const struct pilot_setup *setup);
void pilot_state_release(struct pilot_state *state);

/* Where keys lead back to in the end. */
static inline enum pilot_mode pilot_home(const struct pilot_state *state)
{
    return state->watches ? PILOT_WATCHING : PILOT_MOVING;
}

/* Of a scene whose least side has so many voxels: where nobody has chosen a radius, it is at most a
 * tenth of that. */
void pilot_fit_brush(struct pilot_state *state, uint32_t side);

/* Whether the mode is one for some keys alone, which any other key ends. */
static inline bool pilot_is_passing(const struct pilot_state *state)
{
    return state->mode != pilot_home(state) && state->mode != PILOT_PICKING;
}

/* The pilot is entered once more: what was chosen is as it was, what was begun is not. */
void pilot_state_enter(struct pilot_state *state);

/* A key, and what it is pressed upon. */
struct press {
    struct pilot_state *state;
    const struct key_event *event;
    const struct pilot_host *host;
    const struct pilot_facts *facts;
    struct buf *line, *message;
    int by;               /* of the row, once it is found; 0 and PILOT_NOTHING before, */
    enum pilot_deed deed; /* and what it asks of the loop */
};

/* Adds the line of the command that the key stands for to `line`, if any; several, parted by line
 * feeds, are carried out one after the other until one fails. `message` gets a word for the user
 * where there is something to say. */
enum pilot_deed pilot_press(struct press *press);

/* The same for a mouse report, which lies in the picture at this pixel. */
void pilot_click(struct press *press, uint32_t column, uint32_t row);

/* Whether a key only moves the cross-hair, and draws nothing, or begins another one: it can be
 * shown while something else is carried out. */
bool pilot_only_moves(const struct pilot_state *state, const struct key_event *event);

/* Adds what the keys do in the present mode, in a line that fits 80 columns. */
void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     struct buf *out);

/* Adds the radius and the range of a brush, for a user: " r2.5mm 80..120". */
void pilot_add_brush(struct buf *out, const struct pilot_brush *brush);

/* Adds a decimal as commands take it: three places at most, no zeros at its end. */
void pilot_add_decimal(struct buf *line, double value);

/* How the page of keys is wanted. */
struct pilot_keys_wish {
    const struct pilot_setup *setup;
    bool watches;       /* the keys for that */
    unsigned columns;   /* of the window */
    bool has_colours;   /* those of the setup's theme */
    const char *wanted; /* a piece of a key, a name or of what it does; "" or NULL for all */
};

/* Adds it, part by part with headings: two entries on a line of at most 78, or one; or each in two
 * lines, to be broken by cells_wrap. Where something is wanted each action that has it stands on a
 * line of its own, with its name. */
void pilot_keys_page(struct buf *out, const struct pilot_keys_wish *wish);

/* Whether the key does something in the present mode. */
bool pilot_has_key(const struct pilot_state *state, const struct key_event *event);

/* ---- keys typed ahead ---- */

/*
 * Keys that were typed while a command is carried out: they are taken when it has ended, in their
 * order, and until then shown as far as they only move the cross-hair.
 */
enum { TYPED_AHEAD_MOST = 128 };

/* {0} is empty. */
struct typed_ahead {
    struct key_event event[TYPED_AHEAD_MOST];
    size_t count, taken;
};

/* Whether there is room for another; it is not asked for after a paste, whose text is kept once. */
bool typed_ahead_has_room(const struct typed_ahead *ahead);
void typed_ahead_add(struct typed_ahead *ahead, const struct key_event *event);

/* The first of them, which goes; false where there is none. */
bool typed_ahead_take(struct typed_ahead *ahead, struct key_event *event);

/* Becomes the first of them; after an event was taken there is room. */
void typed_ahead_put_back(struct typed_ahead *ahead, const struct key_event *event);

/* Has the host show the cross-hair where those keys will lead, and `state` what they will make of
 * it, up to the first that does anything else. */
void typed_ahead_show(const struct typed_ahead *ahead, struct pilot_state *state,
                      const struct pilot_host *host);

/* ---- the table ---- */

#define PILOT_IN(mode) (1u << (mode))

enum pilot_flag {
    PILOT_COUNTS = 1,      /* the row takes a count */
    PILOT_CHANGES = 2,     /* `.` repeats it */
    PILOT_STAYS = 4,       /* the mode does not change */
    PILOT_IS_SILENT = 8,   /* what the line does is seen below the picture anyway */
    PILOT_SAYS_ALL = 16,   /* each line of its answer is of use */
    PILOT_ONLY_MOVES = 32, /* it asks nothing of the segmentation, and changes nothing of it */
    PILOT_OUTLINES = 64,   /* it plants what the corners enclose */
    PILOT_HAS_PAGES = 128  /* its answer has the screen for itself */
};

/* Words of keys are those of tui/pilot/chord.h; the first row that fits is taken. */
struct pilot_row {
    const char *name;    /* NULL: of the page alone */
    const char *keys;    /* on the page, */
    const char *also;    /* and those that do the same and are not shown there */
    const char *shown;   /* on the page in place of the keys of this row and those that join it */
    unsigned in;         /* these modes */
    const char *command; /* what it does: this line, with the cross-hair's place for '@', */
    void (*act)(struct press *);
    int by; /* this, or that: which of several things that the function does */
    enum pilot_deed deed;
    enum pilot_mode then; /* the mode afterwards; PILOT_MOVING stands for the state's `base` */
    unsigned flags;
    const char *help; /* on the page; "" joins the row before; NULL begins another part of the page
                         where the row has no keys, headed by `shown`, else it is not there */
    const char
        *hint; /* after its key, below the picture as long as one of its modes lasts; or NULL */
};

extern const struct pilot_row pilot_table[];
extern const size_t pilot_rows;

/* Gives an action of the table the keys, words of tui/pilot/chord.h. ERR_USAGE for what is no key,
 * or a key that another action was given. */
enum err setup_keys(struct pilot_setup *setup, const struct pilot_row *row, const char *words,
                    struct fault *fault);

/* The row of that name; NULL for none. */
const struct pilot_row *setup_row(const struct pilot_setup *setup, const char *name);

/* The keys that the user has given a row, or NULL. */
const char *setup_own(const struct pilot_setup *setup, const struct pilot_row *row);

/* Adds the keys that a row has, of those that the page shows, with blanks between; at most `most`.
 */
void setup_add_keys(struct buf *out, const struct pilot_setup *setup, const struct pilot_row *row,
                    size_t most);

/* Adds the first key of the row of that name, and words after it; of one with a range, as s0-9, the
 * key with this character, as s0. For messages, which name the keys that the user has. */
void setup_say_key(struct buf *out, const struct pilot_setup *setup, const char *name,
                   const char *words);
void setup_say_key_to(struct buf *out, const struct pilot_setup *setup, const char *name, char c,
                      const char *words);

/* ---- what rows do ---- */

/* `by` of pilot_move: which way on the screen, and whether far. */
enum { PILOT_LEFT, PILOT_DOWN, PILOT_UP, PILOT_RIGHT, PILOT_WAYS, PILOT_FAR = PILOT_WAYS };

/* Goes to a place; with the pen down, a stroke leads there. pilot_cross draws none; whether it
 * moves. */
void pilot_go_to(struct press *p, const uint32_t place[3]);
bool pilot_cross(struct press *p, const uint32_t place[3]);
/* Magnifies slices by so many steps of a quarter or so, or less, around the cross-hair. False where
 * they are as large, or as small, as can be. */
bool pilot_magnify_by(struct press *p, int64_t steps);
/* Sets the corners of the last box or polygon once more, beside the cross-hair. False, with a
 * message, where that cannot be. */
bool pilot_move_shape(struct press *p);
/* The corners are set no more, but remembered for that. */
void pilot_keep_shape(struct press *p);
/* One corner more. False, with a message, where it lies in another slice or is one too many. */
bool pilot_add_corner(struct press *p, const uint32_t place[3]);
/* Where the cross-hair goes to a place, so does an outline that is drawn or held. False where none
 * is begun. */
bool pilot_outline_to(struct press *p, const uint32_t place[3]);
void pilot_outline_click(struct press *p, const uint32_t place[3], enum pilot_pane pane);
/* Takes LOW..HIGH; false where `at` begins with something else. */
bool pilot_scan_range(const char **at, struct decimal range[2]);
/* Goes there, draws nothing, and can be taken back: the place before is remembered. */
void pilot_remember_place(struct press *p);
void pilot_jump(struct press *p, const uint32_t place[3]);
/* The voxel that is meant: under the cross-hair, or the one that the pixel of the rendition shows,
 * and then the cross-hair goes there. False, with a message, where that shows none. */
bool pilot_take_voxel(struct press *p, uint32_t place[3]);
/* The count typed before the key; `at` moved by so many, and no further than 0 .. end - 1. */
int64_t pilot_times(const struct press *p);
uint32_t pilot_shifted(uint32_t at, int64_t by, uint32_t end);
/* As setup_say_key, to the message. */
void pilot_say_key(struct press *p, const char *name, const char *words);
/* A value to a thousandth, or of smaller and of huge values to so many digits. */
struct decimal pilot_decimal(double value);
double pilot_magnitude(double value);
/* Whether the path that is shown has one; else false, with a message. */
bool pilot_has_edge(struct press *p);
/* " 2 range=80..120": the label of the brush, and where it plants. */
void pilot_add_label(struct buf *line, const struct pilot_brush *brush);
/* "2.5mm", and "80..120" */
void pilot_add_radius(struct buf *out, const struct pilot_brush *brush);
void pilot_add_range(struct buf *out, const struct pilot_brush *brush);
/* " 90,108,90" after some words. */
void pilot_add_place(struct buf *line, const char *before, const uint32_t place[3]);
/* The stroke that the pen has drawn, as the lines of its command. */
void pilot_add_stroke(struct pilot_state *state, const struct pilot_facts *facts, struct buf *line);

/* What rows do. `by` where it matters: 1 for the one, -1 for its counterpart. */
void pilot_move(struct press *p);         /* one of the ways */
void pilot_change_slice(struct press *p); /* on, back */
void pilot_to_slice(struct press *p);     /* the first, the last, that of the count */
void pilot_next_pane(struct press *p);
void pilot_set_mark(struct press *p);
void pilot_go_to_mark(struct press *p);
void pilot_measure(struct press *p); /* from a mark to the cross-hair */
void pilot_go_back(struct press *p);
void pilot_next_seed(struct press *p); /* next, previous */
void pilot_go_to_centre(struct press *p);
void pilot_plant(struct press *p);
void pilot_plant_label(struct press *p);
void pilot_choose_label(struct press *p); /* next, previous, that of the count */
void pilot_change_radius(struct press *p);
void pilot_change_unit(struct press *p); /* of the radius */
void pilot_take_range(struct press *p);  /* around the intensity at the cross-hair */
void pilot_begin_range(struct press *p);
void pilot_type_range(struct press *p);
void pilot_erase_typed(struct press *p);
void pilot_end_range(struct press *p);
void pilot_set_corner(struct press *p);
void pilot_plant_box(struct press *p);
void pilot_plant_shell(struct press *p); /* 1: of a box; 0: of a ball */
void pilot_begin_outline(struct press *p);
void pilot_close_outline(struct press *p); /* plants it: one of corners, drawn or dragged */
void pilot_drop_outline(struct press *p);
void pilot_take_hold(struct press *p);   /* of its line, or lets go */
void pilot_take_up(struct press *p);     /* the outline that is there, to be corrected */
void pilot_go_to_doubt(struct press *p); /* next, previous, that of the count */
void pilot_lower_pen(struct press *p);
void pilot_begin_stroke(struct press *p);
void pilot_drop_stroke(struct press *p);
void pilot_show_held(struct press *p); /* 1: the single tree; 0: its marker */
void pilot_repeat(struct press *p);
void pilot_hide(struct press *p);
void pilot_show_all(struct press *p);
void pilot_undo(struct press *p); /* undo, redo */
void pilot_explain(struct press *p);
void pilot_go_to_edge(struct press *p);    /* that of the path that is shown */
void pilot_plant_at_edge(struct press *p); /* 1: the label of the digit; 0: what would come next */
void pilot_enclose_at_edge(struct press *p); /* a shell through it */
void pilot_stroke_at_edge(struct press *p);
void pilot_go_to_hint(struct press *p); /* next, previous, that of the count */
void pilot_show_heat(struct press *p);
void pilot_turn(struct press *p); /* one of the ways */
void pilot_roll(struct press *p);
void pilot_pan(struct press *p); /* one of the ways */
void pilot_change_zoom(struct press *p);
void pilot_change_overlay(struct press *p);
void pilot_change_labels(struct press *p); /* finished ones, the forest's */
void pilot_magnify(struct press *p);       /* more, less; 0 for whole slices */
void pilot_recentre(struct press *p);
void pilot_show_alone(struct press *p);
void pilot_preset(struct press *p); /* the window of that number */
/* Where one watches, lines for the host that shows steps: "step on 3". */
void pilot_step(struct press *p);    /* on, back; by the count */
void pilot_to_step(struct press *p); /* the first, the last, that of the count */
void pilot_begin_picking(struct press *p);
void pilot_end_picking(struct press *p); /* 1: at the voxel; 0: where the cross-hair is */

#endif
