/* SPDX-License-Identifier: MIT */
/* What a journal is protected from: files that are deleted, moved, replaced or changed under it,
 * syncs that fail, a second writer, flipped bits. And how it goes on elsewhere. */
#include <errno.h>
#include <fcntl.h>
#include <sys/wait.h>

#include "base/clock.h"
#define RUN_IN_FOLDER
#include "tests/folder_main.h"
#include "tests/journals.h"

static enum err open_again(struct journal **journal, const char *path, struct fault *fault)
{
    const struct journal_resume how = {.semantics = 1};
    return journal_open(journal, path, &how, NULL, fault);
}

/* The file at `path` is a sound journal of `records`. */
static void holds(const char *path, size_t records)
{
    OWNED(journal_drop) struct journal *journal;
    if (!CHECK(open_again(&journal, path, NULL) == OK))
        return;
    CHECK_INT(journal_count(journal), records);
    CHECK(journal_audit(journal));
}

/* ---- a file that is not what it was ---- */

enum harm { DELETED, MOVED, REPLACED, LONGER, SHORTER, CHANGED, HARMS };

static void do_harm(const char *path, enum harm harm)
{
    OWNED(buf_release) struct buf bytes = {0};
    char moved[FILE_LENGTH + 32];
    snprintf(moved, sizeof moved, "%s.moved", path);
    content(&bytes, path);
    if (harm == DELETED)
        CHECK(unlink(path) == 0);
    else if (harm == MOVED)
        CHECK(rename(path, moved) == 0);
    else if (harm == REPLACED)
        put(path, bytes.data, bytes.length); /* the same bytes, another file */
    else if (harm == SHORTER)
        CHECK(truncate(path, (off_t)bytes.length - 5) == 0);
    usleep(20000); /* times of files go by the ticks of the clock */
    FILE *file = harm == LONGER ? fopen(path, "ae") : harm == CHANGED ? fopen(path, "r+e") : NULL;
    if (harm == CHANGED)
        fseek(file, 40, SEEK_SET);
    if (file) {
        fputs("# not ours\n", file);
        fclose(file);
    }
}

STORY(nothing_is_written_to_a_file_that_is_not_ours_any_more)
{
    static const char *const words[] = {"is gone",     "is gone",     "was replaced",
                                        "was changed", "was changed", "its byte 40 differs"};
    const char *path = "harmed.iftty";
    const char *other = "harmed-2.iftty";
    for (enum harm harm = DELETED; harm < HARMS; harm++) {
        struct fault fault;
        OWNED(buf_release) struct buf left = {0};
        struct journal *journal = make_journal(path, 3);
        unlink(other);
        do_harm(path, harm);
        if (file_exists(path))
            content(&left, path);
        for (int tries = 0; tries < 2; tries++) {
            CHECK(append(journal, 4, &fault) == ERR_IO);
            CHECK_HAS(fault.text, words[harm]);
            CHECK_HAS(fault.text, "not recorded");
            CHECK_INT(journal_count(journal), 3);
        }
        CHECK(left.data ? is_file_of(path, left.data, left.length) : !file_exists(path));
        CHECK(journal_continue(journal, other, &fault) == OK); /* and the session goes on */
        CHECK_TEXT(journal_path(journal), other);
        CHECK(append(journal, 4, NULL) == OK);
        CHECK(left.data ? is_file_of(path, left.data, left.length) : !file_exists(path));
        journal_close(journal);
        holds(other, 4);
    }
}

STORY(a_file_whose_times_alone_have_changed_is_written_to)
{
    const char *path = "touched.iftty";
    struct journal *journal = make_journal(path, 3);
    usleep(20000);
    CHECK(chmod(path, 0640) == 0 && utimensat(AT_FDCWD, path, NULL, 0) == 0);
    CHECK(append(journal, 4, NULL) == OK && append(journal, 5, NULL) == OK);
    journal_close(journal);
    holds(path, 5);
}

STORY(line_ends_of_windows_are_named)
{
    OWNED(buf_release) struct buf bytes = {0}, windows = {0};
    struct journal_condition condition;
    struct journal *journal;
    const char *path = "windows.iftty";
    journal_close(make_journal(path, 2));
    content(&bytes, path);
    for (size_t from = 0; from < 60;
         from += 30, buf_clear(&windows)) { /* all lines; but the first */
        for (size_t i = 0; i < bytes.length; i++)
            buf_add(&windows, bytes.data[i] == '\n' && i >= from ? "\r\n" : bytes.data + i,
                    bytes.data[i] == '\n' && i >= from ? 2 : 1);
        put(path, windows.data, windows.length);
        struct fault fault = {.text = ""};
        CHECK(journal_check(&condition, windows.data, windows.length, &fault) != OK);
        CHECK_HAS(fault.text, "line ends of Windows");
        CHECK(open_again(&journal, path, &fault) == ERR_INPUT);
        CHECK_HAS(fault.text, "line ends of Windows");
    }
}

