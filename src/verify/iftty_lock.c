/* SPDX-License-Identifier: MIT */
#include "verify/iftty_lock.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nettle/sha2.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "command/trust.h"

enum {
    LOCK_BYTES_MAX = 64 << 20,
    LOCK_NAME_MAX = 4000,
    GOLDEN_BYTES_MAX = 1 << 30,
    PIECE = 1 << 16,
    JOURNALS_MOST = 100000,
    DEPTH_MOST = 32 /* of folders */
};

static const char before_version[] = "# iftty lock ";

/* What a line begins with, in the order in which lines stand. */
enum kind { KIND_JOURNAL, KIND_CHAIN, KIND_RECORDS, KIND_SCENE, KIND_GOLDEN, KIND_PNG, KINDS };
static const char *const kind_word[KINDS] = {"journal ", "chain ",  "records ",
                                             "scene ",   "golden ", "png "};

/* ---- names ---- */

bool lock_name_is_valid(const char *name)
{
    static const char ending[] = ".iftty";
    const size_t length = strlen(name);
    if (length < sizeof ending || length > LOCK_NAME_MAX || *safe_end(name) ||
        strcmp(name + length - (sizeof ending - 1), ending) != 0)
        return false;
    for (const char *at = name;; at++) {
        const size_t part = strcspn(at, "/");
        if (part == 0 || (part <= 2 && strncmp(at, "..", part) == 0))
            return false;
        at += part;
        if (!*at)
            return true;
    }
}

/* ---- entries ---- */

static int compare_name(const void *name, const void *entry)
{
    return strcmp(name, ((const struct lock_entry *)entry)->name);
}

const char *lock_facts_of(const struct lock *lock, const char *name)
{
    const struct lock_entry *found =
        lock->count ? bsearch(name, lock->entry, lock->count, sizeof *lock->entry, compare_name)
                    : NULL;
    return found ? found->facts : NULL;
}

static void release_entry(struct lock_entry *entry)
{
    free(entry->name);
    free(entry->facts);
}

void lock_release(struct lock *lock)
{
    for (size_t i = 0; i < lock->count; i++)
        release_entry(lock->entry + i);
    free(lock->entry);
    *lock = (struct lock){0};
}

/* ---- as text ---- */

static void write_entry(struct buf *out, const char *name, const char *facts)
{
    buf_printf(out, "journal %s\n%s", name, facts);
}

static bool is_golden(const char *text)
{
    char name[80] = "";
    const size_t length = strcspn(text, " ");
    if (length >= sizeof name || text[length] != ' ')
        return false;
    memcpy(name, text, length);
    return golden_name_is_valid(name) && scan_is_hex(text + length + 1, 64);
}

/* Whether what follows the word is as it has to be. */
static bool is_value(enum kind kind, const char *value)
{
    const char *at = value;
    int64_t count;
    switch (kind) {
    case KIND_JOURNAL:
        return lock_name_is_valid(value);
    case KIND_CHAIN:
        return scan_is_hex(value, RECORD_CHAIN_DIGITS);
    case KIND_RECORDS:
        return (*value != '0' || !value[1]) && scan_integer(&at, 0, INT64_MAX, &count) && !*at;
    case KIND_SCENE:
        return scan_is_hex(value, 16);
    default:
        return is_golden(value);
    }
}

static enum kind kind_of(const char *line)
{
    enum kind kind = 0;
    while (kind < KINDS && strncmp(line, kind_word[kind], strlen(kind_word[kind])) != 0)
        kind++;
    return kind;
}

/* A line may follow another: the next kind that has to be there, or more of one kind, in order. The
 * first, which follows none (KINDS), is a journal's name. */
static bool may_follow(enum kind kind, const char *line, enum kind before, const char *former)
{
    if (before == KIND_JOURNAL || before == KIND_CHAIN)
        return kind == before + 1;
    if (kind == KIND_JOURNAL)
        return true;
    return kind >= KIND_SCENE && (kind > before || (kind == before && strcmp(line, former) > 0));
}

struct reading {
    struct lock *lock;
    struct buf name, facts, former; /* of the journal at hand; the line before */
    enum kind before;
    size_t number; /* of the line, from 1 */
};

