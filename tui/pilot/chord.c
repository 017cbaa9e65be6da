/* SPDX-License-Identifier: MIT */
#include "tui/pilot/pilot_keys.h"

#include <string.h>

#include "tui/cells.h"

static const char *const named[] = {[KEY_PENDING] = "any",
                                    [KEY_CHARACTER] = "Space",
                                    [KEY_ENTER] = "Enter",
                                    [KEY_TAB] = "Tab",
                                    [KEY_BACKSPACE] = "Backspace",
                                    [KEY_ESCAPE] = "Escape",
                                    [KEY_UP] = "Up",
                                    [KEY_DOWN] = "Down",
                                    [KEY_RIGHT] = "Right",
                                    [KEY_LEFT] = "Left",
                                    [KEY_HOME] = "Home",
                                    [KEY_END] = "End",
                                    [KEY_INSERT] = "Insert",
                                    [KEY_DELETE] = "Delete",
                                    [KEY_PAGE_UP] = "Page-up",
                                    [KEY_PAGE_DOWN] = "Page-down"};

static const struct {
    const char *name;
    unsigned modifier;
} modifiers[] = {{"Ctrl-", KEY_CONTROL}, {"Shift-", KEY_SHIFT}, {"Alt-", KEY_ALT}};

/* Remove "Ctrl-" and other modifiers from a word. */
static unsigned take_modifiers(const char **word, size_t *length)
{
    unsigned taken = 0;
    for (size_t i = 0; i < sizeof modifiers / sizeof modifiers[0]; i++) {
        const size_t n = strlen(modifiers[i].name);
        if (*length <= n || memcmp(*word, modifiers[i].name, n) != 0)
            continue;
        taken |= modifiers[i].modifier;
        *word += n;
        *length -= n;
    }
    return taken;
}

/* Read a character, or a range of characters: "x", "0-9". Control characters are not accepted. */
static bool read_characters(const char *word, size_t length, struct chord *chord)
{
    chord->key = KEY_CHARACTER;
    if (length == 3 && word[1] == '-' && *word > ' ' && *word < word[2]) {
        chord->first = (uint8_t)word[0];
        chord->last = (uint8_t)word[2];
        return chord->last < 0x7F;
    }
    const bool is_one = length > 0 && char_read(word, length, &chord->first) == length;
    chord->last = chord->first;
    return is_one && chord->first != CHAR_BROKEN && chord->first > ' ' && chord->first != 0x7F;
}

static bool read_key(const char *word, size_t length, struct chord *chord)
{
    *chord = (struct chord){.modifiers = take_modifiers(&word, &length)};
    for (enum key key = KEY_PENDING; key < sizeof named / sizeof named[0]; key++)
        if (named[key] && strlen(named[key]) == length && memcmp(word, named[key], length) == 0) {
            chord->key = key;
            chord->first = chord->last = key == KEY_CHARACTER ? ' ' : 0;
            return true;
        }
    if (!read_characters(word, length, chord) || chord->modifiers & KEY_SHIFT)
        return false;
    if (chord->modifiers & KEY_CONTROL) /* in lower case, as in keys.h */
        chord->last = chord->first |= 32;
    return true;
}

/* A key, or a character after another. */
static bool read_chord(const char *word, size_t length, struct chord *chord)
{
    uint32_t leader;
    if (read_key(word, length, chord))
        return true;
    const size_t n = char_read(word, length, &leader);
    *chord = (struct chord){.leader = leader};
    return n < length && leader != CHAR_BROKEN && leader > ' ' &&
           read_characters(word + n, length - n, chord);
}

bool chord_next(const char **at, struct chord *chord)
{
    const char *word = *at + strspn(*at, " ");
    const size_t length = strcspn(word, " ");
    *at = word + length;
    if (length > 0 && !read_chord(word, length, chord))
        *chord = (struct chord){.key = KEY_OTHER};
    chord->word = word;
    chord->length = length;
    return length > 0;
}

bool chord_fits(const struct chord *chord, uint32_t leader, const struct key_event *event)
{
    unsigned pressed = event->modifiers & (KEY_SHIFT | KEY_CONTROL | KEY_ALT);
    if (chord->key == KEY_PENDING)
        return leader == 0;
    if (chord->leader != leader || chord->key != event->key)
        return false;
    if (event->key == KEY_ENTER || event->key == KEY_ESCAPE)
        return true;
    if (event->key == KEY_CHARACTER)
        return (pressed & ~(unsigned)KEY_SHIFT) == chord->modifiers &&
               event->point >= chord->first && event->point <= chord->last;
    if (pressed & KEY_SHIFT)
        pressed = KEY_SHIFT;
    return pressed == chord->modifiers;
}

/* Return true if one is the first key of the other. */
static bool is_first_key_of(const struct chord *one, const struct chord *other)
{
    return !one->leader && other->leader && one->key == KEY_CHARACTER && !one->modifiers &&
           other->leader >= one->first && other->leader <= one->last;
}

bool chord_clashes(const struct chord *a, const struct chord *b)
{
    if (is_first_key_of(a, b) || is_first_key_of(b, a))
        return true;
    return a->leader == b->leader && a->key == b->key && a->modifiers == b->modifiers &&
           a->first <= b->last && b->first <= a->last;
}
