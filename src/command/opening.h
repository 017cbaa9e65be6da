/* What `open` is told of a file besides its name. */
#ifndef COMMAND_OPENING_H
#define COMMAND_OPENING_H

#include "command/command.h"
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
    OPEN_SIZE,
    OPEN_TYPE,
    OPEN_ENDIAN,
    OPEN_OFFSET,
    OPEN_SPACING,
    OPEN_HUGE
};
#define OPEN_TYPES "int8|uint8|int16|uint16|int32|uint32|int64|uint64|float32|float64"

/* The choice that the values are; *name is the file's, within value[OPEN_FILE]. ERR_USAGE, with
 * what was expected. */
enum err opening_choice(struct volume_choice *choice, const char **name, const struct value *value,
                        struct fault *fault);

#endif
