#include "tui/pilot/setup.h"

#include <stdio.h>
#include <string.h>

#include "tui/pilot/chord.h"
#include "tui/pilot/pilot_press.h"

const struct pilot_setup pilot_setup_default = {.theme = &theme_dark,
                                                .brush = {.label = 1, .radius = 3},
                                                .window = {{"bone", 500000, 2000000},
                                                           {"brain", 40000, 80000},
                                                           {"lung", -600000, 1500000},
                                                           {"soft", 50000, 400000}},
                                                .windows = 4};

/* ---- windows ---- */

enum err setup_window(struct pilot_setup *setup, const char *name, int64_t centre, int64_t width,
                      struct fault *fault)
{
    struct setup_window *window = setup->window;
    if (strlen(name) >= SETUP_NAME_BYTES)
        return fault_set(fault, ERR_USAGE, "expected a name of at most %d bytes, not %s",
                         SETUP_NAME_BYTES - 1, name);
    while (window < setup->window + setup->windows && strcmp(window->name, name) != 0)
        window++;
    if (window == setup->window + SETUP_WINDOWS_MOST)
        return fault_set(fault, ERR_LIMIT, "there are %d windows already, the most",
                         SETUP_WINDOWS_MOST);
    if (window == setup->window + setup->windows)
        setup->windows++;
    *window = (struct setup_window){.centre = centre, .width = width};
    snprintf(window->name, sizeof window->name, "%s", name);
    return OK;
}

/* ---- keys ---- */

size_t setup_row(const char *name)
{
    for (size_t i = 0; i < pilot_rows; i++)
        if (pilot_table[i].name && strcmp(pilot_table[i].name, name) == 0)
            return i;
    return SIZE_MAX;
}

const char *setup_own(const struct pilot_setup *setup, const struct pilot_row *row)
{
    const char *own = setup->keys[row - pilot_table];
    return *own ? own : NULL;
}

/* The row, other than this one, that the user has given the key, or one that clashes with it. */
static const struct pilot_row *taken_by(const struct pilot_setup *setup,
                                        const struct pilot_row *row, const struct chord *chord)
{
    struct chord other;
    const char *word;
    size_t length;
    for (const struct pilot_row *r = pilot_table; r < pilot_table + pilot_rows; r++) {
        const char *words = setup_own(setup, r);
        if (r == row || !(r->in & row->in))
            continue;
        while (words && chord_next(&words, &word, &length))
            if (chord_read(word, length, &other) && chord_clashes(&other, chord))
                return r;
    }
    return NULL;
}

enum err setup_keys(struct pilot_setup *setup, size_t row, const char *words, struct fault *fault)
{
    const char *at = words, *word;
    struct chord chord;
    size_t length;
    if (strlen(words) >= SETUP_KEYS_BYTES)
        return fault_set(fault, ERR_LIMIT, "expected keys of at most %d bytes in all",
                         SETUP_KEYS_BYTES - 1);
    while (chord_next(&at, &word, &length)) {
        if (!chord_read(word, length, &chord) || chord.key == KEY_PENDING)
            return fault_set(fault, ERR_USAGE, "there is no key %.*s", (int)length, word);
        if (chord.first != chord.last && !chord.leader)
            return fault_set(fault, ERR_USAGE, "%.*s: expected one key", (int)length, word);
        const struct pilot_row *by = taken_by(setup, pilot_table + row, &chord);
        if (by)
            return fault_set(fault, ERR_USAGE, "%.*s was given to %s", (int)length, word, by->name);
    }
    snprintf(setup->keys[row], SETUP_KEYS_BYTES, "%s", words);
    return OK;
}

void setup_add_keys(struct buf *out, const struct pilot_setup *setup, const struct pilot_row *row,
                    size_t most)
{
    const char *own = row->name ? setup_own(setup, row) : NULL, *words = own ? own : row->keys;
    const char *word, *gap = "";
    struct chord chord;
    size_t length;
    while (most > 0 && chord_next(&words, &word, &length)) {
        if (row->name && !own && chord_read(word, length, &chord) && taken_by(setup, row, &chord))
            continue;
        buf_printf(out, "%s%.*s", gap, (int)length, word);
        gap = " ";
        most--;
    }
}

void setup_add_first_key(struct buf *out, const struct pilot_setup *setup, const char *name)
{
    setup_add_keys(out, setup, pilot_table + setup_row(name), 1);
}

void setup_add_key_to(struct buf *out, const struct pilot_setup *setup, const char *name, char c)
{
    struct buf key = {0};
    setup_add_first_key(&key, setup, name);
    const char *range = key.length > 3 ? buf_text(&key) + key.length - 3 : "";
    if (strcmp(range, "a-z") == 0 || strcmp(range, "0-9") == 0)
        buf_printf(out, "%.*s%c", (int)key.length - 3, buf_text(&key), c);
    else
        buf_add_text(out, buf_text(&key));
    out->failed |= key.failed;
    buf_release(&key);
}

bool setup_is_plain(const struct pilot_setup *setup, const struct pilot_row *row)
{
    struct buf keys = {0};
    setup_add_keys(&keys, setup, row, SIZE_MAX);
    const bool is_plain = strcmp(buf_text(&keys), row->keys) == 0;
    buf_release(&keys);
    return is_plain;
}
