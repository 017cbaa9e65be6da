/* SPDX-License-Identifier: MIT */
/* The journal as a file: failing writes and syncs, short writes, power loss. */
#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#define RUN_IN_FOLDER
#include "tests/folder_main.h"
#include "tests/journals.h"

static enum err count_record(void *context, const struct record *record, struct fault *fault)
{
    char command[64];
    size_t *count = context;
    *count += 1;
    snprintf(command, sizeof command, "seed %zu,2,3 1", *count);
    CHECK_INT(record->number, *count);
    CHECK_TEXT(record->command, command);
    (void)fault;
    return OK;
}

/* Opens, counts what is resumed, and expects `records`. */
static struct journal *reopen(const char *path, size_t records, struct buf *notice)
{
    struct journal *journal;
    struct fault fault = {.text = ""};
    size_t count = 0;
    const struct journal_resume resume = {
        .semantics = 1, .on_record = count_record, .context = &count};
    if (!CHECK(journal_open(&journal, path, &resume, notice, &fault) == OK)) {
        printf("#   %s\n", fault.text);
        return NULL;
    }
    CHECK_INT(count, records);
    CHECK_INT(journal_count(journal), records);
    CHECK(journal_audit(journal));
    return journal;
}

static void make(const char *path, size_t records)
{
    journal_close(make_journal(path, records));
}

STORY(a_journal_is_created_continued_and_kept)
{
    struct journal *journal;
    struct fault fault;
    OWNED(buf_release) struct buf first = {0}, second = {0}, notice = {0};
    const char *path = "a.iftty";
    make(path, 3);
    content(&first, path);
    CHECK(journal_create(&journal, path, 1, &fault) == ERR_IO); /* nothing is overwritten */
    CHECK(journal == NULL);
    CHECK_HAS(fault.text, "exists already");
    CHECK(is_file_of(path, first.data, first.length));
    journal = reopen(path, 3, &notice);
    CHECK_INT(notice.length, 0);
    CHECK_TEXT(journal_path(journal), path);
    CHECK(append(journal, 4, NULL) == OK);
    CHECK(strncmp(first.data + first.length - 33, journal_chain(journal), 32) != 0);
    content(&second, path);
    CHECK(strncmp(second.data + second.length - 33, journal_chain(journal), 32) == 0);
    CHECK(second.length > first.length &&
          memcmp(first.data, second.data, first.length) == 0); /* J3 */
    journal_close(journal);
    journal_close(reopen(path, 4, NULL));
    journal_close(NULL);
}

STORY(comments_become_part_of_the_next_record)
{
    struct journal *journal;
    OWNED(buf_release) struct buf bytes = {0};
    const char *path = "comments.iftty";
    CHECK(journal_create(&journal, path, 1, NULL) == OK);
    CHECK(journal_comment(journal, "# first", NULL) == OK);
    CHECK(journal_comment(journal, "", NULL) == OK);
    CHECK(journal_append(journal, "not\trecorded", "", NULL) == ERR_INPUT);
    CHECK(journal_append(journal, "run", "", NULL) == OK);
    CHECK(journal_append(journal, "undo", "", NULL) == OK);
    CHECK(journal_comment(journal, "# lost: nothing follows", NULL) == OK);
    CHECK(journal_audit(journal));
    journal_close(journal);
    content(&bytes, path);
    static const char first[] = "# iftty journal 1 semantics 1\n# first\n\nrun\n= 1 chain=";
    static const char second[] = "\nundo\n= 2 chain=";
    const size_t behind = sizeof first - 1 + 32;
    CHECK(strncmp(bytes.data, first, sizeof first - 1) == 0);
    CHECK(strstr(bytes.data, second) == bytes.data + behind);
    CHECK_INT(bytes.length, behind + sizeof second - 1 + 33);
}

