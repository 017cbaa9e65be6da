/* SPDX-License-Identifier: MIT */
/*
 * Safe printing: the only way in which bytes from outside (file names, headers, journals, labels)
 * reach a terminal.
 *
 * Printable ASCII and well-formed UTF-8 pass. Control characters, escape sequences, bidirectional
 * and invisible formatting marks, and bytes that are not UTF-8 become \xNN, byte by byte, so that
 * no file can move the cursor, change a colour or hide text. Backslashes are not escaped: the
 * output is for display only.
 */
#ifndef BASE_SAFE_H
#define BASE_SAFE_H

#include <stddef.h>
#include <stdint.h>

/* Write `length` bytes of `text`, escaped, into `out`, which holds `capacity` > 0 bytes and is
 * always terminated. A text that does not fit is cut at a whole character and marked "...". Return
 * the length written. */
size_t safe_copy(char *out, size_t capacity, const char *text, size_t length);

/* Return the number of bytes (1..4) of the well-formed, printable UTF-8 character at `text`, or 0
 * if the next byte must be escaped. `length` > 0. */
size_t safe_character(const char *text, size_t length);

/* Return the first byte of a text that must be escaped, or its end. */
const char *safe_end(const char *text);

/* Return the number of bytes (1..4) of the well-formed UTF-8 character at `text`, printable or not,
 * and its code point; 0 for overlong forms, surrogates, values beyond U+10FFFF and other bytes.
 * `length` > 0. */
size_t utf8_read(const char *text, size_t length, uint32_t *point);

/* Write a character as UTF-8, without a NUL, and return its bytes. */
enum { UTF8_BYTES_MOST = 4 };
size_t utf8_write(char out[UTF8_BYTES_MOST], uint32_t point);

#endif
