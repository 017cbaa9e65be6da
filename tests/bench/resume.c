/* SPDX-License-Identifier: MIT */
/* Time to resume a long journal. */
#include "journal/journal.h"
#include "tests/bench/bench.h"

#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "command/execute.h"
#include "session/session_inside.h"

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
static enum err make_session(struct interpreter *interp, const char *path, struct fault *fault)
{
    struct buf line = {0};
    struct reply reply = {0};
    uint64_t state = 1;
    enum err err = interpreter_create_journal(interp, path, fault);
    if (!err)
        err = journal_set_sync(interp->journal, FILE_SYNC_OFF, fault);
    if (!err)
        err = interpreter_execute(interp, "open synth:geom:192x192x192", &reply, fault);
    if (!err)
        err = interpreter_execute(interp, "auto on", &reply, fault);
    while (!err && journal_count(interp->journal) < COMMANDS) {
        write_command(&line, &state);
        err = interpreter_execute(interp, buf_text(&line), &reply, fault);
        if (err == ERR_INPUT)
            err = OK;
    }
    reply_release(&reply);
    buf_release(&line);
    return err;
}

static enum err time_resuming(const char *path, uint64_t labels, double *ms, struct fault *fault)
{
    struct interpreter interp;
    enum err err = interpreter_init(&interp, fault);
    interp.is_read_only = true;
    const uint64_t begin = clock_ns();
    if (!err)
        err = interpreter_resume_journal(&interp, path, NULL, fault);
    *ms = (double)(clock_ns() - begin) / 1e6;
    if (!err && forest_label_digest(interp.session->forest) != labels)
        err = fault_set(fault, ERR_CHECK, "the resumed session is another one");
    interpreter_release(&interp);
    return err;
}

static enum err time_all(const char *path, struct bench_resume *f, struct fault *fault)
{
    struct interpreter interp;
    enum err err = interpreter_init(&interp, fault);
    const uint64_t begin = clock_ns();
    if (!err)
        err = make_session(&interp, path, fault);
    f->session_ms = (double)(clock_ns() - begin) / 1e6;
    f->voxels = err ? 0 : interp.session->scene->grid.voxels;
    const uint64_t labels = err ? 0 : forest_label_digest(interp.session->forest);
    interpreter_release(&interp);
    for (int i = 0; !err && i < ROUNDS; i++) {
        double ms;
        err = time_resuming(path, labels, &ms, fault);
        f->resume_ms = i == 0 || ms < f->resume_ms ? ms : f->resume_ms;
    }
    f->commands = COMMANDS;
    return err;
}

enum err bench_resuming(struct bench_resume *figures, struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    enum err err = folder_fresh(&folder, NULL, fault);
    if (err)
        return err;
    buf_printf(&path, "%s/long.iftty", buf_text(&folder));
    err = path.failed ? fault_memory(fault, "a path") : time_all(buf_text(&path), figures, fault);
    folder_remove(buf_text(&folder));
    buf_release(&folder);
    buf_release(&path);
    return err;
}
