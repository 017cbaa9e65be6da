#include "verify/iftty_lock.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "sandbox/trust.h"
#include "verify/name_list.h"

enum { GOLDEN_BYTES_MAX = 1 << 30 };

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

/* Where it is, or where it would go. */
static size_t place_of(const struct lock *lock, const char *name, bool *is_there)
{
    size_t least = 0, end = lock->count;
    *is_there = false;
    while (least < end) {
        const size_t middle = least + (end - least) / 2;
        const int order = strcmp(lock->entry[middle].name, name);
        *is_there = *is_there || order == 0;
        if (order < 0)
            least = middle + 1;
        else
            end = middle;
    }
    return least;
}

const char *lock_facts_of(const struct lock *lock, const char *name)
{
    bool is_there;
    const size_t at = place_of(lock, name, &is_there);
    return is_there ? lock->entry[at].facts : NULL;
}

static void release_entry(struct lock_entry *entry)
{
    free(entry->name);
    free(entry->facts);
}

bool lock_set(struct lock *lock, const char *name, const char *facts)
{
    bool is_there;
    const size_t at = place_of(lock, name, &is_there);
    struct lock_entry entry = {strdup(name), strdup(facts)};
    if (!entry.name || !entry.facts ||
        !mem_grow(&lock->entry, &lock->capacity, lock->count + 1, sizeof *lock->entry)) {
        release_entry(&entry);
        return false;
    }
    if (is_there) {
        release_entry(lock->entry + at);
    } else {
        memmove(lock->entry + at + 1, lock->entry + at, (lock->count - at) * sizeof entry);
        lock->count++;
    }
    lock->entry[at] = entry;
    return true;
}

void lock_remove(struct lock *lock, const char *name)
{
    bool is_there;
    const size_t at = place_of(lock, name, &is_there);
    if (!is_there)
        return;
    release_entry(lock->entry + at);
    lock->count--;
    memmove(lock->entry + at, lock->entry + at + 1, (lock->count - at) * sizeof *lock->entry);
}

void lock_release(struct lock *lock)
{
    for (size_t i = 0; i < lock->count; i++)
        release_entry(lock->entry + i);
    free(lock->entry);
    *lock = (struct lock){0};
}

/* ---- as text ---- */

void lock_write(struct buf *out, const struct lock *lock)
{
    buf_printf(out, "%s%u\n", before_version, lock->version);
    for (size_t i = 0; i < lock->count; i++)
        buf_printf(out, "journal %s\n%s", lock->entry[i].name, lock->entry[i].facts);
}

static bool is_hex(const char *text, size_t digits)
{
    return strspn(text, "0123456789abcdef") == digits && !text[digits];
}

static bool is_golden(const char *text)
{
    char name[80] = "";
    const size_t length = strcspn(text, " ");
    if (length >= sizeof name || text[length] != ' ')
        return false;
    memcpy(name, text, length);
    return golden_name_is_valid(name) && is_hex(text + length + 1, 64);
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
        return is_hex(value, RECORD_CHAIN_DIGITS);
    case KIND_RECORDS:
        return (*value != '0' || !value[1]) && scan_integer(&at, 0, INT64_MAX, &count) && !*at;
    case KIND_SCENE:
        return is_hex(value, 16);
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

static bool keep_journal(struct reading *r)
{
    const bool fine =
        !r->name.length || (!r->name.failed && !r->facts.failed &&
                            lock_set(r->lock, buf_text(&r->name), buf_text(&r->facts)));
    buf_clear(&r->name);
    buf_clear(&r->facts);
    return fine;
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

/* "golden NAME SHA-256", or of its PNG "png NAME SHA-256", where the journal has such a file. */
static bool add_file(struct name_list *lines, const char *path, const char *name, bool is_png)
{
    struct buf file = {0}, bytes = {0}, line = {0};
    char hex[SHA256_HEX];
    bool fine = true;
    const bool is_named = !golden_path(&file, path, name, NULL);
    if (is_named && is_png)
        memcpy(file.data + file.length - 3, "png", 3);
    if (is_named && trust_look_at_golden(buf_text(&file)) == BENEATH_FINE &&
        !file_read(&bytes, buf_text(&file), GOLDEN_BYTES_MAX, NULL)) {
        sha256_bytes_hex(hex, buf_text(&bytes), bytes.length);
        buf_printf(&line, "%s %s %s", is_png ? "png" : "golden", name, hex);
        fine = !line.failed && name_list_add(lines, buf_text(&line));
    }
    buf_release(&file);
    buf_release(&bytes);
    buf_release(&line);
    return fine;
}

static enum err add_facts(struct buf *out, struct walk *walk, const char *path, struct fault *fault)
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
        fine = add_file(&lines, path, goldens.name[i % goldens.count], i >= goldens.count);
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

enum err lock_facts(struct buf *out, uint64_t *torn, const char *path, struct fault *fault)
{
    struct buf bytes = {0};
    struct walk walk;
    enum err err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (!err) {
        err = walk_begin(&walk, buf_text(&bytes), bytes.length, fault);
        if (!err)
            err = add_facts(out, &walk, path, fault);
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
