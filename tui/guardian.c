/* SPDX-License-Identifier: MIT */
#include "tui/guardian.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* The child's descriptors. */
enum { IN, OUT, PIPE, PARENT, DESCRIPTORS };

struct watch {
    const struct guarded *guarded;
    pid_t job, shell; /* process groups */
};

/* ---- in the child: system calls alone, since other threads may have held any lock ---- */

/* Where the foreground job is not known, the modes decide. */
static void give_back(const struct watch *w)
{
    const struct guarded *g = w->guarded;
    const pid_t foreground = tcgetpgrp(IN);
    const tcflag_t passing = FLUSHO | PENDIN;
    struct termios now;
    const bool ours = tcgetattr(IN, &now) == 0 && now.c_iflag == g->ours.c_iflag &&
                      now.c_oflag == g->ours.c_oflag &&
                      (now.c_lflag & ~passing) == (g->ours.c_lflag & ~passing);
    if (foreground < 0 ? !ours : foreground != w->job && foreground != w->shell)
        return;
    if (ours) {
        tcsetattr(IN, TCSANOW, &g->found);
        tcflush(IN, TCIFLUSH); /* answers that nobody awaits any more, reports of the mouse */
    }
    ssize_t ignored = write(OUT, g->words[g->which].text, g->words[g->which].length);
    (void)ignored; /* nothing can be done about it */
}

static _Noreturn void guard(const struct watch *w, int from[DESCRIPTORS])
{
    struct pollfd ready[2] = {{.fd = PIPE, .events = POLLIN},
                              {.fd = from[PARENT] >= 0 ? PARENT : -1, .events = POLLIN}};
    prctl(PR_SET_NAME, "iftty-guardian");
    setpgid(0, 0);
    const struct sigaction usual = {.sa_handler = SIG_DFL}, ignored = {.sa_handler = SIG_IGN};
    sigset_t none;
    for (int number = 1; number < NSIG; number++) {
        const bool crash = number == SIGSEGV || number == SIGBUS || number == SIGILL ||
                           number == SIGFPE || number == SIGABRT;
        sigaction(number, crash ? &usual : &ignored, NULL);
    }
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    /* Puts what is to stay in its places, by way of places that nothing needs. */
    for (int i = 0; i < DESCRIPTORS; i++)
        from[i] = from[i] < 0 ? -1 : fcntl(from[i], F_DUPFD, DESCRIPTORS);
    for (int i = 0; i < DESCRIPTORS; i++) {
        close(i);
        if (from[i] >= 0)
            dup2(from[i], i);
    }
    closefrom(DESCRIPTORS);
    int unused = chdir("/");
    (void)unused;
    while (poll(ready, 2, -1) <= 0)
        ;
    if (w->guarded->on)
        give_back(w);
    _exit(0);
}

/* ---- in the parent ---- */

void guardian_start(struct guardian *g, int in, int out)
{
    static struct guarded unshared;
    int ends[2];
    sigset_t all, before;
    if (!g->guarded) {
        void *place = mmap(NULL, sizeof(struct guarded), PROT_READ | PROT_WRITE,
                           MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        g->guarded = place == MAP_FAILED ? &unshared : place;
    }
    *g = (struct guardian){.guarded = g->guarded, .pipe = -1};
    if (pipe2(ends, O_CLOEXEC) != 0)
        return;
    const struct watch watch = {g->guarded, getpgrp(), getpgid(getppid())};
    int parent = (int)syscall(SYS_pidfd_open, getpid(), 0);
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, &before); /* no handler of ours runs in the child */
    const pid_t process = fork();
    if (process == 0) {
        close(ends[1]);
        guard(&watch, (int[]){in, out, ends[0], parent});
    }
    sigprocmask(SIG_SETMASK, &before, NULL);
    close(ends[0]);
    if (parent >= 0)
        close(parent);
    if (process < 0)
        close(ends[1]);
    else
        *g = (struct guardian){g->guarded, process, ends[1]};
}

void guardian_end(struct guardian *g)
{
    if (g->process <= 0)
        return;
    kill(g->process, SIGKILL); /* it has nothing to do: sooner than waiting for it to find out */
    while (waitpid(g->process, NULL, 0) < 0 && errno == EINTR)
        ;
    close(g->pipe);
    g->process = 0;
}

void guardian_set_words(struct guardian *g, const char *text, size_t length)
{
    if (!g->guarded || length > GUARDIAN_WORDS)
        return;
    const int other = !g->guarded->which;
    memcpy(g->guarded->words[other].text, text, length);
    g->guarded->words[other].length = length;
    g->guarded->which = other;
}
