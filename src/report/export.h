/*
 * What leaves a session: pictures of its rendition, and maps in the scene's geometry.
 *
 * Here integers become floating point, and nothing of it finds its way back.
 */
#ifndef REPORT_EXPORT_H
#define REPORT_EXPORT_H

#include "base/file.h"
#include "image/picture.h"
#include "image/volume.h"
#include "show/drawn_colours.h"
#include "session/session.h"

#define PROGRAM_VERSION "0.1"

/* What every picture says of itself: program, scene, view; and the labels shown, or NULL. */
enum err export_notes(struct picture *picture, const struct session *session,
                      const struct label_set *shown, struct fault *fault);

/* "100 %, 30 % of label 1": the usual opacity, and that of others; nothing where all are opaque. */
void export_opacity(struct buf *out, const struct kept *kept);

/* All planes of the rendition but normals, which must be rendered, and notes: version, scene (its
 * name and digest), view. Depth is in millimetres along the view direction, 0 in the middle of the
 * scene. The caller releases the picture. */
enum err export_picture(struct picture *picture, const struct session *session,
                        struct fault *fault);

/* The same for files that hold colours alone: `rgba` is what they show, over what is behind it. */
enum err export_colours(struct picture *picture, const struct session *session,
                        struct fault *fault);

/* The same of a picture that is yet to be drawn, of these labels, and its digest: in place, and no
 * rendition is stored afterwards. Not where more than colours is needed (session_draws_colours). */
enum err export_drawn(struct picture *picture, struct session *session, const struct labels *labels,
                      uint64_t *digest, struct fault *fault);

/* What is behind a picture of all planes, for those who look at it: as `shown`. */
enum err export_background(struct picture *picture, const struct session *session,
                           struct fault *fault);

/* The normals as well, for files that hold them. */
enum err export_normals(struct picture *picture, const struct session *session,
                        struct fault *fault);

/* Normals along the axes of voxels (unit vectors times 2^14, [pixels][4], the fourth unused), as
 * unit vectors towards Right, Anterior, Superior ([pixels][3]). Exact: a float holds them. */
void export_normals_to_world(float *out, const int16_t *normal, size_t pixels,
                             const struct scene *scene);

/* How labels are called and shown; names are borrowed. */
void export_labels(struct volume_label label[256], const struct kept *kept);

#define MAPS "labels|cost|root|border|distance|margin"
enum map { MAP_LABELS, MAP_COST, MAP_ROOT, MAP_BORDER, MAP_DISTANCE, MAP_MARGIN };

/* A map in the scene's geometry: `labels`, which may be finished, by their own numbers, as uint8 or
 * where one is above 255 as uint16, and ERR_INPUT where two are the same; the border as uint8; cost
 * uint16, 65535 where no seed reaches; root uint32, the voxel index of the seed, 0xFFFFFFFF where
 * none reaches; distance uint16, the plateau distance (hops of engine/forest.h), 65535 where no
 * seed reaches; margin uint16 (engine/margin.h). */
enum err export_map(const struct session *session, enum map map, const struct labels *labels,
                    const char *path, enum file_mode mode, struct fault *fault);

/* The seeds that are planted as lines x,y,z,label, in the order of voxels, under one with the names
 * of these columns; four more where a seed has a reach: what `seed-file` reads. */
enum err export_seeds(struct buf *out, const struct session *session, struct fault *fault);

#endif
