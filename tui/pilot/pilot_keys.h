/*
 * What keys mean to the pilot: a state, a key and the facts in, the line of a command out. Pure.
 *
 * All keys stand in one table (pilot_table.c), a row for each thing that they do: its name, its
 * keys, in which modes it is done, by what line or function, and the words for it on the page of
 * keys and below the picture. The page, which `?` shows, is also the card in tui/README.md.
 *
 * As in vim, digits are a count for the key after them, a key that takes none says so, some keys
 * wait for a second one, and Escape takes back what was begun. No digit alone plants anything but
 * in PILOT_PICKING, where one corrects what the rendition shows.
 */
#ifndef TUI_PILOT_PILOT_KEYS_H
#define TUI_PILOT_PILOT_KEYS_H

#include "base/polyline.h"
#include "tui/keys.h"
#include "tui/pilot/pilot.h"
#include "tui/pilot/setup.h"

enum pilot_mode {
    PILOT_MOVING,     /* keys move the cross-hair, plant, turn .. */
    PILOT_PICKING,    /* they move a pixel in the rendition, and plant in the voxel that it shows */
    PILOT_CONFIRMING, /* the marker whose trees hold the voxel is shown: x or Enter removes it */
    PILOT_CONFIRMING_TREE, /* the single tree is: X or Enter removes it */
    PILOT_EXPLAINING,      /* the path of the voxel is shown: keys correct its strongest edge */
    PILOT_WINDOWING,       /* arrows change the window */
    PILOT_RANGING,         /* LOW..HIGH is typed: the intensities in which the brush plants */
};

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

/* The last box or polygon, and where the cross-hair was: `.` plants it beside where that is now. */
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

struct pilot_state {
    const struct pilot_setup *setup;
    enum pilot_mode mode, base; /* where others lead back to: moving or picking */
    enum pilot_pane pane;       /* of the three slices: arrows move in it */
    struct pilot_brush brush;
    struct pilot_pen pen;
    struct pilot_mark stroke;                    /* one end of a stroke */
    struct pilot_way way;                        /* that is shown */
    unsigned hint;                               /* the one that was shown last; 0 for none */
    bool heat;                                   /* slices are coloured by uncertainty */
    struct polyline outline;                     /* corners of a box or a polygon, so far */
    char typed[PILOT_RANGE_BYTES];               /* LOW..HIGH, so far */
    struct pilot_mark mark[PILOT_MARKS], former; /* and the place before the last jump */
    uint32_t count;                              /* typed so far; 0 for none */
    uint32_t leader;                             /* the key whose second is awaited, or 0 */
    uint32_t pixel[2];
    bool has_pixel;
    bool is_alone;  /* one pane has the whole screen: that of the slices, or that one corrects in */
    bool drags;     /* the mouse draws, */
    bool encloses;  /* or pulls a ball open, whose middle is the one corner */
    bool sketches;  /* the last lines are a sketch */
    bool drops;     /* the sketch is to be dropped */
    bool is_silent; /* what the last line does is seen below the picture anyway */
    bool tells_all; /* all lines of what it says are of use, not the last alone */
    struct pilot_change change;
    struct pilot_shape shape;
};

/* The setup is borrowed. */
void pilot_state_init(struct pilot_state *state, const struct pilot_setup *setup);
void pilot_state_release(struct pilot_state *state);

/* The pilot is entered once more: what was chosen is as it was, what was begun is not. */
void pilot_state_enter(struct pilot_state *state);

/* Adds the line of the command that the key stands for to `line`, if any; several, parted by line
 * feeds, are carried out one after the other until one fails. `message` gets a word for the user
 * where there is something to say. */
enum pilot_deed pilot_press(struct pilot_state *state, const struct key_event *event,
                            const struct pilot_host *host, const struct pilot_facts *facts,
                            struct buf *line, struct buf *message);

/* Whether a key only moves the cross-hair, and draws nothing, or begins another one: it can be
 * shown while something else is carried out. */
bool pilot_only_moves(const struct pilot_state *state, const struct key_event *event);

/* The same for a mouse report, which lies in the picture at this pixel. */
void pilot_click(struct pilot_state *state, const struct key_event *event, uint32_t column,
                 uint32_t row, const struct pilot_host *host, const struct pilot_facts *facts,
                 struct buf *line, struct buf *message);

/* Adds what the keys do in the present mode, in a line that fits 80 columns. */
void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     struct buf *out);

/* Adds the radius and the range of a brush, for a user: " r2.5mm 80..120". */
void pilot_add_brush(struct buf *out, const struct pilot_brush *brush);

/* Adds a decimal as commands take it: three places at most, no zeros at its end. */
void pilot_add_decimal(struct buf *line, double value);

/* Adds the page of keys for a window of so many columns: two entries on a line of at most 78, or
 * one; or each in two lines, to be broken by cells_wrap. */
void pilot_keys_page(struct buf *out, const struct pilot_setup *setup, unsigned columns);

#endif
