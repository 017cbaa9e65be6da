#include "tui/picture/base64.h"

static const char digit[64] = {"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"};

static char *put_group(char *place, uint32_t n)
{
    place[0] = digit[n >> 18];
    place[1] = digit[n >> 12 & 63];
    place[2] = digit[n >> 6 & 63];
    place[3] = digit[n & 63];
    return place + 4;
}

void base64_add(struct buf *out, const uint8_t *byte, size_t length)
{
    const size_t characters = (length + 2) / 3 * 4;
    char *place = buf_reserve(out, characters);
    if (!place)
        return;
    out->length += characters;
    for (; length >= 3; byte += 3, length -= 3)
        place = put_group(place, (uint32_t)byte[0] << 16 | (uint32_t)byte[1] << 8 | byte[2]);
    if (length > 0) {
        place = put_group(place, (uint32_t)byte[0] << 16 | (length > 1 ? byte[1] * 256u : 0));
        place[-1] = '=';
        if (length == 1)
            place[-2] = '=';
    }
    *place = '\0';
}
