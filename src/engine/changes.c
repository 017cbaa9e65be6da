/* SPDX-License-Identifier: MIT */
#include "engine/changes.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { VOXELS_A_CHANGE = 16 };

void change_log_add(struct change_log *log, const struct changes *changes, size_t voxels)
{
    const size_t count = log->count + changes->count;
    if (!log->follows)
        return;
    if (changes->everything || count > voxels / VOXELS_A_CHANGE ||
        !mem_grow(&log->item, &log->capacity, count, sizeof *log->item)) {
        change_log_give_up(log);
        return;
    }
    if (changes->count)
        memcpy(log->item + log->count, changes->item, changes->count * sizeof *log->item);
    log->count = count;
}

void change_log_give_up(struct change_log *log)
{
    log->follows = false;
    log->count = 0;
}

enum err change_log_settle(struct change_log *log, enum err err)
{
    log->follows = !err;
    log->count = 0;
    return err;
}

void change_log_release(struct change_log *log)
{
    free(log->item);
    *log = (struct change_log){0};
}
