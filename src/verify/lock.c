#include "verify/lock.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "journal/golden.h"
#include "journal/record.h"

static const char before_version[] = "# iftty lock ";

/* What a line begins with, in the order in which lines stand. */
enum kind { KIND_JOURNAL, KIND_CHAIN, KIND_RECORDS, KIND_SCENE, KIND_GOLDEN, KIND_PNG, KINDS };
static const char *const kind_word[KINDS] = {"journal ", "chain ",  "records ",
                                             "scene ",   "golden ", "png "};

/* ---- names ---- */

static bool is_part(const char *at, size_t length)
{
    return length && !(length <= 2 && strncmp(at, "..", length) == 0);
}

bool lock_name_is_valid(const char *name)
{
    static const char ending[] = ".iftty";
    const size_t length = strlen(name);
    if (length < sizeof ending || length > LOCK_NAME_MAX || *safe_end(name) ||
        strcmp(name + length - (sizeof ending - 1), ending) != 0)
        return false;
    for (const char *at = name;; at++) {
        const size_t part = strcspn(at, "/");
        if (!is_part(at, part))
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

static bool is_count(const char *text)
{
    int64_t count;
    const char *at = text;
    return (*text != '0' || !text[1]) && scan_integer(&at, 0, INT64_MAX, &count) && !*at;
}

/* Whether what follows the word is as it has to be. */
static bool is_value(enum kind kind, const char *value)
{
    switch (kind) {
    case KIND_JOURNAL:
        return lock_name_is_valid(value);
    case KIND_CHAIN:
        return is_hex(value, RECORD_CHAIN_DIGITS);
    case KIND_RECORDS:
        return is_count(value);
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

static enum err read_lines(struct reading *r, const char *at, const char *end, struct fault *fault)
{
    struct buf line = {0};
    enum err err = OK;
    for (r->number = 2; !err && at < end; r->number++) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        buf_clear(&line);
        if (feed)
            buf_add(&line, at, (size_t)(feed - at));
        if (!feed || strlen(buf_text(&line)) != line.length)
            err = refuse(r, "a line of text that ends with a line feed", fault);
        else
            err =
                line.failed ? fault_memory(fault, "a lock") : read_line(r, buf_text(&line), fault);
        at = feed ? feed + 1 : end;
    }
    buf_release(&line);
    return err;
}

enum err lock_read(struct lock *lock, const char *bytes, size_t length, struct fault *fault)
{
    struct reading r = {.lock = lock, .before = KINDS, .number = 1};
    const size_t before = sizeof before_version - 1, begin = before + 2;
    if (length >= begin && memcmp(bytes, before_version, before) == 0 && bytes[before + 1] == '\n')
        lock->version = (unsigned)(bytes[before] - '0');
    if (lock->version < 1 || lock->version > LOCK_VERSION)
        return refuse(&r, "`# iftty lock 2`, or 1", fault);
    enum err err = read_lines(&r, bytes + begin, bytes + length, fault);
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

static void tell(struct buf *lines, const char *line, const char *what, const char *other)
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
        tell(lines, at, other ? "and it is" : "and there is none now", other);
        differs = true;
    }
    for (const char *at = now; *at; at += strcspn(at, "\n"), at += *at == '\n')
        if (!find_line(pinned, at) && (version >= LOCK_WITH_PNG || kind_of(at) != KIND_PNG)) {
            tell(lines, at, "which the lock has not", NULL);
            differs = true;
        }
    return differs;
}
