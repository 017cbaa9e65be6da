/*
 * PNG as this program has it written beside a golden image, taken apart without the image helper:
 * 8 bits a channel, RGB or RGBA, not interlaced, with notes as text chunks before the pixels.
 *
 * Everything else is refused, and with it whatever could make a viewer show something else than the
 * pixels that were compared: profiles, another gamma, a colour that is clear, frames of an
 * animation, text that nobody asked for, bytes after the end.
 */
#ifndef IMAGE_PNG_READ_H
#define IMAGE_PNG_READ_H

#include "base/err.h"
#include "image/picture.h"

/* `out` gets rgba, alpha 255 in files without, and the notes. The size is that of the picture which
 * it is compared with: ERR_CHECK for another. ERR_INPUT for another form, with what it is;
 * ERR_MEMORY. On error *out is empty. */
enum err png_read(struct picture *out, const void *bytes, size_t length, uint32_t width,
                  uint32_t height, struct fault *fault);

#endif
