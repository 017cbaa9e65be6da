/* SPDX-License-Identifier: MIT */
/* The history of input lines and its file: what is kept, for whom, how much, and by how many
 * programs at once. */
#include <errno.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>

#include "base/file.h"
#include "base/file_log.h"
#include "tests/check.h"
#include "tests/folder.h"
#include "tui/prompt/line.h"

static char folder[FOLDER_LENGTH];
static char path[FILE_LENGTH];
static struct fault fault;
static const unsigned patience_ms = 60000; /* a busy machine is no reason to go without a lock */

static bool enter(struct line_history *h, const char *text)
{
    return line_history_add(h, text, strlen(text)) && line_history_append(h, path, &fault) == OK;
}

static const char *content(void)
{
    static struct buf bytes;
    CHECK(file_read(&bytes, path, 1 << 24, NULL) == OK);
    return buf_text(&bytes);
}

static void write_file(const char *text)
{
    CHECK(file_write(path, text, strlen(text), FILE_REPLACE, NULL) == OK);
}

STORY(lines_are_appended_as_they_are_entered)
{
    struct line_history h = {0};
    struct stat status;
    CHECK(line_history_load(&h, path, &fault) == OK); /* nothing there, nor its folder */
    CHECK_INT(h.count, 0);
    CHECK(enter(&h, "seed 1,1,1 1"));
    CHECK_TEXT(content(), "seed 1,1,1 1\n");
    CHECK(stat(path, &status) == 0 && (status.st_mode & 0777) == 0600);
    *strrchr(path, '/') = '\0';
    CHECK(stat(path, &status) == 0 && (status.st_mode & 0777) == 0700);
    path[strlen(path)] = '/';
    CHECK(enter(&h, "run") && !enter(&h, "run") && !enter(&h, " secret") && !enter(&h, ""));
    CHECK_TEXT(content(), "seed 1,1,1 1\nrun\n");
    line_history_release(&h);
    CHECK(line_history_load(&h, path, &fault) == OK);
    CHECK_INT(h.count, 2);
    CHECK_TEXT(h.line[0], "seed 1,1,1 1");
    line_history_release(&h);
}

STORY(a_line_that_somebody_left_half_written_is_ended)
{
    OWNED(line_history_release) struct line_history h = {0};
    write_file("one\nhal");
    CHECK(enter(&h, "two"));
    CHECK_TEXT(content(), "one\nhal\ntwo\n");
}

STORY(what_the_file_holds_is_not_trusted)
{
    OWNED(line_history_release) struct line_history h = {0};
    static const char text[] =
        "one\n\x1b[31mred\nbell\a\n\n blank\n\xff\xfe\ntwo\r\nthree\0four\nfive";
    CHECK(file_write(path, text, sizeof text - 1, FILE_REPLACE, NULL) == OK);
    CHECK(line_history_load(&h, path, &fault) == OK);
    CHECK_INT(h.count, 3);
    CHECK_TEXT(h.line[0], "one");
    CHECK_TEXT(h.line[1], "\xff\xfe"); /* drawn as \xff\xfe */
    CHECK_TEXT(h.line[2], "five");
}

STORY(the_file_and_the_memory_are_bounded)
{
    struct line_history h = {0};
    OWNED(buf_release) struct buf text = {0};
    for (int i = 0; i < LINE_HISTORY_MOST + 500; i++)
        buf_printf(&text, "line %d\n", i);
    write_file(buf_text(&text));
    CHECK(line_history_load(&h, path, &fault) == OK);
    CHECK_INT(h.count, LINE_HISTORY_MOST);
    CHECK_TEXT(h.line[0], "line 500");
    CHECK(enter(&h, "the last"));
    CHECK_INT(h.count, LINE_HISTORY_MOST);
    CHECK(strncmp(content(), "line 501\n", 9) == 0);
    line_history_release(&h);
    CHECK(truncate(path, (off_t)1 << 40) == 0); /* a hole, of which only the end is read */
    CHECK(line_history_load(&h, path, &fault) == OK);
    CHECK_INT(h.count, 0);
    CHECK(enter(&h, "after the hole") && strstr(content(), "after the hole\n") != NULL);
    struct stat status;
    CHECK(stat(path, &status) == 0 && status.st_size <= LINE_HISTORY_BYTES_MOST);
    line_history_release(&h);
}

/* Others that trim all the time are in the way. */
static void enter_many(int number, int lines)
{
    for (int i = 0; i < lines; i++) {
        char line[64];
        snprintf(line, sizeof line, "line %d of %d", i, number);
        if (file_lines_append(path, line, strlen(line), NULL) != OK)
            _exit(1);
        if (i % 16 == 0 && file_lines_trim(path, 4000, 100000, NULL) != OK)
            _exit(1);
    }
    _exit(0);
}

