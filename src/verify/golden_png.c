#include "verify/golden_png.h"

#include <inttypes.h>
#include <string.h>

/* Whether the pixel of the file is that of the picture: over what is behind it, or with its alpha
 * where that is clear. */
static bool shows(const uint8_t *file, const uint8_t *rgba, bool is_clear)
{
    if (is_clear)
        return memcmp(file, rgba, 4) == 0;
    for (int c = 0; c < 3; c++)
        if (file[c] != (rgba[c] * rgba[3] + 127) / 255)
            return false;
    return true;
}

static enum err compare(const struct picture *file, const struct picture *picture, const char *path,
                        struct fault *fault)
{
    uint64_t differ = 0;
    const size_t pixels = (size_t)picture->width * picture->height;
    if (file->width != picture->width || file->height != picture->height)
        return fault_set(fault, ERR_CHECK,
                         "strict: %s has another size than the golden image beside it: delete it, "
                         "and `golden` draws it again",
                         path);
    for (size_t i = 0; i < pixels; i++)
        differ += !shows(file->rgba + 4 * i, picture_colours(picture) + 4 * i, picture->is_clear);
    return differ
               ? fault_set(fault, ERR_CHECK,
                           "strict: %s shows another picture than the golden image beside it, "
                           "in %" PRIu64 " of %zu pixels: delete it, and `golden` draws it again",
                           path, differ, pixels)
               : OK;
}

enum err golden_png_check(struct interpreter *interp, const char *exr,
                          const struct picture *picture, struct fault *fault)
{
    struct buf path = {0};
    struct picture file = {0};
    buf_add(&path, exr, strlen(exr) - strlen("exr"));
    buf_add_text(&path, "png");
    enum err err = path.failed ? fault_memory(fault, "a path") : OK;
    if (!err && file_exists(buf_text(&path))) {
        err = interpreter_may_read(interp, buf_text(&path), fault);
        if (!err)
            err = image_helper_read(interp->helper, buf_text(&path), &file, fault);
        if (err) {
            fault_prefix(fault, err, "strict: %s cannot be read", buf_text(&path));
            err = fault_set(fault, ERR_CHECK, "%s", fault->text);
        } else {
            err = compare(&file, picture, buf_text(&path), fault);
        }
    }
    picture_release(&file);
    buf_release(&path);
    return err;
}
