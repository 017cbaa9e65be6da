/* SPDX-License-Identifier: MIT */
/*
 * The incremental image: find the pixels that are out of date after an edit, and update them.
 *
 * The mesh reports its quads that are removed and added (render/mesh.h). Tiles in which one of them
 * may be visible become stale and are redrawn; nothing else is examined.
 */
#ifndef RENDER_INCREMENTAL_H
#define RENDER_INCREMENTAL_H

#include "render/look.h"
#include "render/mesh.h"
#include "render/rendition.h"

/* `rendition` shows the labels before the edit, by the same camera; the border is up to date, and
 * mesh_note was called. Update the mesh, and the pixels whose colours may change; all their tiles
 * become stale. After an error both must be recomputed. */
enum err incremental_image(struct rendition *rendition, const struct camera *camera,
                           struct mesh *mesh, const struct border *border, const struct look *look,
                           const struct changes *changes, struct team *team, struct fault *fault);

#endif
