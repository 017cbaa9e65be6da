/* SPDX-License-Identifier: MIT */
/*
 * The tree of the alternatives in a journal: which record follows which.
 *
 * It follows from three result words; commands are not read, and nothing is carried out.
 *   at=N         the state after this record is that after record N, 0 for the beginning: a note,
 *                and what comes next hangs on N;
 *   on=NAME      and belongs to this alternative, or, where nothing is said, to that of N;
 *   branch=NAME  an alternative of that name begins with this record.
 * Every other record follows the state that was the present one, and belongs to the alternative
 * that one was on; the first is called main. Both words may stand in one record: it then hangs on N
 * itself.
 */
#ifndef JOURNAL_TREE_H
#define JOURNAL_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "journal/record.h"

/* An alternative; there may be as many as records. */
struct tree_branch {
    size_t tip; /* the last record that belongs to it; 0 for none */
    char name[];
};

/* A record, or at 0 the beginning. Parents come before. */
struct tree_node {
    size_t state;  /* the node whose state is the present one after it: itself, but for at=N */
    size_t parent; /* the node it follows */
    struct tree_branch *branch; /* it belongs to */
    uint64_t command;           /* place in the journal */
    uint32_t command_bytes;     /* how many */
    bool is_note;               /* at=N */
    bool begins;                /* branch=NAME */
};

/* Begins as {0}. */
struct tree {
    struct tree_node *node; /* [nodes] by the number of the record */
    size_t nodes, capacity;
    void *branches;         /* a search tree (tsearch) of struct tree_branch */
    size_t present;         /* node */
    struct tree_branch *on; /* that what follows belongs to */
};

/* Puts the beginning there, where the walk is over a journal: ERR_INPUT for a script, which has no
 * such words. ERR_MEMORY. To be released, whatever is returned. */
enum err tree_begin(struct tree *tree, const struct walk *walk, struct fault *fault);

/* The next record. ERR_INPUT where at=N names no record before it. ERR_MEMORY. */
enum err tree_add(struct tree *tree, const struct record *record, struct fault *fault);

void tree_release(struct tree *tree);

#endif
