/* SPDX-License-Identifier: MIT */
/* A disk that fails at each step of the commands that write files.
 *
 * A session carries out a list of commands. Each is tried again and again: step N of the file layer
 * fails alone (EIO), or nothing can be written from step N on (ENOSPC), for every N, until it is
 * carried out. A command that fails says so, and leaves every file as it was, no draft, and a
 * journal that verifies; the same command works once the disk does. */
#include <errno.h>

#include "base/file.h"
#include "command/golden_files.h"
#define RUN_IN_FOLDER
#include "tests/folder_main.h"
#include "tests/interpreting.h"
#include "verify/verify_inside.h"
#include "verify/verify.h"

static const char *const commands[] = {
    "golden first",
    "turn 20",
    "golden slice of=axial",
    "render r.exr",
    "render r.exr replace=yes",
    "spin 2 t%d.png",
    "save labels l.nii.gz",
    "seed 4,4,4 2 radius=1",
    "save labels l.nii.gz replace=yes",
    "save surface s.stl",
    "save seeds seeds.csv",
    "golden second",
};
enum { COMMANDS = sizeof commands / sizeof *commands };

/* ---- the disk ---- */

static unsigned steps_left;
static bool may_fail, is_full, has_failed;

static int fail_step(enum file_step step, const char *path)
{
    (void)path;
    if (!may_fail || (steps_left > 0 && steps_left--))
        return 0;
    if (is_full && step != FILE_STEP_WRITE && step != FILE_STEP_SYNC)
        return 0;
    has_failed = true;
    may_fail = is_full;
    return is_full ? ENOSPC : EIO;
}

/* A number that another name or another byte in any file below `path` changes; the journal, which
 * may have a torn end, and empty folders do not count. */
static uint64_t digest_below(const char *path)
{
    uint64_t sum = 0;
    char name[FILE_LENGTH + 256];
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(listing_release) DIR *listing = opendir(path);
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        uint64_t digest = UINT64_C(14695981039346656037);
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
            strcmp(entry->d_name, "j.iftty") == 0)
            continue;
        if (file_is_folder(name)) {
            sum += digest_below(name);
            continue;
        }
        CHECK(file_read(&bytes, name, 1 << 26, NULL) == OK);
        buf_add_text(&bytes, name);
        for (size_t i = 0; i < bytes.length; i++)
            digest = (digest ^ (unsigned char)bytes.data[i]) * UINT64_C(1099511628211);
        sum += digest;
    }
    return sum;
}

/* The journal verifies: no golden image differs, is missing, or is one too many. */
static void verifies(void)
{
    OWNED(interpreter_release) struct interpreter interp;
    OWNED(replay_report_release) struct replay_report report = {0};
    struct evidence evidence = {0};
    OWNED(buf_release) struct buf told = {0}, orphans = {0};
    const struct golden_judge judge = evidence_judge(&evidence);
    begin_interpreter(&interp);
    interp.judge = &judge;
    fault.text[0] = '\0';
    if (!CHECK(replay_file(&interp, "j.iftty", 0, 0, NULL, NULL, &report, &fault) == OK) ||
        !CHECK(orphan_find(&orphans, &(struct orphan_search){&interp, "j.iftty", false, &told},
                           &fault) == OK))
        printf("#   %s\n", fault.text);
    CHECK_TEXT(buf_text(&told), "");
}

/* ---- stories ---- */

/* False where no step was left to fail. */
static bool fails_at(struct interpreter *interp, const char *line, unsigned step)
{
    const uint64_t before = digest_below(folder);
    const size_t records = interp->history.records;
    steps_left = step / 2;
    is_full = step % 2;
    has_failed = false;
    may_fail = true;
    const enum err err = execute(interp, line);
    may_fail = false;
    if (err == OK)
        return false;
    CHECK(has_failed);
    CHECK_HAS(fault.text, strerror(is_full ? ENOSPC : EIO));
    CHECK(digest_below(folder) == before);
    CHECK_INT(interp->history.records, records);
    if (check_failures)
        printf("#   %s, step %u: %s\n", line, step, fault.text);
    if (step % 8 == 7)
        verifies();
    return true;
}

STORY(a_command_whose_file_cannot_be_written_leaves_nothing_and_works_again)
{
    unsigned failures = 0;
    struct interpreter interp;
    begin_interpreter(&interp);
    CHECK(interpreter_create_journal(&interp, "j.iftty", &fault) == OK);
    must(&interp, "open synth:geom:16x16x16; size 16 16; seed 8,8,8 1 radius=2; seed 1,1,1 0");
    file_step_hook = fail_step;
    for (unsigned n = 0; n < COMMANDS && check_failures == 0; n++) {
        unsigned step = 0;
        while (check_failures == 0 && fails_at(&interp, commands[n], step))
            step++;
        if (has_failed)
            printf("# %s: stands, though step %u failed\n", commands[n], step);
        failures += step;
    }
    file_step_hook = NULL;
    CHECK_INT(interp.history.records, 4 + COMMANDS);
    interpreter_release(&interp);
    verifies();
    printf("# %u faults\n", failures);
    CHECK(failures > 200);
}

/* ---- the folder of golden images becomes a link ---- */

static void swap_folder(void)
{
    CHECK(rename("s.golden", "away") == 0 && symlink("precious", "s.golden") == 0);
}

/* At one step of the file layer, which succeeds. */
static int swap_at_step(enum file_step step, const char *path)
{
    (void)step, (void)path;
    if (!may_fail || steps_left-- > 0)
        return 0;
    may_fail = false;
    has_failed = true;
    swap_folder();
    return 0;
}

static void say_nothing(void *context, const char *text)
{
    (void)context, (void)text;
}

