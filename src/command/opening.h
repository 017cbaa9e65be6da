/* What `open` is told of a file besides its name. */
#ifndef COMMAND_OPENING_H
#define COMMAND_OPENING_H

#include "base/buf.h"
#include "command/command.h"
#include "engine/weight.h"
#include "image/volume.h"

/* Its parameters, in the order of the table. */
enum opening {
    OPEN_FILE,
    OPEN_VOLUME,
    OPEN_CROP,
    OPEN_REDUCE,
    OPEN_SERIES,
    OPEN_DATA,
    OPEN_MISSING,
    OPEN_SKIP,
    OPEN_SIZE,
    OPEN_TYPE,
    OPEN_ENDIAN,
    OPEN_OFFSET,
    OPEN_SPACING,
    OPEN_HUGE,
    OPEN_PRIVATE,
    OPEN_STRAIGHTEN,
    OPEN_WEIGHT
};
#define OPEN_TYPES "int8|uint8|int16|uint16|int32|uint32|int64|uint64|float32|float64"

/* The choice that the values are; *name is the file's, within value[OPEN_FILE]. ERR_USAGE, with
 * what was expected. */
enum err opening_choice(struct volume_choice *choice, const char **name, const struct value *value,
                        struct fault *fault);

/* `open` with these values as its record has it, without the weight: a series by its number,
 * whatever piece of its description was given, since descriptions may be about the patient. */
void opening_write(struct buf *out, const struct command *open, const struct value *value,
                   uint32_t series);

/* The arc weights that a scene is opened with, "morph", or with what they take, "gauss:1.5": as
 * records have them, so that they mean the same once another weight is the default. ERR_USAGE. */
enum err opening_weight(struct weight_choice *weight, const char *text, struct fault *fault);
void opening_write_weight(struct buf *out, const struct weight_choice *weight);

#endif
