/* SPDX-License-Identifier: MIT */
#include "base/scan.h"

#include <string.h>

bool scan_decimal(const char **cursor, unsigned places, int64_t least, int64_t most, int64_t *out)
{
    const char *at = *cursor;
    bool negative = *at == '-';
    int64_t value = 0;
    at += negative;
    if (!scan_is_digit(*at))
        return false;
    for (; scan_is_digit(*at); at++)
        if (__builtin_mul_overflow(value, 10, &value) ||
            __builtin_add_overflow(value, *at - '0', &value))
            return false;
    const bool has_point = places > 0 && *at == '.' && scan_is_digit(at[1]);
    at += has_point;
    for (unsigned i = 0; i < places; i++) {
        int digit = has_point && scan_is_digit(*at) ? *at++ - '0' : 0;
        if (__builtin_mul_overflow(value, 10, &value) ||
            __builtin_add_overflow(value, digit, &value))
            return false;
    }
    if (has_point)
        while (*at == '0')
            at++;
    if (scan_is_digit(*at))
        return false;
    if (negative)
        value = -value;
    if (value < least || value > most)
        return false;
    *out = value;
    *cursor = at;
    return true;
}

bool scan_three(const char **cursor, unsigned places, int64_t least, int64_t most, int64_t out[3])
{
    bool reads = true;
    for (int i = 0; i < 3 && reads; i++)
        reads = (i == 0 || scan_text(cursor, ",")) &&
                scan_decimal(cursor, places, least, most, &out[i]);
    return reads;
}

bool scan_integer(const char **cursor, int64_t least, int64_t most, int64_t *out)
{
    return scan_decimal(cursor, 0, least, most, out);
}

bool scan_range(const char **cursor, int64_t least, int64_t most, int64_t *first, int64_t *last)
{
    const char *at = *cursor;
    int64_t a, b;
    if (!scan_integer(&at, least, most, &a))
        return false;
    b = a;
    if (scan_text(&at, "-") && !scan_integer(&at, a, most, &b))
        return false;
    *first = a;
    *last = b;
    *cursor = at;
    return true;
}

bool scan_list_range(const char **cursor, int64_t least, int64_t most, int64_t *first,
                     int64_t *last)
{
    if (!scan_range(cursor, least, most, first, last))
        return false;
    *cursor += (*cursor)[0] == ',' && (*cursor)[1] != '\0';
    return true;
}

bool scan_is_list(const char *text, int64_t least, int64_t most)
{
    const char *at = text;
    int64_t first, last;
    while (scan_list_range(&at, least, most, &first, &last))
        ;
    return at != text && *at == '\0';
}

int64_t scan_list_number(const char *list, size_t which)
{
    int64_t first, last = 0;
    for (size_t before = 0; scan_list_range(&list, INT64_MIN, INT64_MAX, &first, &last);) {
        const uint64_t numbers = (uint64_t)last - (uint64_t)first + 1;
        if (which - before < numbers)
            return first + (int64_t)(which - before);
        before += (size_t)numbers;
    }
    return last;
}

bool scan_is_hex(const char *text, size_t digits)
{
    return strspn(text, "0123456789abcdef") == digits && !text[digits];
}

bool scan_hex(const char **cursor, unsigned digits, uint64_t *out)
{
    static const char hex[] = "0123456789abcdef";
    uint64_t value = 0;
    for (unsigned i = 0; i < digits; i++) {
        char c = (*cursor)[i];
        const char *place = c ? strchr(hex, c) : NULL;
        if (!place)
            return false;
        value = value << 4 | (uint64_t)(place - hex);
    }
    *cursor += digits;
    *out = value;
    return true;
}

bool scan_text(const char **cursor, const char *text)
{
    size_t length = strlen(text);
    if (strncmp(*cursor, text, length) != 0)
        return false;
    *cursor += length;
    return true;
}

void scan_blanks(const char **cursor)
{
    while (**cursor == ' ' || **cursor == '\t')
        ++*cursor;
}