static unsigned steps_left;
static bool fails_for_good;

static int fail_step(enum file_step step, const char *path)
{
    (void)step, (void)path;
    if (steps_left > 0) {
        steps_left--;
        return 0;
    }
    if (!fails_for_good)
        steps_left = 1000000;
    return ENOSPC;
}

STORY(going_on_elsewhere_is_all_or_nothing)
{
    unsigned failures = 0;
    const char *path = "from.iftty";
    const char *other = "to.iftty";
    for (unsigned steps = 0; steps < 24; steps++) {
        struct journal *journal = make_journal(path, 3);
        struct fault fault = {.text = ""};
        unlink(other);
        steps_left = steps / 2;
        fails_for_good = steps % 2;
        file_step_hook = fail_step;
        const enum err err = journal_continue(journal, other, &fault);
        file_step_hook = NULL;
        if (err) {
            failures++;
            CHECK_HAS(fault.text, strerror(ENOSPC));
            CHECK(!file_exists(other));
        }
        CHECK_TEXT(journal_path(journal), err ? path : other);
        CHECK(append(journal, 4, NULL) == OK && journal_audit(journal));
        journal_close(journal);
        holds(path, err ? 4 : 3);
        if (!err)
            holds(other, 4);
    }
    CHECK(failures >= 6 && failures < 24);
    struct journal *journal = make_journal(path, 1);
    struct fault fault;
    CHECK(journal_continue(journal, other, &fault) == ERR_IO);
    CHECK_HAS(fault.text, "exists already");
    CHECK(journal_continue(journal, "no/such/folder.iftty", &fault) == ERR_IO);
    CHECK(append(journal, 2, NULL) == OK);
    journal_close(journal);
    holds(path, 2);
}

/* ---- when to sync ---- */

static _Atomic unsigned syncs, bad_syncs;

static int count_syncs(enum file_step step, const char *path)
{
    (void)path;
    syncs += step == FILE_STEP_SYNC;
    if (step != FILE_STEP_SYNC || bad_syncs == 0)
        return 0;
    bad_syncs--;
    return EIO;
}

STORY(records_are_synced_when_that_was_asked_for)
{
    const char *path = "modes.iftty";
    struct journal *journal = make_journal(path, 1);
    syncs = bad_syncs = 0;
    file_step_hook = count_syncs;
    CHECK(append(journal, 2, NULL) == OK);
    CHECK_INT(syncs, 1);
    CHECK(journal_set_sync(journal, FILE_SYNC_OFF, NULL) == OK);
    for (size_t n = 3; n <= 20; n++)
        CHECK(append(journal, n, NULL) == OK);
    CHECK_INT(syncs, 1);
    CHECK(journal_sync(journal, NULL) == OK);
    CHECK_INT(syncs, 2);
    CHECK(journal_set_sync(journal, FILE_SYNC_EVERY_SECOND, NULL) == OK);
    for (size_t n = 21; n <= 40; n++)
        CHECK(append(journal, n, NULL) == OK);
    CHECK(syncs <= 3); /* it may have taken long */
    const uint64_t begin = clock_ns();
    while (syncs < 3 && clock_ns() - begin < UINT64_C(60000000000))
        usleep(10000);
    CHECK_INT(syncs, 3); /* though nothing else was done */
    CHECK(append(journal, 41, NULL) == OK);
    CHECK(journal_set_sync(journal, FILE_SYNC_ALWAYS, NULL) == OK); /* what waits goes first */
    CHECK(syncs >= 4);
    file_step_hook = NULL;
    journal_close(journal);
    holds(path, 41);
}

/* A system that could not write a page may drop it and say once that it did. */
STORY(what_a_failed_sync_may_have_lost_is_written_again)
{
    struct fault fault;
    const char *path = "doubt.iftty";
    struct journal *journal = make_journal(path, 2);
    CHECK(journal_set_sync(journal, FILE_SYNC_OFF, NULL) == OK);
    for (size_t n = 3; n <= 6; n++)
        CHECK(append(journal, n, NULL) == OK);
    bad_syncs = 2;
    file_step_hook = count_syncs;
    CHECK(journal_sync(journal, &fault) == ERR_IO);
    CHECK_HAS(fault.text, "cannot sync");
    OWNED(buf_release) struct buf bytes = {0};
    content(&bytes, path);
    FILE *file = fopen(path, "r+e"); /* the pages are gone */
    for (size_t at = bytes.length - 100; file && at < bytes.length; at++) {
        fseek(file, (long)at, SEEK_SET);
        fputc(0, file);
    }
    fclose(file);
    CHECK(append(journal, 7, &fault) == ERR_IO); /* the second bad sync */
    CHECK_HAS(fault.text, "not repaired yet");
    CHECK_INT(journal_count(journal), 6);
    CHECK(append(journal, 7, NULL) == OK);
    file_step_hook = NULL;
    CHECK(journal_audit(journal));
    journal_close(journal);
    holds(path, 7);
}

