/* The one door: a command is carried out, recorded, and stands, or none of it (interpreter_execute).
 */
#ifndef COMMAND_EXECUTE_H
#define COMMAND_EXECUTE_H

#include "command/interpreter.h"

/* What a record says of the forest, after a command that edits it. */
void execute_add_digests(struct reply *reply, const struct session *session);

#endif
