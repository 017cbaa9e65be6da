/* SPDX-License-Identifier: MIT */
#include "command/golden_files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "image/exr.h"
#include "image/png.h"
#include "session/map.h"

/* ---- notes ---- */

bool golden_note_is_of_its_time(const struct attribute *note)
{
    static const char program[] = "iftty ";
    const char *name = note->name, *value = note->value;
    if (strcmp(name, "iftty:journal") == 0)
        return !strchr(value, '/') && !*safe_end(value);
    if (strcmp(name, "iftty:chain") == 0)
        return scan_is_hex(value, RECORD_CHAIN_DIGITS);
    if (strcmp(name, "Software") != 0 || strncmp(value, program, sizeof program - 1) != 0)
        return false;
    value += sizeof program - 1;
    const size_t major = strspn(value, "0123456789"), all = strspn(value, "0123456789.");
    return major && all > major + 1 && all <= major + 17 && !value[all];
}

static enum err refuse_note(const struct attribute *note, const char *drawn, struct fault *fault)
{
    OWNED(buf_release) struct buf words = {0};
    buf_add_safe_text(&words, note->name);
    buf_add_text(&words, " is ");
    buf_add_safe(&words, note->value, strnlen(note->value, 200));
    if (drawn) {
        buf_add_text(&words, ", and the new picture has ");
        buf_add_safe(&words, drawn, strnlen(drawn, 200));
    } else {
        buf_add_text(&words, ", which is no note of the new picture");
    }
    return fault_set(fault, ERR_CHECK, "its note %s", buf_text(&words));
}

static bool is_compared(const struct attribute *note, bool names_scene)
{
    return !golden_note_is_of_its_time(note) &&
           (names_scene || strcmp(note->name, "iftty:scene-name") != 0);
}

enum err golden_compare_notes(const struct picture *kept, const struct picture *drawn,
                              bool names_scene, struct fault *fault)
{
    for (size_t i = 0; i < kept->attributes; i++) {
        const struct attribute *note = &kept->attribute[i];
        const char *now = picture_find(drawn, note->name);
        if (is_compared(note, names_scene) && (!now || strcmp(now, note->value) != 0))
            return refuse_note(note, now, fault);
    }
    for (size_t i = 0; i < drawn->attributes; i++)
        if (is_compared(&drawn->attribute[i], names_scene) &&
            !picture_find(kept, drawn->attribute[i].name))
            return fault_set(fault, ERR_CHECK, "it has no note %s, which the new picture has",
                             drawn->attribute[i].name);
    return OK;
}

static const char image_ending[] = ".exr", png_ending[] = ".png";

enum {
    ENDING = sizeof image_ending - 1,
    NAME_BYTES = 80, /* for the name of an image; longer ones are not valid */
    CHAIN_BYTES = RECORD_CHAIN_DIGITS + 1,
    COPY_BYTES_MOST = 1 << 30
};

/* ---- the folder ---- */

enum err golden_files_open(struct golden_files *files, const char *journal, bool makes,
                           struct fault *fault)
{
    *files = (struct golden_files){.folder = -1};
    const enum err err = golden_folder(&files->path, journal, fault);
    golden_journal_name(&files->name, journal);
    if (err || files->path.failed || files->name.failed)
        return err ? err : fault_memory(fault, "a path");
    const char *path = buf_text(&files->path);
    if (makes && mkdir(path, 0777) == 0 && file_sync_folder(path, fault))
        return ERR_IO;
    files->folder = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (files->folder >= 0 || (errno == ENOENT && !makes))
        return OK;
    if (errno == ENOTDIR || errno == ELOOP)
        return fault_set(fault, ERR_INPUT,
                         "%s is a link, or no folder: no file there belongs to the journal, and "
                         "nothing there was listed, written or removed; put a folder in its place",
                         path);
    return fault_errno(fault, makes ? "make the folder" : "read the folder", path);
}

void golden_files_close(struct golden_files *files)
{
    if (files->folder >= 0)
        close(files->folder);
    files->folder = -1;
    buf_release(&files->path);
    buf_release(&files->name);
    buf_release(&files->named);
    buf_release(&files->chains);
}

/* ---- records of the journal ---- */

static void add_name(struct buf *named, const char *name, size_t length, const char *ending)
{
    buf_add(named, name, length);
    buf_add(named, ending, strlen(ending) + 1);
}

static void add_record(struct golden_files *files, const struct record *record, const char *chain)
{
    static const char word[] = "golden ", copy[] = " copy=";
    const char *at = record->command;
    buf_add(&files->chains, chain, CHAIN_BYTES);
    if (strncmp(at, word, sizeof word - 1) == 0) {
        at += strspn(at + sizeof word - 1, " ") + sizeof word - 1;
        add_name(&files->named, at, strcspn(at, " "), image_ending);
        add_name(&files->named, at, strcspn(at, " "), png_ending);
    } else if ((at = strstr(at, copy))) {
        char digest[LABEL_COPY_DIGEST] = "";
        at += sizeof copy - 1;
        const size_t length = strcspn(at, " ");
        if (length != sizeof digest - 1)
            return;
        memcpy(digest, at, length);
        label_copy_name(&files->named, digest);
        buf_add_char(&files->named, '\0');
    }
}

