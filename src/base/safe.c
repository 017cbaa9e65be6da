/* SPDX-License-Identifier: MIT */
#include "base/safe.h"

#include <stdbool.h>
#include <string.h>

size_t utf8_read(const char *text, size_t length, uint32_t *point)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *byte = (const unsigned char *)text;
    const size_t n = byte[0] < 0x80                       ? 1 /* length announced by the lead byte
                                                                 */
                     : byte[0] >= 0xC2 && byte[0] <= 0xDF ? 2
                     : byte[0] >= 0xE0 && byte[0] <= 0xEF ? 3
                     : byte[0] >= 0xF0 && byte[0] <= 0xF4 ? 4
                                                          : 0;
    if (n == 0 || n > length)
        return 0;
    uint32_t value = n == 1 ? byte[0] : byte[0] & (0xFFu >> (n + 1));
    for (size_t i = 1; i < n; i++) {
        if ((byte[i] & 0xC0) != 0x80)
            return 0;
        value = value << 6 | (byte[i] & 0x3F);
    }
    if (value < least[n] || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF))
        return 0;
    *point = value;
    return n;
}

size_t utf8_write(char out[UTF8_BYTES_MOST], uint32_t point)
{
    const size_t n = point < 0x80 ? 1 : point < 0x800 ? 2 : point < 0x10000 ? 3 : 4;
    for (size_t i = n; i-- > 1; point >>= 6)
        out[i] = (char)(0x80 | (point & 0x3F));
    out[0] = (char)(n == 1 ? point : (0xF00u >> n & 0xFF) | point);
    return n;
}

/* Code points that print nothing themselves but change the appearance of other text. */
static bool is_formatting(uint32_t point)
{
    static const struct {
        uint32_t first, last;
    } range[] = {
        {0x0000, 0x001F}, {0x007F, 0x009F}, {0x00AD, 0x00AD},   {0x034F, 0x034F}, {0x061C, 0x061C},
        {0x115F, 0x1160}, {0x17B4, 0x17B5}, {0x180B, 0x180F},   {0x200B, 0x200F}, {0x2028, 0x202E},
        {0x2060, 0x206F}, {0x3164, 0x3164}, {0xFE00, 0xFE0F},   {0xFEFF, 0xFEFF}, {0xFFA0, 0xFFA0},
        {0xFFF0, 0xFFFB}, {0xFFFE, 0xFFFF}, {0xE0000, 0xE0FFF},
    };
    for (size_t i = 0; i < sizeof range / sizeof range[0]; i++)
        if (point >= range[i].first && point <= range[i].last)
            return true;
    return false;
}

size_t safe_character(const char *text, size_t length)
{
    uint32_t point;
    const size_t n = utf8_read(text, length, &point);
    return n && !is_formatting(point) ? n : 0;
}

const char *safe_end(const char *text)
{
    size_t n = 1;
    for (size_t left = strlen(text); left > 0 && n > 0; left -= n, text += n)
        n = safe_character(text, left);
    return text;
}

size_t safe_copy(char *out, size_t capacity, const char *text, size_t length)
{
    static const char hex[] = "0123456789abcdef";
    size_t used = 0;
    size_t fits = 0; /* length of `out` that may stay if "..." has to follow */
    for (size_t i = 0; i < length;) {
        char piece[4];
        size_t taken = safe_character(text + i, length - i);
        size_t n = taken ? taken : 4;
        if (taken) {
            memcpy(piece, text + i, taken);
        } else {
            unsigned char byte = (unsigned char)text[i];
            memcpy(piece, (char[]){'\\', 'x', hex[byte >> 4], hex[byte & 15]}, 4);
        }
        if (used + n + 1 > capacity) {
            if (capacity > 3) {
                memcpy(out + fits, "...", 3);
                used = fits + 3;
            }
            break;
        }
        memcpy(out + used, piece, n);
        used += n;
        if (used + 4 <= capacity)
            fits = used;
        i += taken ? taken : 1;
    }
    out[used] = '\0';
    return used;
}
