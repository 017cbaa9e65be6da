/* SPDX-License-Identifier: MIT */
/*
 * MetaImage: write maps as .mha, header and voxels in one file, for programs that use ITK.
 *
 *     ObjectType = Image
 *     NDims = 3
 *     BinaryData = True
 *     BinaryDataByteOrderMSB = False
 *     CompressedData = False
 *     TransformMatrix = -1 0 0 0 -1 0 0 0 1
 *     Offset = 90 126 -72
 *     CenterOfRotation = 0 0 0
 *     ElementSpacing = 1 1 1
 *     DimSize = 181 217 181
 *     ElementType = MET_UCHAR
 *     ElementDataFile = LOCAL
 *
 * TransformMatrix has the direction of each voxel axis in turn, in the world of left, posterior and
 * superior. It is omitted with Offset if the orientation is unknown, and ElementSpacing is omitted
 * if the spacing is unknown.
 *
 * From: https://itk.org/Wiki/ITK/MetaIO/Documentation
 */
#include "image/volume_format.h"

static void write_reals(struct buf *out, const char *field, const double *value, int count)
{
    buf_printf(out, "%s =", field);
    for (int i = 0; i < count; i++) {
        buf_add_char(out, ' ');
        buf_add_real(out, value[i]);
    }
    buf_add_char(out, '\n');
}

static enum err write_map(const char *path, enum file_mode mode, const struct volume_map *map,
                          struct watch *watch, struct fault *fault)
{
    const struct geometry *geometry = map->geometry;
    const uint32_t *nm = geometry->spacing_nm;
    struct buf header = {0};
    buf_printf(&header,
               "ObjectType = Image\nComment = %s\nNDims = 3\nBinaryData = True\n"
               "BinaryDataByteOrderMSB = False\nCompressedData = False\n",
               map->description);
    if (geometry_has_place(geometry)) {
        double to_mm[3][4], direction[9], spacing[3];
        geometry_to_lps(geometry, to_mm);
        for (int a = 0; a < 3; a++) {
            spacing[a] = geometry_step_mm(geometry, a);
            for (int w = 0; w < 3; w++)
                direction[3 * a + w] = to_mm[w][a] / spacing[a];
        }
        const double origin[3] = {to_mm[0][3], to_mm[1][3], to_mm[2][3]};
        write_reals(&header, "TransformMatrix", direction, 9);
        write_reals(&header, "Offset", origin, 3);
        write_reals(&header, "CenterOfRotation", (const double[3]){0}, 3);
        write_reals(&header, "ElementSpacing", spacing, 3);
    } else if (!geometry->spacing_unknown)
        write_reals(&header, "ElementSpacing",
                    (const double[3]){nm[0] / 1e6, nm[1] / 1e6, nm[2] / 1e6}, 3);
    buf_printf(&header, "DimSize = %u %u %u\nElementType = %s\nElementDataFile = LOCAL\n",
               map->size[0], map->size[1], map->size[2],
               map->type == VOXEL_UINT8    ? "MET_UCHAR"
               : map->type == VOXEL_UINT16 ? "MET_USHORT"
                                           : "MET_UINT");
    return voxels_write(path, mode, &header, PACKED_NOT, map, watch, fault);
}

extern const struct volume_format metaimage_format;
const struct volume_format metaimage_format = {
    .name = "MetaImage",
    .endings = ".mha",
    .write = write_map,
};
