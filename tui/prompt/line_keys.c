/* SPDX-License-Identifier: MIT */
#include "tui/prompt/line_edit.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *keys;
    unsigned action; /* enum line_action or enum line_editor_act */
    const char *words;
} table[] = {
    {"Ctrl-B, Left", LINE_LEFT, "move a character to the left"},
    {"Ctrl-F, Right", LINE_RIGHT, "move right; at the end: accept the suggestion"},
    {"Alt-B, Ctrl-Left, Alt-Left", LINE_WORD_LEFT, "move a word to the left"},
    {"Alt-F, Ctrl-Right, Alt-Right", LINE_WORD_RIGHT, "move a word right; at the end: accept one"},
    {"Ctrl-A, Home", LINE_HOME, "move to the start of the line"},
    {"Ctrl-E, End", LINE_END, "move to its end; there: accept the suggestion"},
    {NULL, DUTY_NONE, NULL},
    {"Tab", DUTY_COMPLETE, "complete a word; again: list all candidates"},
    {"Ctrl-P, Up", LINE_OLDER, "show older lines that begin like this one"},
    {"Ctrl-N, Down", LINE_NEWER, "show newer lines, then your unfinished line"},
    {"Alt-<, PageUp", LINE_OLDEST, "show the oldest line"},
    {"Alt->, PageDown", LINE_NEWEST, "return to your unfinished line"},
    {"Ctrl-R", DUTY_SEARCH, "search older lines for the typed text"},
    {"Alt-.", LINE_LAST_WORD, "insert the last word of an older line"},
    {NULL, DUTY_NONE, NULL},
    {"Backspace", LINE_ERASE, "delete the character before the cursor"},
    {"Delete", LINE_DELETE, "delete the character at the cursor"},
    {"Ctrl-D", DUTY_DELETE_OR_END, "delete it; on an empty line, quit"},
    {"Ctrl-K", LINE_KILL_TO_END, "cut to the end of the line"},
    {"Ctrl-U", LINE_KILL_TO_START, "cut to the start of the line"},
    {"Ctrl-W", LINE_KILL_BLANK_LEFT, "cut to the blank before the cursor"},
    {"Alt-Backspace, Ctrl-Backspace", LINE_KILL_WORD_LEFT, "cut a word to the left"},
    {"Alt-D, Ctrl-Delete, Alt-Delete", LINE_KILL_WORD_RIGHT, "cut a word to the right"},
    {"Ctrl-Y", LINE_YANK, "insert the text that was cut last"},
    {"Ctrl-T", LINE_TRANSPOSE, "exchange two characters"},
    {"Alt-U", LINE_UPPER, "change a word to upper case"},
    {"Alt-L", LINE_LOWER, "change a word to lower case"},
    {"Alt-C", LINE_CAPITAL, "capitalize a word"},
    {"Ctrl-_", LINE_UNDO, "undo the last change of the line"},
    {NULL, DUTY_NONE, NULL},
    {"Enter", DUTY_SUBMIT, "run the line"},
    {"Ctrl-C", DUTY_ABANDON, "empty the line; cancel a running command"},
    {"Ctrl-X Ctrl-E", DUTY_OTHER_EDITOR, "edit the line in $VISUAL or $EDITOR"},
    {"Ctrl-L", DUTY_CLEAR, "clear the screen"},
    {"Ctrl-O", DUTY_HOST_LINE, "open the pilot"},
    {"Ctrl-Z", DUTY_STOP, "suspend iftty; `fg` resumes it"},
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

/* Return true if one of the keys of a row is `name`; set *is_part if one begins with it and a
 * blank. */
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
