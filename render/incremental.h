/* SPDX-License-Identifier: MIT */
/*
 * The incremental image: which pixels are out of date after an edit, and what they show now.
 *
 * The mesh tells which of its quads come and go (render/mesh.h). Tiles in which one of them may be
 * seen are stale, and are drawn anew; nothing else is looked at.
 */
#ifndef RENDER_INCREMENTAL_H
#define RENDER_INCREMENTAL_H

#include "render/look.h"
#include "render/mesh.h"
#include "render/rendition.h"

/* `rendition` is that of the labels before the edit, by the same camera; the border is up to date,
 * and mesh_note has been told. Brings the mesh up to date, and the pixels whose colours may change,
 * of which all tiles are stale then. On an error neither is of use until it is made anew. */
enum err incremental_image(struct rendition *rendition, const struct camera *camera,
                           struct mesh *mesh, const struct border *border, const struct look *look,
                           const struct changes *changes, struct team *team, struct fault *fault);

#endif
