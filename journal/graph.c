#include "journal/graph.h"

#include <search.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "journal/record.h"

#define NO_LANE SIZE_MAX

/* ---- the tree ---- */

/* An alternative. In a search tree (tsearch), since a journal may have as many as records. */
struct branch {
    size_t tip; /* the last record that belongs to it; 0 for none */
    char name[];
};

/* A record, or at 0 the beginning. */
struct node {
    size_t state;    /* the node whose state is the present one after it: itself, but for at=N */
    size_t parent;   /* the node it follows */
    size_t children; /* that follow it and are still to be drawn */
    size_t lane;     /* once drawn, where it waits for those that follow it */
    struct branch *branch;  /* it belongs to */
    uint64_t command;       /* place in the journal */
    uint32_t command_bytes; /* how many */
    bool is_note;           /* at=N */
};

struct tree {
    const char *bytes; /* of the journal; borrowed */
    struct node *node; /* [nodes] by the number of the record */
    size_t nodes, capacity;
    void *branches;
    size_t present;    /* node */
    struct branch *on; /* that what follows belongs to */
};

static int compare_names(const void *a, const void *b)
{
    const struct branch *x = a, *y = b;
    return strcmp(x->name, y->name);
}

static struct branch *new_branch(const char *name, size_t length)
{
    struct branch *branch = mem_new(sizeof *branch + length + 1);
    if (branch)
        memcpy(branch->name, name, length);
    return branch;
}

/* What follows belongs to a new branch; to the first of that name where there are two, which no
 * session makes. */
static bool begin_branch(struct tree *tree, const char *name, size_t length)
{
    struct branch *branch = new_branch(name, length);
    struct branch **found = branch ? tsearch(branch, &tree->branches, compare_names) : NULL;
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
    struct branch *like = new_branch(word.value, word.value_length);
    struct branch **found = like ? tfind(like, &tree->branches, compare_names) : NULL;
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
                         "it, or 0; nothing is drawn",
                         record->number, record->line,
                         (int)(word->value_length < 40 ? word->value_length : 40), word->value);
    *state = tree->node[number].state;
    return OK;
}

static bool add_node(struct tree *tree, const struct node *node)
{
    if (!mem_grow(&tree->node, &tree->capacity, tree->nodes + 1, sizeof *node))
        return false;
    tree->node[tree->nodes] = *node;
    tree->present = node->state;
    if (!node->is_note && tree->nodes) {
        tree->node[node->parent].children++;
        node->branch->tip = tree->nodes;
    }
    tree->nodes++;
    return true;
}

static enum err add_record(struct tree *tree, const struct record *record, struct fault *fault)
{
    struct record_word at, name;
    const bool moves = record_word_find(record->result, "at", 2, &at);
    const bool begins = record_word_find(record->result, "branch", 6, &name);
    struct node node = {.is_note = moves && !begins,
                        .parent = tree->present,
                        .command = record->command_offset,
                        .command_bytes = (uint32_t)strlen(record->command),
                        .lane = NO_LANE};
    const enum err err = moves ? read_at(tree, record, &at, &node.parent, fault) : OK;
    if (err)
        return err;
    bool has_room = !moves || read_on(tree, record, node.parent);
    if (has_room && begins)
        has_room = begin_branch(tree, name.value, name.value_length);
    node.state = node.is_note ? node.parent : tree->nodes;
    node.branch = tree->on;
    return has_room && add_node(tree, &node) ? OK : fault_memory(fault, "the graph of a journal");
}

static enum err read_tree(struct tree *tree, size_t length, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, tree->bytes, length, fault);
    if (!err && !walk.is_journal)
        err = fault_set(fault, ERR_INPUT,
                        "this is a script, not a journal: no result says what follows what");
    if (!err && (!begin_branch(tree, "main", 4) ||
                 !add_node(tree, &(struct node){.branch = tree->on, .lane = NO_LANE})))
        err = fault_memory(fault, "the graph of a journal");
    while (!err && walk_next(&walk, &record) == WALK_RECORD)
        err = add_record(tree, &record, fault);
    if (!err)
        err = walk_judge(&walk, fault);
    walk_release(&walk);
    return err;
}

/* ---- the drawing ---- */

/* What lines are made of. */
struct strokes {
    const char *node, *present, *rail, *fork, *level, *turn, *corner;
};

static const struct strokes ascii = {"*", "@", "|", "|", "-", "\\", " "};
static const struct strokes box = {"●", "◆", "│", "├", "─", "─", "╮"};

struct drawing {
    struct buf *out;
    const struct strokes *strokes;
    struct tree *tree;
    bool is_held[GRAPH_LANES]; /* a node waits in this lane */
    size_t lanes;              /* after the last that is held */
};

static void end_line(struct drawing *d)
{
    while (d->out->length && d->out->data[d->out->length - 1] == ' ')
        d->out->data[--d->out->length] = '\0';
    buf_add_char(d->out, '\n');
}

