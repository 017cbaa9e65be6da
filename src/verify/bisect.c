#include "verify/bisect.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "verify/builds.h"
#include "verify/divergence.h"
#include "journal/journal.h"
#include "journal/walk.h"

/* A record: places in the texts of its journal. */
struct entry {
    size_t command, result, line;
    struct record_chain chain;
};

struct listed {
    const char *name;
    struct entry *entry;
    size_t count, capacity;
    struct buf texts; /* commands and results, each ended by NUL */
};

static void listed_release(struct listed *listed)
{
    free(listed->entry);
    buf_release(&listed->texts);
}

static enum err add_entry(struct listed *l, const struct record *record, struct fault *fault)
{
    if (!mem_grow(&l->entry, &l->capacity, l->count + 1, sizeof *l->entry))
        return fault_memory(fault, "the records of a journal");
    struct entry *entry = l->entry + l->count++;
    *entry = (struct entry){.line = record->line, .chain = record->chain};
    entry->command = l->texts.length;
    buf_add(&l->texts, record->command, strlen(record->command) + 1);
    entry->result = l->texts.length;
    buf_add(&l->texts, record->result, strlen(record->result) + 1);
    return l->texts.failed ? fault_memory(fault, "the records of a journal") : OK;
}

static enum err list(struct listed *l, const struct buf *bytes, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, buf_text(bytes), bytes->length, WALK_AS_FOUND, fault);
    if (err)
        return fault_prefix(fault, err, "%s", l->name);
    if (!walk.is_journal)
        err = fault_set(fault, ERR_INPUT, "%s is a script, not a journal: it has no results",
                        l->name);
    while (!err && walk_next_sound(&walk, &record) == WALK_RECORD)
        err = add_entry(l, &record, fault);
    if (!err && walk.over == WALK_DAMAGED)
        err = fault_set(fault, ERR_INPUT, "%s: %s", l->name, walk.fault.text);
    walk_release(&walk);
    return err;
}

static const char *command_of(const struct listed *l, size_t i)
{
    return buf_text(&l->texts) + l->entry[i].command;
}

static const char *result_of(const struct listed *l, size_t i)
{
    return buf_text(&l->texts) + l->entry[i].result;
}

/* The first of `both` records, from 0, whose chains differ, or `both`. */
static size_t search(const struct listed l[2], size_t both, size_t *compared)
{
    size_t low = 0, high = both; /* before low all are the same; high differs, or is the end */
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const struct record_chain *a = &l[0].entry[middle].chain, *b = &l[1].entry[middle].chain;
        ++*compared;
        if (strcmp(a->hex, b->hex) == 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool records_are_same(const struct listed l[2], size_t i)
{
    return strcmp(command_of(l, i), command_of(l + 1, i)) == 0 &&
           strcmp(result_of(l, i), result_of(l + 1, i)) == 0;
}

static void write_place(struct buf *lines, const struct listed *l, size_t i)
{
    buf_add_text(lines, "#   in       ");
    buf_add_safe(lines, l->name, strlen(l->name));
    if (i < l->count) {
        buf_printf(lines, ", line %zu: ", l->entry[i].line);
        buf_add_safe(lines, command_of(l, i), strlen(command_of(l, i)));
    } else {
        buf_printf(lines, ": it ends with record %zu", l->count);
    }
    buf_add_char(lines, '\n');
}

static void describe(struct buf *lines, const struct listed l[2], size_t i)
{
    const bool are_there = i < l[0].count && i < l[1].count;
    const bool is_result = are_there && strcmp(command_of(l, i), command_of(l + 1, i)) == 0;
    buf_printf(lines, "# record %zu is the first that differs: %s\n", i + 1,
               is_result    ? "the same command gives another result"
               : !are_there ? "only one of the two goes on"
                            : "another command stands there");
    write_place(lines, l, i);
    write_place(lines, l + 1, i);
    if (is_result)
        divergence_describe(lines, result_of(l, i), result_of(l + 1, i), DIVERGENCE_OF_JOURNALS);
}

enum err bisect_bytes(struct bisection *out, const char *const name[2], const struct buf bytes[2],
                      struct fault *fault)
{
    struct listed l[2] = {{.name = name[0]}, {.name = name[1]}};
    *out = (struct bisection){0};
    enum err err = list(l, bytes, fault);
    if (!err)
        err = list(l + 1, bytes + 1, fault);
    if (!err) {
        const size_t both = l[0].count < l[1].count ? l[0].count : l[1].count;
        const size_t most = l[0].count + l[1].count - both;
        size_t i = search(l, both, &out->compared);
        while (i < both && records_are_same(l, i))
            i++;
        out->records = both;
        out->number = i < most ? i + 1 : 0;
        if (out->number)
            describe(&out->lines, l, i);
        if (out->lines.failed)
            err = fault_memory(fault, "a report");
    }
    listed_release(l);
    listed_release(l + 1);
    return err;
}

void bisection_release(struct bisection *bisection)
{
    buf_release(&bisection->lines);
}

/* ---- the report ---- */

static enum err print_outcome(const struct bisection *found, const char *const name[2],
                              const struct printer *printer, struct fault *fault)
{
    struct buf text = {0};
    buf_printf(&text, "%s 1 - ", found->number ? "not ok" : "ok");
    buf_add_safe(&text, name[0], strlen(name[0]));
    buf_add_text(&text, " and ");
    buf_add_safe(&text, name[1], strlen(name[1]));
    buf_printf(&text, " (%zu chains of %zu compared)\n", found->compared, found->records);
    buf_add_text(&text, buf_text(&found->lines));
    buf_add_text(&text, "1..1\n");
    printer->print(printer->context, buf_text(&text));
    buf_release(&text);
    return found->number
               ? fault_set(fault, ERR_CHECK, "record %zu is the first that differs", found->number)
               : OK;
}

static enum err compare(const char *const path[2], const char *const name[2],
                        const char *const more[2], const struct printer *printer,
                        struct fault *fault)
{
    struct buf bytes[2] = {{0}, {0}};
    struct bisection found = {0};
    enum err err = file_read(bytes, path[0], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = file_read(bytes + 1, path[1], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = bisect_bytes(&found, name, bytes, fault);
    if (!err && !found.number && *more[0] && *more[1]) {
        printer->print(printer->context, more[0]);
        printer->print(printer->context, more[1]);
        err = fault_set(fault, ERR_INPUT, "neither build carries out what follows record %zu",
                        found.records);
    }
    for (int i = 0; !err && i < 2; i++)
        buf_add_text(&found.lines, more[i]);
    if (!err)
        err = print_outcome(&found, name, printer, fault);
    bisection_release(&found);
    buf_release(bytes);
    buf_release(bytes + 1);
    return err;
}

enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault)
{
    const char *const path[2] = {a, b}, *const more[2] = {"", ""};
    return compare(path, path, more, printer, fault);
}

enum err bisect_builds(const struct bisect_builds *how, const struct printer *printer,
                       struct fault *fault)
{
    struct builds builds;
    enum err err = builds_run(&builds, how, fault);
    if (!err) {
        const char *const path[2] = {buf_text(&builds.side[0].journal),
                                     buf_text(&builds.side[1].journal)};
        const char *const name[2] = {"this build", how->other};
        const char *const more[2] = {buf_text(&builds.side[0].words),
                                     buf_text(&builds.side[1].words)};
        err = compare(path, name, more, printer, fault);
    }
    builds_release(&builds);
    return err;
}
