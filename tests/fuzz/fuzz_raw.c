/* SPDX-License-Identifier: MIT */
/* Bytes as voxels without a header: the first ones say the layout and what part is read. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "image/volume.h"

enum { LAYOUT = 16, VOXELS_MOST = 1 << 20 };

static uint32_t side(const uint8_t *byte)
{
    return byte[1] < 250 ? byte[0] % 32u : (uint32_t)byte[0] << 24 | byte[1];
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct volume_choice choice = {.raw.type = VOXEL_INT8};
    struct volume volume;
    struct fault fault = {.text = ""};
    uint64_t voxels = 1;
    if (length < LAYOUT)
        return 0;
    for (int a = 0; a < 3; a++) {
        choice.raw.size[a] = side(bytes + 2 * a);
        voxels = voxels > VOXELS_MOST ? voxels : voxels * choice.raw.size[a];
        choice.first[a] = bytes[6 + a];
        choice.last[a] = bytes[9 + a];
    }
    choice.raw.type = bytes[12] % (VOXEL_FLOAT64 + 1u);
    choice.raw.big_endian = bytes[13] & 1;
    choice.has_crop = bytes[13] & 2;
    choice.nearest = bytes[13] & 4;
    choice.reduce = bytes[14] % (REDUCE_MOST + 1u);
    choice.raw.offset = bytes[15] == 255 ? UINT64_MAX - bytes[14] : bytes[15];
    if (choice.raw.size[0] == 0) /* that is: no layout */
        choice.raw.size[0] = 1;
    const enum err err =
        volume_read(&volume, fuzz_file(bytes + LAYOUT, length - LAYOUT), &choice, NULL, &fault);
    HOLDS(!err == (volume.intensity != NULL));
    HOLDS(!err || (fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
    HOLDS(err || voxels <= VOXELS_MOST || length > VOXELS_MOST / 1100);
    for (int a = 0; a < 3; a++)
        HOLDS(err || (volume.size[a] >= 1 && volume.size[a] <= choice.raw.size[a]));
    volume_release(&volume);
    return 0;
}
