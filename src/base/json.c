/* SPDX-License-Identifier: MIT */
#include "base/json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"

#define NUMBER_MOST ((INT64_C(1) << 53) - 1)

static const char *left(const struct json_reader *r)
{
    return r->bytes + r->at;
}

/* Return the next byte, or 0 at the end, which no JSON contains. */
static char here(const struct json_reader *r)
{
    return r->at < r->length ? *left(r) : '\0';
}

static void skip_blanks(struct json_reader *r)
{
    while (here(r) && strchr(" \t\r\n", here(r)))
        r->at++;
}

static bool take(struct json_reader *r, const char *word)
{
    const size_t n = strlen(word);
    if (n > r->length - r->at || memcmp(left(r), word, n) != 0)
        return false;
    r->at += n;
    return true;
}

static enum err expect(const struct json_reader *r, const char *expected, struct fault *fault)
{
    return fault_set(fault, ERR_USAGE, "byte %zu: expected %s", r->at + 1, expected);
}

/* ---- texts ---- */

/* Read four hexadecimal digits of either case. */
static bool take_hex(struct json_reader *r, uint32_t *out)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    uint32_t value = 0;
    for (size_t i = 0; i < 4; i++) {
        const char c = r->at + i < r->length ? left(r)[i] : '\0';
        const char *digit = c ? strchr(digits, c) : NULL;
        if (!digit)
            return false;
        value = value << 4 | (uint32_t)((digit - digits) & 15);
    }
    r->at += 4;
    *out = value;
    return true;
}

/* Read the rest of an escape after its backslash. */
static enum err take_escape(struct json_reader *r, struct buf *out, struct fault *fault)
{
    static const char escape[] = "\"\\/bfnrt", means[] = "\"\\/\b\f\n\r\t";
    const char *found = here(r) ? strchr(escape, here(r)) : NULL;
    char bytes[UTF8_BYTES_MOST];
    uint32_t point, low;
    if (found) {
        buf_add_char(out, means[found - escape]);
        r->at++;
        return OK;
    }
    if (!take(r, "u"))
        return expect(r, "one of \"\\/bfnrtu after a backslash", fault);
    if (!take_hex(r, &point))
        return expect(r, "four hexadecimal digits", fault);
    if (point == 0)
        return expect(r, "no zero byte in a text", fault);
    const bool is_low = point >= 0xDC00 && point <= 0xDFFF,
               is_high = point >= 0xD800 && point <= 0xDBFF;
    if (is_low ||
        (is_high && !(take(r, "\\u") && take_hex(r, &low) && low >= 0xDC00 && low <= 0xDFFF)))
        return expect(r, "surrogates in a pair, the high one first", fault);
    point = is_high ? 0x10000 + ((point - 0xD800) << 10) + (low - 0xDC00) : point;
    buf_add(out, bytes, utf8_write(bytes, point));
    return OK;
}

static enum err take_text(struct json_reader *r, struct buf *out, struct fault *fault)
{
    buf_clear(out);
    r->at++; /* the quote */
    while (here(r) != '"') {
        uint32_t point;
        if (r->at >= r->length)
            return expect(r, "the quote that ends a text", fault);
        const size_t n = utf8_read(left(r), r->length - r->at, &point);
        if (n == 0)
            return expect(r, "UTF-8", fault);
        if (point < ' ')
            return expect(r, "control characters as \\n, \\t or \\u00NN", fault);
        if (point == '\\') {
            r->at++;
            TRY(take_escape(r, out, fault));
            continue;
        }
        buf_add(out, left(r), n);
        r->at += n;
    }
    r->at++;
    return out->failed ? fault_memory(fault, "a text") : OK;
}

/* ---- other values ---- */

static enum err take_number(struct json_reader *r, int64_t *out, struct fault *fault)
{
    const bool is_negative = take(r, "-"), is_zero = here(r) == '0';
    const size_t begin = r->at;
    int64_t value = 0;
    for (; here(r) >= '0' && here(r) <= '9' && value <= NUMBER_MOST; r->at++)
        value = value * 10 + (here(r) - '0');
    if (r->at == begin || (is_zero && r->at > begin + 1) || value > NUMBER_MOST ||
        (here(r) && strchr(".eE", here(r))))
        return expect(r, "a whole number of at most 9007199254740991", fault);
    *out = is_negative ? -value : value;
    return OK;
}

static enum err take_value(struct json_reader *r, struct json_member *m, struct fault *fault)
{
    static const struct {
        const char *word;
        enum json_kind kind;
    } words[] = {{"true", JSON_TRUE}, {"false", JSON_FALSE}, {"null", JSON_NULL}};
    if (here(r) == '"') {
        m->kind = JSON_TEXT;
        return take_text(r, &m->text, fault);
    }
    if (here(r) == '-' || (here(r) >= '0' && here(r) <= '9')) {
        m->kind = JSON_NUMBER;
        return take_number(r, &m->number, fault);
    }
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (take(r, words[i].word)) {
            m->kind = words[i].kind;
            return OK;
        }
    return expect(r,
                  here(r) == '{' || here(r) == '['
                      ? "a text, a number, true, false or null: no object or array is known here"
                      : "a text, a number, true, false or null",
                  fault);
}

/* ---- members ---- */

enum err json_read(struct json_reader *r, struct json_member *m, struct fault *fault)
{
    const bool is_first = r->at == 0;
    skip_blanks(r);
    if (is_first && !take(r, "{"))
        return expect(r, "an object, as in {\"id\": 1}", fault);
    skip_blanks(r);
    if (take(r, "}")) {
        m->kind = JSON_END;
        skip_blanks(r);
        return r->at < r->length ? expect(r, "nothing after the object", fault) : OK;
    }
    if (!is_first && !take(r, ","))
        return expect(r, "a comma, or } at the end of the object", fault);
    skip_blanks(r);
    if (here(r) != '"')
        return expect(r, "a key between double quotes", fault);
    TRY(take_text(r, &m->key, fault));
    skip_blanks(r);
    if (!take(r, ":"))
        return expect(r, "a colon after the key", fault);
    skip_blanks(r);
    return take_value(r, m, fault);
}

void json_member_release(struct json_member *m)
{
    buf_release(&m->key);
    buf_release(&m->text);
    *m = (struct json_member){0};
}

/* Escape a code point; beyond 16 bits as a pair of surrogates. */
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
    OWNED(buf_release) struct buf text = {0};
    va_list words;
    va_start(words, format);
    buf_vprintf(&text, format, words);
    va_end(words);
    json_bytes(json, key, buf_text(&text), text.length);
    json->out->failed |= text.failed;
}

/* Write a number, or another word of JSON. */
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

void json_counts(struct json *json, const char *key, const uint32_t *value, size_t count)
{
    json_array(json, key);
    for (size_t i = 0; i < count; i++)
        json_count(json, NULL, value[i]);
    json_end(json);
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
    add_word(json, key, isfinite(value) ? "%.*f" : "null", decimals, value);
}

void json_real(struct json *json, const char *key, double value, int digits)
{
    add_word(json, key, isfinite(value) ? "%.*g" : "null", digits, value);
}
