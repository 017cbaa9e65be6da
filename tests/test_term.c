/* SPDX-License-Identifier: MIT */
/* The terminal after every way in which the program can end: a small shell starts it as a job in a
 * real pseudo-terminal, and checks the state of the terminal afterwards. */
#include <dirent.h>
#include <sys/file.h>
#include <sys/mman.h>

#include "tests/job.h"
#include "tui/probe.h"
#include "tui/term.h"

#define BEGIN   "\033[?1049h\033[?25l\033[?2004h\033[?1000h\033[?1006h"
#define END     "\033[?2026l\033[?1006l\033[?1000l\033[?2004l\033[?25h\033[?1049l"
#define RECOVER "\033_Gm=0,q=2;\033\\"
/* Restores any terminal from any of our states. */
#define ENDING RECOVER END "\033[m\033[?25h\r\n"

/* ---- the job: parts to play ---- */

static volatile sig_atomic_t interrupted;

static void note_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

static bool known_to_answer;

static void go_full_screen(enum term_mode mode)
{
    struct fault fault;
    if (term_open(0, 1, &fault))
        _exit(90);
    term_set_sequences(BEGIN, END);
    term_set_recovery(RECOVER, known_to_answer);
    if (term_set_mode(mode, &fault) || term_write("ready", 5, &fault))
        _exit(91);
}

static void waits(const void *context)
{
    (void)context;
    go_full_screen(TERM_RAW);
    for (;;)
        pause();
}

static void waits_with_signals(const void *context)
{
    (void)context;
    go_full_screen(TERM_QUIET);
    for (;;)
        pause();
}

static void waits_and_answers(const void *context)
{
    (void)context;
    known_to_answer = true;
    waits(NULL);
}

static void ends_well(const void *context)
{
    (void)context;
    go_full_screen(TERM_RAW);
    term_close();
}

static void forgets_to_close(const void *context)
{
    (void)context;
    go_full_screen(TERM_RAW);
    exit(3);
}

static void goes_at_once(const void *context)
{
    (void)context;
    go_full_screen(TERM_RAW);
    _exit(4);
}

static void holds_a_lock(const void *context)
{
    (void)context;
    int fd = memfd_create("lock", 0);
    if (fd < 0 || dup2(fd, 77) < 0 || flock(77, LOCK_EX) != 0)
        _exit(92);
    waits(NULL);
}

static void leaves_a_child(const void *context)
{
    (void)context;
    go_full_screen(TERM_RAW);
    if (fork() == 0) { /* that has all of our descriptors */
        usleep(5000000);
        _exit(0);
    }
    term_write("forked", 6, NULL);
    for (;;)
        pause();
}

enum { FRAME = 300000 };

