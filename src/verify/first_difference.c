#include "verify/first_difference.h"

#include <string.h>

#include "base/scan.h"
#include "command/command.h"
#include "journal/walk.h"

/* A walk through one of the two, and the command it has come to. */
struct follower {
    struct walk walk;
    struct record record;
    bool goes_on;
    struct buf words; /* each ended by NUL */
};

/* The words of a command; one that cannot be parsed is one word. */
static void take_words(struct buf *words, const char *command)
{
    buf_clear(words);
    for (const char *at = command; scan_blanks(&at), *at;)
        if (!command_take_word(&at, words)) {
            buf_clear(words);
            buf_add(words, command, strlen(command) + 1);
            return;
        }
}

static bool is_recorded(const struct follower *f)
{
    const struct command *command =
        f->walk.is_journal || !f->words.length ? NULL : command_find(buf_text(&f->words));
    return !command || (command->flags & COMMAND_RECORDED);
}

static enum err step(struct follower *f, const char *name, size_t last, struct fault *fault)
{
    do {
        f->goes_on =
            walk_next(&f->walk, &f->record) == WALK_RECORD && (!last || f->record.number <= last);
        if (f->goes_on)
            take_words(&f->words, f->record.command);
    } while (f->goes_on && !is_recorded(f));
    if (f->words.failed)
        return fault_memory(fault, "a command");
    return f->walk.over == WALK_DAMAGED
               ? fault_set(fault, ERR_INPUT, "%s: %s", name, f->walk.fault.text)
               : OK;
}

static bool are_same(const struct follower f[2])
{
    return f[0].goes_on && f[1].goes_on && f[0].words.length == f[1].words.length &&
           memcmp(buf_text(&f[0].words), buf_text(&f[1].words), f[0].words.length) == 0;
}

static enum err note(struct first_difference *first, const struct follower f[2],
                     struct fault *fault)
{
    first->is_there = f[0].goes_on || f[1].goes_on;
    for (int i = 0; i < 2; i++) {
        first->side[i].goes_on = f[i].goes_on;
        if (!f[i].goes_on)
            continue;
        first->side[i].number = f[i].record.number;
        first->side[i].line = f[i].record.line;
        buf_add_text(&first->side[i].command, f[i].record.command);
        if (first->side[i].command.failed)
            return fault_memory(fault, "a command");
    }
    return OK;
}

static enum err follow(struct first_difference *first, struct follower f[2],
                       const char *const name[2], size_t last, struct fault *fault)
{
    for (;; first->same++) {
        enum err err = step(f, name[0], last, fault);
        if (!err)
            err = step(f + 1, name[1], last, fault);
        if (err)
            return err;
        if (!are_same(f))
            return note(first, f, fault);
    }
}

enum err first_difference_find(struct first_difference *first, const char *const name[2],
                               const struct buf bytes[2], size_t last, struct fault *fault)
{
    struct follower f[2] = {{.goes_on = false}, {.goes_on = false}};
    int begun = 0;
    enum err err = OK;
    for (; !err && begun < 2; begun += !err) {
        err = walk_begin(&f[begun].walk, buf_text(bytes + begun), bytes[begun].length,
                         WALK_AS_FOUND, fault);
        if (err)
            fault_prefix(fault, err, "%s", name[begun]);
    }
    if (!err)
        err = follow(first, f, name, last, fault);
    for (int i = 0; i < begun; i++)
        walk_release(&f[i].walk);
    buf_release(&f[0].words);
    buf_release(&f[1].words);
    return err;
}

void first_difference_release(struct first_difference *first)
{
    buf_release(&first->side[0].command);
    buf_release(&first->side[1].command);
}
