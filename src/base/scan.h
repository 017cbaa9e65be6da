/* SPDX-License-Identifier: MIT */
/*
 * Scanning: numbers and words out of text, strictly and without locale.
 *
 * Each function reads at *cursor, advances it past the bytes read and returns true; on false the
 * cursor and the result are unchanged. No function skips blanks on its own.
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

/* A decimal fraction times 10^places as an integer: "12.5" with 3 places is 12500. Digits beyond
 * `places` are refused unless they are zeros. */
bool scan_decimal(const char **cursor, unsigned places, int64_t least, int64_t most, int64_t *out);

/* Three such fractions separated by commas, "1.5,0,-2". */
bool scan_three(const char **cursor, unsigned places, int64_t least, int64_t most, int64_t out[3]);

/* "A-B" with A <= B, both within least..most, or "A" for "A-A". */
bool scan_range(const char **cursor, int64_t least, int64_t most, int64_t *first, int64_t *last);

/* The next range of a list "A-B,C,D-E", with the comma after it if another follows. */
bool scan_list_range(const char **cursor, int64_t least, int64_t most, int64_t *first,
                     int64_t *last);

/* Return true if the whole text is such a list. */
bool scan_is_list(const char *text, int64_t least, int64_t most);

/* Return number `which` of such a list, from 0, or its last number if it has fewer. */
int64_t scan_list_number(const char *list, size_t which);

/* Exactly `digits` lower-case hexadecimal digits. */
bool scan_hex(const char **cursor, unsigned digits, uint64_t *out);
bool scan_is_hex(const char *text, size_t digits); /* the whole text */

/* Exactly this text. */
bool scan_text(const char **cursor, const char *text);

/* Blanks and tabs; always succeeds. */
void scan_blanks(const char **cursor);

/*
 * Decimals: exact numbers as people write them: 226, -0.5, 4000000000, 1.5e-3, 1e20.
 *
 * At most 19 digits (20, up to 2^64 - 1) between the first and the last that is not 0, within the
 * range of double precision. Equal numbers have equal bytes.
 */

/* sign * digits * 10^exponent; digits do not end in 0; the number 0 is all zeros */
struct decimal {
    uint64_t digits;
    int32_t exponent, sign;
};

/* units / 10^places */
struct decimal decimal_of(int64_t units, unsigned places);

/* Return the decimal with this number of significant digits, 1..17, nearest to a finite number. */
struct decimal decimal_near(double value, unsigned digits);

/* Read at *cursor: an optional '-', digits, an optional point with digits, and an optional e with
 * an integer. False, with both unchanged, on anything else. */
bool decimal_scan(const char **cursor, struct decimal *out);

/* Return the nearest double, rounded correctly, the same on every machine. */
double decimal_value(const struct decimal *decimal);

/* Write it as decimal_scan reads it, the same for equal numbers: "0.0015", or "1.5e-13" instead of
 * many zeros. */
void decimal_write(struct buf *out, const struct decimal *decimal);

/* An interval of intensities, both ends included: "LOW..HIGH" is of channel 0, the first, and
 * "2:LOW..HIGH" of channel 1. On other input `interval_scan` returns false, with the cursor
 * unchanged. */
bool interval_scan(const char **cursor, unsigned *channel, struct decimal range[2]);
void interval_write(struct buf *out, unsigned channel, const struct decimal range[2]);

/* ---- numbers in bytes ---- */

/* Read and write a number of `width` bytes, 1 to 8. */
static inline uint64_t bits_get(const void *from, unsigned width, bool big_endian)
{
    const uint8_t *at = from;
    uint64_t bits = 0;
    for (unsigned i = 0; i < width; i++)
        bits |= (uint64_t)at[big_endian ? width - 1 - i : i] << 8 * i;
    return bits;
}

static inline void bits_put(uint8_t *at, unsigned width, uint64_t bits, bool big_endian)
{
    for (unsigned i = 0; i < width; i++)
        at[big_endian ? width - 1 - i : i] = (uint8_t)(bits >> 8 * i);
}

#endif
