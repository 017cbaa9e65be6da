/* SPDX-License-Identifier: MIT */
/* OpenEXR: written pictures are read back exactly; files of other programs are read or refused. */
#include <math.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "image/exr.h"
#include "image/exr_write.h"
#include "image/linear.h"
#define ONLY_LEAVES "a[.]exr"
#define RUN_IN_FOLDER
#include "folder_main.h"

static const char path[] = "a.exr";
static uint64_t chance = 1;

/* A picture in which every level of every channel and the odd values of each plane occur. */
static struct picture sample(uint32_t width, uint32_t height, bool all_planes)
{
    struct picture p;
    const unsigned planes = all_planes ? PICTURE_BUT_NORMAL | PICTURE_NORMAL : 0;
    CHECK_INT(picture_init(&p, width, height, planes, NULL), OK);
    for (size_t i = 0; i < (size_t)width * height; i++) {
        for (size_t c = 0; c < 4; c++)
            p.rgba[4 * i + c] = (uint8_t)(i * (2 * c + 1) + c);
        if (!all_planes)
            continue;
        p.depth_mm[i] = i % 3 ? (float)i / 7.0f : INFINITY;
        p.label[i] = (uint32_t)(i * 77);
        p.voxel[i] = check_random(&chance) % 5 ? (uint32_t)check_random(&chance) : UINT32_MAX;
    }
    for (size_t i = 0; p.normal && i < (size_t)width * height * 3; i++)
        p.normal[i] = (float)((int)(i * 977 % 32769) - 16384) / 16384.0f;
    CHECK_INT(picture_note(&p, "scene", "sha256:00ff", NULL), OK);
    CHECK_INT(picture_note(&p, "view", "yaw 30\npitch 20 \xc3\xa4", NULL), OK);
    CHECK_INT(picture_note(&p, "a note with a name of more than 31 bytes", "", NULL), OK);
    return p;
}

static bool same_plane(const void *a, const void *b, size_t bytes)
{
    return (a == NULL) == (b == NULL) && (!a || memcmp(a, b, bytes) == 0);
}

static bool same(const struct picture *a, const struct picture *b)
{
    size_t bytes = 4 * (size_t)a->width * a->height;
    bool notes = a->attributes == b->attributes;
    for (size_t i = 0; i < a->attributes && notes; i++)
        notes = strcmp(a->attribute[i].name, b->attribute[i].name) == 0 &&
                strcmp(a->attribute[i].value, b->attribute[i].value) == 0;
    return notes && a->width == b->width && a->height == b->height &&
           same_plane(a->rgba, b->rgba, bytes) && same_plane(a->depth_mm, b->depth_mm, bytes) &&
           same_plane(a->label, b->label, bytes) && same_plane(a->voxel, b->voxel, bytes) &&
           same_plane(a->normal, b->normal, 3 * bytes) && a->tiled == b->tiled;
}

/* Write a picture and read it again. */
static struct picture written(const struct picture *p)
{
    struct picture q;
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, p, NULL), OK);
    CHECK_INT(exr_read(&q, path, NULL), OK);
    return q;
}

static bool comes_back_as(uint32_t width, uint32_t height, bool all_planes, bool tiled)
{
    OWNED(picture_release) struct picture p = sample(width, height, all_planes), q = {0};
    struct fault fault = {0};
    p.tiled = tiled;
    bool fine = CHECK(strips_write(&exr_strips, path, FILE_REPLACE, &p, &fault) == OK) &&
                CHECK(exr_read(&q, path, &fault) == OK) && CHECK(same(&p, &q));
    if (!fine)
        printf("#   %ux%u%s: %s\n", width, height, tiled ? " tiled" : "", fault.text);
    return fine;
}

/* In lines and in tiles. */
static bool comes_back(uint32_t width, uint32_t height, bool all_planes)
{
    bool lines = comes_back_as(width, height, all_planes, false);
    return comes_back_as(width, height, all_planes, true) && lines;
}