STORY(what_may_wait_is_synced_soon_or_with_the_next_record)
{
    const char *path = "views.iftty";
    OWNED(journal_drop) struct journal *journal = make_journal(path, 1);
    syncs = bad_syncs = 0;
    file_step_hook = count_syncs;
    for (size_t n = 2; n <= 6; n++)
        CHECK(journal_append(journal, "turn 15", NULL, NULL) == OK);
    CHECK(syncs <= 1); /* it may have taken long */
    const uint64_t begin = clock_ns();
    while (syncs < 1 && clock_ns() - begin < UINT64_C(60000000000))
        usleep(10000);
    CHECK_INT(syncs, 1); /* though nothing else was done */
    CHECK(journal_append(journal, "turn 15", NULL, NULL) == OK);
    CHECK(journal_catch_up(journal, NULL) == OK);
    CHECK_INT(syncs, 2);
    CHECK(journal_catch_up(journal, NULL) == OK && syncs == 2); /* nothing waits */
    OWNED(buf_release) struct buf synced = {0}, bytes = {0};
    content(&synced, path);
    CHECK(journal_append(journal, "turn 15", NULL, NULL) == OK);
    bad_syncs = 1; /* that of the next record, or of the thread: the page is gone */
    append(journal, 9, NULL);
    content(&bytes, path);
    FILE *file = fopen(path, "r+e");
    for (size_t at = synced.length; file && at < bytes.length; at++) {
        fseek(file, (long)at, SEEK_SET);
        fputc(0, file);
    }
    fclose(file);
    CHECK(append(journal, 10, NULL) == OK);
    file_step_hook = NULL;
    CHECK(journal_audit(journal));
}

STORY(where_nothing_is_to_be_synced_nothing_waits_for_it)
{
    const char *path = "off.iftty";
    OWNED(journal_drop) struct journal *journal = make_journal(path, 1);
    CHECK(journal_set_sync(journal, FILE_SYNC_OFF, NULL) == OK);
    const unsigned before = count_names("/proc/self/task", "");
    CHECK(before > 0 && journal_append(journal, "turn 15", NULL, NULL) == OK);
    CHECK_INT(count_names("/proc/self/task", ""), before);
}

/* ---- others ---- */

STORY(a_second_writer_is_told_who_has_it_and_may_look)
{
    char wanted[64];
    struct fault fault;
    OWNED(buf_release) struct buf before = {0};
    const char *path = "held.iftty";
    const char *other = "mine.iftty";
    struct journal *journal = make_journal(path, 3), *second;
    snprintf(wanted, sizeof wanted, "process %ld (test_durable)", (long)getpid());
    CHECK(open_again(&second, path, &fault) == ERR_IO);
    CHECK_HAS(fault.text, wanted);
    CHECK_HAS(fault.text, "--read-only");
    content(&before, path);
    const struct journal_resume looking = {.semantics = 1, .only_looks = true};
    CHECK(journal_open(&second, path, &looking, NULL, NULL) == OK && journal_only_looks(second));
    CHECK_INT(journal_count(second), 3);
    CHECK(append(second, 4, NULL) == OK); /* in memory */
    CHECK(is_file_of(path, before.data, before.length) && journal_sync(second, NULL) == OK);
    CHECK(journal_continue(second, other, NULL) == OK && append(second, 5, NULL) == OK);
    journal_close(second);
    CHECK(is_file_of(path, before.data, before.length));
    holds(other, 5);
    CHECK(append(journal, 4, NULL) == OK);
    journal_close(journal);
    holds(path, 4); /* the lock went with it */
}

/* A process that is being started holds the locks of its parent until it runs its own program. */
STORY(a_lock_that_a_child_holds_for_a_moment_is_waited_for)
{
    struct fault fault;
    const char *path = "moment.iftty";
    struct journal *journal = make_journal(path, 2), *second;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        usleep(100000);
        _exit(0);
    }
    journal_close(journal);
    CHECK(open_again(&second, path, &fault) == OK);
    journal_close(second);
    CHECK(waitpid(child, NULL, 0) == child);
}

static int has_no_locks(enum file_step step, const char *path)
{
    (void)path;
    return step == FILE_STEP_LOCK ? ENOLCK : 0;
}

static int has_no_locks_and_no_room(enum file_step step, const char *path)
{
    const size_t length = strlen(path);
    const bool is_lock = length > 5 && strcmp(path + length - 5, ".lock") == 0;
    return step == FILE_STEP_LOCK ? ENOLCK : is_lock && step == FILE_STEP_WRITE ? ENOSPC : 0;
}