/* The journal at hand, whose lines are over, is an entry; false without memory. */
static bool keep_journal(struct reading *r)
{
    struct lock *lock = r->lock;
    struct lock_entry entry = {NULL, NULL};
    if (!r->name.length)
        return !r->name.failed;
    if (!r->name.failed && !r->facts.failed)
        entry = (struct lock_entry){strdup(buf_text(&r->name)), strdup(buf_text(&r->facts))};
    buf_clear(&r->name);
    buf_clear(&r->facts);
    if (!entry.name || !entry.facts ||
        !mem_grow(&lock->entry, &lock->capacity, lock->count + 1, sizeof *lock->entry)) {
        release_entry(&entry);
        return false;
    }
    lock->entry[lock->count++] = entry;
    return true;
}

static enum err refuse(const struct reading *r, const char *expected, struct fault *fault)
{
    return fault_set(fault, ERR_INPUT, "line %zu: expected %s; --update-lock writes a lock anew",
                     r->number, expected);
}

static enum err read_line(struct reading *r, const char *line, struct fault *fault)
{
    enum kind kind = kind_of(line);
    if (kind == KIND_PNG && r->lock->version < LOCK_WITH_PNG)
        kind = KINDS;
    if (kind == KINDS || !is_value(kind, line + strlen(kind_word[kind])))
        return refuse(
            r, "`journal`, `chain`, `records`, `scene`, `golden` or `png`, and what belongs to it",
            fault);
    if (!may_follow(kind, line, r->before, buf_text(&r->former)))
        return refuse(r, "lines in their order, each once", fault);
    if (kind == KIND_JOURNAL) {
        const char *name = line + strlen(kind_word[kind]);
        if (r->name.length && strcmp(name, buf_text(&r->name)) <= 0)
            return refuse(r, "journals in the order of their names, each once", fault);
        if (!keep_journal(r))
            return fault_memory(fault, "a lock");
        buf_add_text(&r->name, name);
    } else {
        buf_printf(&r->facts, "%s\n", line);
    }
    r->before = kind;
    buf_clear(&r->former);
    buf_add_text(&r->former, line);
    return OK;
}

enum err lock_read(struct lock *lock, const char *bytes, size_t length, struct fault *fault)
{
    struct reading r = {.lock = lock, .before = KINDS, .number = 1};
    const size_t before = sizeof before_version - 1, begin = before + 2;
    if (length >= begin && memcmp(bytes, before_version, before) == 0 && bytes[before + 1] == '\n')
        lock->version = (unsigned)(bytes[before] - '0');
    if (lock->version < 1 || lock->version > LOCK_VERSION)
        return refuse(&r, "`# iftty lock 2`, or 1", fault);
    struct buf line = {0};
    const char *at = bytes + begin, *end = bytes + length;
    enum err err = OK;
    for (r.number = 2; !err && at < end; r.number++) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        buf_clear(&line);
        if (feed)
            buf_add(&line, at, (size_t)(feed - at));
        if (!feed || strlen(buf_text(&line)) != line.length)
            err = refuse(&r, "a line of text that ends with a line feed", fault);
        else
            err =
                line.failed ? fault_memory(fault, "a lock") : read_line(&r, buf_text(&line), fault);
        at = feed ? feed + 1 : end;
    }
    buf_release(&line);
    if (!err && (r.before == KIND_JOURNAL || r.before == KIND_CHAIN))
        err = refuse(&r, "the rest of a journal's lines", fault);
    if (!err && !keep_journal(&r))
        err = fault_memory(fault, "a lock");
    buf_release(&r.name);
    buf_release(&r.facts);
    buf_release(&r.former);
    return err;
}

/* ---- comparing ---- */

/* How much of a line says what is pinned: "chain", "scene 01..ef", "golden left", "png left". */
static size_t subject_of(const char *line)
{
    const size_t word = strcspn(line, " \n");
    const bool has_name = strncmp(line, "golden ", 7) == 0 || strncmp(line, "png ", 4) == 0;
    return has_name                          ? word + 1 + strcspn(line + word + 1, " \n")
           : strncmp(line, "scene ", 6) == 0 ? strcspn(line, "\n")
                                             : word;
}

