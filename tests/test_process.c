/* SPDX-License-Identifier: MIT */
/* Work in child processes: its output, its order, and processes that die, write too much, or do not
 * end. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "verify/process.h"
#include "tests/check.h"

/* ---- work ---- */

static void say_much(void *context, size_t number, struct buf *out)
{
    const size_t *bytes = context;
    (void)number;
    for (size_t i = 0; i < *bytes; i++)
        buf_add_char(out, (char)(i * 7));
}

static void die(void *context, size_t number, struct buf *out)
{
    (void)context;
    (void)number;
    buf_add_text(out, "half");
    raise(SIGKILL);
}

static void wait_without_end(void *context, size_t number, struct buf *out)
{
    (void)context;
    (void)number;
    (void)out;
    for (;;)
        pause();
}

/* Close everything, and do not end. */
static void close_all_and_wait(void *context, size_t number, struct buf *out)
{
    for (int i = 3; i < 256; i++)
        close(i);
    wait_without_end(context, number, out);
}

/* Leave a child that holds the pipe for a while. */
static void leave_child(void *context, size_t number, struct buf *out)
{
    (void)context;
    (void)number;
    buf_add_text(out, "all");
    if (fork() == 0) {
        for (int i = 0; i < 3; i++)
            close(i);
        alarm(61);
        pause();
    }
}

/* Later pieces of work end earlier. */
static void say_number(void *context, size_t number, struct buf *out)
{
    (void)context;
    usleep(number < 4 ? 1000 * (unsigned)(40 - 10 * number) : 0);
    buf_printf(out, "piece %zu", number);
    if (number == 2)
        abort();
}

static bool poll_and_stop(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)what;
    (void)done;
    (void)total;
    return ++*(int *)context > 2;
}

/* ---- one ---- */

STORY(a_process_hands_back_what_was_made_elsewhere)
{
    size_t bytes = 3000000;
    OWNED(buf_release) struct buf out = {0}, expected = {0};
    const struct processes how = {.work = say_much, .context = &bytes, .most = 4000000};
    CHECK(process_run(&out, &how, NULL) == OK);
    say_much(&bytes, 0, &expected);
    CHECK(out.length == expected.length && memcmp(out.data, expected.data, out.length) == 0);
    bytes = 0;
    CHECK(process_run(&out, &how, NULL) == OK);
    CHECK_INT(out.length, 0);
}

STORY(a_process_that_dies_or_says_too_much_is_an_error)
{
    size_t bytes = 3000000;
    OWNED(buf_release) struct buf out = {0};
    struct fault why = {0};
    CHECK(process_run(&out, &(struct processes){.work = die, .most = 100}, &why) == ERR_INPUT);
    CHECK_HAS(why.text, "ended by signal 9 (Killed)");
    const struct processes much = {.work = say_much, .context = &bytes, .most = 2000000};
    CHECK(process_run(&out, &much, &why) == ERR_INPUT);
    CHECK_HAS(why.text, "more than it may");
}

STORY(a_process_that_does_not_end_is_ended_by_the_watch)
{
    int polls = 0;
    struct watch watch = {.context = &polls, .poll = poll_and_stop};
    OWNED(buf_release) struct buf out = {0};
    struct processes how = {.work = wait_without_end, .most = 1, .watch = &watch};
    CHECK(process_run(&out, &how, NULL) == ERR_CANCELLED);
    polls = 0;
    watch_begin(&watch);
    how.work = close_all_and_wait;
    CHECK(process_run(&out, &how, NULL) == ERR_CANCELLED);
    CHECK(waitpid(-1, NULL, WNOHANG) == -1 && errno == ECHILD); /* P3 */
}

STORY(the_end_of_a_process_counts_though_another_holds_its_pipe)
{
    OWNED(buf_release) struct buf out = {0};
    alarm(60); /* the child lives longer */
    CHECK(process_run(&out, &(struct processes){.work = leave_child, .most = 100}, NULL) == OK);
    alarm(0);
    CHECK_TEXT(buf_text(&out), "all");
}

/* ---- several ---- */

struct log {
    struct buf text;
    int status[16];
    size_t count;
};

static void note(void *context, size_t number, const struct process_end *end)
{
    struct log *log = context;
    buf_add_text(&log->text, buf_text(&end->bytes));
    buf_add_text(&log->text, "\n");
    log->status[number] = end->status;
    log->count++;
}

STORY(each_piece_of_work_is_done_once)
{
    for (unsigned at_once = 1; at_once <= PROCESSES_MOST; at_once *= 4) {
        struct log log = {.count = 0};
        const struct processes how = {.count = 16,
                                      .at_once = at_once,
                                      .most = 100,
                                      .context = &log,
                                      .work = say_number,
                                      .done = note};
        CHECK(processes_run(&how, NULL) == OK);
        CHECK_INT(log.count, 16);
        for (int i = 0; i < 16; i++) {
            char piece[16];
            snprintf(piece, sizeof piece, "piece %d\n", i);
            if (i == 2)
                CHECK(WIFSIGNALED(log.status[i]) && WTERMSIG(log.status[i]) == SIGABRT);
            else
                CHECK_HAS(buf_text(&log.text), piece);
        }
        if (at_once == 1)
            CHECK_HAS(buf_text(&log.text), "piece 0\npiece 1\n\npiece 3\npiece 4\n");
        buf_release(&log.text);
    }
}

static bool note_progress(void *context, const char *what, uint64_t done, uint64_t total)
{
    struct buf *text = context;
    char line[64];
    snprintf(line, sizeof line, "%s %llu of %llu\n", what ? what : "", (unsigned long long)done,
             (unsigned long long)total);
    if (!strstr(buf_text(text), line))
        buf_add_text(text, line);
    return false;
}

STORY(a_watch_is_shown_what_is_done_and_how_far_it_is)
{
    struct log log = {.count = 0};
    OWNED(buf_release) struct buf seen = {0}, out = {0};
    struct watch watch = {.context = &seen, .poll = note_progress};
    size_t bytes = 10;
    struct processes how = {.count = 2,
                            .at_once = 1,
                            .most = 100,
                            .context = &log,
                            .work = say_number,
                            .done = note,
                            .watch = &watch,
                            .what = "counting"};
    CHECK(processes_run(&how, NULL) == OK);
    CHECK_HAS(buf_text(&seen), "counting 0 of 2\ncounting 1 of 2\n");
    buf_clear(&seen);
    how.context = &bytes;
    how.work = say_much;
    CHECK(process_run(&out, &how, NULL) == OK);
    CHECK_TEXT(buf_text(&seen), "counting 0 of 0\n"); /* one process has no progress of its own */
    buf_release(&log.text);
}

int main(void)
{
    alarm(60); /* a pool that hangs fails */
    return check_run();
}
