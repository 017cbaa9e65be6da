/* SPDX-License-Identifier: MIT */
#include "base/owner.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/scan.h"

enum { PART_DIGITS = 5, STARTED_FIELD = 22 }; /* of /proc/PID/stat, from 1 */
enum { MACHINE, BOOT, SPACE, PARTS };

static const uint64_t has_ended = UINT64_MAX;

static uint64_t mix_text(uint64_t sum, const char *text)
{
    while (*text)
        sum = hash_mix(sum ^ (unsigned char)*text++);
    return sum;
}

/* A small file of the system; nothing where it cannot be read. */
static uint64_t mix_file(uint64_t sum, const char *path)
{
    char text[256];
    FILE *file = fopen(path, "re");
    if (!file)
        return sum;
    if (fgets(text, sizeof text, file))
        sum = mix_text(sum, text);
    fclose(file);
    return sum;
}

static void read_system(uint64_t part[PARTS])
{
    struct utsname names = {0};
    struct stat space = {0};
    uname(&names);
    stat("/proc/self/ns/pid", &space);
    part[MACHINE] = mix_file(mix_text(1, names.nodename), "/etc/machine-id");
    part[BOOT] = mix_file(2, "/proc/sys/kernel/random/boot_id");
    part[SPACE] = hash_mix(space.st_ino);
    for (int i = 0; i < PARTS; i++)
        part[i] &= ((uint64_t)1 << 4 * PART_DIGITS) - 1;
}

/* When the process began, in the system's ticks: 0 where it cannot be seen, has_ended where it has
 * ended and nobody has waited for it. A line is "4711 (any name) S 1 ...". */
static uint64_t started(long process)
{
    char path[64], line[1024];
    snprintf(path, sizeof path, "/proc/%ld/stat", process);
    FILE *file = fopen(path, "re");
    if (!file)
        return 0;
    const char *at = fgets(line, sizeof line, file) ? strrchr(line, ')') : NULL;
    fclose(file);
    if (at && strncmp(at, ") Z", 3) == 0)
        return has_ended;
    for (int field = 2; at && field < STARTED_FIELD; field++)
        at = strchr(at + 1, ' ');
    return at ? strtoull(at, NULL, 10) : 0;
}

void owner_write(struct buf *out)
{
    const long process = (long)getpid();
    uint64_t part[PARTS];
    read_system(part);
    for (int i = 0; i < PARTS; i++)
        buf_printf(out, "%0*" PRIx64, PART_DIGITS, part[i]);
    buf_printf(out, "-%lx-%" PRIx64, (unsigned long)process, started(process));
}

static enum owner_state judge(const uint64_t part[PARTS], uint64_t process, uint64_t began)
{
    uint64_t here[PARTS];
    read_system(here);
    if (part[MACHINE] != here[MACHINE])
        return OWNER_IS_HIDDEN;
    if (part[BOOT] != here[BOOT])
        return OWNER_IS_GONE;
    if (part[SPACE] != here[SPACE])
        return OWNER_IS_HIDDEN;
    const uint64_t now = started((long)process);
    if (now == 0)
        return kill((pid_t)process, 0) == 0 || errno == EPERM ? OWNER_LIVES : OWNER_IS_GONE;
    return now != has_ended && (now == began || !began) ? OWNER_LIVES : OWNER_IS_GONE;
}

static bool scan_any_hex(const char **cursor, uint64_t most, uint64_t *out)
{
    const unsigned digits = (unsigned)strspn(*cursor, "0123456789abcdef");
    const char *at = *cursor;
    if (digits < 1 || digits > 16 || !scan_hex(&at, digits, out) || *out > most)
        return false;
    *cursor = at;
    return true;
}

bool owner_read(const char **cursor, enum owner_state *state)
{
    const char *at = *cursor;
    uint64_t part[PARTS], process, began;
    for (int i = 0; i < PARTS; i++)
        if (!scan_hex(&at, PART_DIGITS, &part[i]))
            return false;
    if (!scan_text(&at, "-") || !scan_any_hex(&at, INT32_MAX, &process) || process == 0 ||
        !scan_text(&at, "-") || !scan_any_hex(&at, UINT64_MAX, &began))
        return false;
    *state = judge(part, process, began);
    *cursor = at;
    return true;
}