/* The line of the same subject, or NULL. */
static const char *find_line(const char *facts, const char *line)
{
    const size_t length = subject_of(line);
    for (const char *at = facts; *at; at += strcspn(at, "\n"), at += *at == '\n')
        if (subject_of(at) == length && strncmp(at, line, length) == 0)
            return at;
    return NULL;
}

static void add_line(struct buf *lines, const char *line, const char *what, const char *other)
{
    const size_t subject = subject_of(line), whole = strcspn(line, "\n");
    buf_printf(lines, "#   pinned   ");
    buf_add_safe(lines, line, subject);
    if (whole > subject) {
        buf_add_char(lines, ':');
        buf_add_safe(lines, line + subject, whole - subject);
    }
    buf_printf(lines, ", %s", what);
    if (other) {
        buf_add_safe(lines, other + subject, strcspn(other, "\n") - subject);
        buf_add_text(lines, " now");
    }
    buf_add_char(lines, '\n');
}

bool lock_differs(struct buf *lines, unsigned version, const char *pinned, const char *now)
{
    bool differs = false;
    for (const char *at = pinned; *at; at += strcspn(at, "\n"), at += *at == '\n') {
        const char *other = find_line(now, at);
        const size_t length = strcspn(at, "\n");
        if (other && strcspn(other, "\n") == length && strncmp(at, other, length) == 0)
            continue;
        add_line(lines, at, other ? "and it is" : "and there is none now", other);
        differs = true;
    }
    for (const char *at = now; *at; at += strcspn(at, "\n"), at += *at == '\n')
        if (!find_line(pinned, at) && (version >= LOCK_WITH_PNG || kind_of(at) != KIND_PNG)) {
            add_line(lines, at, "which the lock has not", NULL);
            differs = true;
        }
    return differs;
}

/* ---- what it says of a journal ---- */

static bool digest_file(char hex[SHA256_HEX], const char *path)
{
    uint8_t piece[PIECE];
    struct sha256_ctx sha;
    uint64_t bytes, at = 0;
    ssize_t n = PIECE;
    int fd;
    if (file_open(&fd, &bytes, path, O_RDONLY, NULL) || bytes > GOLDEN_BYTES_MAX)
        return false;
    sha256_init(&sha);
    for (; n == PIECE && (n = file_read_at(fd, piece, PIECE, at)) > 0; at += (uint64_t)n)
        sha256_update(&sha, (size_t)n, piece);
    close(fd);
    sha256_hex(hex, &sha, SHA256_DIGEST_SIZE);
    return n >= 0;
}

/* "golden NAME SHA-256", or of its PNG "png NAME SHA-256", where the journal has such a file. */
static bool add_file(struct name_list *lines, const char *path, const char *name, bool is_png,
                     bool is_proven)
{
    struct buf file = {0}, line = {0};
    char hex[SHA256_HEX];
    bool fine = true, leads_out;
    const bool is_named = !golden_path(&file, path, name, NULL);
    if (is_named && is_png)
        memcpy(file.data + file.length - 3, "png", 3);
    if (is_named && trust_look_at_golden(buf_text(&file), &leads_out) == BENEATH_FINE &&
        (is_proven || !leads_out) && digest_file(hex, buf_text(&file))) {
        buf_printf(&line, "%s %s %s", is_png ? "png" : "golden", name, hex);
        fine = !line.failed && name_list_add(lines, buf_text(&line));
    }
    buf_release(&file);
    buf_release(&line);
    return fine;
}

