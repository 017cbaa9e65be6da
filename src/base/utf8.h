/* UTF-8: characters out of bytes, strictly: no overlong forms, surrogates, or anything beyond
 * U+10FFFF. What a character may do to a terminal is told by base/safe.h. */
#ifndef BASE_UTF8_H
#define BASE_UTF8_H

#include <stddef.h>
#include <stdint.h>

/* The number of bytes (1..4) of the well-formed character at `text`, and its code point; 0 where
 * there is none. `length` > 0. */
size_t utf8_read(const char *text, size_t length, uint32_t *point);

#endif