STORY(every_level_and_every_plane_comes_back)
{
    comes_back(256, 31, true);
    comes_back(640, 480, true);
}

/* ---- colours multiplied by alpha ---- */

static double value_of(uint16_t half)
{
    const int exponent = half >> 10, mantissa = half & 1023;
    return exponent ? ldexp(1024 + mantissa, exponent - 25) : ldexp(mantissa, -24);
}

/* Each is the half nearest to the product, none is that of another level, and each comes back. */
STORY(every_level_comes_back_from_under_every_alpha)
{
    unsigned subnormal = 0, cases = 0;
    for (unsigned alpha = 1; alpha < 256; alpha++)
        for (unsigned level = 0; level < 256; level++, cases++) {
            const uint16_t half = linear_associated((uint8_t)level, (uint8_t)alpha);
            const double exact = value_of(linear_half[level]) * alpha / 255;
            const double off = fabs(value_of(half) - exact);
            CHECK(off <= fabs(value_of((uint16_t)(half + 1)) - exact));
            CHECK(half == 0 || off <= fabs(value_of((uint16_t)(half - 1)) - exact));
            CHECK(level == 0 || half > linear_associated((uint8_t)(level - 1), (uint8_t)alpha));
            CHECK_INT(linear_straight(half, (uint8_t)alpha), level);
            subnormal += half > 0 && half < 1024;
        }
    for (unsigned level = 0; level < 256; level++)
        CHECK_INT(linear_associated((uint8_t)level, 255), linear_half[level]);
    CHECK_INT(cases, 255 * 256);
    CHECK_INT(subnormal, 188);
}

/* Values of another program: any half, with any alpha. */
STORY(any_half_is_the_nearest_level)
{
    for (unsigned alpha = 0; alpha < 256; alpha += 5)
        for (uint32_t half = 0; half <= UINT16_MAX; half += 7) {
            const uint8_t level = linear_straight((uint16_t)half, (uint8_t)alpha);
            if (alpha == 0 || half > 0x7c00) {
                CHECK_INT(level, 0);
                continue;
            }
            const int own = abs(linear_associated(level, (uint8_t)alpha) - (int)half);
            CHECK(level == 0 ||
                  own <= abs(linear_associated((uint8_t)(level - 1), (uint8_t)alpha) - (int)half));
            CHECK(level == 255 ||
                  own <= abs(linear_associated((uint8_t)(level + 1), (uint8_t)alpha) - (int)half));
        }
}

/* All of them in one file, with the depths that compositors know, and where it was seen from. */
STORY(a_file_of_associated_alpha_comes_back_too)
{
    for (int tiled = 0; tiled < 2; tiled++) {
        OWNED(picture_release) struct picture p = sample(256, 255, true);
        p.is_associated = true;
        p.tiled = tiled;
        p.space.eye_mm = 1234.5;
        p.space.has_world = true;
        for (size_t i = 0; i < (size_t)256 * 255; i++) {
            memset(p.rgba + 4 * i, (int)(i % 256), 3);
            p.rgba[4 * i + 3] = (uint8_t)(1 + i / 256);
        }
        OWNED(picture_release) struct picture q = written(&p);
        CHECK(same(&p, &q) && q.is_associated);
    }
}

STORY(what_nothing_covers_has_no_colour)
{
    OWNED(picture_release) struct picture p = sample(8, 8, false);
    p.is_associated = true;
    memcpy(p.rgba, (uint8_t[8]){9, 200, 255, 0, 9, 200, 255, 1}, 8);
    OWNED(picture_release) struct picture q = written(&p);
    CHECK(memcmp(q.rgba, (uint8_t[8]){0, 0, 0, 0, 9, 200, 255, 1}, 8) == 0);
}

STORY(colours_alone_one_pixel_and_odd_sizes_come_back)
{
    comes_back(17, 40, false);
    for (uint32_t width = 1; width < 6; width++)
        for (uint32_t height = 1; height < 36; height += 5)
            comes_back(width, height, width % 2);
}

