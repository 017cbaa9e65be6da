/*
 * How the pilot is set up: which keys do what, windows with a name, what the brush begins with, the
 * theme. What a user has said stands before the table of keys: an action that is given keys has no
 * others but those that no page shows (arrows, say), and a key is taken away from where it was.
 */
#ifndef TUI_PILOT_SETUP_H
#define TUI_PILOT_SETUP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/decimal.h"
#include "base/err.h"
#include "tui/theme.h"

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
    bool has_range; /* only voxels whose intensity is within: real values */
    struct decimal range[2];
};

struct pilot_setup {
    const struct theme *theme;
    struct pilot_brush brush; /* to begin with */
    struct setup_window window[SETUP_WINDOWS_MOST];
    size_t windows;
    char keys[SETUP_ROWS_MOST][SETUP_KEYS_BYTES]; /* by row; "" where the user has said none */
};

/* Without a word of the user: windows for CT. */
extern const struct pilot_setup pilot_setup_default;

/* A window under that name, in place of the one that has it. ERR_USAGE for a name that is too long,
 * ERR_LIMIT for one window too many. */
enum err setup_window(struct pilot_setup *setup, const char *name, int64_t centre, int64_t width,
                      struct fault *fault);

/* Gives an action of the table the keys, words of tui/pilot/chord.h. ERR_USAGE for what is no key,
 * or a key that another action was given. */
enum err setup_keys(struct pilot_setup *setup, size_t row, const char *words, struct fault *fault);

/* The row of that name; SIZE_MAX for none. */
size_t setup_row(const char *name);

struct pilot_row;
/* The keys that the user has given a row, or NULL. */
const char *setup_own(const struct pilot_setup *setup, const struct pilot_row *row);

/* Adds the keys that a row has, of those that the page shows, with blanks between; at most `most`.
 */
void setup_add_keys(struct buf *out, const struct pilot_setup *setup, const struct pilot_row *row,
                    size_t most);

/* Adds the first key of the row of that name; of one with a range, as s0-9, the key with this
 * character, as s0. For messages, which name the keys that the user has. */
void setup_add_first_key(struct buf *out, const struct pilot_setup *setup, const char *name);
void setup_add_key_to(struct buf *out, const struct pilot_setup *setup, const char *name, char c);

/* Whether a row has the keys of the table, all of them. */
bool setup_is_plain(const struct pilot_setup *setup, const struct pilot_row *row);

#endif