STORY(many_sessions_at_once_lose_no_line)
{
    enum { SESSIONS = 8, LINES = 200 };
    OWNED(buf_release) struct buf filler = {0};
    int status;
    while (filler.length < 96000) /* so that there is always something to trim */
        buf_add_text(&filler, "an old line that may go\n");
    write_file(buf_text(&filler));
    fflush(stdout);
    for (int n = 0; n < SESSIONS; n++)
        if (fork() == 0)
            enter_many(n, LINES);
    for (int n = 0; n < SESSIONS; n++)
        CHECK(wait(&status) > 0 && status == 0);
    const char *text = content();
    int found = 0, next[SESSIONS] = {0}, number, i;
    for (const char *at = text; *at; at += strcspn(at, "\n") + 1)
        if (sscanf(at, "line %d of %d\n", &i, &number) == 2 && number >= 0 && number < SESSIONS) {
            found++;
            CHECK(i == next[number]); /* in the order in which each entered them */
            next[number] = i + 1;
        }
    CHECK_INT(found, SESSIONS * LINES);
    CHECK(strlen(text) < 102000);
}

STORY(a_lock_that_is_never_given_back_delays_a_line_and_no_more)
{
    OWNED(line_history_release) struct line_history h = {0};
    write_file("one\n");
    FILE *holder = fopen(path, "re");
    if (!CHECK(holder != NULL) || !CHECK(flock(fileno(holder), LOCK_EX) == 0))
        return;
    file_lines_patience_ms = 100;
    CHECK(line_history_add(&h, "two", 3) && file_lines_append(path, "two", 3, &fault) == OK);
    CHECK_TEXT(content(), "one\ntwo\n");
    CHECK(file_lines_trim(path, 1, 100, &fault) == OK);
    CHECK_TEXT(content(), "one\ntwo\n");
    fclose(holder);
    file_lines_patience_ms = patience_ms;
    CHECK(file_lines_trim(path, 1, 100, &fault) == OK);
    CHECK_TEXT(content(), "two\n");
}

/* A hook: stops this process before the new file gets the name of the old one. */
static int stop_before_rename(enum file_step step, const char *at)
{
    (void)at;
    if (step == FILE_STEP_RENAME)
        raise(SIGSTOP);
    return 0;
}

STORY(a_line_is_not_lost_while_another_process_is_stopped_in_its_trimming)
{
    int status;
    write_file("one\ntwo\nthree\n");
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        file_step_hook = stop_before_rename;
        _exit(file_lines_trim(path, 2, 100, NULL) == OK ? 0 : 1);
    }
    CHECK(waitpid(child, &status, WUNTRACED) == child && WIFSTOPPED(status));
    file_lines_patience_ms = 100;
    CHECK(file_lines_append(path, "four", 4, &fault) == OK);
    file_lines_patience_ms = patience_ms;
    CHECK_TEXT(content(), "one\ntwo\nthree\nfour\n");
    CHECK(kill(child, SIGCONT) == 0 && waitpid(child, &status, 0) == child && status == 0);
    CHECK_TEXT(content(), "two\nthree\nfour\n");
}

/* A hook: the file is replaced after it was opened and before the line is written. */
static unsigned replacements;
static int replace_before_write(enum file_step step, const char *at)
{
    char other[FILE_LENGTH + 4];
    if (step != FILE_STEP_WRITE || strcmp(at, path) != 0 || replacements == 0)
        return 0;
    replacements--;
    snprintf(other, sizeof other, "%s.new", path);
    FILE *out = fopen(other, "we");
    CHECK(out != NULL && fputs("new\n", out) >= 0 && fclose(out) == 0 && rename(other, path) == 0);
    return 0;
}

STORY(a_line_is_written_to_the_file_that_has_the_name_at_last)
{
    for (unsigned times = 1; times <= 40; times *= 2) {
        write_file("old\n");
        replacements = times;
        file_step_hook = replace_before_write;
        CHECK(file_lines_append(path, "one", 3, &fault) == OK);
        file_step_hook = NULL;
        CHECK_INT(replacements, 0);
        CHECK_TEXT(content(), "new\none\n");
    }
    write_file("old\n");
    replacements = 1000000; /* a line that cannot be stored is reported */
    file_step_hook = replace_before_write;
    CHECK(file_lines_append(path, "one", 3, &fault) == ERR_IO);
    file_step_hook = NULL;
    CHECK_HAS(fault.text, "is replaced all the time");
}

