/* SPDX-License-Identifier: MIT */
/*
 * Raw: voxels without a header, x fastest, in a layout that the user says; plain or gzip.
 *
 * Such a file knows neither where its voxels lie nor how far apart they are. Bytes after the last
 * voxel are noted, since they may come from a layout that is wrong.
 */
#include <stdio.h>

#include "engine/grid.h"
#include "image/volume_format.h"

static enum err read_header(struct volume_header *out, struct volume_source *source,
                            struct fault *fault)
{
    const struct raw_layout *raw = &out->choice.raw;
    struct grid grid;
    enum err err = grid_init(&grid, raw->size, fault);
    if (err)
        return err;
    snprintf(out->format, sizeof out->format, "raw");
    out->type = (enum voxel_type)raw->type;
    snprintf(out->type_name, sizeof out->type_name, "%s", voxel_type_name(out->type));
    out->big_endian = raw->big_endian;
    out->offset = raw->offset;
    out->geometry.slope = 1;
    out->geometry.spacing_unknown = true;
    for (int a = 0; a < 3; a++) {
        out->size[a] = raw->size[a];
        out->geometry.spacing_nm[a] = 1000000;
    }
    geometry_place_spaced(&out->geometry);
    err = voxels_check(out, source, fault);
    if (!err)
        voxels_note_rest(out, source, "check size, type and offset");
    return err;
}

extern const struct volume_format raw_format;
const struct volume_format raw_format = {
    .name = "raw",
    .endings = "",
    .takes = TAKES_LAYOUTS,
    .read_header = read_header,
};
