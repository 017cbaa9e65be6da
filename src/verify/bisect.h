/* SPDX-License-Identifier: MIT */
/*
 * The first record in which two journals, or two builds of the program, differ.
 *
 * Builds are compared by the journals that they write: both carry out the commands once, at the
 * same time, each into a folder of its own that is removed, and stop at the first that fails. A
 * search that replays up to one record after another would take as long again for every step; and
 * this way the other build may be one that cannot verify, or has never seen such results.
 */
#ifndef VERIFY_BISECT_H
#define VERIFY_BISECT_H

#include "command/script.h"

/* Prints TAP of one test. OK when both give the same, ERR_CHECK with the first that differs when
 * not, ERR_INPUT for a journal that is not sound. */
enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault);

struct bisect_builds {
    const char *journal, *other; /* whose commands; the other build's program */
    const char *scene_path;      /* as for a replay, or NULL */
    const char *word;            /* of the command line, for carrying a script out */
    struct watch *watch;
    /* Called before the two programs, ended by NULL, are started, which are to write below the
     * folder: for confinement and limits, which hold for them as well, since their commands may be
     * a stranger's. */
    enum err (*begin)(void *context, const char *folder, const char *const *program,
                      struct fault *fault);
    void *context;
};

/* The same for this program and another. Scenes are found where the journal lies. ERR_INPUT where
 * both end at the same record, which neither can carry out: that they differ nowhere is not known
 * then; ERR_LIMIT. */
enum err bisect_builds(const struct bisect_builds *builds, const struct printer *printer,
                       struct fault *fault);

#endif
