/* SPDX-License-Identifier: MIT */
#include "verify/bisect.h"

#include "command/command.h"
#include "verify/first_difference.h"
#include "verify/replay_file.h"

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

enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault)
{
    const char *const path[2] = {a, b};
    struct first_difference first = {0};
    struct buf text = {0};
    enum err err = first_difference_of_files(&first, FIRST_RECORD, path, path, 0, fault);
    if (!err) {
        buf_printf(&text, "%s 1 - ", first.is_there ? "not ok" : "ok");
        buf_add_safe_text(&text, a);
        buf_add_text(&text, " and ");
        buf_add_safe_text(&text, b);
        buf_printf(&text, " (%zu record%s the same)\n", first.same, plural(first.same));
        const struct buf *one = &first.side[0].command, *other = &first.side[1].command;
        const bool are_there = first.side[0].goes_on && first.side[1].goes_on;
        const bool is_result = are_there && command_is_same(buf_text(one), buf_text(other));
        if (first.is_there) {
            buf_printf(&text, "# record %zu is the first that differs: %s\n", first.same + 1,
                       is_result    ? "the same command gives another result"
                       : !are_there ? "only one of the two goes on"
                                    : "another command stands there");
            write_place(&text, &first, 0, a);
            write_place(&text, &first, 1, b);
        }
        if (is_result)
            divergence_describe(&text, buf_text(&first.side[0].result),
                                buf_text(&first.side[1].result), DIVERGENCE_OF_JOURNALS);
        buf_add_text(&text, "1..1\n");
        err = text.failed ? fault_memory(fault, "a report") : OK;
    }
    if (!err)
        printer->print(printer->context, buf_text(&text));
    if (!err && first.is_there)
        err = fault_set(fault, ERR_CHECK, "record %zu is the first that differs", first.same + 1);
    buf_release(&text);
    first_difference_release(&first);
    return err;
}
