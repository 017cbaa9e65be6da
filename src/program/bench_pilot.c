/* From a key to the picture: the pilot in a terminal at the far end of a line (bench_far_end.h). */
#include "program/bench_terminal.h"

#include "base/file.h"
#include "base/folder.h"
#include "program/bench.h"

enum { KEYS_MOST = 100, JOURNAL_MOST = 64 << 20 };

static const char *const prompt[] = {"> ", NULL}, *const frame[] = {"\033[c", NULL};

struct times {
    double shown_ms[KEYS_MOST], last_ms[KEYS_MOST], bytes[KEYS_MOST];
    unsigned keys;
};

static enum err press(struct far_end *e, const char *keys, const char *const *awaited,
                      struct fault *fault)
{
    struct far_result result;
    return far_end_press(e, keys, awaited, &result, fault);
}

static enum err timed_press(struct far_end *e, const char *keys, struct times *t,
                            struct fault *fault)
{
    struct far_result result;
    const enum err err = far_end_press(e, keys, frame, &result, fault);
    t->shown_ms[t->keys] = times_between(result.pressed_ns, result.came_ns[0]);
    t->last_ms[t->keys] = times_between(result.pressed_ns, result.last_ns);
    t->bytes[t->keys++] = (double)result.bytes;
    return err;
}

static struct bench_key medians(struct times *t)
{
    return (struct bench_key){t->keys, times_median(t->shown_ms, t->keys),
                              times_median(t->last_ms, t->keys), times_median(t->bytes, t->keys)};
}

static enum err enter_pilot(struct far_end *e, struct fault *fault)
{
    enum err err = press(e, "", prompt, fault);
    if (!err)
        err = press(e, "auto on\r", prompt, fault);
    if (!err)
        err = press(e, "pilot\r", frame, fault);
    return err ? err : press(e, "5l", frame, fault);
}

/* Each seed at another place, and taken back. */
static enum err press_all(struct far_end *e, unsigned keys, struct bench_key out[BENCH_KEYS],
                          struct fault *fault)
{
    static const char *const ways[] = {"7l", "6k", "9h", "5K", "8j", "7J", "4h", "9k"};
    struct times moves = {.keys = 0}, seeds = {.keys = 0};
    enum err err = enter_pilot(e, fault);
    for (unsigned i = 0; !err && i < keys; i++)
        err = timed_press(e, i % 8 < 4 ? "l" : "k", &moves, fault);
    for (unsigned i = 0; !err && i < keys / 2; i++) {
        err = press(e, ways[i % 8], frame, fault);
        if (!err)
            err = timed_press(e, i % 2 ? "s2" : "s3", &seeds, fault);
        if (!err)
            err = press(e, "u", frame, fault);
    }
    out[BENCH_MOVE] = medians(&moves);
    out[BENCH_SEED] = medians(&seeds);
    return err;
}

/* A copy of the journal in a folder of its own, which becomes the program's home. */
static enum err copy_journal(struct buf *folder, struct buf *path, const char *journal,
                             struct fault *fault)
{
    struct buf bytes = {0};
    enum err err = folder_fresh(folder, NULL, fault);
    if (!err)
        err = file_read(&bytes, journal, JOURNAL_MOST, fault);
    buf_printf(path, "%s/%s", buf_text(folder), file_name(journal));
    if (!err && path->failed)
        err = fault_memory(fault, "a path");
    if (!err)
        err = file_write(buf_text(path), bytes.data, bytes.length, FILE_KEEP, fault);
    buf_release(&bytes);
    return err;
}

enum err bench_pilot(const char *journal, const struct graphics *graphics,
                     const struct bench_line *line, unsigned keys, struct bench_key out[BENCH_KEYS],
                     struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    struct far_end *e = NULL;
    enum err err = copy_journal(&folder, &path, journal, fault);
    char *const argument[] = {"iftty", path.data, NULL};
    if (!err)
        err = far_end_new(&e, argument, buf_text(&folder), graphics, line, fault);
    if (!err)
        err = press_all(e, keys < KEYS_MOST ? keys : KEYS_MOST, out, fault);
    far_end_free(e);
    if (folder.length)
        folder_discard(buf_text(&folder));
    buf_release(&folder);
    buf_release(&path);
    return err;
}
