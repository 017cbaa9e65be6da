/* SPDX-License-Identifier: MIT */
/* Input from a terminal: keys, answers, and a line at the prompt. */
#include "tests/fuzz/fuzz.h"

#include "tests/screen.h"
#include "tui/picture/graphics.h"
#include "tui/prompt/line_edit.h"

/* What a terminal sends, keys and answers, in reads of any size: what comes out as text is UTF-8,
 * every answer is recognised as one, and where the reads were cut changes nothing. The first byte
 * says how long they are. */

enum { READS = 16 };

static void check_event(const struct keys *k, const struct key_event *event)
{
    uint32_t point;
    HOLDS(event->key > KEY_PENDING && event->key <= KEY_OTHER);
    HOLDS(event->modifiers <= (KEY_SHIFT | KEY_ALT | KEY_CONTROL));
    HOLDS(k->state == KEYS_GROUND && !k->alt);
    if (event->key == KEY_CHARACTER) {
        HOLDS(event->length >= 1 && event->length <= 4 && event->text[event->length] == '\0');
        HOLDS(char_read(event->text, event->length, &point) == event->length);
        HOLDS(point == event->point && point != CHAR_BROKEN);
        HOLDS((point >= 0x20 && point < 0x7F) || point >= 0xA0);
    } else if (event->key == KEY_REPLY) {
        HOLDS(strchr("[P]_^X", k->body[0]) && k->body[0]);
    } else if (event->key == KEY_MOUSE) {
        HOLDS(event->mouse.action <= MOUSE_WHEEL_DOWN && event->mouse.button <= MOUSE_NO_BUTTON);
        HOLDS(event->mouse.column < 100000 && event->mouse.row < 100000);
    }
}

/* What came out of the bytes, one event a line. Where `out` is NULL the time runs out after every
 * byte, so that each beginning of a sequence is a key. */
static void decode(const uint8_t *bytes, size_t length, struct buf *out)
{
    struct keys k = {.unit = length % (MOUSE_PIXELS_FROM_0 + 1)};
    struct key_event event;
    for (size_t i = 0; i < length; i++) {
        const bool complete = keys_feed(&k, bytes[i], &event);
        HOLDS(k.length < sizeof k.body && k.body[k.length] == '\0' && k.taken <= i + 1);
        if (complete)
            check_event(&k, &event);
        if (complete && out)
            buf_printf(out, "%d %u %s%s\n", (int)event.key, event.modifiers, event.text,
                       event.key == KEY_REPLY ? k.body : "");
        if (!complete && !out && keys_waiting(&k)) {
            HOLDS(keys_time_out(&k, &event));
            check_event(&k, &event);
        }
    }
    /* no input swallows Enter or later keys */
    keys_feed(&k, '\r', &event);
    HOLDS(keys_feed(&k, 'x', &event) && event.key == KEY_CHARACTER && event.point == 'x');
}

/* Answers to the questions of any round, of which each ends with the right one. */
static void take(struct probe *probe, struct buf *typed, const uint8_t *bytes, size_t length,
                 size_t read)
{
    struct keys keys = {0};
    OWNED(buf_release) struct buf asked = {0};
    for (size_t at = 0; at < length; at += read) {
        const size_t n = length - at < read ? length - at : read;
        for (size_t i = 0; i < n; i++)
            if (probe_take(probe, &keys, (const char *)bytes + at + i, 1, typed))
                probe_ask(probe, &asked);
    }
    HOLDS(typed->length <= length);
    HOLDS(memchr(probe->replies.name, '\0', sizeof probe->replies.name));
    HOLDS(memchr(probe->replies.outer.name, '\0', sizeof probe->replies.outer.name));
    HOLDS(probe->rounds <= 4);
}

