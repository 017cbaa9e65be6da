/* SPDX-License-Identifier: MIT */
/*
 * Settings: commands that only set members of the state, one row each.
 *
 * The table defines the commands themselves with their parameters and help (command/command.h), how
 * they are carried out (act_set), the initial state, equality of states and the parts to recompute
 * where they differ, and the words of `info` and of notes on pictures. To add a setting, add a
 * member, its row, and the code that uses it.
 */
#ifndef SESSION_SETTING_H
#define SESSION_SETTING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "session/state.h"

/*
 * Commands as rows: name, parameters and help.
 *
 * Other commands are in the table of commands (command/table.c), settings in setting_table, where
 * each parameter also names the member that it sets.
 */

struct act;

/* Type of a parameter, in addition to the words in its `choices`. */
enum value_type {
    VALUE_END,      /* no parameter: the end of the list */
    VALUE_POSITION, /* X,Y,Z as indices, or X,Y,Zmm in the world */
    VALUE_LABEL,    /* a label's number, from `least` on, or name */
    VALUE_LABELS,   /* labels, "0,3-7,NAME" */
    VALUE_NUMBER,   /* an integer, least..most */
    VALUE_LINE,     /* further corners of a line from the first parameter; keyed, may be repeated */
    VALUE_RADIUS,   /* voxels, least..most; or millimetres, "2.5mm", of 1 nm to 1 m */
    VALUE_RANGE,    /* "A-B", or "A" for "A-A", least..most */
    VALUE_LIST,     /* ranges with commas between them, "1-90,105", least..most */
    VALUE_REAL,     /* a real value: 40, -0.5, 1.5e-3 (base/scan.h) */
    VALUE_INTERVAL, /* "LOW..HIGH", two of them */
    VALUE_DECIMAL,  /* thousandths, least..most: 12.5 is 12500 */
    VALUE_CHOICE,   /* choices only */
    VALUE_PARTS,    /* several of its choices in a row, a bit each; the last two choices are
                       all and none */
    VALUE_COLOUR,   /* #rrggbb */
    VALUE_FILE,     /* a path */
    VALUE_COMMAND,  /* the name of a command */
    VALUE_GOLDEN,   /* the name of a golden image */
    VALUE_POINT,    /* the number of a record, or the name of a branch */
    VALUE_WORD,     /* any word */
};

/* Representation of a value in a member of the state. */
enum held_as {
    HELD_AS_NUMBER,     /* a number; for choices the index from 0; for parts the bits */
    HELD_AS_SWITCH,     /* 1 for the first of two choices, 0 for the second */
    HELD_AS_COUNT,      /* the number that the choice spells */
    HELD_AS_BACKGROUND, /* a background (render/palette.h) */
};

/* Words of the answer and of the record after a setting (act_set). */
enum setting_says {
    SAYS_NOTHING,
    SAYS_WEIGHTS, /* record: the digest of the weights */
    SAYS_SLICES,  /* contents of slices */
    SAYS_WAITING, /* pending edits */
    SAYS_FINISH,  /* contents of pictures */
};

/* The member that a parameter of a setting sets; zeros for other commands. */
struct setting_member {
    size_t at, bytes; /* an integer in struct state (session/state.h), */
    bool is_signed;
    enum held_as as;
    int64_t usual;          /* initial value, as stored */
    bool stays;             /* unchanged if not given; otherwise reset to `usual` */
    unsigned made;          /* MADE_... parts that depend on it */
    enum setting_says says; /* for the setting, at its first parameter */
};

struct parameter {
    const char *name;
    enum value_type type;
    bool optional, keyed;
    bool is_read;    /* FILE: an existing file, which the command reads */
    bool is_scene;   /* the scene */
    bool is_channel; /* the file of a further channel */
    bool is_kept;    /* WORD: numbers, a digest or a name that other commands use, which `log
                      --anonymise` keeps; any other word may be personal */
    bool is_code;    /* WORD: a code (label_code_fits), kept without its meaning */
    bool paired;     /* given if and only if the value before it is not one of the choices there */
    bool makes;      /* LABEL: no label may have the number yet */
    bool added;      /* keyed; added to the record if the line lacks it */
    int64_t least, most;
    const char *choices; /* words allowed instead, "a|b|c", or NULL */
    const char *form;    /* form in usage; NULL for that of its type */
    struct setting_member sets;
};

/* A set of labels. */
struct label_set {
    uint64_t word[4];
};
static inline bool label_set_has(const struct label_set *set, uint8_t label)
{
    return set->word[label >> 6] >> (label & 63) & 1;
}
static inline void label_set_add(struct label_set *set, uint8_t label)
{
    set->word[label >> 6] |= UINT64_C(1) << (label & 63);
}

enum { PARAMETERS_MOST = 18 };

enum command_flag {
    COMMAND_RECORDED = 1, /* is recorded in the journal */
    COMMAND_NEEDS_SCENE = 2,
    COMMAND_EDITS = 4,    /* changes the result of `run`: its digests are recorded */
    COMMAND_SKETCHED = 8, /* can be carried out as a preview */
    COMMAND_PLANTS = 16,  /* seeds or eliminators, which may change far more voxels than they
                             name */
    COMMAND_CARRIED = 64, /* is carried to other scenes with a procedure (iftty apply) */
    COMMAND_ANSWERS = 32, /* shows, writes or answers from labels: pending edits are applied
                             first */
};

/* Subjects of commands. The table lists commands by group. */
enum command_group {
    GROUP_SCENE,
    GROUP_WEIGHT,
    GROUP_SEEDS,
    GROUP_VIEW,
    GROUP_LOOK,
    GROUP_CUTS,
    GROUP_RENDITION,
    GROUP_SLICES,
    GROUP_KEPT,
    GROUP_QUESTIONS,
    GROUPS,
};

struct command {
    const char *name;
    const char *also;     /* synonyms of the name, "exit|bye", or NULL */
    const char *comes_to; /* the command in its record; if it is the same, only if its first
                             value is one of the choices; or NULL */
    enum err (*act)(const struct act *act); /* NULL for a setting */
    enum command_group group;
    unsigned flags;                                  /* enum command_flag */
    struct parameter parameter[PARAMETERS_MOST + 1]; /* the last one is VALUE_END */
    const char *summary;                             /* one line */
    const char *detail;  /* further paragraphs of help, separated by line feeds, or NULL */
    const char *example; /* a line that can be parsed */
};

/* In the order of help; the last one has no name. */
extern const struct command setting_table[];

/* Read or write a member of the state, as stored. */
int64_t setting_get(const struct state *state, const struct setting_member *member);
void setting_put(struct state *state, const struct setting_member *member, int64_t number);

/* Initial state. */
struct state state_default(void);

/* True if all members are equal: each is a setting, or a row of setting.c. Maps are equal if
 * they are identical. */
bool kept_equals(const struct kept *a, const struct kept *b);

/* MADE_... parts that depend on different members. */
unsigned state_difference(const struct state *a, const struct state *b);

/* Write a setting as a command line: "shade surface ao=30". Optional parameters with their
 * initial values are left out. */
void setting_write(struct buf *out, const struct command *setting, const struct state *state);

/* The same for all settings of a group, separated by commas. */
void settings_write(struct buf *out, enum command_group group, const struct state *state);

/* Write the words of these bits of VALUE_PARTS. */
void setting_write_parts(struct buf *out, const char *choices, int64_t bits);

#endif
