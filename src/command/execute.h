/* The one door is interpreter_execute: a command is carried out and recorded, or none of it. */
#ifndef COMMAND_EXECUTE_H
#define COMMAND_EXECUTE_H

#include "command/interpreter.h"

/* What a record says of the forest, after a command that edits it. */
void execute_add_digests(struct reply *reply, const struct session *session);

#endif
