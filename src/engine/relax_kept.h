/* SPDX-License-Identifier: MIT */
/*
 * Fields of relaxation that are kept, so that after an edit those alone are made anew which it may
 * have changed.
 *
 * A field follows from where its label lies, from the seeds and the region of interest in its box
 * and right beside it, from the intensities there, and from the numbers of sweeps and steps.
 * All of these are kept as they were, and compared: so nobody has to tell what an edit has changed,
 * and a field that is kept is the one that would be made.
 *
 * Of a field, chunks are kept that may have moved (relax_field_next). All of them together take as
 * much memory as the scene's cells at most; what is beyond that is made each time.
 */
#ifndef ENGINE_RELAX_KEPT_H
#define ENGINE_RELAX_KEPT_H

#include "engine/relax_field.h"

/* {0} has kept nothing yet. It is of one scene, whose intensities stay. */
struct relax_kept {
    size_t cells, bytes, most; /* taken for fields, and how many may be */
    uint8_t *label, *stays;    /* [cells]: what fields are of; flags of cells that matter */
    uint32_t sweeps, reach;
    struct relax_stored *field[256]; /* NULL: not kept */
};

/* Forgets the fields that others, of these labels and this scene, may differ from. Without memory
 * it forgets all, and keeps none; stopped by the scene's watch, it goes on the next time. */
void relax_kept_follow(struct relax_kept *kept, const struct finish_work *work, uint32_t sweeps,
                       uint32_t reach);

/* Has the field of a label, to be read alone, if it is kept; and keeps it if there is room. */
bool relax_kept_find(const struct relax_kept *kept, const struct finish_work *work, uint8_t which,
                     struct relax_field *field);
void relax_kept_add(struct relax_kept *kept, const struct relax_field *field);

size_t relax_kept_memory(const struct relax_kept *kept);
void relax_kept_release(struct relax_kept *kept);

#endif
