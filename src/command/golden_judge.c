/* SPDX-License-Identifier: MIT */
#include "command/golden_judge.h"

#include <dirent.h>
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/safe.h"
#include "base/scan.h"
#include "image/exr.h"
#include "journal/golden.h"
#include "journal/record.h"

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
    struct buf words = {0};
    buf_add_safe_text(&words, note->name);
    buf_add_text(&words, " is ");
    buf_add_safe(&words, note->value, strnlen(note->value, 200));
    if (drawn) {
        buf_add_text(&words, ", and what is drawn has ");
        buf_add_safe(&words, drawn, strnlen(drawn, 200));
    } else {
        buf_add_text(&words, ", which is no note of what is drawn");
    }
    const enum err err = fault_set(fault, ERR_CHECK, "its note %s", buf_text(&words));
    buf_release(&words);
    return err;
}

/* Slices, which have no depth, once said what renditions drawn before had behind their objects. */
static bool counts(const struct attribute *note, bool names_scene, bool is_slice)
{
    return !golden_note_is_of_its_time(note) &&
           (names_scene || strcmp(note->name, "iftty:scene-name") != 0) &&
           (!is_slice || strcmp(note->name, "iftty:context") != 0);
}

enum err golden_compare_notes(const struct picture *kept, const struct picture *drawn,
                              bool names_scene, struct fault *fault)
{
    const bool is_slice = !drawn->depth_mm;
    for (size_t i = 0; i < kept->attributes; i++) {
        const struct attribute *note = &kept->attribute[i];
        const char *now = picture_find(drawn, note->name);
        if (counts(note, names_scene, is_slice) && (!now || strcmp(now, note->value) != 0))
            return refuse_note(note, now, fault);
    }
    for (size_t i = 0; i < drawn->attributes; i++)
        if (counts(&drawn->attribute[i], names_scene, is_slice) &&
            !picture_find(kept, drawn->attribute[i].name))
            return fault_set(fault, ERR_CHECK, "it has no note %s, which what is drawn has",
                             drawn->attribute[i].name);
    return OK;
}

/* ---- images of commands that were not recorded ---- */

static const char image_ending[] = ".exr";

bool golden_is_named(const struct buf *named, const char *file)
{
    const char *at = buf_text(named), *end = at + named->length;
    for (; at < end; at += strlen(at) + 1) {
        const size_t length = strlen(at);
        if (strncmp(file, at, length) == 0 && strcmp(file + length, image_ending) == 0)
            return true;
    }
    return false;
}

/* Whether that chain is one of the journal's, of a record that no `golden` follows. */
static bool is_followed_by_no_golden(const char *chain, const char *bytes, size_t length)
{
    struct walk walk;
    struct record record;
    bool found = false;
    if (walk_begin(&walk, bytes, length, NULL) != OK)
        return false;
    while (!found && walk_next(&walk, &record) == WALK_RECORD)
        found = strcmp(walk.chain.hex, chain) == 0;
    if (found && walk_next(&walk, &record) == WALK_RECORD)
        found = strncmp(record.command, "golden ", 7) != 0;
    walk_release(&walk);
    return found;
}

bool golden_is_leftover(const char *path, const char *journal_path, const char *bytes,
                        size_t length)
{
    struct picture picture = {0};
    struct buf name = {0};
    if (exr_read(&picture, path, NULL) != OK)
        return false;
    golden_journal_name(&name, journal_path);
    const char *journal = picture_find(&picture, "iftty:journal"),
               *chain = picture_find(&picture, "iftty:chain");
    const bool is_ours = !journal || strcmp(journal, buf_text(&name)) == 0;
    const bool is_leftover = is_ours && chain && is_followed_by_no_golden(chain, bytes, length);
    picture_release(&picture);
    buf_release(&name);
    return is_leftover;
}

/* The PNG first, and not without it: what is left after a kill is found again by the golden
 * image. */
static void remove_leftover(const struct buf *path, struct buf *told)
{
    struct buf png = {0};
    buf_add(&png, path->data, path->length - strlen(image_ending));
    buf_add_text(&png, ".png");
    const bool is_gone = !png.failed && (unlink(buf_text(&png)) == 0 || errno == ENOENT);
    buf_release(&png);
    if (!is_gone || unlink(buf_text(path)) != 0)
        return;
    buf_add_safe_text(told, buf_text(path));
    buf_add_text(told, " was removed: its command was ended before it was recorded\n");
}

void golden_remove_leftovers(const char *journal_path, const struct buf *named, const char *bytes,
                             size_t length, struct buf *told)
{
    struct buf folder = {0}, path = {0};
    DIR *listing =
        golden_folder(&folder, journal_path, NULL) == OK ? opendir(buf_text(&folder)) : NULL;
    if (listing)
        file_sweep(buf_text(&folder));
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        if (*entry->d_name == '.' || !file_is_named(entry->d_name, image_ending) ||
            golden_is_named(named, entry->d_name))
            continue;
        buf_clear(&path);
        buf_printf(&path, "%s/%s", buf_text(&folder), entry->d_name);
        if (!path.failed && golden_is_leftover(buf_text(&path), journal_path, bytes, length))
            remove_leftover(&path, told);
    }
    if (listing)
        closedir(listing);
    buf_release(&folder);
    buf_release(&path);
}
