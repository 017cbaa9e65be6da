/* SPDX-License-Identifier: MIT */
/*
 * Settings: commands that do no more than set members of the state, one row each.
 *
 * From the table come the commands themselves, with their parameters and help (command/command.h),
 * what sets them (act_set), what a session begins with, whether two states are equal and
 * what follows where they are not, and the words of `info` and of notes on pictures. So one setting
 * more is a member, its row, and the code that heeds it.
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
 * Commands as rows: what one is called, which parameters it takes, and what help says of it.
 *
 * Those that do something are in the table of commands (command/table.c). Those that do no more
 * than set something are in that of settings (session/setting.h), whose parameters also say what
 * they set.
 */

struct act;

/* What a parameter takes, besides the words in its `choices`. */
enum value_type {
    VALUE_END,      /* no parameter: the end of the list */
    VALUE_POSITION, /* X,Y,Z as indices, or X,Y,Zmm in the world */
    VALUE_LABEL,    /* a label's number or name; least..255 */
    VALUE_NUMBER,   /* an integer, least..most */
    VALUE_LINE,     /* places that a line goes on to from the first parameter's; keyed, and given as
                       often as there are */
    VALUE_RADIUS,   /* voxels, least..most; or millimetres, "2.5mm", of 1 nm to 1 m */
    VALUE_RANGE,    /* "A-B", or "A" for "A-A", least..most */
    VALUE_LIST,     /* ranges with commas between them, "1-90,105", least..most */
    VALUE_REAL,     /* a real value, as in 40, -0.5 and 1.5e-3 (base/decimal.h) */
    VALUE_INTERVAL, /* "LOW..HIGH", two of them */
    VALUE_DECIMAL,  /* thousandths, least..most: 12.5 is 12500 */
    VALUE_CHOICE,   /* nothing else */
    VALUE_PARTS,    /* several of its choices, one after the other: a bit each; the last two choices
                       are all of them, and none */
    VALUE_COLOUR,   /* #rrggbb */
    VALUE_FILE,     /* a path */
    VALUE_COMMAND,  /* the name of a command */
    VALUE_GOLDEN,   /* the name of a golden image */
    VALUE_POINT,    /* the number of a record, or the name of a branch */
    VALUE_WORD,     /* any word */
};

/* What a member of the state holds of a value. */
enum held_as {
    HELD_AS_NUMBER,     /* the number; of choices, which, from 0; of parts, their bits */
    HELD_AS_SWITCH,     /* 1 for the first of two choices, 0 for the second */
    HELD_AS_COUNT,      /* the number that the choice is */
    HELD_AS_BACKGROUND, /* a background (render/palette.h) */
};

/* What the answer says, and the record, once a setting was set (act_set). */
enum setting_says {
    SAYS_NOTHING,
    SAYS_WEIGHTS, /* the record: the digest of the weights */
    SAYS_SLICES,  /* what slices show */
    SAYS_WAITING, /* which edits wait still */
    SAYS_FINISH,  /* what pictures show */
};

/* What a parameter of a setting sets; zeros for others. */
struct setting_member {
    size_t at, bytes; /* in struct state (session/state.h): an integer, */
    bool is_signed;
    enum held_as as;
    int64_t usual;          /* as which a session begins, as it is held */
    bool stays;             /* where it is not given; else it is as usual again */
    unsigned made;          /* MADE_... of what follows from it */
    enum setting_says says; /* of the setting, at its first parameter */
};

struct parameter {
    const char *name;
    enum value_type type;
    bool optional, keyed;
    bool is_read;  /* FILE: one that is there, and that the command reads */
    bool is_scene; /* the scene */
    bool is_kept;  /* WORD: numbers, a digest or a name that other commands use, which `log
                      --anonymise` keeps; any other word may be a person's */
    bool paired;   /* given where the one before it is none of its choices, and only there */
    bool added;    /* keyed; the record has it where the line had not */
    int64_t least, most;
    const char *choices; /* words that it may be instead, "a|b|c", or NULL */
    const char *form;    /* what stands for it in usage; NULL for what its type has */
    struct setting_member sets;
};

enum { PARAMETERS_MOST = 18 };

enum command_flag {
    COMMAND_RECORDED = 1, /* goes into the journal */
    COMMAND_NEEDS_SCENE = 2,
    COMMAND_EDITS = 4,    /* changes what `run` computes: its digests are recorded */
    COMMAND_SKETCHED = 8, /* can be carried out to be seen and no more */
    COMMAND_PLANTS = 16,  /* seeds or eliminators, which may change far more than they say */
    COMMAND_CARRIED = 64, /* is carried to other scenes with a procedure (iftty apply) */
    COMMAND_ANSWERS = 32, /* shows, writes or answers from labels: what waits is applied first */
};

/* What commands are about; those of a group stand together. */
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
    const char *also;     /* "exit|bye": other words for it, which lead to it; or NULL */
    const char *comes_to; /* the command that its record is; where that is itself, only if its first
                             value is one of the choices; or NULL */
    enum err (*act)(const struct act *act); /* NULL for a setting */
    enum command_group group;
    unsigned flags;                                  /* enum command_flag */
    struct parameter parameter[PARAMETERS_MOST + 1]; /* the last one is VALUE_END */
    const char *summary;                             /* one line */
    const char *detail;  /* further paragraphs of help, between line feeds, or NULL */
    const char *example; /* a line that parses */
};

/* In the order of help; the last one has no name. */
extern const struct command setting_table[];

/* A member of the state, as it is held. */
int64_t setting_get(const struct state *state, const struct setting_member *member);
void setting_put(struct state *state, const struct setting_member *member, int64_t number);

/* As a session begins. */
struct state state_default(void);

/* Two are the same where every member is: each is a setting, or a row of setting.c. Maps are, where
 * they are one and the same. */
bool kept_equals(const struct kept *a, const struct kept *b);

/* MADE_... of what follows from the members in which two differ. */
unsigned state_difference(const struct state *a, const struct state *b);

/* A setting as it would be typed to be what it is now: "shade surface ao=30". What may be left out
 * is, where it is as usual. */
void setting_write(struct buf *out, const struct command *setting, const struct state *state);

/* The words of these bits of VALUE_PARTS. */
void setting_write_parts(struct buf *out, const char *choices, int64_t bits);

/* The same of all of a group, with commas between. */
void settings_write(struct buf *out, enum command_group group, const struct state *state);

#endif