static int compare_chains(const void *a, const void *b)
{
    return memcmp(a, b, CHAIN_BYTES);
}

enum err golden_files_read(struct golden_files *files, const char *bytes, size_t length,
                           struct fault *fault)
{
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    TRY(walk_begin(&walk, bytes, length, fault));
    while (walk_next(&walk, &record) == WALK_RECORD)
        add_record(files, &record, walk.chain.hex);
    files->last = walk.chain;
    if (files->named.failed || files->chains.failed)
        return fault_memory(fault, "names of files");
    if (files->chains.length)
        qsort(files->chains.data, files->chains.length / CHAIN_BYTES, CHAIN_BYTES, compare_chains);
    return OK;
}

/* ---- notes of an image ---- */

/* Origin of an image, by its notes. */
struct maker {
    char chain[CHAIN_BYTES];
    struct buf journal;
    bool has_journal; /* false for pictures of a private scene */
};

static void take_note(struct maker *maker, const char *name, const char *value, size_t length)
{
    if (strcmp(name, "iftty:chain") == 0 && length == RECORD_CHAIN_DIGITS)
        memcpy(maker->chain, value, length);
    if (strcmp(name, "iftty:journal") == 0) {
        maker->has_journal = true;
        buf_clear(&maker->journal);
        buf_add(&maker->journal, value, length);
    }
}

static void read_exr_notes(struct maker *maker, int fd)
{
    OWNED(buf_release) struct buf header = {0};
    struct exr_attribute_bytes attribute;
    size_t at = 0;
    if (exr_header_read(&header, fd, NULL) == OK)
        while (exr_header_next(&header, &at, &attribute))
            if (strcmp(attribute.type, "string") == 0)
                take_note(maker, attribute.name, attribute.value, attribute.length);
}

static void read_png_notes(struct maker *maker, int fd)
{
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(picture_release) struct picture notes = {0};
    char *to = buf_reserve(&bytes, EXR_HEADER_MOST);
    const ssize_t n = to ? file_read_at(fd, to, EXR_HEADER_MOST, 0) : 0;
    if (n > 0 && png_read_notes(&notes, to, (size_t)n, NULL) == OK)
        for (size_t i = 0; i < notes.attributes; i++)
            take_note(maker, notes.attribute[i].name, notes.attribute[i].value,
                      strlen(notes.attribute[i].value));
}

/* "a" and "a.iftty" have one folder of golden images. */
static bool is_of_neighbour(const struct golden_files *files, const char *journal)
{
    OWNED(buf_release) struct buf path = {0};
    file_folder(&path, buf_text(&files->path));
    buf_printf(&path, "/%s", journal);
    return path.failed || file_exists(buf_text(&path));
}

/* Classify by notes: made after the last record, at another record, or by another journal. */
static enum file_of judge_maker(const struct golden_files *files, const struct maker *maker)
{
    const bool is_of_name =
        maker->has_journal && strcmp(buf_text(&maker->journal), buf_text(&files->name)) == 0;
    const bool has_chain = *maker->chain && files->chains.length &&
                           bsearch(maker->chain, files->chains.data,
                                   files->chains.length / CHAIN_BYTES, CHAIN_BYTES, compare_chains);
    if ((is_of_name || !maker->has_journal) && has_chain &&
        strcmp(maker->chain, files->last.hex) == 0)
        return FILE_LEFTOVER;
    if (maker->has_journal && !is_of_name && is_of_neighbour(files, buf_text(&maker->journal)))
        return FILE_FOREIGN;
    return is_of_name || has_chain ? FILE_STRAY : FILE_FOREIGN;
}

/* ---- deciding ---- */

static bool has_image_name(const char *name)
{
    char stem[NAME_BYTES];
    const char *ending = strrchr(name, '.');
    if (!ending || strlen(name) >= sizeof stem ||
        (strcmp(ending, image_ending) != 0 && strcmp(ending, png_ending) != 0))
        return false;
    snprintf(stem, sizeof stem, "%.*s", (int)(ending - name), name);
    return golden_name_is_valid(stem);
}

enum file_of golden_files_judge(const struct golden_files *files, const char *name)
{
    struct maker maker = {0};
    struct stat status;
    enum file_of of = FILE_FOREIGN;
    if (buf_lists(&files->named, name, strlen(name)))
        return FILE_NAMED;
    if (*name == '.')
        return FILE_HIDDEN;
    if (!has_image_name(name))
        return FILE_FOREIGN;
    const int fd =
        openat(files->folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd < 0)
        return FILE_FOREIGN;
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) {
        if (strcmp(name + strlen(name) - ENDING, image_ending) == 0)
            read_exr_notes(&maker, fd);
        else
            read_png_notes(&maker, fd);
        of = judge_maker(files, &maker);
    }
    close(fd);
    buf_release(&maker.journal);
    return of;
}

