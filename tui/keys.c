/* SPDX-License-Identifier: MIT */
#include "tui/keys.h"

#include <string.h>

#include "tui/cells.h"

enum { ESC = 0x1B, BEL = 0x07, BACKSPACE = 0x08, DELETE = 0x7F };

static bool begin_sequence(struct keys *k, unsigned state)
{
    k->state = state;
    k->length = 0;
    k->body[0] = '\0';
    return false;
}

static void store(struct keys *k, uint8_t byte)
{
    if (k->length + 1 < sizeof k->body) {
        k->body[k->length++] = (char)byte;
        k->body[k->length] = '\0';
    }
}

/* Every event is reported by one of these two, which return to the ground state. */
static bool emit(struct keys *k, enum key key, unsigned modifiers, struct key_event *event)
{
    *event = (struct key_event){.key = key, .modifiers = modifiers | (k->alt ? KEY_ALT : 0)};
    k->state = KEYS_GROUND;
    k->alt = false;
    return true;
}

static bool emit_point(struct keys *k, uint32_t point, unsigned modifiers, struct key_event *event)
{
    emit(k, KEY_CHARACTER, modifiers, event);
    event->point = point;
    event->text[0] = (char)point;
    event->length = 1;
    return true;
}

/* ---- single bytes and characters ---- */

static bool feed_control(struct keys *k, uint8_t byte, struct key_event *event)
{
    switch (byte) {
    case '\r':
    case '\n':
        return emit(k, KEY_ENTER, 0, event);
    case '\t':
        return emit(k, KEY_TAB, 0, event);
    case BACKSPACE:
    case DELETE:
        return emit(k, KEY_BACKSPACE, 0, event);
    case 0:
        return emit_point(k, ' ', KEY_CONTROL, event);
    default:
        return emit_point(k, byte < 27 ? byte + 96u : byte + 64u, KEY_CONTROL, event);
    }
}

static bool feed_ground(struct keys *k, uint8_t byte, struct key_event *event)
{
    if (byte == ESC)
        return begin_sequence(k, KEYS_ESC);
    if (byte < 0x20 || byte == DELETE)
        return feed_control(k, byte, event);
    if (byte < 0x80)
        return emit_point(k, byte, 0, event);
    k->alt = k->alt && byte >= 0xC2;
    k->state = KEYS_GROUND;
    if (byte < 0xC2 || byte > 0xF4)
        return false; /* no character begins with this byte */
    begin_sequence(k, KEYS_UTF8);
    store(k, byte);
    k->needed = byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : 3;
    return false;
}

static bool feed_utf8(struct keys *k, uint8_t byte, struct key_event *event)
{
    uint32_t point;
    if ((byte & 0xC0) != 0x80) {
        k->alt = false;
        return feed_ground(k, byte, event); /* the bytes before it are dropped */
    }
    store(k, byte);
    if (--k->needed > 0)
        return false;
    char_read(k->body, k->length, &point);
    if (point == CHAR_BROKEN || point < 0xA0) { /* C1 controls are no text either */
        k->state = KEYS_GROUND;
        k->alt = false;
        return false;
    }
    emit(k, KEY_CHARACTER, 0, event);
    event->point = point;
    event->length = (unsigned)k->length;
    memcpy(event->text, k->body, k->length);
    return true;
}

/* ---- escape sequences ---- */

static bool feed_escape(struct keys *k, uint8_t byte, struct key_event *event)
{
    switch (byte) {
    case ESC:
        k->alt = true;
        return false;
    case '[':
        begin_sequence(k, KEYS_CSI);
        break;
    case 'O':
        begin_sequence(k, KEYS_SS3);
        break;
    case 'P':
    case ']':
    case '_':
    case '^':
    case 'X':
        begin_sequence(k, KEYS_STRING);
        break;
    case '\\': /* the end of a string whose beginning was lost, or Alt-\, which has no effect */
        return emit(k, KEY_OTHER, KEY_ALT, event);
    default:
        k->alt = true;
        return feed_ground(k, byte, event);
    }
    store(k, byte);
    return false;
}

