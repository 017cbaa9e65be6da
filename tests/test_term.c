/* SPDX-License-Identifier: MIT */
/* The terminal after every end of the program: a small shell starts it as a job in a real
 * pseudo-terminal, and looks at what it leaves. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/check.h"
#include "tui/probe.h"
#include "tui/term.h"

#define BEGIN   "\033[?1049h\033[?25l\033[?2004h\033[?1000h\033[?1006h"
#define END     "\033[?2026l\033[?1006l\033[?1000l\033[?2004l\033[?25h\033[?1049l"
#define RECOVER "\033_Gm=0,q=2;\033\\"
/* What brings back any terminal in any of our states. */
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
    term_set_answers(known_to_answer);
    term_set_sequences(BEGIN, END);
    term_set_recovery(RECOVER);
    if (term_set_mode(mode, &fault) || term_write("ready", 5, &fault))
        _exit(91);
}

static void waits(void)
{
    go_full_screen(TERM_RAW);
    for (;;)
        pause();
}

static void waits_with_signals(void)
{
    go_full_screen(TERM_QUIET);
    for (;;)
        pause();
}

static void waits_and_answers(void)
{
    known_to_answer = true;
    waits();
}

static void ends_well(void)
{
    go_full_screen(TERM_RAW);
    term_close();
}

static void forgets_to_close(void)
{
    go_full_screen(TERM_RAW);
    exit(3);
}

static void goes_at_once(void)
{
    go_full_screen(TERM_RAW);
    _exit(4);
}

static void holds_a_lock(void)
{
    int fd = memfd_create("lock", 0);
    if (fd < 0 || dup2(fd, 77) < 0 || flock(77, LOCK_EX) != 0)
        _exit(92);
    waits();
}

