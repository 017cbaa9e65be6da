/* SPDX-License-Identifier: MIT */
/* Time to resume a long journal. */
#include "journal/journal.h"
#include "tests/bench/bench.h"

#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "command/execute.h"
#include "session/session_inside.h"
#include "tests/bench/times.h"

enum { COMMANDS = 2000, ROUNDS = 3 };

/* A generator of our own (a linear congruence): the same commands everywhere. */
static uint32_t draw(uint64_t *state, uint32_t bound)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)((*state >> 32) * bound >> 32);
}

/* Mostly seeds, some eliminators, and what else a session has. */
static void write_command(struct buf *line, uint64_t *state)
{
    static const char *const other[] = {"undo 1", "turn 5 3", "render mode=ii", "hide 2", "show 2"};
    const uint32_t kind = draw(state, 100);
    const uint32_t x = draw(state, 192), y = draw(state, 192), z = draw(state, 192);
    buf_clear(line);
    if (kind < 65)
        buf_printf(line, "seed %u,%u,%u %u", x, y, z, draw(state, 6));
    else if (kind < 80)
        buf_printf(line, "remove %u,%u,%u", x, y, z);
    else
        buf_add_text(line, other[draw(state, sizeof other / sizeof other[0])]);
}

/* Record COMMANDS commands; commands that fail (nothing to undo, no tree there) do not count. */
static void make_session(struct interpreter *interp, const char *path)
{
    OWNED(buf_release) struct buf line = {0};
    OWNED(reply_release) struct reply reply = {0};
    uint64_t state = 1;
    must(interpreter_create_journal(interp, path, &bench_fault));
    must(journal_set_sync(interp->journal, FILE_SYNC_OFF, &bench_fault));
    must(interpreter_execute(interp, "open synth:geom:192x192x192", &reply, &bench_fault));
    must(interpreter_execute(interp, "auto on", &reply, &bench_fault));
    while (journal_count(interp->journal) < COMMANDS) {
        write_command(&line, &state);
        const enum err err = interpreter_execute(interp, buf_text(&line), &reply, &bench_fault);
        must(err == ERR_INPUT ? OK : err);
    }
}

static double time_resuming(const char *path, uint64_t labels)
{
    OWNED(interpreter_release) struct interpreter interp;
    must(interpreter_init(&interp, &bench_fault));
    interp.is_read_only = true;
    const uint64_t begin = clock_ns();
    must(interpreter_resume_journal(&interp, path, NULL, &bench_fault));
    const double ms = times_since(begin);
    if (forest_label_digest(interp.session->forest) != labels)
        must(fault_set(&bench_fault, ERR_CHECK, "the resumed session is another one"));
    return ms;
}

struct bench_resume bench_resuming(void)
{
    struct bench_resume f = {.commands = COMMANDS};
    struct interpreter interp;
    OWNED(buf_release) struct buf path = {0};
    buf_printf(&path, "%s/long.iftty", bench_folder(NULL));
    must(interpreter_init(&interp, &bench_fault));
    const uint64_t begin = clock_ns();
    make_session(&interp, buf_text(&path));
    f.session_ms = times_since(begin);
    f.voxels = interp.session->scene->grid.voxels;
    const uint64_t labels = forest_label_digest(interp.session->forest);
    interpreter_release(&interp);
    for (int i = 0; i < ROUNDS; i++) {
        const double ms = time_resuming(buf_text(&path), labels);
        f.resume_ms = i == 0 || ms < f.resume_ms ? ms : f.resume_ms;
    }
    return f;
}
