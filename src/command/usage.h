/* How parameters are written in usage, help and hints. */
#ifndef COMMAND_USAGE_H
#define COMMAND_USAGE_H

#include "command/command.h"

/* What stands for a value: "X,Y,Z", "on|off", "0..32". */
void usage_form(struct buf *out, const struct parameter *p);

/* The same with its key and brackets: "LABEL", "[radius=0..32]". */
void usage_parameter(struct buf *out, const struct parameter *p);

#endif
