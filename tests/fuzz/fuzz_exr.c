/* SPDX-License-Identifier: MIT */
/* Bytes as a golden image: read, with what it says of itself, or refused in one line; what was read
 * and written comes back the same. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "image/exr.h"
#include "image/picture.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct picture picture;
    struct fault fault = {.text = ""};
    const enum err err = exr_read(&picture, fuzz_file(bytes, length), &fault);
    HOLDS(!err || fault.text[0]);
    HOLDS(!strpbrk(fault.text, "\n\r\033"));
    HOLDS(err || (picture.width && picture.height));
    if (!err)
        picture_release(&picture);
    return 0;
}
