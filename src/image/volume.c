#include "image/volume.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/choice.h"
#include "image/part.h"

#define DECLARE(format, note) extern const struct volume_format format;
VOLUME_FORMATS(DECLARE)

#define POINT_AT(format, note) &format,
static const struct volume_format *const formats[] = {VOLUME_FORMATS(POINT_AT)};
enum { FORMATS = sizeof formats / sizeof formats[0], FIRST_BYTES = 1024 };

void volume_note(char notes[VOLUME_NOTES_BYTES], const char *format, ...)
{
    const size_t length = strlen(notes), room = VOLUME_NOTES_BYTES - length;
    va_list arguments;
    va_start(arguments, format);
    const int n = vsnprintf(notes + length, room, format, arguments);
    va_end(arguments);
    if (n < 0 || (size_t)n + 1 >= room)
        notes[length] = '\0';
    else
        memcpy(notes + length + n, "\n", 2);
}

/* ---- which format ---- */

static const struct volume_format *format_named(const char *path)
{
    for (int i = 0; i < FORMATS; i++)
        if (file_is_named(path, formats[i]->endings))
            return formats[i];
    return NULL;
}

const char *volume_ending(const char *path)
{
    const struct volume_format *format = format_named(path);
    return format ? file_ending(path, format->endings) : NULL;
}

/* Some formats are written and not read, and others the reverse. */
static bool can(const struct volume_format *format, bool write)
{
    return write ? format->write != NULL : format->read_header != NULL;
}

/* "NIfTI (.nii or .nii.gz)": the formats that are read, or those that are written. */
static void list_formats(struct buf *out, bool write)
{
    for (int i = 0; i < FORMATS; i++) {
        const char *endings = formats[i]->endings, *between = " (";
        struct choice ending;
        if (!can(formats[i], write))
            continue;
        buf_printf(out, "%s%s", out->length ? ", " : "", formats[i]->name);
        for (; choice_next(&ending, &endings); between = " or ")
            buf_printf(out, "%s%.*s", between, (int)ending.length, ending.word);
        buf_add_char(out, ')');
    }
}

static enum err refuse(const char *words, bool write, enum err err, struct fault *fault)
{
    struct buf list = {0};
    list_formats(&list, write);
    fault_set(fault, err, "%s%s", words, buf_text(&list));
    buf_release(&list);
    return err;
}

static enum err find_format(const struct volume_format **format, struct volume_source *source,
                            struct fault *fault)
{
    uint8_t begin[FIRST_BYTES];
    const size_t length = source_peek(source, begin, sizeof begin);
    *format = format_named(source->path);
    for (int i = 0; i < FORMATS; i++)
        if (can(formats[i], false) && formats[i]->recognises(begin, length))
            *format = formats[i];
    return *format && can(*format, false)
               ? OK
               : refuse("not a volume; expected ", false, ERR_INPUT, fault);
}

/* ---- reading ---- */

static void note_shear(struct volume_header *header)
{
    const double degrees = geometry_shear(&header->geometry);
    if (degrees >= 0.1)
        volume_note(header->notes,
                    "its axes are sheared: %.2g degrees off a right angle; pictures, lengths and "
                    "volumes are as if they were not",
                    degrees);
}

/* Opens `path` and reads its header; `source` is to be closed in any case. */
static enum err begin(const struct volume_format **format, struct volume_header *header,
                      struct volume_source *source, const char *path, struct fault *fault)
{
    *header = (struct volume_header){.volumes = 1};
    enum err err = source_open(source, path, fault);
    if (err)
        return err;
    err = find_format(format, source, fault);
    if (!err)
        err = (*format)->read_header(header, source, fault);
    if (!err)
        note_shear(header);
    return err ? fault_prefix(fault, err, "%s", path) : OK;
}

/* Takes the choice; refuses voxels that cannot be read, and a choice that does not fit. */
enum err volume_choose(struct volume_header *header, const char *path,
                       const struct volume_choice *choice, struct fault *fault)
{
    if (choice)
        header->choice = *choice;
    if (*header->refusal)
        return fault_set(fault, ERR_INPUT, "%s: %s", path, header->refusal);
    if (header->volumes > 1 && !header->choice.has_volume)
        return fault_set(fault, ERR_INPUT,
                         "%s: a series of %" PRIu32 " volumes; choose one, as in `open FILE "
                         "volume=0`, of 0 to %" PRIu32,
                         path, header->volumes, header->volumes - 1);
    if (header->choice.volume >= header->volumes)
        return fault_set(fault, ERR_INPUT,
                         "%s: there is no volume %" PRIu32 "; it holds %" PRIu32 ", counted from 0",
                         path, header->choice.volume, header->volumes);
    return part_choose(header, fault) ? fault_prefix(fault, fault->code, "%s", path) : OK;
}

enum err volume_about(struct volume_header *out, const char *path, struct fault *fault)
{
    const struct volume_format *format;
    struct volume_source source;
    enum err err = begin(&format, out, &source, path, fault);
    source_close(&source);
    return err;
}

enum err volume_read(struct volume *out, const char *path, const struct volume_choice *choice,
                     struct watch *watch, struct fault *fault)
{
    const struct volume_format *format;
    struct volume_header header;
    struct volume_source source;
    *out = (struct volume){0};
    enum err err = begin(&format, &header, &source, path, fault);
    if (!err)
        err = volume_choose(&header, path, choice, fault);
    if (!err) {
        memcpy(out->size, header.size, sizeof out->size);
        memcpy(out->whole, header.whole, sizeof out->whole);
        out->choice = header.choice;
        memcpy(out->notes, header.notes, sizeof out->notes);
        out->geometry = header.geometry;
        err = format->read_voxels(out, &header, &source, watch, fault);
        if (err)
            fault_prefix(fault, err, "%s", path);
    }
    source_close(&source);
    if (err)
        volume_release(out);
    return err;
}

void volume_release(struct volume *volume)
{
    free(volume->intensity);
    *volume = (struct volume){0};
}

/* ---- writing ---- */

enum err volume_write(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault)
{
    const struct volume_format *format = format_named(path);
    if (format && can(format, true))
        return format->write(path, mode, map, watch, fault);
    const enum err err = refuse("expected the name of a volume, ", true, ERR_USAGE, fault);
    return fault_prefix(fault, err, "cannot write %s", path);
}
