/* What an edit has done to the labels, in a line for the user. */
#ifndef COMMAND_VOLUMES_H
#define COMMAND_VOLUMES_H

#include <stdint.h>

#include "base/buf.h"
#include "session/session.h"

/* Adds "1234 voxels changed, label 3 brain: 1.24 l (+12 ml), label 2: 142 ml, 12.3 ms": the voxels
 * that have another label; the volumes of the labels that became larger or smaller, the largest first,
 * at most six of them and never that of label 0; and the time. For a command that has edited
 * the forest, between a session_count_labels before it and one after. */
void volumes_write(struct buf *out, const struct session *session, uint64_t took_ns);

#endif
