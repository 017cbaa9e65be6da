/* SPDX-License-Identifier: MIT */
/*
 * Decimals: numbers as people write them, exact: 226, -0.5, 4000000000, 1.5e-3, 1e20.
 *
 * Of at most 19 digits (20, up to 2^64 - 1) between the first and the last that is not 0, and
 * within what double precision holds. Equal numbers are equal bytes.
 */
#ifndef BASE_DECIMAL_H
#define BASE_DECIMAL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"

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
