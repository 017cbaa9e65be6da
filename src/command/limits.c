/* SPDX-License-Identifier: MIT */
#include "command/limits.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/scan.h"
#include "image/image_helper.h"
#include "image/volume_helper.h"

enum { POLL_EVERY_NS = 20000000 };
static const uint64_t DEFAULT_TIME_MS = 3600000, DEFAULT_OUTPUT = 4000000000;
static const uint64_t HELPER_LEAST = 512000000; /* with less it could not write every picture */

enum state { WITHIN, TOO_LONG, TOO_MUCH_MEMORY, TOO_MUCH_OUTPUT };

static struct {
    bool hold;
    struct limits limits;
    uint64_t begun_ns, polled_ns, output_bytes;
    uint64_t rests_since_ns; /* 0: it works */
    enum state state;
    struct rlimit file_size; /* as it was */
    bool is_file_size_set;
} now;

/* ---- options ---- */

/* A decimal with one of the units, each of which is worth so many; at least 1, at most 2^53. */
static bool read_amount(uint64_t *out, const char *text, const char *units, const uint64_t *worth)
{
    int64_t thousandths;
    if (!scan_decimal(&text, 3, 1, INT64_C(1000000000000), &thousandths) || strlen(text) > 1)
        return false;
    const char *unit = strchr(units, *text ? *text : ' ');
    if (!unit)
        return false;
    if (__builtin_mul_overflow((uint64_t)thousandths, worth[unit - units], out))
        return false;
    *out /= 1000;
    return *out > 0 && *out < UINT64_C(1) << 53;
}

enum err limits_read(struct limits *limits, const char *memory, const char *time,
                     const char *output, struct fault *fault)
{
    static const char bytes[] = " kMGT", spans[] = " smh";
    static const uint64_t bytes_worth[] = {1, 1000, 1000000, 1000000000, 1000000000000};
    static const uint64_t spans_worth[] = {1000, 1000, 60000, 3600000};
    static const char some_bytes[] = "bytes such as 500M or 2G";
    const struct {
        const char *name, *text, *units, *expected;
        const uint64_t *worth;
        uint64_t *out;
    } option[] = {
        {"memory", memory, bytes, some_bytes, bytes_worth, &limits->memory_bytes},
        {"time", time, spans, "seconds such as 90, or 20m or 1h", spans_worth, &limits->time_ms},
        {"output", output, bytes, some_bytes, bytes_worth, &limits->output_bytes}};
    *limits = (struct limits){0};
    for (size_t i = 0; i < sizeof option / sizeof *option; i++)
        if (option[i].text &&
            !read_amount(option[i].out, option[i].text, option[i].units, option[i].worth))
            return fault_set(fault, ERR_USAGE, "--limit-%s: expected %s, not %s", option[i].name,
                             option[i].expected, option[i].text);
    return OK;
}

/* ---- while they hold ---- */

void limits_begin(const struct limits *limits)
{
    now.hold = true;
    now.limits = *limits;
    now.begun_ns = clock_ns();
    now.polled_ns = 0;
    now.output_bytes = 0;
    now.state = WITHIN;
    const size_t free_bytes = mem_available();
    if (!now.limits.memory_bytes)
        now.limits.memory_bytes = free_bytes / 4 * 3;
    if (!now.limits.time_ms)
        now.limits.time_ms = DEFAULT_TIME_MS;
    if (!now.limits.output_bytes)
        now.limits.output_bytes = DEFAULT_OUTPUT;
    mem_limit(now.limits.memory_bytes < SIZE_MAX ? (size_t)now.limits.memory_bytes : SIZE_MAX);
    image_helper_memory_most =
        now.limits.memory_bytes > HELPER_LEAST ? now.limits.memory_bytes : HELPER_LEAST;
    volume_helper_memory_most = image_helper_memory_most;
    volume_helper_is_wary = true;
    signal(SIGXFSZ, SIG_IGN); /* a write that would grow a file too large is an error of its own */
}

