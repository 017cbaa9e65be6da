/* SPDX-License-Identifier: MIT */
/* kill -9 at random moments of the real program, under load: whatever it acknowledged is in the
 * journal, which goes on where it was.
 *
 * Commands are fed as fast as the program takes them, golden images, maps and renditions too; two
 * sessions are at work at a time, so that they are in each other's way. Each round kills one at a
 * random moment, compares what it said with what its journal holds, and goes on in the same
 * journal, now and then in a new one; the way of syncing changes from round to round.
 * IFTTY_TEST_SCALE=10 makes 500 rounds of 25. */
#include <fcntl.h>
#include <poll.h>
#include <signal.h>

#include "base/buf.h"
#include "base/clock.h"
#include "base/file.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "tests/check.h"
#include "tests/folder.h"
#include "tests/orphans.h"

enum { VICTIMS = 2, NEW_AFTER = 6 };

static char folder[FOLDER_LENGTH], program[512];
static uint64_t dice = 20060101;

struct victim {
    pid_t process;
    int input, output;
    char journal[FILE_LENGTH];
    unsigned rounds; /* with this journal */
    size_t before;   /* records that were in it */
    size_t fed;      /* commands, in this round */
    struct buf waits, said;
};

/* Command n of a round; every one is another. A journal that is resumed has its scene. */
static void write_command(struct buf *out, size_t n, size_t salt, bool has_scene)
{
    static const char *const first[] = {"open synth:geom:16x16x16", "auto on"};
    static const char *const sync[] = {"sync always", "sync everysec", "sync off"};
    if (n == 0)
        buf_printf(out, "%s\n", sync[salt % 3]);
    else if (n <= 2 && has_scene)
        buf_add_text(out, "info\n");
    else if (n <= 2)
        buf_printf(out, "%s\n", first[n - 1]);
    else if (n == 3)
        buf_add_text(out, "size 32 32\n");
    else if (n % 23 == 0)
        buf_printf(out, "golden g%zu-%zu\n", salt, n);
    else if (n % 29 == 0) {
        buf_printf(out, "%s", n % 2 ? "save labels " : "render ");
        buf_printf(out, "%s/%zu.%s replace=yes\n", folder, n, n % 2 ? "nii" : "exr");
    } else if (n % 17 == 0)
        buf_printf(out, "# comment %zu\nlabel %zu name%zu-%zu\n", n, 1 + n % 200, salt, n);
    else if (n % 5 == 0) /* whose sync waits */
        buf_printf(out, "cross %zu,%zu,%zu\n", n % 16, n / 16 % 16, (n + salt) % 16);
    else
        buf_printf(out, "seed %zu,%zu,%zu %zu\n", n % 16, n / 16 % 16, (n + salt) % 16, n % 9);
}

static void start(struct victim *v, size_t salt)
{
    int in[2], out[2];
    if (v->rounds++ % NEW_AFTER == 0)
        snprintf(v->journal, sizeof v->journal, "%s/%zu.iftty", folder, salt);
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0)
        abort();
    fflush(stdout);
    v->process = fork();
    if (v->process == 0) {
        dup2(in[0], STDIN_FILENO);
        dup2(out[1], STDOUT_FILENO);
        execl(program, "iftty", "run", "-", "--keep-going", "--journal", v->journal, (char *)NULL);
        _exit(127);
    }
    close(in[0]);
    close(out[1]);
    v->input = in[1];
    v->output = out[0];
    fcntl(v->input, F_SETFL, O_NONBLOCK);
    fcntl(v->output, F_SETFL, O_NONBLOCK);
    v->fed = 0;
    buf_clear(&v->waits);
    buf_clear(&v->said);
}

static void take_output(struct victim *v)
{
    char bytes[4096];
    ssize_t n;
    while ((n = read(v->output, bytes, sizeof bytes)) > 0)
        buf_add(&v->said, bytes, (size_t)n);
}

static void feed(struct victim *v, size_t salt)
{
    while (v->waits.length < 4096)
        write_command(&v->waits, v->fed++, salt, v->before > 0);
    const ssize_t n = write(v->input, v->waits.data, v->waits.length);
    if (n <= 0)
        return;
    v->waits.length -= (size_t)n;
    memmove(v->waits.data, v->waits.data + n, v->waits.length);
}

/* How often it said "ok". */
static unsigned acknowledged_by(const struct victim *v)
{
    unsigned lines = 0;
    for (const char *at = buf_text(&v->said); (at = strstr(at, "ok ")) != NULL; at++)
        lines += at == buf_text(&v->said) || at[-1] == '\n';
    return lines;
}

/* Feeds both until the moment has come, and the victim has said "ok" so often: how fast it is must
 * not decide how much is tested. */
