/* SPDX-License-Identifier: MIT */
/* Bytes as a scene of NRRD: its header, its voxels, plain and as gzip. What is left to ITK goes to
 * a helper that is not there, which is refused in one line. */
#include "tests/fuzz/fuzz.h"

#include "image/volume_helper.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    volume_helper_program = "/nonexistent/iftty-volume";
    fuzz_volume(fuzz_file(bytes, length));
    return 0;
}
