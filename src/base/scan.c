/* SPDX-License-Identifier: MIT */
#include "base/scan.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXPONENT_MOST = 400, PLACES_MOST = 12, WHOLE_MOST = 20 /* digits that are written out */ };

/* Remove zeros at the end of the digits. */
static struct decimal normal(struct decimal d)
{
    if (!d.digits)
        return (struct decimal){0, 0, 0};
    for (; d.digits % 10 == 0; d.digits /= 10)
        d.exponent++;
    return d;
}

struct decimal decimal_of(int64_t units, unsigned places)
{
    const uint64_t digits = units < 0 ? -(uint64_t)units : (uint64_t)units;
    return normal((struct decimal){digits, -(int32_t)places, units < 0 ? -1 : 1});
}

struct decimal decimal_near(double value, unsigned digits)
{
    char text[40];
    const char *at = text;
    struct decimal out = {0, 0, 0};
    snprintf(text, sizeof text, "%.*e", (int)digits - 1, value);
    for (char *plus = strchr(text, '+'); plus; plus = strchr(text, '+'))
        memmove(plus, plus + 1, strlen(plus)); /* e+20 */
    decimal_scan(&at, &out);
    return out;
}

/* Append a digit; zeros are held back until another digit follows. */
static bool add_digit(struct decimal *d, int32_t *zeros, char c)
{
    ++*zeros;
    if (c == '0')
        return *zeros < EXPONENT_MOST;
    for (; *zeros > 0; --*zeros)
        if (__builtin_mul_overflow(d->digits, 10, &d->digits))
            return false;
    return !__builtin_add_overflow(d->digits, (uint64_t)(c - '0'), &d->digits);
}

bool decimal_scan(const char **cursor, struct decimal *out)
{
    const char *at = *cursor;
    struct decimal d = {0, 0, *at == '-' ? -1 : 1};
    int32_t zeros = 0;
    int64_t exponent = 0;
    at += *at == '-';
    if (!scan_is_digit(*at))
        return false;
    for (; scan_is_digit(*at); at++)
        if (!add_digit(&d, &zeros, *at))
            return false;
    if (at[0] == '.' && scan_is_digit(at[1]))
        for (at++; scan_is_digit(*at); at++, d.exponent--)
            if (!add_digit(&d, &zeros, *at))
                return false;
    if (*at == 'e' || *at == 'E') {
        const char *after = at + 1;
        after += *after == '+' && scan_is_digit(after[1]);
        if (!scan_integer(&after, -EXPONENT_MOST, EXPONENT_MOST, &exponent))
            return false;
        at = after;
    }
    d.exponent += zeros + (int32_t)exponent;
    d = normal(d);
    if (d.digits && !(isfinite(decimal_value(&d)) && decimal_value(&d) != 0))
        return false;
    *out = d;
    *cursor = at;
    return true;
}

double decimal_value(const struct decimal *decimal)
{
    char text[48]; /* without a point, which not every locale has */
    snprintf(text, sizeof text, "%" PRIu64 "e%" PRId32, decimal->digits, decimal->exponent);
    return decimal->sign < 0 ? -strtod(text, NULL) : strtod(text, NULL);
}

void decimal_write(struct buf *out, const struct decimal *decimal)
{
    static const char zeros[] = "00000000000000000000";
    char text[24];
    const int n = snprintf(text, sizeof text, "%" PRIu64, decimal->digits);
    const int exponent = decimal->exponent, whole = n + exponent; /* digits before the point */
    buf_add_text(out, decimal->sign < 0 ? "-" : "");
    if (exponent >= 0 && whole <= WHOLE_MOST) {
        buf_printf(out, "%s%.*s", text, exponent, zeros);
    } else if (exponent < 0 && exponent >= -PLACES_MOST) {
        if (whole > 0)
            buf_printf(out, "%.*s.%s", whole, text, text + whole);
        else
            buf_printf(out, "0.%.*s%s", -whole, zeros, text);
    } else {
        buf_printf(out, "%.1s%s%se%d", text, n > 1 ? "." : "", text + 1, whole - 1);
    }
}

bool interval_scan(const char **cursor, unsigned *channel, struct decimal range[2])
{
    const char *at = *cursor;
    int64_t number = 1;
    if (!scan_integer(&at, 1, 99, &number) || !scan_text(&at, ":")) {
        number = 1;
        at = *cursor;
    }
    if (!decimal_scan(&at, &range[0]) || !scan_text(&at, "..") || !decimal_scan(&at, &range[1]) ||
        decimal_value(&range[0]) > decimal_value(&range[1]))
        return false;
    *channel = (unsigned)number - 1;
    *cursor = at;
    return true;
}

void interval_write(struct buf *out, unsigned channel, const struct decimal range[2])
{
    if (channel)
        buf_printf(out, "%u:", channel + 1);
    decimal_write(out, &range[0]);
    buf_add_text(out, "..");
    decimal_write(out, &range[1]);
}

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
