/* SPDX-License-Identifier: MIT */
/* The terminal after every way in which the program can end: a small shell starts it as a job in a
 * real pseudo-terminal, and checks the state of the terminal afterwards. */
#include <sys/file.h>
#include <sys/mman.h>

#include "tests/folder.h"
#include "tests/job.h"
#include "tui/probe.h"
#include "tui/term.h"

#define BEGIN   "\033[?1049h\033[?25l\033[?2004h\033[?1000h\033[?1006h"
#define END     "\033[?2026l\033[?1006l\033[?1000l\033[?2004l\033[?25h\033[?1049l"
#define RECOVER "\033_Gm=0,q=2;\033\\"
/* Restores any terminal from any of our states. */
#define ENDING RECOVER END "\033[m\033[?25h\r\n"

/* ---- the job: parts to play ---- */

enum part {
    WAITS,
    WAITS_WITH_SIGNALS,
    WAITS_AND_ANSWERS,
    ENDS_WELL,
    FORGETS_TO_CLOSE,
    GOES_AT_ONCE,
    HOLDS_A_LOCK,
    LEAVES_A_CHILD,
    WRITES_A_FRAME
};
enum { FRAME = 300000 };

static volatile sig_atomic_t interrupted;

static void note_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

/* Play a part of a program on the full screen. */
static void play(const void *context)
{
    static char frame[FRAME];
    const enum part part = *(const enum part *)context;
    const bool has_signals = part == WAITS_WITH_SIGNALS || part == WRITES_A_FRAME;
    struct fault fault;
    if (part == HOLDS_A_LOCK) {
        int fd = memfd_create("lock", 0);
        if (fd < 0 || dup2(fd, 77) < 0 || flock(77, LOCK_EX) != 0)
            _exit(92);
    }
    if (part == WRITES_A_FRAME)
        signal(SIGINT, note_interrupt);
    if (term_open(0, 1, &fault))
        _exit(90);
    term_set_sequences(BEGIN, END);
    term_set_recovery(RECOVER, part == WAITS_AND_ANSWERS ? "\033[c" : NULL);
    if (term_set_mode(has_signals ? TERM_QUIET : TERM_RAW, &fault) ||
        term_write("ready", 5, &fault))
        _exit(91);
    switch (part) {
    case ENDS_WELL:
        term_close();
        return;
    case FORGETS_TO_CLOSE:
        exit(3);
    case GOES_AT_ONCE:
        _exit(4);
    case LEAVES_A_CHILD:
        if (fork() == 0) { /* that has all of our descriptors */
            usleep(5000000);
            _exit(0);
        }
        term_write("forked", 6, NULL);
        break;
    case WRITES_A_FRAME:
        memset(frame, 'p', sizeof frame);
        frame[FRAME - 1] = '.';
        if (term_write(frame, sizeof frame, &fault))
            _exit(93);
        term_close();
        _exit(interrupted ? 6 : 5);
    default:
        break;
    }
    for (;;)
        pause();
}

static void changes_sequences(const void *context)
{
    (void)context;
    struct fault fault;
    if (term_open(0, 1, &fault))
        _exit(90);
    term_set_sequences("<prompt>", "</prompt>");
    term_set_mode(TERM_RAW, &fault);
    term_change_sequences("<pilot>", "</pilot>", &fault);
    term_change_sequences("<prompt>", "</prompt>", &fault);
    term_write_end(&fault);
    term_write("bye", 3, &fault);
    term_close();
}

/* ---- the shell and the terminal ---- */

static struct stage {
    struct job job;
    pid_t guardian;
} s;

/* True if the text was written at any time. */
static bool see(const char *text, int ms)
{
    s.job.mark = 0;
    return job_see(&s.job, text, ms);
}

/* The first process of this name in the session; 0: none. A zombie counts. */
static pid_t process_of(pid_t session, const char *name)
{
    OWNED(listing_release) DIR *folder = opendir("/proc");
    pid_t found = 0;
    for (struct dirent *entry; folder && !found && (entry = readdir(folder));) {
        char path[300], line[300] = "";
        snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
        OWNED(stream_release)
        FILE *file = *entry->d_name >= '0' && *entry->d_name <= '9' ? fopen(path, "r") : NULL;
        if (file && !fgets(line, sizeof line, file))
            *line = '\0';
        const char *open = strchr(line, '('), *end = strrchr(line, ')');
        int group, own;
        if (!open || !end || sscanf(end + 1, " %*c %*d %d %d", &group, &own) != 2)
            continue;
        const size_t length = (size_t)(end - open - 1);
        if (own == session && length == strlen(name) && strncmp(open + 1, name, length) == 0)
            found = (pid_t)atol(entry->d_name);
    }
    return found;
}

static bool comes_true(bool (*what)(void))
{
    for (int i = 0; i < 6000; i++) {
        if (what())
            return true;
        see(NULL, 10);
    }
    return false;
}

