/* SPDX-License-Identifier: MIT */
#include "journal/graph.h"

#include "journal/tree.h"

#define NO_LANE SIZE_MAX

/* What lines are made of. */
struct strokes {
    const char *node, *present, *rail, *fork, *level, *turn, *corner;
};

static const struct strokes ascii = {"*", "@", "|", "|", "-", "\\", " "};
static const struct strokes box = {"●", "◆", "│", "├", "─", "─", "╮"};

struct drawing {
    struct buf *out;
    const char *bytes; /* of the journal */
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
static size_t choose_lane(struct drawing *d, const struct tree_node *node)
{
    struct tree_node *parent = d->tree->node + node->parent;
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

static void add_command(struct drawing *d, const struct tree_node *node)
{
    buf_add_safe_excerpt(d->out, d->bytes + node->command, node->command_bytes);
}

/* "(main, present) " before the command, where there is something to say. */
static void add_names(struct drawing *d, size_t number, bool follows_unseen)
{
    const struct tree_node *node = d->tree->node + number;
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
    struct tree_node *node = d->tree->node + number;
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

static enum err read_tree(struct tree *tree, const char *bytes, size_t length, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes, length, fault);
    if (!err)
        err = tree_begin(tree, &walk, fault);
    while (!err && walk_next(&walk, &record) == WALK_RECORD)
        err = tree_add(tree, &record, fault);
    if (!err)
        err = walk_judge(&walk, fault);
    walk_release(&walk);
    return err;
}

enum err graph_draw(struct buf *out, const char *bytes, size_t length, bool unicode,
                    struct fault *fault)
{
    struct tree tree = {0};
    struct drawing drawing = {
        .out = out, .bytes = bytes, .strokes = unicode ? &box : &ascii, .tree = &tree};
    enum err err = read_tree(&tree, bytes, length, fault);
    if (!err) {
        if (tree.node[0].children != 1 || tree.present == 0)
            draw_node(&drawing, 0, 0, false);
        hold(&drawing, 0, tree.node[0].children > 0);
        for (size_t i = 1; i < tree.nodes; i++)
            draw_record(&drawing, i);
    }
    if (!err && out->failed)
        err = fault_memory(fault, "the graph of a journal");
    tree_release(&tree);
    return err;
}
