/* SPDX-License-Identifier: MIT */
#include "command/trust.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"
#include "image/image_helper.h"
#include "image/volume.h"
#include "image/volume_helper.h"

enum { POLL_EVERY_NS = 20000000 };
static const uint64_t DEFAULT_TIME_MS = 3600000, DEFAULT_OUTPUT = 4000000000;
static const uint64_t HELPER_LEAST =
    512000000; /* the least with which it can write every picture */

enum state { WITHIN, TOO_LONG, TOO_MUCH_MEMORY, TOO_MUCH_OUTPUT };

static struct {
    bool hold;
    struct limits limits;
    uint64_t begun_ns, polled_ns, output_bytes;
    uint64_t rests_since_ns; /* 0: not resting */
    enum state state;
    struct rlimit file_size; /* as it was */
    bool is_file_size_set;
} now;

/* ---- options ---- */

/* Read a decimal with a unit; `worth` has the factor of each unit. The result is 1 to 2^53. */
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
    signal(SIGXFSZ, SIG_IGN); /* so that writing too much is an error, not a signal */
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

/* Report the exceeded limit and its consequence. */
static enum err refuse_limit(enum state state, const char *end, struct fault *fault)
{
    const struct {
        const char *does, *unit, *option;
        double most;
    } limit[] = {
        [TOO_LONG] = {"runs longer", "s", "time", (double)now.limits.time_ms / 1e3},
        [TOO_MUCH_MEMORY] = {"uses more", "MB", "memory", (double)now.limits.memory_bytes / 1e6},
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
        return refuse_limit(now.state, "it was stopped", fault);
    /* Name the option if a limit has caused the error. */
    if ((err == ERR_LIMIT || err == ERR_MEMORY) && fault && strstr(fault->text, "memory"))
        fault_prefix(fault, err, "--limit-memory allows %g MB",
                     (double)now.limits.memory_bytes / 1e6);
    if (err == ERR_IO && files_were_limited && fault &&
        (strstr(fault->text, strerror(EFBIG)) || strstr(fault->text, strsignal(SIGXFSZ))))
        return refuse_limit(TOO_MUCH_OUTPUT, "this file was removed", fault);
    if (err)
        return err;
    uint64_t bytes = 0;
    for (const char *at = buf_text(written), *end = at + written->length; at < end;) {
        struct stat status;
        if (lstat(at, &status) == 0)
            bytes += (uint64_t)status.st_size;
        at += strlen(at) + 1; /* the path */
        at += strlen(at) + 1; /* and its backup */
    }
    if (bytes > now.limits.output_bytes - now.output_bytes)
        return refuse_limit(TOO_MUCH_OUTPUT, "this file was removed", fault);
    now.output_bytes += bytes;
    return OK;
}

/* Headers whose voxels may be in other files of the same folder. */
static const char HEADERS_ALONE[] = ".mhd|.nhdr|.h5|.hdf5|.hdf|.ims";

/* ---- names in a journal ---- */

static enum path_kind look_in(struct buf *path, const char *folder, size_t length, const char *name)
{
    buf_clear(path);
    buf_add(path, folder, length);
    const enum path_kind answer =
        path->failed ? PATH_IS_MISSING : path_kind_below(buf_text(path), name);
    buf_printf(path, "/%s", name);
    return answer;
}

/* The first place with this name decides: a link that leads out is an error, and the folders of
 * scenes are not searched. */
static enum path_kind look_everywhere(struct buf *path, const char *home, const char *scenes,
                                      const char *name)
{
    OWNED(buf_release) struct buf folder = {0};
    file_folder(&folder, home);
    enum path_kind answer = look_in(path, buf_text(&folder), folder.length, name);
    while (answer == PATH_IS_MISSING && *scenes) {
        const size_t length = strcspn(scenes, ":");
        if (length)
            answer = look_in(path, scenes, length, name);
        scenes += length + (scenes[length] == ':');
    }
    path->failed |= folder.failed;
    return answer;
}

/* OK for a file that may be read, or a folder if allowed; else the error. */
static enum err check_answer(enum path_kind answer, const char *name,
                             const struct trust_sought *sought, struct fault *fault)
{
    const char *where = *sought->hint ? "" : " ($IFTTY_SCENES names their folders)";
    switch (sought->by_proof && answer == PATH_IS_OUTSIDE ? PATH_IS_MISSING : answer) {
    case PATH_IS_FILE:
        return OK;
    case PATH_IS_OUTSIDE:
        return fault_set(fault, ERR_INPUT,
                         "the journal may not read %s, which leads out of its folder%s; nothing %s",
                         name, sought->hint, sought->undone);
    case PATH_IS_FOLDER:
        if (sought->is_scene)
            return OK;
        __attribute__((fallthrough));
    case PATH_IS_SPECIAL:
        return fault_set(fault, ERR_INPUT, "%s is not a regular file; nothing %s", name,
                         sought->undone);
    case PATH_IS_MISSING:
        break;
    }
    return fault_set(fault, ERR_IO,
                     "there is no %s %s next to the journal or among the scenes%s%s; nothing %s",
                     sought->kind, name, where, sought->hint, sought->undone);
}

/* Check the other file of a pair, with `name` found as `path`; PATH_IS_FILE without one. */
static enum path_kind look_at_other(struct buf *other, const struct buf *path, const char *name)
{
    const size_t length = path->length - strlen(name) - 1;
    OWNED(buf_release) struct buf folder = {0};
    enum path_kind answer = PATH_IS_FILE;
    buf_add(&folder, path->data, length);
    if (pair_other(other, buf_text(path)) && !folder.failed)
        answer = path_kind_below(buf_text(&folder), buf_text(other) + length + 1);
    other->failed |= folder.failed;
    return answer;
}

enum err trust_find(struct buf *path, const char *home, const char *scenes, const char *name,
                    const struct trust_sought *sought, struct fault *fault)
{
    OWNED(buf_release) struct buf other = {0};
    enum path_kind answer = look_everywhere(path, home, scenes, name);
    const char *last = name;
    if (!path->failed && answer == PATH_IS_FILE) {
        const size_t length = path->length - strlen(name);
        answer = look_at_other(&other, path, name);
        if (answer == PATH_IS_FOLDER)
            answer = PATH_IS_SPECIAL;
        last = answer == PATH_IS_FILE || sought->by_proof ? name : buf_text(&other) + length;
    }
    return path->failed || other.failed ? fault_memory(fault, "a path")
                                        : check_answer(answer, last, sought, fault);
}

/* ---- elsewhere ---- */

bool trust_leads_out(const char *name)
{
    return !path_is_inside(name) || file_is_from_home(name);
}

static bool is_regular(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

/* Resolve both files of a pair, and the other one must be next to the real file: a stranger's
 * header next to a link could select voxels few enough to be guessed. */
static bool take_pair(struct buf *path)
{
    OWNED(buf_release) struct buf other = {0};
    if (!file_is_named(buf_text(path), PAIR_HEADERS "|" PAIR_VOXELS))
        return true;
    OWNED(mem_release) char *real = realpath(buf_text(path), NULL);
    OWNED(mem_release)
    char *real_other = pair_other(&other, buf_text(path)) ? realpath(buf_text(&other), NULL) : NULL;
    const bool fine = real && real_other && pair_other(&other, real) &&
                      strcmp(real_other, buf_text(&other)) == 0 && is_regular(real_other);
    buf_clear(path);
    buf_add_text(path, fine ? real : "");
    return fine && !other.failed && !path->failed;
}

bool trust_find_outside(struct buf *path, const char *home, const char *scenes, const char *name)
{
    OWNED(buf_release) struct buf other = {0};
    bool leads_out = trust_leads_out(name);
    if (!leads_out) {
        enum path_kind answer = look_everywhere(path, home, scenes, name);
        if (answer == PATH_IS_FILE)
            answer = look_at_other(&other, path, name);
        leads_out = answer == PATH_IS_OUTSIDE;
    } else if (*name == '/' || file_is_from_home(name)) {
        file_from_home(path, name);
    } else {
        file_folder(path, home);
        buf_printf(path, "/%s", name);
    }
    return leads_out && !path->failed && is_regular(buf_text(path)) &&
           !file_is_named(buf_text(path), HEADERS_ALONE) && !other.failed && take_pair(path);
}

/* ---- golden images ---- */

enum path_kind trust_look_at_golden(const char *path, bool *leads_out)
{
    OWNED(buf_release) struct buf goldens = {0}, folder = {0};
    struct stat status;
    file_folder(&goldens, path);
    file_folder(&folder, buf_text(&goldens));
    const char *name = path + (file_name(buf_text(&goldens)) - buf_text(&goldens));
    const bool failed = goldens.failed || folder.failed;
    const enum path_kind answer =
        failed ? PATH_IS_OUTSIDE : path_kind_below(buf_text(&folder), name);
    *leads_out = /* its last part is a link to a regular file */
        answer == PATH_IS_OUTSIDE && !failed &&
        path_kind_below(buf_text(&folder), file_name(buf_text(&goldens))) == PATH_IS_FOLDER &&
        lstat(path, &status) == 0 && S_ISLNK(status.st_mode) && is_regular(path);
    return *leads_out ? PATH_IS_FILE : answer;
}

/* ---- confinement ---- */

enum { PLACES_MOST = 2048 };

/* Collected places, each once; the arena owns their paths. */
struct gathering {
    struct confine_place place[PLACES_MOST];
    struct arena paths;
    size_t places;
    bool is_full; /* too many places */
};

static void gather_part(struct gathering *g, const char *path, size_t length, unsigned rights)
{
    for (size_t i = 0; i < g->places; i++)
        if (g->place[i].rights == rights && strlen(g->place[i].path) == length &&
            memcmp(g->place[i].path, path, length) == 0)
            return;
    g->is_full |= length && g->places == PLACES_MOST;
    if (!length || g->is_full)
        return;
    struct buf *own = arena_buf(&g->paths);
    buf_add(own, path, length);
    g->place[g->places++] = (struct confine_place){buf_text(own), rights};
}

static void gather(struct gathering *g, const char *path, unsigned rights)
{
    if (path)
        gather_part(g, path, strlen(path), rights);
}

static void gather_folder_of(struct gathering *g, const char *path, unsigned rights)
{
    struct buf *folder = arena_buf(&g->paths);
    file_folder(folder, path);
    gather(g, buf_text(folder), rights);
}

/* Add a scene anywhere, with the files read together with it. */
static void gather_scene(struct gathering *g, const char *path)
{
    struct buf *other = arena_buf(&g->paths);
    gather(g, path, CONFINE_READ);
    if (path && file_is_named(path, HEADERS_ALONE))
        gather_folder_of(g, path, CONFINE_READ);
    if (path && pair_other(other, path))
        gather(g, buf_text(other), CONFINE_READ);
}

bool trust_confine(const struct trust_places *places)
{
    /* Required by every program: its libraries, their data, and /dev/null. */
    static const char *const read[] = {
        "/usr/lib",       "/usr/lib32", "/usr/lib64",          "/lib",
        "/lib64",         "/usr/share", "/usr/local/lib",      "/etc/ld.so.cache",
        "/etc/localtime", "/proc",      "/sys/devices/system", "/dev/urandom",
        "/dev/random",    "/dev/zero"};
    struct gathering g = {.places = 0};
    for (size_t i = 0; i < sizeof read / sizeof *read; i++)
        gather(&g, read[i], CONFINE_READ | (i < 5 ? CONFINE_RUN : 0u));
    gather(&g, "/dev/null", CONFINE_DEVICE);
    for (int i = 0; i < 2; i++)
        gather(&g, places->helper[i], CONFINE_READ | CONFINE_RUN);
    for (const char *const *at = places->given; at && *at; at++)
        gather_scene(&g, *at);
    for (const char *list = places->scenes; *list; list += *list == ':') {
        const size_t length = strcspn(list, ":");
        gather_part(&g, list, length, CONFINE_READ);
        list += length;
    }
    for (const char *const *at = places->written; at && *at; at++) {
        gather(&g, *at, CONFINE_WRITE);
        gather_folder_of(&g, *at, CONFINE_EMPTY);
    }
    /* A journal may be a link; names are resolved in the folder of the link. */
    for (int i = 0; i < places->journals; i++) {
        struct stat status;
        gather_folder_of(&g, places->journal[i], CONFINE_READ);
        if (lstat(places->journal[i], &status) == 0 && S_ISLNK(status.st_mode))
            gather(&g, places->journal[i], CONFINE_READ);
    }
    gather(&g, places->goldens, CONFINE_READ);
    for (const char *const *at = places->linked; at && *at; at++)
        gather(&g, *at, CONFINE_READ);
    const bool is_confined = !g.is_full && !arena_failed(&g.paths) && confine_to(g.place, g.places);
    arena_release(&g.paths);
    return is_confined;
}
