#include "verify/lock_facts.h"

#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "verify/name_list.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "journal/walk.h"
#include "sandbox/trust.h"

enum { GOLDEN_BYTES_MAX = 1 << 30 };

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

static bool add_scene(struct name_list *lines, const struct record *record)
{
    struct record_word scene;
    struct buf line = {0};
    bool fine = true;
    if (record_word_find(record->result, "scene", 5, &scene) && scene.value_length == 16 &&
        record_word_is_digest(&scene)) {
        buf_printf(&line, "scene %.16s", scene.value);
        fine = !line.failed && name_list_add(lines, buf_text(&line));
    }
    buf_release(&line);
    return fine;
}

/* The name in "golden NAME", or "". */
static void golden_name(struct buf *name, const char *command)
{
    buf_clear(name);
    if (strncmp(command, "golden ", 7) == 0)
        buf_add(name, command + 7, strcspn(command + 7, " "));
}

static enum err walk_through(struct walk *walk, struct name_list *scenes, struct name_list *goldens)
{
    struct record record;
    struct buf name = {0};
    bool fine = true;
    while (fine && walk_next(walk, &record) == WALK_RECORD) {
        golden_name(&name, record.command);
        fine = add_scene(scenes, &record) && !name.failed &&
               (!name.length || name_list_add(goldens, buf_text(&name)));
    }
    buf_release(&name);
    name_list_sort(scenes);
    name_list_sort(goldens);
    return fine ? OK : ERR_MEMORY;
}

static void add_lines(struct buf *out, const struct name_list *lines)
{
    for (size_t i = 0; i < lines->count; i++)
        buf_printf(out, "%s\n", lines->name[i]);
}

static enum err add_facts(struct buf *out, struct walk *walk, const char *path, struct fault *fault)
{
    struct name_list scenes = {0}, goldens = {0}, lines = {0};
    enum err err = walk_through(walk, &scenes, &goldens);
    bool fine = !err;
    for (size_t i = 0; fine && i < 2 * goldens.count; i++)
        fine = add_file(&lines, path, goldens.name[i % goldens.count], i >= goldens.count);
    buf_printf(out, "chain %s\nrecords %zu\n", walk->chain.hex, walk->records);
    add_lines(out, &scenes);
    add_lines(out, &lines);
    err = fine && !out->failed ? walk_judge(walk, fault) : fault_memory(fault, "a lock");
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
