/* SPDX-License-Identifier: MIT */
/*
 * Golden images beside their journal: who judges them, and what they must say. Which files there
 * belong to a journal is command/golden_files.h.
 *
 * `golden NAME` writes a file in a plain session. In a replay it compares what is drawn with that
 * file, where the interpreter has a judge, and the judge is asked what follows from a difference:
 * src/verify has one that leaves evidence for a person, and one that accepts the new picture. The
 * commands know neither.
 */
#ifndef COMMAND_GOLDEN_JUDGE_H
#define COMMAND_GOLDEN_JUDGE_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"
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
    /* Called where every plane of every pixel is the same, for what else there is to ask. NULL:
     * OK. */
    enum err (*is_same)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
    /* Called with what is wrong in `fault`. OK, with an empty fault, where the picture is taken
     * in; ERR_CHECK, with the fault as it was or in better words, where not. NULL: ERR_CHECK. */
    enum err (*differs)(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault);
};

/* ---- notes ---- */

/*
 * The words that a golden image carries beside its pixels (show/export_picture.h) are those that
 * the picture drawn now would carry, and none is missing. Which journal it was of, at which record,
 * and which version drew it, is of the time at which it was made: of those only the form is looked
 * at.
 */

/* Whether it is one of those, and of their form. */
bool golden_note_is_of_its_time(const struct attribute *note);

/* OK, or ERR_CHECK with the first that differs. Of a scene that was opened in place of another the
 * name counts for nothing (!names_scene). */
enum err golden_compare_notes(const struct picture *kept, const struct picture *drawn,
                              bool names_scene, struct fault *fault);

#endif
