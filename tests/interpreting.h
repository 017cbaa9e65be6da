/* SPDX-License-Identifier: MIT */
/*
 * Helpers for stories with an interpreter: lines are executed as at the prompt, with the image
 * helper built for the tests.
 *
 * `reply` and `fault` belong to the last line; main releases `reply` at the end.
 */
#ifndef TESTS_INTERPRETING_H
#define TESTS_INTERPRETING_H

#include <limits.h>
#include <unistd.h>

#include "command/execute.h"
#include "image/image_helper.h"
#include "session/session_inside.h"
#include "session/setting.h"
#include "show/draw.h"
#include "verify/replay_file.h"
#include "tests/check.h"

static struct reply reply;
static struct fault fault;

/* It has no padding (session/state.h). */
static inline bool outlook_equals(const struct outlook *a, const struct outlook *b)
{
    return memcmp(a, b, offsetof(struct outlook, shows_finished) + sizeof a->shows_finished) == 0;
}

static inline enum err execute(struct interpreter *interp, const char *line)
{
    fault = (struct fault){.text = ""};
    return interpreter_execute(interp, line, &reply, &fault);
}

static inline void must(struct interpreter *interp, const char *line)
{
    if (!CHECK(execute(interp, line) == OK))
        printf("#   %s: %s\n", line, fault.text);
}

/* Execute a line and check that the answer is the text, or contains it. */
#define MUST_ANSWER(interp, line, expected)                                                        \
    do {                                                                                           \
        must(interp, line);                                                                        \
        CHECK_TEXT(buf_text(&reply.text), expected);                                               \
    } while (0)
#define MUST_MENTION(interp, line, part)                                                           \
    do {                                                                                           \
        must(interp, line);                                                                        \
        CHECK_HAS(buf_text(&reply.text), part);                                                    \
    } while (0)

/* Return the path of the helper, above the folder of the test programs. Static storage. */
static inline const char *helper_program(void)
{
    static char program[PATH_MAX];
    ssize_t n = readlink("/proc/self/exe", program, sizeof program - 32);
    CHECK(n > 0);
    program[n > 0 ? n : 0] = '\0';
    for (int up = 0; up < 2 && strrchr(program, '/'); up++)
        *strrchr(program, '/') = '\0';
    return strcat(program, "/iftty-image");
}

/* Begin an interpreter with that helper; the caller releases it. */
static inline void begin_interpreter(struct interpreter *interp)
{
    CHECK(interpreter_init(interp, NULL) == OK);
    image_helper_free(interp->helper);
    CHECK(image_helper_new(&interp->helper, helper_program(), NULL) == OK);
}

#endif