/* Deflate leaves about one block in a thousand of these exactly as long as it was, which readers
 * take to be stored plain. */
STORY(blocks_that_deflate_cannot_shorten_and_sizes_about_those_of_tiles_come_back)
{
    for (int round = 0; round < 3000; round++) /* tiles go the same way */
        if (!comes_back_as(2, 1 + check_below(&chance, 16), true, round % 10 == 0))
            break;
    static const uint32_t side[] = {63, 64, 65, 128, 200};
    for (size_t i = 0; i < sizeof side / sizeof side[0]; i++)
        for (size_t j = 0; j < sizeof side / sizeof side[0]; j++)
            comes_back(side[i], side[j], (i + j) % 2);
}

STORY(the_same_picture_gives_the_same_bytes)
{
    OWNED(picture_release) struct picture p = sample(50, 50, true);
    OWNED(buf_release) struct buf first = {0}, second = {0};
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, NULL), OK);
    CHECK_INT(file_read(&first, path, 1 << 20, NULL), OK);
    sleep(1);
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, NULL), OK);
    CHECK_INT(file_read(&second, path, 1 << 20, NULL), OK);
    CHECK_INT(first.length, second.length);
    CHECK(memcmp(first.data, second.data, first.length) == 0);
}

STORY(an_existing_file_and_a_note_under_a_name_of_the_format_are_refused)
{
    OWNED(picture_release) struct picture p = sample(4, 4, false);
    struct fault fault = {0};
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, &fault), OK);
    CHECK_INT(strips_write(&exr_strips, path, FILE_KEEP, &p, &fault), ERR_IO);
    CHECK_HAS(fault.text, "exists already");
    picture_note(&p, "dataWindow", "mine", NULL);
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "\"dataWindow\" cannot name a note");
}

static int full_after;
static int disk_is_full(enum file_step step, const char *name)
{
    (void)name;
    return step == FILE_STEP_WRITE && full_after-- <= 0 ? 28 /* ENOSPC */ : 0;
}

STORY(a_full_disk_leaves_the_former_file)
{
    OWNED(picture_release) struct picture p = sample(64, 64, true), q;
    struct fault fault = {0};
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, NULL), OK);
    p.rgba[0] ^= 1;
    file_step_hook = disk_is_full;
    for (int after = 0; after < 6; after++) {
        full_after = after;
        CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, &fault), ERR_IO);
        CHECK_HAS(fault.text, "No space left on device");
    }
    file_step_hook = NULL;
    CHECK_INT(exr_read(&q, path, NULL), OK);
    p.rgba[0] ^= 1;
    CHECK(same(&p, &q));
}

/* Replace the only occurrence of `from` in the file by as many bytes of `to`. */
static void patch(const void *from, const void *to, size_t length)
{
    OWNED(buf_release) struct buf file = {0};
    CHECK_INT(file_read(&file, path, 1 << 24, NULL), OK);
    char *at = memmem(file.data, file.length, from, length);
    if (CHECK(at != NULL)) {
        memcpy(at, to, length);
        CHECK_INT(file_write(path, file.data, file.length, FILE_REPLACE, NULL), OK);
    }
}

/* Writes a small picture, patches it, and reads it for the words of the refusal. */
static const char *refusal(const void *from, const void *to, size_t length)
{
    static struct fault fault;
    OWNED(picture_release) struct picture p = sample(8, 8, true), q = {0};
    fault = (struct fault){0};
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, NULL), OK);
    patch(from, to, length);
    CHECK(exr_read(&q, path, &fault) != OK && q.rgba == NULL && q.attributes == 0);
    CHECK(strchr(fault.text, '\n') == NULL);
    return fault.text;
}

#define WINDOW "dataWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0"

