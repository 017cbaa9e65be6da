/*
 * Two builds of the program carry the commands of one journal out, at the same time, each into a
 * journal of its own in a temporary folder that goes away with struct builds.
 *
 * The commands may be a stranger's: whoever wants the builds confined and limited does it to this
 * process in how->begin, which they inherit. What both take is counted together as its own.
 */
#ifndef VERIFY_BUILDS_H
#define VERIFY_BUILDS_H

#include <sys/types.h>

#include "verify/bisect.h"

struct side {
    pid_t process; /* 0 once it has ended */
    int status;
    struct buf program, folder, journal, errors;
    struct buf words; /* why it ended early: "# ..." lines, or "" */
};

struct builds {
    struct buf folder;
    struct side side[2]; /* this program, and the other */
};

/* Both have ended, each with a journal of what it carried out; words tell of a command that failed
 * and of a signal. ERR_IO where one could not be started or left no journal, ERR_CANCELLED. To be
 * released, whatever is returned. */
enum err builds_run(struct builds *builds, const struct bisect_builds *how, struct fault *fault);
void builds_release(struct builds *builds);

#endif