static void writes_a_frame(const void *context)
{
    (void)context;
    static char frame[FRAME];
    struct fault fault;
    signal(SIGINT, note_interrupt);
    go_full_screen(TERM_QUIET);
    memset(frame, 'p', sizeof frame);
    frame[FRAME - 1] = '.';
    if (term_write(frame, sizeof frame, &fault))
        _exit(93);
    term_close();
    _exit(interrupted ? 6 : 5);
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

struct stage {
    struct job job;
    pid_t guardian;
};

/* True if the text was written at any time. */
static bool see(struct stage *s, const char *text, int ms)
{
    s->job.mark = 0;
    return job_see(&s->job, text, ms);
}

/* The first process of this name in the session; 0: none. A zombie counts. */
static pid_t process_of(pid_t session, const char *name)
{
    DIR *folder = opendir("/proc");
    pid_t found = 0;
    for (struct dirent *entry; folder && !found && (entry = readdir(folder));) {
        char path[300], line[300] = "";
        snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
        FILE *file = *entry->d_name >= '0' && *entry->d_name <= '9' ? fopen(path, "r") : NULL;
        if (file && !fgets(line, sizeof line, file))
            *line = '\0';
        if (file)
            fclose(file);
        const char *open = strchr(line, '('), *end = strrchr(line, ')');
        int group, own;
        if (!open || !end || sscanf(end + 1, " %*c %*d %d %d", &group, &own) != 2)
            continue;
        const size_t length = (size_t)(end - open - 1);
        if (own == session && length == strlen(name) && strncmp(open + 1, name, length) == 0)
            found = (pid_t)atol(entry->d_name);
    }
    if (folder)
        closedir(folder);
    return found;
}

static bool comes_true(struct stage *s, bool (*what)(struct stage *))
{
    for (int i = 0; i < 6000; i++) {
        if (what(s))
            return true;
        see(s, NULL, 10);
    }
    return false;
}

static bool guardian_is_gone(struct stage *s)
{
    while (waitpid(-1, NULL, WNOHANG) > 0) /* orphans become our children */
        ;
    return process_of(s->job.shell, "iftty-guardian") == 0;
}

static bool ends_with(const struct stage *s, const char *end)
{
    const size_t length = strlen(end);
    return s->job.seen.length >= length &&
           strcmp(buf_text(&s->job.seen) + s->job.seen.length - length, end) == 0;
}

static int descriptors_of(pid_t process)
{
    char path[64];
    int count = 0;
    snprintf(path, sizeof path, "/proc/%d/fd", (int)process);
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        count += *entry->d_name != '.';
    if (folder)
        closedir(folder);
    return count;
}

/* The guardian may not be ready when its job is. Nothing is read meanwhile. */
static void start_ready(struct stage *s, void (*play)(const void *))
{
    s->guardian = 0;
    job_start(&s->job, play, NULL);
    CHECK(see(s, BEGIN "ready", 60000));
    for (int i = 0; i < 6000 && !s->guardian; i++) {
        usleep(i ? 10000 : 0);
        const pid_t found = process_of(s->job.shell, "iftty-guardian");
        s->guardian = found && descriptors_of(found) <= 4 ? found : 0;
    }
    CHECK(s->guardian > 0);
}

static void end(struct stage *s)
{
    kill(s->job.process, SIGKILL);
    CHECK(comes_true(s, guardian_is_gone));
    job_end(&s->job);
}

/* ---- stories ---- */

/* The terminal may have made CR CR LF of the last line feed, since modes come first. */
static bool has_ending(struct stage *s)
{
    return ends_with(s, ENDING) || ends_with(s, RECOVER END "\033[m\033[?25h\r\r\n");
}

static void check_restored(struct stage *s)
{
    CHECK(comes_true(s, guardian_is_gone));
    CHECK(job_has_modes_as_found(&s->job));
    CHECK(comes_true(s, has_ending)); /* the output may still be on its way */
    see(s, NULL, 20);
    CHECK(has_ending(s)); /* and nothing after it */
}

STORY(killed_in_full_screen_the_guardian_restores_the_terminal)
{
    struct stage s;
    void (*const play[])(const void *) = {waits, waits_with_signals, leaves_a_child};
    for (int i = 0; i < 6; i++) { /* the process alone, or the whole job */
        start_ready(&s, play[i / 2]);
        CHECK(!job_has_modes_as_found(&s.job));
        CHECK(play[i / 2] != leaves_a_child || see(&s, "forked", 60000));
        kill(i % 2 ? -s.job.process : s.job.process, SIGKILL);
        const int status = job_report(&s.job);
        CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
        check_restored(&s);
        end(&s);
    }
}

STORY(the_guardian_holds_nothing_and_takes_no_signal)
{
    struct stage s;
    char path[64], line[200];
    unsigned long dirty_kb = 0;
    start_ready(&s, holds_a_lock);
    CHECK(descriptors_of(s.guardian) <= 4 && descriptors_of(s.job.process) > 4);
    snprintf(path, sizeof path, "/proc/%d/smaps_rollup", (int)s.guardian);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "Private_Dirty:", 14) == 0)
            dirty_kb = strtoul(line + 14, NULL, 10);
    if (file)
        fclose(file);
    printf("# the guardian has %lu kB of its own\n", dirty_kb);
    static const int signals[] = {SIGINT, SIGQUIT, SIGHUP, SIGTERM, SIGTSTP, SIGTTIN, SIGTTOU};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        kill(s.guardian, signals[i]);
    kill(s.job.process, SIGKILL);
    job_report(&s.job);
    check_restored(&s);
    end(&s);
}

