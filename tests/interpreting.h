/* SPDX-License-Identifier: MIT */
/* Helpers for stories with an interpreter: lines are executed as at the prompt, with the image
 * helper built for the tests.
 *
 * `reply` and `fault` belong to the last line; main releases `reply` at the end. */
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

/* Copy the next of the lines "LINE; LINE; ..." at *lines and advance; false at the end. */
static inline bool next_line(struct buf *line, const char **lines)
{
    const char *end = strstr(*lines, "; ");
    buf_clear(line);
    buf_add(line, *lines, end ? (size_t)(end - *lines) : strlen(*lines));
    *lines += line->length + (end ? 2 : 0);
    return line->length > 0;
}

/* Execute lines, with "; " between them. */
static inline void must(struct interpreter *interp, const char *lines)
{
    OWNED(buf_release) struct buf line = {0};
    while (next_line(&line, &lines))
        CHECK_WITH(execute(interp, buf_text(&line)) == OK, "%s: %s", buf_text(&line), fault.text);
}

/* Execute lines and check that the answer to the last one is the text, or contains it. */
#define MUST_ANSWER(interp, lines, expected)                                                       \
    do {                                                                                           \
        must(interp, lines);                                                                       \
        CHECK_TEXT(buf_text(&reply.text), expected);                                               \
    } while (0)
#define MUST_MENTION(interp, lines, part)                                                          \
    do {                                                                                           \
        must(interp, lines);                                                                       \
        CHECK_HAS(buf_text(&reply.text), part);                                                    \
    } while (0)
/* Execute lines and check that the record of the last one contains the text. */
#define MUST_RECORD(interp, lines, part)                                                           \
    do {                                                                                           \
        must(interp, lines);                                                                       \
        CHECK_HAS(buf_text(&reply.words), part);                                                   \
    } while (0)
/* Check that a line fails with this code and a message that contains the text. */
#define MUST_FAIL(interp, line, code, part)                                                        \
    do {                                                                                           \
        CHECK_INT(execute(interp, line), code);                                                    \
        CHECK_HAS(fault.text, part);                                                               \
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

/* Define a story whose `interp` is begun by begin(interp), and released at the end. */
#define BEGUN_STORY(told, begin)                                                                   \
    static void told_##told(struct interpreter *interp);                                           \
    STORY(told)                                                                                    \
    {                                                                                              \
        struct interpreter begun;                                                                  \
        begin(&begun);                                                                             \
        told_##told(&begun);                                                                       \
        interpreter_release(&begun);                                                               \
    }                                                                                              \
    static void told_##told(struct interpreter *interp)

#endif
