/* SPDX-License-Identifier: MIT */
#include "base/watch.h"

#include <stdarg.h>
#include <stdio.h>

void watch_begin(struct watch *watch)
{
    if (!watch)
        return;
    watch->stopped = false;
    watch->ignores_stop = watch->wants_show = false;
}

void watch_ignore_stop(struct watch *watch)
{
    watch_begin(watch);
    if (watch)
        watch->ignores_stop = true;
}

void watch_announce(struct watch *watch, const char *format, ...)
{
    char line[256];
    va_list words;
    if (!watch || !watch->announce || watch->is_quiet)
        return;
    va_start(words, format);
    vsnprintf(line, sizeof line, format, words);
    va_end(words);
    watch->announce(watch->context, line);
}

bool watch_poll(struct watch *watch, const char *what, uint64_t done, uint64_t total)
{
    if (!watch)
        return false;
    const bool stop = watch->poll(watch->context, watch->is_quiet ? NULL : what, done, total);
    watch->stopped = watch->stopped || (stop && !watch->ignores_stop);
    return watch->stopped;
}

bool watch_wants_show(const struct watch *watch)
{
    return watch && watch->show && watch->wants_show;
}

void watch_show(struct watch *watch)
{
    watch->wants_show = false;
    watch->show(watch->context);
}

bool watch_stops(struct watch *watch)
{
    return watch_poll(watch, NULL, 0, 0);
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
    const uint64_t step = watch && watch->step ? watch->step : TASK_STEP;
    return (struct task){watch, what, 0, total, watch ? step : UINT64_MAX, step, part > 0};
}

bool task_poll(struct task *task)
{
    const bool stop = task->only_stops
                          ? task->watch->stopped
                          : watch_poll(task->watch, task->what, task->done, task->total);
    task->next = stop ? 0 : task->done + task->step;
    return !stop;
}
