/* SPDX-License-Identifier: MIT */
/* A session that is killed at each step of the commands that write files: golden images,
 * renditions, turntables, maps, surfaces and reports.
 *
 * A child carries out a list of commands, and is killed before step N of the file layer, for every
 * N up to the golden images, then for every ninth; with IFTTY_TEST_SCALE above 1 for every N, at
 * each of the writes of a file too. What it leaves has to be: a journal with every command that was
 * acknowledged, which verifies as it is; files that are whole, or not there; after the journal is
 * continued, a golden image for each record of one, no other, and no draft; and the rest of the
 * commands can be carried out, golden images from another view too. */
#include <fcntl.h>
#include <signal.h>

#include "base/file.h"
#include "command/golden_files.h"
#include "image/exr.h"
#include "tests/folder.h"
#include "tests/interpreting.h"
#include "tests/orphans.h"
#include "verify/verify_inside.h"
#include "journal/journal.h"

/* Below the test's own folder, which is the working folder: where the victim works, and what it
 * leaves when nobody kills it. */
#define HERE  "here/"
#define WHOLE "whole/"
enum { PATH_LENGTH = 512 };

static const char second[] = "golden second";
static const char *const commands[] = {
    "open synth:geom:16x16x16",
    "size 32 32",
    "seed 8,8,8 1 radius=2",
    "seed 1,1,1 0",
    "golden first",
    "turn 20",
    second,
    second,
    "golden slice of=axial",
    "render r.exr",
    "render r.png",
    "slice axial 8 a.png",
    "mosaic m.png",
    "spin 3 t%d.exr",
    "save labels before.nii.gz",
    "save labels map.nii.gz",
    "save cost cost.nrrd",
    "save surface s.stl",
    "save surface s.vtp",
    "save seeds seeds.csv",
    "save names names.txt",
    "stats report=stats.json",
    "compare before.nii.gz report=compare.csv picture=compare.png",
    "seed 4,4,4 2 radius=1",
    "save labels after.nii.gz",
    "save labels map.nii.gz replace=yes",
    "render r.exr replace=yes",
    "golden third",
    "spin 2 t.gif", /* last, since its helper starts slowly */
};
enum { COMMANDS = sizeof commands / sizeof *commands, GOLDENS = 9 }; /* up to the slice */

/* ---- the victim ---- */

static unsigned steps_left, scale = 1;
static bool dies;

/* Of the writes of one file, one right after the other, the first. */
static bool counts(enum file_step step, const char *path)
{
    static char last[PATH_LENGTH];
    const bool goes_on = step == FILE_STEP_WRITE && strcmp(path, last) == 0;
    snprintf(last, sizeof last, "%s", step == FILE_STEP_WRITE ? path : "");
    return !goes_on || scale > 1;
}

static int die_in_time(enum file_step step, const char *path)
{
    if (dies && counts(step, path) && steps_left-- == 0)
        kill(getpid(), SIGKILL);
    return 0;
}

/* Acknowledges each command that stood by a byte: how many records there are. */
static void work(int acknowledgements)
{
    struct interpreter interp;
    if (chdir(HERE) != 0)
        _exit(2);
    begin_interpreter(&interp);
    file_step_hook = die_in_time;
    if (interpreter_create_journal(&interp, "j.iftty", NULL) != OK)
        _exit(3);
    for (unsigned n = 0; n < COMMANDS; n++) {
        must(&interp, commands[n]);
        const char records = (char)interp.history.records;
        if (write(acknowledgements, &records, 1) != 1)
            _exit(4);
    }
    fflush(stdout);
    interpreter_release(&interp);
    _exit(0);
}

/* Records after each command, as far as it was acknowledged. */
static char records_after[COMMANDS + 1];

/* False where it came to its end. */
static bool kill_at(unsigned step, unsigned *acknowledged)
{
    int ends[2], status;
    if (pipe2(ends, O_CLOEXEC) != 0)
        abort();
    steps_left = step;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        work(ends[1]);
    }
    close(ends[1]);
    for (*acknowledged = 0; read(ends[0], &records_after[*acknowledged], 1) == 1;)
        ++*acknowledged;
    close(ends[0]);
    waitpid(child, &status, 0);
    CHECK(await_orphans() && (WIFSIGNALED(status) || WEXITSTATUS(status) == 0));
    return WIFSIGNALED(status);
}

/* ---- what it leaves ---- */

static const char *in(const char *where, const char *name)
{
    static char path[4][PATH_LENGTH + 8];
    static unsigned next;
    char *at = path[next++ % 4];
    snprintf(at, sizeof path[0], "%s%s", where, name);
    return at;
}

static bool is_same(const char *name, const char *wanted)
{
    return file_holds_same(in(HERE, name), in(WHOLE, wanted));
}

static bool is_picture(const char *name)
{
    OWNED(picture_release) struct picture picture = {0};
    return exr_read(&picture, in(HERE, name), NULL) == OK;
}

/* How many drafts are in a folder ("" or "NAME/"), whose other files are whole. */
static unsigned look_through(const char *below)
{
    unsigned drafts = 0;
    char name[PATH_LENGTH];
    OWNED(listing_release) DIR *listing = opendir(in(HERE, below));
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        snprintf(name, sizeof name, "%s%s", below, entry->d_name);
        if (*entry->d_name == '.') {
            drafts += strncmp(entry->d_name, ".iftty-", 7) == 0;
            continue;
        }
        if (strcmp(name, "j.iftty") == 0 || file_is_folder(in(HERE, name)))
            continue;
        if (strcmp(name, "map.nii.gz") == 0)
            CHECK(is_same(name, "before.nii.gz") || is_same(name, "after.nii.gz"));
        else if (strcmp(name, "r.exr") == 0)
            CHECK(is_picture(name));
        else if (!CHECK(is_same(name, name)))
            printf("#   %s\n", name);
    }
    return drafts;
}

