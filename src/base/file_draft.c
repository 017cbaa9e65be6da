#include "base/file_draft.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/folder.h"
#include "base/hash.h"
#include "base/owner.h"
#include "base/scan.h"

#define DRAFT_PREFIX ".iftty-"

enum { TAIL_MOST = 160, FORGOTTEN_S = 24 * 60 * 60, COPY_PIECE = 65536 };

/* ---- names of drafts ---- */

/* The end of a name, of whole characters: a draft has its extension, and a name of any length that
 * the file system takes. */
static const char *tail_of(const char *name)
{
    const size_t length = strlen(name);
    const char *tail = length > TAIL_MOST ? name + length - TAIL_MOST : name;
    while (((unsigned char)*tail & 0xC0) == 0x80)
        tail++;
    return tail;
}

/* ".iftty-OWNER-N-TAIL" */
static void write_name(struct buf *out, const char *tail)
{
    static _Atomic unsigned counter; /* pictures are written beside the session */
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

static bool is_forgotten(enum owner_state state, const struct stat *status)
{
    return (S_ISREG(status->st_mode) || S_ISDIR(status->st_mode)) && status->st_uid == geteuid() &&
           (state == OWNER_IS_GONE ||
            (state == OWNER_IS_HIDDEN && time(NULL) - status->st_mtime > FORGOTTEN_S));
}

void file_sweep(const char *path)
{
    struct buf draft = {0};
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        enum owner_state state;
        struct stat status;
        if (!read_name(entry->d_name, &state) || state == OWNER_LIVES)
            continue;
        buf_clear(&draft);
        buf_printf(&draft, "%s/%s", path, entry->d_name);
        if (!draft.failed && lstat(buf_text(&draft), &status) == 0 && is_forgotten(state, &status))
            folder_remove(buf_text(&draft));
    }
    if (folder)
        closedir(folder);
    buf_release(&draft);
}

/* Once for a folder, as long as no other is written to. */
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

static enum err judge_place(const char *path, const char *folder, enum file_mode mode,
                            struct fault *fault)
{
    if (*file_name(path) == '\0' || file_is_folder(path))
        return fault_set(fault, ERR_IO, "%s is a folder, not a file", path);
    if (!file_is_folder(folder))
        return fault_set(fault, ERR_IO, "cannot write %s: there is no folder %s", path, folder);
    if (mode == FILE_KEEP && file_exists(path))
        return fault_set(fault, ERR_IO, "%s exists already and was left alone", path);
    return OK;
}

enum err file_may_write(const char *path, enum file_mode mode, struct fault *fault)
{
    struct buf folder = {0};
    file_folder(&folder, path);
    const enum err err = folder.failed ? fault_memory(fault, "a file name")
                                       : judge_place(path, buf_text(&folder), mode, fault);
    buf_release(&folder);
    return err;
}

enum err file_draft(struct buf *draft, const char *path, enum file_mode mode, struct fault *fault)
{
    enum err err = file_may_write(path, mode, fault);
    buf_clear(draft);
    if (err)
        return err;
    file_folder(draft, path);
    sweep_once(buf_text(draft));
    buf_add_char(draft, '/');
    write_name(draft, tail_of(file_name(path)));
    return draft->failed ? fault_memory(fault, "a file name") : OK;
}

enum err file_draft_folder(struct buf *draft, const char *folder, struct fault *fault)
{
    sweep_once(folder);
    buf_clear(draft);
    buf_printf(draft, "%s/", folder);
    write_name(draft, "folder");
    if (draft->failed)
        return fault_memory(fault, "a path");
    if (mkdir(buf_text(draft), 0700) == 0)
        return OK;
    buf_clear(draft);
    return fault_errno(fault, "make a folder below", folder);
}

/* ---- folders that are held ---- */

#define HELD_PREFIX "iftty-"
#define HOLDER_TAIL "holder"

/* The empty file that says who holds the folder, if there is one: its path, and what has become of
 * that process. */
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

static void sweep_held(const char *path)
{
    struct buf held = {0}, holder = {0};
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        enum owner_state state;
        struct stat status;
        if (strncmp(entry->d_name, HELD_PREFIX, sizeof HELD_PREFIX - 1) != 0)
            continue;
        buf_clear(&held);
        buf_printf(&held, "%s/%s", path, entry->d_name);
        if (!held.failed && lstat(buf_text(&held), &status) == 0 && S_ISDIR(status.st_mode) &&
            status.st_uid == geteuid() && find_holder(&holder, &state, buf_text(&held)) &&
            is_forgotten(state, &status))
            folder_remove(buf_text(&held));
    }
    if (folder)
        closedir(folder);
    buf_release(&held);
    buf_release(&holder);
}

