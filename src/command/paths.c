/* Where the interpreter finds files, and where it may write them. */
#include "command/interpreter.h"

#include <stdlib.h>
#include <string.h>

#include "base/beneath.h"
#include "sandbox/trust.h"

static const char default_scenes[] = "/usr/share/mricron/templates";

enum err interpreter_set_home(struct interpreter *interp, const char *path, struct fault *fault)
{
    buf_clear(&interp->home);
    buf_add_text(&interp->home, path);
    return interp->home.failed ? fault_memory(fault, "a path") : OK;
}

const char *interpreter_scenes(void)
{
    const char *list = getenv("IFTTY_SCENES");
    return list ? list : default_scenes;
}

static bool try_folder(struct buf *path, const char *folder, size_t length, const char *name)
{
    buf_clear(path);
    buf_add(path, folder, length);
    buf_printf(path, "/%s", name);
    return file_exists(buf_text(path));
}

/* `kind` and `undone` are for the words: "scene", "was opened". */
static enum err find(const struct interpreter *interp, const char *name, struct buf *path,
                     const char *kind, const char *undone, bool takes_folders, struct fault *fault)
{
    struct buf folder = {0};
    bool found = false;
    if (interpreter_is_wary(interp))
        return trust_find(path, buf_text(&interp->home), interpreter_scenes(), name, kind, undone,
                          takes_folders, fault);
    buf_clear(path);
    if (interp->home.length && *name != '/') {
        file_folder(&folder, buf_text(&interp->home));
        found = try_folder(path, buf_text(&folder), folder.length, name);
    }
    if (!found && file_exists(name)) {
        buf_clear(path);
        buf_add_text(path, name);
        found = true;
    }
    for (const char *list = interpreter_scenes(); !found && beneath_is_inside(name) && *list;) {
        size_t length = strcspn(list, ":");
        found = length && try_folder(path, list, length, name);
        list += length + (list[length] == ':');
    }
    buf_release(&folder);
    if (path->failed)
        return fault_memory(fault, "a path");
    if (!found)
        return fault_set(fault, ERR_IO, "there is no %s %s here%s; nothing %s", kind, name,
                         interp->home.length ? " nor beside the journal" : "", undone);
    return OK;
}

enum err interpreter_find_scene(const struct interpreter *interp, const char *name,
                                struct buf *path, struct fault *fault)
{
    const bool synthetic = strncmp(name, "synth:", 6) == 0;
    if (!synthetic && !interp->scene_path) {
        const bool is_elsewhere = interpreter_is_wary(interp) && !beneath_is_inside(name);
        const enum err err = find(interp, is_elsewhere ? file_name(name) : name, path, "scene",
                                  "was opened", true, fault);
        if (err && is_elsewhere)
            fault_prefix(fault, err, "the journal may not open %s; expected --scene FILE", name);
        return err;
    }
    buf_clear(path);
    buf_add_text(path, synthetic ? name : interp->scene_path);
    return path->failed ? fault_memory(fault, "a path") : OK;
}

enum err interpreter_find_file(const struct interpreter *interp, const char *name, struct buf *path,
                               struct fault *fault)
{
    const bool is_elsewhere = interpreter_is_wary(interp) && !beneath_is_inside(name);
    const enum err err = find(interp, is_elsewhere ? file_name(name) : name, path, "file",
                              "has changed", false, fault);
    return err && is_elsewhere ? fault_prefix(fault, err, "the journal may not read %s", name)
                               : err;
}

enum err interpreter_may_read(const struct interpreter *interp, const char *path,
                              struct fault *fault)
{
    struct buf goldens = {0}, folder = {0};
    if (!interpreter_is_wary(interp))
        return OK;
    file_folder(&goldens, path);
    file_folder(&folder, buf_text(&goldens));
    const char *name = path + (file_name(buf_text(&goldens)) - buf_text(&goldens));
    const enum beneath answer =
        goldens.failed || folder.failed ? BENEATH_OUTSIDE : beneath_look(buf_text(&folder), name);
    buf_release(&goldens);
    buf_release(&folder);
    if (answer == BENEATH_FINE || answer == BENEATH_MISSING)
        return OK; /* the reader says that it is missing */
    return fault_set(fault, ERR_INPUT, "the journal may not read %s, which %s", path,
                     answer == BENEATH_OUTSIDE ? "leads out of its folder"
                                               : "is not a regular file");
}

/* ---- files that are written ---- */

/* The path that stands for `name` below the folder, or NULL; and which name a path stands for. */
static const char *place_of(const struct buf *placed, const char *name, const char *path)
{
    const char *at = buf_text(placed), *end = at + placed->length;
    while (at < end) {
        const char *of = at, *where = at + strlen(at) + 1;
        if (name ? strcmp(of, name) == 0 : strcmp(where, path) == 0)
            return where;
        at = where + strlen(where) + 1;
    }
    return NULL;
}

/* "out/lab.nii.gz", then "out/lab-2.nii.gz". */
static void write_place(struct buf *path, const char *folder, const char *name, unsigned number)
{
    const size_t stem = 1 + strcspn(name + 1, ".");
    buf_clear(path);
    buf_printf(path, "%s/", folder);
    buf_add(path, name, stem);
    if (number > 1)
        buf_printf(path, "-%u", number);
    buf_add_text(path, name + stem);
}

/* By the last part of its name: whatever a journal says, that is in the folder. Names that differ
 * get places that do, and one name always the same. */
static enum err place_below(struct interpreter *interp, const char *name, struct buf *path,
                            struct fault *fault)
{
    struct buf *placed = &interp->placed;
    const char *last = file_name(name), *before = place_of(placed, name, NULL);
    if (!*last || strcmp(last, ".") == 0 || strcmp(last, "..") == 0)
        return fault_set(fault, ERR_INPUT, "%s names no file; nothing was written", name);
    if (before) {
        buf_add_text(path, before);
        return path->failed ? fault_memory(fault, "a path") : OK;
    }
    unsigned number = 1;
    do
        write_place(path, interp->out_folder, last, number++);
    while (!path->failed && place_of(placed, NULL, buf_text(path)));
    if (path->failed || !buf_reserve(placed, strlen(name) + path->length + 2)) {
        placed->failed = false; /* what it holds is whole */
        return fault_memory(fault, "a path");
    }
    buf_add(placed, name, strlen(name) + 1);
    buf_add(placed, buf_text(path), path->length + 1);
    return OK;
}

enum err interpreter_output_path(struct interpreter *interp, const char *name, struct buf *path,
                                 struct fault *fault)
{
    buf_clear(path);
    if (interp->mode == MODE_RESUME || interp->mode == MODE_SKIM)
        return OK; /* it was written when the command was new */
    if (interp->out_folder)
        return place_below(interp, name, path, fault);
    if (interp->mode == MODE_LIVE)
        buf_add_text(path, name);
    return path->failed ? fault_memory(fault, "a path") : OK;
}