/* The journal verifies: no golden image differs, is missing, or is one too many. */
static void verifies(struct buf *told)
{
    OWNED(interpreter_release) struct interpreter interp;
    OWNED(replay_report_release) struct replay_report report = {0};
    struct evidence evidence = {0};
    OWNED(buf_release) struct buf orphans = {0};
    const struct golden_judge judge = evidence_judge(&evidence);
    begin_interpreter(&interp);
    interp.judge = &judge;
    const char *path = HERE "j.iftty";
    fault.text[0] = '\0';
    if (!CHECK(replay_file(&interp, path, 0, 0, NULL, NULL, &report, &fault) == OK) ||
        !CHECK(orphan_find(&orphans, &(struct orphan_search){&interp, path, false, told}, &fault) ==
               OK) ||
        !CHECK(!orphans.length))
        printf("#   %s\n", fault.text);
}

/* A golden image for each name, and nothing else. */
static void has_goldens(void)
{
    OWNED(golden_files_close) struct golden_files files = {0};
    OWNED(buf_release) struct buf bytes = {0};
    unsigned images = 0, names = 0;
    char path[PATH_LENGTH];
    CHECK(file_read(&bytes, HERE "j.iftty", JOURNAL_BYTES_MAX, NULL) == OK &&
          golden_files_open(&files, HERE "j.iftty", false, NULL) == OK &&
          golden_files_read(&files, buf_text(&bytes), bytes.length, NULL) == OK);
    const char *at = buf_text(&files.named), *end = at + files.named.length;
    OWNED(listing_release) DIR *listing = opendir(HERE "j.golden");
    for (const struct dirent *entry; listing && (entry = readdir(listing));)
        images += *entry->d_name != '.';
    for (const char *name = at; name < end; name += strlen(name) + 1) {
        snprintf(path, sizeof path, "j.golden/%s", name);
        CHECK(file_exists(in(HERE, path)));
        const char *again = at;
        while (strcmp(again, name) != 0)
            again += strlen(again) + 1;
        names += again == name;
    }
    CHECK_INT(images, names);
}

/* What was not acknowledged is carried out now. A file that is there already, whole, without its
 * record has to be replaced by the user. */
static void go_on(struct interpreter *interp, unsigned from)
{
    char line[256];
    for (unsigned n = from; n < COMMANDS; n++) {
        if (n == from && strncmp(commands[n], "golden", 6) == 0 && commands[n] != commands[n - 1])
            must(interp, "turn 33"); /* another view: what was not recorded is not in its way */
        if (execute(interp, commands[n]) == OK)
            continue;
        CHECK_HAS(fault.text, "exists already");
        snprintf(line, sizeof line, "%s replace=yes", commands[n]);
        must(interp, line);
    }
}

static void continue_after(unsigned acknowledged, bool goes_on)
{
    OWNED(interpreter_release) struct interpreter interp;
    OWNED(buf_release) struct buf told = {0};
    CHECK(chdir(HERE) == 0);
    begin_interpreter(&interp);
    if (CHECK(interpreter_resume_journal(&interp, "j.iftty", &told, &fault) == OK)) {
        const size_t records = interp.history.records,
                     before = acknowledged ? (size_t)records_after[acknowledged - 1] : 0;
        CHECK((records == before || records == before + 1) && chdir("..") == 0);
        CHECK_INT(look_through("") + look_through("j.golden/"), 0);
        has_goldens();
        CHECK(chdir(HERE) == 0);
        if (goes_on)
            go_on(&interp, acknowledged + (unsigned)(records - before));
        CHECK(chdir("..") == 0);
        has_goldens();
    } else {
        CHECK(chdir("..") == 0);
        printf("#   %s\n", fault.text);
    }
}

STORY(a_kill_at_any_step_leaves_whole_files_and_a_journal_that_verifies)
{
    unsigned acknowledged, points = 0, drafts = 0, leftovers = 0;
    OWNED(buf_release) struct buf told = {0};
    scale = check_scaled(1);
    dies = true;
    for (unsigned step = 0; check_failures == 0 && kill_at(step, &acknowledged); points++) {
        step += acknowledged > GOLDENS && scale == 1 ? 9 : 1;
        if (file_exists(HERE "j.iftty")) {
            drafts += look_through("") + look_through("j.golden/") > 0;
            verifies(&told);
            leftovers += told.length > 0;
            continue_after(acknowledged, points % 5 == 0);
            buf_clear(&told);
            verifies(&told);
            CHECK_INT(told.length, 0);
        } else {
            CHECK_INT(acknowledged, 0);
        }
        if (check_failures)
            printf("#   before step %u, %u acknowledged\n", step, acknowledged);
        remove_folder(HERE);
        CHECK(mkdir(HERE, 0700) == 0);
        buf_clear(&told);
    }
    printf("# killed at %u steps; %u times with a draft left, %u with a golden image\n", points,
           drafts, leftovers);
    CHECK(points > 60 && drafts > 20 && leftovers >= 8);
}

int main(void)
{
    char folder[FOLDER_LENGTH];
    unsigned all;
    adopt_orphans();
    if (!make_folder(folder, "killed") || chdir(folder) != 0 || mkdir(HERE, 0700) != 0 ||
        kill_at(0, &all) || all != COMMANDS || rename(HERE, WHOLE) != 0 || mkdir(HERE, 0700) != 0)
        return 1;
    const int status = check_run();
    reply_release(&reply);
    return status | remove_folder(folder);
}