STORY(where_there_are_no_locks_a_file_stands_for_one)
{
    char lock[FILE_LENGTH + 8];
    struct fault fault;
    struct journal *journal, *second;
    const char *path = "nfs.iftty";
    snprintf(lock, sizeof lock, "%s.lock", path);
    file_step_hook = has_no_locks;
    journal = make_journal(path, 2);
    CHECK_TEXT(journal_lock_file(journal), lock);
    CHECK(open_again(&second, path, &fault) == ERR_IO);
    CHECK_HAS(fault.text, "is being written by another session, by process ");
    CHECK_HAS(fault.text, ".lock serves as one");
    CHECK(append(journal, 3, NULL) == OK);
    journal_close(journal);
    CHECK(!file_exists(lock));
    fflush(stdout);
    const pid_t child = fork(); /* it dies with the journal open */
    if (child == 0)
        _exit(open_again(&journal, path, NULL) == OK ? 0 : 1);
    int status = 1;
    CHECK(waitpid(child, &status, 0) == child && status == 0 && file_exists(lock));
    CHECK(open_again(&journal, path, NULL) == OK && append(journal, 4, NULL) == OK);
    journal_close(journal);
    put(lock, "somebody\n", 9); /* what cannot be read is left */
    CHECK(open_again(&second, path, &fault) == ERR_IO);
    CHECK_HAS(fault.text, ".lock serves as one");
    CHECK(file_exists(lock));
    file_step_hook = NULL;
    unlink(lock);
    holds(path, 4);
}

STORY(no_empty_journal_stays_where_no_lock_can_be_had)
{
    struct journal *journal;
    struct fault fault;
    const char *path = "none.iftty";
    file_step_hook = has_no_locks_and_no_room;
    CHECK(journal_create(&journal, path, 1, &fault) == ERR_IO);
    file_step_hook = NULL;
    CHECK_HAS(fault.text, strerror(ENOSPC));
    CHECK(!file_exists(path));
}

STORY(looking_leaves_a_torn_tail_alone)
{
    struct journal *journal;
    OWNED(buf_release) struct buf bytes = {0}, notice = {0};
    const char *path = "looked.iftty";
    journal_close(make_journal(path, 3));
    CHECK(truncate(path, 200) == 0);
    content(&bytes, path);
    const struct journal_resume looking = {.semantics = 1, .only_looks = true};
    CHECK(journal_open(&journal, path, &looking, &notice, NULL) == OK);
    CHECK_HAS(buf_text(&notice), "left where it is");
    journal_close(journal);
    CHECK(is_file_of(path, bytes.data, bytes.length) && !file_exists("looked.iftty.torn-1"));
}

/* ---- flips ---- */

/* Opens `bytes`, of which the byte at `at` is wrong; records before it are `before`. */
static void open_flipped(const char *path, const struct buf *bytes, size_t before, bool is_last)
{
    struct journal *journal;
    OWNED(buf_release) struct buf told = {0}, left = {0};
    put(path, bytes->data, bytes->length);
    const enum err err = open_again(&journal, path, NULL);
    if (err) {
        CHECK(err == ERR_INPUT);
        CHECK(is_file_of(path, bytes->data, bytes->length)); /* refused, and untouched */
        if (before > 0 && CHECK(journal_repair(path, 1, &told, NULL) == OK))
            holds(path, before);
    } else {
        CHECK(is_last); /* what could be a torn end is repaired, as told; never more */
        CHECK_INT(journal_count(journal), before);
        journal_close(journal);
        content(&left, path);
        CHECK(left.length < bytes->length || before == 0);
    }
}

STORY(a_flip_of_any_bit_is_refused_or_repaired_and_never_taken)
{
    enum { RECORDS = 3 };
    OWNED(buf_release) struct buf bytes = {0};
    const char *path = "flip.iftty";
    char name[32];
    size_t before = 0;
    journal_close(make_journal(path, RECORDS));
    content(&bytes, path);
    for (size_t at = 0; at < bytes.length; at++) {
        for (unsigned bit = 0; bit < 8; bit++) {
            bytes.data[at] = (char)(bytes.data[at] ^ 1 << bit);
            open_flipped(path, &bytes, before, before == RECORDS - 1);
            bytes.data[at] = (char)(bytes.data[at] ^ 1 << bit);
            for (unsigned n = 1; n < 4; n++) {
                snprintf(name, sizeof name, "flip.iftty.torn-%u", n);
                unlink(name);
            }
        }
        const char *line = memrchr(bytes.data, '\n', at);
        before += bytes.data[at] == '\n' && line && line[1] == '=';
    }
    CHECK_INT(before, RECORDS);
}
