#include "verify/divergence.h"

#include <inttypes.h>
#include <string.h>

#include "base/scan.h"
#include "journal/record.h"

enum likeness { ABSENT, SAME, OTHER }; /* ABSENT: one of the two does not have the word */

static enum likeness compare(const char *expected, const char *actual, const char *key)
{
    struct record_word e, a;
    if (!record_word_find(expected, key, strlen(key), &e))
        return ABSENT;
    const bool is_same = record_word_is_among(actual, &e, &a);
    return is_same ? SAME : a.value ? OTHER : ABSENT;
}

/* What the difference is; what a command read comes before what it made of it. */
static const char *meaning(const char *expected, const char *actual)
{
    const enum likeness labels = compare(expected, actual, "labels"),
                        forest = compare(expected, actual, "forest");
    if (compare(expected, actual, "scene") == OTHER)
        return "the scene is another one: other voxels were read";
    if (compare(expected, actual, "file") == OTHER)
        return "a file that the command read holds something else";
    if (compare(expected, actual, "weights") == OTHER)
        return "the arc weights differ, and what grows by them may";
    if (labels == OTHER)
        return "labels differ: voxels belong to other objects";
    if (labels == SAME && forest == OTHER)
        return "only keys differ: every voxel has the same label, by another cost, hops or root";
    if (compare(expected, actual, "picture") == OTHER || compare(expected, actual, "spin") == OTHER)
        return forest == SAME ? "only the picture differs: the forest and its labels are the same"
                              : "the picture differs; the command says nothing of the forest";
    return NULL;
}

static void add_line(struct buf *lines, const char *what)
{
    buf_printf(lines, "#   %-9s", what);
}

/* How far apart counts are, decimal numbers of up to 12 digits. Digests are longer. */
static void add_difference(struct buf *lines, const struct record_word *e,
                           const struct record_word *a)
{
    const char *expected = e->value, *actual = a->value;
    int64_t before, now;
    if (e->value_length > 12 || a->value_length > 12 ||
        !scan_integer(&expected, 0, INT64_MAX, &before) || expected != e->value + e->value_length ||
        !scan_integer(&actual, 0, INT64_MAX, &now) || actual != a->value + a->value_length)
        return;
    buf_printf(lines, " (%" PRId64 " %s)", now > before ? now - before : before - now,
               now > before ? "more" : "less");
}

static void write_word(struct buf *lines, const struct record_word *e, const struct record_word *a,
                       enum divergence_of of)
{
    const bool is_replay = of == DIVERGENCE_OF_REPLAY;
    add_line(lines, "word");
    buf_add_safe(lines, e->key, e->key_length);
    buf_add_text(lines, ": ");
    buf_add_safe(lines, e->value, e->value_length);
    buf_add_text(lines, is_replay ? " was recorded, " : " in the first, ");
    if (a->value)
        buf_add_safe(lines, a->value, a->value_length);
    else
        buf_add_text(lines, "nothing");
    buf_add_text(lines, is_replay ? " now" : " in the second");
    if (a->value)
        add_difference(lines, e, a);
    buf_add_char(lines, '\n');
}

void divergence_describe(struct buf *lines, const char *expected, const char *actual,
                         enum divergence_of of)
{
    const char *words = meaning(expected, actual);
    const char *at = expected, *end = expected + strlen(expected);
    struct record_word e, a;
    struct buf same = {0};
    if (words) {
        add_line(lines, "meaning");
        buf_printf(lines, "%s\n", words);
    }
    while (record_word_next(&at, end, &e)) {
        if (!record_word_is_among(actual, &e, &a)) {
            write_word(lines, &e, &a, of);
            continue;
        }
        buf_add_text(&same, same.length ? ", " : "");
        buf_add_safe(&same, e.key, e.key_length);
    }
    if (same.length) {
        add_line(lines, "the same");
        buf_printf(lines, "%s\n", buf_text(&same));
    }
    lines->failed = lines->failed || same.failed;
    buf_release(&same);
}