STORY(records_are_signed_and_sessions_counted)
{
    struct journal *journal;
    OWNED(buf_release) struct buf bytes = {0}, script = {0};
    const char *path = "signed.iftty";
    CHECK(journal_create(&journal, path, 1, NULL) == OK);
    CHECK(journal_append(journal, "run", "", NULL) == OK); /* not signed */
    CHECK(journal_sign(journal, "jane", true, NULL) == OK);
    CHECK(journal_comment(journal, "# why", NULL) == OK);
    CHECK(journal_append(journal, "not\trecorded", "", NULL) == ERR_INPUT);
    CHECK(journal_append(journal, "undo", "", NULL) == OK);
    CHECK(journal_audit(journal));
    journal_close(journal);
    CHECK(journal_open(&journal, path, &(struct journal_resume){.semantics = 1}, NULL, NULL) == OK);
    CHECK(journal_sign(journal, NULL, false, NULL) == OK);
    CHECK(journal_append(journal, "redo", "", NULL) == OK);
    journal_close(journal);
    content(&bytes, path);
    CHECK_HAS(bytes.data, "\n# why\n#@ who=jane at=20");
    CHECK_HAS(bytes.data, "Z session=1\nundo\n= 2 ");
    CHECK_HAS(bytes.data, "\n#@ session=2\nredo\n= 3 ");
    CHECK(!strstr(strstr(bytes.data, "session=1") + 1, "session=1"));
    CHECK(journal_script(&script, bytes.data, bytes.length, NULL) == OK);
    CHECK_TEXT(buf_text(&script), "run\n# why\nundo\nredo\n");
    static const char *const wrong[] = {"", "jane doe", "a\x1b", "a\nb",
                                        "12345678901234567890123456789012345678901234567890"
                                        "123456789012345"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        CHECK(journal_who_check(wrong[i], NULL) != OK);
    CHECK(journal_who_check("j\xc3\xa5ne", NULL) == OK);
}

STORY(a_refused_command_changes_nothing)
{
    struct journal *journal;
    struct fault fault;
    const char *path = "refused.iftty";
    make(path, 2);
    journal = reopen(path, 2, NULL);
    CHECK(journal_append(journal, "seed\x1b[2J", "", &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "not recorded: ");
    CHECK(strchr(fault.text, '\x1b') == NULL);
    CHECK(journal_append(journal, "run", "not words", NULL) == ERR_INPUT);
    CHECK(journal_comment(journal, "no comment", NULL) == ERR_INPUT && journal_audit(journal));
    CHECK(append(journal, 3, NULL) == OK);
    journal_close(journal);
    journal_close(reopen(path, 3, NULL));
}

/* ---- torn and damaged files ---- */

STORY(a_torn_tail_is_kept_aside_and_cut_for_every_cut)
{
    OWNED(buf_release) struct buf bytes = {0}, notice = {0};
    const char *path = "torn.iftty", *kept = "torn.iftty.torn-1";
    make(path, 3);
    content(&bytes, path);
    size_t records = 0, begin = 0;
    for (size_t cut = 0; cut <= bytes.length; cut++) {
        if (cut > 0 && bytes.data[cut - 1] == '\n' && begin < cut) {
            const char *line = memrchr(bytes.data, '\n', cut - 1);
            line = line ? line + 1 : bytes.data;
            if (line == bytes.data || *line == '=') {
                records += line != bytes.data;
                begin = cut;
            }
        }
        put(path, bytes.data, cut);
        unlink(kept);
        struct journal *journal = reopen(path, records, &notice);
        if (!journal)
            break;
        if (cut == begin) {
            CHECK_INT(notice.length, 0);
            CHECK(!file_exists(kept));
        } else {
            CHECK(is_file_of(kept, bytes.data + begin, cut - begin));
            CHECK_HAS(buf_text(&notice), "is torn");
            CHECK_HAS(buf_text(&notice), ".torn-1");
            CHECK(strchr(buf_text(&notice), '\n') == NULL);
        }
        for (size_t n = records + 1; n <= 3; n++) /* it goes on as if nothing had been */
            CHECK(append(journal, n, NULL) == OK);
        journal_close(journal);
        CHECK(is_file_of(path, bytes.data, bytes.length));
    }
    CHECK_INT(records, 3);
}

STORY(torn_bytes_never_replace_earlier_ones)
{
    OWNED(buf_release) struct buf notice = {0};
    const char *path = "twice.iftty";
    for (int n = 1; n <= 3; n++) {
        char name[64];
        make(path, 1);
        OWNED(buf_release) struct buf bytes = {0};
        content(&bytes, path);
        buf_printf(&bytes, "seed %d", n);
        put(path, bytes.data, bytes.length);
        journal_close(reopen(path, 1, &notice));
        snprintf(name, sizeof name, "twice.iftty.torn-%d", n);
        CHECK(is_file_of(name, bytes.data + bytes.length - 6, 6));
        CHECK_HAS(buf_text(&notice), name);
    }
}

STORY(damage_is_refused_and_cut_only_on_request)
{
    OWNED(buf_release) struct buf bytes = {0}, notice = {0};
    struct journal *journal;
    struct fault fault;
    const char *path = "damaged.iftty";
    make(path, 4);
    content(&bytes, path);
    char *third = strstr(bytes.data, "# every third\nseed 3,");
    *strstr(third, "3,2,3") = '4';
    put(path, bytes.data, bytes.length);
    size_t count = 0;
    struct journal_resume resume = {.semantics = 1, .on_record = count_record, .context = &count};
    CHECK(journal_open(&journal, path, &resume, &notice, &fault) == ERR_INPUT && journal == NULL);
    CHECK_INT(count, 0); /* nothing was carried out for a journal that cannot be continued */
    char where[64];
    snprintf(where, sizeof where, "record 3 (line 7, from byte %td)", third - bytes.data);
    CHECK_HAS(fault.text, where);
    CHECK_HAS(fault.text, "nothing was changed");
    CHECK(is_file_of(path, bytes.data, bytes.length));
    resume.cuts_damage = true;
    CHECK(journal_open(&journal, path, &resume, &notice, &fault) == OK);
    CHECK_INT(count, 2);
    CHECK_HAS(buf_text(&notice), "2 records left");
    CHECK(is_file_of("damaged.iftty.torn-1", third, bytes.length - (size_t)(third - bytes.data)));
    CHECK(append(journal, 3, NULL) == OK);
    journal_close(journal);
    journal_close(reopen(path, 3, NULL));
}

static enum err refuse_second(void *context, const struct record *record, struct fault *fault)
{
    (void)context;
    return record->number == 2 ? fault_set(fault, ERR_CHECK, "it diverges") : OK;
}

static enum err refuse_two(void *context, unsigned semantics, struct fault *fault)
{
    (void)context;
    return semantics == 2 ? fault_set(fault, ERR_INPUT, "semantics 2") : OK;
}

STORY(what_is_no_journal_of_ours_is_refused_untouched)
{
    struct journal *journal;
    struct fault fault;
    const char *path = "other.iftty";
    const struct journal_resume resume = {.semantics = 1, .on_semantics = refuse_two};
    static const struct {
        const char *text, *words;
    } c[] = {
        {"seed 1,2,3 1\n", "this is a script"},
        {"# iftty journal 9 semantics 1\n", "format 9"},
        {"# iftty journal 1 semantics 2\n", "semantics 2"},
        {"# iftty journal one\n", "malformed"},
    };
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        put(path, c[i].text, strlen(c[i].text));
        CHECK(journal_open(&journal, path, &resume, NULL, &fault) == ERR_INPUT);
        CHECK_HAS(fault.text, c[i].words);
        CHECK(is_file_of(path, c[i].text, strlen(c[i].text)));
    }
    CHECK(journal_open(&journal, "missing.iftty", &resume, NULL, &fault) == ERR_IO);
    CHECK(journal_open(&journal, folder, &resume, NULL, &fault) == ERR_IO);
    /* a callback that refuses leaves even a torn tail where it is */
    make(path, 3);
    OWNED(buf_release) struct buf bytes = {0};
    content(&bytes, path);
    put(path, bytes.data, bytes.length - 3);
    const struct journal_resume refusing = {
        .semantics = 1, .on_record = refuse_second, .context = NULL};
    CHECK(journal_open(&journal, path, &refusing, NULL, &fault) == ERR_CHECK);
    CHECK_HAS(fault.text, "it diverges");
    CHECK(is_file_of(path, bytes.data, bytes.length - 3));
}

/* ---- failing steps ---- */

static unsigned steps_left;    /* until one fails */
static bool steps_stay_failed; /* and all after it */
static bool cut_failed;
static int step_errno;

static int fail_step(enum file_step step, const char *path)
{
    (void)path;
    if (steps_left > 0) {
        steps_left--;
        return 0;
    }
    cut_failed = cut_failed || step == FILE_STEP_CUT;
    if (!steps_stay_failed)
        file_step_hook = NULL;
    return step_errno;
}

static void fail_after(unsigned steps, bool stay_failed, int number)
{
    steps_left = steps;
    steps_stay_failed = stay_failed;
    step_errno = number;
    cut_failed = false;
    file_step_hook = fail_step;
}

/* How many records a file holds now, without opening it, and how they end. */
static size_t records_in(const char *path, enum walk_step *over)
{
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    content(&bytes, path);
    CHECK(walk_begin(&walk, bytes.data, bytes.length, NULL) == OK);
    while (walk_next_sound(&walk, &record) == WALK_RECORD)
        ;
    const size_t records = walk.records;
    *over = walk.over;
    return records;
}

/* A session of creating, appending and reopening, in which the step after `steps` others fails.
 * Where nothing works any more, not even a cut, a record that was refused may stay in the file when
 * the session ends there. Returns whether a step failed. */
static bool run_failing_session(unsigned steps, bool stay_failed, int number)
{
    const char *path = "failing.iftty";
    struct journal *journal;
    struct fault fault = {.text = ""};
    size_t acknowledged = 0;
    enum walk_step over;
    bool failed = false;
    unlink(path);
    fail_after(steps, stay_failed, number);
    if (journal_create(&journal, path, 1, &fault) != OK) {
        CHECK(journal == NULL);
        CHECK_HAS(fault.text, strerror(number));
        CHECK(!file_exists(path));
        file_step_hook = NULL;
        return true;
    }
    for (size_t n = 1; n <= 3; n++) {
        char chain[33];
        snprintf(chain, sizeof chain, "%s", journal_chain(journal));
        if (append(journal, acknowledged + 1, &fault) == OK) {
            acknowledged++;
        } else {
            failed = true;
            CHECK_HAS(fault.text, "not recorded");
            CHECK_TEXT(journal_chain(journal), chain);
        }
        CHECK_INT(journal_count(journal), acknowledged);
        if (!cut_failed)
            CHECK(journal_audit(journal)); /* J2, J3 at every moment */
    }
    journal_close(journal);
    file_step_hook = NULL;
    if (cut_failed && stay_failed && records_in(path, &over) == acknowledged + 1)
        acknowledged++;
    journal = reopen(path, acknowledged, NULL);
    CHECK(journal && append(journal, acknowledged + 1, &fault) == OK);
    journal_close(journal);
    journal_close(reopen(path, acknowledged + 1, NULL));
    return failed;
}

STORY(every_step_of_writing_may_fail)
{
    for (int stay_failed = 0; stay_failed < 2; stay_failed++) {
        unsigned failures = 0;
        for (unsigned steps = 0; steps < 24; steps++)
            failures += run_failing_session(steps, stay_failed != 0, steps % 2 ? ENOSPC : EIO);
        CHECK(failures >= 8); /* there are that many steps; beyond them nothing fails */
        CHECK(failures < 24);
    }
}

/* Reopens a journal with a torn tail, of which `bytes` hold `cut`. Returns whether that failed. */
static bool fail_reopening(const struct buf *bytes, size_t cut, unsigned steps, bool stay_failed)
{
    const char *path = "mending.iftty", *kept = "mending.iftty.torn-1";
    struct journal *journal;
    struct fault fault = {.text = ""};
    const struct journal_resume resume = {.semantics = 1};
    put(path, bytes->data, cut);
    unlink(kept);
    fail_after(steps, stay_failed, ENOSPC);
    enum err err = journal_open(&journal, path, &resume, NULL, &fault);
    file_step_hook = NULL;
    if (err)
        CHECK_HAS(fault.text, strerror(ENOSPC));
    /* the torn bytes are in one of the two files */
    CHECK(is_file_of(path, bytes->data, cut) || file_exists(kept));
    journal_close(journal);
    journal_close(reopen(path, 2, NULL));
    unlink("mending.iftty.torn-2");
    return err != OK;
}

STORY(every_step_of_reopening_may_fail)
{
    OWNED(buf_release) struct buf bytes = {0};
    make("mending.iftty", 3);
    content(&bytes, "mending.iftty");
    for (int stay_failed = 0; stay_failed < 2; stay_failed++) {
        unsigned failures = 0;
        for (unsigned steps = 0; steps < 20; steps++)
            failures += fail_reopening(&bytes, bytes.length - 20, steps, stay_failed != 0);
        CHECK(failures >= 9 && failures < 20); /* open to the sync of the cut */
    }
}

/* A failed append is cut off, and where even that fails nothing is appended until it succeeds:
 * otherwise a short record could stand before the rest of a long one. */
STORY(nothing_follows_an_append_that_could_not_be_taken_back)
{
    const char *path = "ragged.iftty";
    struct fault fault;
    make(path, 1);
    struct journal *journal = reopen(path, 1, NULL);
    fail_after(1, true, EIO); /* the write succeeds, its sync and that of the cut fail */
    CHECK(append(journal, 2, &fault) == ERR_IO && append(journal, 2, &fault) == ERR_IO);
    CHECK_HAS(fault.text, "not repaired yet");
    CHECK_INT(journal_count(journal), 1);
    file_step_hook = NULL;
    CHECK(append(journal, 2, &fault) == OK && journal_audit(journal));
    journal_close(journal);
    journal_close(reopen(path, 2, NULL));
}

/* The kernel itself writes only a part: the file may not grow beyond a limit. */
STORY(a_short_write_is_taken_back)
{
    const char *path = "short.iftty";
    struct rlimit former;
    struct fault fault;
    make(path, 2);
    struct journal *journal = reopen(path, 2, NULL);
    OWNED(buf_release) struct buf before = {0}, grown = {0};
    content(&before, path);
    getrlimit(RLIMIT_FSIZE, &former);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    for (size_t room = 0; room < 90; room += 7) {
        struct rlimit limit = {before.length + room, former.rlim_max};
        CHECK(setrlimit(RLIMIT_FSIZE, &limit) == 0);
        CHECK(journal_append(journal, "seed 3,2,3 1", "forest=0123456789abcdef seeds=3", &fault) ==
              ERR_IO);
        CHECK_HAS(fault.text, strerror(EFBIG));
        setrlimit(RLIMIT_FSIZE, &former);
        CHECK(is_file_of(path, before.data, before.length) && journal_audit(journal));
    }
    signal(SIGXFSZ, handler);
    CHECK(append(journal, 3, NULL) == OK);
    journal_close(journal);
    journal_close(reopen(path, 3, NULL));
}

/* ---- processes ---- */

static int die_at_step(enum file_step step, const char *path)
{
    (void)step;
    (void)path;
    if (steps_left-- == 0)
        _exit(7);
    return 0;
}

/* Like a loss of power between any two steps, with and without half a record written. */
STORY(a_process_that_dies_at_any_step_leaves_at_most_a_torn_record)
{
    const char *path = "dying.iftty";
    unsigned deaths = 0, torn = 0;
    OWNED(buf_release) struct buf notice = {0}, bytes = {0};
    make(path, 2);
    content(&bytes, path);
    for (unsigned steps = 0; steps < 8; steps++)
        for (size_t room = 0; room < 120; room += 30) {
            put(path, bytes.data, bytes.length);
            fflush(stdout);
            pid_t child = fork();
            if (child == 0) {
                struct journal *journal;
                const struct journal_resume resume = {.semantics = 1};
                const struct rlimit limit = {bytes.length + room, bytes.length + room};
                signal(SIGXFSZ, SIG_IGN);
                if (journal_open(&journal, path, &resume, NULL, NULL) != OK ||
                    (room > 0 && setrlimit(RLIMIT_FSIZE, &limit) != 0))
                    _exit(1);
                steps_left = steps;
                file_step_hook = die_at_step;
                for (size_t n = 3; n < 6; n++)
                    append(journal, n, NULL);
                _exit(0);
            }
            int status = -1;
            while (waitpid(child, &status, 0) < 0 && errno == EINTR)
                ;
            CHECK(WIFEXITED(status) && (WEXITSTATUS(status) == 7 || WEXITSTATUS(status) == 0));
            deaths += WIFEXITED(status) && WEXITSTATUS(status) == 7;
            enum walk_step over;
            const size_t records = records_in(path, &over);
            CHECK((over == WALK_END || over == WALK_TORN) && records >= 2);
            torn += over == WALK_TORN;
            journal_close(reopen(path, records, &notice));
            CHECK(notice.length == 0 || strstr(notice.data, "torn"));
        }
    CHECK(deaths > 8 && torn > 0);
}
