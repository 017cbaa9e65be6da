/* SPDX-License-Identifier: MIT */
/*
 * Surfaces in files: STL, PLY, OBJ and VTP, by the ending of the name.
 *
 *     .stl   binary: triangles with normals, and no colours
 *     .ply   binary, little-endian: points with colours
 *     .obj   text: points with colours (after the place, as most programs read it); an object for
 *            each label
 *     .vtp   VTK's XML, with raw data after it: points with colours and labels
 *
 * Places are those of the world (image/geometry.h): millimetres towards Right, Anterior, Superior,
 * in single precision. They are worked out from whole numbers of 2^-n millimetres, so that files
 * are the same on every machine. Normals point out of the label, also where the axes of the
 * voxels are left-handed.
 *
 * No two points of a surface have the same place in a file, so that readers which know points by
 * their places alone (of STL, all) find it closed as well: one of two is moved by 2^-14 of the
 * finest spacing along x, or by the least that single precision knows.
 */
#ifndef IMAGE_SURFACE_FILE_H
#define IMAGE_SURFACE_FILE_H

#include "base/file.h"
#include "engine/surface.h"
#include "image/volume.h"

/* ERR_USAGE where the name has none of those endings. */
enum err surface_file_check(const char *path, struct fault *fault);

/* Whether a file of that name says which triangles belong to which label. */
bool surface_file_tells_labels(const char *path);

/* A surface to be written, and what is said with it. */
struct surface_document {
    const struct surface *surface;
    const struct geometry *geometry;
    const struct volume_label *label; /* [256] */
    const char *notes;                /* a line; "" for none */
};

/* Writes `path` whole or not at all, as where the watch, or NULL, stops it. ERR_LIMIT where the
 * scene lies so far from the origin of the world that voxels would not be told apart well. */
enum err surface_write(const char *path, enum file_mode mode,
                       const struct surface_document *document, struct watch *watch,
                       struct fault *fault);

#endif
