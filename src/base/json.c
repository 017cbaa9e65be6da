/* SPDX-License-Identifier: MIT */
#include "base/json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/safe.h"

/* A code point beyond 16 bits is a pair of surrogates. */
static void add_escape(struct buf *out, uint32_t point)
{
    if (point < 0x10000)
        buf_printf(out, "\\u%04x", point);
    else
        buf_printf(out, "\\u%04x\\u%04x", 0xD7C0 + (point >> 10), 0xDC00 + (point & 0x3FF));
}

static void add_text(struct buf *out, const char *text, size_t length)
{
    buf_add_char(out, '"');
    while (length > 0) {
        uint32_t point;
        size_t n = utf8_read(text, length, &point);
        if (n == 0)
            add_escape(out, (unsigned char)*text);
        else if (safe_character(text, length) == 0)
            add_escape(out, point);
        else if (*text == '"' || *text == '\\')
            buf_printf(out, "\\%c", *text);
        else
            buf_add(out, text, n);
        n = n ? n : 1;
        text += n;
        length -= n;
    }
    buf_add_char(out, '"');
}

/* ---- members ---- */

static bool has_lines(const struct json *json)
{
    return json->depth && json->depth <= json->lines;
}

static void begin_line(struct json *json, unsigned depth)
{
    buf_add_char(json->out, '\n');
    for (unsigned i = 0; i < depth; i++)
        buf_add_text(json->out, "  ");
}

static void begin_member(struct json *json, const char *key)
{
    if (json->has_member)
        buf_add_char(json->out, ',');
    if (has_lines(json))
        begin_line(json, json->depth);
    else if (json->has_member)
        buf_add_char(json->out, ' ');
    if (key) {
        add_text(json->out, key, strlen(key));
        buf_add_text(json->out, ": ");
    }
}

static void end_member(struct json *json)
{
    json->has_member = json->depth > 0;
    if (!json->depth)
        buf_add_char(json->out, '\n');
}

static void begin_container(struct json *json, const char *key, char opening, char closing)
{
    assert(json->depth < JSON_DEPTH_MOST);
    begin_member(json, key);
    buf_add_char(json->out, opening);
    json->closing[json->depth++] = closing;
    json->has_member = false;
}

void json_object(struct json *json, const char *key)
{
    begin_container(json, key, '{', '}');
}

void json_array(struct json *json, const char *key)
{
    begin_container(json, key, '[', ']');
}

void json_end(struct json *json)
{
    assert(json->depth > 0);
    if (json->has_member && has_lines(json))
        begin_line(json, json->depth - 1);
    buf_add_char(json->out, json->closing[--json->depth]);
    end_member(json);
}

/* ---- values ---- */

void json_bytes(struct json *json, const char *key, const void *bytes, size_t length)
{
    begin_member(json, key);
    add_text(json->out, bytes, length);
    end_member(json);
}

void json_text(struct json *json, const char *key, const char *text)
{
    json_bytes(json, key, text, strlen(text));
}

void json_format(struct json *json, const char *key, const char *format, ...)
{
    struct buf text = {0};
    va_list words;
    va_start(words, format);
    buf_vprintf(&text, format, words);
    va_end(words);
    json_bytes(json, key, buf_text(&text), text.length);
    json->out->failed |= text.failed;
    buf_release(&text);
}

/* A number, or another word of JSON. */
__attribute__((format(printf, 3, 4))) static void add_word(struct json *json, const char *key,
                                                           const char *format, ...)
{
    va_list words;
    begin_member(json, key);
    va_start(words, format);
    buf_vprintf(json->out, format, words);
    va_end(words);
    end_member(json);
}

void json_count(struct json *json, const char *key, uint64_t value)
{
    add_word(json, key, "%" PRIu64, value);
}

void json_boolean(struct json *json, const char *key, bool value)
{
    add_word(json, key, "%s", value ? "true" : "false");
}

void json_word(struct json *json, const char *key, const char *word)
{
    add_word(json, key, "%s", word);
}

void json_fixed(struct json *json, const char *key, double value, int decimals)
{
    if (isfinite(value))
        add_word(json, key, "%.*f", decimals, value);
    else
        add_word(json, key, "null");
}

void json_real(struct json *json, const char *key, double value, int digits)
{
    if (isfinite(value))
        add_word(json, key, "%.*g", digits, value);
    else
        add_word(json, key, "null");
}
