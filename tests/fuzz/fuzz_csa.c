/* SPDX-License-Identifier: MIT */
/* The private header of a Siemens picture: its values are finite numbers, as many as asked for or
 * fewer, and nothing after its last byte is looked at. */
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <string.h>

#include "helper/csa.h"

enum { MOST = 3 };

static void ask(const uint8_t *bytes, size_t length, const char *name)
{
    double number[MOST + 1] = {0, 0, 0, -1};
    const int count = csa_numbers(number, MOST, bytes, length, name);
    HOLDS(count >= -1 && count <= MOST && number[MOST] == -1);
    for (int i = 0; i < count; i++)
        HOLDS(isfinite(number[i]));
    HOLDS(count < 0 || length >= 16);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    uint8_t *own = malloc(length + 1); /* a byte too many read is seen */
    HOLDS(own);
    memcpy(own + 1, bytes, length);
    ask(own + 1, length, "NumberOfImagesInMosaic");
    ask(own + 1, length, "SliceNormalVector");
    ask(own + 1, length, "");
    free(own);
    return 0;
}
