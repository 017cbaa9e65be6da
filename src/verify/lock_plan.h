/*
 * The journals that a lock is about: which are to be verified, what it says of each, and the lock
 * written anew.
 *
 * With no journals named they are those that it names, and those that lie in its folder or a folder
 * below, hidden ones and links to folders apart; so one that is missing is found, and one that has
 * been added.
 */
#ifndef VERIFY_LOCK_PLAN_H
#define VERIFY_LOCK_PLAN_H

#include "verify/iftty_lock.h"
#include "verify/name_list.h"

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

/* What the lock says of the journal with this number: facts, or NULL where it does not name it. */
const char *lock_plan_pinned(const struct lock_plan *plan, size_t number);

/* Writes the lock anew, with facts[i] for the journal with number i, and adds lines about it. */
enum err lock_plan_write(struct lock_plan *plan, const char *const *facts, struct buf *lines,
                         struct fault *fault);
void lock_plan_release(struct lock_plan *plan);

#endif
