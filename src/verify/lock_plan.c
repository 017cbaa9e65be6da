#include "verify/lock_plan.h"

#include <dirent.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/mem.h"

enum { JOURNALS_MOST = 100000, DEPTH_MOST = 32 };

/* ---- journals in a folder ---- */

static enum err find_journals(struct name_list *found, const char *folder, struct buf *below,
                              unsigned depth, struct fault *fault);

/* "FOLDER/BELOW" */
static void join(struct buf *out, const char *folder, const char *below)
{
    buf_clear(out);
    if (strcmp(folder, ".") != 0 || !*below)
        buf_printf(out, "%s%s", folder, *below && strcmp(folder, "/") != 0 ? "/" : "");
    buf_add_text(out, below);
}

/* One entry, whose name below the lock's folder is `below`. */
static enum err take_entry(struct name_list *found, const char *folder, struct buf *below,
                           unsigned depth, struct fault *fault)
{
    struct buf path = {0};
    struct stat status;
    enum err err = OK;
    join(&path, folder, buf_text(below));
    if (path.failed || below->failed)
        err = fault_memory(fault, "a path");
    else if (lstat(buf_text(&path), &status) != 0)
        err = OK; /* it went away meanwhile */
    else if (S_ISDIR(status.st_mode) && depth < DEPTH_MOST)
        err = find_journals(found, folder, below, depth + 1, fault);
    else if (!S_ISDIR(status.st_mode) && lock_name_is_valid(buf_text(below)))
        err = found->count == JOURNALS_MOST
                  ? fault_set(fault, ERR_LIMIT, "there are more than %d journals below %s",
                              JOURNALS_MOST, folder)
              : name_list_add(found, buf_text(below)) ? OK
                                                      : fault_memory(fault, "names of journals");
    buf_release(&path);
    return err;
}

static enum err find_journals(struct name_list *found, const char *folder, struct buf *below,
                              unsigned depth, struct fault *fault)
{
    struct buf path = {0};
    const size_t length = below->length;
    enum err err = OK;
    join(&path, folder, buf_text(below));
    DIR *entries = path.failed ? NULL : opendir(buf_text(&path));
    if (path.failed)
        err = fault_memory(fault, "a path");
    else if (!entries)
        err = fault_errno(fault, "read the folder", buf_text(&path));
    for (const struct dirent *entry; entries && !err && (entry = readdir(entries));) {
        if (*entry->d_name == '.')
            continue;
        buf_printf(below, "%s%s", length ? "/" : "", entry->d_name);
        err = take_entry(found, folder, below, depth, fault);
        if (below->data)
            below->data[below->length = length] = '\0';
    }
    if (entries)
        closedir(entries);
    buf_release(&path);
    return err;
}

/* ---- names and paths ---- */

/* The folder of a path without links, NULL for none. The caller frees it. */
static char *real_folder(const char *path)
{
    struct buf folder = {0};
    file_folder(&folder, path);
    char *real = folder.failed ? NULL : realpath(buf_text(&folder), NULL);
    buf_release(&folder);
    return real;
}

/* The name that the lock has for a journal that the user names. */
static enum err add_named(struct lock_plan *plan, const char *path, const char *home,
                          struct fault *fault)
{
    char *real = real_folder(path);
    const size_t length = strcmp(home, "/") == 0 ? 0 : strlen(home);
    struct buf name = {0};
    enum err err = OK;
    if (real && strncmp(real, home, length) == 0 && (real[length] == '/' || !real[length]))
        buf_printf(&name, "%s%s%s", real + length + (real[length] == '/'),
                   real[length] && real[length + 1] ? "/" : "", file_name(path));
    if (!lock_name_is_valid(buf_text(&name)))
        err = fault_set(fault, ERR_USAGE,
                        "%s: a lock has journals *.iftty in its own folder and those below it, "
                        "which is %s",
                        path, home);
    else if (!name_list_add(&plan->name, buf_text(&name)))
        err = fault_memory(fault, "names of journals");
    buf_release(&name);
    free(real);
    return err;
}

static enum err take_named(struct lock_plan *plan, char *const *named, size_t count,
                           struct fault *fault)
{
    char *home = real_folder(plan->path);
    enum err err = home ? OK : fault_errno(fault, "find the folder of", plan->path);
    for (size_t i = 0; !err && i < count; i++)
        err = add_named(plan, named[i], home, fault);
    free(home);
    return err;
}

