/*
 * What becomes of golden images while a journal is replayed.
 *
 * `golden NAME` writes a file in a plain session. In a replay it compares what is drawn with that
 * file, where the interpreter has a judge, and the judge is asked what follows from a difference:
 * src/verify has one that leaves evidence for a person, and one that accepts the new picture. The
 * commands know neither.
 */
#ifndef COMMAND_GOLDEN_JUDGE_H
#define COMMAND_GOLDEN_JUDGE_H

#include "image/picture.h"
#include "journal/golden.h"

struct interpreter;

/* A golden image that is missing, cannot be read, or shows something else. Borrowed. */
struct golden_finding {
    const char *name, *path;        /* of the golden image; its place beside the journal */
    struct picture *actual;         /* to which notes may be added */
    const struct picture *expected; /* NULL where none can be read */
    const struct golden_difference *difference; /* NULL likewise */
};

struct golden_judge {
    void *context;
    /* The file that is compared instead of the one at `path`; NULL: that one. */
    const char *(*source)(void *context, const char *path);
    /* Called where every plane of every pixel is the same, for what else there is to ask. NULL: OK.
     */
    enum err (*is_same)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
    /* Called with what is wrong in `fault`. OK, with an empty fault, where the picture is taken
     * in; ERR_CHECK, with the fault as it was or in better words, where not. NULL: ERR_CHECK. */
    enum err (*differs)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
};

#endif