static bool guardian_is_gone(void)
{
    while (waitpid(-1, NULL, WNOHANG) > 0) /* orphans become our children */
        ;
    return process_of(s.job.shell, "iftty-guardian") == 0;
}

static bool ends_with(const char *end)
{
    const size_t length = strlen(end);
    return s.job.seen.length >= length &&
           strcmp(buf_text(&s.job.seen) + s.job.seen.length - length, end) == 0;
}

static unsigned descriptors_of(pid_t process)
{
    char path[64];
    snprintf(path, sizeof path, "/proc/%d/fd", (int)process);
    return count_names(path, "");
}

/* The guardian may not be ready when its job is. Nothing is read meanwhile. */
static void start_ready(enum part part)
{
    s.guardian = 0;
    job_start(&s.job, play, &part);
    CHECK(see(BEGIN "ready", 60000));
    for (int i = 0; i < 6000 && !s.guardian; i++) {
        usleep(i ? 10000 : 0);
        const pid_t found = process_of(s.job.shell, "iftty-guardian");
        s.guardian = found && descriptors_of(found) <= 4 ? found : 0;
    }
    CHECK(s.guardian > 0);
}

static void end(void)
{
    kill(s.job.process, SIGKILL);
    CHECK(comes_true(guardian_is_gone));
    job_end(&s.job);
}
/* Define a story that ends the job. */
#define JOB_STORY(told) STORY_WITHIN(told, (void)0, end())

/* ---- stories ---- */

/* The terminal may have made CR CR LF of the last line feed, since modes come first. */
static bool has_ending(void)
{
    return ends_with(ENDING) || ends_with(RECOVER END "\033[m\033[?25h\r\r\n");
}

static bool has_modes_as_found(void)
{
    return job_has_modes_as_found(&s.job);
}

/* A guardian that has just begun has no name yet, as if it were gone: wait for the modes first. */
static void check_restored(void)
{
    CHECK(comes_true(has_modes_as_found) && comes_true(guardian_is_gone) && has_modes_as_found());
    CHECK(comes_true(has_ending)); /* the output may still be on its way */
    see(NULL, 20);
    CHECK(has_ending()); /* and nothing after it */
}

STORY(killed_in_full_screen_the_guardian_restores_the_terminal)
{
    static const enum part part[] = {WAITS, WAITS_WITH_SIGNALS, LEAVES_A_CHILD};
    for (int i = 0; i < 6; i++) { /* the process alone, or the whole job */
        start_ready(part[i / 2]);
        CHECK(!job_has_modes_as_found(&s.job));
        CHECK(part[i / 2] != LEAVES_A_CHILD || see("forked", 60000));
        kill(i % 2 ? -s.job.process : s.job.process, SIGKILL);
        const int status = job_report(&s.job);
        CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
        check_restored();
        end();
    }
}

JOB_STORY(the_guardian_holds_nothing_and_takes_no_signal)
{
    char path[64], line[200];
    unsigned long dirty_kb = 0;
    start_ready(HOLDS_A_LOCK);
    CHECK(descriptors_of(s.guardian) <= 4 && descriptors_of(s.job.process) > 4);
    snprintf(path, sizeof path, "/proc/%d/smaps_rollup", (int)s.guardian);
    OWNED(stream_release) FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "Private_Dirty:", 14) == 0)
            dirty_kb = strtoul(line + 14, NULL, 10);
    printf("# the guardian has %lu kB of its own\n", dirty_kb);
    static const int signals[] = {SIGINT, SIGQUIT, SIGHUP, SIGTERM, SIGTSTP, SIGTTIN, SIGTTOU};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        kill(s.guardian, signals[i]);
    kill(s.job.process, SIGKILL);
    job_report(&s.job);
    check_restored();
}