/* Those of the lock, and those of its folder. */
static enum err take_all(struct lock_plan *plan, struct fault *fault)
{
    struct buf folder = {0}, below = {0};
    enum err err = OK;
    file_folder(&folder, plan->path);
    if (folder.failed)
        err = fault_memory(fault, "a path");
    if (!err)
        err = find_journals(&plan->name, buf_text(&folder), &below, 0, fault);
    for (size_t i = 0; !err && !plan->updates && i < plan->lock.count; i++)
        if (!name_list_add(&plan->name, plan->lock.entry[i].name))
            err = fault_memory(fault, "names of journals");
    buf_release(&below);
    buf_release(&folder);
    return err;
}

static enum err make_paths(struct lock_plan *plan, struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    plan->journal = calloc(plan->name.count + 1, sizeof *plan->journal);
    bool fine = plan->journal;
    file_folder(&folder, plan->path);
    for (size_t i = 0; fine && i < plan->name.count; i++) {
        join(&path, buf_text(&folder), plan->name.name[i]);
        fine =
            !folder.failed && !path.failed && (plan->journal[i] = strdup(buf_text(&path))) != NULL;
    }
    buf_release(&path);
    buf_release(&folder);
    return fine ? OK : fault_memory(fault, "names of journals");
}

enum err lock_plan_make(struct lock_plan *plan, const char *path, bool updates, char *const *named,
                        size_t count, struct fault *fault)
{
    *plan = (struct lock_plan){.path = path, .updates = updates, .is_whole = count == 0};
    struct buf bytes = {0};
    enum err err = OK;
    if (updates && !file_exists(path)) {
        plan->lock.version = LOCK_VERSION;
    } else {
        err = file_read(&bytes, path, LOCK_BYTES_MAX, fault);
        if (!err && (err = lock_read(&plan->lock, buf_text(&bytes), bytes.length, fault)))
            fault_prefix(fault, err, "%s", path);
    }
    buf_release(&bytes);
    if (!err && updates && !plan->is_whole && plan->lock.version < LOCK_VERSION)
        err = fault_set(fault, ERR_USAGE,
                        "%s is of the form before, which pins no PNGs: --update-lock with no "
                        "journals named writes all of it anew",
                        path);
    if (!err)
        err = count ? take_named(plan, named, count, fault) : take_all(plan, fault);
    name_list_sort(&plan->name);
    if (!err && !plan->name.count)
        err = fault_set(fault, ERR_CHECK, "there is no journal *.iftty where %s lies", path);
    return err ? err : make_paths(plan, fault);
}

const char *lock_plan_pinned(const struct lock_plan *plan, size_t number)
{
    return lock_facts_of(&plan->lock, plan->name.name[number]);
}

void lock_plan_release(struct lock_plan *plan)
{
    for (size_t i = 0; plan->journal && i < plan->name.count; i++)
        free(plan->journal[i]);
    free(plan->journal);
    name_list_release(&plan->name);
    lock_release(&plan->lock);
}

/* ---- written anew ---- */

static void add_line(struct buf *lines, const char *what, const char *name)
{
    buf_printf(lines, "# %s ", what);
    buf_add_safe_text(lines, name);
    buf_add_char(lines, '\n');
}

enum err lock_plan_write(struct lock_plan *plan, const char *const *facts, struct buf *lines,
                         struct fault *fault)
{
    struct buf text = {0};
    const size_t before = lines->length;
    bool fine = true;
    if (plan->lock.version < LOCK_VERSION)
        add_line(lines, "in the present form, which pins PNGs too:", plan->path);
    plan->lock.version = LOCK_VERSION;
    for (size_t i = 0; plan->is_whole && i < plan->lock.count;) { /* those that are gone go */
        const char *name = plan->lock.entry[i].name;
        if (name_list_has(&plan->name, name)) {
            i++;
            continue;
        }
        add_line(lines, "no longer in the lock:", name);
        lock_remove(&plan->lock, name);
    }
    for (size_t i = 0; fine && i < plan->name.count; i++) {
        const char *name = plan->name.name[i], *former = lock_facts_of(&plan->lock, name);
        if (former && strcmp(former, facts[i]) == 0)
            continue;
        add_line(lines, former ? "changed in the lock:" : "new in the lock:", name);
        fine = lock_set(&plan->lock, name, facts[i]);
    }
    lock_write(&text, &plan->lock);
    enum err err = fine && !text.failed ? OK : fault_memory(fault, "a lock");
    if (!err && (lines->length > before || !file_exists(plan->path)))
        err = file_write(plan->path, buf_text(&text), text.length, FILE_REPLACE, fault);
    else if (!err)
        add_line(lines, "nothing has changed in", plan->path);
    buf_release(&text);
    return err;
}
