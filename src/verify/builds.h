/*
 * Two builds of the program carry the commands of one journal out, at the same time, each into a
 * journal of its own in a temporary folder that goes away with struct builds.
 *
 * The commands may be a stranger's: how->begin confines and limits this process, which the builds
 * inherit. The memory and files of both are counted together as its own.
 */
#ifndef VERIFY_BUILDS_H
#define VERIFY_BUILDS_H

#include "base/process.h"
#include "verify/bisect.h"

struct side {
    struct buf program, folder, journal;
    struct buf words; /* why it ended early: "# ..." lines, or "" */
};

struct builds {
    struct buf folder;
    struct side side[2];       /* this program, and the other */
    struct process_end end[2]; /* with what they printed to standard error */
};

/* Both have ended, each with a journal of what it carried out; words name a command that failed,
 * or a signal. ERR_IO where one could not be started or left no journal, ERR_CANCELLED. To be
 * released, whatever is returned. */
enum err builds_run(struct builds *builds, const struct bisect_builds *how, struct fault *fault);
void builds_release(struct builds *builds);

#endif
