/* SPDX-License-Identifier: MIT */
#include "image/exr_header.h"

#include <string.h>

#include "base/file.h"
#include "image/exr_parts.h"
#include "image/exr_write.h"

enum { BEFORE = 8, FIRST_READ = 1 << 14, LONG_NAMES = 0x400, WINDOW = 16, ATTRIBUTES_MOST = 200 };

static uint32_t number_at(const char *at)
{
    const uint8_t *p = (const uint8_t *)at;
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* ---- reading ---- */

bool exr_header_next(const struct buf *header, size_t *at, struct exr_attribute_bytes *out)
{
    *at = *at < BEFORE ? BEFORE : *at;
    const char *name = header->data + *at, *end = header->data + header->length;
    if (*at >= header->length || !*name)
        return false;
    const char *type = memchr(name, 0, (size_t)(end - name));
    const char *size = type ? memchr(type + 1, 0, (size_t)(end - type) - 1) : NULL;
    if (!size || end - size < 5)
        return false;
    const size_t length = number_at(size + 1);
    if (length > (size_t)(end - size) - 5)
        return false;
    *out = (struct exr_attribute_bytes){name, type + 1, size + 5, length};
    *at = (size_t)(size + 5 - header->data) + length;
    return true;
}

/* Cuts what follows the header; false where its end is not among the bytes. */
static bool ends(struct buf *header)
{
    struct exr_attribute_bytes attribute;
    size_t at = 0;
    while (exr_header_next(header, &at, &attribute))
        ;
    if (at < BEFORE || at >= header->length || header->data[at])
        return false;
    header->length = at + 1;
    return true;
}

enum err exr_header_read(struct buf *bytes, int fd, struct fault *fault)
{
    static const char magic[] = {0x76, 0x2f, 0x31, 0x01, 2};
    for (size_t length = FIRST_READ; length <= EXR_HEADER_MOST; length *= 2) {
        buf_clear(bytes);
        char *to = buf_reserve(bytes, length);
        const ssize_t n = to ? file_read_at(fd, to, length, 0) : 0;
        if (!to)
            return fault_memory(fault, "a header");
        if (n < 0)
            return fault_errno(fault, "read", "a header");
        bytes->length = (size_t)n;
        if (n < BEFORE || memcmp(to, magic, sizeof magic) != 0)
            return fault_set(fault, ERR_INPUT, "it is no OpenEXR file");
        if (ends(bytes))
            return OK;
        if ((size_t)n < length)
            return fault_set(fault, ERR_INPUT, "its header is cut short");
    }
    return fault_set(fault, ERR_INPUT, "its header has more than %d bytes", EXR_HEADER_MOST);
}

/* ---- comparing ---- */

static bool find(const struct buf *header, const char *name, struct exr_attribute_bytes *out)
{
    size_t at = 0;
    while (exr_header_next(header, &at, out))
        if (strcmp(out->name, name) == 0)
            return true;
    return false;
}

/* Bytes after a NUL would be no part of the note that is compared. */
static bool is_note(const struct exr_attribute_bytes *a)
{
    return strcmp(a->type, "string") == 0 && !exr_is_reserved(a->name) &&
           !memchr(a->value, 0, a->length);
}

static enum err compare_sizes(const struct buf *header, const struct picture *like,
                              struct fault *fault)
{
    struct exr_attribute_bytes window;
    int64_t side[2] = {0, 0};
    if (find(header, "dataWindow", &window) && window.length == WINDOW)
        for (size_t d = 0; d < 2; d++)
            side[d] = (int64_t)(int32_t)number_at(window.value + 8 + 4 * d) -
                      (int32_t)number_at(window.value + 4 * d) + 1;
    return side[0] == like->width && side[1] == like->height
               ? OK
               : fault_set(fault, ERR_CHECK,
                           "the sizes differ: it is %lldx%lld pixels, and %ux%u are drawn",
                           (long long)side[0], (long long)side[1], like->width, like->height);
}

/* Each attribute of `a` but notes is in `b`, once and with the same bytes. */
static enum err compare_attributes(const struct buf *a, const struct buf *b, const char *what,
                                   struct fault *fault)
{
    struct exr_attribute_bytes one, other;
    struct buf name = {0};
    size_t at = 0, count = 0;
    enum err err = OK;
    while (!err && exr_header_next(a, &at, &one)) {
        const size_t after = at;
        if (++count > ATTRIBUTES_MOST)
            return fault_set(fault, ERR_CHECK, "it has more than %d attributes", ATTRIBUTES_MOST);
        struct exr_attribute_bytes again;
        bool is_twice = false;
        for (size_t rest = after; !is_twice && exr_header_next(a, &rest, &again);)
            is_twice = strcmp(again.name, one.name) == 0;
        if (!is_twice &&
            (is_note(&one) ||
             (find(b, one.name, &other) && strcmp(one.type, other.type) == 0 &&
              one.length == other.length && memcmp(one.value, other.value, one.length) == 0)))
            continue;
        buf_clear(&name);
        buf_add_safe_excerpt(&name, one.name, strlen(one.name));
        err = fault_set(fault, ERR_CHECK, what, is_twice ? "two attributes" : "an attribute",
                        buf_text(&name));
    }
    buf_release(&name);
    return err;
}

enum err exr_header_check(const struct buf *header, const struct picture *like, struct fault *fault)
{
    struct buf expected = {0};
    enum err err = compare_sizes(header, like, fault);
    if (!err)
        err = exr_write_header_of(&expected, like, fault);
    if (!err && !ends(&expected))
        err = fault_memory(fault, "a header");
    if (!err && (number_at(header->data + 4) & ~(uint32_t)LONG_NAMES) !=
                    (number_at(expected.data + 4) & ~(uint32_t)LONG_NAMES))
        err = fault_set(fault, ERR_CHECK, "it has several parts, or is of another kind");
    if (!err)
        err = compare_attributes(header, &expected, "it has %s %s that iftty does not write there",
                                 fault);
    if (!err)
        err = compare_attributes(&expected, header, "it lacks %s %s, or has it otherwise", fault);
    buf_release(&expected);
    return err;
}
