/* SPDX-License-Identifier: MIT */
/*
 * Surfaces in files: STL, PLY, OBJ and VTP, by the ending of the name.
 *
 *     .stl   binary: triangles with normals, and no colours
 *     .ply   binary, little-endian: points with colours
 *     .obj   text: points with colours (after the position, as most programs read it); an object
 *            for each label
 *     .vtp   VTK's XML, with raw data after it: points with colours and labels
 *
 * Positions are those of the world (image/geometry.h): millimetres towards Right, Anterior,
 * Superior, in single precision. They are computed from whole numbers of 2^-n millimetres, so that
 * files are the same on every machine. Normals point out of the label, also if the axes of the
 * voxels are left-handed.
 *
 * Two points of a surface never have the same position in a file, so that readers which identify
 * points by their positions (all of STL) see a closed surface: one of two is moved by 2^-14 of the
 * finest spacing along x, or by the least step of single precision.
 */
#ifndef IMAGE_SURFACE_FILE_H
#define IMAGE_SURFACE_FILE_H

#include "base/file.h"
#include "engine/surface.h"
#include "image/volume.h"

/* ERR_USAGE for a name without one of these endings. */
enum err surface_file_check(const char *path, struct fault *fault);

/* Return true if a file of that name stores the label of each triangle. */
bool surface_file_tells_labels(const char *path);

/* A surface to be written, with labels and notes. */
struct surface_document {
    const struct surface *surface;
    const struct geometry *geometry;
    const struct volume_label *label; /* [256] */
    const char *notes;                /* a line; "" for none */
};

/* Write `path` atomically; the watch may be NULL. ERR_LIMIT if the scene is so far from the origin
 * of the world that single precision does not distinguish its voxels well. */
enum err surface_write(const char *path, enum file_mode mode,
                       const struct surface_document *document, struct watch *watch,
                       struct fault *fault);

#endif
