/* SPDX-License-Identifier: MIT */
/*
 * A lock: a text that pins the journals of a folder, by custom named iftty.lock.
 *
 *     # iftty lock 2
 *     journal brain/mine.iftty
 *     chain 5d41402abc4b2a76b9719d911017c592
 *     records 494
 *     scene 8c1f0e52a7b3d946
 *     golden left 2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae
 *     png left fcde2b2edba56bf408601fb721fe9b5c338d10ee429ea04fae5511b68fbf8fb9
 *
 * journal/FORMAT.md describes it. A journal shows that it was changed, but not that another one
 * lies in its place, that its end is gone, or that it is gone itself: its chain holds no secret,
 * and nothing says which one is meant. A lock says it, in a file that is reviewed and kept apart.
 *
 *   (L1) one way to write it: journals and lines are in the order of their bytes, each once, and a
 *        reader refuses all else, so that two locks of the same journals are the same bytes;
 *   (L2) names lead below the lock's folder, and nowhere else.
 *
 * What is known of a journal, its facts, are the lines below its name, as text.
 */
#ifndef VERIFY_IFTTY_LOCK_H
#define VERIFY_IFTTY_LOCK_H

#include "base/buf.h"
#include "base/err.h"
#include "verify/name_list.h"

/* Version 1 has no lines `png`: it does not say which PNGs lie beside golden images. */
enum { LOCK_WITH_PNG = 2, LOCK_VERSION = 2 };

struct lock {
    unsigned version; /* 1..LOCK_VERSION */
    struct lock_entry {
        char *name, *facts;
    } * entry; /* in the order of their names */
    size_t count, capacity;
};

/* Whether a lock can hold a journal of this name: relative, no "." or "..", nothing that a terminal
 * would obey, and it ends in ".iftty". */
bool lock_name_is_valid(const char *name);

/* Takes the text apart. ERR_INPUT with the line that is wrong, and what was expected; ERR_MEMORY.
 * `lock` begins as {0}, and is to be released whatever is returned. */
enum err lock_read(struct lock *lock, const char *bytes, size_t length, struct fault *fault);

/* Of the journal of that name, or NULL. */
const char *lock_facts_of(const struct lock *lock, const char *name);
void lock_release(struct lock *lock);

/* Adds a line "#   pinned   ..." for each fact that differs, is gone or is new, of those that a
 * lock of this version has; false where none does. Safe to print. */
bool lock_differs(struct buf *lines, unsigned version, const char *pinned, const char *now);

/* Adds what a lock says of the journal at `path`, lines read from its bytes and from its golden
 * images; no command is carried out. Of the goldens, the SHA-256 of each file that the journal
 * names, and of the PNG beside it; one that cannot be read has no line. *torn is the byte from
 * which on the journal is an unfinished record, 0 for none. ERR_INPUT for a journal that is
 * damaged, ERR_IO, ERR_MEMORY. A golden image or PNG that is a link out of its folder is there only
 * where a replay has compared it (is_proven): of another file not even the digest is said. */
enum err lock_facts(struct buf *out, uint64_t *torn, const char *path, bool is_proven,
                    struct fault *fault);

/* The chain among these lines: 32 digits, not ended; NULL where there is none. */
const char *lock_facts_chain(const char *facts);

/* ---- the journals that it is about ---- */

/*
 * Which are to be verified, what it says of each, and the lock written anew. With no journals named
 * they are those that it names, and those that lie in its folder or a folder below, hidden ones and
 * links to folders apart; so one that is missing is found, and one that has been added.
 */
struct lock_plan {
    const char *path; /* of the lock; borrowed */
    bool updates;     /* it is written anew: what it says now counts for nothing */
    bool is_whole;    /* no journals were named */
    struct lock lock;
    struct name_list name; /* of the journals, as the lock has them */
    char **journal;        /* [name.count] their paths */
};

/* Reads the lock, which need not exist where it is written anew, and finds the journals: `named`
 * ones, all of which lie in its folder or below (else ERR_USAGE). ERR_CHECK where there are none.
 * To be released, whatever is returned. */
enum err lock_plan_make(struct lock_plan *plan, const char *path, bool updates, char *const *named,
                        size_t count, struct fault *fault);

/* Writes the lock anew, with facts[i] for the journal with number i, and adds lines about it. */
enum err lock_plan_write(struct lock_plan *plan, const char *const *facts, struct buf *lines,
                         struct fault *fault);
void lock_plan_release(struct lock_plan *plan);

#endif