STORY(what_is_no_regular_file_is_left_alone)
{
    OWNED(buf_release) struct buf out = {0};
    struct stat status;
    char pipe_path[FILE_LENGTH], link_path[FILE_LENGTH];
    snprintf(pipe_path, sizeof pipe_path, "%s/pipe", folder);
    snprintf(link_path, sizeof link_path, "%s/link", folder);
    CHECK(mkfifo(pipe_path, 0600) == 0);
    CHECK(file_lines_read(&out, pipe_path, 100, &fault) == ERR_INPUT);
    CHECK(file_lines_append(pipe_path, "x", 1, &fault) == ERR_INPUT);
    CHECK(file_lines_read(&out, "/dev/null", 100, &fault) == ERR_INPUT);
    CHECK(file_lines_append("/dev/null", "x", 1, &fault) == ERR_INPUT);
    CHECK(file_lines_append(folder, "x", 1, &fault) == ERR_IO);
    CHECK(stat("/dev/null", &status) == 0 && S_ISCHR(status.st_mode));
    write_file("one\ntwo\n");
    CHECK(symlink(path, link_path) == 0); /* a link to a file is as good as the file */
    CHECK(file_lines_trim(link_path, 1, 100, &fault) == OK);
    CHECK_TEXT(content(), "two\n");
    CHECK(lstat(link_path, &status) == 0 && S_ISLNK(status.st_mode));
}

static enum file_step failing;
static int fail(enum file_step step, const char *at)
{
    (void)at;
    return step == failing ? ENOSPC : 0;
}

STORY(a_disk_that_fails_is_told_of)
{
    static const enum file_step step[] = {FILE_STEP_OPEN, FILE_STEP_WRITE};
    OWNED(line_history_release) struct line_history h = {0};
    write_file("one\ntwo\n");
    CHECK(line_history_add(&h, "three", 5));
    for (size_t i = 0; i < 2; i++) {
        failing = step[i];
        file_step_hook = fail;
        CHECK(line_history_append(&h, path, &fault) == ERR_IO);
        CHECK(file_lines_trim(path, 1, 100, &fault) == ERR_IO);
        file_step_hook = NULL;
        CHECK_HAS(fault.text, "No space left on device");
        CHECK_TEXT(content(), "one\ntwo\n");
    }
}

static int lack_locks(enum file_step step, const char *at)
{
    (void)at;
    return step == FILE_STEP_LOCK ? ENOLCK : 0;
}

STORY(without_locks_one_process_at_a_time_trims)
{
    struct file_lock held = {0};
    char lock_path[FILE_LENGTH + 8];
    snprintf(lock_path, sizeof lock_path, "%s.lock", path);
    write_file("one\ntwo\n");
    file_step_hook = lack_locks;
    CHECK(file_lines_append(path, "three", 5, &fault) == OK);
    CHECK(file_lines_trim(path, 2, 100, &fault) == OK);
    CHECK_TEXT(content(), "two\nthree\n");
    CHECK(!file_exists(lock_path));
    CHECK(file_lock_take(&held, -1, path, &fault) == OK && file_exists(lock_path));
    CHECK(file_lines_append(path, "four", 4, &fault) == OK);
    CHECK(file_lines_trim(path, 1, 100, &fault) == OK);
    CHECK_TEXT(content(), "two\nthree\nfour\n");
    file_lock_release(&held);
    CHECK(file_lines_trim(path, 1, 100, &fault) == OK);
    CHECK_TEXT(content(), "four\n");
    file_step_hook = NULL;
}

static const char *path_with(const char *own, const char *state, const char *home)
{
    static struct buf out;
    own ? setenv("IFTTY_HISTORY", own, 1) : unsetenv("IFTTY_HISTORY");
    state ? setenv("XDG_STATE_HOME", state, 1) : unsetenv("XDG_STATE_HOME");
    home ? setenv("HOME", home, 1) : unsetenv("HOME");
    return line_history_path(&out) ? buf_text(&out) : "none";
}

STORY(the_environment_says_where_it_lies)
{
    CHECK_TEXT(path_with("/x/y", "/state", "/home/me"), "/x/y");
    CHECK_TEXT(path_with("", "/state", "/home/me"), "none");
    CHECK_TEXT(path_with(NULL, "/state", "/home/me"), "/state/iftty/history");
    CHECK_TEXT(path_with(NULL, "state", "/home/me"), "/home/me/.local/state/iftty/history");
    CHECK_TEXT(path_with(NULL, NULL, "/home/me"), "/home/me/.local/state/iftty/history");
    CHECK_TEXT(path_with(NULL, NULL, ""), "none");
    CHECK_TEXT(path_with(NULL, NULL, NULL), "none");
}

int main(void)
{
    alarm(300);
    file_lines_patience_ms = patience_ms;
    if (!make_folder(folder, "history"))
        return 1;
    snprintf(path, sizeof path, "%s/state/iftty/history", folder);
    const int status = check_run();
    return remove_folder(folder) | status;
}
