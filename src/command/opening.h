/* What `open` is told of a file besides its name. */
#ifndef COMMAND_OPENING_H
#define COMMAND_OPENING_H

#include "base/buf.h"
#include "command/act.h"
#include "engine/weight.h"
#include "image/volume.h"

#define OPEN_TYPES "int8|uint8|int16|uint16|int32|uint32|int64|uint64|float32|float64"

/* What the command `open` says; *name is the file's, within FILE. ERR_USAGE, with what was
 * expected. */
enum err opening_choice(struct volume_choice *choice, const char **name, const struct act *act);

/* `open` as its record has it, without the weight: a series by its number, whatever piece of its
 * description was given, since descriptions may be about the patient. */
void opening_write(struct buf *out, const struct call *open, uint32_t series);

/* The arc weights that a scene is opened with, "morph", or with what they take, "gauss:1.5": as
 * records have them, so that they mean the same once another weight is the default. ERR_USAGE. */
enum err opening_weight(struct weight_choice *weight, const char *text, struct fault *fault);
void opening_write_weight(struct buf *out, const struct weight_choice *weight);

#endif
