/*
 * One key pressed: what the functions of the table of keys are given, and the table's rows.
 *
 * Those that do something are in pilot_acts.c and pilot_hints.c, the table in pilot_table.c, and
 * what finds the row for a key in pilot_keys.c.
 */
#ifndef TUI_PILOT_PILOT_PRESS_H
#define TUI_PILOT_PILOT_PRESS_H

#include "tui/pilot/pilot_keys.h"

/* A key, and what it is pressed upon. */
struct press {
    struct pilot_state *state;
    const struct key_event *event;
    const struct pilot_host *host;
    const struct pilot_facts *facts;
    struct buf *line, *message;
    int by; /* of the row */
    enum pilot_deed deed;
};

#define PILOT_IN(mode) (1u << (mode))

enum pilot_flag {
    PILOT_COUNTS = 1,      /* the row takes a count */
    PILOT_CHANGES = 2,     /* `.` repeats it */
    PILOT_STAYS = 4,       /* the mode does not change */
    PILOT_IS_SILENT = 8,   /* what the line does is seen below the picture anyway */
    PILOT_TELLS_ALL = 16,  /* each line of its answer is of use */
    PILOT_ONLY_MOVES = 32, /* it asks nothing of the segmentation, and changes nothing of it */
    PILOT_OUTLINES = 64    /* it plants what the corners enclose */
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
                         where the row has no keys, else it is not there */
    const char
        *hint; /* after its key, below the picture as long as one of its modes lasts; or NULL */
};

extern const struct pilot_row pilot_table[];
extern const size_t pilot_rows;

/* `by` of pilot_move: which way on the screen, and whether far. */
enum { PILOT_LEFT, PILOT_DOWN, PILOT_UP, PILOT_RIGHT, PILOT_WAYS, PILOT_FAR = PILOT_WAYS };

/* Goes to a place; with the pen down, a stroke leads there. pilot_cross draws none; whether it
 * moves. */
void pilot_go_to(struct pilot_state *state, const struct pilot_facts *facts,
                 const uint32_t place[3], struct buf *line);
bool pilot_cross(struct pilot_state *state, const struct pilot_facts *facts,
                 const uint32_t place[3], struct buf *line);
/* Magnifies slices by so many steps of a quarter or so, or less, around the cross-hair. False where
 * they are as large, or as small, as can be. */
bool pilot_magnify_by(const struct pilot_facts *facts, int64_t steps, struct buf *line);
/* Sets the corners of the last box or polygon once more, beside the cross-hair. False, with a
 * message, where that cannot be. */
bool pilot_move_shape(struct press *p);
/* Takes LOW..HIGH; false where `at` begins with something else. */
bool pilot_scan_range(const char **at, struct decimal range[2]);
/* Goes there, draws nothing, and can be taken back. */
void pilot_jump(struct press *p, const uint32_t place[3]);
/* The voxel that is meant: under the cross-hair, or the one that the pixel of the rendition shows,
 * and then the cross-hair goes there. False, with a message, where that shows none. */
bool pilot_take_voxel(struct press *p, uint32_t place[3]);
/* " 90,108,90" after some words; the command of a seed there, without its line feed. */
void pilot_add_place(struct buf *line, const char *before, const uint32_t place[3]);
void pilot_begin_seed(struct buf *line, const uint32_t place[3], const struct pilot_brush *brush);
/* The stroke that the pen has drawn, as the lines of its command. */
void pilot_add_stroke(struct pilot_state *state, const struct pilot_facts *facts, struct buf *line);
void pilot_zoom(uint32_t now, bool nearer, struct buf *line);

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
void pilot_plant_polygon(struct press *p);
void pilot_plant_shell(struct press *p); /* 1: of a box; 0: of a ball */
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
void pilot_begin_picking(struct press *p);
void pilot_end_picking(struct press *p); /* 1: at the voxel; 0: where the cross-hair is */

#endif
