/* SPDX-License-Identifier: MIT */
/* Bytes as a scene of FreeSurfer: its header, what is said of it, and its voxels. */
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    fuzz_volume(fuzz_file(bytes, length));
    return 0;
}