static void check_facts(const struct probe_replies *replies)
{
    static const char *const terms[] = {"xterm", "xterm-kitty", "screen", "tmux-256color", "linux"};
    const struct term_size size = {.columns = 80, .rows = 24};
    for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++) {
        struct probe_replies in = *replies;
        in.environment = (struct probe_environment){.term = terms[i]};
        struct terminal_facts facts;
        graphics_decide(&in, &size, graphics_auto, &facts);
        HOLDS(facts.graphics && facts.cell_width >= 4 && facts.cell_width <= 64);
        HOLDS(facts.cell_height >= 4 && facts.cell_height <= 64 && facts.image_side_most > 0);
        HOLDS(facts.graphics != &graphics_sixel || replies->attributes >> 4 & 1);
        HOLDS((facts.graphics != &graphics_kitty && facts.graphics != &graphics_tiles &&
               facts.graphics != &graphics_placeholders) ||
              strstr(replies->answers, "_G"));
        HOLDS(!probe_is_tmux(&in) || facts.graphics->kind == GRAPHICS_TEXT || in.outer_reports);
    }
}

static struct probe fresh_probe(uint8_t kind)
{
    static const char *const terms[] = {"xterm", "xterm-kitty", "tmux-256color"};
    const struct probe_environment environment = {.term = terms[kind % 3]};
    struct probe probe = {.wish = graphics_asks(graphics_auto, &environment),
                          .replies.environment = environment};
    OWNED(buf_release) struct buf asked = {0};
    HOLDS(probe_ask(&probe, &asked));
    return probe;
}

void fuzz_keys(const uint8_t *bytes, size_t length)
{
    OWNED(buf_release) struct buf typed = {0}, once = {0}, events = {0};
    if (length == 0)
        return;
    const size_t read = 1 + bytes[0] % READS;
    decode(bytes + 1, length - 1, &events);
    decode(bytes + 1, length - 1, NULL);
    struct probe probe = fresh_probe(bytes[0]), same = fresh_probe(bytes[0]);
    take(&probe, &typed, bytes + 1, length - 1, read);
    take(&same, &once, bytes + 1, length - 1, length);
    HOLDS(memcmp(&probe.replies, &same.replies, sizeof same.replies) == 0);
    HOLDS(typed.length == once.length && !memcmp(buf_text(&typed), buf_text(&once), typed.length));
    /* No answer is left in the typed text. */
    struct keys k = {0};
    struct key_event event;
    for (size_t i = 0; i < typed.length; i++)
        if (keys_feed(&k, (uint8_t)typed.data[i], &event))
            HOLDS(event.key != KEY_REPLY);
    check_facts(&probe.replies);
}

/* Keys at the prompt, any bytes at all: the line keeps its promises (line.h), all that was done is
 * undone, and the screen shows what one drawn afresh would. The first two bytes are the size of the
 * screen. */

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

static void press(struct line *l, char before[LINE_KEYS_MOST], const struct key_event *event)
{
    const bool held = event->modifiers & (KEY_CONTROL | KEY_ALT);
    if (l->searching) {
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

/* No control characters after any input; the cursor is in the text. */
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
    OWNED(buf_release) struct buf out = {0};
    const struct line_content content = {.prompt = "s> ",
                                         .text = buf_text(&l->text),
                                         .length = l->text.length,
                                         .cursor = l->cursor,
                                         .hint = line_suggestion(l, knows, NULL),
                                         .grey = "\033[90m"};
    line_draw(drawing, &content, s->columns, s->rows, &out);
    screen_write(s, buf_text(&out), out.length);
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
    OWNED(line_release) struct line l = {.history = &history, .place = history.count};
    struct line_drawing drawing = {0};
    struct keys keys = {0};
    struct key_event event;
    char before[LINE_KEYS_MOST] = "";
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
}

void fuzz_line(const uint8_t *bytes, size_t length)
{
    if (length < 2)
        return;
    prepare();
    memset(&screen, 0, sizeof screen);
    screen_resize(&screen, 8 + bytes[0] % 60, 2 + bytes[1] % 24);
    edit(bytes + 2, length - 2);
}
