/* SPDX-License-Identifier: MIT */
/* What a killed process had started: programs that end because it did, a moment after it. A test
 * that kills, and then looks at the files or removes the folder, waits for them first. */
#ifndef TESTS_ORPHANS_H
#define TESTS_ORPHANS_H

#include <errno.h>
#include <stdbool.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* From now on they become children of this process when their parent ends. */
static inline void adopt_orphans(void)
{
    prctl(PR_SET_CHILD_SUBREAPER, 1);
}

/* Waits a minute at most until no child is left; false where one is. */
static inline bool await_orphans(void)
{
    for (int i = 0; i < 60000; i++) {
        const pid_t ended = waitpid(-1, NULL, WNOHANG);
        if (ended < 0 && errno == ECHILD)
            return true;
        if (ended == 0)
            usleep(1000);
    }
    return false;
}

#endif
