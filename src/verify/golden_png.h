/*
 * The PNG beside a golden image, which people look at: it has to show what the golden image does,
 * pixel by pixel, its colours over their background. It is decoded by the image helper, in a
 * confined process, since whoever changed it chose its bytes; that takes some 0.2 s for the first
 * of a journal, so it is asked of strict verifications alone.
 */
#ifndef VERIFY_GOLDEN_PNG_H
#define VERIFY_GOLDEN_PNG_H

#include "command/interpreter.h"

/* OK where it shows `picture`, or is not there: nothing needs it. ERR_CHECK where it shows
 * something else, or cannot be read. `exr` is the path of the golden image. */
enum err golden_png_check(struct interpreter *interp, const char *exr,
                          const struct picture *picture, struct fault *fault);

#endif
