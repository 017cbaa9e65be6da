/*
 * What keys mean to the pilot: a state, a key and the facts in, the line of a command out. Pure.
 *
 * All keys stand in one table (pilot_keys.c), a row for each thing that they do: in which modes it
 * is done, by what line or function, and the words for it on the page of keys and below the picture.
 * The page, which `?` shows, is also the card in tui/README.md.
 */
#ifndef TUI_PILOT_PILOT_KEYS_H
#define TUI_PILOT_PILOT_KEYS_H

#include "tui/keys.h"
#include "tui/pilot/pilot.h"

enum pilot_mode {
    PILOT_MOVING,     /* keys move the cross-hair, plant, turn .. */
    PILOT_CONFIRMING, /* the tree under the cross-hair is shown: x or Enter eliminates it */
    PILOT_WINDOWING,  /* arrows change the window */
    PILOT_PICKING,    /* arrows move a pixel in the rendition */
    PILOT_HELPING,    /* the page of keys is shown */
};

/* What the loop is to do beside carrying out the line. */
enum pilot_deed { PILOT_NOTHING, PILOT_PROMPT, PILOT_REDRAW, PILOT_SUSPEND, PILOT_LEAVE };

struct pilot_state {
    enum pilot_mode mode;
    enum pilot_pane pane; /* of the three slices: arrows move in it */
    unsigned label;       /* that s plants */
    unsigned radius;      /* of the brush */
    bool pen_is_down, has_mark;
    uint32_t mark[3];
    uint32_t count; /* typed so far; 0 for none */
    bool counts;    /* digits belong to it */
    uint32_t pixel[2];
    bool drags;     /* the mouse draws */
    bool is_silent; /* what the last line does is seen below the picture anyway */
};

void pilot_state_init(struct pilot_state *state);

/* Adds the line of the command that the key stands for to `line`, if any; several, parted by line
 * feeds, are carried out one after the other until one fails. `message` gets a word for the user
 * where there is something to say. */
enum pilot_deed pilot_press(struct pilot_state *state, const struct key_event *event,
                            const struct pilot_host *host, const struct pilot_facts *facts,
                            struct buf *line, struct buf *message);

/* The same for a mouse report, which lies in the picture at this pixel. */
void pilot_click(struct pilot_state *state, const struct key_event *event, uint32_t column,
                 uint32_t row, const struct pilot_host *host, const struct pilot_facts *facts,
                 struct buf *line, struct buf *message);

/* Adds what the keys do in the present mode, in a line that fits 80 columns. */
void pilot_keys_hint(const struct pilot_state *state, const struct pilot_facts *facts,
                     struct buf *out);

/* Adds the page of keys, as lines of at most 78 columns. */
void pilot_keys_page(struct buf *out);

#endif
