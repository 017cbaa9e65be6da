/* SPDX-License-Identifier: MIT */
/*
 * Commands: one table, from which parser, canonical form, help, completion, journal policy, the
 * README's section and the tests of every example are read.
 *
 * A command is a line of words separated by blanks; a word with blanks in it is written between
 * double quotes, in which \" and \\ stand for " and \, or between single quotes, in which nothing
 * stands for anything else (MEANING_QUOTES). Parameters come in the order of the table; those
 * marked `keyed` are written name=value, where the value may stand between double quotes, anywhere
 * after the command's name. A line parsed and written again in canonical form is the same command,
 * and canonical already.
 */
#ifndef COMMAND_COMMAND_H
#define COMMAND_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/scan.h"
#include "base/err.h"
#include "base/polyline.h"
#include "command/near.h"
#include "session/setting.h"

struct interpreter;
struct kept;
struct session;

/* What a parameter was given as. */
struct value {
    bool given;
    int64_t number;         /* of one of the choices: which; LABEL, NUMBER; DECIMAL: thousandths;
                          COLOUR: 0xrrggbb; RADIUS: voxels, or nanometres;
                          -1 for what is a word alone */
    struct decimal real[2]; /* REAL: the first; INTERVAL: both ends */
    bool in_mm;             /* RADIUS: it was given in millimetres */
    const char *text;       /* the word, where it was one of the choices, or its type is a word's */
    uint32_t place[3];      /* POSITION, in the scene; RANGE: first and last */
    const struct polyline *line; /* LINE: all of it, with where it begins; not given where it stays
                                    there */
};

/* A command with what it is given. */
struct call {
    const struct command *command;       /* NULL for an empty line or a comment */
    struct value value[PARAMETERS_MOST]; /* in the order of the command's parameters; others find
                                            them by their names */
    const char *quotes;                  /* that words may stand between */
    struct buf store;                    /* the words that values point into */
    struct buf settled;                  /* the same, of a file as the record has it */
    struct polyline line;                /* the same for the corners of a line */
};

/* The headings of help, and the commands, from 0: those of the table, then those of settings. NULL
 * after the last one. */
extern const char *const command_group_name[GROUPS];
const struct command *command_at(unsigned number);
unsigned command_count(void);

const struct command *command_find(const char *name);

/* Tries the names of all, and what else they are called. */
void command_try_names(struct near *near);

/* Parses a line against the table: ERR_USAGE for one longer than a journal holds. Positions and
 * labels are looked up in `session` (which may have no scene: then positions are refused, and label
 * names too). The words of an error say what was expected, and fault->at, where the word begins
 * that is wrong; for one that is missing, a place after the end. The caller releases `call`. */
enum err command_parse(struct call *call, const char *line, const struct session *session,
                       struct fault *fault);

/* The same with the names that labels have in `kept`, whatever they are called now. */
enum err command_parse_by(struct call *call, const char *line, const struct session *session,
                          const struct kept *kept, struct fault *fault);
void call_release(struct call *call);

/* The value of the parameter of this name, which the command has; and another in place of what was
 * given for it: a number, or a choice with its word. */
const struct value *call_value(const struct call *call, const char *name);
void call_set(struct call *call, const char *name, int64_t number, const char *word);

/* Whether one of these parameters, "a|b|c", which the command has, is given. */
bool call_has(const struct call *call, const char *names);

/* An error of a command that was parsed: where its words name a word of the line, a file say,
 * fault->at says where that begins. */
void command_point_at(const struct call *call, const char *line, struct fault *fault);

/* Adds the word at *cursor to `out`, ended by NUL, without its quotes, which are one of `quotes`,
 * and moves on past it. False for a quote that does not end. */
bool command_take_word(const char **cursor, struct buf *out, const char *quotes);
#define COMMAND_QUOTES "\"'"

/* One word as a command holds it: between quotes where it needs them. */
void command_write_word(struct buf *out, const char *word);

/* The canonical form of a call. */
void command_write(struct buf *out, const struct call *call);

/* Whether the line opens a scene, and the name of that. */
bool command_opens(struct buf *name, const char *line);

/* Whether both lines are the same command, wherever the file that it reads is seen from. */
bool command_is_same(const char *a, const char *b);

/* What stands for a value: "X,Y,Z", "on|off", "0..32". */
void usage_form(struct buf *out, const struct parameter *p);

/* Those not given yet (`value` NULL: all), each after a blank, with keys and brackets: " LABEL
 * [radius=0..32]"; those in order come first. */
void usage_rest(struct buf *out, const struct parameter *p, const struct value *value);

/* "seed X,Y,Z LABEL [radius=0..32]": how a command is used. */
void command_usage(struct buf *out, const struct command *command);

/* The text of `help` (command NULL) or `help NAME`, in lines of at most 80 columns. */
void command_help(struct buf *out, const struct command *command);

/* What the help of a command says of a word, a choice or a key: the rest of the line of its detail
 * that begins "WORD: " or "WORD, ..: ". Of length 0 where there is none; no NUL ends it. */
const char *command_note(const struct command *command, const char *word, size_t word_length,
                         size_t *length);

/* The parameter that a word fills, of those whose value is not given: a keyed one by its name, in
 * which case *word moves on to its value, else the next in order; -1 for none. */
int command_parameter_for(const struct command *command, const struct value *value,
                          const char **word);

/* ---- a command that is being typed ---- */

/* Words that may stand at the end of line[0..cursor), as they are to be typed, each ended by a line
 * feed, with a tab and what it means before that where there is something to say, and where they
 * begin. A folder ends in /, so that its files can follow. Files are those on
 * the disk now; names that a command cannot hold are left out. */
void command_complete(struct buf *out, size_t *word_start, const char *line, size_t cursor,
                      const struct interpreter *interp);

/* What may follow line[0..length), as usage has it: "X,Y,Z LABEL [radius=0..32]" after the name
 * of a command; nothing where that is not known. */
void command_hint(struct buf *out, const char *line, size_t length);

#endif
