/* SPDX-License-Identifier: MIT */
/*
 * OpenEXR: golden images and renditions, by OpenEXR's C library; image/exr_write.h writes them.
 *
 * A file has one part under ZIP, of scan lines or (picture->tiled) of tiles of 64x64 pixels in one
 * level, data and display window from 0,0:
 *
 *     R G B A       half    linear light; A is 0..1; colours are multiplied by A, as OpenEXR has it
 *     Z             float   millimetres from the camera on; +infinity where nothing is seen
 *     depth         float   depth_mm: the same from the plane through the scene's middle on
 *     label         uint
 *     voxel         uint    0xFFFFFFFF where nothing is seen
 *     N.X N.Y N.Z   float   normal, towards Right, Anterior, Superior; 0,0,0 where nothing is seen
 *
 * of which all but the first are there when the picture has the plane. Z is what compositors know,
 * and is not read back: depth is exact. The string attribute iftty:alpha is "associated", and
 * worldToCamera and worldToNDC are OpenEXR's standard attributes, where the picture's space has a
 * world, in millimetres, with points as rows. ImfStandardAttributes.h of OpenEXR has the space of
 * the camera left-handed, as RenderMan has it: x to the right, y up, +z ahead, so that Z is z; the
 * matrix has determinant -1, and programs that make a camera of it (scripts for Nuke, by that name)
 * turn z around. iftty:cameraToWorld is the camera as Blender and Nuke place one, right-handed: x
 * to the right, y up, -z ahead, a rotation of determinant 1 with the place in its last row. A pixel
 * lies where the camera's point (x, y, -Z) goes. It is not there for sheared scenes.
 *
 * A picture that is not associated, as golden images were once, has no iftty:alpha: colours are not
 * multiplied by A then, Z is depth_mm, and there is no channel depth. Readers go by the attribute.
 *
 * Each attribute of the picture is a string attribute of its own name. exr_read gives back exactly
 * what exr_write was given, but for colours where alpha is 0, which are 0 in an associated file:
 * 8-bit sRGB goes through a table of 256 halves that all differ, for each alpha another
 * (image/linear.h), and a half that is not in the table (another program wrote it) comes back as
 * the nearest entry. The same picture gives the same bytes: no time, host or program is noted.
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

/* Reads a picture of the form above; channels it does not know are left out. A file of more than
 * 16384 pixels a side, of another form or damaged is refused in one line, *out is empty then. */
enum err exr_read(struct picture *out, const char *path, struct fault *fault);

/* Reads a golden image, which has to be as exr_write would write `like`, the picture that is drawn
 * now, but for its pixels and notes, which the caller compares: another size, another header and
 * any byte that no reader looks at are ERR_CHECK, before a pixel is decoded where the header shows
 * it. It takes no more memory than is free (mem_available), and ends with ERR_CANCELLED when the
 * watch stops. */
struct watch;
enum err exr_read_golden(struct picture *out, const char *path, const struct picture *like,
                         struct watch *watch, struct fault *fault);

/*
 * The header of an OpenEXR file, as bytes, read without OpenEXR: the maker of a picture is known
 * without decoding it, and a golden image is compared with the header that exr_write gives.
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

/* bytes = the header and no more. ERR_INPUT for another file, or a longer header; ERR_IO,
 * ERR_MEMORY. */
enum err exr_header_read(struct buf *bytes, int fd, struct fault *fault);

/* The next attribute of a header that exr_header_read has read; *at begins as 0. False at the end.
 */
bool exr_header_next(const struct buf *header, size_t *at, struct exr_attribute_bytes *attribute);

#endif
