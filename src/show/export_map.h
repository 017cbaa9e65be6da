/* SPDX-License-Identifier: MIT */
/* Maps that leave a session, in the scene's geometry, and its seeds as a list. */
#ifndef REPORT_EXPORT_MAP_H
#define REPORT_EXPORT_MAP_H

#include "base/file.h"
#include "image/volume.h"
#include "session/session.h"

/* How labels are called and shown; names are borrowed. */
void export_labels(struct volume_label label[256], const struct kept *kept);

#define MAPS "labels|cost|root|border|distance|margin"
enum map { MAP_LABELS, MAP_COST, MAP_ROOT, MAP_BORDER, MAP_DISTANCE, MAP_MARGIN, MAP_INTENSITY };

/* A map in the scene's geometry: `labels`, which may be finished, by their own numbers, as uint8 or
 * where one is above 255 as uint16, and ERR_INPUT where two are the same; the border as uint8; cost
 * uint16, 65535 where no seed reaches; root uint32, the voxel index of the seed, 0xFFFFFFFF where
 * none reaches; distance uint16, the plateau distance (hops of engine/forest.h), 65535 where no
 * seed reaches; margin uint16 (engine/margin.h); intensity float32, the values of the scene as
 * levels_value has them, for NIfTI alone. */
enum err export_map(const struct session *session, enum map map, const struct labels *labels,
                    const char *path, enum file_mode mode, struct fault *fault);

/* The seeds that are planted as lines x,y,z,label, in the order of voxels, under one with the names
 * of these columns; four more where a seed has a reach: what `seed-file` reads. */
enum err export_seeds(struct buf *out, const struct session *session, struct fault *fault);

#endif