static void leaves_a_child(void)
{
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

static void writes_a_frame(void)
{
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

static void changes_sequences(void)
{
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
    int master, slave, report, order;
    pid_t shell, job, guardian;
    struct termios found;
    struct buf seen;
};

/* Starts the job in the foreground, reports how it stops or ends, and takes the terminal back, as
 * shells do. When ordered, gives it to another process group, or (0) to the job and continues it.
 */
static void run_shell(int slave, int report, int order, void (*play)(void))
{
    int status;
    pid_t other = 0;
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* and the terminal hangs up */
    setsid();
    ioctl(slave, TIOCSCTTY, 0);
    signal(SIGTTOU, SIG_IGN);
    signal(SIGHUP, SIG_DFL); /* ignored where the test itself runs in the background or by nohup */
    signal(SIGINT, SIG_DFL);
    signal(SIGQUIT, SIG_DFL);
    for (int fd = 0; fd < 3; fd++)
        dup2(slave, fd);
    pid_t job = fork();
    if (job == 0) {
        setpgid(0, 0);
        tcsetpgrp(0, getpid());
        signal(SIGTTOU, SIG_DFL);
        close(slave);
        close(report);
        close(order);
        play();
        exit(0);
    }
    setpgid(job, job);
    bool alive = write(report, &job, sizeof job) == sizeof job;
    while (alive && waitpid(job, &status, WUNTRACED) == job) {
        if (!other)
            tcsetpgrp(0, getpgrp());
        alive = write(report, &status, sizeof status) > 0 && read(order, &other, sizeof other) > 0;
        tcsetpgrp(0, other ? other : job);
        if (WIFSTOPPED(status) && !other)
            kill(-job, SIGCONT);
    }
    while (read(order, &other, sizeof other) > 0)
        ;
    _exit(0);
}

static bool see(struct stage *s, const char *text, int ms)
{
    uint64_t end = clock_ns() + (uint64_t)ms * 1000000;
    for (;;) {
        char piece[4096];
        uint64_t now = clock_ns();
        struct pollfd ready = {.fd = s->master, .events = POLLIN};
        if (text && strstr(buf_text(&s->seen), text))
            return true;
        if (now >= end || poll(&ready, 1, (int)((end - now) / 1000000) + 1) == 0)
            return false;
        ssize_t n = read(s->master, piece, sizeof piece);
        if (n > 0)
            buf_add(&s->seen, piece, (size_t)n);
        else if (n == 0 || errno != EINTR)
            return false;
    }
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

static void start(struct stage *s, void (*play)(void))
{
    int report[2], order[2];
    const struct winsize size = {.ws_row = 24, .ws_col = 80};
    *s = (struct stage){.master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)};
    grantpt(s->master);
    unlockpt(s->master);
    s->slave = open(ptsname(s->master), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ioctl(s->slave, TIOCSWINSZ, &size);
    tcgetattr(s->slave, &s->found);
    if (pipe(report) != 0 || pipe(order) != 0)
        exit(1);
    fflush(stdout);
    s->shell = fork();
    if (s->shell == 0) {
        close(report[0]);
        close(order[1]);
        run_shell(s->slave, report[1], order[0], play);
    }
    close(report[1]);
    close(order[0]);
    s->report = report[0];
    s->order = order[1];
    CHECK(read(s->report, &s->job, sizeof s->job) == sizeof s->job);
}

static int report_of(struct stage *s)
{
    int status = -1;
    for (int i = 0; i < 12000; i++) {
        struct pollfd ready = {.fd = s->report, .events = POLLIN};
        see(s, NULL, 5);
        if (poll(&ready, 1, 0) > 0)
            return read(s->report, &status, sizeof status) == sizeof status ? status : -1;
    }
    return -1;
}

static bool as_found(const struct stage *s)
{
    struct termios now;
    return tcgetattr(s->slave, &now) == 0 && now.c_iflag == s->found.c_iflag &&
           now.c_oflag == s->found.c_oflag && now.c_cflag == s->found.c_cflag &&
           now.c_lflag == s->found.c_lflag && memcmp(now.c_cc, s->found.c_cc, sizeof now.c_cc) == 0;
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
    while (waitpid(-1, NULL, WNOHANG) > 0) /* orphans come to us */
        ;
    return process_of(s->shell, "iftty-guardian") == 0;
}

static bool ends_with(const struct stage *s, const char *end)
{
    const size_t length = strlen(end);
    return s->seen.length >= length &&
           strcmp(buf_text(&s->seen) + s->seen.length - length, end) == 0;
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
static void start_ready(struct stage *s, void (*play)(void))
{
    start(s, play);
    CHECK(see(s, BEGIN "ready", 60000));
    for (int i = 0; i < 6000 && !s->guardian; i++) {
        usleep(i ? 10000 : 0);
        const pid_t found = process_of(s->shell, "iftty-guardian");
        s->guardian = found && descriptors_of(found) <= 4 ? found : 0;
    }
    CHECK(s->guardian > 0);
}

static void end(struct stage *s)
{
    kill(s->job, SIGKILL);
    CHECK(comes_true(s, guardian_is_gone));
    close(s->order);
    kill(s->shell, SIGKILL);
    waitpid(s->shell, NULL, 0);
    close(s->report);
    close(s->master);
    close(s->slave);
    buf_release(&s->seen);
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
    CHECK(as_found(s));
    CHECK(comes_true(s, has_ending)); /* what was written may still be on its way */
    see(s, NULL, 20);
    CHECK(has_ending(s)); /* and nothing after it */
}

STORY(killed_in_full_screen_the_guardian_restores_the_terminal)
{
    struct stage s;
    void (*const play[])(void) = {waits, waits_with_signals, leaves_a_child};
    for (int i = 0; i < 6; i++) { /* the process alone, or the whole job */
        start_ready(&s, play[i / 2]);
        CHECK(!as_found(&s));
        CHECK(play[i / 2] != leaves_a_child || see(&s, "forked", 60000));
        kill(i % 2 ? -s.job : s.job, SIGKILL);
        const int status = report_of(&s);
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
    CHECK(descriptors_of(s.guardian) <= 4 && descriptors_of(s.job) > 4);
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
    kill(s.job, SIGKILL);
    report_of(&s);
    check_restored(&s);
    end(&s);
}

STORY(after_an_end_of_its_own_nothing_is_left)
{
    static const struct {
        void (*play)(void);
        int status;
    } cases[] = {{ends_well, 0}, {forgets_to_close, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct stage s;
        start(&s, cases[i].play);
        const int status = report_of(&s);
        CHECK(WIFEXITED(status) && WEXITSTATUS(status) == cases[i].status);
        CHECK_INT(process_of(s.shell, "iftty-guardian"), 0); /* at once */
        CHECK(as_found(&s));
        CHECK(see(&s, END, 60000));
        end(&s);
    }
}

STORY(an_end_without_a_word_is_noticed_too)
{
    struct stage s;
    start(&s, goes_at_once);
    const int status = report_of(&s);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 4);
    check_restored(&s);
    end(&s);
}

/* The job stops without a word, somebody else has the terminal, and then it is killed. */
static void stop_and_kill(struct stage *s, void (*then)(struct stage *))
{
    kill(s->job, SIGSTOP);
    CHECK(WIFSTOPPED(report_of(s)));
    CHECK(!as_found(s));
    then(s);
    buf_clear(&s->seen);
    kill(s->job, SIGKILL);
    CHECK(comes_true(s, guardian_is_gone));
    see(s, NULL, 20);
}

static struct termios of_the_shell;

static void shell_sets_its_own_modes(struct stage *s)
{
    tcgetattr(s->slave, &of_the_shell);
    of_the_shell.c_oflag |= OPOST | ONLCR;
    of_the_shell.c_lflag |= ISIG;
    tcsetattr(s->slave, TCSANOW, &of_the_shell);
}

STORY(a_shell_that_came_first_keeps_its_modes_and_gets_the_screen)
{
    struct stage s;
    struct termios now;
    start_ready(&s, waits);
    stop_and_kill(&s, shell_sets_its_own_modes);
    CHECK(tcgetattr(s.slave, &now) == 0 && now.c_lflag == of_the_shell.c_lflag &&
          now.c_iflag == of_the_shell.c_iflag);
    CHECK(see(&s, END, 60000));
    end(&s);
}

static void order(struct stage *s, pid_t group)
{
    CHECK(write(s->order, &group, sizeof group) == sizeof group);
}

/* A group that there is in the session: the guardian's own. */
static void another_job_has_the_terminal(struct stage *s)
{
    order(s, s->guardian);
    for (int i = 0; i < 6000 && tcgetpgrp(s->master) != s->guardian; i++)
        usleep(10000);
    CHECK_INT(tcgetpgrp(s->master), s->guardian);
}

STORY(another_job_is_not_disturbed)
{
    struct stage s;
    start_ready(&s, waits);
    stop_and_kill(&s, another_job_has_the_terminal);
    CHECK_INT(s.seen.length, 0);
    CHECK(!as_found(&s));
    end(&s);
}

STORY(killed_while_stopped_there_is_nothing_to_give_back)
{
    struct stage s;
    start_ready(&s, waits);
    kill(s.job, SIGTSTP);
    CHECK(WIFSTOPPED(report_of(&s)));
    CHECK(as_found(&s));
    CHECK(see(&s, END, 60000) && ends_with(&s, END));
    const size_t before = s.seen.length;
    kill(s.job, SIGKILL);
    CHECK(comes_true(&s, guardian_is_gone));
    see(&s, NULL, 20);
    CHECK_INT(s.seen.length, before);
    end(&s);
}

STORY(stopped_and_continued_it_is_guarded_again)
{
    struct stage s;
    start_ready(&s, waits);
    kill(s.job, SIGTSTP);
    CHECK(WIFSTOPPED(report_of(&s)));
    buf_clear(&s.seen);
    order(&s, 0);
    CHECK(see(&s, BEGIN, 60000));
    kill(s.job, SIGKILL);
    report_of(&s);
    check_restored(&s);
    end(&s);
}

/* Waits until the job is in the middle of its frame: some of it is there, and more than the line
 * holds, since nobody reads. */
static void start_frame(struct stage *s)
{
    start_ready(s, writes_a_frame);
    CHECK(see(s, "readyp", 60000));
}

STORY(ctrl_c_cuts_no_frame_in_two)
{
    struct stage s;
    start_frame(&s);
    CHECK(write(s.master, "\003", 1) == 1);
    usleep(100000);
    const int status = report_of(&s);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 6);
    CHECK(see(&s, END, 60000));
    const char *text = buf_text(&s.seen), *first = strchr(text, 'p'), *last = strchr(text, '.');
    while (first && first[1] != 'p')
        first = strchr(first + 1, 'p');
    if (!CHECK(first && last && last - first == FRAME - 1))
        printf("#   %zu bytes, from %td to %td\n", s.seen.length, first ? first - text : -1,
               last ? last - text : -1);
    end(&s);
}

STORY(stopping_waits_for_the_end_of_a_frame)
{
    struct stage s;
    start_frame(&s);
    CHECK(write(s.master, "\032", 1) == 1);
    usleep(100000);
    CHECK(WIFSTOPPED(report_of(&s)));
    CHECK(as_found(&s));
    CHECK(see(&s, END, 60000));
    const char *end_of_frame = strstr(buf_text(&s.seen), "p.");
    CHECK(end_of_frame && strstr(end_of_frame, END));
    CHECK(strstr(buf_text(&s.seen), END) > end_of_frame);
    end(&s);
}

/* What a shell would find typed. */
static size_t left_to_read(struct stage *s)
{
    char bytes[256];
    struct termios raw = s->found;
    raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    raw.c_cc[VMIN] = raw.c_cc[VTIME] = 0;
    tcsetattr(s->slave, TCSANOW, &raw);
    ssize_t n = read(s->slave, bytes, sizeof bytes);
    return n > 0 ? (size_t)n : 0;
}

STORY(an_answer_that_is_due_at_sigterm_is_not_left_to_the_shell)
{
    struct stage s;
    start_ready(&s, waits_and_answers);
    kill(s.job, SIGTERM);
    CHECK(see(&s, RECOVER "\033[c" END, 60000));
    usleep(50000);
    CHECK(write(s.master, "\033[?62;4c", 8) == 8);
    const int status = report_of(&s);
    CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    CHECK(as_found(&s));
    CHECK_INT(left_to_read(&s), 0);
    end(&s);
}

STORY(sequences_change_in_order_and_the_end_is_written_once)
{
    struct stage s;
    start(&s, changes_sequences);
    CHECK_INT(report_of(&s), 0);
    see(&s, "bye", 60000);
    CHECK_TEXT(buf_text(&s.seen), "<prompt></prompt><pilot></pilot><prompt></prompt>bye");
    end(&s);
}

int main(void)
{
    alarm(900);
    prctl(PR_SET_CHILD_SUBREAPER, 1); /* guardians outlive their parents: see them go */
    return check_run();
}
