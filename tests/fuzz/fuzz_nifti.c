/* Bytes as a scene, in one file or as a pair: the header alone, what is said of it, and its
 * voxels. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "image/volume.h"
#include "image/nifti_header.h"
#include "image/regrid.h"

enum { VOXELS_MOST = 1 << 20 }; /* more are fine, and take too long here */

static void decode(const uint8_t *bytes, size_t length)
{
    struct nifti_header header;
    struct geometry geometry;
    uint8_t again[NIFTI_MOST_BYTES];
    char notes[VOLUME_NOTES_BYTES] = "";
    struct fault fault = {.text = ""};
    if (length < NIFTI_LEAST_BYTES || nifti_header_recognise(&header, bytes, &fault))
        return;
    HOLDS(header.bytes == NIFTI_LEAST_BYTES || header.bytes == NIFTI_MOST_BYTES);
    if (length < header.bytes)
        return;
    nifti_header_decode(&header, bytes);
    nifti_header_geometry(&geometry, notes, &header, (const uint32_t[]){9, 8, 7});
    HOLDS(geometry.world_axis[0] + geometry.world_axis[1] + geometry.world_axis[2] == 3);
    nifti_header_place(&header, &geometry);
    nifti_header_encode(&header, again);
}

static void read_all(const char *path)
{
    struct volume_header facts;
    struct volume volume;
    struct fault fault = {.text = ""};
    enum err err = volume_about(&facts, path, &fault);
    HOLDS(!err || (fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
    if (err || (uint64_t)facts.size[0] * facts.size[1] * facts.size[2] > VOXELS_MOST)
        return;
    const struct volume_choice last = {.has_volume = facts.volumes > 1,
                                       .volume = facts.volumes - 1};
    err = volume_read(&volume, path, &last, NULL, &fault);
    HOLDS(!err == (volume.intensity != NULL));
    HOLDS(err || memcmp(volume.size, facts.size, sizeof volume.size) == 0);
    if (!err) { /* a map of a scene that lies elsewhere */
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

/* The bytes as a pair, where their header is that of one: the rest is in another file. */
static void read_pair(const uint8_t *bytes, size_t length)
{
    struct nifti_header header;
    if (length < NIFTI_LEAST_BYTES || nifti_header_recognise(&header, bytes, NULL) ||
        header.kind == NIFTI_SINGLE || length < header.bytes)
        return;
    read_all(fuzz_pair(bytes, header.bytes, bytes + header.bytes, length - header.bytes));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    decode(bytes, length);
    read_all(fuzz_file(bytes, length));
    read_pair(bytes, length);
    return 0;
}
