/* SPDX-License-Identifier: MIT */
/*
 * The verification of journals: each is replayed in a process of its own, every result and golden
 * image compared, and the outcome printed as TAP, in the order of the files whatever ends first.
 *
 * A process each, because a journal is a program that is not trusted: one that crashes, or is
 * killed for its memory, is one failure with its signal named, and the others are verified. What
 * was found comes back through a pipe (verify_result.h); all reports read the same array of it.
 */
#ifndef VERIFY_VERIFY_H
#define VERIFY_VERIFY_H

#include "command/script.h"
#include "verify/process.h"
#include "verify/side.h"

struct verify_options {
    char *const *path; /* of the journals */
    size_t count;
    const char *scene_path;      /* a scene to open whatever name `open` gives, or NULL */
    const char *evidence_folder; /* for what golden images differ by, or NULL; that of journals of
                                    one name goes below, into N/ for the Nth of `path` */
    const char *junit, *html;    /* reports, replacing what is there; or NULL */
    bool json;                   /* one JSON object is printed instead of TAP */
    bool strict;                 /* what leaves anything unproven is a failure */
    bool fail_fast;       /* the first failure ends it: what is not verified yet is skipped */
    bool timings;         /* the slowest records of each are printed */
    bool removes_orphans; /* of journals that verify otherwise */
    const char *expect;   /* the last chain that the only journal is to have, or NULL */
    size_t first, last;   /* records to compare; 0 for all */
    unsigned processes;   /* at most so many at once, 1..PROCESSES_MOST */
    /* Called in the process of each journal before it is carried out; or NULL. An error is the
     * result. */
    enum err (*begin)(void *context, const char *journal, struct fault *fault);
    void *context;
    struct watch *watch; /* when it stops, all processes are ended: ERR_CANCELLED */
};

/* True in a run without a person: the environment variable CI is set to anything but "", as by the
 * services that run tests. Then verification is strict, and decisions of a person are refused. */
bool ci_is_set(void);

/* ERR_CHECK when anything differs, a golden image is missing, or one is there that no command of
 * the journal names (which is only known when it was replayed to its end, without `last`); else the
 * worst error. */
enum err verify_files(const struct verify_options *options, const struct printer *printer,
                      struct fault *fault);

/* Prints the first record that differs as TAP of one test. OK when both journals give the same,
 * ERR_CHECK with the first that differs when not, ERR_INPUT for a journal that is not sound. */
enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault);

/*
 * Resealing a journal: the honest way to change one. It is carried out again, every record that
 * gives another result gets that of today and a comment that says why, with what it said before,
 * and the former journal is stored beside it. Nothing else changes.
 *
 *     # accepted: softer light (golden image left: 512 pixels differ, first column 3, row 4: ...)
 *     # it was: chain=<32 digits> picture=0123456789abcdef
 *     golden left
 *     = 12 picture=fedcba9876543210 chain=<32 digits>
 *
 * A journal names its golden images, so accepting one is a change of the journal, even where only
 * the file is drawn again: the reason is part of the chain from then on.
 *
 * Promises
 *     (R1) whole or not at all: golden images and journal are all as they were, or all new;
 *     (R2) what is written verifies, here and now, but for pictures that are not accepted;
 *     (R3) the bytes of the former journal stay, as FILE.before-N;
 *     (R4) nobody else writes the journal meanwhile.
 */

/* `iftty verify --accept WHY`: golden images that differ or are missing are drawn again, and
 * records of pictures get today's digests. Refused where a record gives another result that is no
 * picture's, where the journal was edited, where an orphan lies in its folder (ERR_CHECK), and
 * where the environment variable CI is set (ERR_USAGE): accepting is a person's decision.
 *
 * `only`, or NULL: the names of the golden images to accept, as "first,second". All other pictures
 * stay as they were, with their records: ERR_CHECK where any of them differs, after the named ones
 * were accepted. ERR_USAGE for a name that the journal does not give. */
enum err reseal_accept(struct interpreter *interp, const char *path, const char *why,
                       const char *only, const struct printer *printer, struct fault *fault);

/* `iftty log --reseal`: a journal that was edited by hand, or that another version wrote, gets the
 * results that its commands give here. With a reason, `--accept WHY`, its pictures are accepted in
 * the same step. Without one golden images are left alone, and counted where they are others
 * now. */
enum err reseal_edited(struct interpreter *interp, const char *path, const char *why,
                       const struct printer *printer, struct fault *fault);

/*
 * Two journals or scripts compared: the first command in which they differ, and how far the labels
 * differ that they end with.
 *
 * Each is carried out in a process of its own, by the rules for the journals of
 * others, B first: only its labels, names and colours stay, a byte a voxel, while A is carried out.
 * The picture is drawn by A's process, which has the scene. Nothing is written but that picture,
 * and that by the process that asked for it.
 */

struct diff_options {
    const char *path[2];
    struct side_options side;
    const char *picture; /* a file that is not there yet, or NULL */
    bool json;
};

/* Prints what differs. OK where the labels are the same, ERR_CHECK where not. ERR_INPUT for what
 * cannot be read or carried out, gives other results than it says, opens no scene, or one of
 * another size than the other's. */
enum err diff_journals(const struct diff_options *options, const struct printer *printer,
                       struct fault *fault);

#endif
