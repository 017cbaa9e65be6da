#include "verify/bisect.h"

#include <string.h>

#include "verify/builds.h"
#include "verify/divergence.h"
#include "verify/first_difference.h"

static void write_place(struct buf *text, const struct first_difference *first, int which,
                        const char *name)
{
    buf_add_text(text, "#   in       ");
    buf_add_safe_text(text, name);
    if (first->side[which].goes_on) {
        buf_printf(text, ", line %zu: ", first->side[which].line);
        buf_add_safe_text(text, buf_text(&first->side[which].command));
    } else {
        buf_printf(text, ": it ends with record %zu", first->same);
    }
    buf_add_char(text, '\n');
}

static void describe(struct buf *text, const struct first_difference *first,
                     const char *const name[2])
{
    const bool are_there = first->side[0].goes_on && first->side[1].goes_on;
    const bool is_result = are_there && strcmp(buf_text(&first->side[0].command),
                                               buf_text(&first->side[1].command)) == 0;
    buf_printf(text, "# record %zu is the first that differs: %s\n", first->same + 1,
               is_result    ? "the same command gives another result"
               : !are_there ? "only one of the two goes on"
                            : "another command stands there");
    write_place(text, first, 0, name[0]);
    write_place(text, first, 1, name[1]);
    if (is_result)
        divergence_describe(text, buf_text(&first->side[0].result),
                            buf_text(&first->side[1].result), DIVERGENCE_OF_JOURNALS);
}

/* `more`: lines to be printed after those of a difference, of each. */
static enum err print_outcome(const struct first_difference *first, const char *const name[2],
                              const char *const more[2], const struct printer *printer,
                              struct fault *fault)
{
    struct buf text = {0};
    buf_printf(&text, "%s 1 - ", first->is_there ? "not ok" : "ok");
    buf_add_safe_text(&text, name[0]);
    buf_add_text(&text, " and ");
    buf_add_safe_text(&text, name[1]);
    buf_printf(&text, " (%zu record%s the same)\n", first->same, plural(first->same));
    if (first->is_there)
        describe(&text, first, name);
    buf_printf(&text, "%s%s1..1\n", more[0], more[1]);
    const enum err err = text.failed ? fault_memory(fault, "a report") : OK;
    if (!err)
        printer->print(printer->context, buf_text(&text));
    buf_release(&text);
    return err || !first->is_there
               ? err
               : fault_set(fault, ERR_CHECK, "record %zu is the first that differs",
                           first->same + 1);
}

static enum err compare(const char *const path[2], const char *const name[2],
                        const char *const more[2], const struct printer *printer,
                        struct fault *fault)
{
    struct first_difference first = {0};
    enum err err = first_difference_of_files(&first, FIRST_RECORD, name, path, 0, fault);
    if (!err && !first.is_there && *more[0] && *more[1]) {
        printer->print(printer->context, more[0]);
        printer->print(printer->context, more[1]);
        err = fault_set(fault, ERR_INPUT, "neither build carries out what follows record %zu",
                        first.same);
    }
    if (!err)
        err = print_outcome(&first, name, more, printer, fault);
    first_difference_release(&first);
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
