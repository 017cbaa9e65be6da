/* SPDX-License-Identifier: MIT */
#include "helper/csa.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/scan.h"

enum { BEGIN = 16, NAME = 64, ELEMENT = 84, COUNT_AT = 76, ITEM = 16, LENGTH_AT = 4, DIGITS = 63 };

struct rest {
    const uint8_t *at;
    size_t length;
};

/* Take the next `length` bytes; NULL if there are fewer. */
static const uint8_t *take(struct rest *rest, size_t length)
{
    const uint8_t *at = rest->at;
    if (length > rest->length)
        return NULL;
    rest->at += length;
    rest->length -= length;
    return at;
}

static bool is_number(double *out, const uint8_t *text, size_t length)
{
    char digits[DIGITS + 1] = "", *end;
    memcpy(digits, text, length < DIGITS ? length : DIGITS);
    *out = strtod(digits, &end);
    return end != digits && end[strspn(end, " ")] == '\0' && isfinite(*out);
}

int csa_numbers(double *out, int most, const uint8_t *bytes, size_t length, const char *name)
{
    struct rest rest = {bytes, length};
    const uint8_t *begin = take(&rest, BEGIN);
    int count = 0;
    if (!begin || memcmp(begin, "SV10", 4) != 0)
        return -1;
    for (uint64_t elements = bits_get(begin + 8, 4, false); elements > 0; elements--) {
        const uint8_t *element = take(&rest, ELEMENT);
        if (!element)
            return -1;
        bool takes = strnlen((const char *)element, NAME) == strlen(name) &&
                     memcmp(element, name, strlen(name)) == 0;
        for (uint64_t items = bits_get(element + COUNT_AT, 4, false); items > 0; items--) {
            const uint8_t *item = take(&rest, ITEM);
            const size_t bytes_in = item ? bits_get(item + LENGTH_AT, 4, false) : 0;
            const uint8_t *text = item ? take(&rest, bytes_in) : NULL;
            if (!text)
                return -1;
            if (!take(&rest, -bytes_in % 4))
                rest.length = 0; /* the last text may lack its padding */
            takes = takes && count < most && is_number(&out[count], text, bytes_in);
            count += takes;
        }
    }
    return count;
}
