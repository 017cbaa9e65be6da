/*
 * About a file: what a picture, a scene or a journal says of itself, for `iftty info FILE`.
 *
 * OpenEXR is read by our own reader, and by the image helper where another program wrote what ours
 * does not take; all other pictures by the helper. Pictures are decoded: one that is damaged or cut
 * short is an error. Of a scene the header alone is read. Nothing a file says reaches the terminal
 * as it is.
 */
#ifndef PROGRAM_ABOUT_H
#define PROGRAM_ABOUT_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"
#include "image/helper.h"

/* Adds lines for a person, or one JSON object and a line feed, to `out`. A journal that is torn,
 * edited or damaged is told like any, and ERR_CHECK. */
enum err about_file(struct buf *out, const char *path, bool json, struct image_helper *helper,
                    struct fault *fault);

#endif
