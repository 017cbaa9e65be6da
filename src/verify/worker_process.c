#include "verify/worker_process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LOOK_MS = 100, PIECE = 1 << 20 };

static _Noreturn void go(const struct worker_process *worker, int descriptor, pid_t parent)
{
    struct buf bytes = {0};
    if (signal(SIGINT, SIG_DFL) == SIG_IGN)
        signal(SIGINT, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(1);
    worker->work(worker->context, &bytes);
    for (size_t sent = 0; !bytes.failed && sent < bytes.length;) {
        const ssize_t n = write(descriptor, bytes.data + sent, bytes.length - sent);
        if (n < 0 && errno != EINTR)
            _exit(1);
        sent += n > 0 ? (size_t)n : 0;
    }
    _exit(bytes.failed);
}

/* Waits a little while for bytes, and takes them; *over at their end. */
static enum err take(struct buf *out, const struct worker_process *worker, int descriptor,
                     bool *over, struct fault *fault)
{
    struct pollfd wait = {descriptor, POLLIN, 0};
    if (watch_stops(worker->watch))
        return fault_set(fault, ERR_CANCELLED, "cancelled");
    if (poll(&wait, 1, LOOK_MS) <= 0)
        return OK;
    char *room = buf_reserve(out, PIECE);
    if (!room)
        return fault_memory(fault, "what a process hands back");
    const ssize_t n = read(descriptor, room, PIECE);
    if (n < 0 && errno != EINTR && errno != EAGAIN)
        return fault_errno(fault, "read from", "a process");
    out->length += n > 0 ? (size_t)n : 0;
    out->data[out->length] = '\0';
    *over = n == 0;
    return out->length > worker->most
               ? fault_set(fault, ERR_INPUT, "its process hands back more than it may")
               : OK;
}

static enum err judge(int status, struct fault *fault)
{
    if (WIFSIGNALED(status))
        return fault_set(fault, ERR_INPUT, "its process was ended by signal %d (%s)",
                         WTERMSIG(status), strsignal(WTERMSIG(status)));
    return status ? fault_memory(fault, "what a process hands back") : OK;
}

enum err worker_process_run(struct buf *out, const struct worker_process *worker,
                            struct fault *fault)
{
    int end[2], status = 0;
    bool over = false;
    const pid_t parent = getpid();
    if (pipe2(end, O_CLOEXEC) != 0)
        return fault_errno(fault, "make", "a pipe");
    const pid_t process = fork();
    if (process == 0)
        go(worker, end[1], parent);
    close(end[1]);
    enum err err = process < 0 ? fault_errno(fault, "start", "a process") : OK;
    while (!err && !over)
        err = take(out, worker, end[0], &over, fault);
    if (err && process > 0)
        kill(process, SIGKILL);
    close(end[0]);
    while (process > 0 && waitpid(process, &status, 0) < 0 && errno == EINTR)
        ;
    return err ? err : judge(status, fault);
}