static enum key letter_key(uint8_t final)
{
    static const char letters[] = "ABCDHF";
    static const enum key key[] = {KEY_UP, KEY_DOWN, KEY_RIGHT, KEY_LEFT, KEY_HOME, KEY_END};
    const char *place = memchr(letters, final, sizeof letters - 1);
    return place ? key[place - letters] : KEY_OTHER;
}

static enum key tilde_key(unsigned number)
{
    static const enum key key[] = {KEY_OTHER,   KEY_HOME,      KEY_INSERT, KEY_DELETE, KEY_END,
                                   KEY_PAGE_UP, KEY_PAGE_DOWN, KEY_HOME,   KEY_END};
    if (number == 200 || number == 201)
        return number == 200 ? KEY_PASTE_BEGIN : KEY_PASTE_END;
    return number < sizeof key / sizeof key[0] ? key[number] : KEY_OTHER;
}

/* Read the number at *text, and move past it and a semicolon. */
static unsigned parameter(const char **text)
{
    unsigned n = 0;
    for (; **text >= '0' && **text <= '9'; ++*text)
        n = n < 10000 ? n * 10 + (unsigned)(**text - '0') : n;
    if (**text == ';')
        ++*text;
    return n;
}

/* Read a coordinate of the mouse, from 1, and move past it; 0 if absent. Coordinates before
 * the window are at its edge. */
static unsigned place(const struct keys *k, const char **text)
{
    const bool is_before = k->unit != MOUSE_CELLS && **text == '-';
    *text += is_before;
    const bool is_number = **text >= '0' && **text <= '9';
    const unsigned n = parameter(text);
    if (k->unit == MOUSE_CELLS || !is_number)
        return n;
    return is_before || n == 0 ? 1 : n + (k->unit == MOUSE_PIXELS_FROM_0);
}

/* The button byte: two bits for the button, shift, alt and control, 32 for motion, 64 for the
 * wheel. Further buttons and a tilting wheel are ignored. */
static bool emit_mouse(struct keys *k, unsigned code, unsigned column, unsigned row, bool released,
                       struct key_event *event)
{
    const unsigned which = code & 3;
    const bool wheel = code & 64;
    if (code >= 128 || (wheel && which > 1) || column == 0 || row == 0)
        return emit(k, KEY_OTHER, 0, event);
    emit(k, KEY_MOUSE, code >> 2 & 7, event);
    event->mouse = (struct mouse){.action = wheel       ? MOUSE_WHEEL_UP + which
                                            : code & 32 ? MOUSE_MOVED
                                            : released  ? MOUSE_RELEASED
                                                        : MOUSE_PRESSED,
                                  .button = wheel ? MOUSE_NO_BUTTON : which,
                                  .column = column - 1,
                                  .row = row - 1};
    return true;
}

/* Three bytes, each 32 more than its value; a release does not name its button. */
static bool feed_csi_mouse(struct keys *k, uint8_t byte, struct key_event *event)
{
    store(k, byte);
    if (k->length < 5)
        return false;
    const unsigned code = (uint8_t)k->body[2] - 32u;
    const bool released = (code & (64 | 32 | 3)) == 3;
    return emit_mouse(k, code, (uint8_t)k->body[3] - 32u, (uint8_t)k->body[4] - 32u, released,
                      event);
}