/* ---- removing ---- */

/* Remove the PNG first: the image, which identifies it, is removed only if no PNG remains. A kill
 * leaves an empty PNG on some file systems (base/file.h). */
static bool remove_png(const struct golden_files *files, const char *image)
{
    char png[NAME_BYTES];
    struct stat status = {0};
    snprintf(png, sizeof png, "%.*s%s", (int)(strlen(image) - ENDING), image, png_ending);
    if (fstatat(files->folder, png, &status, AT_SYMLINK_NOFOLLOW) != 0 && errno == ENOENT)
        return true;
    const enum file_of of = golden_files_judge(files, png);
    return (of == FILE_LEFTOVER || of == FILE_STRAY ||
            (S_ISREG(status.st_mode) && status.st_size == 0)) &&
           unlinkat(files->folder, png, 0) == 0;
}

enum err golden_files_remove(const struct golden_files *files, const char *name,
                             struct fault *fault)
{
    struct stat status;
    if (files->folder >= 0 && fstatat(files->folder, name, &status, AT_SYMLINK_NOFOLLOW) != 0 &&
        errno == ENOENT)
        return OK; /* removed together with its image */
    const enum file_of of = files->folder < 0 ? FILE_FOREIGN : golden_files_judge(files, name);
    if (of != FILE_LEFTOVER && of != FILE_STRAY)
        return fault_set(fault, ERR_CHECK,
                         "%s was left alone: no record of this journal can have made it; if it is "
                         "not needed, delete it",
                         name);
    if (strcmp(name + strlen(name) - ENDING, image_ending) == 0 && !remove_png(files, name))
        return fault_set(fault, ERR_CHECK,
                         "%s was left alone: no record of this journal can have made its PNG; if "
                         "they are not needed, delete them",
                         name);
    return unlinkat(files->folder, name, 0) == 0 || errno == ENOENT
               ? OK
               : fault_errno(fault, "delete", name);
}

/* ---- copying ---- */

static enum err copy_one(const struct golden_files *files, const char *to, const char *name,
                         struct fault *fault)
{
    OWNED(arena_release) struct arena arena = {0};
    struct buf *source = arena_buf(&arena), *target = arena_buf(&arena), *bytes = arena_buf(&arena);
    struct stat status;
    buf_printf(source, "%s/%s", buf_text(&files->path), name);
    buf_printf(target, "%s/%s", to, name);
    if (arena_failed(&arena))
        return fault_memory(fault, "a path");
    if (lstat(buf_text(source), &status) != 0 || file_exists(buf_text(target)))
        return OK; /* missing, or named twice */
    if (S_ISLNK(status.st_mode)) {
        OWNED(mem_release) char *real = realpath(buf_text(source), NULL);
        return real && symlink(real, buf_text(target)) != 0 /* a dangling link is left out */
                   ? fault_errno(fault, "make the link", buf_text(target))
                   : OK;
    }
    if (!S_ISREG(status.st_mode))
        return OK;
    TRY(file_read(bytes, buf_text(source), COPY_BYTES_MOST, fault));
    return file_write(buf_text(target), buf_text(bytes), bytes->length, FILE_KEEP, fault);
}

enum err golden_files_copy(const struct golden_files *files, const char *to, struct fault *fault)
{
    const char *name = buf_text(&files->named), *end = name + files->named.length;
    if (mkdir(to, 0777) != 0)
        return fault_errno(fault, "make the folder", to);
    enum err err = OK;
    for (; !err && name < end; name += strlen(name) + 1)
        err = copy_one(files, to, name, fault);
    if (!err)
        err = file_sync_folder(to, fault);
    if (err)
        folder_remove(to);
    return err;
}

/* ---- clearing ---- */

void golden_files_clear(const char *journal, const char *bytes, size_t length, struct buf *told)
{
    OWNED(golden_files_close) struct golden_files files = {.folder = -1};
    DIR *listing = NULL;
    if (golden_files_open(&files, journal, false, NULL) == OK && files.folder >= 0 &&
        golden_files_read(&files, bytes, length, NULL) == OK) {
        file_sweep(buf_text(&files.path));
        const int again = openat(files.folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        listing = again >= 0 ? fdopendir(again) : NULL;
    }
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        const char *name = entry->d_name;
        if (!file_is_named(name, image_ending) ||
            golden_files_judge(&files, name) != FILE_LEFTOVER ||
            golden_files_remove(&files, name, NULL) != OK)
            continue;
        buf_add_safe_text(told, buf_text(&files.path));
        buf_add_char(told, '/');
        buf_add_safe_text(told, name);
        buf_add_text(told, " was removed: its command was ended before it was recorded\n");
    }
    if (listing)
        closedir(listing);
}