STORY(after_an_end_of_its_own_nothing_is_left)
{
    static const struct {
        void (*play)(const void *);
        int status;
    } cases[] = {{ends_well, 0}, {forgets_to_close, 3}, {goes_at_once, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct stage s;
        job_start(&s.job, cases[i].play, NULL);
        const int status = job_report(&s.job);
        CHECK(WIFEXITED(status) && WEXITSTATUS(status) == cases[i].status);
        if (cases[i].play == goes_at_once) { /* without a word, which the guardian notices */
            check_restored(&s);
        } else {
            CHECK_INT(process_of(s.job.shell, "iftty-guardian"), 0); /* at once */
            CHECK(job_has_modes_as_found(&s.job));
            CHECK(see(&s, END, 60000));
        }
        end(&s);
    }
}

/* The job is stopped, another process has the terminal, and then the job is killed. */
static void stop_and_kill(struct stage *s, void (*then)(struct stage *))
{
    kill(s->job.process, SIGSTOP);
    CHECK(WIFSTOPPED(job_report(&s->job)));
    CHECK(!job_has_modes_as_found(&s->job));
    then(s);
    buf_clear(&s->job.seen);
    kill(s->job.process, SIGKILL);
    CHECK(comes_true(s, guardian_is_gone));
    see(s, NULL, 20);
}

static struct termios of_the_shell;

static void shell_sets_its_own_modes(struct stage *s)
{
    tcgetattr(s->job.slave, &of_the_shell);
    of_the_shell.c_oflag |= OPOST | ONLCR;
    of_the_shell.c_lflag |= ISIG;
    tcsetattr(s->job.slave, TCSANOW, &of_the_shell);
}

STORY(a_shell_that_came_first_keeps_its_modes_and_gets_the_screen)
{
    struct stage s;
    struct termios now;
    start_ready(&s, waits);
    stop_and_kill(&s, shell_sets_its_own_modes);
    CHECK(tcgetattr(s.job.slave, &now) == 0 && now.c_lflag == of_the_shell.c_lflag &&
          now.c_iflag == of_the_shell.c_iflag);
    CHECK(see(&s, END, 60000));
    end(&s);
}

/* A group that there is in the session: the guardian's own. */
static void another_job_has_the_terminal(struct stage *s)
{
    job_order(&s->job, s->guardian);
    for (int i = 0; i < 6000 && tcgetpgrp(s->job.master) != s->guardian; i++)
        usleep(10000);
    CHECK_INT(tcgetpgrp(s->job.master), s->guardian);
}

STORY(another_job_is_not_disturbed)
{
    struct stage s;
    start_ready(&s, waits);
    stop_and_kill(&s, another_job_has_the_terminal);
    CHECK_INT(s.job.seen.length, 0);
    CHECK(!job_has_modes_as_found(&s.job));
    end(&s);
}

STORY(killed_while_stopped_there_is_nothing_to_give_back)
{
    struct stage s;
    start_ready(&s, waits);
    kill(s.job.process, SIGTSTP);
    CHECK(WIFSTOPPED(job_report(&s.job)));
    CHECK(job_has_modes_as_found(&s.job));
    CHECK(see(&s, END, 60000) && ends_with(&s, END));
    const size_t before = s.job.seen.length;
    kill(s.job.process, SIGKILL);
    CHECK(comes_true(&s, guardian_is_gone));
    see(&s, NULL, 20);
    CHECK_INT(s.job.seen.length, before);
    end(&s);
}

STORY(stopped_and_continued_it_is_guarded_again)
{
    struct stage s;
    start_ready(&s, waits);
    kill(s.job.process, SIGTSTP);
    CHECK(WIFSTOPPED(job_report(&s.job)));
    buf_clear(&s.job.seen);
    job_order(&s.job, 0);
    CHECK(see(&s, BEGIN, 60000));
    kill(s.job.process, SIGKILL);
    job_report(&s.job);
    check_restored(&s);
    end(&s);
}

/* Wait until the job is in the middle of its frame: a part was read, and the rest exceeds the
 * buffer of the terminal, since nobody reads. */
static void start_frame(struct stage *s)
{
    start_ready(s, writes_a_frame);
    CHECK(see(s, "readyp", 60000));
}

STORY(ctrl_c_cuts_no_frame_in_two)
{
    struct stage s;
    start_frame(&s);
    CHECK(write(s.job.master, "\003", 1) == 1);
    usleep(100000);
    const int status = job_report(&s.job);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 6);
    CHECK(see(&s, END, 60000));
    const char *text = buf_text(&s.job.seen), *first = strchr(text, 'p'), *last = strchr(text, '.');
    while (first && first[1] != 'p')
        first = strchr(first + 1, 'p');
    if (!CHECK(first && last && last - first == FRAME - 1))
        printf("#   %zu bytes, from %td to %td\n", s.job.seen.length, first ? first - text : -1,
               last ? last - text : -1);
    end(&s);
}

STORY(stopping_waits_for_the_end_of_a_frame)
{
    struct stage s;
    start_frame(&s);
    CHECK(write(s.job.master, "\032", 1) == 1);
    usleep(100000);
    CHECK(WIFSTOPPED(job_report(&s.job)));
    CHECK(job_has_modes_as_found(&s.job));
    CHECK(see(&s, END, 60000));
    const char *end_of_frame = strstr(buf_text(&s.job.seen), "p.");
    CHECK(end_of_frame && strstr(end_of_frame, END));
    CHECK(strstr(buf_text(&s.job.seen), END) > end_of_frame);
    end(&s);
}

STORY(an_answer_that_is_due_at_sigterm_is_not_left_to_the_shell)
{
    struct stage s;
    start_ready(&s, waits_and_answers);
    kill(s.job.process, SIGTERM);
    CHECK(see(&s, RECOVER "\033[c" END, 60000));
    usleep(50000);
    CHECK(write(s.job.master, "\033[?62;4c", 8) == 8);
    const int status = job_report(&s.job);
    CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    CHECK(job_has_modes_as_found(&s.job));
    CHECK_INT(job_left_to_read(&s.job), 0);
    end(&s);
}

STORY(sequences_change_in_order_and_the_end_is_written_once)
{
    struct stage s;
    job_start(&s.job, changes_sequences, NULL);
    CHECK_INT(job_report(&s.job), 0);
    see(&s, "bye", 60000);
    CHECK_TEXT(buf_text(&s.job.seen), "<prompt></prompt><pilot></pilot><prompt></prompt>bye");
    end(&s);
}

int main(void)
{
    alarm(900);
    prctl(PR_SET_CHILD_SUBREAPER, 1); /* guardians outlive their parents: see them go */
    return check_run();
}
