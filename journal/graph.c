#include "journal/graph.h"

#include <stdlib.h>
#include <search.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "journal/walk.h"

#define NO_LANE SIZE_MAX

/* ---- the tree ---- */

/* A record, or at 0 the beginning. */
struct node {
    size_t state;    /* the node whose state is the present one after it: itself, but for at=N */
    size_t parent;   /* the node it follows */
    size_t children; /* that follow it and are still to be drawn */
    size_t branch;   /* it belongs to */
    size_t command;  /* place in tree->texts */
    size_t lane;     /* once drawn, where it waits for those that follow it */
    bool is_note;    /* at=N */
};

struct branch {
    size_t name; /* place in tree->texts */
    size_t tip;  /* the last record that belongs to it; 0 for none */
};

/* In a search tree (tsearch), since a journal may have as many branches as records. */
struct named {
    size_t branch;
    char name[];
};

struct tree {
    struct node *node; /* [nodes] by the number of the record */
    size_t nodes, node_capacity;
    struct branch *branch;
    size_t branches, branch_capacity;
    void *names;      /* of struct named */
    struct buf texts; /* each ended by NUL */
    size_t present;   /* node */
    size_t on;        /* the branch that what follows belongs to */
};

static void tree_release(struct tree *tree)
{
    tdestroy(tree->names, free);
    free(tree->node);
    free(tree->branch);
    buf_release(&tree->texts);
}

static size_t store_text(struct tree *tree, const char *text, size_t length)
{
    const size_t place = tree->texts.length;
    buf_add(&tree->texts, text, length);
    buf_add_char(&tree->texts, '\0');
    return place;
}

static int compare_names(const void *a, const void *b)
{
    const struct named *x = a, *y = b;
    return strcmp(x->name, y->name);
}

/* A search tree's entry for a name, or NULL when out of memory. */
static struct named *new_name(const char *name, size_t length, size_t branch)
{
    struct named *named = mem_new(sizeof *named + length + 1);
    if (!named)
        return NULL;
    named->branch = branch;
    memcpy(named->name, name, length);
    return named;
}

/* Of two branches of one name, which no session makes, the first is the one that is found. */
static bool add_branch(struct tree *tree, const char *name, size_t length)
{
    struct named *named = new_name(name, length, tree->branches);
    struct named **found = named ? tsearch(named, &tree->names, compare_names) : NULL;
    if (!found || *found != named)
        free(named);
    if (!found ||
        !mem_grow(&tree->branch, &tree->branch_capacity, tree->branches + 1, sizeof *tree->branch))
        return false;
    tree->on = tree->branches;
    tree->branch[tree->branches++] = (struct branch){.name = store_text(tree, name, length)};
    return true;
}

