/* SPDX-License-Identifier: MIT */
/*
 * OpenEXR: golden images and renditions, by OpenEXR's C library; image/exr_write.h writes them.
 *
 * A file has one part under ZIP, of scan lines or (picture->tiled) of tiles of 64x64 pixels in one
 * level, data and display window from 0,0:
 *
 *     R G B A       half    linear light; A is 0..1; colours are multiplied by A, as OpenEXR has it
 *     Z             float   millimetres from the camera; +infinity where nothing is seen
 *     depth         float   depth_mm: the same from the plane through the scene's middle
 *     label         uint
 *     voxel         uint    0xFFFFFFFF where nothing is seen
 *     N.X N.Y N.Z   float   normal, towards Right, Anterior, Superior; 0,0,0 where nothing is seen
 *
 * All but the first row are present if the picture has the plane. Z is for compositors, and is not
 * read back: depth is exact. The string attribute iftty:alpha is "associated"; worldToCamera and
 * worldToNDC are OpenEXR's standard attributes, written if the picture's space has a world, in
 * millimetres, with points as rows. In ImfStandardAttributes.h of OpenEXR the space of the camera
 * is left-handed, as in RenderMan: x to the right, y up, +z ahead, so that Z is z; the matrix has
 * determinant -1, and programs that build a camera from it (scripts for Nuke, by that name) negate
 * z. iftty:cameraToWorld is the camera in the convention of Blender and Nuke, right-handed: x to
 * the right, y up, -z ahead, a rotation of determinant 1 with the position in its last row. It maps
 * the camera's point (x, y, -Z) to the pixel's position in the world, and is absent for sheared
 * scenes.
 *
 * A picture that is not associated, like old golden images, has no iftty:alpha: its colours are not
 * multiplied by A, Z is depth_mm, and there is no channel depth. Readers check the attribute.
 *
 * Each attribute of the picture is a string attribute of the same name. exr_read returns exactly
 * the written picture, except for colours where alpha is 0, which are 0 in an associated file:
 * 8-bit sRGB is converted by a table of 256 different halves for each alpha (image/linear.h), and a
 * half that is not in the table (from another program) becomes the nearest entry. The same picture
 * has the same bytes: no time, host or program is stored.
 */
#ifndef IMAGE_EXR_H
#define IMAGE_EXR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "image/picture.h"

/* The endings of OpenEXR files; all three mean the same. */
#define EXR_NAMES ".exr|.sxr|.mxr"

/* Read a picture of the form above; unknown channels are ignored. A file of more than 16384 pixels
 * a side, of another form or damaged is refused in one line, and *out is empty. */
enum err exr_read(struct picture *out, const char *path, struct fault *fault);

/* Read a golden image, which must equal the file that iftty writes for `like`, the picture
 * drawn now, except for its pixels and notes, which the caller compares. Another size, another
 * header and any byte that readers ignore are ERR_CHECK, before a pixel is decoded if the header
 * shows it. Uses at most the free memory (mem_available), and returns ERR_CANCELLED if the watch
 * stops. */
struct watch;
enum err exr_read_golden(struct picture *out, const char *path, const struct picture *like,
                         struct watch *watch, struct fault *fault);

/*
 * The header of an OpenEXR file, as bytes, read without OpenEXR: to find the program that wrote a
 * picture without decoding it, and to compare a golden image with the header of exr_write.c.
 *
 *     76 2f 31 01        magic number
 *     02 00 00 00        version 2; flags above: 0x200 tiles, 0x400 long names
 *     "name\0" "type\0" length (4 bytes, little-endian) value        any number of attributes
 *     00                 the end
 *
 * Only the header of the first part is read, and at most EXR_HEADER_MOST bytes of it.
 */

enum { EXR_HEADER_MOST = 1 << 20 };

struct exr_attribute_bytes {
    const char *name, *type; /* each ended by NUL */
    const char *value;       /* `length` bytes */
    size_t length;
};

/* bytes = the header alone. ERR_INPUT for another file, or a longer header; ERR_IO, ERR_MEMORY. */
enum err exr_header_read(struct buf *bytes, int fd, struct fault *fault);

/* Read the next attribute of a header of exr_header_read; *at begins as 0. False at the end. */
bool exr_header_next(const struct buf *header, size_t *at, struct exr_attribute_bytes *attribute);

#endif
