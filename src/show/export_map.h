/* SPDX-License-Identifier: MIT */
/* Export maps of a session in the scene's geometry, and its seeds as a list. */
#ifndef SHOW_EXPORT_MAP_H
#define SHOW_EXPORT_MAP_H

#include "base/file.h"
#include "image/volume.h"
#include "session/session.h"

/* Names, numbers and colours of labels; names are borrowed. */
void export_labels(struct volume_label label[256], const struct kept *kept);

#define MAPS "labels|cost|root|border|distance|margin"
enum map { MAP_LABELS, MAP_COST, MAP_ROOT, MAP_BORDER, MAP_DISTANCE, MAP_MARGIN, MAP_INTENSITY };

/* Write a map in the scene's geometry:
 *
 *     labels      or finished labels: their numbers, in the smallest of uint8, uint16, uint32
 *     border      uint8
 *     cost        uint16, 65535 where no seed reaches
 *     root        uint32, the voxel index of the seed; 0xFFFFFFFF where no seed reaches
 *     distance    uint16, the plateau distance (hops of engine/forest.h), or 65535
 *     margin      uint16 (engine/margin.h)
 *     intensity   float32, the values of levels_value; for NIfTI alone
 *
 * `source` is for DICOM SEG; otherwise NULL.
 */
enum err export_map(const struct session *session, enum map map, const struct labels *labels,
                    const char *path, enum file_mode mode, const struct dicom_source *source,
                    struct fault *fault);

/* List the planted seeds as `seed-file` reads them: a line of column names, and lines x,y,z,label
 * in the order of voxels, with four more columns for seeds that have a reach. */
enum err export_seeds(struct buf *out, const struct session *session, struct fault *fault);

#endif
