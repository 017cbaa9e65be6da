/* SPDX-License-Identifier: MIT */
/* `iftty tutorial`: a session at prompt and pilot, with a lesson beside it. */
#include <unistd.h>

#include "program/programs.h"

enum err run_tutorial(const struct options *o, struct fault *fault)
{
    struct lesson lesson = {0};
    struct interpreter interp;
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO))
        return fault_set(fault, ERR_USAGE, "the lesson takes a terminal");
    enum err err = interpreter_init(&interp, fault);
    if (!err)
        err = lesson_find(&interp, fault);
    interpreter_release(&interp);
    if (!err)
        err = prompt_run(o, &lesson, fault);
    lesson_release(&lesson);
    return err;
}
