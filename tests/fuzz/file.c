/* SPDX-License-Identifier: MIT */
#include "tests/fuzz/fuzz.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>

#include "image/regrid.h"
#include "image/volume.h"
#include "tests/folder.h"

enum { VOXELS_MOST = 1 << 20 }; /* more are fine, and take too long here */

static void fill(int descriptor, const uint8_t *bytes, size_t length)
{
    HOLDS(descriptor >= 0 && ftruncate(descriptor, 0) == 0);
    HOLDS(length == 0 || pwrite(descriptor, bytes, length, 0) == (ssize_t)length);
}

const char *fuzz_file(const uint8_t *bytes, size_t length)
{
    static char path[32];
    static int descriptor = -1;
    if (descriptor < 0) {
        descriptor = memfd_create("fuzz", 0);
        snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    }
    fill(descriptor, bytes, length);
    return path;
}

/* Readers go by the names of a pair. */
static char folder[FOLDER_LENGTH];

static void clean_up(void)
{
    remove_folder(folder);
}

static int make(const char *name)
{
    return open(file_in(folder, name), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
}

const char *fuzz_pair(const uint8_t *header, size_t header_length, const uint8_t *voxels,
                      size_t voxels_length)
{
    static int descriptor[2] = {-1, -1};
    if (descriptor[0] < 0) {
        HOLDS(make_folder(folder, "fuzz") && atexit(clean_up) == 0);
        descriptor[0] = make("A.hdr");
        descriptor[1] = make("A.img");
    }
    fill(descriptor[0], header, header_length);
    fill(descriptor[1], voxels, voxels_length);
    return file_in(folder, "A.hdr");
}

void fuzz_volume(const char *path)
{
    struct volume_header facts;
    struct volume volume;
    struct fault fault = {.text = ""};
    struct volume_reader reader;
    enum err err = volume_begin(&reader, path, NULL, NULL, &fault);
    facts = reader.header;
    volume_close(&reader);
    HOLDS(!err || (fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
    if (err || (uint64_t)facts.size[0] * facts.size[1] * facts.size[2] > VOXELS_MOST)
        return;
    const struct volume_choice last = {.has_volume = facts.volumes > 1,
                                       .volume = facts.volumes - 1};
    err = volume_read(&volume, path, &last, NULL, &fault);
    HOLDS(!err == (volume.intensity != NULL));
    HOLDS(err || memcmp(volume.size, facts.size, sizeof volume.size) == 0);
    if (!err) {
        const uint32_t size[3] = {5, 4, 3};
        struct geometry place = {.slope = 1};
        geometry_place_plain(&place, (const double[3]){1, 1, 1});
        geometry_orient(&place, "LPS");
        place.orientation = ORIENTATION_FILE;
        const enum err placed = regrid(&volume, size, &place, true, NULL, &fault);
        HOLDS(placed || memcmp(volume.size, size, sizeof size) == 0);
    }
    volume_release(&volume);
    err = volume_read(&volume, path, &(struct volume_choice){.reduce = 2}, NULL, &fault);
    HOLDS(!err == (volume.intensity != NULL));
    volume_release(&volume);
}
