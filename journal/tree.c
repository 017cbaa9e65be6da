/* SPDX-License-Identifier: MIT */
#include "journal/tree.h"

#include <search.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"

static int compare_names(const void *a, const void *b)
{
    const struct tree_branch *x = a, *y = b;
    return strcmp(x->name, y->name);
}

static struct tree_branch *new_branch(const char *name, size_t length)
{
    struct tree_branch *branch = mem_new(sizeof *branch + length + 1);
    if (branch)
        memcpy(branch->name, name, length);
    return branch;
}

/* What follows belongs to a new branch; to the first of that name where there are two, which no
 * session makes. */
static bool begin_branch(struct tree *tree, const char *name, size_t length)
{
    struct tree_branch *branch = new_branch(name, length);
    struct tree_branch **found = branch ? tsearch(branch, &tree->branches, compare_names) : NULL;
    if (!found || *found != branch)
        free(branch);
    tree->on = found ? *found : NULL;
    return tree->on;
}

/* The branch that a record with at=N says one is on; that of N where it says nothing. */
static bool read_on(struct tree *tree, const struct record *record, size_t state)
{
    struct record_word word;
    tree->on = tree->node[state].branch;
    if (!record_word_find(record->result, "on", 2, &word))
        return true;
    struct tree_branch *like = new_branch(word.value, word.value_length);
    struct tree_branch **found = like ? tfind(like, &tree->branches, compare_names) : NULL;
    tree->on = found ? *found : tree->on;
    free(like);
    return like;
}

/* Where at=N goes: to a node before this record. */
static enum err read_at(const struct tree *tree, const struct record *record,
                        const struct record_word *word, size_t *state, struct fault *fault)
{
    const char *at = word->value;
    int64_t number;
    if (!scan_integer(&at, 0, (int64_t)tree->nodes - 1, &number) ||
        at != word->value + word->value_length)
        return fault_set(fault, ERR_INPUT,
                         "record %zu, line %zu: at=%.*s: expected the number of a record before "
                         "it, or 0",
                         record->number, record->line,
                         (int)(word->value_length < 40 ? word->value_length : 40), word->value);
    *state = tree->node[number].state;
    return OK;
}

static bool add_node(struct tree *tree, const struct tree_node *node)
{
    if (!mem_grow(&tree->node, &tree->capacity, tree->nodes + 1, sizeof *node))
        return false;
    tree->node[tree->nodes] = *node;
    tree->present = node->state;
    if (!node->is_note && tree->nodes)
        node->branch->tip = tree->nodes;
    tree->nodes++;
    return true;
}

enum err tree_begin(struct tree *tree, const struct walk *walk, struct fault *fault)
{
    if (!walk->is_journal)
        return fault_set(fault, ERR_INPUT,
                         "this is a script, not a journal: no result says what follows what; "
                         "`iftty run --journal FILE` makes a journal of it");
    return begin_branch(tree, "main", 4) && add_node(tree, &(struct tree_node){.branch = tree->on})
               ? OK
               : fault_memory(fault, "the tree of a journal");
}

enum err tree_add(struct tree *tree, const struct record *record, struct fault *fault)
{
    struct record_word at, name;
    const bool moves = record_word_find(record->result, "at", 2, &at);
    const bool begins = record_word_find(record->result, "branch", 6, &name);
    struct tree_node node = {.is_note = moves && !begins,
                             .begins = begins,
                             .parent = tree->present,
                             .command = record->command_offset,
                             .command_bytes = (uint32_t)strlen(record->command)};
    const enum err err = moves ? read_at(tree, record, &at, &node.parent, fault) : OK;
    if (err)
        return err;
    bool has_room = !moves || read_on(tree, record, node.parent);
    if (has_room && begins)
        has_room = begin_branch(tree, name.value, name.value_length);
    node.state = node.is_note ? node.parent : tree->nodes;
    node.branch = tree->on;
    return has_room && add_node(tree, &node) ? OK : fault_memory(fault, "the tree of a journal");
}

void tree_release(struct tree *tree)
{
    tdestroy(tree->branches, free);
    free(tree->node);
}
