#include "base/watch.h"

#include <stdarg.h>
#include <stdio.h>

void watch_begin(struct watch *watch)
{
    if (!watch)
        return;
    watch->stopped = false;
    watch->deaf = false;
}

void watch_deafen(struct watch *watch)
{
    watch_begin(watch);
    if (watch)
        watch->deaf = true;
}

void watch_tell(struct watch *watch, const char *format, ...)
{
    char line[256];
    va_list words;
    if (!watch || !watch->tell)
        return;
    va_start(words, format);
    vsnprintf(line, sizeof line, format, words);
    va_end(words);
    watch->tell(watch->context, line);
}

bool watch_look(struct watch *watch, const char *what, uint64_t done, uint64_t total)
{
    if (!watch)
        return false;
    const bool stop = watch->look(watch->context, what, done, total);
    watch->stopped = watch->stopped || (stop && !watch->deaf);
    return watch->stopped;
}

bool watch_stops(struct watch *watch)
{
    return watch_look(watch, NULL, 0, 0);
}

enum err watch_fault(struct watch *watch, struct fault *fault)
{
    if (!watch_stops(watch))
        return OK;
    return fault_set(fault, ERR_CANCELLED, "cancelled; nothing has changed");
}

struct task task_begin(struct watch *watch, const char *what, uint64_t total)
{
    return task_begin_part(watch, what, total, 0);
}

struct task task_begin_part(struct watch *watch, const char *what, uint64_t total, uint64_t part)
{
    return (struct task){watch, what, 0, total, watch ? TASK_STEP : UINT64_MAX, part > 0};
}

bool task_look(struct task *task)
{
    const bool stop = task->aside ? task->watch->stopped
                                  : watch_look(task->watch, task->what, task->done, task->total);
    task->next = stop ? 0 : task->done + TASK_STEP;
    return !stop;
}