static enum err hold(const char *folder, struct fault *fault)
{
    struct buf path = {0};
    buf_printf(&path, "%s/", folder);
    write_name(&path, HOLDER_TAIL);
    const int fd = path.failed ? -1 : open(buf_text(&path), O_WRONLY | O_CREAT | O_EXCL, 0600);
    enum err err = path.failed ? fault_memory(fault, "a path") : OK;
    if (!err && fd < 0)
        err = fault_errno(fault, "make", buf_text(&path));
    if (fd >= 0)
        close(fd);
    buf_release(&path);
    return err;
}

enum err file_hold_folder(struct buf *path, const char *folder, struct fault *fault)
{
    sweep_held(folder);
    enum err err = folder_fresh(path, folder, fault);
    if (err)
        return err;
    err = hold(buf_text(path), fault);
    if (err) {
        rmdir(buf_text(path));
        buf_clear(path);
    }
    return err;
}

bool file_release_folder(const char *path)
{
    struct buf holder = {0};
    enum owner_state state;
    if (find_holder(&holder, &state, path))
        unlink(buf_text(&holder));
    buf_release(&holder);
    return rmdir(path) != 0 && (errno == ENOTEMPTY || errno == EEXIST);
}

void file_discard(const char *draft)
{
    const int number = errno;
    unlink(draft);
    errno = number;
}

/* ---- publishing ---- */

static bool is_same_file(const char *a, const char *b)
{
    struct stat left, right;
    return lstat(a, &left) == 0 && lstat(b, &right) == 0 && left.st_dev == right.st_dev &&
           left.st_ino == right.st_ino;
}

/* Whether the last step failed because the file system has no such thing. */
static bool is_not_supported(void)
{
    return errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP || errno == EPERM ||
           errno == EMLINK;
}

static bool rename_over(const char *draft, const char *path)
{
    return !file_step_fails(FILE_STEP_RENAME, path) && rename(draft, path) == 0;
}

/* NFS may have done what it says has failed, when it asked twice. */
static bool link_to(const char *draft, const char *path)
{
    return !file_step_fails(FILE_STEP_LINK, path) &&
           (link(draft, path) == 0 || (errno == EEXIST && is_same_file(draft, path)));
}

/* The weaker way, without hard links. */
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

/* D1 by the strongest way that the file system has. */
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

enum err file_publish(const char *draft, const char *path, enum file_mode mode, struct fault *fault)
{
    const int fd = file_step_open(draft, O_RDONLY);
    const bool synced = fd >= 0 && file_step_sync(fd, draft);
    if (fd >= 0)
        close(fd);
    if (!synced || !(mode == FILE_KEEP ? rename_new(draft, path) : rename_over(draft, path))) {
        const enum err err = fault_errno(fault, "write", path);
        file_discard(draft);
        return err;
    }
    if (!file_step_sync_folder(path))
        return fault_errno(fault, "sync the folder of", path);
    return OK;
}

/* ---- backups ---- */

static bool copy_bytes(int from, int to, const char *path)
{
    char piece[COPY_PIECE];
    uint64_t at = 0;
    for (ssize_t n; (n = file_read_at(from, piece, sizeof piece, at)) != 0; at += (uint64_t)n)
        if (n < 0 || !file_step_write(to, path, piece, (size_t)n))
            return false;
    return file_step_sync(to, path);
}

static enum err copy(const char *path, const char *backup, struct fault *fault)
{
    uint64_t bytes;
    int from;
    enum err err = file_open(&from, &bytes, path, O_RDONLY, fault);
    if (err)
        return err;
    const int to = file_step_open(backup, O_WRONLY | O_CREAT | O_EXCL);
    if (to < 0 || !copy_bytes(from, to, backup)) {
        err = fault_errno(fault, "keep the former", path);
        if (to >= 0)
            file_discard(backup);
    }
    if (to >= 0)
        close(to);
    close(from);
    return err;
}

enum err file_backup(struct buf *backup, const char *path, struct fault *fault)
{
    enum err err = file_draft(backup, path, FILE_REPLACE, fault);
    if (err || link_to(path, buf_text(backup)))
        return err;
    return is_not_supported() ? copy(path, buf_text(backup), fault)
                              : fault_errno(fault, "keep the former", path);
}

enum err file_restore(const char *backup, const char *path, struct fault *fault)
{
    if (rename(backup, path) != 0)
        return fault_errno(fault, "restore", path);
    file_discard(backup); /* it stays where path was never replaced: two names of one file */
    return file_step_sync_folder(path) ? OK : fault_errno(fault, "sync the folder of", path);
}