STORY(after_an_end_of_its_own_nothing_is_left)
{
    static const struct {
        enum part part;
        int status;
    } cases[] = {{ENDS_WELL, 0}, {FORGETS_TO_CLOSE, 3}, {GOES_AT_ONCE, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        job_start(&s.job, play, &cases[i].part);
        const int status = job_report(&s.job);
        CHECK(WIFEXITED(status) && WEXITSTATUS(status) == cases[i].status);
        if (cases[i].part == GOES_AT_ONCE) { /* without a word, which the guardian notices */
            check_restored();
        } else {
            CHECK_INT(process_of(s.job.shell, "iftty-guardian"), 0); /* at once */
            CHECK(job_has_modes_as_found(&s.job) && see(END, 60000));
        }
        end();
    }
}

/* The job is stopped, another process has the terminal, and then the job is killed. */
static void stop_and_kill(void (*then)(void))
{
    kill(s.job.process, SIGSTOP);
    CHECK(WIFSTOPPED(job_report(&s.job)) && !job_has_modes_as_found(&s.job));
    then();
    buf_clear(&s.job.seen);
    kill(s.job.process, SIGKILL);
    CHECK(comes_true(guardian_is_gone));
    see(NULL, 20);
}

static struct termios of_the_shell;

static void shell_sets_its_own_modes(void)
{
    tcgetattr(s.job.slave, &of_the_shell);
    of_the_shell.c_oflag |= OPOST | ONLCR;
    of_the_shell.c_lflag |= ISIG;
    tcsetattr(s.job.slave, TCSANOW, &of_the_shell);
}

JOB_STORY(a_shell_that_came_first_keeps_its_modes_and_gets_the_screen)
{
    struct termios now;
    start_ready(WAITS);
    stop_and_kill(shell_sets_its_own_modes);
    CHECK(tcgetattr(s.job.slave, &now) == 0 && now.c_lflag == of_the_shell.c_lflag &&
          now.c_iflag == of_the_shell.c_iflag);
    CHECK(see(END, 60000));
}

/* A group that there is in the session: the guardian's own. */
static void another_job_has_the_terminal(void)
{
    job_order(&s.job, s.guardian);
    for (int i = 0; i < 6000 && tcgetpgrp(s.job.master) != s.guardian; i++)
        usleep(10000);
    CHECK_INT(tcgetpgrp(s.job.master), s.guardian);
}

JOB_STORY(another_job_is_not_disturbed)
{
    start_ready(WAITS);
    stop_and_kill(another_job_has_the_terminal);
    CHECK_INT(s.job.seen.length, 0);
    CHECK(!job_has_modes_as_found(&s.job));
}

JOB_STORY(killed_while_stopped_there_is_nothing_to_give_back)
{
    start_ready(WAITS);
    kill(s.job.process, SIGTSTP);
    CHECK(WIFSTOPPED(job_report(&s.job)) && job_has_modes_as_found(&s.job));
    CHECK(see(END, 60000) && ends_with(END));
    const size_t before = s.job.seen.length;
    kill(s.job.process, SIGKILL);
    CHECK(comes_true(guardian_is_gone));
    see(NULL, 20);
    CHECK_INT(s.job.seen.length, before);
}

JOB_STORY(stopped_and_continued_it_is_guarded_again)
{
    start_ready(WAITS);
    kill(s.job.process, SIGTSTP);
    CHECK(WIFSTOPPED(job_report(&s.job)));
    buf_clear(&s.job.seen);
    job_order(&s.job, 0);
    CHECK(see(BEGIN, 60000));
    kill(s.job.process, SIGKILL);
    job_report(&s.job);
    check_restored();
}

/* Wait until the job is in the middle of its frame: a part was read, and the rest exceeds the
 * buffer of the terminal, since nobody reads. */
static void start_frame(void)
{
    start_ready(WRITES_A_FRAME);
    CHECK(see("readyp", 60000));
}

JOB_STORY(ctrl_c_cuts_no_frame_in_two)
{
    start_frame();
    CHECK(write(s.job.master, "\003", 1) == 1);
    usleep(100000);
    const int status = job_report(&s.job);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 6 && see(END, 60000));
    const char *text = buf_text(&s.job.seen), *first = strchr(text, 'p'), *last = strchr(text, '.');
    while (first && first[1] != 'p')
        first = strchr(first + 1, 'p');
    CHECK_WITH(first && last && last - first == FRAME - 1, "%zu bytes, from %td to %td",
               s.job.seen.length, first ? first - text : -1, last ? last - text : -1);
}

JOB_STORY(stopping_waits_for_the_end_of_a_frame)
{
    start_frame();
    CHECK(write(s.job.master, "\032", 1) == 1);
    usleep(100000);
    CHECK(WIFSTOPPED(job_report(&s.job)) && job_has_modes_as_found(&s.job) && see(END, 60000));
    const char *end_of_frame = strstr(buf_text(&s.job.seen), "p.");
    CHECK(end_of_frame && strstr(end_of_frame, END));
    CHECK(strstr(buf_text(&s.job.seen), END) > end_of_frame);
}

JOB_STORY(an_answer_that_is_due_at_sigterm_is_not_left_to_the_shell)
{
    start_ready(WAITS_AND_ANSWERS);
    kill(s.job.process, SIGTERM);
    CHECK(see(RECOVER "\033[c" END, 60000));
    usleep(50000);
    CHECK(write(s.job.master, "\033[?62;4c", 8) == 8);
    const int status = job_report(&s.job);
    CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM && job_has_modes_as_found(&s.job));
    CHECK_INT(job_left_to_read(&s.job), 0);
}

JOB_STORY(sequences_change_in_order_and_the_end_is_written_once)
{
    job_start(&s.job, changes_sequences, NULL);
    CHECK_INT(job_report(&s.job), 0);
    see("bye", 60000);
    CHECK_TEXT(buf_text(&s.job.seen), "<prompt></prompt><pilot></pilot><prompt></prompt>bye");
}

int main(void)
{
    alarm(900);
    prctl(PR_SET_CHILD_SUBREAPER, 1); /* guardians outlive their parents: see them go */
    return check_run();
}