static bool end_csi(struct keys *k, uint8_t final, struct key_event *event)
{
    const char *text = k->body + 1;
    if (*text == '<' && (final == 'M' || final == 'm')) { /* "<0;11;6" and the final byte */
        text++;
        const unsigned code = parameter(&text), column = place(k, &text), row = place(k, &text);
        if (text != k->body + k->length - 1)
            return emit(k, KEY_OTHER, 0, event);
        return emit_mouse(k, code, column, row, final == 'm', event);
    }
    if (final == 'M' && k->length == 2) {
        k->state = KEYS_CSI_MOUSE;
        return false;
    }
    if ((strchr("?><=", *text) && *text) || (strchr("tcnRSy", final) && k->length > 2))
        return emit(k, KEY_REPLY, 0, event);
    if (final == '[' && k->length == 2) {
        k->state = KEYS_CSI_LINUX;
        return false;
    }
    if (final == 'Z')
        return emit(k, KEY_TAB, KEY_SHIFT, event);
    unsigned number = parameter(&text), modifier = parameter(&text);
    unsigned modifiers = modifier > 0 ? (modifier - 1) & 7 : 0;
    return emit(k, final == '~' ? tilde_key(number) : letter_key(final), modifiers, event);
}

static bool feed_ss3(struct keys *k, uint8_t byte, struct key_event *event)
{
    if (byte >= '0' && byte <= '9')
        return false;
    if (byte == 'M')
        return emit(k, KEY_ENTER, 0, event);
    if (byte >= 'a' && byte <= 'd') /* rxvt's Ctrl */
        return emit(k, letter_key((uint8_t)(byte - 32)), KEY_CONTROL, event);
    return emit(k, letter_key(byte), 0, event);
}

static bool feed(struct keys *k, uint8_t byte, struct key_event *event)
{
    bool control = byte < 0x20 || byte == DELETE;
    bool in_string = k->state == KEYS_STRING || k->state == KEYS_STRING_ESC;
    bool in_sequence = in_string || k->state == KEYS_CSI || k->state == KEYS_SS3 ||
                       k->state == KEYS_CSI_LINUX || k->state == KEYS_CSI_MOUSE;
    if (in_sequence && control && !(in_string && (byte == ESC || byte == BEL))) {
        k->alt = false;
        return feed_ground(k, byte, event);
    }
    switch (k->state) {
    case KEYS_UTF8:
        return feed_utf8(k, byte, event);
    case KEYS_ESC:
        return feed_escape(k, byte, event);
    case KEYS_CSI:
        store(k, byte);
        return byte >= 0x40 && end_csi(k, byte, event);
    case KEYS_CSI_LINUX:
        return emit(k, KEY_OTHER, 0, event);
    case KEYS_CSI_MOUSE:
        return feed_csi_mouse(k, byte, event);
    case KEYS_SS3:
        return feed_ss3(k, byte, event);
    case KEYS_STRING:
    case KEYS_STRING_ESC:
        if (byte == BEL || (k->state == KEYS_STRING_ESC && byte == '\\'))
            return emit(k, KEY_REPLY, 0, event);
        if (k->state == KEYS_STRING_ESC) {
            k->state = KEYS_ESC; /* another sequence begins before this one ended */
            return feed_escape(k, byte, event);
        }
        if (byte == ESC)
            k->state = KEYS_STRING_ESC;
        else
            store(k, byte);
        return false;
    case KEYS_GROUND:
        break;
    }
    return feed_ground(k, byte, event);
}

bool keys_feed(struct keys *k, uint8_t byte, struct key_event *event)
{
    k->taken = k->complete ? 1 : k->taken + 1;
    k->complete = feed(k, byte, event);
    return k->complete;
}

/* ---- time ---- */

bool keys_waiting(const struct keys *k)
{
    if (k->state == KEYS_ESC)
        return true;
    return (k->state == KEYS_CSI || k->state == KEYS_SS3 || k->state == KEYS_STRING) &&
           k->length == 1;
}

bool keys_time_out(struct keys *k, struct key_event *event)
{
    if (!keys_waiting(k))
        return false;
    k->complete = true;
    if (k->state == KEYS_ESC)
        return emit(k, KEY_ESCAPE, 0, event);
    return emit_point(k, (uint8_t)k->body[0], KEY_ALT, event);
}

bool keys_is_answer(const char *body)
{
    return strncmp(body, "[?", 2) == 0 && body[strlen(body) - 1] == 'c';
}
