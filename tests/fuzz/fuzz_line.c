/* SPDX-License-Identifier: MIT */
/* Keys at the prompt, any bytes at all: the line keeps its promises (line.h), all that was done is
 * undone, and the screen shows what one drawn afresh would. The first two bytes are the size of the
 * screen. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "tests/screen.h"
#include "tui/prompt/line_draw.h"
#include "tui/prompt/line_keys.h"

static struct screen screen, fresh;
static struct line_history history;

static void prepare(void)
{
    static const char *const entry[] = {"seed 1,2,3 \"left hemi\"", "sed \xff\xfe", "se\xcc\x81",
                                        "label 2 \xe6\x9c\xac", "# \xf0\x9f\xa7\xa0 note"};
    for (size_t i = 0; i < sizeof entry / sizeof *entry && history.count < 5; i++)
        line_history_add(&history, entry[i], strlen(entry[i]));
}

static bool knows(void *context, const char *text)
{
    (void)context;
    return text[0] != '#';
}

/* ---- the line ---- */

static void search(struct line *l, const struct key_event *event)
{
    if (event->key == KEY_CHARACTER && event->modifiers == 0)
        line_search_add(l, event->text, event->length);
    else if (event->key == KEY_BACKSPACE)
        line_search_erase(l);
    else if (event->key == KEY_CHARACTER && event->point == 'r')
        line_search_older(l);
    else if (event->key == KEY_UP)
        line_search_newer(l);
    else
        line_search_end(l, event->key != KEY_ESCAPE);
}

static void press(struct line *l, char before[LINE_KEYS_MOST], const struct key_event *event)
{
    const bool held = event->modifiers & (KEY_CONTROL | KEY_ALT);
    if (l->searching) {
        search(l, event);
        return;
    }
    if (event->key == KEY_CHARACTER && !held && !*before) {
        line_insert(l, event->text, event->length);
        return;
    }
    const unsigned found = line_key_find(event, before);
    HOLDS(found <= DUTY_MORE && (*before != '\0') == (found == DUTY_MORE));
    if (found == DUTY_SEARCH)
        line_search_begin(l);
    else if (found < LINE_ACTIONS &&
             !line_take_suggestion(l, line_suggestion(l, knows, NULL), (enum line_action)found))
        line_act(l, (enum line_action)found);
}

/* No control characters, whatever came; the cursor is in the text. */
static void check_line(const struct line *l)
{
    const char *text = buf_text(&l->text);
    HOLDS(l->cursor <= l->text.length && strlen(text) == l->text.length);
    for (size_t i = 0; i < l->text.length; i++)
        HOLDS((unsigned char)text[i] >= ' ' && text[i] != 127);
    HOLDS(l->undo.count <= LINE_UNDO_MOST && l->undo.removed.length <= LINE_UNDO_BYTES);
}

static void draw(struct screen *s, struct line_drawing *drawing, const struct line *l)
{
    struct buf out = {0};
    const struct line_content content = {.prompt = "s> ",
                                         .text = buf_text(&l->text),
                                         .length = l->text.length,
                                         .cursor = l->cursor,
                                         .hint = line_suggestion(l, knows, NULL),
                                         .grey = "\033[90m"};
    line_draw(drawing, &content, s->columns, s->rows, &out);
    screen_write(s, buf_text(&out), out.length);
    buf_release(&out);
}

static void check_screen(const struct line_drawing *drawing, const struct line *l)
{
    struct line_drawing none = {0};
    HOLDS(drawing->row <= screen.row);
    const unsigned first = screen.row - drawing->row;
    memset(&fresh, 0, sizeof fresh);
    screen_resize(&fresh, screen.columns, screen.rows);
    fresh.row = first;
    draw(&fresh, &none, l);
    HOLDS(fresh.row == screen.row && fresh.column == screen.column);
    for (unsigned y = first; y < screen.rows; y++)
        HOLDS(strcmp(screen_row(&fresh, y), screen_row(&screen, y)) == 0);
}

static void edit(const uint8_t *bytes, size_t length)
{
    struct line l;
    struct line_drawing drawing = {0};
    struct keys keys = {0};
    struct key_event event;
    char before[LINE_KEYS_MOST] = "";
    line_init(&l, &history);
    for (size_t i = 0; i < length; i++) {
        if (!keys_feed(&keys, bytes[i], &event))
            continue;
        press(&l, before, &event);
        check_line(&l);
        if (i % 8 == 0)
            draw(&screen, &drawing, &l);
    }
    draw(&screen, &drawing, &l);
    check_screen(&drawing, &l);
    const bool whole = l.undo.count < LINE_UNDO_MOST;
    while (l.undo.count > 0) {
        line_act(&l, LINE_UNDO);
        check_line(&l);
    }
    HOLDS(l.text.length == 0 || !whole);
    line_release(&l);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    if (length < 2)
        return 0;
    prepare();
    memset(&screen, 0, sizeof screen);
    screen_resize(&screen, 8 + bytes[0] % 60, 2 + bytes[1] % 24);
    edit(bytes + 2, length - 2);
    return 0;
}
