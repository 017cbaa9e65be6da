/*
 * The verification of journals: each is replayed in a process of its own, every result and golden
 * image compared, and the outcome told as TAP, in the order of the files whatever ends first.
 *
 * A process each, because a journal is a program that is not trusted: one that crashes, or is
 * killed for its memory, is one failure with its signal named, and the others are verified. The
 * verdict comes back through a pipe (verdict.h). No process outlives the one that started it.
 */
#ifndef VERIFY_VERIFY_H
#define VERIFY_VERIFY_H

#include "command/script.h"
#include "verify/verdict.h"

enum { VERIFY_PROCESSES_MOST = 64 };

struct verify_options {
    char *const *path; /* of the journals */
    size_t count;
    const char *scene_path;      /* a scene to open whatever name `open` gives, or NULL */
    const char *evidence_folder; /* for what golden images differ by, or NULL; that of journals of
                                    one name goes below, into N/ for the Nth of `path` */
    const char *junit, *html;    /* reports, written anew; or NULL */
    size_t first, last;          /* records to compare; 0 for all */
    unsigned processes;          /* at most so many at once, 1..VERIFY_PROCESSES_MOST */
    /* Called in the process of each journal before it is carried out; or NULL. An error is the
     * verdict. */
    enum err (*begin)(void *context, const char *journal, struct fault *fault);
    void *context;
    struct watch *watch; /* when it stops, all processes are ended: ERR_CANCELLED */
};

/* ERR_CHECK when anything differs, a golden image is missing, or one is there that no command of
 * the journal names (which is only known when it was replayed to its end, without `last`); else the
 * worst error. */
enum err verify_files(const struct verify_options *options, const struct teller *teller,
                      struct fault *fault);

/* The verdict on one journal, in this process. */
void verify_one(const struct verify_options *options, const char *path, struct verdict *verdict);

#endif
