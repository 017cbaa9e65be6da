/*
 * The incremental image: which pixels are out of date after an edit, and what they show now.
 *
 * `rendition` is that of the labels before the edit, by the same camera, and `border` is up to
 * date. Repairs it in time proportional to the changes, and marks the tiles whose colours may
 * change: `reach` says how far around a change they do. Changes that are "everything" are splatted
 * from nothing. Of a stale tile all pixels are looked at for what has disappeared: by voxel, most
 * would be looked at several times.
 */
#ifndef RENDER_INCREMENTAL_H
#define RENDER_INCREMENTAL_H

#include "render/rendition.h"

void incremental_image(struct rendition *rendition, const struct camera *camera,
                       const struct border *border, const struct changes *changes,
                       struct shade_reach reach);

#endif
