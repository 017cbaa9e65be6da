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

#endif