static enum err add_facts(struct buf *out, struct walk *walk, const char *path, bool is_proven,
                          struct fault *fault)
{
    struct name_list scenes = {0}, goldens = {0}, lines = {0};
    struct record record;
    struct record_word scene;
    struct buf text = {0};
    bool fine = true;
    while (fine && walk_next(walk, &record) == WALK_RECORD) {
        buf_clear(&text);
        if (record_word_find(record.result, "scene", 5, &scene) && scene.value_length == 16 &&
            record_word_is_digest(&scene)) {
            buf_printf(&text, "scene %.16s", scene.value);
            fine = !text.failed && name_list_add(&scenes, buf_text(&text));
        }
        buf_clear(&text);
        if (fine && strncmp(record.command, "golden ", 7) == 0) {
            buf_add(&text, record.command + 7, strcspn(record.command + 7, " "));
            fine = !text.failed && (!text.length || name_list_add(&goldens, buf_text(&text)));
        }
    }
    buf_release(&text);
    name_list_sort(&scenes);
    name_list_sort(&goldens);
    for (size_t i = 0; fine && i < 2 * goldens.count; i++)
        fine =
            add_file(&lines, path, goldens.name[i % goldens.count], i >= goldens.count, is_proven);
    buf_printf(out, "chain %s\nrecords %zu\n", walk->chain.hex, walk->records);
    for (size_t i = 0; i < scenes.count; i++)
        buf_printf(out, "%s\n", scenes.name[i]);
    for (size_t i = 0; i < lines.count; i++)
        buf_printf(out, "%s\n", lines.name[i]);
    const enum err err =
        fine && !out->failed ? walk_judge(walk, fault) : fault_memory(fault, "a lock");
    name_list_release(&scenes);
    name_list_release(&goldens);
    name_list_release(&lines);
    return err;
}

enum err lock_facts(struct buf *out, uint64_t *torn, const char *path, bool is_proven,
                    struct fault *fault)
{
    struct buf bytes = {0};
    struct walk walk;
    enum err err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (!err) {
        err = walk_begin(&walk, buf_text(&bytes), bytes.length, fault);
        if (!err)
            err = add_facts(out, &walk, path, is_proven, fault);
        *torn = !err && walk.over == WALK_TORN ? walk.offset : 0;
        walk_release(&walk);
    }
    buf_release(&bytes);
    return err;
}

const char *lock_facts_chain(const char *facts)
{
    static const char word[] = "chain ";
    return strncmp(facts, word, sizeof word - 1) == 0 ? facts + sizeof word - 1 : NULL;
}

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
    char *home = count ? real_folder(path) : NULL;
    if (!err && count && !home)
        err = fault_errno(fault, "find the folder of", path);
    for (size_t i = 0; !err && i < count; i++)
        err = add_named(plan, named[i], home, fault);
    free(home);
    if (!err && !count)
        err = take_all(plan, fault);
    name_list_sort(&plan->name);
    if (!err && !plan->name.count)
        err = fault_set(fault, ERR_CHECK, "there is no journal *.iftty where %s lies", path);
    return err ? err : make_paths(plan, fault);
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

static void add_notice(struct buf *lines, const char *what, const char *name)
{
    buf_printf(lines, "# %s ", what);
    buf_add_safe_text(lines, name);
    buf_add_char(lines, '\n');
}

enum err lock_plan_write(struct lock_plan *plan, const char *const *facts, struct buf *lines,
                         struct fault *fault)
{
    const struct lock_entry *at = plan->lock.entry, *const end = at + plan->lock.count;
    struct buf text = {0};
    const size_t before = lines->length;
    if (plan->lock.version < LOCK_VERSION)
        add_notice(lines, "in the present form, which pins PNGs too:", plan->path);
    for (size_t i = 0; plan->is_whole && i < plan->lock.count; i++)
        if (!name_list_has(&plan->name, at[i].name))
            add_notice(lines, "no longer in the lock:", at[i].name);
    buf_printf(&text, "%s%u\n", before_version, LOCK_VERSION);
    for (size_t i = 0; i <= plan->name.count; i++) {
        const char *name = i < plan->name.count ? plan->name.name[i] : NULL;
        for (; at < end && (!name || strcmp(at->name, name) < 0); at++)
            if (!plan->is_whole)
                write_entry(&text, at->name, at->facts);
        if (!name)
            break;
        const char *former = at < end && strcmp(at->name, name) == 0 ? at++->facts : NULL;
        if (!former || strcmp(former, facts[i]) != 0)
            add_notice(lines, former ? "changed in the lock:" : "new in the lock:", name);
        write_entry(&text, name, facts[i]);
    }
    enum err err = text.failed ? fault_memory(fault, "a lock") : OK;
    if (!err && (lines->length > before || !file_exists(plan->path)))
        err = file_write(plan->path, buf_text(&text), text.length, FILE_REPLACE, fault);
    else if (!err)
        add_notice(lines, "nothing has changed in", plan->path);
    buf_release(&text);
    return err;
}
