/* SPDX-License-Identifier: MIT */
/*
 * A writer of JSON, which sets commas, quotes and brackets, and escapes texts.
 *
 *     struct json json = {.out = &text};
 *     json_object(&json, NULL);
 *     json_text(&json, "file", path);
 *     json_array(&json, "size");
 *     for (int a = 0; a < 3; a++)
 *         json_count(&json, NULL, size[a]);
 *     json_end(&json);
 *     json_end(&json);
 *
 * appends {"file": "a.nii", "size": [3, 4, 5]} and a line feed, which ends every outermost value.
 * Each value has a key in an object, and NULL in an array or outermost. Texts of any bytes become
 * valid JSON that is safe to print: a character that safe_character (base/safe.h) rejects becomes
 * \uNNNN, or two of them, and a byte that is not UTF-8 \u00NN. Numbers have a decimal point, since
 * no program here sets a locale.
 *
 * The writer owns nothing; `out` records a failure.
 */
#ifndef BASE_JSON_H
#define BASE_JSON_H

#include "base/buf.h"
#include "base/err.h"

enum { JSON_DEPTH_MOST = 16 };

/* Initialise as {.out = ...}; the caller may set `lines`, and the writer sets the rest. */
struct json {
    struct buf *out;
    unsigned lines;  /* put each member of objects and arrays down to this depth on a line of its
                       own; 0: none */
    unsigned depth;  /* number of open objects and arrays */
    bool has_member; /* a comma comes before the next one */
    char closing[JSON_DEPTH_MOST];
};

/* Each is closed by json_end, the last opened first. */
void json_object(struct json *json, const char *key);
void json_array(struct json *json, const char *key);
void json_end(struct json *json);

void json_text(struct json *json, const char *key, const char *text);
void json_bytes(struct json *json, const char *key, const void *bytes, size_t length);
void json_format(struct json *json, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4))); /* as a text */
void json_count(struct json *json, const char *key, uint64_t value);
void json_boolean(struct json *json, const char *key, bool value);
void json_word(struct json *json, const char *key, const char *word); /* a JSON word: null, 12 */

/* An array of numbers. */
void json_counts(struct json *json, const char *key, const uint32_t *value, size_t count);

/* A number with `decimals` digits after the point; in the shorter of the two notations with
 * `digits` significant digits. A value that is not finite becomes null. */
void json_fixed(struct json *json, const char *key, double value, int decimals);
void json_real(struct json *json, const char *key, double value, int digits);

/*
 * A reader of JSON (RFC 8259) from outside: one object, whose members are texts, whole numbers,
 * true, false and null.
 *
 *     struct json_reader reader = {.bytes = line, .length = length};
 *     struct json_member member = {0};
 *     while (!(err = json_read(&reader, &member, fault)) && member.kind != JSON_END)
 *         ...                                {"id": 7, "do": "zoom 2"} has two
 *     json_member_release(&member);
 *
 * Nothing nests: an inner object or array is refused where it begins, so memory is bounded by the
 * input's length. Texts are UTF-8 without overlong forms; escaped surrogates must form pairs; a
 * zero byte is refused, since it terminates texts here. Numbers are whole and within 2^53, the
 * range that every reader of JSON keeps exactly. The caller, who knows the keys, has to detect
 * duplicates. Bytes after the object are refused.
 */

struct json_reader {
    const char *bytes; /* the caller's; need not be terminated */
    size_t length;
    size_t at; /* starts at 0 */
};

enum json_kind { JSON_END, JSON_TEXT, JSON_NUMBER, JSON_TRUE, JSON_FALSE, JSON_NULL };

struct json_member {
    enum json_kind kind; /* JSON_END: no further member */
    struct buf key, text;
    int64_t number;
};

/* Read the next member. ERR_USAGE, with the byte, from 1, and the expected token; ERR_MEMORY. The
 * caller releases the member. */
enum err json_read(struct json_reader *reader, struct json_member *member, struct fault *fault);
void json_member_release(struct json_member *member);

#endif
