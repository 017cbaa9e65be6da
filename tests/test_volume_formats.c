/* SPDX-License-Identifier: MIT */
/* The table of volume formats: each that is read has a fuzz target with a corpus that it reads, and
 * each that is written comes back as it was. */

#include "base/file.h"
#include "image/volume.h"
#include "image/volume_helper.h"
#include "tests/interpreting.h"
#define BEFORE_STORIES volume_helper_program = built_program("iftty-volume")
#include "tests/folder_main.h"

/* By name in VOLUME_FORMATS: the target of what is read, NULL where it is only written; and where a
 * row is written, the name of such a file. */
static const struct proven {
    const char *format, *target, *written;
    bool by_bytes; /* recognised by its first bytes */
} proven[] = {
    {"nifti_format", "nifti", "a.nii.gz", true}, {"pair_format", "nifti", NULL, false},
    {"mgh_format", "mgh", "a.mgz", true},        {"nrrd_format", "nrrd", "a.nrrd", true},
    {"metaimage_format", NULL, "a.mha", false},  {"raw_format", "raw", NULL, false},
    {"helped_format", "helper", NULL, false},    {"seg_format", NULL, "a.dcm", false},
};

#define DECLARE(format, note) extern const struct volume_format format;
VOLUME_FORMATS(DECLARE)
#define NAMED(format, note) {#format, &format},
static const struct {
    const char *name;
    const struct volume_format *format;
} rows[] = {VOLUME_FORMATS(NAMED)};
enum { ROWS = sizeof rows / sizeof rows[0], PROVEN = sizeof proven / sizeof proven[0] };

static const struct proven *proven_of(const char *name)
{
    for (size_t i = 0; i < PROVEN; i++)
        if (strcmp(proven[i].format, name) == 0)
            return &proven[i];
    printf("#   %s has no row here: a fuzz target, and the way back of what is written\n", name);
    return NULL;
}

/* Count the files of a corpus that a format recognises; all, if it has no first bytes. */
static unsigned files_of(const struct proven *p, const struct volume_format *format)
{
    char path[300];
    unsigned count = 0;
    snprintf(path, sizeof path, "tests/fuzz/corpus/%s", p->target);
    OWNED(listing_release) DIR *listing = opendir(path);
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        OWNED(buf_release) struct buf bytes = {0};
        snprintf(path, sizeof path, "tests/fuzz/corpus/%s/%s", p->target, entry->d_name);
        if (*entry->d_name != '.' && file_read(&bytes, path, 1 << 20, NULL) == OK)
            count +=
                !p->by_bytes || format->recognises((const uint8_t *)buf_text(&bytes), bytes.length);
    }
    OWNED(buf_release) struct buf targets = {0};
    snprintf(path, sizeof path, "{\"%s\", ", p->target);
    CHECK_INT(file_read(&targets, "tests/fuzz/targets.c", 1 << 20, NULL), OK);
    CHECK_HAS(buf_text(&targets), path);
    return count;
}

STORY(every_format_that_is_read_has_a_fuzz_target_and_bytes_for_it)
{
    for (size_t i = 0; i < ROWS; i++) {
        const struct proven *p = proven_of(rows[i].name);
        if (!CHECK(p) || !CHECK(!rows[i].format->read_header == !p->target) || !p->target)
            continue;
        CHECK_WITH(files_of(p, rows[i].format) > 0, "no file for %s", rows[i].name);
    }
}

enum { X = 7, Y = 5, Z = 4 };

static uint8_t value_at(uint32_t x, uint32_t y, uint32_t z)
{
    return (uint8_t)(x * 31 + y * 17 + z * 57);
}

static void row_of_values(void *context, uint32_t y, uint32_t z, void *values)
{
    uint8_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < X; x++)
        at[x] = value_at(x, y, z);
}

static void comes_back(const struct volume_format *format, const char *name)
{
    static const uint32_t size[3] = {X, Y, Z};
    const bool is_seg = file_is_named(name, ".dcm"); /* which has no left-handed axes */
    const double to_mm[3][4] = {{is_seg ? 1 : -1, 0, 0, 5.5}, {0, 1.5, 0, -20}, {0, 0, 2, 7}};
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1500000, 2000000}};
    const char *path = file_in(folder, name);
    OWNED(volume_release) struct volume volume = {0};
    struct volume_label label[256];
    OWNED(buf_release) struct buf words = {0};
    buf_add_text(&words, "\n0020000d 1.2\n0020000e 1.3\n00200052 1.4\nslice 1.5 1.6 0\n");
    const struct dicom_source source = {.words = words, .date = "19000101", .time = "000000"};
    for (unsigned l = 0; l < 256; l++)
        label[l] = (struct volume_label){.name = "", .code = "", .number = l, .used = true};
    CHECK(geometry_place(&geometry, to_mm, ORIENTATION_SFORM));
    CHECK(format->write(path, FILE_REPLACE,
                        &(struct volume_map){size, &geometry, VOXEL_UINT8, "test", row_of_values,
                                             NULL, is_seg ? label : NULL, is_seg ? &source : NULL,
                                             NULL},
                        NULL, &fault) == OK);
    if (!CHECK(volume_read(&volume, path, NULL, NULL, &fault) == OK)) {
        printf("#   %s: %s\n", name, fault.text);
        return;
    }
    CHECK(memcmp(volume.size, size, sizeof size) == 0);
    CHECK(memcmp(volume.geometry.spacing_nm, geometry.spacing_nm, sizeof geometry.spacing_nm) == 0);
    unsigned wrong = 0;
    for (uint32_t i = 0; i < X * Y * Z; i++)
        wrong += volume.intensity[i] != value_at(i % X, i / X % Y, i / X / Y);
    CHECK_INT(wrong, 0);
}

STORY(every_format_that_is_written_comes_back_as_it_was)
{
    for (size_t i = 0; i < ROWS; i++) {
        const struct proven *p = proven_of(rows[i].name);
        if (CHECK(p) && CHECK(!rows[i].format->write == !p->written) && p->written)
            comes_back(rows[i].format, p->written);
    }
}
