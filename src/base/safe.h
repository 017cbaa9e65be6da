/* SPDX-License-Identifier: MIT */
/*
 * Safe printing: the one way by which bytes from outside (file names, headers, journals, labels)
 * reach a terminal.
 *
 * Printable ASCII and well-formed UTF-8 pass. Control characters, escape sequences, bidirectional
 * and invisible formatting marks, and bytes that are not UTF-8 come out as \xNN, byte by byte, so
 * that nothing a file holds can move the cursor, change a colour or hide text. A backslash is left
 * alone: this is for eyes, not for reading back.
 */
#ifndef BASE_SAFE_H
#define BASE_SAFE_H

#include <stddef.h>
#include <stdint.h>

/* Writes `length` bytes of `text` escaped into `out`, which holds `capacity` > 0 bytes, always
 * ended by NUL; what does not fit is cut at a whole character and marked "...". Returns the
 * length written. */
size_t safe_copy(char *out, size_t capacity, const char *text, size_t length);

/* The number of bytes (1..4) of the well-formed, printable UTF-8 character at `text`, or 0 where
 * the next byte must be escaped. `length` > 0. */
size_t safe_character(const char *text, size_t length);

/* The first byte of a text that must be escaped, or its end. */
const char *safe_end(const char *text);

/* The number of bytes (1..4) of the well-formed UTF-8 character at `text`, printable or not, and
 * its code point; 0 where there is none: no overlong forms, surrogates, or anything beyond
 * U+10FFFF. `length` > 0. */
size_t utf8_read(const char *text, size_t length, uint32_t *point);

#endif
