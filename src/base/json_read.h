/* SPDX-License-Identifier: MIT */
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
#ifndef BASE_JSON_READ_H
#define BASE_JSON_READ_H

#include "base/buf.h"
#include "base/err.h"

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
