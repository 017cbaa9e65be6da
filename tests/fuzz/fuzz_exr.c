/* SPDX-License-Identifier: MIT */
/* Bytes as an OpenEXR file: read, with its notes, or refused in one line; and as the golden image
 * of what was read, or of a picture that is drawn. Its header is read by our own reader too, which
 * finds the same notes. */
#include "tests/fuzz/fuzz.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "image/exr.h"
#include "image/picture.h"

static void check_words(enum err err, const struct fault *fault)
{
    HOLDS(!err || fault->text[0]);
    HOLDS(!strpbrk(fault->text, "\n\r\033"));
}

/* What golden images are compared with: associated, with a world, and without. */
static void draw(struct picture *like, bool is_associated)
{
    HOLDS(!picture_init(like, 5, 4, true, NULL));
    like->is_associated = is_associated;
    like->space.has_world = is_associated;
    like->space.eye_mm = 9;
    for (size_t i = 0; i < 4; i++)
        like->space.to_camera[i][i] = like->space.to_ndc[i][i] = 1;
}

static void read_golden(const char *path, const struct picture *like)
{
    struct picture golden;
    struct fault fault = {.text = ""};
    const enum err err = exr_read_golden(&golden, path, like, NULL, &fault);
    check_words(err, &fault);
    if (err)
        return;
    HOLDS(golden.width == like->width && golden.height == like->height);
    HOLDS(picture_planes(&golden) == picture_planes(like));
    picture_release(&golden);
}

/* With the notes of the picture that was read, or NULL. */
static void read_header(const char *path, const struct picture *picture)
{
    struct buf header = {0};
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
    buf_release(&header);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
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
        draw(&like, is_associated);
        read_golden(path, &like);
        picture_release(&like);
    }
    return 0;
}
