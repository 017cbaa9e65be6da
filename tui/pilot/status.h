/* SPDX-License-Identifier: MIT */
/*
 * The row below the picture: where the cross-hair is, what a key would plant there, what waits, and
 * what is known of the voxel.
 *
 *     axial at 90,108,90  brush 2 ventricle r3  here 1 brain 1.64 l (+1.2 ml)  intensity 93
 *
 * It is made of parts, each of a rank. A screen that is too narrow for all of them shows those of
 * the highest ranks that fit, each whole, in the same order: the place, the brush and the label
 * first, then names, the volume and its change, the intensity, millimetres, the rest. So nothing
 * moves to the left or right for a part that comes or goes far down. A `>` at the end says that
 * slices are sent ahead. Pure.
 */
#ifndef TUI_PILOT_STATUS_H
#define TUI_PILOT_STATUS_H

#include "base/buf.h"
#include "tui/pilot/host.h"
#include "tui/pilot/pilot_keys.h"

/* Adds the row, without a line feed, for a screen of so many columns. */
void pilot_add_status(struct buf *out, const struct pilot_state *state,
                      const struct pilot_host *host, const struct pilot_facts *facts,
                      unsigned columns);

#endif
