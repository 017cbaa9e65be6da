/* `iftty log`: a journal as text, in several forms, and its repair. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "journal/graph.h"
#include "journal/journal.h"
#include "journal/walk.h"
#include "program/anonymise.h"
#include "program/console.h"
#include "program/programs.h"
#include "program/provenance.h"
#include "session/semantics.h"
#include "tui/cells.h"
#include "tui/term.h"
#include "verify/signature.h"

static enum err read_journal(struct buf *bytes, const struct options *o, struct fault *fault)
{
    return file_read(bytes, o->word[0], JOURNAL_BYTES_MAX, fault);
}

/* Line by line, without what a terminal would obey. */
static void print_safe(const struct buf *text)
{
    struct buf line = {0};
    for (const char *at = buf_text(text), *end = at + text->length; at < end;) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const size_t n = feed ? (size_t)(feed - at) : (size_t)(end - at);
        buf_clear(&line);
        buf_add_safe(&line, at, n);
        puts(buf_text(&line));
        at += n + 1;
    }
    buf_release(&line);
}

/* What `write` makes of a journal, printed also where it ends with an error. */
static enum err print_written(enum err (*write)(struct buf *out, const char *bytes, size_t length,
                                                struct fault *fault),
                              const struct options *o, struct fault *fault)
{
    struct buf bytes = {0}, text = {0};
    enum err err = read_journal(&bytes, o, fault);
    if (!err)
        err = write(&text, buf_text(&bytes), bytes.length, fault);
    if (err && bytes.length)
        fault_prefix(fault, err, "%s", o->word[0]);
    if (!err && text.failed)
        err = fault_memory(fault, "what a journal says");
    print_safe(&text);
    buf_release(&text);
    buf_release(&bytes);
    return err;
}

/* As it is, intact or not; a scene that was meant to be opened is no text. */
static enum err copy(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    struct walk walk;
    const enum err err = walk_begin(&walk, bytes, length, fault);
    walk_release(&walk);
    if (err && !walk.is_journal)
        return err;
    buf_add(out, bytes, length);
    return OK;
}

enum err run_log(const struct options *o, struct fault *fault)
{
    return print_written(copy, o, fault);
}

enum err run_log_script(const struct options *o, struct fault *fault)
{
    return print_written(journal_script, o, fault);
}

enum err run_log_anonymise(const struct options *o, struct fault *fault)
{
    return print_written(anonymise_script, o, fault);
}

static enum err check(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    struct journal_condition condition;
    const enum err err = journal_check(&condition, bytes, length, fault);
    if (!err)
        buf_printf(out, "%s\n", condition.text);
    return err;
}

enum err run_log_check(const struct options *o, struct fault *fault)
{
    return print_written(check, o, fault);
}

/* At a terminal no wider than it is, with lines where the locale has them. */
static enum err draw_graph(struct buf *out, const char *bytes, size_t length, struct fault *fault)
{
    const bool is_terminal = isatty(STDOUT_FILENO);
    struct buf drawn = {0};
    const enum err err = graph_draw(&drawn, bytes, length, is_terminal && locale_is_utf8(), fault);
    if (!err)
        cells_crop(out, buf_text(&drawn), is_terminal ? term_columns(STDOUT_FILENO) : 0);
    buf_release(&drawn);
    return err;
}

enum err run_log_graph(const struct options *o, struct fault *fault)
{
    return print_written(draw_graph, o, fault);
}

enum err run_log_export(const struct options *o, struct fault *fault)
{
    struct buf bytes = {0}, text = {0};
    enum err err = read_journal(&bytes, o, fault);
    if (!err)
        err = provenance_write(&text, file_name(o->word[0]), buf_text(&bytes), bytes.length,
                               o->anonymise, fault);
    if (!err && strcmp(o->export, "-") == 0)
        fputs(buf_text(&text), stdout);
    else if (!err)
        err = file_write(o->export, text.data, text.length, FILE_KEEP, fault);
    buf_release(&text);
    buf_release(&bytes);
    return err;
}

enum err run_log_repair(const struct options *o, struct fault *fault)
{
    struct buf lines = {0};
    const enum err err = journal_repair(o->word[0], SEMANTICS, &lines, fault);
    if (!err)
        puts(buf_text(&lines));
    buf_release(&lines);
    return err;
}

/* ---- signing ---- */

/* Only what is intact is worth a signature. */
static enum err check_intact(const struct buf *bytes, struct journal_condition *condition,
                             struct fault *fault)
{
    const enum err err = journal_check(condition, buf_text(bytes), bytes->length, fault);
    if (err)
        return fault_prefix(fault, err, "only an intact journal is signed");
    return condition->state == JOURNAL_INTACT
               ? OK
               : fault_set(fault, ERR_CHECK, "this is a script, not a journal, and was not signed");
}

enum err run_log_sign(const struct options *o, struct fault *fault)
{
    struct buf bytes = {0}, line = {0};
    struct journal_condition condition;
    enum err err = read_journal(&bytes, o, fault);
    console_handle_interrupts();
    if (!err)
        err = check_intact(&bytes, &condition, fault);
    if (!err)
        err = signature_make(o->word[0], &bytes, o->sign, console_watch(), fault);
    if (!err) {
        buf_add_safe_text(&line, o->word[0]);
        printf("# %s.sig signs %zu record%s, chain %s\n", buf_text(&line), condition.records,
               plural(condition.records), condition.chain.hex);
    }
    buf_release(&line);
    buf_release(&bytes);
    return err;
}
