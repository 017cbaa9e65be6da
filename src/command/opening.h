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
    OPEN_SPACING
};
#define OPEN_TYPES "uint8|int16|uint16|float32"

/* The choice that the values are; *name is the file's, within value[OPEN_FILE]. ERR_USAGE, with
 * what was expected. */
enum err opening_choice(struct volume_choice *choice, const char **name, const struct value *value,
                        struct fault *fault);

#endif
