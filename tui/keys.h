/* SPDX-License-Identifier: MIT */
/*
 * From bytes to keys, one byte at a time, so that it does not matter how reads split them.
 *
 *     61                      KEY_CHARACTER 'a'            C3 A4          KEY_CHARACTER U+00E4
 *     01                      KEY_CHARACTER 'a' + KEY_CONTROL
 *     ESC 62                  KEY_CHARACTER 'b' + KEY_ALT
 *     ESC [ A,  ESC O A       KEY_UP                       ESC [ 1;5 C    KEY_RIGHT + KEY_CONTROL
 *     ESC [ 3 ~               KEY_DELETE                   ESC [ 200 ~    KEY_PASTE_BEGIN
 *     ESC [ ? 62;4 c          KEY_REPLY "[?62;4c"          ESC P .. ESC \ KEY_REPLY "P.."
 *     ESC [ < 0;11;6 M        KEY_MOUSE, left pressed, column 10, row 5;   m: released
 *     ESC [ M 20 2B 26        the same from terminals without SGR reports
 *     ESC [ < 0;95;110 M      under ESC[?1016h, in pixels (keys.unit)
 *
 * A terminal's replies may come late, so they are recognised during the whole session and are never
 * inserted into the line as text: CSI with a private mark or with a final byte that only replies
 * have; DCS, APC, OSC, PM and SOS to their end, however long. A control byte inside a sequence ends
 * it, so a truncated reply cannot swallow Enter or Ctrl-C.
 *
 * ESC alone is a key too, and so are Alt-[, Alt-O, Alt-P and others whose bytes begin sequences.
 * Only time can tell: while keys_waiting returns true and nothing arrives for KEYS_TIMEOUT_MS, the
 * caller calls keys_time_out. If a reply arrives first, it is a KEY_REPLY with KEY_ALT: it came
 * right after the Escape key.
 */
#ifndef TUI_KEYS_H
#define TUI_KEYS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum key {
    KEY_PENDING,
    KEY_CHARACTER,
    KEY_ENTER,
    KEY_TAB,
    KEY_BACKSPACE,
    KEY_ESCAPE,
    KEY_UP,
    KEY_DOWN,
    KEY_RIGHT,
    KEY_LEFT,
    KEY_HOME,
    KEY_END,
    KEY_INSERT,
    KEY_DELETE,
    KEY_PAGE_UP,
    KEY_PAGE_DOWN,
    KEY_PASTE_BEGIN,
    KEY_PASTE_END,
    KEY_REPLY, /* its text is in keys.body */
    KEY_MOUSE, /* key_event.mouse */
    KEY_OTHER  /* not used: F1, keypad, focus gained or lost .. */
};

enum { KEY_SHIFT = 1, KEY_ALT = 2, KEY_CONTROL = 4 }; /* xterm's modifier parameter minus 1 */

enum { KEYS_TIMEOUT_MS = 50 };

enum mouse_action {
    MOUSE_PRESSED,
    MOUSE_RELEASED,
    MOUSE_MOVED, /* with `button` held; reported under ESC[?1002h (held) and ESC[?1003h (always) */
    MOUSE_WHEEL_UP,
    MOUSE_WHEEL_DOWN
};
enum mouse_button { MOUSE_LEFT, MOUSE_MIDDLE, MOUSE_RIGHT, MOUSE_NO_BUTTON };

/* Unit of SGR reports: cells from 1; pixels under ESC[?1016h, from 1 as in xterm and foot, or from
 * 0 as in kitty and ghostty. Outside the window pixels may be negative. */
enum mouse_unit { MOUSE_CELLS, MOUSE_PIXELS, MOUSE_PIXELS_FROM_0 };

struct mouse {
    enum mouse_action action;
    enum mouse_button button; /* MOUSE_NO_BUTTON if none or unknown */
    unsigned column, row;     /* cells or pixels, from 0 at the top left; below 100000 */
};

struct key_event {
    enum key key;
    unsigned modifiers;
    uint32_t point; /* for KEY_CHARACTER; with KEY_CONTROL the letter in lower case */
    char text[5];   /* the same in UTF-8 */
    unsigned length;
    struct mouse mouse; /* for KEY_MOUSE */
};

struct keys {
    enum mouse_unit unit;
    enum {
        KEYS_GROUND,
        KEYS_UTF8,
        KEYS_ESC,
        KEYS_CSI,
        KEYS_CSI_LINUX, /* ESC [ [ A: a function key of the Linux console */
        KEYS_CSI_MOUSE, /* ESC [ M and three bytes */
        KEYS_SS3,
        KEYS_STRING,
        KEYS_STRING_ESC
    } state;
    bool alt;        /* ESC ESC: the next key has Alt */
    unsigned needed; /* bytes of a character still to come */
    bool complete;   /* the last byte completed an event */
    size_t taken;    /* bytes of the event, and before a KEY_REPLY those of an unfinished one */
    size_t length;   /* bytes in body; only the beginning of a longer sequence is stored */
    char body[256];  /* without the first ESC, ended by NUL */
};

/* `struct keys k = {0}` is ready. Feed a byte; return true if it completed *event. */
bool keys_feed(struct keys *k, uint8_t byte, struct key_event *event);

/* Return true if the bytes so far are a key of their own unless more follows at once. */
bool keys_waiting(const struct keys *k);

/* Return true if the body of a KEY_REPLY answers ESC[c. */
bool keys_is_answer(const char *body);

/* Call if nothing followed: return true with the event that the bytes make on their own. */
bool keys_time_out(struct keys *k, struct key_event *event);

#endif
