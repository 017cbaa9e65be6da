/* SPDX-License-Identifier: MIT */
#include "tui/prompt/line_edit.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *keys;
    unsigned action; /* or duty */
    const char *words;
} table[] = {
    {"Ctrl-B, Left", LINE_LEFT, "a character to the left"},
    {"Ctrl-F, Right", LINE_RIGHT, "to the right; at the end: the suggestion"},
    {"Alt-B, Ctrl-Left, Alt-Left", LINE_WORD_LEFT, "a word to the left"},
    {"Alt-F, Ctrl-Right, Alt-Right", LINE_WORD_RIGHT, "to the right; at the end: a suggested word"},
    {"Ctrl-A, Home", LINE_HOME, "the start of the line"},
    {"Ctrl-E, End", LINE_END, "its end; there: the suggestion"},
    {NULL, DUTY_NONE, NULL},
    {"Tab", DUTY_COMPLETE, "completes a word; again: lists all that fit"},
    {"Ctrl-P, Up", LINE_OLDER, "older lines that begin like this one"},
    {"Ctrl-N, Down", LINE_NEWER, "newer ones, down to the line that was begun"},
    {"Alt-<, PageUp", LINE_OLDEST, "the oldest line"},
    {"Alt->, PageDown", LINE_NEWEST, "the line that was begun"},
    {"Ctrl-R", DUTY_SEARCH, "lists older lines that hold what is typed"},
    {"Alt-.", LINE_CITE, "the last word of the line before; again: older"},
    {NULL, DUTY_NONE, NULL},
    {"Backspace", LINE_ERASE, "removes the character before the cursor"},
    {"Delete", LINE_DELETE, "removes the character at the cursor"},
    {"Ctrl-D", DUTY_DELETE_OR_END, "the same; on an empty line, the end"},
    {"Ctrl-K", LINE_KILL_TO_END, "kills up to the end of the line"},
    {"Ctrl-U", LINE_KILL_TO_START, "kills back to the start"},
    {"Ctrl-W", LINE_KILL_BLANK_LEFT, "kills back to a blank"},
    {"Alt-Backspace, Ctrl-Backspace", LINE_KILL_WORD_LEFT, "kills a word to the left"},
    {"Alt-D, Ctrl-Delete, Alt-Delete", LINE_KILL_WORD_RIGHT, "kills a word to the right"},
    {"Ctrl-Y", LINE_YANK, "inserts what was killed last"},
    {"Ctrl-T", LINE_TRANSPOSE, "exchanges two characters"},
    {"Alt-U", LINE_UPPER, "a word in upper case"},
    {"Alt-L", LINE_LOWER, "a word in lower case"},
    {"Alt-C", LINE_CAPITAL, "a word with a capital"},
    {"Ctrl-_", LINE_UNDO, "undoes the last change of the line"},
    {NULL, DUTY_NONE, NULL},
    {"Enter", DUTY_SUBMIT, "carries the line out"},
    {"Ctrl-C", DUTY_ABANDON, "empties the line; cancels a command that runs"},
    {"Ctrl-X Ctrl-E", DUTY_OTHER_EDITOR, "edits the line in $VISUAL or $EDITOR"},
    {"Ctrl-L", DUTY_CLEAR, "clears the screen"},
    {"Ctrl-O", DUTY_HOST_LINE, "the pilot"},
    {"Ctrl-Z", DUTY_STOP, "stops as a job; `fg` goes on"},
};

enum { ROWS = sizeof table / sizeof table[0] };

/* ---- finding a key ---- */

static void name_key(const struct key_event *event, unsigned modifiers, char *out, size_t room)
{
    static const char *const named[] = {
        [KEY_ENTER] = "Enter",   [KEY_TAB] = "Tab",        [KEY_BACKSPACE] = "Backspace",
        [KEY_UP] = "Up",         [KEY_DOWN] = "Down",      [KEY_RIGHT] = "Right",
        [KEY_LEFT] = "Left",     [KEY_HOME] = "Home",      [KEY_END] = "End",
        [KEY_DELETE] = "Delete", [KEY_PAGE_UP] = "PageUp", [KEY_PAGE_DOWN] = "PageDown",
    };
    const bool is_letter = event->point >= 'a' && event->point <= 'z';
    const char letter[2] = {(char)(event->point - 32), '\0'};
    const char *name = event->key < sizeof named / sizeof named[0] ? named[event->key] : NULL;
    if (event->key == KEY_CHARACTER)
        name = is_letter ? letter : event->text;
    snprintf(out, room, "%s%s%s%s", modifiers & KEY_CONTROL ? "Ctrl-" : "",
             modifiers & KEY_ALT ? "Alt-" : "", modifiers & KEY_SHIFT ? "Shift-" : "",
             name ? name : "");
}

/* Whether one of the keys of a row is `name`, or begins with it and a blank. */
static bool has_key(const char *keys, const char *name, bool *is_part)
{
    const size_t length = strlen(name);
    for (const char *at = keys; at; at = strstr(at, ", "), at = at ? at + 2 : NULL) {
        if (strncmp(at, name, length) != 0)
            continue;
        if (at[length] == '\0' || strncmp(at + length, ", ", 2) == 0)
            return true;
        *is_part |= at[length] == ' ';
    }
    return false;
}

unsigned line_key_find(const struct key_event *event, char before[LINE_KEYS_MOST])
{
    const unsigned all = event->modifiers;
    const unsigned tried[] = {all, all & KEY_CONTROL, all & KEY_ALT, 0};
    const unsigned tries = event->key == KEY_CHARACTER ? 3 : 4;
    unsigned found = DUTY_NONE;
    char keys[LINE_KEYS_MOST] = "";
    for (unsigned i = 0; i < tries && found == DUTY_NONE; i++) {
        char name[LINE_KEYS_MOST / 2];
        name_key(event, tried[i], name, sizeof name);
        snprintf(keys, sizeof keys, "%.18s%s%s", before, *before ? " " : "", name);
        const bool is_plain = event->key == KEY_CHARACTER && tried[i] == 0;
        bool is_part = false;
        unsigned row = 0;
        while (row < ROWS && !(table[row].keys && has_key(table[row].keys, keys, &is_part)))
            row++;
        if (!is_plain && *keys)
            found = row < ROWS ? table[row].action : is_part ? DUTY_MORE : DUTY_NONE;
    }
    snprintf(before, LINE_KEYS_MOST, "%s", found == DUTY_MORE ? keys : "");
    return found;
}

/* ---- the page ---- */

void line_keys_page(struct buf *out)
{
    for (unsigned i = 0; i < ROWS; i++)
        if (table[i].keys)
            buf_printf(out, "  %-30s  %s\n", table[i].keys, table[i].words);
        else
            buf_add_char(out, '\n');
}
