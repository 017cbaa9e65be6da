/* SPDX-License-Identifier: MIT */
/* A job in a pseudo-terminal: a small shell starts it in the foreground, reports how it stops or
 * ends, takes the terminal back as shells do, and continues it on request. */
#ifndef TESTS_JOB_H
#define TESTS_JOB_H

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/clock.h"
#include "tests/check.h"

struct job {
    int master, slave, report, order;
    pid_t shell, process;
    struct termios found;
    struct buf seen;              /* everything that was written to the terminal */
    size_t mark;                  /* job_see searches from here */
    void (*answer)(struct job *); /* the terminal's answers, called often; or NULL, */
    bool is_late;                 /* and it still has something to say */
};

/* The shell stays until the end, since the terminal hangs up with it. An order is another process
 * group that gets the terminal, or 0 for the job, which is then continued. */
static inline void job_shell(int slave, int report, int order, void (*play)(const void *),
                             const void *context)
{
    int status;
    pid_t other = 0;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
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
        play(context);
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

static inline void job_start(struct job *j, void (*play)(const void *), const void *context)
{
    int report[2], order[2];
    const struct winsize size = {.ws_row = 24, .ws_col = 80, .ws_xpixel = 800, .ws_ypixel = 480};
    *j = (struct job){.master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)};
    grantpt(j->master);
    unlockpt(j->master);
    j->slave = open(ptsname(j->master), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ioctl(j->slave, TIOCSWINSZ, &size);
    tcgetattr(j->slave, &j->found);
    if (pipe(report) != 0 || pipe(order) != 0)
        exit(1);
    fflush(stdout);
    j->shell = fork();
    if (j->shell == 0) {
        close(report[0]);
        close(order[1]);
        job_shell(j->slave, report[1], order[0], play, context);
    }
    close(report[1]);
    close(order[0]);
    j->report = report[0];
    j->order = order[1];
    CHECK(read(j->report, &j->process, sizeof j->process) == sizeof j->process);
}

/* Read the output of the job for up to `ms`, or until `text` appears after the mark. */
static inline bool job_see(struct job *j, const char *text, int ms)
{
    const uint64_t end = clock_ns() + (uint64_t)ms * 1000000;
    for (;;) {
        char piece[4096];
        struct pollfd ready = {.fd = j->master, .events = POLLIN};
        if (j->answer) /* before the next keys of the story */
            j->answer(j);
        const char *found = text ? strstr(buf_text(&j->seen) + j->mark, text) : NULL;
        const uint64_t now = clock_ns();
        if (found)
            j->mark = (size_t)(found - j->seen.data) + strlen(text);
        if (found || now >= end)
            return found != NULL;
        if (poll(&ready, 1, j->is_late ? 2 : (int)((end - now) / 1000000) + 1) == 0)
            continue;
        const ssize_t n = read(j->master, piece, sizeof piece);
        if (n > 0)
            buf_add(&j->seen, piece, (size_t)n);
        else if (n == 0 || errno != EINTR)
            return false;
    }
}

/* Wait until the job stops or ends; its wait status, or -1 when nothing happens. */
static inline int job_report(struct job *j)
{
    int status = -1;
    for (int i = 0; i < 12000; i++) {
        struct pollfd ready = {.fd = j->report, .events = POLLIN};
        job_see(j, NULL, 5); /* it may wait for us to read */
        if (poll(&ready, 1, 0) > 0)
            return read(j->report, &status, sizeof status) == sizeof status ? status : -1;
    }
    return -1;
}

static inline void job_order(const struct job *j, pid_t group)
{
    CHECK(write(j->order, &group, sizeof group) == sizeof group);
}

static inline bool job_has_modes_as_found(const struct job *j)
{
    struct termios now;
    return tcgetattr(j->slave, &now) == 0 && now.c_iflag == j->found.c_iflag &&
           now.c_oflag == j->found.c_oflag && now.c_cflag == j->found.c_cflag &&
           now.c_lflag == j->found.c_lflag && memcmp(now.c_cc, j->found.c_cc, sizeof now.c_cc) == 0;
}

/* The bytes that a shell would find typed. */
static inline size_t job_left_to_read(struct job *j)
{
    char bytes[256];
    struct termios raw = j->found;
    raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    raw.c_cc[VMIN] = raw.c_cc[VTIME] = 0;
    tcsetattr(j->slave, TCSANOW, &raw);
    const ssize_t n = read(j->slave, bytes, sizeof bytes);
    return n > 0 ? (size_t)n : 0;
}

static inline void job_end(struct job *j)
{
    close(j->order);
    job_see(j, NULL, 5);
    kill(j->shell, SIGKILL);
    kill(j->process, SIGKILL);
    waitpid(j->shell, NULL, 0);
    close(j->report);
    close(j->master);
    close(j->slave);
    buf_release(&j->seen);
}

#endif
