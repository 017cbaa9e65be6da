/* SPDX-License-Identifier: MIT */
/*
 * Limits of a replay: how much memory, time and output the journal of somebody else may take.
 *
 * Protects against: a journal that fills the memory or the disk, or never ends.
 *
 * One set for the process, because memory and time are the process's.
 *     (L1) memory is checked before a scene is loaded (mem_available), and again while commands
 *          work;
 *     (L2) time is checked while commands work and after each;
 *     (L3) output is checked before a file grows too large, by the kernel (RLIMIT_FSIZE), and after
 *          each command, whose files are removed again;
 *     (L4) what is beyond a limit ends the replay with ERR_LIMIT, and words that name the option.
 * The image helper is a process of its own, and may hold as much memory again, or 512 MB where that
 * is more.
 */
#ifndef SANDBOX_LIMITS_H
#define SANDBOX_LIMITS_H

#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"

struct limits {
    uint64_t memory_bytes; /* 0: three quarters of what is free at the beginning */
    uint64_t time_ms;      /* 0: an hour */
    uint64_t output_bytes; /* 0: 4 GB */
};

/* Texts as options give them, or NULL: "500M", "2G" (powers of 1000) and "90", "1.5h", "20m",
 * "90s". ERR_USAGE. */
enum err limits_read(struct limits *limits, const char *memory, const char *time,
                     const char *output, struct fault *fault);

/* From now on they hold. */
void limits_begin(const struct limits *limits);

/* While a person looks at what the journal has come to, or thinks, its time stands still. */
void limits_rest(bool rests);

/* Whether the work is to stop, for the poll of a watch; limits_watch is a watch that polls nothing
 * else, or NULL where no limits hold. */
bool limits_stop(void);
struct watch *limits_watch(void);

/* A file is about to be written: it cannot grow beyond what is left. */
void limits_will_write(void);

/* A command has ended with `err`, and has written files: pairs of a path and another text, each
 * ended by NUL. What it is to end with. */
enum err limits_judge(enum err err, const struct buf *written, struct fault *fault);

#endif