void limits_rest(bool rests)
{
    const uint64_t ns = clock_ns();
    if (rests && !now.rests_since_ns)
        now.rests_since_ns = ns;
    if (!rests && now.rests_since_ns) {
        now.begun_ns += ns - now.rests_since_ns;
        now.rests_since_ns = 0;
    }
}

bool limits_stop(void)
{
    const uint64_t ns = clock_ns();
    if (!now.hold || now.state != WITHIN || ns - now.polled_ns < POLL_EVERY_NS)
        return now.state != WITHIN;
    now.polled_ns = ns;
    const uint64_t works_until_ns = now.rests_since_ns ? now.rests_since_ns : ns;
    if (works_until_ns - now.begun_ns > now.limits.time_ms * 1000000)
        now.state = TOO_LONG;
    else if (mem_held() > now.limits.memory_bytes)
        now.state = TOO_MUCH_MEMORY;
    return now.state != WITHIN;
}

static bool poll_limits(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)context, (void)what, (void)done, (void)total;
    return limits_stop();
}

struct watch *limits_watch(void)
{
    static struct watch watch = {.poll = poll_limits};
    return now.hold ? &watch : NULL;
}

void limits_will_write(void)
{
    if (!now.hold || now.is_file_size_set || getrlimit(RLIMIT_FSIZE, &now.file_size) != 0)
        return;
    const uint64_t left = now.limits.output_bytes - now.output_bytes;
    struct rlimit wanted = now.file_size;
    if (left < wanted.rlim_cur)
        wanted.rlim_cur = (rlim_t)left;
    now.is_file_size_set = setrlimit(RLIMIT_FSIZE, &wanted) == 0;
}

/* ---- after a command ---- */

/* What the journal does beyond a limit, and what became of that. */
static enum err refuse(enum state state, const char *end, struct fault *fault)
{
    const struct {
        const char *does, *unit, *option;
        double most;
    } limit[] = {
        [TOO_LONG] = {"takes longer", "s", "time", (double)now.limits.time_ms / 1e3},
        [TOO_MUCH_MEMORY] = {"takes more", "MB", "memory", (double)now.limits.memory_bytes / 1e6},
        [TOO_MUCH_OUTPUT] = {"writes more", "MB", "output", (double)now.limits.output_bytes / 1e6},
    };
    return fault_set(fault, ERR_LIMIT, "the journal %s than the %g %s of --limit-%s; %s",
                     limit[state].does, limit[state].most, limit[state].unit, limit[state].option,
                     end);
}

enum err limits_judge(enum err err, const struct buf *written, struct fault *fault)
{
    if (!now.hold)
        return err;
    const bool files_were_limited = now.is_file_size_set;
    if (files_were_limited)
        setrlimit(RLIMIT_FSIZE, &now.file_size);
    now.is_file_size_set = false;
    now.polled_ns = 0;
    limits_stop();
    if (now.state != WITHIN)
        return refuse(now.state, "it was stopped", fault);
    /* An error that a limit has caused names its option. */
    if ((err == ERR_LIMIT || err == ERR_MEMORY) && fault && strstr(fault->text, "memory"))
        fault_prefix(fault, err, "--limit-memory allows %g MB",
                     (double)now.limits.memory_bytes / 1e6);
    if (err == ERR_IO && files_were_limited && fault &&
        (strstr(fault->text, strerror(EFBIG)) || strstr(fault->text, strsignal(SIGXFSZ))))
        return refuse(TOO_MUCH_OUTPUT, "this file was removed", fault);
    if (err)
        return err;
    uint64_t bytes = 0;
    for (const char *at = buf_text(written), *end = at + written->length; at < end;) {
        struct stat status;
        if (lstat(at, &status) == 0)
            bytes += (uint64_t)status.st_size;
        at += strlen(at) + 1; /* the path */
        at += strlen(at) + 1; /* and what belongs to it */
    }
    if (bytes > now.limits.output_bytes - now.output_bytes)
        return refuse(TOO_MUCH_OUTPUT, "this file was removed", fault);
    now.output_bytes += bytes;
    return OK;
}
