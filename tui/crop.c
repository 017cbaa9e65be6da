#include "tui/crop.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/ioctl.h>

#include "tui/char_width.h"

unsigned crop_columns(int fd)
{
    struct winsize size = {0};
    return ioctl(fd, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

bool crop_locale_is_utf8(void)
{
    static const char *const name[] = {"LC_ALL", "LC_CTYPE", "LANG"};
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) {
        const char *locale = getenv(name[i]);
        if (locale && *locale)
            return strcasestr(locale, "utf-8") || strcasestr(locale, "utf8");
    }
    return false;
}

/* The bytes of a line of `length` that fit. */
static size_t fitting(const char *line, size_t length, unsigned columns)
{
    size_t bytes = 0;
    for (unsigned used = 0; bytes < length;) {
        uint32_t point;
        const size_t n = char_read(line + bytes, length - bytes, &point);
        used += point == CHAR_BROKEN ? 1 : char_width(point);
        if (used > columns)
            break;
        bytes += n;
    }
    return bytes;
}

void crop_lines(struct buf *out, const char *text, unsigned columns)
{
    while (*text) {
        const size_t length = strcspn(text, "\n");
        buf_add(out, text, columns ? fitting(text, length, columns) : length);
        if (text[length] == '\n')
            buf_add_char(out, '\n');
        text += length + (text[length] == '\n');
    }
}