STORY(a_header_that_is_not_ours_is_refused_with_what_is_odd)
{
    static const struct {
        const char *from, *to;
        size_t length;
        const char *words;
    } row[] = {
        {"channels\0chlist\0\xc3\0\0\0A", "channels\0chlist\0\xc3\0\0\0C", 21,
         "no channel A; expected R, G, B and A"},
        {"label\0\0\0\0\0", "label\0\2\0\0\0", 10, "channel label is float; expected uint"},
        {WINDOW "\7\0\0\0\7\0\0\0", WINDOW "\377\377\0\0\7\0\0\0", 37, "OpenEXR"},
        {WINDOW "\7\0\0\0\7\0\0\0", WINDOW "\377\77\0\0\377\77\0\0", 37,
         "cannot hold 16384x16384 pixels"},
        {"compression\0compression\0\1\0\0\0\3", "compression\0compression\0\1\0\0\0\4", 29,
         "not the ZIP that iftty writes"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        CHECK_HAS(refusal(row[i].from, row[i].to, row[i].length), row[i].words);
}

STORY(tiles_of_many_levels_or_none_are_refused)
{
    static struct picture tiled;
    struct fault fault = {0};
    struct picture q;
    const char *form[] = {"tiles\0tiledesc\0\x9\0\0\0\x40\0\0\0\x40\0\0\0\1",
                          "tiles\0tiledesc\0\x9\0\0\0\0\0\0\0\x40\0\0\0\0",
                          "tiles\0tiledesc\0\x9\0\0\0\x40\0\0\0\xff\xff\xff\x7f\0"};
    for (size_t i = 0; i < sizeof form / sizeof form[0]; i++) {
        tiled = sample(70, 70, true);
        tiled.tiled = true;
        CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &tiled, NULL), OK);
        patch("tiles\0tiledesc\0\x9\0\0\0\x40\0\0\0\x40\0\0\0\0", form[i], 28);
        CHECK(exr_read(&q, path, &fault) != OK && q.rgba == NULL);
        CHECK(fault.text[0] != '\0' && strchr(fault.text, '\n') == NULL);
        picture_release(&tiled);
    }
}

STORY(what_is_no_exr_is_told_in_a_line)
{
    struct picture q;
    struct fault fault = {0};
    CHECK_INT(file_write(path, "P6 1 1 255 abc", 14, FILE_REPLACE, NULL), OK);
    CHECK_INT(exr_read(&q, path, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "cannot read");
    CHECK_INT(exr_read(&q, folder, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "not a regular file");
    CHECK_INT(exr_read(&q, "/nonexistent.exr", &fault), ERR_IO);
    CHECK_HAS(fault.text, "No such file");
}

static void damage(struct picture p)
{
    struct picture q;
    OWNED(buf_release) struct buf good = {0}, bad = {0};
    CHECK_INT(strips_write(&exr_strips, path, FILE_REPLACE, &p, NULL), OK);
    CHECK_INT(file_read(&good, path, 1 << 20, NULL), OK);
    for (int round = 0; round < 3000; round++) {
        struct fault fault = {0};
        buf_clear(&bad);
        buf_add(&bad, good.data, good.length);
        if (round % 4 == 0)
            bad.length = check_below(&chance, (uint32_t)bad.length);
        else /* mostly in the header, where the meaning is */
            for (int flips = 1 + round % 3; flips > 0; flips--)
                bad.data[check_below(&chance, round % 2 ? 900 : (uint32_t)bad.length)] ^=
                    (char)(1 << check_below(&chance, 8));
        FILE *file = fopen(path, "wb");
        fwrite(bad.data, 1, bad.length, file);
        fclose(file);
        if (exr_read(&q, path, &fault) != OK)
            CHECK(fault.text[0] != '\0' && q.rgba == NULL);
        picture_release(&q);
    }
    picture_release(&p);
}

STORY(damaged_files_never_do_harm)
{
    struct picture tiled = sample(70, 66, true);
    tiled.tiled = true;
    damage(sample(20, 33, true));
    damage(tiled);
}
