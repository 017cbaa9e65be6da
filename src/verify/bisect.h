/*
 * The first record in which two journals, or two builds of the program, differ.
 *
 * Journals are compared by their chains. A chain covers everything before it, so that two journals
 * with the same chain at record N are the same up to N: a binary search finds the first record that
 * is not, and nothing is carried out. From there on commands and results are compared, since after a
 * comment that differs all chains do.
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
     * folder; or NULL. For confinement and limits, which hold for them as well. */
    enum err (*begin)(void *context, const char *folder, const char *const *program,
                      struct fault *fault);
    void *context;
};

/* The same for this program and another. Scenes are found where the journal lies. ERR_INPUT where
 * both end at the same record, which neither can carry out: that they differ nowhere is not known
 * then; ERR_LIMIT. */
enum err bisect_builds(const struct bisect_builds *builds, const struct printer *printer,
                       struct fault *fault);

/* ---- for tests ---- */

/* Two journals in memory: `number` of the first record that differs, 0 for none; `compared` chains.
 * `lines` describe it. */
struct bisection {
    size_t number, records, compared;
    struct buf lines; /* begin with "# ", safe to print */
};
enum err bisect_bytes(struct bisection *out, const char *const name[2], const struct buf bytes[2],
                      struct fault *fault);
void bisection_release(struct bisection *bisection);

#endif
