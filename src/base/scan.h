/* SPDX-License-Identifier: MIT */
/*
 * Scanning: numbers and words out of text, strictly and without locale.
 *
 * Each function reads at *cursor, advances it past what it took and returns true; on false the
 * cursor has not moved and nothing was stored. No function skips blanks on its own.
 */
#ifndef BASE_SCAN_H
#define BASE_SCAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"

static inline bool scan_is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* A decimal integer, sign allowed, no leading '+', within least..most. */
bool scan_integer(const char **cursor, int64_t least, int64_t most, int64_t *out);

/* A decimal fraction times 10^places as an integer: "12.5" with 3 places is 12500. More digits
 * than places are refused unless they are zeros. */
bool scan_decimal(const char **cursor, unsigned places, int64_t least, int64_t most, int64_t *out);

/* Three of them with commas between, "1.5,0,-2". */
bool scan_three(const char **cursor, unsigned places, int64_t least, int64_t most, int64_t out[3]);

/* "A-B" with A <= B, both within least..most, or "A" for "A-A". */
bool scan_range(const char **cursor, int64_t least, int64_t most, int64_t *first, int64_t *last);

/* The same as the next of a list "A-B,C,D-E", with the comma after it where another follows. */
bool scan_list_range(const char **cursor, int64_t least, int64_t most, int64_t *first,
                     int64_t *last);

/* Whether all of a text is such a list. */
bool scan_is_list(const char *text, int64_t least, int64_t most);

/* Number `which` of such a list, from 0, or where it has fewer, its last. */
int64_t scan_list_number(const char *list, size_t which);

/* Exactly `digits` lower-case hexadecimal digits. */
bool scan_hex(const char **cursor, unsigned digits, uint64_t *out);
bool scan_is_hex(const char *text, size_t digits); /* the text is these and no more */

/* This very text. */
bool scan_text(const char **cursor, const char *text);

/* Blanks and tabs; always succeeds. */
void scan_blanks(const char **cursor);

/*
 * Decimals: numbers as people write them, exact: 226, -0.5, 4000000000, 1.5e-3, 1e20.
 *
 * Of at most 19 digits (20, up to 2^64 - 1) between the first and the last that is not 0, and
 * within what double precision holds. Equal numbers are equal bytes.
 */

/* sign * digits * 10^exponent; digits do not end in 0, and of 0 everything is 0. */
struct decimal {
    uint64_t digits;
    int32_t exponent, sign;
};

/* units / 10^places */
struct decimal decimal_of(int64_t units, unsigned places);

/* The decimal of so many significant digits, 1 to 17, that is nearest to a finite number. */
struct decimal decimal_near(double value, unsigned digits);

/* Reads at *cursor and moves it on; false, and neither is changed, where there is none: a sign, no
 * plus, digits, and where wanted a point with digits, and e with a whole number. */
bool decimal_scan(const char **cursor, struct decimal *out);

/* The nearest double, rounded correctly: the same on every machine. */
double decimal_value(const struct decimal *decimal);

/* As decimal_scan reads it, always the same for one number: "0.0015", and "1.5e-13" where that
 * takes many zeros. */
void decimal_write(struct buf *out, const struct decimal *decimal);

#endif