static const struct printer silent = {.print = say_nothing, .warn = say_nothing};

static void give(struct interpreter *interp)
{
    if (CHECK(interpreter_resume_journal(interp, "s.iftty", NULL, &fault) == OK))
        execute(interp, "golden more");
}

static void resume_it(struct interpreter *interp)
{
    interpreter_resume_journal(interp, "s.iftty", NULL, &fault);
}

static void accept_it(struct interpreter *interp)
{
    reseal_accept(interp, "s.iftty", "why", NULL, &silent, &fault);
}

static void reseal_it(struct interpreter *interp)
{
    reseal_edited(interp, "s.iftty", "why", &silent, &fault);
}

/* Between the look at the folder and the removal. */
static void remove_it(struct interpreter *interp)
{
    OWNED(golden_files_close) struct golden_files files = {0};
    OWNED(buf_release) struct buf bytes = {0};
    (void)interp;
    CHECK(golden_files_open(&files, "s.iftty", false, &fault) == OK);
    CHECK(file_read(&bytes, "s.iftty", 1 << 20, &fault) == OK);
    CHECK(golden_files_read(&files, buf_text(&bytes), bytes.length, &fault) == OK);
    if (may_fail && steps_left == 0) {
        swap_folder();
        has_failed = true;
    }
    may_fail = false;
    CHECK(golden_files_remove(&files, "last.exr", &fault) == OK);
}

static const char *const golden_files[] = {"first.exr", "first.png", "last.exr", "last.png"};

static void copy_file(const char *from, const char *to)
{
    OWNED(buf_release) struct buf bytes = {0};
    CHECK(file_read(&bytes, from, 1 << 24, &fault) == OK);
    CHECK(file_write(to, buf_text(&bytes), bytes.length, FILE_REPLACE, &fault) == OK);
}

static void copy_folder(const char *from, const char *to)
{
    CHECK(mkdir(to, 0777) == 0);
    for (size_t i = 0; i < sizeof golden_files / sizeof *golden_files; i++) {
        char name[2][64];
        snprintf(name[0], sizeof name[0], "%s/%s", from, golden_files[i]);
        snprintf(name[1], sizeof name[1], "%s/%s", to, golden_files[i]);
        copy_file(name[0], name[1]);
    }
}

/* What the user had there is as it was. */
static bool is_whole(const char *path)
{
    bool is_same = true;
    for (size_t i = 0; i < sizeof golden_files / sizeof *golden_files; i++) {
        char name[2][64];
        snprintf(name[0], sizeof name[0], "%s/%s", path, golden_files[i]);
        snprintf(name[1], sizeof name[1], "former/%s", golden_files[i]);
        is_same = is_same && file_holds_same(name[0], name[1]);
    }
    return is_same;
}

STORY(a_folder_that_becomes_a_link_at_any_step_leads_nothing_out)
{
    static void (*const works[])(struct interpreter *) = {give, resume_it, accept_it, reseal_it,
                                                          remove_it};
    struct interpreter interp;
    unsetenv("CI");
    begin_interpreter(&interp);
    CHECK(interpreter_create_journal(&interp, "s.iftty", &fault) == OK);
    must(&interp, "open synth:geom:16x16x16; size 16 16; seed 8,8,8 1 radius=2; golden first");
    CHECK(file_write("whole", "", 0, FILE_REPLACE, &fault) == OK);
    copy_file("s.iftty", "whole");
    must(&interp, "golden last of=axial");
    interpreter_release(&interp);
    copy_file("s.golden/last.exr", "s.golden/first.exr"); /* to be accepted */
    copy_file("s.golden/last.png", "s.golden/first.png");
    copy_folder("s.golden", "former");
    copy_folder("s.golden", "precious");
    unsigned swaps = 0;
    for (size_t i = 0; i < sizeof works / sizeof *works; i++) {
        has_failed = true;
        for (unsigned step = 0; has_failed && !check_failures; step++) {
            if (unlink("s.golden") != 0)
                folder_remove("s.golden");
            copy_folder("former", "s.golden");
            copy_file("whole", "s.iftty");
            begin_interpreter(&interp);
            steps_left = step;
            has_failed = false;
            may_fail = true;
            file_step_hook = swap_at_step;
            works[i](&interp);
            file_step_hook = NULL;
            may_fail = false;
            interpreter_release(&interp);
            CHECK_WITH(is_whole("precious"), "work %zu, step %u: %s", i, step, fault.text);
            if (has_failed)
                folder_remove("away");
            swaps += has_failed;
        }
    }
    printf("# %u swaps\n", swaps);
    CHECK(swaps > 20);
}

static int has_no_locks(enum file_step step, const char *path)
{
    (void)path;
    return step == FILE_STEP_LOCK ? ENOLCK : 0;
}

STORY(a_journal_that_is_begun_where_there_are_no_locks_says_what_stands_for_one)
{
    struct interpreter interp;
    begin_interpreter(&interp);
    interp.new_journal = "new.iftty";
    file_step_hook = has_no_locks;
    must(&interp, "open synth:geom:16x16x16");
    CHECK_HAS(buf_text(&reply.text), "has no locks: new.iftty.lock keeps other sessions from");
    must(&interp, "seed 8,8,8 1");
    CHECK(!strstr(buf_text(&reply.text), "locks")); /* once */
    MUST_MENTION(&interp, "journal", "has no locks: new.iftty.lock");
    MUST_MENTION(&interp, "journal other.iftty", "has no locks: other.iftty.lock");
    interpreter_release(&interp);
    file_step_hook = NULL;
    CHECK(!file_exists("new.iftty.lock") && !file_exists("other.iftty.lock"));
}
