/* SPDX-License-Identifier: MIT */
#include "steps/step_list.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "command/command.h"
#include "journal/tree.h"

struct reading {
    struct step_list *list;
    struct tree tree;
    struct buf comments; /* since the last step */
};

static size_t keep_text(struct step_list *list, const char *text)
{
    const size_t at = list->text.length;
    buf_add(&list->text, text, strlen(text) + 1);
    return at;
}

/* Comments stand before their record's command, and may be any bytes. */
static void gather_comments(struct reading *r, const char *bytes, const struct record *record)
{
    const char *at = bytes + record->offset, *end = bytes + record->command_offset;
    while (at < end) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const char *stop = feed ? feed : end;
        at += at < stop && *at == '#';
        at += at < stop && *at == ' ';
        if (at < stop) {
            buf_add(&r->comments, at, (size_t)(stop - at));
            buf_add_char(&r->comments, '\n');
        }
        at = stop + 1;
    }
}

/* "seed" of "seed 1,2,3 2"; NULL for none. */
static const struct command *command_of(const char *line)
{
    char name[32];
    const size_t n = strcspn(line, " \t");
    if (n >= sizeof name)
        return NULL;
    memcpy(name, line, n);
    name[n] = '\0';
    return command_find(name);
}

/* `auto`, which is a setting, changes nothing by itself. */
static bool is_step(const struct command *command)
{
    return command && command->flags & COMMAND_RECORDED &&
           (command->group == GROUP_WEIGHT || (command->group == GROUP_SEEDS && command->act));
}

static enum err add_record(struct reading *r, const char *bytes, const struct record *record,
                           struct fault *fault)
{
    struct step_list *list = r->list;
    enum err err = tree_add(&r->tree, record, fault);
    gather_comments(r, bytes, record);
    list->records++;
    if (err || !is_step(command_of(record->command)))
        return err;
    if (!mem_grow(&list->step, &list->capacity, list->count + 1, sizeof *list->step))
        return fault_memory(fault, "the steps of a journal");
    const struct tree_node *node = r->tree.node + r->tree.nodes - 1;
    struct step *step = list->step + list->count++;
    *step = (struct step){.record = record->number,
                          .line = record->line,
                          .command = keep_text(list, record->command),
                          .comments = keep_text(list, buf_text(&r->comments)),
                          .fate = node->is_note || node->begins ? STEP_MOVES : STEP_UNDONE};
    buf_clear(&r->comments);
    return OK;
}

/* The way back from the end to the beginning is what stands. */
static void find_fates(struct reading *r)
{
    const struct tree *tree = &r->tree;
    size_t stands = tree->present;
    for (size_t i = r->list->count; i-- > 0;) {
        struct step *step = r->list->step + i;
        while (stands > step->record) /* parents come before */
            stands = tree->node[stands].parent;
        if (step->fate == STEP_MOVES)
            continue;
        if (stands == step->record)
            step->fate = STEP_STANDS;
        else if (tree->node[step->record].branch != tree->on)
            step->fate = STEP_ELSEWHERE;
    }
}

enum err step_list_read(struct step_list *list, const char *bytes, size_t length,
                        struct fault *fault)
{
    struct reading r = {.list = list};
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes, length, fault);
    if (!err)
        err = tree_begin(&r.tree, &walk, fault);
    while (!err && walk_next(&walk, &record) == WALK_RECORD)
        err = add_record(&r, bytes, &record, fault);
    if (!err && (list->text.failed || r.comments.failed))
        err = fault_memory(fault, "the steps of a journal");
    if (!err)
        find_fates(&r);
    walk_release(&walk);
    tree_release(&r.tree);
    buf_release(&r.comments);
    return err;
}

void step_list_release(struct step_list *list)
{
    free(list->step);
    buf_release(&list->text);
    *list = (struct step_list){0};
}

size_t step_list_find(const struct step_list *list, size_t record)
{
    size_t low = 0, high = list->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (list->step[middle].record < record)
            low = middle + 1;
        else
            high = middle;
    }
    return low < list->count && list->step[low].record == record ? low + 1 : 0;
}