/* The branch that a record with at=N says one is on; that of N where it says nothing. */
static enum err read_on(struct tree *tree, const struct record *record, size_t state,
                        struct fault *fault)
{
    struct record_word word;
    tree->on = tree->node[state].branch;
    if (!record_word_find(record->result, "on=", 2, &word))
        return OK;
    struct named *named = new_name(word.value, word.value_length, 0);
    if (!named)
        return fault_memory(fault, "the graph of a journal");
    struct named **found = tfind(named, &tree->names, compare_names);
    tree->on = found ? (*found)->branch : tree->on;
    free(named);
    return OK;
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

static enum err add_record(struct tree *tree, const struct record *record, struct fault *fault)
{
    struct record_word at, name;
    const bool moves = record_word_find(record->result, "at=", 2, &at);
    const bool begins = record_word_find(record->result, "branch=", 6, &name);
    const size_t number = tree->nodes;
    struct node node = {.is_note = moves && !begins, .parent = tree->present, .lane = NO_LANE};
    enum err err = moves ? read_at(tree, record, &at, &node.parent, fault) : OK;
    if (!err && moves)
        err = read_on(tree, record, node.parent, fault);
    if (err)
        return err;
    node.state = node.is_note ? node.parent : number;
    node.branch = begins ? tree->branches : tree->on;
    node.command = store_text(tree, record->command, strlen(record->command));
    if ((begins && !add_branch(tree, name.value, name.value_length)) ||
        !mem_grow(&tree->node, &tree->node_capacity, number + 1, sizeof node) || tree->texts.failed)
        return fault_memory(fault, "the graph of a journal");
    tree->node[tree->nodes++] = node;
    tree->present = node.state;
    if (!node.is_note) {
        tree->node[node.parent].children++;
        tree->branch[node.branch].tip = number;
    }
    return OK;
}

static enum err begin_tree(struct tree *tree, struct fault *fault)
{
    *tree = (struct tree){0};
    if (!add_branch(tree, "main", 4) ||
        !mem_grow(&tree->node, &tree->node_capacity, 1, sizeof *tree->node) || tree->texts.failed)
        return fault_memory(fault, "the graph of a journal");
    tree->node[tree->nodes++] = (struct node){.lane = NO_LANE};
    return OK;
}

static enum err read_tree(struct tree *tree, const char *bytes, size_t length, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes, length, fault);
    if (err)
        return err;
    if (!walk.is_journal)
        err = fault_set(fault, ERR_INPUT,
                        "this is a script, not a journal: no result says what follows what");
    while (!err && walk_next(&walk, &record) == WALK_RECORD)
        err = add_record(tree, &record, fault);
    if (!err && walk.over == WALK_DAMAGED)
        err = fault_set(fault, ERR_INPUT, "%s", walk.fault.text);
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

static void add_text(struct drawing *d, size_t place)
{
    const char *text = buf_text(&d->tree->texts) + place;
    buf_add_safe_text(d->out, text);
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
    if (number && d->tree->branch[node->branch].tip == number) {
        buf_add_text(d->out, between);
        add_text(d, d->tree->branch[node->branch].name);
        between = ", ";
    }
    if (number == d->tree->present) {
        buf_add_text(d->out, between);
        buf_add_text(d->out, "present");
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
        add_text(d, d->tree->node[number].command);
    else
        buf_add_text(d->out, "the beginning");
    end_line(d);
}

static void draw_note(struct drawing *d, size_t number)
{
    draw_rails(d, 0, d->lanes);
    buf_printf(d->out, "(%zu ", number);
    add_text(d, d->tree->node[number].command);
    buf_printf(d->out, ": at %zu)\n", d->tree->node[number].state);
}

static void draw_record(struct drawing *d, size_t number)
{
    struct node *node = d->tree->node + number;
    if (node->is_note) {
        draw_note(d, number);
        return;
    }
    const bool parent_is_seen = d->tree->node[node->parent].lane != NO_LANE;
    const size_t lane = choose_lane(d, node);
    draw_node(d, number, lane, !parent_is_seen || lane == NO_LANE);
    node->lane = node->children ? lane : NO_LANE;
    if (lane != NO_LANE)
        hold(d, lane, node->children > 0);
}

static void draw_tree(struct drawing *d)
{
    struct node *beginning = d->tree->node;
    beginning->lane = 0;
    if (beginning->children != 1 || d->tree->present == 0)
        draw_node(d, 0, 0, false);
    hold(d, 0, beginning->children > 0);
    for (size_t i = 1; i < d->tree->nodes; i++)
        draw_record(d, i);
}

enum err graph_draw(struct buf *out, const char *bytes, size_t length, bool unicode,
                    struct fault *fault)
{
    struct tree tree;
    struct drawing drawing = {.out = out, .strokes = unicode ? &box : &ascii, .tree = &tree};
    enum err err = begin_tree(&tree, fault);
    if (!err)
        err = read_tree(&tree, bytes, length, fault);
    if (!err)
        draw_tree(&drawing);
    if (!err && out->failed)
        err = fault_memory(fault, "the graph of a journal");
    tree_release(&tree);
    return err;
}
