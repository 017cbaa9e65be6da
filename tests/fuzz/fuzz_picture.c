/* SPDX-License-Identifier: MIT */
/* Readers of pictures: OpenEXR and PNG. */
#include "tests/fuzz/fuzz.h"

#include <fcntl.h>
#include <libdeflate.h>
#include <string.h>
#include <unistd.h>

#include "image/exr.h"
#include "image/picture.h"
#include "image/png.h"

/* Bytes as an OpenEXR file: read, with its notes, or refused in one line; and as the golden image
 * of what was read, or of a picture that is drawn. Its header is read by our own reader too, which
 * finds the same notes. */

static void check_words(enum err err, const struct fault *fault)
{
    HOLDS(!err || fault->text[0]);
    HOLDS(!strpbrk(fault->text, "\n\r\033"));
}

static void read_golden(const char *path, const struct picture *like)
{
    OWNED(picture_release) struct picture golden = {0};
    struct fault fault = {.text = ""};
    const enum err err = exr_read_golden(&golden, path, like, NULL, &fault);
    check_words(err, &fault);
    if (err)
        return;
    HOLDS(golden.width == like->width && golden.height == like->height);
    HOLDS(picture_planes(&golden) == picture_planes(like));
}

/* With the notes of the picture that was read, or NULL. */
static void read_header(const char *path, const struct picture *picture)
{
    OWNED(buf_release) struct buf header = {0};
    struct exr_attribute_bytes attribute;
    struct fault fault = {.text = ""};
    size_t at = 0, notes = 0;
    const int fd = open(path, O_RDONLY);
    HOLDS(fd >= 0);
    const enum err err = exr_header_read(&header, fd, &fault);
    check_words(err, &fault);
    while (!err && exr_header_next(&header, &at, &attribute)) {
        const char *end = header.data + header.length;
        HOLDS(attribute.value <= end && attribute.length <= (size_t)(end - attribute.value));
        const char *note = picture ? picture_find(picture, attribute.name) : NULL;
        const size_t length = strnlen(attribute.value, attribute.length);
        notes += note && strlen(note) == length && memcmp(note, attribute.value, length) == 0;
    }
    HOLDS(!picture || err || notes >= picture->attributes);
    close(fd);
}

void fuzz_exr(const uint8_t *bytes, size_t length)
{
    struct picture picture, like;
    struct fault fault = {.text = ""};
    const char *path = fuzz_file(bytes, length);
    const enum err err = exr_read(&picture, path, &fault);
    check_words(err, &fault);
    HOLDS(err || (picture.width && picture.height));
    read_header(path, err ? NULL : &picture);
    if (!err) {
        read_golden(path, &picture);
        picture_release(&picture);
    }
    for (int is_associated = 0; is_associated < 2; is_associated++) {
        /* Pictures that golden images are compared with: associated, with a world, and without. */
        HOLDS(!picture_init(&like, 5, 4, PICTURE_BUT_NORMAL, NULL));
        like.is_associated = is_associated;
        like.space.has_world = is_associated;
        like.space.eye_mm = 9;
        for (size_t i = 0; i < 4; i++)
            like.space.to_camera[i][i] = like.space.to_ndc[i][i] = 1;
        read_golden(path, &like);
        picture_release(&like);
    }
}

/* Bytes as the PNG beside a golden image: pixels and texts, or refused in one line. What our own
 * writer makes of the pixels is read again, bit for bit. */

enum { SIDE = 12 }; /* of the picture that it is compared with */

static void read_again(const struct picture *picture)
{
    OWNED(buf_release) struct buf png = {0};
    OWNED(picture_release) struct picture again = {0};
    HOLDS(!png_encode(&png, SIDE, SIDE, picture->rgba, NULL));
    HOLDS(!png_read(&again, png.data, png.length, SIDE, SIDE, NULL));
    HOLDS(memcmp(again.rgba, picture->rgba, (size_t)4 * SIDE * SIDE) == 0);
}

static uint32_t number_at(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* Make every checksum right, so that the covered bytes are read. */
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

/* Reading only the notes returns the notes of the whole picture. */
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

void fuzz_png(const uint8_t *bytes, size_t length)
{
    OWNED(mem_release) uint8_t *copy = malloc(length ? length : 1);
    HOLDS(copy);
    read_one(bytes, length);
    if (length)
        memcpy(copy, bytes, length);
    mend(copy, length);
    read_one(copy, length);
}
