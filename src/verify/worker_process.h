/*
 * An worker: work on what is not trusted, in a process of its own that may be confined, crash or be
 * killed, and hands back bytes. It does not outlive the one that sent it.
 */
#ifndef VERIFY_WORKER_PROCESS_H
#define VERIFY_WORKER_PROCESS_H

#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"

struct worker_process {
    void (*work)(void *context,
                 struct buf *out); /* in that process; what it changes goes with it */
    void *context;
    uint64_t most;       /* bytes that it may hand back */
    struct watch *watch; /* when it stops, the process is ended: ERR_CANCELLED. Or NULL */
};

/* Adds what the work has added to its `out` to ours. ERR_INPUT, naming the signal, where it was
 * killed, and where it hands back too much; ERR_MEMORY, ERR_IO. `out` may hold a part of it then.
 */
enum err worker_process_run(struct buf *out, const struct worker_process *worker,
                            struct fault *fault);

#endif
