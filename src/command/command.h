/* SPDX-License-Identifier: MIT */
/*
 * Commands: one table, from which parser, canonical form, help, completion, journal policy, the
 * README's section and the tests of every example are read.
 *
 * A command is a line of words separated by blanks. A word with blanks in it is written between
 * double quotes, in which \" and \\ mean " and \, or between single quotes, in which no character
 * is special. Parameters come in the order of the table; a parameter marked `keyed` is written
 * name=value, where the value may be in quotes, anywhere after the command's name.
 * Parsing a line and writing it in canonical form yields the same command, in the same canonical
 * form.
 */
#ifndef COMMAND_COMMAND_H
#define COMMAND_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/choice.h"
#include "base/scan.h"
#include "base/err.h"
#include "base/polyline.h"
#include "command/near.h"
#include "session/setting.h"

struct interpreter;
struct session;

/* The value of a parameter. */
struct value {
    bool given;
    int64_t number; /* LABEL: its index (session/map.h); choice: its index; DECIMAL: thousandths;
                       COLOUR: 0xrrggbb; RADIUS: voxels or nanometres; PARTS: bits; INTERVAL: its
                       channel, from 0, or -1 for LOW alone; -1: a plain word */
    struct decimal real[2]; /* REAL: the first; INTERVAL: both ends */
    bool in_mm;             /* RADIUS: it is in millimetres */
    const char *text;       /* the word, if it is a choice or the type is a word */
    uint32_t place[3];      /* POSITION, in the scene; RANGE: first and last; LABEL: its number */
    struct label_set set;   /* LABELS */
    const struct polyline
        *line; /* LINE: all of it, with its first corner; not given if it is a single place */
};

/* A command with its values. */
struct call {
    const struct command *command;       /* NULL for an empty line or a comment */
    struct value value[PARAMETERS_MOST]; /* in the order of the table; look them up by name */
    const struct kept *kept;             /* the numbers of its labels */
    struct buf store;                    /* owns the words that values point to */
    struct buf settled;                  /* the same for a file name rewritten for the record */
    struct polyline line;                /* the same for the corners of a line */
};

/* The headings of help; and the commands, from 0: those of the table, then the settings. command_at
 * is valid below command_count(). */
extern const char *const command_group_name[GROUPS];
const struct command *command_at(unsigned number);
unsigned command_count(void);

const struct command *command_find(const char *name);

/* The arguments of weights, by enum weight_argument. */
extern const struct parameter weight_parameter[];

/* Try the names of all commands and their synonyms. */
void command_try_names(struct near *near);

/* Parse a line by the table. ERR_USAGE, also for a line longer than a record; ERR_INPUT for a place
 * outside the scene; ERR_MEMORY. Positions and labels are looked up in `session`; without a scene,
 * positions are rejected. An error
 * contains the expected form, and fault->at is the position of the wrong word, or after the end for
 * a missing one. The caller releases `call`. */
enum err command_parse(struct call *call, const char *line, const struct session *session,
                       struct fault *fault);

/* The same with the names of labels taken from `kept`. */
enum err command_parse_by(struct call *call, const char *line, const struct session *session,
                          const struct kept *kept, struct fault *fault);
void call_release(struct call *call);

/* Return the value of the parameter of this name, which the command has; or replace it by a number,
 * or a choice with its word. */
const struct value *call_value(const struct call *call, const char *name);
void call_set(struct call *call, const char *name, int64_t number, const char *word);

/* Return the name of the first of these parameters, "a|b|c", which the command has, that is given;
 * NULL if none is. */
const char *call_given(const struct call *call, const char *names);

static inline bool call_has(const struct call *call, const char *names)
{
    return call_given(call, names) != NULL;
}

/* Return the labels that `over` and `keep` of a command that has them let a gesture change. */
struct label_set call_takes(const struct call *call);

/* Set fault->at of an error of a parsed command: the position of the word of the line, a file name
 * say, that the words of the error contain. */
void command_point_at(const struct call *call, const char *line, struct fault *fault);

/* Add the word at *cursor to `out` without its quotes, ended by NUL, and advance the cursor. False
 * for an unterminated quote. */
bool command_take_word(const char **cursor, struct buf *out);

/* Add a word, in quotes if it needs them. */
bool command_needs_quotes(const char *word);
void command_write_word(struct buf *out, const char *word);

/* Add the canonical form of a call. */
void command_write(struct buf *out, const struct call *call);

/* True if the line opens a scene or reads a channel; the name of its file. *is_part: not a whole
 * file, or a channel that may be on another grid than the scene's. */
bool command_opens(struct buf *name, bool *is_scene, bool *is_part, const char *line);

/* True if both lines are the same command. The file that it reads may be seen from different
 * folders. */
bool command_is_same(const char *a, const char *b);

/* Add the usage of a command: "seed X,Y,Z LABEL [radius=0..32]". */
void command_usage(struct buf *out, const struct command *command);

/* Add the text of `help all` (command NULL) or `help NAME`, in lines of at most 76 columns. */
void command_help(struct buf *out, const struct command *command);

/* Return the text of `help NAME` if it is not of a command, or NULL; of `help` if NAME is NULL. */
const char *command_page(const char *name);

/* Return the help of a command about a word, a choice or a key: the rest of the line of its detail
 * that begins "WORD: " or "WORD, ..: ". Length 0 if not found. */
struct choice command_note(const struct command *command, const char *word, size_t length);

/* Return the number of the parameter that a word fills, among those not given yet: a keyed one by
 * its name, and *word advances to its value; else the next positional one; -1 for none. */
int command_parameter_for(const struct command *command, const struct value *value,
                          const char **word);

/* ---- a command that is being typed ---- */

/* Add the possible words at the end of line[0..cursor), as they are typed, each ended by a line
 * feed, with a tab and an explanation before it if there is one; *word_start is their first byte. A
 * folder ends in "/", so that its files can follow. Files are those on the disk now; names that a
 * command cannot contain are left out. */
void command_complete(struct buf *out, size_t *word_start, const char *line, size_t cursor,
                      const struct interpreter *interp);

/* Add the possible continuation of line[0..length) as usage: "X,Y,Z LABEL [radius=0..32]" after the
 * name of a command; nothing if it is unknown. */
void command_hint(struct buf *out, const char *line, size_t length);

#endif