static void work_until(struct victim *victims, const size_t *salt, uint64_t end_ns,
                       const struct victim *v, unsigned said)
{
    const uint64_t patience_ns = clock_ns() + UINT64_C(60000000000);
    while (clock_ns() < end_ns || (acknowledged_by(v) < said && clock_ns() < patience_ns)) {
        struct pollfd ready[2 * VICTIMS];
        for (unsigned i = 0; i < VICTIMS; i++) {
            ready[2 * i] = (struct pollfd){.fd = victims[i].input, .events = POLLOUT};
            ready[2 * i + 1] = (struct pollfd){.fd = victims[i].output, .events = POLLIN};
        }
        poll(ready, 2 * VICTIMS, 1);
        for (unsigned i = 0; i < VICTIMS; i++) {
            if (ready[2 * i].revents & POLLOUT)
                feed(victims + i, salt[i]);
            take_output(victims + i);
        }
    }
}

/* Every command said to be done, in whole lines, is in the journal in that order, behind what was
 * there before; and at most one more is. Gives the number of records. */
static size_t compare(const struct victim *v, size_t *acknowledged)
{
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(walk_release) struct walk walk = {0};
    struct record record = {0};
    size_t records = 0;
    if (!file_exists(v->journal)) {
        CHECK_INT(v->said.length, 0);
        return 0;
    }
    CHECK(file_read(&bytes, v->journal, JOURNAL_BYTES_MAX, NULL) == OK);
    if (!CHECK(walk_begin(&walk, buf_text(&bytes), bytes.length, NULL) == OK))
        return 0;
    while (records < v->before && walk_next_sound(&walk, &record) == WALK_RECORD)
        records++;
    CHECK_INT(records, v->before); /* what was acknowledged in earlier rounds */
    const char *at = buf_text(&v->said), *feed;
    for (; (feed = strchr(at, '\n')); at = feed + 1) {
        char line[128] = "";
        const char *command = line;
        if (strncmp(at, "ok ", 3) != 0)
            continue; /* what it answers */
        snprintf(line, sizeof line, "%.*s", (int)(feed - at), at);
        command += 3 + strcspn(line + 3, " ") + 1;
        if (strncmp(command, "sync", 4) == 0 || strcmp(command, "info") == 0) /* not recorded */
            continue;
        ++*acknowledged;
        if (!CHECK(walk_next_sound(&walk, &record) == WALK_RECORD))
            break;
        CHECK_TEXT(record.command, command);
        records++;
    }
    size_t more = 0;
    while (walk_next_sound(&walk, &record) == WALK_RECORD)
        more++;
    CHECK(walk.over != WALK_DAMAGED && more <= 1);
    return records + more;
}

static void kill_and_compare(struct victim *v, size_t *acknowledged)
{
    int status = 0;
    take_output(v);
    kill(v->process, SIGKILL);
    while (waitpid(v->process, &status, 0) < 0 && errno == EINTR)
        ;
    CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    take_output(v); /* what it said and nobody had read yet */
    close(v->input);
    close(v->output);
    v->before = compare(v, acknowledged);
    if (v->rounds % NEW_AFTER == 0)
        v->before = 0;
}

STORY(kill_9_at_any_moment_takes_nothing_that_was_acknowledged)
{
    struct victim victim[VICTIMS] = {0};
    size_t salt[VICTIMS], acknowledged = 0, next = 0;
    const unsigned scale = check_scaled(1);
    const unsigned rounds = scale > 1 ? 50 * scale : 25;
    for (unsigned i = 0; i < VICTIMS; i++)
        start(victim + i, salt[i] = next++);
    for (unsigned round = 0; round < rounds && check_failures == 0; round++) {
        struct victim *v = victim + round % VICTIMS;
        const bool is_early = round % 4 == 0; /* while it starts, or resumes */
        const uint64_t us = 200 + check_below(&dice, is_early ? 5000 : 120000);
        const unsigned said = is_early ? 0 : 10 + check_below(&dice, 20);
        work_until(victim, salt, clock_ns() + us * 1000, v, said);
        kill_and_compare(v, &acknowledged);
        start(v, salt[round % VICTIMS] = next++);
    }
    for (unsigned i = 0; i < VICTIMS; i++) {
        kill_and_compare(victim + i, &acknowledged);
        buf_release(&victim[i].waits);
        buf_release(&victim[i].said);
    }
    CHECK(await_orphans());
    printf("# %u rounds, %zu commands acknowledged, none lost\n", rounds, acknowledged);
    CHECK(acknowledged > 4 * rounds);
}

int main(void)
{
    const char *build = getenv("IFTTY_BUILD");
    snprintf(program, sizeof program, "%s/iftty", build ? build : "build");
    signal(SIGPIPE, SIG_IGN);
    adopt_orphans();
    if (!make_folder(folder, "kill"))
        return 1;
    int status = check_run();
    return status | remove_folder(folder);
}
