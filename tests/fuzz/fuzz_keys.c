/* SPDX-License-Identifier: MIT */
/* What a terminal sends, keys and answers, in reads of any size: what comes out as text is UTF-8,
 * every answer is recognised as one, and where the reads were cut changes nothing. The first byte
 * says how long they are. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "tui/cells.h"
#include "tui/picture/graphics.h"

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
    /* whatever came, it swallows neither Enter nor what follows */
    keys_feed(&k, '\r', &event);
    HOLDS(keys_feed(&k, 'x', &event) && event.key == KEY_CHARACTER && event.point == 'x');
}

static void take(struct probe_replies *replies, struct buf *typed, const uint8_t *bytes,
                 size_t length, size_t read)
{
    struct keys keys = {0};
    for (size_t at = 0; at < length; at += read)
        probe_take(replies, &keys, (const char *)bytes + at,
                   length - at < read ? length - at : read, typed);
    HOLDS(typed->length <= length);
    HOLDS(memchr(replies->name, '\0', sizeof replies->name));
}

/* No answer is left in what is typed. */
static void check_typed(const struct buf *typed)
{
    struct keys k = {0};
    struct key_event event;
    for (size_t i = 0; i < typed->length; i++)
        if (keys_feed(&k, (uint8_t)typed->data[i], &event))
            HOLDS(event.key != KEY_REPLY);
}

static void check_facts(const struct probe_replies *replies)
{
    static const char *const terms[] = {"xterm", "xterm-kitty", "screen", "tmux-256color", "linux"};
    const struct term_size size = {.columns = 80, .rows = 24};
    for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++) {
        const struct probe_environment e = {.term = terms[i]};
        struct terminal_facts facts;
        struct buf asked = {0};
        graphics_decide(replies, &e, &size, graphics_auto, &facts);
        probe_questions(1, replies, &e, graphics_asks(graphics_auto, &e), &asked);
        HOLDS(facts.graphics && facts.cell_width >= 4 && facts.cell_width <= 64);
        HOLDS(facts.cell_height >= 4 && facts.cell_height <= 64 && facts.image_side_most > 0);
        HOLDS(facts.graphics != &graphics_sixel || replies->attributes >> 4 & 1);
        HOLDS((facts.graphics != &graphics_kitty && facts.graphics != &graphics_tiles) ||
              strstr(replies->answers, "_G"));
        buf_release(&asked);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct probe_replies replies = {0}, same = {0};
    struct buf typed = {0}, once = {0}, events = {0};
    if (length == 0)
        return 0;
    const size_t read = 1 + bytes[0] % READS;
    decode(bytes + 1, length - 1, &events);
    decode(bytes + 1, length - 1, NULL);
    take(&replies, &typed, bytes + 1, length - 1, read);
    take(&same, &once, bytes + 1, length - 1, length);
    HOLDS(memcmp(&replies, &same, sizeof same) == 0);
    HOLDS(typed.length == once.length && !memcmp(buf_text(&typed), buf_text(&once), typed.length));
    check_typed(&typed);
    check_facts(&replies);
    buf_release(&typed);
    buf_release(&once);
    buf_release(&events);
    return 0;
}
