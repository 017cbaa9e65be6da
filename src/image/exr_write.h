/* SPDX-License-Identifier: MIT */
/*
 * Writing OpenEXR as image/exr.h describes it, from a picture that is there or while it is drawn.
 * A strip (image/strips.h) is what ZIP packs together of lines, or a row of tiles.
 */
#ifndef IMAGE_EXR_WRITE_H
#define IMAGE_EXR_WRITE_H

#include "base/err.h"
#include "base/file.h"
#include "image/picture.h"
#include "image/strips.h"

extern const struct strips_format exr_strips;

/* Writes `picture` as `path`, whole or not at all. ERR_INPUT for an attribute whose name OpenEXR
 * uses itself (such as "channels") or that is empty or longer than 255 bytes. */
enum err exr_write(const char *path, enum file_mode mode, const struct picture *picture,
                   struct fault *fault);

/* out = the header of `like`, without its notes; other bytes may follow it. */
enum err exr_write_header_of(struct buf *out, const struct picture *like, struct fault *fault);

#endif