/* Lanes first..end-1, each with the gap after it. */
static void draw_rails(struct drawing *d, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        buf_add_text(d->out, d->is_held[i] ? d->strokes->rail : " ");
        buf_add_char(d->out, ' ');
    }
}

/* The line on which lane `to` branches off lane `from`, to its right. */
static void draw_fork(struct drawing *d, size_t from, size_t to)
{
    draw_rails(d, 0, from);
    buf_add_text(d->out, d->strokes->fork);
    for (size_t i = from + 1; i < to; i++) {
        buf_add_text(d->out, d->strokes->level);
        buf_add_text(d->out, d->is_held[i] ? d->strokes->rail : d->strokes->level);
    }
    buf_add_text(d->out, d->strokes->turn);
    buf_add_text(d->out, d->strokes->corner);
    buf_add_char(d->out, ' ');
    if (to + 1 < d->lanes)
        draw_rails(d, to + 1, d->lanes);
    end_line(d);
}

/* The first free lane from `first` on, or NO_LANE. */
static size_t find_lane(const struct drawing *d, size_t first)
{
    for (size_t i = first; i < GRAPH_LANES; i++)
        if (!d->is_held[i])
            return i;
    return NO_LANE;
}

static void hold(struct drawing *d, size_t lane, bool is_held)
{
    d->is_held[lane] = is_held;
    if (is_held && lane >= d->lanes)
        d->lanes = lane + 1;
    while (d->lanes && !d->is_held[d->lanes - 1])
        d->lanes--;
}

/* The lane for a node, by G1 and G2; draws the line before it where it branches off. */
static size_t choose_lane(struct drawing *d, const struct node *node)
{
    struct node *parent = d->tree->node + node->parent;
    const size_t from = parent->lane;
    parent->children--;
    if (from == NO_LANE)
        return find_lane(d, 0);
    if (!parent->children)
        return from;
    const size_t to = find_lane(d, from + 1);
    if (to != NO_LANE)
        draw_fork(d, from, to);
    return to;
}

static void add_command(struct drawing *d, const struct node *node)
{
    buf_add_safe_excerpt(d->out, d->tree->bytes + node->command, node->command_bytes);
}

/* "(main, present) " before the command, where there is something to say. */
static void add_names(struct drawing *d, size_t number, bool follows_unseen)
{
    const struct node *node = d->tree->node + number;
    const char *between = "(";
    if (follows_unseen) {
        buf_printf(d->out, "(after %zu", node->parent);
        between = ", ";
    }
    if (number && node->branch->tip == number) {
        buf_add_text(d->out, between);
        buf_add_safe_text(d->out, node->branch->name);
        between = ", ";
    }
    if (number == d->tree->present) {
        buf_printf(d->out, "%spresent", between);
        between = ", ";
    }
    if (*between == ',')
        buf_add_text(d->out, ") ");
}

static void draw_node(struct drawing *d, size_t number, size_t lane, bool follows_unseen)
{
    const struct strokes *s = d->strokes;
    const size_t before = lane == NO_LANE ? d->lanes : lane;
    draw_rails(d, 0, before);
    buf_add_text(d->out, number == d->tree->present ? s->present : s->node);
    buf_add_char(d->out, ' ');
    if (lane + 1 < d->lanes && lane != NO_LANE)
        draw_rails(d, lane + 1, d->lanes);
    buf_printf(d->out, "%zu ", number);
    add_names(d, number, follows_unseen);
    if (number)
        add_command(d, d->tree->node + number);
    else
        buf_add_text(d->out, "the beginning");
    end_line(d);
}

static void draw_record(struct drawing *d, size_t number)
{
    struct node *node = d->tree->node + number;
    if (node->is_note) {
        draw_rails(d, 0, d->lanes);
        buf_printf(d->out, "(%zu ", number);
        add_command(d, node);
        buf_printf(d->out, ": at %zu)\n", node->state);
        return;
    }
    const bool parent_is_seen = d->tree->node[node->parent].lane != NO_LANE;
    const size_t lane = choose_lane(d, node);
    draw_node(d, number, lane, !parent_is_seen || lane == NO_LANE);
    node->lane = node->children ? lane : NO_LANE;
    if (lane != NO_LANE)
        hold(d, lane, node->children > 0);
}

enum err graph_draw(struct buf *out, const char *bytes, size_t length, bool unicode,
                    struct fault *fault)
{
    struct tree tree = {.bytes = bytes};
    struct drawing drawing = {.out = out, .strokes = unicode ? &box : &ascii, .tree = &tree};
    enum err err = read_tree(&tree, length, fault);
    if (!err) {
        tree.node[0].lane = 0;
        if (tree.node[0].children != 1 || tree.present == 0)
            draw_node(&drawing, 0, 0, false);
        hold(&drawing, 0, tree.node[0].children > 0);
        for (size_t i = 1; i < tree.nodes; i++)
            draw_record(&drawing, i);
    }
    if (!err && out->failed)
        err = fault_memory(fault, "the graph of a journal");
    tdestroy(tree.branches, free);
    free(tree.node);
    return err;
}
