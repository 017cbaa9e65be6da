/* SPDX-License-Identifier: MIT */
/* A command that is being carried out, and what all acts have in common. */
#ifndef COMMAND_ACT_H
#define COMMAND_ACT_H

#include "base/file.h"
#include "command/command.h"
#include "command/interpreter.h"
#include "command/table.h"

struct labels;
struct volume;

/* A command that is being carried out: by whom, with which values, and where its answer goes. */
struct act {
    struct interpreter *interp;
    struct session *session; /* the interpreter's */
    const struct call *call; /* NULL where no command is carried out */
    struct state *next;      /* a copy of the session's state, to be changed; act_go goes there */
    struct reply *reply;
    struct fault *fault;
};

/* What the command was given for the parameter of this name, which it has in the table. */
static inline const struct value *act_value(const struct act *act, const char *name)
{
    return call_value(act->call, name);
}

/* Whether one of these parameters, "a|b|c", is given. */
static inline bool act_has(const struct act *act, const char *names)
{
    return call_has(act->call, names);
}

/* The word that it is given as (struct value); NULL where it is not given, or no word. */
static inline const char *act_text(const struct act *act, const char *name)
{
    return act_value(act, name)->text;
}

/* The number; where it is not given, 0, or `usual`. */
static inline int64_t act_number(const struct act *act, const char *name)
{
    return act_value(act, name)->number;
}

static inline int64_t act_number_or(const struct act *act, const char *name, int64_t usual)
{
    return act_has(act, name) ? act_number(act, name) : usual;
}

/* The place X,Y,Z, or the first and last of a range. */
static inline const uint32_t *act_place(const struct act *act, const char *name)
{
    return act_value(act, name)->place;
}

/* Of the choices yes|no; "no" where it is not given. */
static inline bool act_is_yes(const struct act *act, const char *name)
{
    return act_has(act, name) && act_number(act, name) == 0;
}

/* ---- what they have in common ---- */

/* Has the session take on the state act->next. */
enum err act_go(const struct act *act);

/* `err`, with the name of a file before its words. */
enum err act_naming(const char *file, enum err err, struct fault *fault);

/* A name is a word of less than `room` bytes that no number, colour or option can be mistaken for;
 * ERR_USAGE for another. */
enum err act_check_name(const char *name, size_t room, struct fault *fault);

/* What `replace=yes|no` says. */
enum file_mode act_file_mode(const struct act *act);

/* A line of the answer: what was done with the file at `path`, as "wrote "; and the file among
 * those that the command has written, which is all that act_note_file does. */
void act_write_file_line(const char *doing, const char *path, struct reply *reply);
void act_note_file(const char *path, struct reply *reply);

/* ERR_USAGE where `report`, if it is given, ends in neither .json nor .csv. */
enum err act_check_report(const struct act *act);

/* Writes the text to the file that `report` names, unless replay writes none, and says so. */
enum err act_write_report(const struct act *act, const struct buf *text);

/* The labels that a command saves or counts, once the edits that wait have been run: with
 * `finished=yes`, the finished ones, whose digest is added to the words of the record. Where
 * somebody sits at a prompt and does not give `finished=`, it is as pictures show them, and the
 * record says which. In a session that skims they are of no meaning. */
enum err act_take_labels(const struct act *act, struct labels *labels);

/* Adds a line for each label that the finished labels delete, halve or break
 * (report/label_loss.h). `only_new`: one short line, of the labels that the call before has not
 * named. ERR_MEMORY, ERR_CANCELLED. */
enum err act_write_losses(struct interpreter *interp, const struct labels *labels, bool only_new,
                          struct watch *watch, struct buf *out, struct fault *fault);

/* The same for a picture: where `finished=` is not given, as `finished on|off` has it. */
enum err act_take_shown(const struct act *act, struct labels *labels);

/* Adds "KEY=DIGEST" to the words of the record; and that of the weights. */
void act_add_digest(const struct act *act, const char *key, uint64_t digest);
void act_add_weights(const struct act *act);

/* Where a map has to be, by `resample`, and which volume of its file is meant. */
struct map_place act_map_place(const struct act *act);

/* Reads the map FILE, in the place of the scene or, with `resample=yes`, wherever it lies. The
 * caller releases it, also on error. */
enum err act_read_map(const struct act *act, struct volume *map);

#endif
