#include "verify/golden_png.h"

#include <inttypes.h>
#include <string.h>

#include "base/safe.h"
#include "command/files.h"
#include "command/golden_judge.h"
#include "image/png_read.h"

/* Whether the pixel of the file is that of the picture: over what is behind it, or with its alpha
 * where that is clear. */
static bool shows(const uint8_t *file, const uint8_t *rgba, bool is_clear)
{
    if (is_clear)
        return memcmp(file, rgba, 4) == 0;
    for (int c = 0; c < 3; c++)
        if (file[c] != (rgba[c] * rgba[3] + 127) / 255)
            return false;
    return file[3] == 255;
}

static enum err compare_pixels(const struct picture *file, const struct picture *picture,
                               struct fault *fault)
{
    uint64_t differ = 0;
    const size_t pixels = (size_t)picture->width * picture->height;
    for (size_t i = 0; i < pixels; i++)
        differ += !shows(file->rgba + 4 * i, picture_colours(picture) + 4 * i, picture->is_clear);
    return differ ? fault_set(fault, ERR_CHECK,
                              "it shows another picture than the golden image beside it, in "
                              "%" PRIu64 " of %zu pixels",
                              differ, pixels)
                  : OK;
}

/* The one that OpenImageIO adds by itself. */
static bool is_writers_own(const struct attribute *text)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    return strcmp(text->name, "oiio:ColorSpace") == 0 && strlen(text->value) <= 32 &&
           !text->value[strspn(text->value, letters)];
}

static enum err compare_texts(const struct picture *file, const struct picture *golden,
                              struct fault *fault)
{
    for (size_t i = 0; i < file->attributes; i++) {
        const struct attribute *text = &file->attribute[i];
        const char *note = picture_find(golden, text->name);
        if (is_writers_own(text) || golden_note_is_of_its_time(text) ||
            (note && strcmp(note, text->value) == 0))
            continue;
        struct buf words = {0};
        buf_add_safe_text(&words, text->name);
        buf_add_text(&words, ": ");
        buf_add_safe(&words, text->value, strnlen(text->value, 200));
        const enum err err =
            fault_set(fault, ERR_CHECK, "it has a text that the golden image beside it has not: %s",
                      buf_text(&words));
        buf_release(&words);
        return err;
    }
    return OK;
}

/* A file of more bytes than pixels and notes can take is another one. */
static enum err read_png(struct picture *file, const struct interpreter *interp, const char *path,
                         const struct picture *picture, struct fault *fault)
{
    struct buf bytes = {0};
    const size_t most = (size_t)8 * picture->width * picture->height + (4 << 20);
    enum err err = interpreter_may_read(interp, path, fault);
    if (!err)
        err = file_read(&bytes, path, most, fault);
    if (!err)
        err =
            png_read(file, buf_text(&bytes), bytes.length, picture->width, picture->height, fault);
    buf_release(&bytes);
    return err;
}

static enum err check_png(const struct interpreter *interp, const char *path,
                          const struct golden_finding *finding, struct fault *fault)
{
    struct picture file = {0};
    enum err err = read_png(&file, interp, path, finding->actual, fault);
    if (!err)
        err = compare_pixels(&file, finding->actual, fault);
    if (!err)
        err = compare_texts(&file, finding->expected, fault);
    picture_release(&file);
    if (!err || err == ERR_MEMORY)
        return err;
    fault_prefix(fault, err, "%s", path);
    return fault_set(fault, ERR_CHECK, "%s; delete it, and `golden` draws it again", fault->text);
}

enum err golden_png_check(struct interpreter *interp, const struct golden_finding *finding,
                          struct fault *fault)
{
    struct buf path = {0};
    buf_add(&path, finding->path, strlen(finding->path) - strlen("exr"));
    buf_add_text(&path, "png");
    enum err err = path.failed ? fault_memory(fault, "a path") : OK;
    if (!err && file_exists(buf_text(&path)))
        err = check_png(interp, buf_text(&path), finding, fault);
    buf_release(&path);
    return err;
}
