/* SPDX-License-Identifier: MIT */
/* Bytes as a scene, in one file or as a pair: the header alone, what is said of it, and its
 * voxels. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "image/image_inside.h"

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

/* The bytes as a pair, where their header is that of one: the rest is in another file. */
static void read_pair(const uint8_t *bytes, size_t length)
{
    struct nifti_header header;
    if (length < NIFTI_LEAST_BYTES || nifti_header_recognise(&header, bytes, NULL) ||
        header.kind == NIFTI_SINGLE || length < header.bytes)
        return;
    fuzz_volume(fuzz_pair(bytes, header.bytes, bytes + header.bytes, length - header.bytes));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    decode(bytes, length);
    fuzz_volume(fuzz_file(bytes, length));
    read_pair(bytes, length);
    return 0;
}
