/* What an edit has done to the labels, in a line for the user. */
#ifndef COMMAND_VOLUMES_H
#define COMMAND_VOLUMES_H

#include <stdint.h>

#include "base/buf.h"
#include "session/session.h"

/* Adds "1234 voxels changed, 3 brain 1.24 l, 2 cerebellum 142 ml, 12.3 ms": voxels that the forest
 * looked at anew; the volumes of labels that have become larger or smaller, the largest first, of
 * some at most, label 0 apart; and the time. For a command that has edited the forest, between
 * session_count_labels before and after it. */
void volumes_tell(struct buf *out, const struct session *session, uint64_t took_ns);

#endif
