/* SPDX-License-Identifier: MIT */
/* Bytes as the PNG beside a golden image: pixels and texts, or refused in one line. What our own
 * writer makes of the pixels is read again, bit for bit. */
#include "tests/fuzz/fuzz.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

#include "image/picture.h"
#include "image/png.h"

enum { SIDE = 12 }; /* of the picture that it is compared with */

static void read_again(const struct picture *picture)
{
    struct buf png = {0};
    struct picture again;
    HOLDS(!png_encode(&png, SIDE, SIDE, picture->rgba, NULL));
    HOLDS(!png_read(&again, png.data, png.length, SIDE, SIDE, NULL));
    HOLDS(memcmp(again.rgba, picture->rgba, (size_t)4 * SIDE * SIDE) == 0);
    picture_release(&again);
    buf_release(&png);
}

static uint32_t number_at(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* Every checksum is right, so that what they cover is read. */
static void mend(uint8_t *bytes, size_t length)
{
    for (size_t at = 8; length >= 12 && at <= length - 12;) {
        const size_t n = number_at(bytes + at);
        if (n > length - 12 - at)
            return;
        const uint32_t crc = libdeflate_crc32(0, bytes + at + 4, n + 4);
        for (unsigned i = 0; i < 4; i++)
            bytes[at + 8 + n + i] = (uint8_t)(crc >> (24 - 8 * i));
        at += n + 12;
    }
}

/* The notes alone are those that the whole has. */
static void read_notes(const struct picture *whole, const uint8_t *bytes, size_t length)
{
    struct picture notes;
    struct fault fault = {.text = ""};
    const enum err err = png_read_notes(&notes, bytes, length, &fault);
    HOLDS(!err || (fault.text[0] && !notes.attribute));
    HOLDS(!strpbrk(fault.text, "\n\r\033"));
    if (whole) {
        HOLDS(!err && notes.attributes == whole->attributes);
        for (size_t i = 0; i < whole->attributes; i++)
            HOLDS(strcmp(notes.attribute[i].name, whole->attribute[i].name) == 0 &&
                  strcmp(notes.attribute[i].value, whole->attribute[i].value) == 0);
    }
    if (!err)
        picture_release(&notes);
}

static void read_one(const uint8_t *bytes, size_t length)
{
    struct picture picture;
    struct fault fault = {.text = ""};
    const enum err err = png_read(&picture, bytes, length, SIDE, SIDE, &fault);
    HOLDS(!err || fault.text[0]);
    HOLDS(!strpbrk(fault.text, "\n\r\033"));
    for (size_t i = 0; !err && i < picture.attributes; i++)
        HOLDS(picture_find(&picture, picture.attribute[i].name) == picture.attribute[i].value);
    read_notes(err ? NULL : &picture, bytes, length);
    if (!err) {
        read_again(&picture);
        picture_release(&picture);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    uint8_t *copy = malloc(length ? length : 1);
    HOLDS(copy);
    read_one(bytes, length);
    if (length)
        memcpy(copy, bytes, length);
    mend(copy, length);
    read_one(copy, length);
    free(copy);
    return 0;
}
