/* SPDX-License-Identifier: MIT */
/* Formats that nobody here reads (image/volume.h): each row of their table says what it is there
 * for, unless a format that is read has taken what the row is known by. */
#include "base/choice.h"
#include "image/volume.h"
#include "folder_main.h"

/* A file with such a name and the first bytes of the row, and an unknown rest. */
static const char *make(const struct foreign *row, const char *ending, size_t length)
{
    char name[32], bytes[1024];
    memset(bytes, 'U', sizeof bytes);
    if (row->bytes)
        memcpy(bytes + row->at, row->bytes, row->length);
    snprintf(name, sizeof name, "a%.*s", (int)length, ending);
    const char *path = file_in(folder, name);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(bytes, 1, sizeof bytes, file) == sizeof bytes);
    CHECK(file && fclose(file) == 0);
    return path;
}

STORY(each_row_is_still_refused_with_its_advice)
{
    for (const struct foreign *row = foreign_formats; row->advice; row++) {
        const char *endings = *row->endings ? row->endings : ".bin";
        for (struct choice ending; choice_next(&ending, &endings);) {
            const char *path = make(row, ending.word, ending.length);
            struct volume_reader reader;
            struct fault fault = {.text = ""};
            CHECK_INT(volume_begin(&reader, path, NULL, NULL, &fault), ERR_INPUT);
            if (!CHECK(strstr(fault.text, row->advice)))
                printf("#   %.*s is read now, or refused for something else: %s\n#   not \"%s\"\n",
                       (int)ending.length, ending.word, fault.text, row->advice);
            volume_close(&reader);
            remove(path);
        }
    }
}
