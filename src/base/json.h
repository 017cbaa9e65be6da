/* SPDX-License-Identifier: MIT */
/*
 * A writer of JSON: it sets commas, quotes and brackets, and escapes what has to be.
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
 * adds {"file": "a.nii", "size": [3, 4, 5]} and a line feed, which ends every outermost value. Each
 * value is given with the key it has in its object, or with NULL in an array and outermost. A text
 * of any bytes comes out as valid JSON that is safe to print: a character that safe_character
 * (base/safe.h) does not let pass becomes \uNNNN, or two of them, and a byte that is not UTF-8
 * \u00NN. Numbers have a point, since no program of ours sets a locale.
 *
 * The writer owns nothing; a failure stands in `out`.
 */
#ifndef BASE_JSON_H
#define BASE_JSON_H

#include "base/buf.h"
#include "base/err.h"

enum { JSON_DEPTH_MOST = 16 };

/* Begins as {.out = ...}; the caller sets `lines` besides, and leaves the rest to the writer. */
struct json {
    struct buf *out;
    unsigned lines; /* objects and arrays down to this depth have a line for each member; 0: none */
    unsigned depth; /* that are open now */
    bool has_member; /* a comma comes before the next one */
    char closing[JSON_DEPTH_MOST];
};

/* Each is closed by json_end, the last one opened first. */
void json_object(struct json *json, const char *key);
void json_array(struct json *json, const char *key);
void json_end(struct json *json);

void json_text(struct json *json, const char *key, const char *text);
void json_bytes(struct json *json, const char *key, const void *bytes, size_t length);
void json_format(struct json *json, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4))); /* a text too */
void json_count(struct json *json, const char *key, uint64_t value);
void json_boolean(struct json *json, const char *key, bool value);
void json_word(struct json *json, const char *key, const char *word); /* JSON already: null, 12 */

/* So many digits after the point; the shorter of the two forms with so many significant ones. A
 * value that is not finite, for which JSON has no number, is null. */
void json_fixed(struct json *json, const char *key, double value, int decimals);
void json_real(struct json *json, const char *key, double value, int digits);

/*
 * A reader of JSON (RFC 8259) from somebody else: one object, whose members are texts, whole
 * numbers, true, false and null.
 *
 *     struct json_reader reader = {.bytes = line, .length = length};
 *     struct json_member member = {0};
 *     while (!(err = json_read(&reader, &member, fault)) && member.kind != JSON_END)
 *         ...                                {"id": 7, "do": "zoom 2"} has two
 *     json_member_release(&member);
 *
 * Nothing nests: an object or array within is refused where it begins, so that no input takes more
 * than its own length. Texts are UTF-8 without overlong forms; escapes of surrogates come in pairs;
 * a zero byte is refused, since texts end in one here. Numbers are whole and within 2^53, which is
 * what every other reader of JSON keeps exactly. A key that comes twice is for the caller to
 * notice, who knows which there are. Bytes after the object are refused.
 */

struct json_reader {
    const char *bytes; /* the caller's; no NUL need end them */
    size_t length;
    size_t at; /* begins at 0 */
};

enum json_kind { JSON_END, JSON_TEXT, JSON_NUMBER, JSON_TRUE, JSON_FALSE, JSON_NULL };

struct json_member {
    enum json_kind kind; /* JSON_END: there is no further member */
    struct buf key, text;
    int64_t number;
};

/* The next member. ERR_USAGE with words that say what stands at which byte, from 1; ERR_MEMORY. */
enum err json_read(struct json_reader *reader, struct json_member *member, struct fault *fault);
void json_member_release(struct json_member *member);

#endif
