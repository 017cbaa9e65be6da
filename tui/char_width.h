/*
 * How many cells a character takes in a terminal: 0 for marks that sit on the one before, 2 for
 * East Asian wide characters and emoji, else 1. Our own tables, because wcwidth asks the locale,
 * and a session over SSH often has none. From Unicode 14 (UnicodeData: Mn and Me; EastAsianWidth:
 * W and F), which the terminals in use agree on for all but emoji sequences.
 */
#ifndef TUI_CHAR_WIDTH_H
#define TUI_CHAR_WIDTH_H

#include <stddef.h>
#include <stdint.h>

unsigned char_width(uint32_t point);

/* Reads the UTF-8 character at `text` (`length` > 0) into *point and returns its bytes; for what is
 * not well formed, one byte and CHAR_BROKEN. */
#define CHAR_BROKEN UINT32_MAX
size_t char_read(const char *text, size_t length, uint32_t *point);

#endif
