/* SPDX-License-Identifier: MIT */
#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <inttypes.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/scan.h"

enum { PART_DIGITS = 5, STARTED_FIELD = 22 }; /* field of /proc/PID/stat, from 1 */
enum { MACHINE, BOOT, SPACE, PARTS };

static const uint64_t has_ended = UINT64_MAX;

static uint64_t mix_text(uint64_t sum, const char *text)
{
    while (*text)
        sum = hash_mix(sum ^ (unsigned char)*text++);
    return sum;
}

/* Mix in the first line of a system file, if it can be read. */
static uint64_t mix_file(uint64_t sum, const char *path)
{
    char text[256];
    OWNED(stream_release) FILE *file = fopen(path, "re");
    return file && fgets(text, sizeof text, file) ? mix_text(sum, text) : sum;
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

/* Return the start time of a process, in system ticks: 0 if it cannot be seen, has_ended if it is a
 * zombie. A line of the file is "4711 (any name) S 1 ...". */
static uint64_t started(long process)
{
    char path[64], line[1024];
    snprintf(path, sizeof path, "/proc/%ld/stat", process);
    OWNED(stream_release) FILE *file = fopen(path, "re");
    const char *at = file && fgets(line, sizeof line, file) ? strrchr(line, ')') : NULL;
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

#define DRAFT_PREFIX ".iftty-"
#define FRESH_PREFIX "iftty-" /* prefix of folders, which may be held */
#define HOLDER_TAIL  "holder"

enum {
    NUMBERED_MOST = 9999, /* files PATH.KIND-N */
    TAIL_MOST = 160,
    FORGOTTEN_S = 24 * 60 * 60,
    COPY_PIECE = 65536,
};

/* ---- steps ---- */

int (*file_step_hook)(enum file_step step, const char *path);

bool file_step_fails(enum file_step step, const char *path)
{
    int number = file_step_hook ? file_step_hook(step, path) : 0;
    if (number)
        errno = number;
    return number != 0;
}

static int open_step(const char *path, int flags, mode_t mode)
{
    if (file_step_fails(FILE_STEP_OPEN, path))
        return -1;
    int fd;
    do
        fd = open(path, flags | O_CLOEXEC | O_NOCTTY, mode);
    while (fd < 0 && errno == EINTR);
    return fd;
}

int file_step_open(const char *path, int flags)
{
    return open_step(path, flags, 0666);
}

bool file_step_write(int fd, const char *path, const char *bytes, size_t length)
{
    while (length > 0) {
        if (file_step_fails(FILE_STEP_WRITE, path))
            return false;
        ssize_t n = write(fd, bytes, length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return false;
        bytes += n;
        length -= (size_t)n;
    }
    return true;
}

bool file_step_sync(int fd, const char *path)
{
    return !file_step_fails(FILE_STEP_SYNC, path) && fdatasync(fd) == 0;
}

enum err file_sync_folder(const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf folder = {0};
    file_folder(&folder, path);
    OWNED(file_release) int fd = -1;
    if (folder.failed)
        errno = ENOMEM;
    else
        fd = file_step_open(buf_text(&folder), O_RDONLY | O_DIRECTORY);
    const bool fine = fd >= 0 && !file_step_fails(FILE_STEP_SYNC_FOLDER, path) &&
                      (fsync(fd) == 0 || errno == EINVAL);
    return fine ? OK : fault_errno(fault, "sync the folder of", path);
}

bool file_step_cut(int fd, const char *path, uint64_t length)
{
    return !file_step_fails(FILE_STEP_CUT, path) && ftruncate(fd, (off_t)length) == 0;
}

/* ---- existing files ---- */

void file_release(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

enum err file_open(int *fd, uint64_t *bytes, const char *path, int flags, struct fault *fault)
{
    struct stat status;
    *fd = open_step(path, flags | O_NONBLOCK, 0600);
    if (*fd < 0)
        return fault_errno(fault, "open", path);
    if (fstat(*fd, &status) == 0 && S_ISREG(status.st_mode)) {
        *bytes = (uint64_t)status.st_size;
        return OK;
    }
    file_release(fd);
    return fault_set(fault, ERR_INPUT, "%s is not a regular file", path);
}

ssize_t file_read_at(int fd, void *to, size_t length, uint64_t from)
{
    size_t done = 0;
    while (done < length) {
        const ssize_t n = pread(fd, (char *)to + done, length - done, (off_t)(from + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return -1;
        if (n == 0)
            break;
        done += (size_t)n;
    }
    return (ssize_t)done;
}

enum err file_read(struct buf *out, const char *path, size_t limit, struct fault *fault)
{
    const size_t piece = 65536;
    uint64_t bytes;
    OWNED(file_release) int fd = -1;
    buf_clear(out);
    TRY(file_open(&fd, &bytes, path, O_RDONLY, fault));
    for (ssize_t n = (ssize_t)piece; n == (ssize_t)piece;) {
        char *place = buf_reserve(out, piece);
        if (!place)
            return fault_memory(fault, path);
        n = file_read_at(fd, place, piece, out->length);
        if (n < 0)
            return fault_errno(fault, "read", path);
        out->length += (size_t)n;
        if (out->length > limit)
            return fault_set(fault, ERR_LIMIT, "%s holds more than %zu bytes", path, limit);
    }
    buf_add(out, "", 0);
    return OK;
}

bool file_exists(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0;
}

bool file_is_missing(const char *path)
{
    return !file_exists(path) && (errno == ENOENT || errno == ENOTDIR);
}

bool file_is_folder(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

bool file_begins_with(const char *path, const char *text)
{
    char start[64];
    const size_t length = strlen(text);
    uint64_t bytes;
    OWNED(file_release) int fd = -1;
    return length <= sizeof start && file_open(&fd, &bytes, path, O_RDONLY, NULL) == OK &&
           file_read_at(fd, start, length, 0) == (ssize_t)length &&
           memcmp(start, text, length) == 0;
}

bool file_is_same(const char *a, const char *b)
{
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

bool file_holds_same(const char *a, const char *b)
{
    enum { PIECE = 1 << 16 };
    char piece[2][PIECE];
    OWNED(file_release) int one = -1, other = -1;
    uint64_t bytes[2] = {0, 1}, at = 0;
    bool same = file_open(&one, &bytes[0], a, O_RDONLY, NULL) == OK &&
                file_open(&other, &bytes[1], b, O_RDONLY, NULL) == OK && bytes[0] == bytes[1];
    for (ssize_t n = PIECE; same && n == PIECE; at += PIECE) {
        n = file_read_at(one, piece[0], PIECE, at);
        same = n >= 0 && file_read_at(other, piece[1], PIECE, at) == n &&
               memcmp(piece[0], piece[1], (size_t)n) == 0;
    }
    return same;
}

void file_real(struct buf *out, const char *path)
{
    struct stat status;
    const bool is_link = lstat(path, &status) == 0 && S_ISLNK(status.st_mode);
    OWNED(mem_release) char *real = is_link ? realpath(path, NULL) : NULL;
    buf_clear(out);
    buf_add_text(out, real ? real : path);
}

enum { LINKS_MOST = 40 };

static void settle(struct buf *out, const char *path, unsigned links)
{
    char target[PATH_MAX];
    OWNED(mem_release) char *real = realpath(path, NULL);
    const ssize_t n = real || !links ? -1 : readlink(path, target, sizeof target - 1);
    OWNED(buf_release) struct buf next = {0};
    if (real) {
        buf_add_text(out, real);
    } else if (n > 0) { /* a link to a missing file */
        target[n] = '\0';
        if (*target != '/') {
            file_folder(&next, path);
            buf_add_char(&next, '/');
        }
        buf_add_text(&next, target);
        settle(out, buf_text(&next), links - 1);
    } else {
        file_folder(&next, path);
        if (strcmp(buf_text(&next), path) != 0)
            settle(out, buf_text(&next), links);
        buf_printf(out, "/%s", file_name(path));
    }
    out->failed |= next.failed;
}

void file_absolute(struct buf *out, const char *path)
{
    buf_clear(out);
    settle(out, path, LINKS_MOST);
}

enum err file_program_folder(struct buf *out, struct fault *fault)
{
    char self[PATH_MAX];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length < 0)
        return fault_errno(fault, "find the folder of this program by", "/proc/self/exe");
    self[length] = '\0';
    file_folder(out, self);
    return out->failed ? fault_memory(fault, "a file name") : OK;
}

/* ---- names ---- */

const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void file_folder(struct buf *out, const char *path)
{
    const char *slash = strrchr(path, '/');
    buf_clear(out);
    if (!slash)
        buf_add_text(out, ".");
    else
        buf_add(out, path, slash == path ? 1 : (size_t)(slash - path));
}

const char *file_ending(const char *path, const char *endings)
{
    const char *name = file_name(path);
    const size_t length = strlen(name);
    struct choice end;
    while (choice_next(&end, &endings))
        if (length > end.length &&
            strncasecmp(name + length - end.length, end.word, end.length) == 0)
            return name + length - end.length;
    return NULL;
}

bool file_is_named(const char *path, const char *endings)
{
    return file_ending(path, endings) != NULL;
}

bool file_is_from_home(const char *name)
{
    return strncmp(name, "~/", 2) == 0;
}

void file_from_home(struct buf *out, const char *name)
{
    const char *home = file_is_from_home(name) ? getenv("HOME") : NULL;
    buf_clear(out);
    if (home && *home)
        buf_add_text(out, home);
    buf_add_text(out, home && *home ? name + 1 : name);
}

/* ---- names of drafts ---- */

/* ".iftty-OWNER-N-TAIL" */
static void write_name(struct buf *out, const char *tail)
{
    static _Atomic unsigned counter; /* a picture may be written by another thread */
    buf_add_text(out, DRAFT_PREFIX);
    owner_write(out);
    buf_printf(out, "-%u-%s", counter++, tail);
}

static bool read_name(const char *name, enum owner_state *state)
{
    const char *at = name;
    int64_t number;
    return scan_text(&at, DRAFT_PREFIX) && owner_read(&at, state) && scan_text(&at, "-") &&
           scan_integer(&at, 0, UINT32_MAX, &number) && scan_text(&at, "-") && *at;
}

/* ---- what others left ---- */

/* Use rmdir for folders: a process confined to removing empty folders must not call unlink on one.
 * */
static int remove_one(const char *path, const struct stat *status, int type, struct FTW *where)
{
    (void)status, (void)where;
    return type == FTW_DP ? rmdir(path) : unlink(path);
}

void folder_remove(const char *path)
{
    enum { DESCRIPTORS = 8 };
    nftw(path, remove_one, DESCRIPTORS, FTW_DEPTH | FTW_PHYS | FTW_MOUNT);
}

static bool is_forgotten(enum owner_state state, const struct stat *status)
{
    return (S_ISREG(status->st_mode) || S_ISDIR(status->st_mode)) &&
           (state == OWNER_IS_GONE ||
            (state == OWNER_IS_HIDDEN && time(NULL) - status->st_mtime > FORGOTTEN_S));
}

/* Find the empty file that names the process holding the folder: its path, and the state of that
 * process. */
static bool find_holder(struct buf *path, enum owner_state *state, const char *folder)
{
    bool found = false;
    DIR *listing = opendir(folder);
    for (const struct dirent *entry; listing && !found && (entry = readdir(listing));) {
        struct stat status;
        const char *tail = strrchr(entry->d_name, '-');
        if (!read_name(entry->d_name, state) || strcmp(tail + 1, HOLDER_TAIL) != 0)
            continue;
        buf_clear(path);
        buf_printf(path, "%s/%s", folder, entry->d_name);
        found = !path->failed && lstat(buf_text(path), &status) == 0 && S_ISREG(status.st_mode) &&
                status.st_size == 0;
    }
    if (listing)
        closedir(listing);
    return found;
}

/* Remove abandoned drafts from a folder, or abandoned folders that were held. */
static void sweep(const char *path, bool of_held)
{
    OWNED(buf_release) struct buf found = {0}, holder = {0};
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        enum owner_state state;
        struct stat status;
        if (of_held ? strncmp(entry->d_name, FRESH_PREFIX, sizeof FRESH_PREFIX - 1) != 0
                    : !read_name(entry->d_name, &state) || state == OWNER_LIVES)
            continue;
        buf_clear(&found);
        buf_printf(&found, "%s/%s", path, entry->d_name);
        if (!found.failed && lstat(buf_text(&found), &status) == 0 && status.st_uid == geteuid() &&
            (!of_held ||
             (S_ISDIR(status.st_mode) && find_holder(&holder, &state, buf_text(&found)))) &&
            is_forgotten(state, &status))
            folder_remove(buf_text(&found));
    }
    if (folder)
        closedir(folder);
}

void file_sweep(const char *path)
{
    sweep(path, false);
}

/* Sweep a folder once, until another folder is written to. */
static void sweep_once(const char *folder)
{
    static _Atomic uint64_t last;
    struct stat status;
    if (stat(folder, &status) != 0)
        return;
    const uint64_t place = hash_mix_at(status.st_dev, status.st_ino) | 1;
    if (atomic_exchange(&last, place) != place)
        file_sweep(folder);
}

/* ---- drafts ---- */

enum err file_may_write(const char *path, enum file_mode mode, struct fault *fault)
{
    OWNED(buf_release) struct buf folder = {0};
    file_folder(&folder, path);
    if (folder.failed)
        return fault_memory(fault, "a file name");
    if (*file_name(path) == '\0' || file_is_folder(path))
        return fault_set(fault, ERR_IO, "%s is a folder, not a file", path);
    if (!file_is_folder(buf_text(&folder)))
        return fault_set(fault, ERR_IO, "cannot write %s: there is no folder %s", path,
                         buf_text(&folder));
    if (mode == FILE_KEEP && file_exists(path))
        return fault_set(fault, ERR_IO, "%s exists already and was left alone", path);
    return OK;
}

enum err file_draft(struct buf *draft, const char *path, enum file_mode mode, struct fault *fault)
{
    buf_clear(draft);
    TRY(file_may_write(path, mode, fault));
    file_folder(draft, path);
    sweep_once(buf_text(draft));
    buf_add_char(draft, '/');
    /* Keep the end of the name, cut at a whole character: the draft has the same extension, and
     * works for names of any length that the file system accepts. */
    const char *tail = file_name(path);
    const size_t length = strlen(tail);
    tail += length > TAIL_MOST ? length - TAIL_MOST : 0;
    while (((unsigned char)*tail & 0xC0) == 0x80)
        tail++;
    write_name(draft, tail);
    return draft->failed ? fault_memory(fault, "a file name") : OK;
}

void file_discard(const char *draft)
{
    const int number = errno;
    unlink(draft);
    errno = number;
}

/* ---- publishing ---- */

/* Return true if the last step failed because the file system does not support it. */
static bool is_not_supported(void)
{
    return errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP || errno == EPERM ||
           errno == EMLINK;
}

static bool rename_over(const char *draft, const char *path)
{
    return !file_step_fails(FILE_STEP_RENAME, path) && rename(draft, path) == 0;
}

/* NFS may report a failure of a link that a repeated request has made. */
static bool link_to(const char *draft, const char *path)
{
    struct stat one, other;
    if (file_step_fails(FILE_STEP_LINK, path))
        return false;
    return link(draft, path) == 0 ||
           (errno == EEXIST && lstat(draft, &one) == 0 && lstat(path, &other) == 0 &&
            one.st_dev == other.st_dev && one.st_ino == other.st_ino);
}

/* The weaker way, for file systems without hard links. */
static bool rename_over_empty(const char *draft, const char *path)
{
    const int fd = file_step_open(path, O_WRONLY | O_CREAT | O_EXCL);
    if (fd < 0)
        return false;
    close(fd);
    if (rename_over(draft, path))
        return true;
    file_discard(path); /* empty, and ours */
    return false;
}

/* Ensure D1 by the strongest means of the file system. */
static bool rename_new(const char *draft, const char *path)
{
    if (!file_step_fails(FILE_STEP_RENAME_NEW, path) &&
        renameat2(AT_FDCWD, draft, AT_FDCWD, path, RENAME_NOREPLACE) == 0)
        return true;
    if (!is_not_supported())
        return false;
    if (link_to(draft, path)) {
        file_discard(draft);
        return true;
    }
    return is_not_supported() && rename_over_empty(draft, path);
}

enum err file_rename_new(const char *path, const char *name, struct fault *fault)
{
    if (!rename_new(path, name))
        return fault_errno(fault, "write", name);
    return file_sync_folder(name, fault);
}

static bool sync_draft(int descriptor, const char *draft)
{
    OWNED(file_release) int fd = descriptor;
    return fd >= 0 && file_step_sync(fd, draft);
}

enum err file_publish(const char *draft, const char *path, enum file_mode mode, struct fault *fault)
{
    if (sync_draft(file_step_open(draft, O_RDONLY), draft) &&
        (mode == FILE_KEEP ? rename_new(draft, path) : rename_over(draft, path)))
        return file_sync_folder(path, fault);
    const enum err err = fault_errno(fault, "write", path);
    file_discard(draft);
    return err;
}

enum err file_publish_in(int folder, const char *draft, const char *path, struct fault *fault)
{
    const char *name = file_name(draft);
    const int fd = file_step_fails(FILE_STEP_OPEN, draft)
                       ? -1
                       : openat(folder, name, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NOCTTY);
    if (!sync_draft(fd, draft) || file_step_fails(FILE_STEP_RENAME, path) ||
        renameat(folder, name, folder, file_name(path)) != 0) {
        const enum err err = fault_errno(fault, "write", path);
        unlinkat(folder, name, 0);
        return err;
    }
    return !file_step_fails(FILE_STEP_SYNC_FOLDER, path) && (fsync(folder) == 0 || errno == EINVAL)
               ? OK
               : fault_errno(fault, "sync the folder of", path);
}

/* ---- backups ---- */

static enum err copy(const char *path, const char *backup, struct fault *fault)
{
    char piece[COPY_PIECE];
    uint64_t bytes, at = 0;
    OWNED(file_release) int from = -1;
    TRY(file_open(&from, &bytes, path, O_RDONLY, fault));
    OWNED(file_release) int to = file_step_open(backup, O_WRONLY | O_CREAT | O_EXCL);
    bool fine = to >= 0;
    for (ssize_t n = 1; fine && n != 0; at += (uint64_t)n) {
        n = file_read_at(from, piece, sizeof piece, at);
        fine = n >= 0 && file_step_write(to, path, piece, (size_t)n);
    }
    if (fine && file_step_sync(to, path))
        return OK;
    const enum err err = fault_errno(fault, "keep the former", path);
    if (to >= 0)
        file_discard(backup);
    return err;
}

enum err file_backup(struct buf *backup, const char *path, struct fault *fault)
{
    TRY(file_draft(backup, path, FILE_REPLACE, fault));
    if (link_to(path, buf_text(backup)))
        return OK;
    return is_not_supported() ? copy(path, buf_text(backup), fault)
                              : fault_errno(fault, "keep the former", path);
}

enum err file_restore(const char *backup, const char *path, struct fault *fault)
{
    if (rename(backup, path) != 0)
        return fault_errno(fault, "restore", path);
    file_discard(backup); /* it remains if path was never replaced: both are names of one file */
    return file_sync_folder(path, fault);
}

/* ---- whole files ---- */

static enum err write_draft(const char *draft, const char *path, const void *bytes, size_t length,
                            struct fault *fault)
{
    const int fd = file_step_open(draft, O_WRONLY | O_CREAT | O_EXCL);
    if (fd < 0)
        return fault_errno(fault, "write", path);
    const bool written = file_step_write(fd, path, bytes, length);
    const int number = errno;
    if (close(fd) == 0 && written)
        return OK;
    errno = written ? errno : number;
    file_discard(draft);
    return fault_errno(fault, "write", path);
}

enum err file_write(const char *path, const void *bytes, size_t length, enum file_mode mode,
                    struct fault *fault)
{
    OWNED(buf_release) struct buf draft = {0};
    TRY(file_draft(&draft, path, mode, fault));
    TRY(write_draft(buf_text(&draft), path, bytes, length, fault));
    return file_publish(buf_text(&draft), path, mode, fault);
}

enum err file_write_beside(struct buf *name, const char *path, const char *kind, const void *bytes,
                           size_t length, struct fault *fault)
{
    for (int n = 1; n <= NUMBERED_MOST; n++) {
        buf_clear(name);
        buf_printf(name, "%s.%s-%d", path, kind, n);
        if (name->failed)
            return fault_memory(fault, "a file name");
        if (!file_exists(buf_text(name)))
            return file_write(buf_text(name), bytes, length, FILE_KEEP, fault);
    }
    return fault_set(fault, ERR_IO, "there are %d files %s.%s-N already; %s is as it was",
                     NUMBERED_MOST, path, kind, path);
}

/* ---- folders ---- */

enum err file_make_folder(const char *path, struct fault *fault)
{
    if (mkdir(path, 0777) == 0)
        return file_sync_folder(path, fault);
    if (errno == EEXIST && file_is_folder(path))
        return OK;
    return fault_errno(fault, "make the folder", path);
}

enum err folder_make_private(const char *path, struct fault *fault)
{
    OWNED(buf_release) struct buf part = {0};
    for (size_t at = 0; path[at];) {
        at += strspn(path + at, "/");
        at += strcspn(path + at, "/");
        buf_clear(&part);
        buf_add(&part, path, at);
        if (part.failed)
            return fault_memory(fault, "a path");
        if (mkdir(buf_text(&part), 0700) != 0 && !file_is_folder(buf_text(&part)))
            return fault_errno(fault, "make the folder", buf_text(&part));
    }
    return OK;
}

static const char *usual_place(const char *below)
{
    const char *usual = getenv("TMPDIR");
    return below ? below : usual && *usual ? usual : "/tmp";
}

/* Make the folder of a name that is fresh by itself, or by XXXXXX at its end. */
static enum err make_below(struct buf *path, const char *below, bool is_fresh, struct fault *fault)
{
    buf_clear(path);
    buf_printf(path, is_fresh ? "%s/" FRESH_PREFIX "XXXXXX" : "%s/", below);
    if (!is_fresh)
        write_name(path, "folder");
    if (path->failed)
        return fault_memory(fault, "a path");
    if (is_fresh ? mkdtemp(path->data) != NULL : mkdir(path->data, 0700) == 0)
        return OK;
    buf_clear(path);
    return fault_errno(fault, "make a folder below", below);
}

enum err folder_fresh(struct buf *path, const char *below, struct fault *fault)
{
    return make_below(path, usual_place(below), true, fault);
}

enum err folder_temporary(struct buf *path, const char *below, struct fault *fault)
{
    sweep_once(usual_place(below));
    return make_below(path, usual_place(below), false, fault);
}

enum err folder_held(struct buf *path, const char *below, struct fault *fault)
{
    OWNED(buf_release) struct buf holder = {0};
    sweep(usual_place(below), true);
    TRY(folder_fresh(path, below, fault));
    buf_printf(&holder, "%s/", buf_text(path));
    write_name(&holder, HOLDER_TAIL);
    OWNED(file_release)
    int fd = holder.failed ? -1 : open(buf_text(&holder), O_WRONLY | O_CREAT | O_EXCL, 0600);
    if (fd >= 0)
        return OK;
    enum err err = holder.failed ? fault_memory(fault, "a path")
                                 : fault_errno(fault, "make", buf_text(&holder));
    rmdir(buf_text(path));
    buf_clear(path);
    return err;
}

bool folder_release(const char *path)
{
    OWNED(buf_release) struct buf holder = {0};
    enum owner_state state;
    if (find_holder(&holder, &state, path))
        unlink(buf_text(&holder));
    return rmdir(path) != 0 && (errno == ENOTEMPTY || errno == EEXIST);
}
