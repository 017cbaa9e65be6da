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

#endif
